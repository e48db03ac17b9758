/// The settings that a person or a program may change while the board runs, until the next reset.
///
/// Names and units are those of a rig file. How targets are followed can be changed at any time;
/// limits and speeds only while no axis is driven, and only to be stricter than the rig that the
/// image was built for: a console must not be the way past a limit.
/// Shown: tests/unit/test_board_settings.c.
#ifndef APP_BOARD_SETTINGS_H
#define APP_BOARD_SETTINGS_H

#include "control/controller.h"
#include "fixed/must_check.h"
#include "link/text.h"
#include "link/words.h"

struct board_settings {
    const struct controller_config *built; ///< what the image was built for
    struct controller_config now;
};

void board_settings_init(struct board_settings *settings, const struct controller_config *built);

/// Line `index` of the list, for a person: name, value, range. False: there is no such line.
bool board_settings_list(const struct board_settings *settings, uint32_t index, struct text *text);

/// Adds "name value" to the text. Returns: NULL, or what is wrong.
const char *board_settings_get(const struct board_settings *settings, struct word name,
                               struct text *text) MUST_CHECK;

/// Changes one. If it is a limit, the controller starts anew, and waits to be armed.
/// Returns: NULL, or why not; then nothing is changed.
const char *board_settings_set(struct board_settings *settings, struct word name,
                               int64_t value_micro, struct controller *controller) MUST_CHECK;

#endif
