/// Where things are in the pump of the image: the size of each array is a place or a number, for
/// `nm -S`. With it the test puts targets and commands where a console would.
#include "app/board_loop.h"

#include <stddef.h>

#define PUMP offsetof(struct board_loop, pump)
#define PLACE(name, value)                                                                         \
    extern char name[];                                                                            \
    char name[1 + (value)]

PLACE(commands, PUMP + offsetof(struct pump, commands));
PLACE(update_first, PUMP + offsetof(struct pump, update_first));
PLACE(update_count, PUMP + offsetof(struct pump, update_count));
PLACE(updates, PUMP + offsetof(struct pump, update));
PLACE(updates_max, PUMP_UPDATES_MAX);
PLACE(update_bytes, sizeof(struct target_update));
PLACE(kind, offsetof(struct target_update, kind));
PLACE(kind_bytes, sizeof(enum target_kind));
PLACE(id, offsetof(struct target_update, id));
PLACE(object, offsetof(struct target_update, object));
PLACE(weight_q16, offsetof(struct target_update, weight_q16));
PLACE(direction, offsetof(struct target_update, direction));
PLACE(radius_bam32, offsetof(struct target_update, radius_bam32));
PLACE(kind_direction, TARGET_DIRECTION);
PLACE(command_arm, COMMAND_ARM);
PLACE(command_stop, COMMAND_STOP);
