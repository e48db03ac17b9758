#include "detect/markers.h"

#include <math.h>
#include <string.h>

enum { RUNS_MAX = 1 << 17, COMPONENTS_MAX = 4096 };

/// Pixels around a spot that are looked at for what surrounds it.
#define MARGIN_PX 4

struct markers_settings markers_defaults(uint32_t height_px) {
    return (struct markers_settings){.contrast_min = 40,
                                     .area_px_min = 6,
                                     .diameter_px_max = height_px / 2.0,
                                     .elongation_max = 2.5,
                                     .form_min = 0.8};
}

bool markers_create(struct markers_work *work) {
    memset(work, 0, sizeof *work);
    return components_create(&work->components, RUNS_MAX, COMPONENTS_MAX);
}

void markers_destroy(struct markers_work *work) {
    components_destroy(&work->components);
}

static struct component_picture picture_of(const struct hal_camera_luma *frame) {
    return (struct component_picture){frame->luma, frame->width_px, frame->height_px,
                                      frame->stride_bytes};
}

// ---------------------------------------------------------------- a spot and its surroundings

/// The spot's box, widened and cut off at the picture's edges; right and bottom are outside.
struct patch {
    int left, top, right, bottom;
};

static struct patch patch_around(const struct component *spot, int margin,
                                 const struct hal_camera_luma *frame) {
    struct patch patch = {(int)spot->left - margin, (int)spot->top - margin,
                          (int)spot->right + 1 + margin, (int)spot->bottom + 1 + margin};
    patch.left = patch.left < 0 ? 0 : patch.left;
    patch.top = patch.top < 0 ? 0 : patch.top;
    patch.right = patch.right > (int)frame->width_px ? (int)frame->width_px : patch.right;
    patch.bottom = patch.bottom > (int)frame->height_px ? (int)frame->height_px : patch.bottom;
    return patch;
}

/// By how much of its half axes a pixel is away from the middle of the ellipse through the spot's
/// second moments: below 1 is inside.
struct ellipse {
    double middle[2], uu, uv, vv; ///< of the inverse matrix
};

static struct ellipse ellipse_of(const struct component *spot, const double middle[2],
                                 double wider_px) {
    const double area = spot->area_px;
    const double u = (double)spot->sum_u / area, v = (double)spot->sum_v / area;
    const double room = wider_px * wider_px;
    // Four times the variance is the square of a half axis.
    const double uu = 4.0 * ((double)spot->sum_uu / area - u * u + 1.0 / 12.0);
    const double vv = 4.0 * ((double)spot->sum_vv / area - v * v + 1.0 / 12.0);
    const double uv = 4.0 * ((double)spot->sum_uv / area - u * v);
    // Each half axis gets wider by wider_px: (a + w)^2 = a^2 + 2 a w + w^2, a the mean one.
    const double mean = sqrt(fmax(0.5 * (uu + vv), 0.0));
    const double a = uu + 2.0 * mean * wider_px + room, b = vv + 2.0 * mean * wider_px + room;
    const double det = fmax(a * b - uv * uv, 1e-6);
    return (struct ellipse){{middle[0], middle[1]}, b / det, -uv / det, a / det};
}

static bool inside(const struct ellipse *ellipse, double u, double v) {
    const double x = u - ellipse->middle[0], y = v - ellipse->middle[1];
    return x * x * ellipse->uu + 2.0 * x * y * ellipse->uv + y * y * ellipse->vv < 1.0;
}

/// The median brightness of a ring of about three pixels around the spot, and of the spot.
struct levels {
    uint8_t around, inner;
    uint32_t around_count;
};

static uint8_t median_of(const uint32_t histogram[256], uint32_t count) {
    uint32_t below = 0;
    for (unsigned level = 0; level < 256U; level++) {
        below += histogram[level];
        if (2U * below >= count) {
            return (uint8_t)level;
        }
    }
    return 255;
}

static struct levels measure_levels(const struct hal_camera_luma *frame,
                                    const struct component *spot, const double middle[2]) {
    const struct patch patch = patch_around(spot, MARGIN_PX + 1, frame);
    const struct ellipse inner = ellipse_of(spot, middle, -0.3);
    const struct ellipse near = ellipse_of(spot, middle, 2.0);
    const struct ellipse wide = ellipse_of(spot, middle, MARGIN_PX + 1.0);
    uint32_t around[256] = {0}, within[256] = {0}, around_count = 0, within_count = 0;
    for (int v = patch.top; v < patch.bottom; v++) {
        const uint8_t *row = frame->luma + (size_t)v * frame->stride_bytes;
        for (int u = patch.left; u < patch.right; u++) {
            if (inside(&inner, u, v)) {
                within[row[u]]++;
                within_count++;
            } else if (inside(&wide, u, v) && !inside(&near, u, v)) {
                around[row[u]]++;
                around_count++;
            }
        }
    }
    return (struct levels){median_of(around, around_count), median_of(within, within_count),
                           around_count};
}

/// What the spot and the ellipse through its moments have in common, by what either has: 1 for an
/// ellipse, 0.87 for a square, 0.75 for an L.
static double overlap(const struct hal_camera_luma *frame, const struct component *spot,
                      uint8_t threshold, const double middle[2]) {
    const struct patch patch = patch_around(spot, 1, frame);
    const struct ellipse ellipse = ellipse_of(spot, middle, 0.0);
    uint32_t both = 0, either = 0;
    for (int v = patch.top; v < patch.bottom; v++) {
        const uint8_t *row = frame->luma + (size_t)v * frame->stride_bytes;
        for (int u = patch.left; u < patch.right; u++) {
            const bool bright = row[u] >= threshold, in = inside(&ellipse, u, v);
            both += bright && in;
            either += bright || in;
        }
    }
    return (double)both / either;
}

/// Centroid of what is brighter than the surroundings, near the spot. The lowest 15 % of the
/// contrast count as nothing, so that the noise and texture around it don't pull.
static bool centroid(const struct hal_camera_luma *frame, const struct component *spot,
                     const struct levels *levels, double middle[2]) {
    const struct patch patch = patch_around(spot, MARGIN_PX, frame);
    const struct ellipse near = ellipse_of(spot, middle, MARGIN_PX - 1.0);
    const double contrast = levels->inner - levels->around;
    const double floor = levels->around + 0.15 * contrast;
    const double most = levels->around + contrast;
    double sum = 0.0, sum_u = 0.0, sum_v = 0.0;
    for (int v = patch.top; v < patch.bottom; v++) {
        const uint8_t *row = frame->luma + (size_t)v * frame->stride_bytes;
        for (int u = patch.left; u < patch.right; u++) {
            if (row[u] > floor && inside(&near, u, v)) {
                const double weight = fmin(row[u], most) - floor;
                sum += weight;
                sum_u += weight * u;
                sum_v += weight * v;
            }
        }
    }
    if (!(sum > 0.0)) {
        return false;
    }
    middle[0] = sum_u / sum;
    middle[1] = sum_v / sum;
    return true;
}

/// Is the spot a marker?
static bool judge(const struct markers_settings *settings, const struct hal_camera_luma *frame,
                  const struct component *spot, uint8_t threshold, struct marker *marker) {
    const struct component_shape shape = component_shape_of(spot);
    if (spot->left == 0U || spot->top == 0U || spot->right + 1U >= frame->width_px ||
        spot->bottom + 1U >= frame->height_px ||
        shape.long_axis_px > settings->elongation_max * shape.short_axis_px ||
        2.0 * shape.long_axis_px > settings->diameter_px_max) {
        return false;
    }
    double middle[2] = {shape.middle[0], shape.middle[1]};
    // A spot of a few pixels is made of corners: its outline says little.
    const double form = overlap(frame, spot, threshold, middle) + 0.6 / sqrt(spot->area_px);
    if (form < settings->form_min) {
        return false;
    }
    const struct levels levels = measure_levels(frame, spot, middle);
    if (levels.around_count == 0U || levels.inner < levels.around + settings->contrast_min ||
        threshold < levels.around + (levels.inner - levels.around) / 4 ||
        !centroid(frame, spot, &levels, middle)) {
        return false;
    }
    const double contrast = (levels.inner - levels.around) / (255.0 - levels.around);
    *marker = (struct marker){.pixel = {middle[0], middle[1]},
                              .radius_px = shape.long_axis_px,
                              .box_px = {spot->left, spot->top, spot->right, spot->bottom},
                              .confidence = fmin(1.0, contrast) * fmin(1.0, form)};
    return true;
}

// ---------------------------------------------------------------- thresholds

static bool holds(const struct component *spot, const struct marker *marker) {
    return marker->pixel[0] >= spot->left && marker->pixel[0] <= spot->right &&
           marker->pixel[1] >= spot->top && marker->pixel[1] <= spot->bottom;
}

static void drop(struct markers_work *work, uint32_t i) {
    work->count--;
    work->item[i] = work->item[work->count];
    work->threshold[i] = work->threshold[work->count];
}

/// One spot at a lower threshold: takes the place of the marker in it, if it is one itself. Two or
/// more in it have run together.
static void consider(struct markers_work *work, const struct markers_settings *settings,
                     const struct hal_camera_luma *frame, const struct component *spot,
                     uint8_t threshold) {
    uint32_t held = 0, which = 0;
    for (uint32_t i = 0; i < work->count; i++) {
        if (holds(spot, &work->item[i])) {
            held++;
            which = i;
        }
    }
    struct marker marker;
    if (held > 1U || !judge(settings, frame, spot, threshold, &marker)) {
        return;
    }
    if (held == 1U) {
        drop(work, which);
    }
    if (work->count < MARKERS_MAX) {
        work->item[work->count] = marker;
        work->threshold[work->count++] = threshold;
    }
}

/// Thresholds from the brightest down to contrast_min above the median of the picture.
static uint32_t choose_levels(const struct hal_camera_luma *frame, uint8_t contrast_min,
                              uint8_t level[MARKERS_LEVELS]) {
    uint32_t histogram[256] = {0}, count = 0;
    for (uint32_t v = 0; v < frame->height_px; v += 2U) {
        const uint8_t *row = frame->luma + (size_t)v * frame->stride_bytes;
        for (uint32_t u = v / 2U % 2U; u < frame->width_px; u += 2U) {
            histogram[row[u]]++;
            count++;
        }
    }
    const unsigned low = median_of(histogram, count) + (contrast_min + 1U) / 2U;
    unsigned high = 255;
    while (high > 0U && histogram[high] == 0U) {
        high--;
    }
    uint32_t levels = 0;
    for (uint32_t i = 0; i < MARKERS_LEVELS; i++) {
        const unsigned at =
            high < low ? 0U : high - (high - low) * (2U * i + 1U) / (2U * MARKERS_LEVELS);
        if (at > low && (levels == 0U || level[levels - 1U] > at)) {
            level[levels++] = (uint8_t)at;
        }
    }
    return levels;
}

static void sort_by_row(struct markers_work *work) {
    for (uint32_t i = 1; i < work->count; i++) {
        const struct marker marker = work->item[i];
        uint32_t at = i;
        for (; at > 0U && work->item[at - 1U].pixel[1] > marker.pixel[1]; at--) {
            work->item[at] = work->item[at - 1U];
        }
        work->item[at] = marker;
    }
}

void markers_find(struct markers_work *work, const struct markers_settings *settings,
                  const struct hal_camera_luma *frame) {
    work->count = 0;
    uint8_t level[MARKERS_LEVELS];
    const uint32_t levels = choose_levels(frame, settings->contrast_min, level);
    const struct component_picture picture = picture_of(frame);
    for (uint32_t i = 0; i < levels; i++) {
        // Where a threshold gives more spots than fit, it is in the texture of the picture.
        if (!components_find(&work->components, &picture, level[i], settings->area_px_min)) {
            break;
        }
        for (uint32_t k = 0; k < work->components.count; k++) {
            consider(work, settings, frame, &work->components.item[k], level[i]);
        }
    }
    sort_by_row(work);
}
