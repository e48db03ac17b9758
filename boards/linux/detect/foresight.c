#include "detect/foresight.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define MEMORY_S   0.1 ///< in which a sight fades
#define GAP_S      1.0 ///< unseen for so long: begins anew
#define SIGHTS_MIN 3U  ///< the first that confirms how it goes
/// How far from where it was expected a thing may be: so many radians, or this part of its way
/// since it was last seen.
#define SURPRISE_RAD  0.0175
#define SURPRISE_PART 0.5

void foresight_init(struct foresight *foresight) {
    foresight->count = 0;
}

static struct foresight_thing *find(struct foresight *foresight, uint32_t id) {
    for (uint32_t i = 0; i < foresight->count; i++) {
        if (foresight->thing[i].id == id) {
            return &foresight->thing[i];
        }
    }
    if (foresight->count == FORESIGHT_THINGS) {
        return NULL;
    }
    struct foresight_thing *const thing = &foresight->thing[foresight->count++];
    *thing = (struct foresight_thing){.id = id};
    return thing;
}

void foresight_forget(struct foresight *foresight, uint32_t id) {
    for (uint32_t i = 0; i < foresight->count; i++) {
        if (foresight->thing[i].id == id) {
            foresight->thing[i] = foresight->thing[--foresight->count];
            return;
        }
    }
}

static double length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void begin(struct foresight_thing *thing, const double world[3]) {
    memcpy(thing->at, world, sizeof thing->at);
    memset(thing->rate, 0, sizeof thing->rate);
    thing->sights = 1;
}

/// A fading memory m of place and rate: 1 - m^2 and (1 - m)^2 of each surprise count. The first
/// sights have less to remember.
static void follow(struct foresight_thing *thing, const double world[3], double since_s) {
    double surprise[3];
    for (unsigned i = 0; i < 3U; i++) {
        thing->at[i] += thing->rate[i] * since_s;
        surprise[i] = world[i] - thing->at[i];
    }
    const double way = length(thing->rate) * since_s;
    if (thing->sights > 1U && length(surprise) > fmax(SURPRISE_RAD, SURPRISE_PART * way)) {
        begin(thing, world);
        return;
    }
    thing->sights++;
    const double memory = fmin(exp(-since_s / MEMORY_S), 1.0 - 2.0 / (double)thing->sights);
    for (unsigned i = 0; i < 3U; i++) {
        thing->at[i] += (1.0 - memory * memory) * surprise[i];
        thing->rate[i] += (1.0 - memory) * (1.0 - memory) * surprise[i] / since_s;
    }
}

void foresight_see(struct foresight *foresight, uint32_t id, uint32_t seen_us, uint32_t now_us,
                   double world[3]) {
    struct foresight_thing *const thing = find(foresight, id);
    if (thing == NULL) {
        return;
    }
    const double since_s = (double)(int32_t)(seen_us - thing->seen_us) * 1e-6;
    thing->seen_us = seen_us;
    if (thing->sights == 0U || since_s <= 0.0 || since_s > GAP_S) {
        begin(thing, world);
    } else {
        follow(thing, world, since_s);
    }
    const uint32_t age_us = now_us - seen_us;
    if (thing->sights < SIGHTS_MIN || age_us > FORESIGHT_US_MAX) {
        return;
    }
    double next[3];
    for (unsigned i = 0; i < 3U; i++) {
        next[i] = thing->at[i] + thing->rate[i] * (double)age_us * 1e-6;
    }
    const double size = length(next);
    for (unsigned i = 0; i < 3U && size > 0.5; i++) {
        world[i] = next[i] / size;
    }
}
