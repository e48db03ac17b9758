#include "regular/wedge.h"

#include "regular/primitive.h"

static int64_t turn(struct vec3_i64 from, struct vec3_i64 to) {
    return from.x * to.y - from.y * to.x;
}

void wedge_add(struct wedge *wedge, struct vec3_i64 trace) {
    trace.z = 0;
    trace = primitive_vec3_i64(trace);
    wedge->operations++;
    if (primitive_is_zero(wedge->first)) {
        wedge->first = trace;
        return;
    }
    const int64_t side = turn(wedge->first, trace);
    if (side == 0) {
        return;
    }
    if (side < 0) {
        trace = (struct vec3_i64){-trace.x, -trace.y, 0};
    }
    if (primitive_is_zero(wedge->next) || turn(wedge->next, trace) < 0) {
        wedge->next = trace;
    }
}

struct vec3 wedge_azimuth(const struct wedge *wedge) {
    const struct vec3_i64 first = wedge->first, next = wedge->next;
    // One trace only: at right angles to it. Else the sum lies between both, less than half a turn
    // apart.
    return primitive_is_zero(next)
               ? vec3((int32_t)-first.y, (int32_t)first.x, 0)
               : vec3((int32_t)(first.x + next.x), (int32_t)(first.y + next.y), 0);
}

struct u128 wedge_steepness(struct vec3_i64 normal, struct vec3 azimuth) {
    if (normal.z == 0) {
        return (struct u128){0, 0};
    }
    struct i128 along = i128_add(i128_mul(normal.x, azimuth.x), i128_mul(normal.y, azimuth.y));
    if (i128_sign(along) < 0) {
        along = i128_neg(along);
    }
    const struct u128 size = {along.lo, (uint64_t)along.hi};
    return u128_add(primitive_quotient(size, u64_abs(normal.z)), (struct u128){1, 0});
}
