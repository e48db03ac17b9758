/// Tracks: ids that stay through noise, misses, crossings and a camera that turns, and end when
/// they should.
#include "check.h"

#include "detect/tracks.h"

#include <math.h>
#include <string.h>

static const struct tracks_settings settings = {.first_id = 100,
                                                .frames_to_confirm = 3,
                                                .keep_s = 0.5,
                                                .gate_px = 10.0,
                                                .gate_sizes = 0.5,
                                                .speed_gain = 0.3};
static struct tracks tracks;

static struct track_find find_at(double u, double v, double half_px) {
    return (struct track_find){.at = {u, v}, .half_px = {half_px, half_px}, .confidence = 1.0};
}

/// The id of the confirmed track of a find; 0: none.
static uint32_t id_of(const struct track_find *find) {
    const struct track *track = find->track == UINT32_MAX ? NULL : &tracks.item[find->track];
    return track != NULL && track->confirmed ? track->id : 0U;
}

static void told_when_seen_three_times(void) {
    tracks_init(&tracks, &settings);
    for (unsigned i = 0; i < 5U; i++) {
        struct track_find find = find_at(50.0 + i, 50.0, 5.0);
        tracks_update(&tracks, &settings, &find, 1, 0.1);
        CHECK_EQ(id_of(&find), i < 2U ? 0 : 100);
    }
}

static void noise_that_comes_once_is_never_told(void) {
    uint64_t seed = 5;
    tracks_init(&tracks, &settings);
    for (unsigned i = 0; i < 300U; i++) {
        // Never twice near the same place.
        struct track_find find = find_at((double)(i % 10U) * 60.0, (double)(i / 10U) * 60.0, 2.0);
        (void)check_random(&seed);
        tracks_update(&tracks, &settings, &find, 1, 0.1);
        CHECK_EQ(id_of(&find), 0);
        CHECK_EQ(tracks.ended_count, 0);
    }
}

static void misses_are_bridged_and_then_it_ends(void) {
    tracks_init(&tracks, &settings);
    struct track_find find;
    for (unsigned i = 0; i < 20U; i++) { // 100 pixels a second; not seen for 0.4 s on the way
        find = find_at(10.0 * i, 50.0, 4.0);
        tracks_update(&tracks, &settings, &find, i >= 10U && i < 14U ? 0 : 1, 0.1);
    }
    CHECK_EQ(id_of(&find), 100);
    unsigned frames = 0;
    while (tracks.ended_count == 0U && frames < 20U) {
        tracks_update(&tracks, &settings, NULL, 0, 0.1);
        frames++;
    }
    CHECK(frames >= 5U && frames <= 6U);
    CHECK_EQ(tracks.ended[0], 100);
    find = find_at(200.0, 50.0, 4.0);
    for (unsigned i = 0; i < 3U; i++) {
        tracks_update(&tracks, &settings, &find, 1, 0.1);
    }
    CHECK_EQ(id_of(&find), 101); // never the old one again
}

/// Two that pass each other 6 pixels apart, in either order of the list.
static void ids_stay_when_paths_cross(void) {
    tracks_init(&tracks, &settings);
    for (unsigned i = 0; i < 40U; i++) {
        struct track_find finds[2] = {find_at(20.0 + 6.0 * i, 50.0, 4.0),
                                      find_at(260.0 - 6.0 * i, 56.0, 4.0)};
        if (i % 2U == 1U) {
            const struct track_find first = finds[0];
            finds[0] = finds[1];
            finds[1] = first;
        }
        tracks_update(&tracks, &settings, finds, 2, 0.1);
        if (i >= 3U) {
            CHECK_EQ(id_of(&finds[i % 2U]), 100);
            CHECK_EQ(id_of(&finds[1U - i % 2U]), 101);
        }
    }
}

static void shift_right(void *context, double pixel[2]) {
    (void)context;
    pixel[0] += 80.0;
}

static void tracks_turn_with_the_camera(void) {
    tracks_init(&tracks, &settings);
    struct track_find find = find_at(50.0, 50.0, 4.0);
    for (unsigned i = 0; i < 4U; i++) {
        tracks_update(&tracks, &settings, &find, 1, 0.1);
    }
    tracks_move(&tracks, shift_right, NULL);
    find = find_at(130.0, 50.0, 4.0);
    tracks_update(&tracks, &settings, &find, 1, 0.1);
    CHECK_EQ(id_of(&find), 100);
}

static void more_than_fit_have_no_track(void) {
    static struct track_find finds[TRACKS_MAX + 5];
    tracks_init(&tracks, &settings);
    for (unsigned i = 0; i < TRACKS_MAX + 5U; i++) {
        finds[i] = find_at(40.0 * (i % 12U), 40.0 * (i / 12U), 4.0);
    }
    for (unsigned k = 0; k < 3U; k++) {
        tracks_update(&tracks, &settings, finds, TRACKS_MAX + 5U, 0.1);
    }
    unsigned without = 0;
    for (unsigned i = 0; i < TRACKS_MAX + 5U; i++) {
        without += finds[i].track == UINT32_MAX;
    }
    CHECK_EQ(without, 5);
}

int main(void) {
    TEST(told_when_seen_three_times);
    TEST(noise_that_comes_once_is_never_told);
    TEST(misses_are_bridged_and_then_it_ends);
    TEST(ids_stay_when_paths_cross);
    TEST(tracks_turn_with_the_camera);
    TEST(more_than_fit_have_no_track);
    return check_finish();
}
