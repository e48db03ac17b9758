#include "detect/tracks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NONE = UINT32_MAX };

void tracks_init(struct tracks *tracks, const struct tracks_settings *settings) {
    memset(tracks, 0, sizeof *tracks);
    tracks->next_id = settings->first_id;
}

void tracks_move(struct tracks *tracks, void (*move)(void *context, double pixel[2]),
                 void *context) {
    for (uint32_t i = 0; i < TRACKS_MAX; i++) {
        if (tracks->item[i].used) {
            move(context, tracks->item[i].at);
        }
    }
}

/// A possible pair; cost in parts of the gate.
struct pair {
    double cost;
    uint32_t track, find;
};

static int compare_pairs(const void *a, const void *b) {
    const struct pair *x = a, *y = b;
    if (x->cost != y->cost) {
        return x->cost < y->cost ? -1 : 1;
    }
    const uint32_t left = x->track != y->track ? x->track : x->find;
    const uint32_t right = x->track != y->track ? y->track : y->find;
    return (left > right) - (left < right);
}

static double gate_of(const struct tracks_settings *settings, const struct track *track) {
    const double size = hypot(track->half_px[0], track->half_px[1]);
    // What was not seen for a while may have turned off meanwhile.
    return (settings->gate_px + settings->gate_sizes * size) * (1.0 + track->unseen_s);
}

static uint32_t list_pairs(const struct tracks *tracks, const struct tracks_settings *settings,
                           const struct track_find *finds, uint32_t find_count, struct pair *pairs,
                           uint32_t capacity) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < TRACKS_MAX; t++) {
        const struct track *track = &tracks->item[t];
        const double gate = gate_of(settings, track);
        for (uint32_t f = 0; f < find_count && track->used; f++) {
            const double off = hypot(finds[f].at[0] - track->at[0], finds[f].at[1] - track->at[1]);
            // Places count first; of two at the same place that of the same size.
            const double size = fabs(log((finds[f].half_px[1] + 1.0) / (track->half_px[1] + 1.0)));
            if (off <= gate && count < capacity) {
                // Tracks that were told go before those that may be noise.
                const double cost = off / gate + 0.3 * size + (track->confirmed ? 0.0 : 0.5);
                pairs[count++] = (struct pair){cost, t, f};
            }
        }
    }
    qsort(pairs, count, sizeof *pairs, compare_pairs);
    return count;
}

static void take(struct track *track, const struct tracks_settings *settings,
                 const struct track_find *find, uint32_t index, double since_s) {
    for (unsigned i = 0; i < 2U; i++) {
        const double surprise = find->at[i] - track->at[i];
        if (since_s > 0.0) {
            const double gain = track->hits == 1U ? 0.5 : settings->speed_gain;
            track->speed_pps[i] += gain * surprise / since_s;
        }
        track->at[i] = find->at[i];
        track->half_px[i] += 0.3 * (find->half_px[i] - track->half_px[i]);
    }
    track->confidence = find->confidence;
    track->hits++;
    track->unseen_s = 0.0;
    track->find = index;
    track->confirmed = track->confirmed || track->hits >= settings->frames_to_confirm;
}

static void begin(struct tracks *tracks, const struct tracks_settings *settings,
                  struct track_find *find, uint32_t index) {
    for (uint32_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = &tracks->item[i];
        if (!track->used) {
            *track = (struct track){.used = true,
                                    .confirmed = settings->frames_to_confirm <= 1U,
                                    .id = tracks->next_id++,
                                    .hits = 1,
                                    .at = {find->at[0], find->at[1]},
                                    .half_px = {find->half_px[0], find->half_px[1]},
                                    .confidence = find->confidence,
                                    .find = index};
            find->track = i;
            return;
        }
    }
}

static void end_unseen(struct tracks *tracks, const struct tracks_settings *settings) {
    for (uint32_t i = 0; i < TRACKS_MAX; i++) {
        struct track *track = &tracks->item[i];
        // One that was never told gets no patience.
        const double keep_s = track->confirmed ? settings->keep_s : 0.0;
        if (track->used && track->find == NONE && track->unseen_s > keep_s) {
            if (track->confirmed) {
                tracks->ended[tracks->ended_count++] = track->id;
            }
            track->used = false;
        }
    }
}

void tracks_update(struct tracks *tracks, const struct tracks_settings *settings,
                   struct track_find *finds, uint32_t find_count, double elapsed_s) {
    const uint32_t pairs_max = 4096;
    tracks->ended_count = 0;
    for (uint32_t t = 0; t < TRACKS_MAX; t++) {
        struct track *track = &tracks->item[t];
        track->at[0] += track->speed_pps[0] * elapsed_s;
        track->at[1] += track->speed_pps[1] * elapsed_s;
        track->unseen_s += elapsed_s;
        track->find = NONE;
    }
    for (uint32_t f = 0; f < find_count; f++) {
        finds[f].track = NONE;
    }
    struct pair *pairs = malloc(pairs_max * sizeof *pairs);
    const uint32_t pair_count =
        pairs == NULL ? 0U : list_pairs(tracks, settings, finds, find_count, pairs, pairs_max);
    for (uint32_t i = 0; i < pair_count; i++) {
        struct track *track = &tracks->item[pairs[i].track];
        struct track_find *find = &finds[pairs[i].find];
        if (track->find == NONE && find->track == NONE) {
            take(track, settings, find, pairs[i].find, track->unseen_s);
            find->track = pairs[i].track;
        }
    }
    free(pairs);
    for (uint32_t f = 0; f < find_count; f++) {
        if (finds[f].track == NONE) {
            begin(tracks, settings, &finds[f], f);
        }
    }
    end_unseen(tracks, settings);
}
