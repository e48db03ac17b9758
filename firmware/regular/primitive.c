#include "regular/primitive.h"

struct vec3_i64 primitive_reduced(struct vec3_i64 a) {
    const int64_t divisor =
        (int64_t)primitive_gcd(primitive_gcd(u64_abs(a.x), u64_abs(a.y)), u64_abs(a.z));
    return divisor == 0 ? a : (struct vec3_i64){a.x / divisor, a.y / divisor, a.z / divisor};
}

struct vec3_i64 primitive_vec3_i64(struct vec3_i64 a) {
    const int64_t first = a.x != 0 ? a.x : (a.y != 0 ? a.y : a.z);
    a = primitive_reduced(a);
    return first < 0 ? (struct vec3_i64){-a.x, -a.y, -a.z} : a;
}

struct vec3 primitive_vec3(struct vec3 a) {
    const struct vec3_i64 reduced = primitive_vec3_i64(vec3_widen(a));
    return vec3((int32_t)reduced.x, (int32_t)reduced.y, (int32_t)reduced.z);
}

uint32_t primitive_hash(struct vec3_i64 a) {
    uint64_t hash = (uint64_t)a.x * UINT64_C(0x9E3779B97F4A7C15);
    hash = ((hash ^ hash >> 29) + (uint64_t)a.y) * UINT64_C(0xBF58476D1CE4E5B9);
    hash = ((hash ^ hash >> 32) + (uint64_t)a.z) * UINT64_C(0x94D049BB133111EB);
    return (uint32_t)(hash >> 32);
}

struct u128 primitive_quotient(struct u128 a, uint64_t divisor) {
    uint64_t rest = a.hi % divisor;
    const uint64_t hi = a.hi / divisor;
    return (struct u128){u128_div_u64((struct u128){a.lo, rest}, divisor, &rest), hi};
}
