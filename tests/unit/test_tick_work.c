/// The work of a tick with 256 moving targets: what the controller spends on the aim stays within
/// its bound, also on sets made to be hard, and the frame always holds every target. In reads of
/// about 20 instructions of a Cortex-M4; measured on that core, ticks with CONTROLLER_UPDATES_MAX
/// updates and CONTROLLER_FRAMES_IN_MAX frames took at most 90,200 instructions on these sets.
#include "rig.h"

#include "fixed/trig_fine.h"

/// A call of follow_narrowest under the controller's limit (tests/unit/test_follow.c).
#define WORK_MOST 6000U

static uint64_t seed = UINT64_C(0x5EED0032);

enum shape { SPREAD, CIRCLE, SMALL_CIRCLE, TINY_CIRCLE, SPIRAL, SHAPES };

/// A place 20 m north, up to 8 m off; all turn round the axis.
static struct target_update update(enum shape shape, uint32_t id, uint32_t tick, bool sized) {
    const struct sincos turn = trig_sincos(bam32(id * UINT32_C(0x1000000) + tick * 0x20000U));
    static const int64_t off_um[SHAPES] = {0, 8000000, 80000, 800, 30000};
    int64_t x = off_um[shape] * turn.cos_q30 >> 30, z = off_um[shape] * turn.sin_q30 >> 30;
    if (shape == SPREAD) {
        x = (int64_t)(check_random(&seed) % 16000000U) - 8000000;
        z = (int64_t)(check_random(&seed) % 16000000U) - 8000000;
    } else if (shape == SPIRAL) {
        x *= id + 1U;
        z *= id + 1U;
    }
    return (struct target_update){.kind = TARGET_POSITION,
                                  .id = id,
                                  .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                  .position_um = {x, 20000000, z},
                                  .radius_um = sized ? id % 3U * 1000U : 0U};
}

static void check_frame(void) {
    const struct target_set *set = &rig.controller.targets;
    const struct framing *framing = &rig.output.status.framing;
    if (framing->status != FRAMING_OK) {
        return;
    }
    for (uint32_t i = 0; i < set->count; i++) {
        const uint64_t reach = trig_fine_angle_q30(framing->ahead_q30, set->direction_q30[i]) +
                               ((uint64_t)set->target[i].radius_bam32 << 32);
        CHECK(reach <= ((uint64_t)framing->half_angle_bam32.bam << 32) + 2048U);
    }
}

static void run(enum shape shape, bool sized) {
    const uint32_t ticks = 300;
    uint32_t most = 0, solved = 0;
    uint64_t sum = 0;
    rig_init();
    rig_arm();
    for (uint32_t tick = 0; tick < ticks && check_clean(); tick++) {
        const uint32_t updates = CONTROLLER_UPDATES_MAX - 1U; // one more, and the aim would wait
        for (uint32_t i = 0; i < updates; i++) {
            rig_update(update(shape, (tick * updates + i) % 256U, tick, sized));
        }
        rig_tick();
        const uint32_t work = rig.output.status.framing.work;
        most = work > most ? work : most;
        sum += work;
        solved += rig.output.status.framing.status == FRAMING_OK;
        if (work != 0U && rig.controller.framed_version == rig.controller.targets.version &&
            !rig.output.status.framing.refining) {
            check_frame();
        }
    }
    check_note(sized ? "radii, work of a tick, most" : "points, work of a tick, most", most);
    check_note("  on average", (int64_t)(sum / ticks));
    CHECK(most <= WORK_MOST);
    CHECK(solved == ticks);
    // At rest the search comes to its end.
    for (uint32_t i = 0; i < 40U && rig.output.status.framing.refining; i++) {
        rig_tick();
    }
    CHECK(!rig.output.status.framing.refining);
    check_frame();
    const uint32_t aims = rig.output.status.aims_solved;
    rig_ticks(10);
    CHECK_EQ(rig.output.status.aims_solved, aims);
}

static void moving_points(void) {
    for (unsigned shape = 0; shape < SHAPES; shape++) {
        run((enum shape)shape, false);
    }
}

static void moving_spheres(void) {
    for (unsigned shape = 0; shape < SHAPES; shape++) {
        run((enum shape)shape, true);
    }
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(moving_points);
    TEST(moving_spheres);
    return check_finish();
}
