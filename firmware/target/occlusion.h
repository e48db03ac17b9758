/// Targets that solids hide: which are in sight, now and in the next moments, and how much each
/// counts for the aim.
///
/// A stage between the sources of targets and the controller (app/pump.h). Reports of targets and
/// of moving obstacles go in; once a frame, every target comes out as an update for the controller,
/// where it is by then, with its visible part and with what it counts. What is in sight is decided
/// exactly (scene/sight.h) on positions in whole units.
///
/// A target with a radius is nine points, its middle and eight on its rim, and its visible part is
/// the ball around those that count. An object of several targets counts by those of them that do.
///
/// Policy DROP: what is hidden does not count. CALM: a target counts if it is in sight at some
/// frame from `fade_us` to `ahead_us` from now, on the paths that targets and obstacles are on. So
/// what is hidden only for a moment stays, what will be hidden for long leaves before it is, and
/// what will appear is made room for. WEIGH: as CALM, but what does not count keeps a weight.
///
/// A target of weight w is, in the eyes of the controller, on the way from the middle of those that
/// count to its own place, w of that way. It moves there within fade_us (DROP: at once). So the
/// narrowest cone always holds all that is in sight, is that of what is in sight at w = 0 (the
/// middle is among them) and of all targets at w = 1, and never narrower for a larger w; it follows
/// without a jump. Where nothing is or will be in sight, everything counts as it did.
///
/// The work of a frame comes in small units, so that a board does it in the time that its ticks
/// leave over; a computer does all of it when the frame is due. Sans-I/O, no allocation. Shown:
/// tests/property/occlusion.c, tests/unit/test_occlusion.c, tests/scenario/test_obstacle.c.
#ifndef TARGET_OCCLUSION_H
#define TARGET_OCCLUSION_H

#include "fixed/must_check.h"
#include "scene/sight.h"
#include "scene/units.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define OCCLUSION_TARGETS_MAX 64U ///< more pass through untouched
#define OCCLUSION_GROUPS_MAX  16U
#define OCCLUSION_FRAMES_MAX  128U ///< that a forecast looks ahead
#define OCCLUSION_SAMPLES     9U
#define OCCLUSION_NEAR_MAX    16U ///< pieces of shadow near one target that are told apart
#define OCCLUSION_MIDDLES_MAX 8U  ///< objects with a middle of their own

enum occlusion_policy { OCCLUSION_IGNORE, OCCLUSION_DROP, OCCLUSION_CALM, OCCLUSION_WEIGH };

/// As a rig file or a scenario has them.
struct occlusion_settings {
    enum occlusion_policy policy;
    uint32_t frame_us; ///< 1,000 to 10^6
    uint32_t ahead_us, fade_us;
    uint32_t hidden_q16; ///< WEIGH: weight of what does not count, 0 to 65536
};

/// Are they in range: fade_us at most ahead_us, that at most 10 s and OCCLUSION_FRAMES_MAX frames?
bool occlusion_settings_valid(const struct occlusion_settings *settings);

struct occlusion_config {
    const struct shape_set *shapes; ///< world axes, in units; NULL: the shadows are given
    const uint8_t *group;           ///< of each object, those that move together; NULL: all 0
    struct units units;
    struct vec3_i64 viewpoint_um;
    uint64_t expiry_us; ///< a target not heard of for so long leaves; 0: never
    struct occlusion_settings settings;
};

/// Never: no such moment within ahead_us.
#define OCCLUSION_NEVER UINT64_MAX

struct occlusion_target {
    struct target_update last;      ///< as reported
    struct vec3_i64 velocity_ump20; ///< micrometres in 2^20 us
    uint64_t heard_us;
    uint64_t since_us; ///< when it was at last.position_um
    uint32_t reports;
    bool is_new;          ///< it was in no frame yet: if it counts, then at once
    bool leaves;          ///< with the next frame
    bool cleared;         ///< and not reported again since:
    uint64_t cleared_us;  ///< when
    uint8_t samples_seen; ///< of OCCLUSION_SAMPLES; of a point 0 or all
    uint16_t samples;     ///< which
    bool counts;          ///< by the policy
    uint32_t level_q16;   ///< how far it counts: moves to 0 or 65536 within fade_us
    uint64_t hides_us;    ///< in sight now: the first frame when it is not
    uint64_t shows_us;    ///< hidden now: the first frame when it is
    bool is_part;         ///< only a part of it counts:
    uint32_t part_radius_um;
    struct vec3_i64 part_um; ///< its middle from that of the target
    struct {
        uint32_t number;           ///< of the look that was done with it last
        uint16_t samples, counted; ///< in sight now; at a frame that matters for the policy
        uint64_t hides_us, shows_us;
    } look;
    bool is_out; ///< `out` is of this frame, and not taken yet
    struct target_update out;
};

/// Where a group of objects is.
struct occlusion_group {
    struct vec3_i64 offset_um;
    struct vec3_i64 velocity_ump20;
    uint64_t since_us;
};

/// Where the targets of an object are that count: the mean.
struct occlusion_middle {
    uint16_t object;
    int64_t weight; ///< 256 for each that counts in full; 0: none does
    struct vec3_i64 sum_um, middle_um;
    int64_t weight_toward; ///< the same of directions
    struct vec3_i64 sum_q30;
    struct vec3 toward_q30;
};

enum occlusion_look_stage {
    OCCLUSION_LOOK_NEAR,  ///< which shadows are near the target all the time ahead
    OCCLUSION_LOOK_AXES,  ///< how its rim stands at a frame
    OCCLUSION_LOOK_PLACE, ///< where its samples are
    OCCLUSION_LOOK_TEST,  ///< are they in these shadows
    OCCLUSION_LOOK_PART_AXES,
    OCCLUSION_LOOK_PART,  ///< what of it is in sight
    OCCLUSION_LOOK_DECIDE ///< all are done: what counts
};

/// A look at all targets, one after the other.
struct occlusion_look {
    bool runs, any;
    uint32_t number; ///< of looks
    uint64_t at_us;
    uint32_t target;
    enum occlusion_look_stage stage;
    bool started; ///< of this target's stage NEAR
    uint64_t ahead_us;
    uint32_t piece; ///< next
    uint32_t sample, sample_count;
    uint16_t seen;
    struct vec3 right, up; ///< Q1.30, across the line of sight
    struct vec3 ball;      ///< that holds the target all the time ahead
    uint32_t ball_radius;
    bool all_near; ///< too many pieces are: all are tested
    uint32_t near_count;
    uint16_t near[OCCLUSION_NEAR_MAX];
    struct vec3 place[OCCLUSION_SAMPLES];
};

enum occlusion_frame_stage {
    OCCLUSION_FRAME_DONE,
    OCCLUSION_FRAME_LEVELS,
    OCCLUSION_FRAME_MIDDLES,
    OCCLUSION_FRAME_OUT
};

struct occlusion {
    const struct occlusion_config *config;
    struct sight sight;
    bool cast; ///< the shadows are those of the groups' places
    struct occlusion_group group[OCCLUSION_GROUPS_MAX];
    struct occlusion_target target[OCCLUSION_TARGETS_MAX];
    uint32_t target_count;
    bool by_object;
    bool passed; ///< targets passed through since the last clearing
    struct occlusion_look look;
    bool started;
    uint64_t next_frame_us, frame_us, elapsed_us;
    enum occlusion_frame_stage frame_stage;
    uint32_t frame_next; ///< target or middle
    uint32_t next_out;
    uint32_t middle_count;
    struct occlusion_middle middle[OCCLUSION_MIDDLES_MAX];
    struct occlusion_middle middle_of_all;
    uint64_t looked_total, hidden_total; ///< targets in all looks; those hidden as a whole
    uint32_t look_us;                    ///< how long the last look took
};

/// Bytes of workspace for the shadows, aligned to 8.
size_t occlusion_workspace_bytes(const struct shape_set *shapes);

/// False: the workspace is too small, or the settings are out of range (the viewpoint may be 2^28
/// units from the origin). config must outlive it. With policy IGNORE it may be had, and takes
/// nothing.
bool occlusion_init(struct occlusion *occlusion, const struct occlusion_config *config,
                    void *workspace, size_t workspace_bytes) MUST_CHECK;

/// With config->shapes NULL: shadows that never move, of the viewpoint.
bool occlusion_init_shadows(struct occlusion *occlusion, const struct occlusion_config *config,
                            const struct sight *shadows) MUST_CHECK;

/// An update of a source. False: not taken (a target that leaves; too many targets): give it to the
/// controller as it is. A TARGET_CLEAR is taken: what is not reported again until the next frame
/// leaves then.
/// Cost: a search by id; three 64-bit divisions.
bool occlusion_report(struct occlusion *occlusion, const struct target_update *update,
                      uint64_t now_us) MUST_CHECK;

/// Forgets every target at once; the controller has to be told by the caller.
void occlusion_forget(struct occlusion *occlusion);

/// A group is there, and moves on so, for 16 s at most. What is 2^29 units from the viewpoint or
/// farther hides nothing.
void occlusion_move(struct occlusion *occlusion, uint32_t group, struct vec3_i64 offset_um,
                    struct vec3_i64 velocity_umps, uint64_t now_us);

/// Each object is framed by itself: one that is hidden as a whole counts as it did, and what of it
/// does not count moves to its own middle. As long as not, all targets are framed together.
void occlusion_by_object(struct occlusion *occlusion, bool by_object);

/// Begins a frame if one is due. all: and does its work, and that of a look at everything as it is
/// now. Groups that move need that.
/// Cost:  for each frame ahead the shadows of what moves, and a test for each target and piece of
///        shadow that may hide it.
void occlusion_step(struct occlusion *occlusion, uint64_t now_us, bool all);

/// A unit of the work, for those who do not do all: frames first, then looks, which begin again as
/// they end. False: nothing is to be done.
/// Cost: about 20 tests of a bound, and those of one piece (tests/gate/tick.sh).
bool occlusion_work(struct occlusion *occlusion, uint64_t now_us);

/// The updates of a frame, one a call. False: no more.
bool occlusion_next(struct occlusion *occlusion, struct target_update *out);

/// What a place reported now would become. False: the target is not known: it is as it is.
bool occlusion_adjust(const struct occlusion *occlusion, const struct target_update *in,
                      struct target_update *out);

#endif
