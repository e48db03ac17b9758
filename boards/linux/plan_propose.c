#include "plan.h"

#include "measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 800 };
static const double apart_deg = 15, first_step_rad = 0.06, last_step_rad = 0.0005;

/// A direction from the targets' centre; score: what the margin in pixels is from there, negative
/// where it can't be used.
struct candidate {
    double direction[3];
    double score;
};

double plan_distance(const struct plan *plan) {
    double half_rad = asin(0.25);
    if (plan->camera.rig != NULL) {
        const struct lens_config *const lens = &plan->camera.rig->controller.lens;
        const double side = lens->sensor_width_um < lens->sensor_height_um ? lens->sensor_width_um
                                                                           : lens->sensor_height_um;
        const double focal_um = lens->point_count == 0U
                                    ? plan->camera.rig->fixed_focal_mm * 1000
                                    : sqrt((double)lens->point[0].focal_um *
                                           lens->point[lens->point_count - 1U].focal_um);
        half_rad = atan(side / 2 / focal_um / (1 + lens->margin_q16 * 0x1p-16));
    }
    // A cone that touches the targets' sphere; a little farther, so that rounding keeps it inside.
    return plan->radius > 0 ? plan->radius / sin(half_rad) * 1.001 : 1.0;
}

// ---------------------------------------------------------------- scores

struct search {
    struct plan plan; ///< in a grid that is fine enough
    const struct plan_region *region;
};

static bool place_of(const struct search *s, const double direction[3], struct vec3 *at) {
    int32_t c[3];
    for (int axis = 0; axis < 3; axis++) {
        const double x = s->plan.center[axis] + direction[axis] * s->region->distance;
        if (axis == 2 && x < s->region->above) {
            return false;
        }
        c[axis] = (int32_t)lround(x / s->plan.grid);
    }
    *at = vec3(c[0], c[1], c[2]);
    return true;
}

static void rate(struct search *s, struct candidate *candidate) {
    struct vec3 at;
    candidate->score = -1;
    if (place_of(s, candidate->direction, &at)) {
        struct plan_view view;
        plan_glance(&s->plan, at, &view);
        if (view.usable) {
            candidate->score = view.margin_px < 1e9 ? view.margin_px : 1e9;
        }
    }
}

/// Goes uphill in steps to eight sides that get smaller.
static void climb(struct search *s, struct candidate *best) {
    for (double step = first_step_rad; step > last_step_rad;) {
        const double *const d = best->direction;
        // Two directions across d, from the axis that is least along it.
        const int axis = fabs(d[2]) < 0.7 ? 2 : 0;
        double u[3] = {d[1] * (axis == 2), d[2] * (axis == 0) - d[0] * (axis == 2),
                       -d[1] * (axis == 0)};
        const double size = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        const double v[3] = {(d[1] * u[2] - d[2] * u[1]) / size, (d[2] * u[0] - d[0] * u[2]) / size,
                             (d[0] * u[1] - d[1] * u[0]) / size};
        struct candidate next = *best;
        for (int side = 0; side < 8; side++) {
            struct candidate trial = {.score = -1};
            const double a = cos(side * M_PI_4) * sin(step) / size,
                         b = sin(side * M_PI_4) * sin(step);
            for (int k = 0; k < 3; k++) {
                trial.direction[k] = d[k] * cos(step) + a * u[k] + b * v[k];
            }
            rate(s, &trial);
            next = trial.score > next.score ? trial : next;
        }
        step = next.score > best->score ? step : step / 2;
        *best = next;
    }
}

static int by_score(const void *a, const void *b) {
    const double x = ((const struct candidate *)a)->score, y = ((const struct candidate *)b)->score;
    return x > y ? -1 : x < y;
}

/// The best of them that can be used and are apart from every better one, the best first; sorts the
/// candidates.
static uint32_t pick(struct candidate *candidates, uint32_t count, struct candidate *picked,
                     uint32_t most) {
    uint32_t kept = 0;
    qsort(candidates, count, sizeof *candidates, by_score);
    for (uint32_t i = 0; i < count && kept < most; i++) {
        const double *const a = candidates[i].direction;
        bool apart = candidates[i].score >= 0;
        for (uint32_t j = 0; j < kept && apart; j++) {
            const double *const b = picked[j].direction;
            apart = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < cos(apart_deg / MEASURE_DEG_PER_RAD);
        }
        if (apart) {
            picked[kept++] = candidates[i];
        }
    }
    return kept;
}

// ---------------------------------------------------------------- as decimals

/// Three words a mount, to a two thousandth of the distance.
static char *write_words(const struct search *s, const struct candidate *candidates,
                         uint32_t count) {
    enum { WORD_MOST = 40 };
    char *const words = malloc((size_t)count * 3U * WORD_MOST + 1U);
    const double digits = ceil(log10(2000 / s->region->distance));
    const int places = digits < 0 ? 0 : digits > 12 ? 12 : (int)digits;
    char *at = words;
    for (uint32_t i = 0; i < count && words != NULL; i++) {
        for (int axis = 0; axis < 3; axis++) {
            const double x =
                s->plan.center[axis] + candidates[i].direction[axis] * s->region->distance;
            at += (fabs(x) < 1e12 ? snprintf(at, WORD_MOST, "%.*f", places, x)
                                  : snprintf(at, WORD_MOST, "%.6e", x)) +
                  1;
        }
    }
    return words;
}

uint32_t plan_propose(const struct points *targets, const struct plan *settings,
                      const struct plan_region *region, char **words) {
    struct search s = {.plan = *settings, .region = region};
    s.plan.scene = (struct plan_scene){0};
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        reach = fmax(reach, fabs(settings->center[axis]) + settings->radius + region->distance);
    }
    const uint32_t most = 2U * region->count + 4U;
    struct candidate *const candidates = malloc((SAMPLES + 2U * most) * sizeof *candidates);
    uint32_t count = UINT32_MAX;
    if (plan_set(&s.plan, targets, NULL, 0, reach) == EXIT_STATUS_OK && candidates != NULL) {
        // Evenly over the sphere: a spiral that turns by the golden angle.
        for (uint32_t i = 0; i < SAMPLES; i++) {
            const double z = 1 - (2 * i + 1) / (double)SAMPLES, r = sqrt(1 - z * z),
                         angle = i * 2.399963229728653;
            candidates[i] = (struct candidate){.direction = {r * cos(angle), r * sin(angle), z}};
            rate(&s, &candidates[i]);
        }
        // Several may climb the same hill; the samples themselves fill up what is missing then.
        struct candidate *const climbed = candidates + SAMPLES, *const best = climbed + most;
        const uint32_t climbers = pick(candidates, SAMPLES, climbed, most);
        for (uint32_t i = 0; i < climbers; i++) {
            climb(&s, &climbed[i]);
        }
        count = pick(candidates, SAMPLES + climbers, best, region->count);
        *words = write_words(&s, best, count);
        count = *words == NULL ? UINT32_MAX : count;
    }
    free(candidates);
    plan_free(&s.plan);
    return count;
}
