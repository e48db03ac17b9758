/// Targets that solids hide: which are in sight, now and in the next moments, and how much each
/// counts for the aim.
///
/// A stage between the sources of targets and the controller. Reports of targets and of moving
/// obstacles go in; once a frame, every target comes out as an update for the controller, where it
/// is by then, with its visible part and with what it counts. What is in sight is decided exactly
/// (scene/sight.h) on positions in whole units.
///
/// A target with a radius is nine points, its middle and eight on its rim, and its visible part is
/// the ball around those that count. An object of several targets counts by those of them that do.
///
/// Policy DROP: what is hidden does not count. CALM: a target counts if it is in sight at some
/// frame from `fade_us` to `ahead_us` from now, on the paths that targets and obstacles are on. So
/// what is hidden only for a moment stays, what will be hidden for long leaves before it is, and
/// what will appear is made room for. To leave means to move, in the eyes of the controller, within
/// fade_us to the middle of the targets that count: the aim follows without a jump. Where nothing
/// is or will be in sight, everything counts as it did.
///
/// Sans-I/O, no allocation. Shown: tests/property/occlusion.c, tests/scenario/test_obstacle.c.
#ifndef TARGET_OCCLUSION_H
#define TARGET_OCCLUSION_H

#include "fixed/must_check.h"
#include "scene/sight.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define OCCLUSION_TARGETS_MAX 64U ///< more pass through untouched
#define OCCLUSION_GROUPS_MAX  16U
#define OCCLUSION_FRAMES_MAX  128U ///< that a forecast looks ahead
#define OCCLUSION_SAMPLES     9U

enum occlusion_policy { OCCLUSION_DROP, OCCLUSION_CALM };

struct occlusion_config {
    const struct shape_set *shapes; ///< world axes, in units
    const uint8_t *group;           ///< of each object, those that move together; NULL: all 0
    uint32_t unit_um;               ///< 1 to 10^6
    struct vec3_i64 viewpoint_um;
    enum occlusion_policy policy;
    uint32_t frame_us; ///< 1,000 to 10^6
    uint32_t ahead_us, fade_us;
};

/// Never: no such moment within ahead_us.
#define OCCLUSION_NEVER UINT64_MAX

struct occlusion_target {
    struct target_update last; ///< as reported
    struct vec3_i64 velocity_umps;
    uint64_t seen_us;
    uint32_t reports;
    uint8_t samples_seen;     ///< of OCCLUSION_SAMPLES; of a point 0 or all
    uint16_t samples;         ///< which
    uint16_t samples_counted; ///< those in sight at a moment that matters for the policy
    bool counts;              ///< by the policy
    uint32_t level_q16;       ///< how far it counts: moves to 0 or 1 within fade_us
    uint64_t hides_us;        ///< in sight now: the first frame when it is not
    uint64_t shows_us;        ///< hidden now: the first frame when it is
};

/// Where a group of objects is.
struct occlusion_group {
    struct vec3_i64 offset_um;
    struct vec3_i64 velocity_umps;
    uint64_t since_us;
};

struct occlusion {
    const struct occlusion_config *config;
    struct sight sight;
    struct occlusion_group group[OCCLUSION_GROUPS_MAX];
    struct occlusion_target target[OCCLUSION_TARGETS_MAX];
    uint32_t target_count, next_out;
    bool started;
    uint64_t next_frame_us, frame_us;
    struct vec3_i64 middle_um; ///< of the targets that count
    bool middle_known;
};

/// Bytes of workspace for the shadows, aligned to 8.
size_t occlusion_workspace_bytes(const struct shape_set *shapes);

/// False: the workspace is too small, or the settings are out of range (the viewpoint may be 2^28
/// units from the origin). config must outlive it.
bool occlusion_init(struct occlusion *occlusion, const struct occlusion_config *config,
                    void *workspace, size_t workspace_bytes) MUST_CHECK;

/// An update of a source. False: not taken (too many targets): give it to the controller as it is.
bool occlusion_report(struct occlusion *occlusion, const struct target_update *update,
                      uint64_t now_us) MUST_CHECK;

/// A group is there, and moves on so. What is 2^29 units from the viewpoint or farther hides
/// nothing.
void occlusion_move(struct occlusion *occlusion, uint32_t group, struct vec3_i64 offset_um,
                    struct vec3_i64 velocity_umps, uint64_t now_us);

/// If a frame is due, decides anew. True: occlusion_next has updates.
/// Cost:  for each frame ahead the shadows of what moves (CALM), and a test for each target and
///        piece of shadow.
bool occlusion_step(struct occlusion *occlusion, uint64_t now_us);

/// The updates of a frame, one a call. False: no more.
bool occlusion_next(struct occlusion *occlusion, struct target_update *out);

/// What a place reported now would become. False: the target is not known: it is as it is.
bool occlusion_adjust(const struct occlusion *occlusion, const struct target_update *in,
                      struct target_update *out);

/// Is a place in sight, with the groups where they are at a time? For a place by itself.
bool occlusion_sees(struct occlusion *occlusion, struct vec3_i64 position_um, uint64_t at_us);

#endif
