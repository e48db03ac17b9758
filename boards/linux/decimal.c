#include "decimal.h"

#include <assert.h>
#include <math.h>

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// The exponent after `e`; sizes beyond any use are cut to 1,000,000. False: not an integer.
static bool read_exponent(const char *at, const char *end, int32_t *out) {
    bool negative = false;
    if (at < end && (*at == '+' || *at == '-')) {
        negative = *at == '-';
        at++;
    }
    if (at == end) {
        return false;
    }
    int32_t value = 0;
    for (; at < end; at++) {
        if (!is_digit(*at)) {
            return false;
        }
        value = value < 100000 ? value * 10 + (*at - '0') : 1000000;
    }
    *out = negative ? -value : value;
    return true;
}

/// The digits from a->first on, without the point.
struct digits {
    const char *at;
    uint32_t left;
};

static uint32_t next_digit(struct digits *digits) {
    if (digits->left == 0U) {
        return 0;
    }
    digits->left--;
    if (*digits->at == '.') {
        digits->at++;
    }
    return (uint32_t)(*digits->at++ - '0');
}

static uint32_t head_digits(const struct decimal *a) {
    return a->digit_count < DECIMAL_HEAD_DIGITS ? a->digit_count : DECIMAL_HEAD_DIGITS;
}

static struct u128 read_head(const struct decimal *a) {
    struct digits digits = {a->first, a->digit_count};
    uint32_t left = head_digits(a);
    uint64_t high = 0, low = 0, power = 1;
    for (; left > 18U; left--) {
        high = high * 10U + next_digit(&digits); // 19 digits at most
    }
    for (; left != 0U; left--) {
        low = low * 10U + next_digit(&digits);
        power *= 10U;
    }
    return u128_add(u128_mul(high, power), u128_of(low));
}

enum decimal_status decimal_read(const char *text, size_t size, struct decimal *out) {
    const char *at = text, *const end = text + size;
    *out = (struct decimal){0};
    if (at < end && (*at == '+' || *at == '-')) {
        out->negative = *at == '-';
        at++;
    }
    const char *last = NULL, *point = NULL;
    bool any = false;
    for (; at < end; at++) {
        if (is_digit(*at)) {
            any = true;
            if (*at != '0') {
                out->first = out->first == NULL ? at : out->first;
                last = at;
            }
        } else if (*at == '.' && point == NULL) {
            point = at;
        } else {
            break;
        }
    }
    const char *const units = point != NULL ? point : at; // just after the digit of 10^0
    int32_t exponent = 0;
    if (!any ||
        (at < end && ((*at != 'e' && *at != 'E') || !read_exponent(at + 1, end, &exponent)))) {
        return DECIMAL_ERROR_SYNTAX;
    }
    if (out->first == NULL) {
        out->negative = false;
        return DECIMAL_OK;
    }
    const int32_t highest = exponent + (int32_t)(units - out->first) - (out->first < units ? 1 : 0);
    out->exponent = exponent + (int32_t)(units - last) - (last < units ? 1 : 0);
    out->digit_count = (uint32_t)(highest - out->exponent) + 1U;
    if (highest > DECIMAL_HIGHEST || out->exponent < DECIMAL_LOWEST) {
        return DECIMAL_ERROR_RANGE;
    }
    out->head = read_head(out);
    return DECIMAL_OK;
}

int decimal_sign(const struct decimal *a) {
    return a->digit_count == 0U ? 0 : (a->negative ? -1 : 1);
}

int decimal_compare(const struct decimal *a, const struct decimal *b) {
    const int sign = decimal_sign(a);
    if (sign != decimal_sign(b)) {
        return sign < decimal_sign(b) ? -1 : 1;
    }
    if (sign == 0) {
        return 0;
    }
    const int32_t highest_a = a->exponent + (int32_t)a->digit_count;
    const int32_t highest_b = b->exponent + (int32_t)b->digit_count;
    if (highest_a != highest_b) {
        return highest_a < highest_b ? -sign : sign;
    }
    struct digits left = {a->first, a->digit_count}, right = {b->first, b->digit_count};
    while (left.left != 0U || right.left != 0U) {
        const uint32_t digit_a = next_digit(&left), digit_b = next_digit(&right);
        if (digit_a != digit_b) {
            return digit_a < digit_b ? -sign : sign;
        }
    }
    return 0;
}

struct u128 decimal_power10(uint32_t exponent) {
    static const uint64_t powers[20] = {UINT64_C(1),
                                        UINT64_C(10),
                                        UINT64_C(100),
                                        UINT64_C(1000),
                                        UINT64_C(10000),
                                        UINT64_C(100000),
                                        UINT64_C(1000000),
                                        UINT64_C(10000000),
                                        UINT64_C(100000000),
                                        UINT64_C(1000000000),
                                        UINT64_C(10000000000),
                                        UINT64_C(100000000000),
                                        UINT64_C(1000000000000),
                                        UINT64_C(10000000000000),
                                        UINT64_C(100000000000000),
                                        UINT64_C(1000000000000000),
                                        UINT64_C(10000000000000000),
                                        UINT64_C(100000000000000000),
                                        UINT64_C(1000000000000000000),
                                        UINT64_C(10000000000000000000)};
    assert(exponent <= 38U);
    return exponent < 20U ? u128_of(powers[exponent])
                          : u128_mul(powers[19], powers[exponent - 19U]);
}

void decimal_magnitude(const struct decimal *a, int32_t shift, struct big *out) {
    big_set(out, 0);
    if (a->digit_count == 0U) {
        return;
    }
    struct digits digits = {a->first, a->digit_count};
    while (digits.left != 0U) {
        uint64_t chunk = 0, power = 1;
        while (digits.left != 0U && power < UINT64_C(1000000000000000000)) {
            chunk = chunk * 10U + next_digit(&digits);
            power *= 10U;
        }
        big_multiply_add(out, power, chunk);
    }
    assert(a->exponent + shift >= 0);
    big_multiply_power10(out, (uint32_t)(a->exponent + shift));
}

bool decimal_scale(const struct decimal *a, uint64_t numerator, uint64_t denominator,
                   int64_t *out) {
    const int32_t shift = a->exponent < 0 ? -a->exponent : 0;
    struct big rest, divisor;
    decimal_magnitude(a, shift, &rest);
    big_multiply_add(&rest, numerator, 0);
    big_set(&divisor, denominator);
    big_multiply_power10(&divisor, (uint32_t)shift);
    const struct big unit = divisor;
    big_multiply_add(&divisor, UINT64_C(1) << 63, 0);
    if (big_compare(&rest, &divisor) >= 0) {
        return false;
    }
    uint64_t quotient = 0;
    for (int bit = 0; bit < 63; bit++) {
        big_shift_right(&divisor, 1);
        quotient *= 2U;
        if (big_compare(&rest, &divisor) >= 0) {
            big_subtract(&rest, &divisor);
            quotient++;
        }
    }
    big_multiply_add(&rest, 2, 0);
    quotient += big_compare(&rest, &unit) >= 0 ? 1U : 0U;
    if (quotient > (uint64_t)INT64_MAX) {
        return false;
    }
    *out = a->negative ? -(int64_t)quotient : (int64_t)quotient;
    return true;
}

bool decimal_fixed(const struct decimal *a, int32_t places, struct i128 *out) {
    *out = i128_from_i64(0);
    if (a->digit_count == 0U) {
        return true;
    }
    const int32_t used = (int32_t)head_digits(a);
    const int32_t shift = a->exponent + (int32_t)a->digit_count - used + places;
    if (used + shift > DECIMAL_HEAD_DIGITS) {
        return false;
    }
    struct u128 value = {0, 0};
    if (shift >= 0) {
        value = u128_product(a->head, decimal_power10((uint32_t)shift));
    } else if (shift > -DECIMAL_HEAD_DIGITS) {
        value = u128_divide(a->head, decimal_power10((uint32_t)-shift), NULL);
    }
    *out = i128_with_sign(value, a->negative);
    return true;
}

bool decimal_whole(const struct decimal *a, int64_t *out) {
    struct i128 value;
    const bool fits = decimal_fixed(a, 0, &value) && value.hi == ((int64_t)value.lo < 0 ? -1 : 0);
    *out = fits ? (int64_t)value.lo : 0;
    return fits;
}

long double decimal_value(const struct decimal *a) {
    const uint32_t kept =
        a->digit_count < DECIMAL_HEAD_DIGITS ? a->digit_count : DECIMAL_HEAD_DIGITS;
    const long double size =
        u128_value(a->head) * powl(10.0L, (long double)a->exponent + a->digit_count - kept);
    return a->digit_count == 0U ? 0.0L : a->negative ? -size : size;
}
