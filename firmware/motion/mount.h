/// How the gimbal stands in the world: directions to joint angles and back.
///
/// World axes: x east, y north, z up. The mount's own axes: right, ahead, up at pan 0 and tilt 0.
/// Pan turns about the mount's up axis, positive clockwise seen from above; tilt about the right
/// axis, positive up.
#ifndef MOTION_MOUNT_H
#define MOTION_MOUNT_H

#include "fixed/bam32.h"
#include "fixed/vec3.h"

#include <stdbool.h>

/// Attitude of the base, applied in this order: heading (clockwise from north), pitch (nose up),
/// roll (right side down). A gimbal that hangs upside down has a roll of a half turn.
struct mount_attitude {
    bam32_t heading, pitch, roll;
};

/// The mount's axes in world coordinates, unit vectors in Q1.30: the rows of the rotation world ->
/// mount.
struct mount {
    struct vec3 right_q30, ahead_q30, up_q30;
};

struct mount_joints {
    bam32_t pan, tilt; ///< tilt within a quarter turn of 0
};

/// Accuracy of the axes: 3 ulp a component (tests/property/mount.c).
void mount_init(struct mount *mount, struct mount_attitude attitude);

/// Joint angles that look along a world direction (unit, Q1.30), with tilt in [-90, 90] degrees.
/// Returns: false if the direction is within 2^-24 rad of the pan axis, where pan is undefined: the
/// caller keeps its
///          pan, and joints->pan is 0.
/// Accuracy: 4 nrad of direction, against the exact attitude (tests/property/mount.c).
bool mount_solve(const struct mount *mount, struct vec3 direction_q30, struct mount_joints *joints);

/// The world direction in which the camera looks at these joint angles, unit, Q1.30. Accuracy: 4
/// ulp a component, against the exact attitude (tests/property/mount.c).
struct vec3 mount_direction(const struct mount *mount, struct mount_joints joints);

#endif
