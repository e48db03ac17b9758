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

/// Whichever way it goes, 100 pixels a second; not seen for 0.4 s on the way.
static void misses_are_bridged_and_then_it_ends(void) {
    static const double ways[][2] = {{10.0, 0.0}, {0.0, 10.0}, {-6.0, 8.0}, {8.0, -6.0}};
    for (unsigned way = 0; way < 4U; way++) {
        tracks_init(&tracks, &settings);
        struct track_find find;
        for (unsigned i = 0; i < 20U; i++) {
            find = find_at(ways[way][0] * i, 50.0 + ways[way][1] * i, 4.0);
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
        tracks_update(&tracks, &settings, NULL, 0, 0.1);
        CHECK_EQ(tracks.ended_count, 0); // told once
        find = find_at(200.0, 50.0, 4.0);
        for (unsigned i = 0; i < 3U; i++) {
            tracks_update(&tracks, &settings, &find, 1, 0.1);
        }
        CHECK_EQ(id_of(&find), 101); // never the old one again
    }
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
            CHECK_EQ(tracks.item[finds[0].track].find, 0);
            CHECK_EQ(tracks.item[finds[1].track].find, 1);
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

/// A track that stands still at 300, 300, its box 60 by 80 pixels: half its diagonal is 50.
static void begin_still(void) {
    tracks_init(&tracks, &settings);
    for (unsigned i = 0; i < 5U; i++) {
        struct track_find find = {.at = {300.0, 300.0}, .half_px = {30.0, 40.0}};
        tracks_update(&tracks, &settings, &find, 1, 0.1);
    }
}

/// 10 pixels and half of its size: 35 pixels, whichever way.
static void the_gate_is_as_wide_as_told(void) {
    for (unsigned i = 0; i < 16U; i++) {
        const double x = cos(i * 0.3927), y = sin(i * 0.3927);
        begin_still();
        struct track_find find = find_at(300.0 + 34.9 * x, 300.0 + 34.9 * y, 40.0);
        tracks_update(&tracks, &settings, &find, 1, 0.0);
        CHECK_EQ(id_of(&find), 100);
        begin_still();
        find = find_at(300.0 + 35.1 * x, 300.0 + 35.1 * y, 40.0);
        tracks_update(&tracks, &settings, &find, 1, 0.0);
        CHECK_EQ(id_of(&find), 0); // a new one
        // It may be farther away if nobody has looked for a while.
        begin_still();
        tracks_update(&tracks, &settings, NULL, 0, 0.4);
        find = find_at(300.0 + 35.1 * x, 300.0 + 35.1 * y, 40.0);
        tracks_update(&tracks, &settings, &find, 1, 0.0);
        CHECK_EQ(id_of(&find), 100);
    }
}

/// Its box is that of the first find, then on its way to those that come, each side for itself.
static void the_box_follows(void) {
    begin_still();
    const struct track *track = &tracks.item[0];
    CHECK(fabs(track->half_px[0] - 30.0) < 1e-9 && fabs(track->half_px[1] - 40.0) < 1e-9);
    double before[2] = {30.0, 40.0};
    for (unsigned i = 0; i < 40U; i++) {
        struct track_find find = {.at = {300.0, 300.0}, .half_px = {36.0, 20.0}};
        tracks_update(&tracks, &settings, &find, 1, 0.1);
        CHECK(track->half_px[0] > before[0] && track->half_px[0] <= 36.0);
        CHECK(track->half_px[1] < before[1] && track->half_px[1] >= 20.0);
        before[0] = track->half_px[0];
        before[1] = track->half_px[1];
    }
    CHECK(fabs(before[0] - 36.0) < 0.01 && fabs(before[1] - 20.0) < 0.01);
}

static void told_at_once_if_so_set(void) {
    struct tracks_settings once = settings;
    once.frames_to_confirm = 1;
    tracks_init(&tracks, &once);
    struct track_find find = find_at(50.0, 50.0, 5.0);
    tracks_update(&tracks, &once, &find, 1, 0.1);
    CHECK_EQ(id_of(&find), 100);
}

/// Two that are equally near: the first in the list, every time; and of two tracks the first.
static void ties_are_broken_by_order(void) {
    for (unsigned turn = 0; turn < 4U; turn++) {
        const double x = turn == 0U   ? 6.0
                         : turn == 1U ? -6.0
                                      : 0.0,
                     y = turn == 2U   ? 6.0
                         : turn == 3U ? -6.0
                                      : 0.0;
        begin_still();
        struct track_find finds[2] = {find_at(300.0 + x, 300.0 + y, 40.0),
                                      find_at(300.0 - x, 300.0 - y, 40.0)};
        tracks_update(&tracks, &settings, finds, 2, 0.0);
        CHECK_EQ(id_of(&finds[0]), 100);
        CHECK_EQ(id_of(&finds[1]), 0);

        tracks_init(&tracks, &settings);
        for (unsigned i = 0; i < 3U; i++) {
            finds[0] = find_at(300.0 + x, 300.0 + y, 40.0);
            finds[1] = find_at(300.0 - x, 300.0 - y, 40.0);
            tracks_update(&tracks, &settings, finds, 2, 0.1);
        }
        struct track_find middle = find_at(300.0, 300.0, 40.0);
        tracks_update(&tracks, &settings, &middle, 1, 0.0);
        CHECK_EQ(id_of(&middle), 100);
    }
}

/// More pairs than there is room for: no track is two finds', and nothing is written beyond.
static void a_crowd_at_one_place(void) {
    static struct track_find finds[TRACKS_MAX];
    tracks_init(&tracks, &settings);
    for (unsigned k = 0; k < 3U; k++) {
        bool used[TRACKS_MAX] = {false};
        for (unsigned i = 0; i < TRACKS_MAX; i++) {
            finds[i] = find_at(300.0 + i * 0.01, 300.0, 4.0);
        }
        tracks_update(&tracks, &settings, finds, TRACKS_MAX, 0.0);
        for (unsigned i = 0; i < TRACKS_MAX; i++) {
            const uint32_t track = finds[i].track;
            CHECK(track == UINT32_MAX || (track < TRACKS_MAX && !used[track]));
            used[track % TRACKS_MAX] = track != UINT32_MAX;
        }
    }
}

int main(void) {
    TEST(told_when_seen_three_times);
    TEST(noise_that_comes_once_is_never_told);
    TEST(misses_are_bridged_and_then_it_ends);
    TEST(ids_stay_when_paths_cross);
    TEST(tracks_turn_with_the_camera);
    TEST(more_than_fit_have_no_track);
    TEST(the_gate_is_as_wide_as_told);
    TEST(the_box_follows);
    TEST(told_at_once_if_so_set);
    TEST(ties_are_broken_by_order);
    TEST(a_crowd_at_one_place);
    return check_finish();
}
