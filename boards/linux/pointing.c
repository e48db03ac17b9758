#include "pointing.h"

#include <math.h>
#include <string.h>

#define ROUNDS     200
#define STEP_DEG   1e-5 ///< of the differences
#define SMALL_DEG  1e-10
#define PARAMETERS 4
#define RADIANS    (3.14159265358979323846 / 180.0)
/// Below this share of the largest pivot the sightings say nothing of a parameter.
#define PIVOT_LEAST 1e-9

static void turn(double *a, double *b, double deg) {
    const double c = cos(deg * RADIANS), s = sin(deg * RADIANS), old = *a;
    *a = c * old + s * *b;
    *b = c * *b - s * old;
}

/// Where the camera looks: from the mount's axes (right, ahead, up) to the world's (east, north,
/// up).
static void look(const double p[PARAMETERS], const struct pointing_sighting *sighting,
                 double out[3]) {
    const double tilt = (sighting->tilt_deg + p[3]) * RADIANS, pan = sighting->pan_deg * RADIANS;
    double x = cos(tilt) * sin(pan), y = cos(tilt) * cos(pan), z = sin(tilt);
    turn(&x, &z, p[2]); // roll: the right side down
    turn(&z, &y, p[1]); // pitch: the nose up
    turn(&x, &y, p[0]); // heading: clockwise from north
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static double residuals(const struct pointing_sighting *sightings, size_t count,
                        const double p[PARAMETERS], double *out) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        double at[3];
        look(p, &sightings[i], at);
        for (unsigned k = 0; k < 3U; k++) {
            out[3U * i + k] = (at[k] - sightings[i].direction[k]) / RADIANS;
            sum += out[3U * i + k] * out[3U * i + k];
        }
    }
    return sum;
}

/// Solves a x = b in place, by elimination with pivots. False: singular.
static bool solve(double a[PARAMETERS][PARAMETERS], double b[PARAMETERS], unsigned n) {
    double largest = 0.0;
    for (unsigned k = 0; k < n; k++) {
        unsigned pivot = k;
        for (unsigned i = k + 1U; i < n; i++) {
            pivot = fabs(a[i][k]) > fabs(a[pivot][k]) ? i : pivot;
        }
        largest = fmax(largest, fabs(a[pivot][k]));
        if (!(fabs(a[pivot][k]) > PIVOT_LEAST * largest)) {
            return false;
        }
        for (unsigned j = 0; j < n; j++) {
            const double kept = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        const double kept = b[k];
        b[k] = b[pivot];
        b[pivot] = kept;
        for (unsigned i = k + 1U; i < n; i++) {
            const double share = a[i][k] / a[k][k];
            for (unsigned j = k; j < n; j++) {
                a[i][j] -= share * a[k][j];
            }
            b[i] -= share * b[k];
        }
    }
    for (unsigned k = n; k-- > 0U;) {
        for (unsigned j = k + 1U; j < n; j++) {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    return true;
}

/// The normal equations at p.
static void linearise(const struct pointing_sighting *sightings, size_t count, const double *p,
                      unsigned n, const double *at, double a[PARAMETERS][PARAMETERS],
                      double b[PARAMETERS]) {
    static double slope[PARAMETERS][3 * POINTING_SIGHTINGS_MAX];
    for (unsigned k = 0; k < n; k++) {
        double moved[PARAMETERS];
        memcpy(moved, p, sizeof moved);
        moved[k] += STEP_DEG;
        (void)residuals(sightings, count, moved, slope[k]);
        for (size_t i = 0; i < 3U * count; i++) {
            slope[k][i] = (slope[k][i] - at[i]) / STEP_DEG;
        }
    }
    for (unsigned k = 0; k < n; k++) {
        b[k] = 0.0;
        for (size_t i = 0; i < 3U * count; i++) {
            b[k] -= slope[k][i] * at[i];
        }
        for (unsigned j = 0; j < n; j++) {
            a[k][j] = 0.0;
            for (size_t i = 0; i < 3U * count; i++) {
                a[k][j] += slope[k][i] * slope[j][i];
            }
        }
    }
}

static double in_half_turn(double deg) {
    return deg - 360.0 * floor(deg / 360.0 + 0.5);
}

bool pointing_fit(const struct pointing_sighting *sightings, size_t count, bool with_offset,
                  struct pointing_model *model, double *rms_deg) {
    static double at[3 * POINTING_SIGHTINGS_MAX], next[3 * POINTING_SIGHTINGS_MAX];
    double p[PARAMETERS] = {model->heading_deg, model->pitch_deg, model->roll_deg,
                            model->tilt_offset_deg};
    const unsigned n = with_offset ? 4U : 3U;
    if (count < n - 1U || count > POINTING_SIGHTINGS_MAX) {
        return false;
    }
    double sum = residuals(sightings, count, p, at), damping = 1e-3, largest = 1.0;
    for (int round = 0; round < ROUNDS && largest > SMALL_DEG; round++) {
        double a[PARAMETERS][PARAMETERS], b[PARAMETERS], moved[PARAMETERS];
        linearise(sightings, count, p, n, at, a, b);
        double plain[PARAMETERS][PARAMETERS], unused[PARAMETERS] = {0};
        memcpy(plain, a, sizeof plain);
        if (!solve(plain, unused, n)) {
            return false;
        }
        for (unsigned k = 0; k < n; k++) {
            a[k][k] *= 1.0 + damping;
        }
        memcpy(moved, p, sizeof moved);
        if (!solve(a, b, n)) {
            return false;
        }
        largest = 0.0;
        for (unsigned k = 0; k < n; k++) {
            moved[k] += b[k];
            largest = fmax(largest, fabs(b[k]));
        }
        const double better = residuals(sightings, count, moved, next);
        if (better <= sum) {
            sum = better;
            memcpy(p, moved, sizeof p);
            memcpy(at, next, sizeof at);
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
    }
    p[1] = in_half_turn(p[1]);
    if (fabs(p[1]) > 90.0) { // the same attitude, as a person would say it
        p[0] += 180.0;
        p[1] = 180.0 - p[1];
        p[2] += 180.0;
    }
    *model =
        (struct pointing_model){in_half_turn(p[0]), in_half_turn(p[1]), in_half_turn(p[2]), p[3]};
    *rms_deg = sqrt(sum / (double)count);
    return true;
}
