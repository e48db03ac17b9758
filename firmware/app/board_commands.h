/// What a command does on a board, whoever gave it: a person at the console or a program.
#ifndef APP_BOARD_COMMANDS_H
#define APP_BOARD_COMMANDS_H

#include "app/board_settings.h"
#include "app/pump.h"
#include "link/request.h"

/// Where a command for the scene waits until there is time for it (board_scene.h).
struct board_scene_mail {
    bool asked;
    struct vec3_i64 viewpoint_um;
};

struct board_commands {
    struct pump *pump;
    struct board_settings *settings;
    bool aims;                      ///< the target of `aim` and `home` is in the set
    struct board_scene_mail *scene; ///< NULL: the image has no scene
};

/// Does it, except what only concerns a console (help, status, trace). Bounded: at most three
/// updates.
/// held:    why the board must not arm, or NULL.
/// answer:  what `get` found is added to it.
/// Returns: NULL, or why it was not done.
/// Shown: tests/unit/test_board_console.c.
const char *board_commands_do(struct board_commands *commands, const struct request *request,
                              const char *held, struct text *answer) MUST_CHECK;

/// One target of a program. False: the pump's queue is full.
bool board_commands_update(struct board_commands *commands,
                           const struct target_update *update) MUST_CHECK;

/// Stops, and forgets every target.
void board_commands_stop_and_forget(struct board_commands *commands);

#endif
