/// Linked in front of the framing (--wrap) to see that the gate on the tick catches an aim that
/// costs too much.
#include "aim/framing.h"

#define TIMES 8

__typeof__(framing_follow) __real_framing_follow, __wrap_framing_follow;

enum framing_status __wrap_framing_follow(const struct target_set *set,
                                          struct framing_choice choice,
                                          const struct framing_picture *picture,
                                          struct framing_memory *memory, uint32_t work_limit,
                                          struct framing_workspace *workspace,
                                          struct framing *framing) {
    for (int i = 1; i < TIMES; i++) {
        (void)__real_framing_follow(set, choice, picture, memory, work_limit, workspace, framing);
    }
    return __real_framing_follow(set, choice, picture, memory, work_limit, workspace, framing);
}
