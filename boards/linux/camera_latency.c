#include "camera_latency.h"

#include <math.h>
#include <string.h>

#define APART_US     1000U
#define SIGHTS_MIN   20U
#define TURN_DEG_MIN 3.0 ///< that the gimbal turns in all
#define GRID_MS      10
#define LENS_STEPS   24 ///< of a golden section: to 1.5e-5
/// With another latency, two steps of the grid away, the scatter is so many times more.
#define SHARP 1.5

void camera_latency_init(struct camera_latency *latency, const struct mount *mount,
                         const struct camera_seat *seat) {
    latency->mount = *mount;
    latency->seat = *seat;
    latency->pose_count = latency->sight_count = latency->id_count = 0;
}

void camera_latency_pose(struct camera_latency *latency, uint32_t at_us,
                         const struct camera_pose *pose) {
    const uint32_t count = latency->pose_count;
    if (count == CAMERA_LATENCY_POSES ||
        (count > 0U && at_us - latency->pose_us[count - 1U] < APART_US)) {
        return;
    }
    latency->pose_us[count] = at_us;
    latency->pose[count] = *pose;
    latency->pose_count++;
}

void camera_latency_sight(struct camera_latency *latency, uint32_t stamp_us, uint32_t id,
                          const double ray[3]) {
    uint32_t thing = 0;
    while (thing < latency->id_count && latency->id[thing] != id) {
        thing++;
    }
    if (thing == CAMERA_LATENCY_IDS || latency->sight_count == CAMERA_LATENCY_SIGHTS) {
        return;
    }
    latency->id_count += thing == latency->id_count;
    latency->id[thing] = id;
    struct camera_latency_sight *sight = &latency->sight[latency->sight_count++];
    *sight = (struct camera_latency_sight){.stamp_us = stamp_us, .thing = thing};
    memcpy(sight->ray, ray, sizeof sight->ray);
}

/// Linear between the poses around that time. False: it is before the first or after the last.
static bool pose_at(const struct camera_latency *latency, double at_us, struct camera_pose *pose) {
    const uint32_t base_us = latency->pose_us[0];
    uint32_t low = 0, high = latency->pose_count - 1U;
    if (!(at_us >= 0.0) || at_us > (double)(latency->pose_us[high] - base_us)) {
        return false;
    }
    while (high - low > 1U) {
        const uint32_t middle = (low + high) / 2U;
        if ((double)(latency->pose_us[middle] - base_us) <= at_us) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const double from_us = (double)(latency->pose_us[low] - base_us);
    const double part = (at_us - from_us) / (double)(latency->pose_us[high] - base_us - from_us);
    const struct camera_pose *a = &latency->pose[low], *b = &latency->pose[high];
    *pose = (struct camera_pose){a->pan_deg + part * (b->pan_deg - a->pan_deg),
                                 a->tilt_deg + part * (b->tilt_deg - a->tilt_deg), a->zoom};
    return true;
}

/// What a lens so many times as long as the model would have made of the same pixel.
static void through_lens(const double ray[3], double lens, double out[3]) {
    const double x = ray[0] / lens, y = ray[1], z = ray[2] / lens;
    const double length = sqrt(x * x + y * y + z * z);
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
}

/// Mean square of the distances from the middles, in radians; few: nothing can be said.
static double scatter(const struct camera_latency *latency, double latency_ms, double lens,
                      uint32_t *count) {
    double sum[CAMERA_LATENCY_IDS][3] = {{0.0}};
    uint32_t seen[CAMERA_LATENCY_IDS] = {0};
    *count = 0;
    for (uint32_t i = 0; i < latency->sight_count; i++) {
        const struct camera_latency_sight *sight = &latency->sight[i];
        struct camera_pose pose;
        const double at_us =
            (double)(int32_t)(sight->stamp_us - latency->pose_us[0]) - latency_ms * 1e3;
        if (!pose_at(latency, at_us, &pose)) {
            continue;
        }
        const struct camera_view view = camera_view_at(&latency->mount, &latency->seat, &pose);
        double ray[3], world[3];
        through_lens(sight->ray, lens, ray);
        camera_view_to_world(&view, ray, world);
        for (unsigned axis = 0; axis < 3U; axis++) {
            sum[sight->thing][axis] += world[axis];
        }
        seen[sight->thing]++;
        (*count)++;
    }
    // Of unit vectors: the sum of the squared distances from their mean is n - |sum|^2 / n.
    double squares = 0.0;
    for (uint32_t thing = 0; thing < latency->id_count; thing++) {
        const double *s = sum[thing];
        const double n = (double)seen[thing];
        squares += seen[thing] > 0U ? n - (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / n : 0.0;
    }
    return *count > 0U ? squares / (double)*count : INFINITY;
}

static bool turns_enough(const struct camera_latency *latency) {
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < latency->pose_count; i++) {
        const double at = latency->pose[i].pan_deg + latency->pose[i].tilt_deg;
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return high - low >= TURN_DEG_MIN;
}

/// The least of three values a step apart, by a parabola.
static double vertex(double before, double at, double after) {
    const double bend = before - 2.0 * at + after;
    return bend > 0.0 ? 0.5 * (before - after) / bend : 0.0;
}

/// The least on a grid of whole steps around a middle.
static double least_around(const struct camera_latency *latency, double middle_ms, int steps,
                           double step_ms, double lens, uint32_t few) {
    double least = INFINITY, least_ms = middle_ms;
    for (int i = -steps; i <= steps; i++) {
        uint32_t count;
        const double at_ms = middle_ms + i * step_ms, value = scatter(latency, at_ms, lens, &count);
        if (count >= few && value < least) {
            least = value;
            least_ms = at_ms;
        }
    }
    return least_ms;
}

/// The lens that scatters least: by golden section, since the scatter has one valley in 1 / lens.
static double best_lens(const struct camera_latency *latency, double latency_ms) {
    const double section = 0.6180339887498949;
    double low = 1.0 / CAMERA_LATENCY_LENS_MAX, high = 1.0 / CAMERA_LATENCY_LENS_MIN;
    uint32_t count;
    double left = high - section * (high - low), right = low + section * (high - low);
    double at_left = scatter(latency, latency_ms, 1.0 / left, &count);
    double at_right = scatter(latency, latency_ms, 1.0 / right, &count);
    for (int i = 0; i < LENS_STEPS; i++) {
        if (at_left < at_right) {
            high = right;
            right = left;
            at_right = at_left;
            left = high - section * (high - low);
            at_left = scatter(latency, latency_ms, 1.0 / left, &count);
        } else {
            low = left;
            left = right;
            at_left = at_right;
            right = low + section * (high - low);
            at_right = scatter(latency, latency_ms, 1.0 / right, &count);
        }
    }
    return 2.0 / (low + high);
}

const char *camera_latency_fit(const struct camera_latency *latency,
                               struct camera_latency_found *found) {
    if (latency->sight_count < SIGHTS_MIN || latency->pose_count < SIGHTS_MIN) {
        return "the camera saw nothing for long enough";
    }
    if (!turns_enough(latency)) {
        return "the gimbal did not turn";
    }
    const uint32_t few = latency->sight_count / 2U;
    const double middle_ms = 0.5 * (CAMERA_LATENCY_MS_MAX + CAMERA_LATENCY_MS_MIN);
    const int steps = (CAMERA_LATENCY_MS_MAX - CAMERA_LATENCY_MS_MIN) / (2 * GRID_MS);
    const double coarse_ms = least_around(latency, middle_ms, steps, GRID_MS, 1.0, few);
    const double near_lens = best_lens(latency, coarse_ms);
    const double fine_ms = least_around(latency, coarse_ms, GRID_MS, 1.0, near_lens, few);
    const double lens = best_lens(latency, fine_ms);
    uint32_t count;
    const double before = scatter(latency, fine_ms - 1.0, lens, &count);
    const double after = scatter(latency, fine_ms + 1.0, lens, &count);
    const double least = scatter(latency, fine_ms, lens, &count);
    const double aside = fmin(scatter(latency, fine_ms - 2.0 * GRID_MS, lens, &count),
                              scatter(latency, fine_ms + 2.0 * GRID_MS, lens, &count));
    if (coarse_ms <= CAMERA_LATENCY_MS_MIN || coarse_ms >= CAMERA_LATENCY_MS_MAX ||
        lens < 1.01 * CAMERA_LATENCY_LENS_MIN || lens > 0.99 * CAMERA_LATENCY_LENS_MAX ||
        aside < SHARP * SHARP * least) {
        return "what the camera saw does not stand still, or the gimbal turned too slowly";
    }
    *found = (struct camera_latency_found){.latency_ms = fine_ms + vertex(before, least, after),
                                           .lens = lens,
                                           .rms_deg = sqrt(fmax(least, 0.0)) *
                                                      (180.0 / 3.14159265358979323846)};
    return NULL;
}
