/// `boresight run` with a scene that hides targets, tick by tick: an obstacle stands between the
/// camera and people who walk, and the aim stays calm. The code of `run`, simulated drives, and no
/// clock: as fast as it goes, the same each time.
#include "check.h"

#include "runner.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCENE   "tests/mcu/cpu/hidden/yard.scene"
#define SECONDS 12
#define PEOPLE  5

/// How the camera moved from 2.5 s on.
struct motion {
    double turned_deg, rate_max_dps, hidden_percent;
};

static bool write_file(char *path, void fill(FILE *stream, const char *text), const char *text) {
    const int handle = mkstemp(path);
    FILE *const stream = handle < 0 ? NULL : fdopen(handle, "w");
    if (!CHECK(stream != NULL)) {
        return false;
    }
    fill(stream, text);
    return CHECK(fclose(stream) == 0);
}

static void fill_rig(FILE *stream, const char *section) {
    char line[256];
    FILE *const from = fopen("host-sim/rigs/moving.ini", "r");
    while (CHECK(from != NULL) && fgets(line, sizeof line, from) != NULL) {
        fputs(line, stream);
    }
    fprintf(stream, "\n[occlusion]\n%s", section);
    if (from != NULL) {
        fclose(from);
    }
}

/// Five people walk from left to right at 1 m/s, 20 m away; the pillar is halfway.
static void fill_targets(FILE *stream, const char *text) {
    static const double start_m[PEOPLE][2] = {{-7, 20}, {-5, 22}, {-4, 20}, {-2, 21}, {-9, 21}};
    (void)text;
    for (int frame = 0; frame < 20 * SECONDS; frame++) {
        for (int i = 0; i < PEOPLE; i++) {
            fprintf(stream, "{\"t_us\": %d, \"id\": %d, \"xyz\": [%.3f, %.3f, 0]}\n", frame * 50000,
                    i + 1, start_m[i][0] + frame * 0.05, start_m[i][1]);
        }
    }
}

static struct motion walk(const char *section) {
    char rig[] = "build/hidden-rig-XXXXXX", targets[] = "build/hidden-targets-XXXXXX";
    struct motion motion = {0, 0, 0};
    struct runner *const runner = calloc(1, sizeof *runner);
    if (!CHECK(runner != NULL) || !write_file(rig, fill_rig, section) ||
        !write_file(targets, fill_targets, NULL)) {
        free(runner);
        return motion;
    }
    const struct runner_settings settings = {.command = "run",
                                             .rig_file = rig,
                                             .targets = targets,
                                             .scene = SCENE,
                                             .limit_us = SECONDS * 1000000U,
                                             .arm = true,
                                             .hurry = true};
    if (CHECK_EQ(runner_start(runner, &settings), EXIT_STATUS_OK)) {
        double last = 0;
        while (runner_tick(runner) && !runner->stopping) {
            const double pan = sim_joint_deg(runner->sim, AXIS_PAN), way = fabs(pan - last);
            if (runner->sim->time_us % 10000U != 0U) {
                continue;
            }
            last = pan;
            if (runner->sim->time_us > 2500000U) {
                motion.turned_deg += way;
                motion.rate_max_dps = fmax(motion.rate_max_dps, way * 100.0);
            }
        }
        const struct sim_summary summary = sim_summarise(runner->sim);
        CHECK_EQ(sim_violation_count(&summary.violations), 0);
        motion.hidden_percent = summary.hidden_percent;
    }
    runner_close(runner);
    free(runner);
    unlink(rig);
    unlink(targets);
    printf(
        "MEASURED %.*s: turned %.2f deg in all, at most %.2f deg/s; hidden %.1f %% of all looks\n",
        (int)strcspn(section, "\n"), section, motion.turned_deg, motion.rate_max_dps,
        motion.hidden_percent);
    return motion;
}

static void calm_past_an_obstacle(void) {
    const struct motion ignore = walk("policy = ignore\n"), drop = walk("policy = drop\n"),
                        calm = walk("policy = calm\n"),
                        weigh = walk("policy = weigh\nhidden_percent = 30\n");
    CHECK(ignore.hidden_percent == 0.0 && drop.hidden_percent > 5.0);
    CHECK(calm.hidden_percent == drop.hidden_percent);
    CHECK(drop.turned_deg > ignore.turned_deg + 5.0);
    CHECK(drop.rate_max_dps > 3.0 * ignore.rate_max_dps);
    CHECK(calm.turned_deg < 1.05 * ignore.turned_deg + 0.2);
    CHECK(calm.rate_max_dps < 1.3 * ignore.rate_max_dps);
    CHECK(weigh.turned_deg < 1.05 * ignore.turned_deg + 0.2);
}

/// A reload with a scene that can't be used changes nothing; a run with one does not begin.
static void a_scene_that_is_not_there(void) {
    char rig[] = "build/hidden-rig-XXXXXX";
    struct runner *const runner = calloc(1, sizeof *runner);
    if (CHECK(runner != NULL) && write_file(rig, fill_rig, "scene = nowhere.scene\n")) {
        const struct runner_settings settings = {
            .command = "run", .rig_file = rig, .limit_us = 1000000U, .hurry = true};
        CHECK_EQ(runner_start(runner, &settings), EXIT_STATUS_USAGE);
        runner_close(runner);
        unlink(rig);
    }
    free(runner);
}

int main(void) {
    TEST(calm_past_an_obstacle);
    TEST(a_scene_that_is_not_there);
    return check_finish();
}
