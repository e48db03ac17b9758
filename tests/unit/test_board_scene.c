/// The scene of a board's console: where the viewpoint is in the scene's units, and what is told.
/// tests/mcu/cpu/scene.c has the whole image.
#include "unit/desk.h"

#include "app/board_scene.h"

/// Two points, 10 m north and 2 m to each side, in millimetres.
static struct {
    struct tree_header header;
    struct tree_node node;
    struct tree_description description;
    struct tree_point point[2];
} block;

static struct board_scene scene;

static void set_unit(uint32_t high, uint32_t low) {
    block.header.unit_double[1] = high;
    block.header.unit_double[0] = low;
}

static void make_block(void) {
    const size_t covered = offsetof(struct tree_header, node_count);
    block.node = (struct tree_node){0, 10000, 0, 2000, 0, 1, TREE_NONE};
    block.description = (struct tree_description){.kind = TREE_POINTS, .count = 2};
    block.point[0] = (struct tree_point){-2000, 10000, 0, 0};
    block.point[1] = (struct tree_point){2000, 10000, 0, 1};
    block.header = (struct tree_header){.magic = TREE_MAGIC,
                                        .version = TREE_VERSION,
                                        .size_bytes = sizeof block,
                                        .node_count = 1,
                                        .description_count = 1,
                                        .point_count = 2,
                                        .level_count = 1,
                                        .source_count = 2};
    set_unit(0x3F50624D, 0xD2F1A9FC); // 0.001
    block.header.crc32 = tree_crc32(0, (const uint8_t *)&block + covered, sizeof block - covered);
}

static void units(void) {
    int32_t got;
    scene.tree.header = &block.header;
    make_block();
    CHECK(board_scene_units(&scene.tree, 12345678, &got) && got == 12345); // down to 12.345 m
    CHECK(board_scene_units(&scene.tree, -12345678, &got) && got == -12345);
    CHECK(board_scene_units(&scene.tree, 0, &got) && got == 0);
    CHECK(!board_scene_units(&scene.tree, INT64_C(1100000) * 1000000, &got));
    set_unit(0x3FF00000, 0); // 1
    CHECK(board_scene_units(&scene.tree, INT64_C(17592186044415), &got) && got == 17592186);
    CHECK(board_scene_units(&scene.tree, INT64_C(1073741823) * 1000000, &got));
    CHECK(!board_scene_units(&scene.tree, INT64_C(1073741824) * 1000000, &got));
    set_unit(0x3EB0C6F7, 0xA0B5ED8D); // 10^-6
    CHECK(board_scene_units(&scene.tree, -7, &got) && (got == -7 || got == -6));
    CHECK(board_scene_units(&scene.tree, 1000000000, &got) && got >= 999999999);
    CHECK(!board_scene_units(&scene.tree, 1100000000, &got));
    set_unit(0x3DDB7CDF, 0xD9D7BDBB); // 10^-10
    CHECK(board_scene_units(&scene.tree, 1000, &got) && got >= 9999998 && got <= 10000000);
    set_unit(0x412E8480, 0); // 10^6
    CHECK(board_scene_units(&scene.tree, INT64_C(7000001000000), &got) && got == 7);
    set_unit(0x42F00000, 0); // 2^48
    CHECK(board_scene_units(&scene.tree, INT64_C(7000001000000), &got) && got == 0);
    set_unit(0, 0); // no unit at all, infinity, less than nothing
    CHECK(!board_scene_units(&scene.tree, 1, &got));
    set_unit(0x7FF00000, 0);
    CHECK(!board_scene_units(&scene.tree, 1, &got));
    set_unit(0xBFF00000, 0);
    CHECK(!board_scene_units(&scene.tree, 1, &got));
    set_unit(0x00100000, 0); // 2^-1022
    CHECK(!board_scene_units(&scene.tree, 1, &got));
}

static void begin(void) {
    desk_configure();
    desk_start(0);
    board_scene_attach(&scene, &desk_loop);
    desk_ticks(100);
    desk_type("\r");
    desk_ticks(10);
}

/// Types a line; does what it asks for; then asks how it is.
static bool ask(const char *line, const char *answer) {
    desk_forget();
    desk_type(line);
    for (int i = 0; i < 40; i++) {
        desk_ticks(1);
        board_scene_work(&scene, &desk_loop);
    }
    desk_type("status\r");
    desk_ticks(40);
    return desk_says(answer);
}

static void it_aims(void) {
    make_block();
    board_scene_open(&scene, &block, sizeof block);
    begin();
    CHECK(ask("\r", "\r\nscene: 2 points; `scene X Y Z` aims at them\r\n"));
    CHECK(ask("scene 2 0 0\r", "\r\nscene: aimed at; half-angle 10.90 degrees, "));
    CHECK(desk_says("targets: 1, "));
    CHECK(ask("scene 0 10 0\r", "\r\nscene: no direction sees all of it from there\r\n"));
    CHECK(ask("scene -2 10 0\r", "\r\nscene: a point of it is at that place\r\n"));
    CHECK(ask("scene 900000 0 9900000\r", "\r\nscene: that is too far away from it\r\n") ||
          desk_says("error: expected X Y Z in metres"));
}

static void damaged_or_none(void) {
    make_block();
    block.point[1].x ^= 1;
    board_scene_open(&scene, &block, sizeof block);
    begin();
    CHECK(ask("scene 0 0 0\r", "\r\nscene: damaged at offset 12\r\n"));
    CHECK(desk_says("targets: 0, "));
    desk_configure();
    desk_start(0); // nothing attached
    desk_ticks(100);
    desk_type("scene 0 0 0\r");
    desk_ticks(30);
    CHECK(desk_says("error: this image has no scene; see boards/README.md\r\n"));
}

int main(void) {
    TEST(units);
    TEST(it_aims);
    TEST(damaged_or_none);
    return check_finish();
}
