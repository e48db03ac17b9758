#include "scene.h"

void scene_open(void) {}

void scene_attach(struct board_loop *loop) {
    (void)loop;
}

void scene_work(struct board_loop *loop) {
    (void)loop;
}
