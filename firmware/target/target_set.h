/// The tracked points: what the camera should look at, as directions from the mount.
///
/// A target is a point in the world (micrometres) or a direction (a star). Updates come from any
/// source; a target that is not heard of for the expiry time leaves the set. The directions lie
/// densely in one array, so that the cone solver reads them where they are. Fixed capacity, no
/// allocation.
#ifndef TARGET_TARGET_SET_H
#define TARGET_TARGET_SET_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "fixed/vec3.h"
#include "sphere/follow.h"

#include <stdbool.h>
#include <stdint.h>

#define TARGET_CAPACITY   256U
#define TARGET_INDEX_SIZE 512U // a power of two, at least twice the capacity

/// Weight 1.0. A target of weight 0 is kept but not framed.
#define TARGET_WEIGHT_ONE_Q16 UINT32_C(0x10000)

/// World coordinates reach 2^52 um, 4.5 million kilometres: the difference from any viewpoint in
/// the same range, and its normalisation, are exact in 64 bits.
#define TARGET_POSITION_UM_MAX (INT64_C(1) << 52)

enum target_kind {
    TARGET_POSITION,  ///< position_um, radius_um
    TARGET_DIRECTION, ///< direction, radius_bam32
    TARGET_GONE,      ///< the target `id` leaves
    TARGET_CLEAR ///< every target leaves (a source that sends whole frames starts each with this)
};

/// One message of a source.
struct target_update {
    enum target_kind kind;
    uint32_t id;
    uint16_t object; ///< which group the target belongs to
    uint32_t weight_q16;
    union {
        struct vec3_i64 position_um; ///< world axes, each |component| <= TARGET_POSITION_UM_MAX
        struct vec3 direction;       ///< world axes, any length but zero
    };
    union {
        uint32_t radius_um;    ///< of a sphere round the position
        uint32_t radius_bam32; ///< angle round the direction, below a quarter turn
    };
};

enum target_status {
    TARGET_OK = 0,
    TARGET_ERROR_FULL = -1,      ///< the set holds TARGET_CAPACITY others; nothing changed
    TARGET_ERROR_VIEWPOINT = -2, ///< the position is the viewpoint, or its sphere holds it
    TARGET_ERROR_RANGE =
        -3 ///< a coordinate, a radius or the kind is out of range; or a zero direction
};

/// What is kept of a target besides its direction.
struct target {
    uint32_t id;
    uint16_t object;
    bool moves; ///< its last report differed from the one before
    uint32_t weight_q16;
    uint32_t radius_bam32; ///< angular radius as seen from the viewpoint, rounded up
    uint64_t seen_us;
};

struct target_set {
    uint32_t count;
    uint32_t version; ///< grows with every change that can move the aim
    /// Grows with every report that changes nothing while no target moves: then the aim stands
    /// still.
    uint32_t rest_reports;
    uint32_t moving_count; ///< targets that move
    struct vec3 direction_q30[TARGET_CAPACITY];
    struct follow_radius radius[TARGET_CAPACITY]; ///< target[].radius_bam32, as the solver takes it
    uint32_t sized_count, muted_count;            ///< targets with a radius; of weight 0
    struct target target[TARGET_CAPACITY];

    struct vec3_i64 viewpoint_um;
    uint64_t expiry_us;               ///< 0: targets never expire
    uint64_t oldest_us;               ///< no target was seen before this
    uint16_t slot[TARGET_INDEX_SIZE]; ///< hash of the id -> place + 1, linear probing
};

/// An empty set. viewpoint_um: where the gimbal's axes meet, in world axes; each |component| at
/// most TARGET_POSITION_UM_MAX.
void target_set_init(struct target_set *set, struct vec3_i64 viewpoint_um, uint64_t expiry_us);

/// Applies one update. now_us: the controller's time, for the expiry; never less than before.
/// Returns an error, and leaves the set as it was, if the update can't be taken. Whether a sphere
/// holds the viewpoint is decided exactly (its surface belongs to it).
/// Cost: O(1); TARGET_CLEAR O(TARGET_INDEX_SIZE). The direction is normalised once, here.
/// Accuracy: the angular radius is never too small, and too large by at most 2 BAM and what the
/// tangent to the sphere, rounded down to 1 um, makes of it (tests/property/target_radius.c).
/// Shown: tests/unit/test_target_set.c (against a list, also with ids that collide).
enum target_status target_set_apply(struct target_set *set, const struct target_update *update,
                                    uint64_t now_us) MUST_CHECK;

/// Drops every target that was last seen more than expiry_us ago. Returns how many.
/// Cost: O(1) while none can be due, else O(count).
uint32_t target_set_expire(struct target_set *set, uint64_t now_us);

/// Is the target in the set? *place gets its place in the arrays, which any change may move.
bool target_set_find(const struct target_set *set, uint32_t id, uint32_t *place);

#endif
