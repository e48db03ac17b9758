#include "motion/mount.h"

#include "fixed/root.h"
#include "fixed/trig.h"

/// a * ca + b * cb, a combination of unit vectors by a cosine and a sine, Q1.30.
static struct vec3 blend(struct vec3 a, q30_t ca, struct vec3 b, q30_t cb) {
    return vec3((q30_t)round_shift_i64((int64_t)a.x * ca + (int64_t)b.x * cb, 30U),
                (q30_t)round_shift_i64((int64_t)a.y * ca + (int64_t)b.y * cb, 30U),
                (q30_t)round_shift_i64((int64_t)a.z * ca + (int64_t)b.z * cb, 30U));
}

void mount_init(struct mount *mount, struct mount_attitude attitude) {
    const struct sincos heading = trig_sincos(attitude.heading),
                        pitch = trig_sincos(attitude.pitch), roll = trig_sincos(attitude.roll);
    const struct vec3 level = vec3(heading.sin_q30, heading.cos_q30, 0);
    const struct vec3 right = vec3(heading.cos_q30, -heading.sin_q30, 0);
    const struct vec3 zenith = vec3(0, 0, Q30_ONE);
    const struct vec3 up = blend(zenith, pitch.cos_q30, level, -pitch.sin_q30);
    mount->ahead_q30 = blend(level, pitch.cos_q30, zenith, pitch.sin_q30);
    mount->right_q30 = blend(right, roll.cos_q30, up, -roll.sin_q30);
    mount->up_q30 = blend(up, roll.cos_q30, right, roll.sin_q30);
}

bool mount_solve(const struct mount *mount, struct vec3 direction_q30,
                 struct mount_joints *joints) {
    const int64_t x = vec3_dot_unit(mount->right_q30, direction_q30);
    const int64_t y = vec3_dot_unit(mount->ahead_q30, direction_q30);
    const int64_t z = vec3_dot_unit(mount->up_q30, direction_q30); // all Q2.60
    const uint64_t level = vec3_i64_length((struct vec3_i64){x, y, 0});
    joints->tilt = trig_atan2(z, (int64_t)level);
    const bool pan_defined = level >> 36 != 0U;
    joints->pan = pan_defined ? trig_atan2(x, y) : bam32(0);
    return pan_defined;
}

struct vec3 mount_direction(const struct mount *mount, struct mount_joints joints) {
    const struct sincos pan = trig_sincos(joints.pan), tilt = trig_sincos(joints.tilt);
    const struct vec3 level = blend(mount->right_q30, pan.sin_q30, mount->ahead_q30, pan.cos_q30);
    return blend(level, tilt.cos_q30, mount->up_q30, tilt.sin_q30);
}
