/// The image with a scene in its flash, on the emulated chip: a person types where the gimbal
/// stands, and the gimbal looks where the host says that all of the scene is seen. No tick is
/// missed over it.
#include "mcu/cpu/closed_loop.h"
#include "scene_file.h"

#include "scene/scene_aim.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define IMAGE    "build/boards/stm32f405/scene/boresight.elf"
#define TREE     "build/boards/stm32f405/scene/block.coca"
#define SCENARIO "tests/mcu/cpu/park/scenario.ini"

static struct scene_aim_memory memory;

/// Where the host looks from that place, in millimetres; the tree's unit may be finer.
static void look(const struct tree *tree, const int mm[3], struct scene_aim_result *result) {
    double unit;
    memcpy(&unit, tree->header->unit_double, sizeof unit);
    const double units = 0.001 / unit;
    const struct scene_aim_options options = {
        .eye = {(int32_t)(mm[0] * units), (int32_t)(mm[1] * units), (int32_t)(mm[2] * units)}};
    CHECK_EQ(scene_aim(tree, &options, &memory, result), SCENE_AIM_OK);
}

static void it_looks_where_the_host_does(void) {
    static const int from[3][3] = {{0, 0, 1500}, {-35000, 12250, 30000}, {8000, -5000, 0}};
    struct scene_file file;
    if (!begin_typing(IMAGE, SCENARIO) || !CHECK_EQ(scene_file_open(TREE, &file), EXIT_STATUS_OK)) {
        finish_typing();
        return;
    }
    run_ms(1500);
    type("status\r", 300);
    CHECK(says_last("scene: ", "2000 points; `scene X Y Z` aims at them"));
    for (unsigned i = 0; i < 3U; i++) {
        struct scene_aim_result result;
        look(&file.tree, from[i], &result);
        char line[80], wanted[80];
        snprintf(line, sizeof line, "scene %.3f %.3f %.3f\r", from[i][0] * 1e-3, from[i][1] * 1e-3,
                 from[i][2] * 1e-3);
        type(line, 6000);
        type("status\r", 300);
        const double degrees = ldexp((double)result.cone.half_angle_turn64, -64) * 360.0;
        snprintf(wanted, sizeof wanted, "aimed at; half-angle %d.%02d degrees, %u reads of 2000",
                 (int)degrees, (int)(degrees * 100.0) % 100, (unsigned)result.point_reads);
        CHECK(says_last("scene: ", wanted));
        // The mount looks south: its pan is 0 there.
        const struct controller_status *const status = &sim->pump.output.status;
        const struct vec3 a = result.cone.axis_q30;
        const double pan = atan2(-(double)a.x, -(double)a.y) * 180.0 / acos(-1.0),
                     tilt = asin(a.z * 0x1p-30) * 180.0 / acos(-1.0);
        CHECK(fabs(ldexp((double)status->axis[AXIS_PAN].setpoint_q48, -48) * 360.0 - pan) < 0.001);
        CHECK(fabs(ldexp((double)status->axis[AXIS_TILT].setpoint_q48, -48) * 360.0 - tilt) <
              0.001);
        CHECK(says_last(" us at most, missed ", "0"));
        printf("# from %d %d %d mm: pan %.3f tilt %.3f, %u reads\n", from[i][0], from[i][1],
               from[i][2], pan, tilt, (unsigned)result.point_reads);
    }
    check_note("instructions of a turn of the loop, at most", (int64_t)board.probe.counts.loop_max);
    CHECK(board.probe.counts.loop_max < 168000U);
    scene_file_close(&file);
    finish_typing();
}

static void what_cannot_be_is_told(void) {
    if (begin_typing(IMAGE, SCENARIO)) {
        run_ms(1500);
        type("scene 1 2\r", 300);
        CHECK(strstr(said, "error: expected X Y Z in metres: scene 0 -12.5 1.8") != NULL);
        type("scene 0 -60 3\r", 1000);
        type("status\r", 300);
        CHECK(says_last("scene: ", "no direction sees all of it from there"));
        type("scene 900000 0 0\r", 300);
        type("status\r", 300);
        CHECK(says_last("scene: ", "that is too far away from it"));
        CHECK(says_last(" us at most, missed ", "0"));
    }
    finish_typing();
}

int main(void) {
    TEST(it_looks_where_the_host_does);
    TEST(what_cannot_be_is_told);
    return check_finish();
}
