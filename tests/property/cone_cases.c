/// The recorded cones of tests/vectors/cones, all sizes: cone_narrowest against their exact answers
/// and by certificate; and that the table for boards is the same cases.
#include "check.h"
#include "property/support/cone_check.h"
#include "property/support/cone_sets.h"
#include "property/support/methods.h"
#include "vectors/cones/table.h"

#include "sphere/cone.h"

#include <glob.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FOLDER    "tests/vectors/cones/"
#define COUNT_MAX 2000

struct cone_case {
    char name[64];
    bool feasible;
    char axis[3][40], half_angle_rad[40];
    uint64_t half_angle_turn64;
    uint32_t count;
    struct vec3 point[COUNT_MAX];
};

static bool read_note(struct cone_case *cone, const char *line) {
    unsigned long long turn;
    if (strcmp(line, "# feasible\n") == 0 || strcmp(line, "# infeasible\n") == 0) {
        cone->feasible = line[2] == 'f';
    } else if (sscanf(line, "# half_angle_turn64 %llu", &turn) == 1) {
        cone->half_angle_turn64 = turn;
    } else {
        return sscanf(line, "# axis %39s %39s %39s", cone->axis[0], cone->axis[1], cone->axis[2]) ==
                   3 ||
               sscanf(line, "# half_angle_rad %39s", cone->half_angle_rad) == 1 ||
               strncmp(line, "# support ", 10) == 0;
    }
    return true;
}

static bool read_case(struct cone_case *cone, const char *path) {
    memset(cone, 0, sizeof *cone);
    const size_t size = strlen(path) - strlen(FOLDER) - strlen(".txt");
    FILE *file = fopen(path, "r");
    if (!CHECK(file != NULL) || !CHECK(size < sizeof cone->name)) {
        return false;
    }
    memcpy(cone->name, path + strlen(FOLDER), size);
    char line[256];
    bool right = true;
    while (right && fgets(line, sizeof line, file) != NULL) {
        struct vec3 *p = &cone->point[cone->count];
        if (line[0] == '#') {
            right = CHECK(read_note(cone, line));
        } else {
            right = CHECK(cone->count < COUNT_MAX) &&
                    CHECK_EQ(sscanf(line, "%d %d %d", &p->x, &p->y, &p->z), 3);
            cone->count++;
        }
    }
    fclose(file);
    return right;
}

// ---------------------------------------------------------------- against the recorded answer

static double excess_rad_max, gap_rad_max, recorded_rad_max;

static enum cone_status solve(const struct cone_case *cone, enum cone_lengths lengths,
                              struct cone_result *result) {
    static int64_t workspace[CONE_WORKSPACE_BYTES(COUNT_MAX) / sizeof(int64_t) + 1U];
    const struct cone_options options = {
        .lengths = lengths, .workspace = workspace, .workspace_bytes = sizeof workspace};
    return cone_narrowest(cone->point, cone->count, &options, result);
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

/// The recorded half-angle is that of the certificate, and its turn64 form the same rounded down.
static bool check_record(const struct cone_case *cone, const struct cone_report *report) {
    mpfr_t recorded, turn;
    mpfr_inits2(200, recorded, turn, (mpfr_ptr)NULL);
    mpfr_set_str(recorded, cone->half_angle_rad, 10, MPFR_RNDN);
    mpfr_const_pi(turn, MPFR_RNDN);
    mpfr_div(turn, recorded, turn, MPFR_RNDN);
    mpfr_mul_2ui(turn, turn, 63, MPFR_RNDN);
    const uint64_t turn64 = mpfr_get_uj(turn, MPFR_RNDD);
    mpfr_sub_d(recorded, recorded, report->half_angle_rad, MPFR_RNDN);
    mpfr_abs(recorded, recorded, MPFR_RNDN);
    const double apart = mpfr_get_d(recorded, MPFR_RNDU);
    mpfr_clears(recorded, turn, (mpfr_ptr)NULL);
    recorded_rad_max = larger(recorded_rad_max, apart);
    return CHECK_EQ(turn64, cone->half_angle_turn64) && CHECK(apart <= 2.3e-16); // a double's ulp
}

static bool check_case(const struct cone_case *cone, enum cone_lengths lengths) {
    struct cone_result result;
    struct cone_report report;
    const enum cone_status status = solve(cone, lengths, &result);
    const char *wrong = cone_check(cone->point, cone->count, status, &result, &report);
    if (wrong != NULL) {
        printf("  # %s: %s\n", cone->name, wrong);
    }
    if (!CHECK(wrong == NULL) || !CHECK_EQ(status, cone->feasible ? CONE_OK : CONE_INFEASIBLE)) {
        return false;
    }
    if (status != CONE_OK) {
        return true;
    }
    excess_rad_max = larger(excess_rad_max, report.excess_rad);
    gap_rad_max = larger(gap_rad_max, report.support_gap_rad);
    const int32_t axis[3] = {result.axis_q30.x, result.axis_q30.y, result.axis_q30.z};
    for (unsigned i = 0; i < 3U; i++) { // recorded to 25 digits, printed to 2^-30
        CHECK(fabs(strtod(cone->axis[i], NULL) * 0x1p30 - axis[i]) <= 1.0);
    }
    return CHECK(report.excess_rad <= CONE_EXCESS_RAD_MAX) && check_record(cone, &report);
}

/// The other methods, by certificate and against the recorded axis. On a ring of hundreds of
/// corners the pyramid of 1982 would try millions of triples.
static bool check_methods(const struct cone_case *cone) {
    for (unsigned m = 0; m < METHOD_COUNT; m++) {
        if (m == METHOD_PYRAMID && strncmp(cone->name, "ring_n720", 9) == 0) {
            continue;
        }
        struct cone_result result;
        struct cone_report report;
        const enum cone_status status = methods[m].solve(cone->point, cone->count, &result);
        const char *wrong = cone_check(cone->point, cone->count, status, &result, &report);
        if (wrong != NULL || !CHECK_EQ(status, cone->feasible ? CONE_OK : CONE_INFEASIBLE)) {
            printf("  # %s by %s: %s\n", cone->name, methods[m].name, wrong);
            return CHECK(wrong == NULL);
        }
        const int32_t axis[3] = {result.axis_q30.x, result.axis_q30.y, result.axis_q30.z};
        for (unsigned i = 0; cone->feasible && i < 3U; i++) {
            if (!CHECK(fabs(strtod(cone->axis[i], NULL) * 0x1p30 - axis[i]) <= 1.5)) {
                printf("  # %s by %s\n", cone->name, methods[m].name);
                return false;
            }
        }
    }
    return true;
}

static bool all_unit(const struct cone_case *cone) {
    for (uint32_t i = 0; i < cone->count; i++) {
        if (!cone_sets_is_unit(cone->point[i])) {
            return false;
        }
    }
    return true;
}

static const struct cone_vector *find_in_table(const char *name) {
    for (size_t i = 0; i < CONE_VECTOR_COUNT; i++) {
        if (strcmp(cone_vectors[i].name, name) == 0) {
            return &cone_vectors[i];
        }
    }
    return NULL;
}

static bool check_table(const struct cone_case *cone) {
    const struct cone_vector *vector = find_in_table(cone->name);
    if (vector == NULL) {
        return CHECK(cone->count > CONE_VECTOR_POINTS_MAX);
    }
    const struct vec3 axis = vector->axis_q30;
    return CHECK_EQ(vector->count, cone->count) &&
           CHECK(memcmp(&cone_vector_points[vector->first], cone->point,
                        cone->count * sizeof *cone->point) == 0) &&
           CHECK_EQ(vector->half_angle_turn64, cone->half_angle_turn64) &&
           CHECK_EQ((axis.x | axis.y | axis.z) != 0, cone->feasible) &&
           (!cone->feasible || (CHECK(fabs(strtod(cone->axis[0], NULL) * 0x1p30 - axis.x) <= 0.5) &&
                                CHECK(fabs(strtod(cone->axis[1], NULL) * 0x1p30 - axis.y) <= 0.5) &&
                                CHECK(fabs(strtod(cone->axis[2], NULL) * 0x1p30 - axis.z) <= 0.5)));
}

static void recorded_cones(void) {
    static struct cone_case cone;
    glob_t files;
    unsigned infeasible = 0, in_table = 0;
    if (!CHECK_EQ(glob(FOLDER "*.txt", 0, NULL, &files), 0)) {
        return;
    }
    for (size_t i = 0; i < files.gl_pathc; i++) {
        bool right = read_case(&cone, files.gl_pathv[i]) && check_table(&cone) &&
                     check_case(&cone, CONE_LENGTHS_ANY) && check_methods(&cone);
        right = right && (!all_unit(&cone) || check_case(&cone, CONE_LENGTHS_UNIT));
        infeasible += !cone.feasible;
        in_table += find_in_table(cone.name) != NULL;
        if (!right) {
            printf("  # in %s\n", files.gl_pathv[i]);
        }
    }
    printf("# %zu cases, %u infeasible, %u in the table for boards\n", files.gl_pathc, infeasible,
           in_table);
    printf("# worst excess %.3f nrad, support gap %.1e rad; records differ by %.1e rad\n",
           excess_rad_max * 1e9, gap_rad_max, recorded_rad_max);
    CHECK(files.gl_pathc >= 109U);
    CHECK_EQ(in_table, CONE_VECTOR_COUNT);
    globfree(&files);
}

int main(void) {
    TEST(recorded_cones);
    cone_check_free();
    return check_finish();
}
