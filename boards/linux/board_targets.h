/// The targets that a board is to know, and which of them are news: what goes down the line in a
/// frame.
///
/// The lines of a frame are marked, so that they reach the controller in one tick.
/// A stream's ids become numbers from 0 to 255 on the board. Of a target that changes faster than
/// frames go out only the latest counts, so nothing ever piles up. If a frame's news fit as text,
/// they go as they are (to the micrometre); if not, as directions of six characters
/// (link/compact.h), which the board sees from the position of its mount. Shown:
/// tests/scenario/test_board_link.c.
#ifndef LINUX_BOARD_TARGETS_H
#define LINUX_BOARD_TARGETS_H

#include "board_link.h"

#include "target/target_set.h"

/// A frame is at most what the line carries in this time.
#define BOARD_TARGETS_FRAME_US 50000U
/// News are a frame when no more have come for this long, or the first ones have waited so long.
#define BOARD_TARGETS_QUIET_US 2000U
#define BOARD_TARGETS_WAIT_US  20000U

struct board_targets {
    struct vec3_i64 viewpoint_um;
    uint32_t count, most; ///< known now, and at one time
    uint32_t next;        ///< with which number the next frame begins
    bool has_news;
    uint64_t first_news_us, last_news_us;
    uint64_t compact_frames, text_frames, cut_frames;
    struct board_target {
        bool used, news;
        struct target_update update;
    } target[TARGET_CAPACITY];
};

/// viewpoint_um: where the axes of the mount meet.
void board_targets_init(struct board_targets *targets, struct vec3_i64 viewpoint_um);

/// The board has forgotten them: all are news again.
void board_targets_renew(struct board_targets *targets, uint64_t now_us);

/// Takes an update of a stream. False: there are TARGET_CAPACITY others.
bool board_targets_take(struct board_targets *targets, const struct target_update *update,
                        uint64_t now_us);

/// Is it time for a frame? The line is free, and what belongs together is there.
bool board_targets_due(const struct board_targets *targets, const struct board_link *link,
                       uint64_t now_us);

/// Sends what is new, as much of it as the line carries until the next frame; the rest is first
/// next time.
void board_targets_send(struct board_targets *targets, struct board_link *link, uint64_t now_us);

#endif
