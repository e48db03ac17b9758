/// The printed cone against MPFR: it holds every point as written, and is no wider than it must be.
#include "check.h"
#include "support/messages.h"

#include "measure.h"

#include "sphere/cone.h"

#include <mpfr.h>

static uint64_t seed = UINT64_C(0x60642E2A34326F15);

enum { BITS = 256, POINTS_MOST = 8, TEXT_BYTES = 4096 };

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

// ---------------------------------------------------------------- the true angle

static mpfr_t scratch[8];

/// Degrees in `angle` to radians.
static void to_rad(mpfr_t angle) {
    mpfr_const_pi(scratch[7], MPFR_RNDN);
    mpfr_mul(angle, angle, scratch[7], MPFR_RNDN);
    mpfr_div_ui(angle, angle, 180, MPFR_RNDN);
}

/// The direction that a line of the file names, in `out`.
static void true_direction(mpfr_t out[3], const char *line, enum points_input input,
                           const double viewpoint[3]) {
    char words[3][80] = {"0", "0", "0"};
    sscanf(line, "%79s %79s %79s", words[0], words[1], words[2]);
    for (int i = 0; i < 3; i++) {
        mpfr_set_str(out[i], words[i], 10, MPFR_RNDN);
    }
    if (input == POINTS_XYZ) {
        for (int i = 0; i < 3; i++) {
            mpfr_sub_d(out[i], out[i], viewpoint[i], MPFR_RNDN);
        }
    }
    if (input == POINTS_RADEC) {
        to_rad(out[0]);
        to_rad(out[1]);
        mpfr_sin_cos(scratch[0], scratch[1], out[0], MPFR_RNDN);
        mpfr_sin_cos(out[2], scratch[2], out[1], MPFR_RNDN);
        mpfr_mul(out[0], scratch[1], scratch[2], MPFR_RNDN);
        mpfr_mul(out[1], scratch[0], scratch[2], MPFR_RNDN);
    }
}

/// The largest angle from the axis to the points of the text, in degrees, in `out`.
static void true_angle(mpfr_t out, struct vec3 axis, const char *text, enum points_input input,
                       const double viewpoint[3]) {
    mpfr_t v[3], cross, sum, dot;
    mpfr_inits2(BITS, v[0], v[1], v[2], cross, sum, dot, (mpfr_ptr)0);
    const int32_t a[3] = {axis.x, axis.y, axis.z};
    mpfr_set_ui(out, 0, MPFR_RNDN);
    for (const char *line = text; *line != '\0'; line = strchr(line, '\n') + 1) {
        true_direction(v, line, input, viewpoint);
        mpfr_set_ui(sum, 0, MPFR_RNDN);
        mpfr_set_ui(dot, 0, MPFR_RNDN);
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            mpfr_mul_si(scratch[3], v[k], a[j], MPFR_RNDN);
            mpfr_mul_si(scratch[4], v[j], a[k], MPFR_RNDN);
            mpfr_sub(cross, scratch[3], scratch[4], MPFR_RNDN);
            mpfr_fma(sum, cross, cross, sum, MPFR_RNDN);
            mpfr_mul_si(scratch[3], v[i], a[i], MPFR_RNDN);
            mpfr_add(dot, dot, scratch[3], MPFR_RNDN);
        }
        mpfr_sqrt(sum, sum, MPFR_RNDN);
        mpfr_atan2(sum, sum, dot, MPFR_RNDN);
        mpfr_max(out, out, sum, MPFR_RNDN);
    }
    mpfr_const_pi(sum, MPFR_RNDN);
    mpfr_div(out, out, sum, MPFR_RNDN);
    mpfr_mul_ui(out, out, 180, MPFR_RNDN);
    mpfr_clears(v[0], v[1], v[2], cross, sum, dot, (mpfr_ptr)0);
}

// ---------------------------------------------------------------- the printed one

struct excess {
    double worst_pdeg, worst_bam;
    int64_t feasible;
};

/// Reads the text, aims, measures, and compares.
static void check_text(const char *text, enum points_input input, struct excess *excess) {
    static const double viewpoint[3] = {0.25, -1.5, 0.125};
    struct points_format format = {.input = input};
    struct triple triple = {.given = false};
    if (input == POINTS_XYZ) {
        CHECK(points_read_triple("0.25,-1.5,0.125", &triple) == NULL);
        memcpy(format.viewpoint, triple.component, sizeof format.viewpoint);
    }
    struct points points;
    FILE *const stream = messages_input(text, strlen(text));
    CHECK_EQ(points_read_stream(stream, "f", &format, &points), EXIT_STATUS_OK);
    fclose(stream);
    int64_t workspace[CONE_WORKSPACE_BYTES(POINTS_MOST) / sizeof(int64_t) + 1U];
    struct cone_result result;
    const struct cone_options options = {.workspace = workspace,
                                         .workspace_bytes = sizeof workspace};
    if (cone_narrowest(points.directions, points.count, &options, &result) == CONE_OK) {
        const struct measured_cone cone = measure_cone(result.axis_q30, &points);
        true_angle(scratch[5], result.axis_q30, text, input, viewpoint);
        // As printed, and as a reader takes it who has doubles only.
        char printed[64];
        snprintf(printed, sizeof printed, "%llu.%012llu",
                 (unsigned long long)(cone.half_angle_pdeg / MEASURE_DEGREE),
                 (unsigned long long)(cone.half_angle_pdeg % MEASURE_DEGREE));
        mpfr_set_str(scratch[6], printed, 10, MPFR_RNDN);
        const double as_double = strtod(printed, NULL);
        CHECK(mpfr_cmp(scratch[6], scratch[5]) >= 0);
        CHECK(mpfr_cmp_d(scratch[5], as_double) <= 0);
        mpfr_sub(scratch[6], scratch[6], scratch[5], MPFR_RNDN);
        const double above = mpfr_get_d(scratch[6], MPFR_RNDU) * 1e12;
        // BAM: the next whole one above what is printed.
        mpfr_mul_2ui(scratch[5], scratch[5], 32, MPFR_RNDN);
        mpfr_div_ui(scratch[5], scratch[5], 360, MPFR_RNDN);
        mpfr_ui_sub(scratch[5], cone.half_angle_bam32.bam, scratch[5], MPFR_RNDN);
        const double bam_above = mpfr_get_d(scratch[5], MPFR_RNDU);
        CHECK(bam_above >= 0);
        excess->worst_pdeg = above > excess->worst_pdeg ? above : excess->worst_pdeg;
        excess->worst_bam = bam_above > excess->worst_bam ? bam_above : excess->worst_bam;
        excess->feasible++;
    }
    points_free(&points);
}

/// A set of points around a random direction: width in radians, digits after the point.
static void any_text(char text[TEXT_BYTES], enum points_input input, double width, int digits) {
    const int count = 1 + (int)(check_random(&seed) % POINTS_MOST);
    const double a = uniform() * 360, d = uniform() * 120 - 60, spread = width * 57.3;
    size_t at = 0;
    for (int i = 0; i < count; i++) {
        const double ra = a + (uniform() - 0.5) * spread, dec = d + (uniform() - 0.5) * spread;
        const double clipped = dec > 90 ? 90 : (dec < -90 ? -90 : dec);
        if (input == POINTS_RADEC) {
            at += (size_t)snprintf(text + at, TEXT_BYTES - at, "%.*f %.*f\n", digits, ra, digits,
                                   clipped);
            continue;
        }
        const double distance = input == POINTS_Q30 ? 1e9 : 1 + 100 * uniform();
        const double x = distance * __builtin_cos(clipped / 57.3) * __builtin_cos(ra / 57.3);
        const double y = distance * __builtin_cos(clipped / 57.3) * __builtin_sin(ra / 57.3);
        const double z = distance * __builtin_sin(clipped / 57.3);
        const int places = input == POINTS_Q30 ? 0 : digits;
        at += (size_t)snprintf(text + at, TEXT_BYTES - at, "%.*f %.*f %.*f\n", places, x, places, y,
                               places, z);
    }
}

static void check_input(enum points_input input) {
    static const double widths[] = {1e-7, 1e-4, 0.1, 1, 2.5};
    static const int digits[] = {3, 8, 15, 25};
    struct excess excess = {0, 0, 0};
    for (int i = 0; i < 6000 && check_clean(); i++) {
        char text[TEXT_BYTES];
        any_text(text, input, widths[i % 5], digits[i / 5 % 4]);
        check_text(text, input, &excess);
        if (!check_clean()) {
            printf("%s", text);
        }
    }
    check_note("feasible sets", excess.feasible);
    check_note("most above the true angle, 1e-18 degrees", (int64_t)(excess.worst_pdeg * 1e6));
    check_note("most above it in BAM, millionths", (int64_t)(excess.worst_bam * 1e6));
    CHECK(excess.feasible > 3000);
    CHECK(excess.worst_pdeg < 2);
    CHECK(excess.worst_bam < 1.0001);
}

static void the_cone_of_decimals(void) {
    check_input(POINTS_XYZ);
}

static void the_cone_of_directions(void) {
    check_input(POINTS_Q30);
}

static void the_cone_of_stars(void) {
    check_input(POINTS_RADEC);
}

// ---------------------------------------------------------------- exact angles

static struct measured_cone measure_text(struct vec3 axis, const char *text) {
    static const struct points_format format = {.input = POINTS_XYZ};
    struct points points;
    FILE *const stream = messages_input(text, strlen(text));
    CHECK_EQ(points_read_stream(stream, "f", &format, &points), EXIT_STATUS_OK);
    fclose(stream);
    const struct measured_cone cone = measure_cone(axis, &points);
    points_free(&points);
    return cone;
}

static void round_angles_stay_round(void) {
    static const struct {
        struct vec3 axis;
        const char *points;
        uint64_t pdeg;
    } cases[] = {
        {{5, 0, 0}, "7 0 0\n1e300 0 0\n", 0},
        {{1, 0, 0}, "2 1 1\n2 -1 -1\n", 35264389682755}, // atan(1 / sqrt 2), rounded up
        {{1, 1, 0}, "1 0 0\n0 1 0\n", 45 * MEASURE_DEGREE},
        {{1, 1, 0}, "1 0 1\n1 1 0\n", 60 * MEASURE_DEGREE},
        {{1, 1, 2}, "1 0 1\n", 30 * MEASURE_DEGREE},
        {{1, 0, 0}, "0 0 1\n1 1 0\n", 90 * MEASURE_DEGREE},
        // One part in 10^16 beyond: not 45 any more, and not below the truth.
        {{1, 1, 0}, "1 0 0\n-0.0000000000000001 1 0\n", 45 * MEASURE_DEGREE + 1},
        {{1, 1, 0}, "1 0.0000000000000001 0\n", 45 * MEASURE_DEGREE},
        {{1, 0, 0}, "-1e-17 0 1\n", 90 * MEASURE_DEGREE + 1},
        {{1, 0, 0}, "-3 0 0\n", 180 * MEASURE_DEGREE + 1}, // behind: rounded up like any other
        {{1, 0, 0}, "1 1e-200 0\n", 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct measured_cone cone = measure_text(cases[i].axis, cases[i].points);
        if (!CHECK_NEAR(cone.half_angle_pdeg, cases[i].pdeg, 0)) {
            printf("  case %zu\n", i);
        }
    }
    CHECK_EQ(measure_text(vec3(1, 1, 0), "1 0 0\n0 1 0\n").half_angle_bam32.bam, 1 << 29);
    CHECK_EQ(measure_text(vec3(1, 0, 0), "0 1 0\n").half_angle_bam32.bam, 1 << 30);
}

static bool close_to(double a, double b) {
    return CHECK(__builtin_fabs(a - b) <= 1e-15 * __builtin_fabs(b));
}

static void pictures_and_angles(void) {
    close_to(measure_tangent(45 * MEASURE_DEGREE), 1);
    close_to(measure_secant(60 * MEASURE_DEGREE), 2);
    close_to(measure_tangent(0) + 1, 1);
    close_to(measure_secant(0), 1);
    // A pico-degree below 90: 180e12 / pi.
    close_to(measure_tangent(90 * MEASURE_DEGREE - 1), 57295779513082.32);
    close_to(measure_secant(90 * MEASURE_DEGREE - 1), 57295779513082.32);
    close_to(measure_pan_deg(vec3(0, -1, 0)), 180);
    close_to(measure_pan_deg(vec3(-1, -1, 5)), -135);
    close_to(measure_pan_deg(vec3(0, 0, 5)) + 1, 1);
    close_to(measure_pan_deg(vec3(0, 0, -5)) + 1, 1);
    close_to(measure_tilt_deg(vec3(0, 0, -5)), -90);
    close_to(measure_tilt_deg(vec3(0, 3, 3)), 45);
}

int main(void) {
    printf("# seed 0x%016llx\n", (unsigned long long)seed);
    for (int i = 0; i < 8; i++) {
        mpfr_init2(scratch[i], BITS);
    }
    TEST(the_cone_of_decimals);
    TEST(the_cone_of_directions);
    TEST(the_cone_of_stars);
    TEST(round_angles_stay_round);
    TEST(pictures_and_angles);
    for (int i = 0; i < 8; i++) {
        mpfr_clear(scratch[i]);
    }
    mpfr_free_cache();
    return check_finish();
}
