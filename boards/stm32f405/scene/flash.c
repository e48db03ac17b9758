#include "scene.h"

#include "app/board_scene.h"
#include "compiled_rig.h"

/// From the file, by the linker (boards/boards.mk).
extern const uint32_t scene_block[], scene_block_end[];

static struct board_scene scene;

void scene_open(void) {
    const uintptr_t size = (uintptr_t)scene_block_end - (uintptr_t)scene_block;
    board_scene_open(&scene, scene_block, (uint32_t)size);
    board_scene_hide(&scene, &compiled_rig, &compiled_occlusion);
}

void scene_attach(struct board_loop *loop) {
    board_scene_attach(&scene, loop);
}

void scene_work(struct board_loop *loop) {
    board_scene_work(&scene, loop);
}
