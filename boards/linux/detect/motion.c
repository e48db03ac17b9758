#include "detect/motion.h"

#include "detect/background.h"
#include "detect/components.h"
#include "detect/tracks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WORK_WIDTH_PX = 320, FINDS_MAX = 128, RUNS_MAX = 1 << 16 };

/// The mask is widened by so much before its pieces are joined: legs and a body in shade.
enum { WIDER_U = 1, WIDER_V = 2 };

/// The frame is put in place of the background from this shift on, in pixels of the work picture.
#define SHIFT_SEEN_PX 0.25
/// After a camera came to rest its last poses may still be a little off.
#define UNSTEADY_S 1.0
/// More than this much foreground is no object: the light went on, or the pose was wrong.
#define FOREGROUND_MOST 0.5

static const struct tracks_settings track_settings = {.first_id = DETECTION_MOVING_ID,
                                                      .frames_to_confirm = 3,
                                                      .keep_s = 1.0,
                                                      .gate_px = 5.0,
                                                      .gate_sizes = 0.6,
                                                      .speed_gain = 0.3};

struct motion {
    struct motion_settings settings;
    uint32_t bin;                 ///< pixels of the frame by those of the work picture
    uint32_t width_px, height_px; ///< of the work picture
    struct background background;
    struct components components;
    struct tracks tracks;
    uint8_t *picture, *placed, *known, *mask, *joined, *scratch;
    int32_t *source;
    // The pose that the background has, if poses are known, and that of the last frame.
    bool has_anchor, is_new;
    struct camera_model model; ///< of the work picture
    struct camera_view anchor, last;
    double unsteady_s;
    struct track_find find[FINDS_MAX];
    uint32_t find_count;
};

struct motion_settings motion_defaults(uint32_t width_px, uint32_t height_px) {
    return (struct motion_settings){.contrast_min = 18,
                                    .area_px_min = width_px * height_px / 2000U,
                                    .absorb_s = 15.0,
                                    .quiet_s = 0.5};
}

struct motion *motion_create(const struct motion_settings *settings, uint32_t width_px,
                             uint32_t height_px) {
    struct motion *motion = calloc(1, sizeof *motion);
    if (motion == NULL) {
        return NULL;
    }
    motion->settings = *settings;
    motion->bin = (width_px + WORK_WIDTH_PX / 2U) / WORK_WIDTH_PX;
    motion->bin = motion->bin == 0U ? 1U : motion->bin;
    motion->width_px = width_px / motion->bin;
    motion->height_px = height_px / motion->bin;
    const size_t pixels = (size_t)motion->width_px * motion->height_px;
    motion->picture = calloc(pixels, 6U);
    motion->source = calloc(pixels, sizeof *motion->source);
    const bool background =
        background_create(&motion->background, motion->width_px, motion->height_px);
    const bool components = components_create(&motion->components, RUNS_MAX, FINDS_MAX);
    if (motion->picture == NULL || motion->source == NULL || !background || !components) {
        motion_destroy(motion);
        return NULL;
    }
    motion->placed = motion->picture + pixels;
    motion->known = motion->placed + pixels;
    motion->mask = motion->known + pixels;
    motion->joined = motion->mask + pixels;
    motion->scratch = motion->joined + pixels;
    tracks_init(&motion->tracks, &track_settings);
    return motion;
}

void motion_destroy(struct motion *motion) {
    if (motion != NULL) {
        background_destroy(&motion->background);
        components_destroy(&motion->components);
        free(motion->picture);
        free(motion->source);
        free(motion);
    }
}

static void shrink(const struct motion *motion, const struct hal_camera_luma *frame) {
    const uint32_t bin = motion->bin;
    for (uint32_t v = 0; v < motion->height_px; v++) {
        for (uint32_t u = 0; u < motion->width_px; u++) {
            uint32_t sum = bin * bin / 2U;
            for (uint32_t y = 0; y < bin; y++) {
                const uint8_t *row =
                    frame->luma + (size_t)(v * bin + y) * frame->stride_bytes + (size_t)u * bin;
                for (uint32_t x = 0; x < bin; x++) {
                    sum += row[x];
                }
            }
            motion->picture[(size_t)v * motion->width_px + u] = (uint8_t)(sum / (bin * bin));
        }
    }
}

// ---------------------------------------------------------------- a camera that turns

/// Where what `from` shows at a pixel is in `to`.
static bool carry(const struct camera_model *model, const struct camera_view *from,
                  const struct camera_view *to, const double pixel[2], double out[2]) {
    double ray[3], world[3], camera[3];
    if (!camera_model_ray(model, pixel, ray)) {
        return false;
    }
    camera_view_to_world(from, ray, world);
    camera_view_from_world(to, world, camera);
    return camera_model_project(model, camera, out);
}

/// How far the picture moves between two views at most, by its middle and two corners.
static double shift_px(const struct motion *motion, const struct camera_view *from,
                       const struct camera_view *to) {
    const double right = motion->width_px - 1.0, bottom = motion->height_px - 1.0;
    const double places[3][2] = {{right / 2.0, bottom / 2.0}, {0.0, 0.0}, {right, bottom}};
    double most = 0.0;
    for (unsigned i = 0; i < 3U; i++) {
        double out[2];
        if (!carry(&motion->model, from, to, places[i], out)) {
            return INFINITY;
        }
        most = fmax(most, hypot(out[0] - places[i][0], out[1] - places[i][1]));
    }
    return most;
}

struct turn {
    const struct motion *motion;
    struct camera_view from, to;
};

static void move_track(void *context, double pixel[2]) {
    const struct turn *turn = context;
    double out[2];
    if (carry(&turn->motion->model, &turn->from, &turn->to, pixel, out)) {
        pixel[0] = out[0];
        pixel[1] = out[1];
    } else {
        pixel[0] = pixel[1] = -1e6; // behind the camera
    }
}

/// The background gets the place of a new view.
static void move_anchor(struct motion *motion, const struct camera_view *view) {
    const int width = (int)motion->width_px, height = (int)motion->height_px;
    for (int v = 0; v < height; v++) {
        for (int u = 0; u < width; u++) {
            double out[2];
            const double pixel[2] = {u, v};
            int32_t *source = &motion->source[v * width + u];
            *source = -1;
            if (carry(&motion->model, view, &motion->anchor, pixel, out) && out[0] > -0.5 &&
                out[1] > -0.5 && out[0] < width - 0.5 && out[1] < height - 0.5) {
                *source = (int32_t)lround(out[1]) * width + (int32_t)lround(out[0]);
            }
        }
    }
    struct turn turn = {motion, motion->anchor, *view};
    tracks_move(&motion->tracks, move_track, &turn);
    motion->anchor = *view;
    if (!background_move(&motion->background, motion->source)) {
        background_forget(&motion->background);
    }
}

/// The frame as it would look from the anchor.
static void place_frame(struct motion *motion, const struct camera_view *view) {
    const int width = (int)motion->width_px, height = (int)motion->height_px;
    for (int v = 0; v < height; v++) {
        for (int u = 0; u < width; u++) {
            const size_t i = (size_t)v * motion->width_px + (size_t)u;
            const double pixel[2] = {u, v};
            double at[2];
            motion->known[i] = carry(&motion->model, &motion->anchor, view, pixel, at) &&
                               at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width - 1 &&
                               at[1] < height - 1;
            if (motion->known[i] == 0U) {
                continue;
            }
            const int x = (int)at[0], y = (int)at[1];
            const double right = at[0] - x, down = at[1] - y;
            const uint8_t *p = motion->picture + (size_t)y * motion->width_px + (size_t)x;
            const double upper = p[0] + (p[1] - p[0]) * right;
            const double lower = p[width] + (p[width + 1] - p[width]) * right;
            motion->placed[i] = (uint8_t)(upper + (lower - upper) * down + 0.5);
        }
    }
}

enum steadiness { STEADY, TURNED, TOO_FAST };

/// Brings background and frame to one place. *shown: the frame there.
static enum steadiness follow_turn(struct motion *motion, const struct detector_sight *sight,
                                   double elapsed_s, const uint8_t **shown) {
    *shown = motion->picture;
    if (sight->model == NULL) {
        return STEADY;
    }
    const struct camera_model model =
        camera_model_resized(sight->model, motion->width_px, motion->height_px);
    const bool other_zoom =
        motion->has_anchor && fabs(model.fx_px / motion->model.fx_px - 1.0) > 0.004;
    if (!motion->has_anchor || other_zoom) {
        background_forget(&motion->background);
        motion->model = model;
        motion->anchor = motion->last = sight->view;
        motion->has_anchor = true;
        return STEADY;
    }
    const double since_last = shift_px(motion, &motion->last, &sight->view);
    motion->last = sight->view;
    motion->unsteady_s = since_last > SHIFT_SEEN_PX ? UNSTEADY_S : motion->unsteady_s - elapsed_s;
    if (shift_px(motion, &motion->anchor, &sight->view) > motion->width_px / 8.0) {
        move_anchor(motion, &sight->view);
    }
    if (since_last > motion->width_px / 20.0) {
        return TOO_FAST;
    }
    if (shift_px(motion, &motion->anchor, &sight->view) > SHIFT_SEEN_PX) {
        place_frame(motion, &sight->view);
        *shown = motion->placed;
        return TURNED;
    }
    return motion->unsteady_s > 0.0 ? TURNED : STEADY;
}

// ---------------------------------------------------------------- pieces

/// Drops pixels with fewer than two neighbours in the mask, then widens what is left.
static void join_pieces(const struct motion *motion) {
    const int width = (int)motion->width_px, height = (int)motion->height_px;
    const uint8_t *mask = motion->mask;
    memset(motion->scratch, 0, (size_t)width * (size_t)height);
    memset(motion->joined, 0, (size_t)width * (size_t)height);
    for (int v = 1; v + 1 < height; v++) {
        for (int u = 1; u + 1 < width; u++) {
            const uint8_t *at = mask + (size_t)v * (size_t)width + (size_t)u;
            if (at[0] == 0U) {
                continue;
            }
            int neighbours = -1;
            for (int y = -width; y <= width; y += width) {
                neighbours += (at[y - 1] != 0) + (at[y] != 0) + (at[y + 1] != 0);
            }
            motion->scratch[v * width + u] = neighbours >= 2;
        }
    }
    for (int v = WIDER_V; v + WIDER_V < height; v++) {
        for (int u = WIDER_U; u + WIDER_U < width; u++) {
            if (motion->scratch[v * width + u] == 0U) {
                continue;
            }
            for (int y = v - WIDER_V; y <= v + WIDER_V; y++) {
                memset(motion->joined + y * width + u - WIDER_U, 1, 2 * WIDER_U + 1);
            }
        }
    }
}

/// The box of a piece and what the mask holds in it.
static bool measure_piece(const struct motion *motion, const struct component *piece,
                          struct track_find *find) {
    uint64_t differs = 0;
    uint32_t area = 0;
    double box[4] = {1e9, 1e9, -1.0, -1.0};
    for (uint32_t v = piece->top; v <= piece->bottom; v++) {
        for (uint32_t u = piece->left; u <= piece->right; u++) {
            const size_t i = (size_t)v * motion->width_px + u;
            if (motion->scratch[i] != 0U) {
                differs += motion->mask[i];
                area++;
                box[0] = fmin(box[0], u);
                box[1] = fmin(box[1], v);
                box[2] = fmax(box[2], u);
                box[3] = fmax(box[3], v);
            }
        }
    }
    if (area * motion->bin * motion->bin < motion->settings.area_px_min) {
        return false;
    }
    *find = (struct track_find){
        .at = {0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])},
        .half_px = {0.5 * (box[2] - box[0] + 1.0), 0.5 * (box[3] - box[1] + 1.0)},
        .confidence = fmin(1.0, (double)differs / area / 64.0)};
    return true;
}

static void find_pieces(struct motion *motion) {
    join_pieces(motion);
    const struct component_picture picture = {motion->joined, motion->width_px, motion->height_px,
                                              motion->width_px};
    const uint32_t least = motion->settings.area_px_min / (motion->bin * motion->bin);
    (void)components_find(&motion->components, &picture, 1, least); // more than fit are noise
    motion->find_count = 0;
    for (uint32_t i = 0; i < motion->components.count; i++) {
        if (measure_piece(motion, &motion->components.item[i], &motion->find[motion->find_count])) {
            motion->find_count++;
        }
    }
}

// ---------------------------------------------------------------- results

static void append(const struct motion *motion, const struct track *track,
                   const struct detector_sight *sight, struct detections *out) {
    const double *half = motion->find[track->find].half_px;
    double at[2] = {track->at[0], track->at[1]};
    if (sight->model != NULL &&
        !carry(&motion->model, &motion->anchor, &sight->view, track->at, at)) {
        return;
    }
    if (out->count == DETECTIONS_MAX) {
        out->dropped++;
        return;
    }
    const double bin = motion->bin;
    // The middle of a work pixel is between those of the frame's pixels.
    const double u = at[0] * bin + 0.5 * (bin - 1.0), v = at[1] * bin + 0.5 * (bin - 1.0);
    const double seen = fmin(1.0, track->hits / 8.0);
    out->item[out->count++] = (struct detection){
        .kind = DETECTION_MOVING,
        .id = track->id,
        .pixel = {u, v},
        .radius_px = hypot(half[0], half[1]) * bin,
        .box_px = {u - half[0] * bin, v - half[1] * bin, u + half[0] * bin, v + half[1] * bin},
        .confidence = 0.5 * track->confidence + 0.5 * seen};
}

void motion_find(struct motion *motion, const struct hal_camera_luma *frame, double elapsed_s,
                 const struct detector_sight *sight, struct detections *out) {
    const struct background_settings background = {motion->settings.contrast_min,
                                                   motion->settings.absorb_s, 4.0};
    const uint8_t *shown;
    shrink(motion, frame);
    const enum steadiness steadiness = follow_turn(motion, sight, elapsed_s, &shown);
    motion->find_count = 0;
    if (steadiness != TOO_FAST) {
        const uint8_t *known = shown == motion->placed ? motion->known : NULL;
        const double share = background_take(&motion->background, &background, shown, known,
                                             elapsed_s, steadiness == TURNED, motion->mask);
        if (share <= FOREGROUND_MOST && motion->background.learned_s >= motion->settings.quiet_s) {
            find_pieces(motion);
        }
    }
    tracks_update(&motion->tracks, &track_settings, motion->find, motion->find_count, elapsed_s);
    for (uint32_t i = 0; i < TRACKS_MAX; i++) {
        const struct track *track = &motion->tracks.item[i];
        if (track->used && track->confirmed && track->find != UINT32_MAX) {
            append(motion, track, sight, out);
        }
    }
    for (uint32_t i = 0; i < motion->tracks.ended_count && out->gone_count < DETECTIONS_MAX; i++) {
        out->gone[out->gone_count++] = motion->tracks.ended[i];
    }
}
