/// The scene in the image: scene/none.c where there is none, scene/flash.c with one.
#ifndef STM32F405_SCENE_H
#define STM32F405_SCENE_H

#include "app/board_loop.h"

/// Checks it, and casts its shadows if the rig asks for it; before the watchdog runs.
void scene_open(void);

void scene_attach(struct board_loop *loop);

/// After each tick.
void scene_work(struct board_loop *loop);

#endif
