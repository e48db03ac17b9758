/// A scene in flash, in the time that ticks leave over: aims at everything that it holds, and lets
/// its solids and faces hide targets.
///
/// A person or a program says `scene X Y Z` (link/request.h): where the gimbal stands in the scene.
/// The search then goes on in small steps after each tick, and its cone becomes the target, as
/// `aim` does it. `status` has a line about it. If the rig says what hidden targets count
/// ([occlusion]), what stands between the mount and a target hides it. Optional: an image without
/// it has no code of it. Shown: tests/unit/test_board_scene.c, tests/mcu/cpu/scene.c (in the image,
/// on the emulated chip).
#ifndef APP_BOARD_SCENE_H
#define APP_BOARD_SCENE_H

#include "app/board_loop.h"
#include "app/board_shadows.h"
#include "scene/scene_aim.h"

/// After so much of a tick no step is begun.
#define BOARD_SCENE_UNTIL_US 450U

/// About 70 KB.
struct board_scene {
    struct tree tree;
    const char *refusal; ///< why there is no scene; NULL: there is one
    bool runs;
    struct board_scene_mail mail;
    struct scene_aim_run run;
    struct scene_aim_result result;
    union { ///< a search begins after the shadows are cast
        struct scene_aim_memory memory;
        struct board_shadows_memory casting;
    };
    struct board_shadows shadows;
    enum board_shadows_status hides; ///< what became of them
    bool asked_to_hide;
    char told[96];   ///< for `status`
    char hidden[96]; ///< likewise, of hidden targets; empty: nothing hides any
};

/// Checks the tree, which stays where it is. Before the watchdog runs: it takes about 20 cycles a
/// byte. A damaged one is told by `status`, and the rest works.
void board_scene_open(struct board_scene *scene, const void *block, uint32_t size_bytes);

/// Casts the shadows of its solids, if the settings ask for it. After board_scene_open; takes some
/// milliseconds. What can't be had is told by `status`, and nothing is hidden.
void board_scene_hide(struct board_scene *scene, const struct controller_config *rig,
                      const struct occlusion_settings *settings);

/// From now on the loop's commands reach it, and targets may be hidden. After board_loop_init.
void board_scene_attach(struct board_scene *scene, struct board_loop *loop);

/// After each board_loop_tick.
void board_scene_work(struct board_scene *scene, struct board_loop *loop);

/// Micrometres in units of the tree, rounded down. False: beyond TREE_COORDINATE_MAX.
bool board_scene_units(const struct tree *tree, int64_t um, int32_t *units);

#endif
