/// Recordings of the controller's inputs: written by the simulator, replayed, and broken in every
/// way.
#include "check.h"

#include "replay/recording.h"
#include "scenario.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct scenario scenario;
static char path_of_recording[] = "/tmp/boresight-recording-XXXXXX";

static char *text;
static size_t text_bytes;

static bool load(void) {
    FILE *file = fopen(path_of_recording, "r");
    if (!CHECK(file != NULL)) {
        return false;
    }
    free(text);
    text = malloc(8U << 20);
    text_bytes = fread(text, 1, 8U << 20, file);
    fclose(file);
    return CHECK(text_bytes > 1000U);
}

static bool record(const char *path, double seconds) {
    struct recorder recorder;
    struct sim *sim = NULL;
    if (!CHECK(scenario_read(path, &scenario) == EXIT_STATUS_OK) ||
        !CHECK(recorder_open(&recorder, path_of_recording))) {
        return false;
    }
    scenario.sim.recorder = &recorder;
    sim = sim_create(&scenario.sim);
    while (sim != NULL && (double)sim->time_us < seconds * 1e6) {
        sim_step(sim);
    }
    const bool ran = CHECK(sim != NULL);
    sim_destroy(sim);
    scenario_free(&scenario);
    return CHECK(recorder_close(&recorder)) && ran && load();
}

static bool replay_text(const char *bytes, size_t size, struct replay *replay) {
    FILE *file = fmemopen((void *)(uintptr_t)bytes, size, "r");
    const bool read = recording_replay(file, replay);
    fclose(file);
    return read;
}

static void a_replay_gives_the_same_bits(void) {
    struct replay replay;
    if (record("host-sim/scenarios/moving.ini", 2.5)) {
        CHECK(replay_text(text, text_bytes, &replay));
        CHECK(replay.same);
        CHECK_EQ(replay.ticks, 2500);
    }
    if (record("host-sim/scenarios/hobby.ini", 9.0)) {
        CHECK(replay_text(text, text_bytes, &replay));
        CHECK(replay.same);
        CHECK_EQ(replay.ticks, 9000);
    }
}

static void any_other_angle_is_noticed(void) {
    struct replay replay;
    if (!record("host-sim/scenarios/moving.ini", 2.0)) {
        return;
    }
    // The last byte of the angle of the pan drive, from the middle on: another half of its range.
    char *at = text + text_bytes / 2U;
    while ((at = strstr(at, " f 241 0 92")) != NULL) {
        at[11 + 12] = at[11 + 12] == '7' ? '0' : '7';
        at += 11;
    }
    CHECK(replay_text(text, text_bytes, &replay));
    CHECK(!replay.same);
    CHECK(replay.differs_by_ticks >= 1000U && replay.differs_by_ticks <= 2000U);
}

static void the_hash_covers_everything_that_moves(void) {
    struct controller_output output;
    memset(&output, 0, sizeof output);
    output.frame_count = 1;
    output.frame[0] = (struct can_frame){.id = 0x141, .length = 8, .data = {1}};
    const uint64_t hash = recording_hash(1, 2, &output);
    CHECK(recording_hash(1, 3, &output) != hash);
    CHECK(recording_hash(2, 2, &output) != hash);
#define DIFFERS(field, value)                                                                      \
    do {                                                                                           \
        struct controller_output other = output;                                                   \
        other.field = value;                                                                       \
        CHECK(recording_hash(1, 2, &other) != hash);                                               \
    } while (false)
    DIFFERS(frame_count, 0);
    DIFFERS(frame[0].id, 0x142);
    DIFFERS(frame[0].flags, 1);
    DIFFERS(frame[0].length, 7);
    DIFFERS(frame[0].data[7], 1);
    DIFFERS(pulse_ns[1], 1);
    DIFFERS(pulse_set[1], true);
    DIFFERS(pulse_channel[2], 3);
    DIFFERS(status.mode, MODE_FAULTED);
    DIFFERS(status.faults, 1);
    DIFFERS(status.axis[0].setpoint_q48, 1);
}

/// A recording with one line more at its end, or instead of its first.
static void refuse_line(const char *line) {
    struct replay replay;
    static char bytes[256];
    const char *end = strchr(strchr(text, '\n') + 1, '\n') + 1; // the heading and `start`
    const size_t head = (size_t)(end - text);
    char *all = malloc(head + sizeof bytes);
    memcpy(all, text, head);
    memcpy(all + head, line, strlen(line));
    CHECK(!replay_text(all, head + strlen(line), &replay));
    CHECK_EQ(replay.line, 3);
    free(all);
}

static void lines_that_are_none_are_named(void) {
    static const char *const lines[] = {"x 1 2\n",
                                        "t 1\n",
                                        "t 1 0 f\n",
                                        "t 1 0 f 141\n",
                                        "t 1 0 f 141 0 1\n",
                                        "t 1 0 f 141 0 0g\n",
                                        "t 1 0 f 20000000 0 00\n",
                                        "t 1 0 f 141 4 00\n",
                                        "t 1 0 f 141 0 001122334455667788\n",
                                        "t 4294967296 0\n",
                                        "t -1 0\n",
                                        "t 1 0 u 00\n",
                                        "t 1 0 v 00\n",
                                        "h 1\n",
                                        "h x 1\n",
                                        "start 00\n",
                                        "t 1 0",
                                        "boresight recording 1\n"};
    if (record("host-sim/scenarios/hobby.ini", 1.0)) {
        for (unsigned i = 0; i < sizeof lines / sizeof *lines; i++) {
            refuse_line(lines[i]);
        }
    }
}

static void a_file_without_its_end_is_no_recording(void) {
    struct replay replay;
    if (!record("host-sim/scenarios/hobby.ini", 1.5)) {
        return;
    }
    size_t cut = text_bytes - 1U;
    while (text[cut - 1U] != '\n') {
        cut--;
    }
    CHECK(!replay_text(text, cut, &replay)); // without the last hash
    CHECK(!replay_text(text, text_bytes - 1U, &replay));
    CHECK(!replay_text("t 1 0\n", 6, &replay)); // a tick before a controller
}

int main(void) {
    const int file = mkstemp(path_of_recording);
    if (file < 0) {
        return EXIT_FAILURE;
    }
    (void)close(file);
    TEST(a_replay_gives_the_same_bits);
    TEST(any_other_angle_is_noticed);
    TEST(the_hash_covers_everything_that_moves);
    TEST(lines_that_are_none_are_named);
    TEST(a_file_without_its_end_is_no_recording);
    free(text);
    (void)unlink(path_of_recording);
    return check_finish();
}
