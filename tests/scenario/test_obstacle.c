/// An obstacle passes between the camera and its targets: the aim stays calm. And hidden targets do
/// not count, for good, when they stay hidden.
#include "check.h"

#include "scenario.h"
#include "view/scene_lines.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// How the camera moved from 5 s to 20 s.
struct motion {
    double path_deg, rate_max_dps, hidden_part, end_deg;
};

static struct motion measure(const char *path, const char *name) {
    struct motion motion = {0, 0, 0, 0};
    struct scenario scenario;
    const bool read = CHECK(scenario_read(path, &scenario) == EXIT_STATUS_OK);
    struct sim *const sim = read ? sim_create(&scenario.sim) : NULL;
    double last = 0, moments = 0, hidden = 0;
    while (CHECK(sim != NULL) && sim->time_us < 20000000U) {
        sim_step(sim);
        if (sim->time_us % 10000U != 0U) {
            continue;
        }
        const double pan = sim_joint_deg(sim, AXIS_PAN), way = fabs(pan - last);
        last = pan;
        for (uint32_t i = 0; i < sim->occlusion.target_count; i++) {
            moments++;
            hidden += sim->occlusion.target[i].samples == 0U;
        }
        if (sim->time_us > 5000000U) {
            motion.path_deg += way;
            motion.rate_max_dps = fmax(motion.rate_max_dps, way * 100.0);
        }
    }
    motion.end_deg = last;
    motion.hidden_part = moments > 0 ? hidden / moments : 0;
    if (sim != NULL) {
        const struct sim_summary summary = sim_summarise(sim);
        CHECK_EQ(sim_violation_count(&summary.violations), 0);
    }
    sim_destroy(sim);
    scenario_free(&scenario);
    printf("MEASURED %s: pan moves %.2f deg in all, at most %.2f deg/s; targets hidden %.1f %% of "
           "the time\n",
           name, motion.path_deg, motion.rate_max_dps, 100.0 * motion.hidden_part);
    return motion;
}

#define RIG "rig = ../host-sim/rigs/moving.ini\n"

/// Writes a scenario, runs it, and removes it.
static struct motion run(const char *base, const char *text, const char *settings,
                         const char *name) {
    char path[] = "build/obstacle-XXXXXX";
    char line[256];
    const int file = mkstemp(path);
    FILE *const from = base != NULL ? fopen(base, "r") : NULL;
    FILE *const to = file < 0 ? NULL : fdopen(file, "w");
    if (!CHECK((base == NULL || from != NULL) && to != NULL)) {
        return (struct motion){0, 0, 0, 0};
    }
    while (from != NULL && fgets(line, sizeof line, from) != NULL) {
        const bool rig = strncmp(line, "rig = ", 6) == 0;
        fputs(rig ? RIG : line, to);
    }
    fprintf(to, "%s\n[occlusion]\n%s", text, settings);
    if (from != NULL) {
        fclose(from);
    }
    fclose(to);
    const struct motion motion = measure(path, name);
    remove(path);
    return motion;
}

static void calm_while_an_obstacle_passes(void) {
    const char *const file = "host-sim/scenarios/obstacle.ini";
    const struct motion ignore = run(file, "", "policy = ignore\n", "no van"),
                        drop = run(file, "", "policy = drop\n", "a van, hidden ones dropped"),
                        calm = run(file, "", "policy = calm\n", "a van, calm");
    CHECK(calm.hidden_part > 0.05 && drop.hidden_part > 0.05);
    // Without care the camera swings after those in sight; calm, it moves as if there were no van.
    CHECK(drop.path_deg > 10.0 + ignore.path_deg && drop.rate_max_dps > 5.0 * ignore.rate_max_dps);
    CHECK(calm.path_deg < 1.1 * ignore.path_deg + 0.5);
    CHECK(calm.rate_max_dps < 1.5 * ignore.rate_max_dps + 0.2);
}

/// One of two walks behind a wall and stays there: both policies end on the other one, calm goes
/// there before and slowly.
static void hidden_for_good(void) {
    const char *const text = "[scenario]\nname = wall\n" RIG "seconds = 24\n"
                             "[obstacle wall]\nsize_m = 30, 0.5, 6\nstart_m = 17.5, 15, 0\n"
                             "[mover ann]\nid = 1\nstart_m = -6, 20, 0\n"
                             "[mover bob]\nid = 2\nstart_m = -7, 20, 0\nvelocity_mps = 1, 0, 0\n";
    const struct motion drop = run(NULL, text, "policy = drop\n", "a wall, hidden ones dropped"),
                        calm = run(NULL, text, "policy = calm\nahead_s = 4\nfade_s = 2.5\n",
                                   "a wall, calm");
    const double ann_deg = atan2(-6, 20) * 180.0 / acos(-1.0);
    CHECK(fabs(drop.end_deg - ann_deg) < 0.1 && fabs(calm.end_deg - ann_deg) < 0.1);
    CHECK(calm.rate_max_dps < 0.5 * drop.rate_max_dps);
}

/// The demo's flight: everyone stays in the picture though each is hidden again and again, and the
/// picture has the city's lines, within twice the sensor.
static void flight(void) {
    struct scenario scenario;
    const bool read =
        CHECK(scenario_read("host-sim/scenarios/flight.ini", &scenario) == EXIT_STATUS_OK);
    struct sim *const sim = read ? sim_create(&scenario.sim) : NULL;
    uint64_t hidden = 0;
    while (CHECK(sim != NULL) && sim->time_us < scenario.duration_us) {
        sim_step(sim);
        for (uint32_t i = 0; i < sim->occlusion.target_count && sim->time_us % 40000U == 0U; i++) {
            hidden += sim->occlusion.target[i].samples == 0U;
        }
        if (sim->time_us % 3000000U == 0U) {
            const struct sim_view view = sim_observe(sim);
            size_t count;
            struct report_line *const lines = scene_lines(sim, &view, 4.8, 3.6, &count);
            CHECK(lines != NULL && count > 8U && count < 200U);
            for (size_t i = 0; lines != NULL && i < count; i++) {
                CHECK(fabs(lines[i].x0_mm) < 4.81 && fabs(lines[i].y1_mm) < 3.61);
            }
            free(lines);
        }
    }
    if (sim != NULL) {
        const struct sim_summary summary = sim_summarise(sim);
        CHECK_EQ(sim_violation_count(&summary.violations), 0);
        CHECK(summary.in_frame_percent > 99.0 && summary.targets == 4U);
        CHECK(hidden > 200U); // of 4 x 600 looks
        printf("MEASURED flight: hidden %.0f %% of the time, in the picture %.2f %%\n",
               (double)hidden / 24.0, summary.in_frame_percent);
    }
    sim_destroy(sim);
    scenario_free(&scenario);
}

int main(void) {
    TEST(calm_while_an_obstacle_passes);
    TEST(hidden_for_good);
    TEST(flight);
    return check_finish();
}
