#include "detect/detector.h"

#include "detect/markers.h"
#include "detect/motion.h"
#include "detect/tags.h"
#include "detect/tracks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct tracks_settings marker_tracks = {.first_id = DETECTION_MARKER_ID,
                                                     .frames_to_confirm = 2,
                                                     .keep_s = 0.5,
                                                     .gate_px = 12.0,
                                                     .gate_sizes = 1.0,
                                                     .speed_gain = 0.3};

/// A tag that is not seen for so long has gone. Longer than for markers: its number says for sure
/// that it is the same when it is seen again after a turn that blurred it.
#define TAG_KEEP_S 1.0

struct known_tag {
    uint32_t id;
    double unseen_s;
};

struct detector {
    struct detector_settings settings;
    struct tags *tags;
    uint32_t known_tag_count;
    struct known_tag known_tag[DETECTIONS_MAX];
    struct markers_settings marker_settings;
    struct markers_work markers;
    struct tracks marker_tracks;
    struct motion *motion;
    bool any_frame, has_view;
    uint32_t last_us;
    struct camera_model model; ///< of the last frame
    struct camera_view view;
};

const char *detection_kind_name(enum detection_kind kind) {
    static const char *const names[] = {"tag", "marker", "moving"};
    return names[kind];
}

// ---------------------------------------------------------------- settings

const char *detector_settings_read(struct detector_settings *settings, const char *names,
                                   uint32_t size) {
    static const char *const known[] = {"tags", "markers", "motion"};
    static char problem[128];
    memset(settings->wanted, 0, sizeof settings->wanted);
    for (uint32_t i = 0; i < size;) {
        const uint32_t length = (uint32_t)strcspn(names + i, ", \t");
        unsigned kind = 0;
        while (length > 0U && kind < DETECTION_KINDS &&
               (strlen(known[kind]) != length || memcmp(known[kind], names + i, length) != 0)) {
            kind++;
        }
        if (kind == DETECTION_KINDS) {
            snprintf(problem, sizeof problem, "no detector '%.*s': tags, markers or motion",
                     (int)(length < 40U ? length : 40U), names + i);
            return problem;
        }
        settings->wanted[kind] = settings->wanted[kind] || length > 0U;
        i += length + 1U;
    }
    if (settings->wanted[DETECTION_TAG] && tags_missing() != NULL) {
        return tags_missing();
    }
    return NULL;
}

struct detector *detector_create(const struct detector_settings *settings, uint32_t width_px,
                                 uint32_t height_px) {
    struct detector *detector = calloc(1, sizeof *detector);
    if (detector == NULL) {
        return NULL;
    }
    detector->settings = *settings;
    detector->marker_settings = markers_defaults(height_px);
    if (settings->contrast_min > 0U) {
        detector->marker_settings.contrast_min = settings->contrast_min;
    }
    struct motion_settings motion = motion_defaults(width_px, height_px);
    motion.area_px_min = settings->area_px_min > 0U ? settings->area_px_min : motion.area_px_min;
    tracks_init(&detector->marker_tracks, &marker_tracks);
    bool made = true;
    if (settings->wanted[DETECTION_TAG]) {
        detector->tags = tags_create(settings->tag_family);
        made = detector->tags != NULL;
    }
    if (settings->wanted[DETECTION_MARKER]) {
        made = markers_create(&detector->markers) && made;
    }
    if (settings->wanted[DETECTION_MOVING]) {
        detector->motion = motion_create(&motion, width_px, height_px);
        made = made && detector->motion != NULL;
    }
    if (!made) {
        detector_destroy(detector);
        return NULL;
    }
    return detector;
}

void detector_destroy(struct detector *detector) {
    if (detector != NULL) {
        tags_destroy(detector->tags);
        markers_destroy(&detector->markers);
        motion_destroy(detector->motion);
        free(detector);
    }
}

// ---------------------------------------------------------------- tags, remembered

static void remember_tag(struct detector *detector, uint32_t id) {
    uint32_t at = 0;
    while (at < detector->known_tag_count && detector->known_tag[at].id != id) {
        at++;
    }
    if (at == DETECTIONS_MAX) {
        return; // nobody will say that it has gone, but that it is there
    }
    detector->known_tag_count += at == detector->known_tag_count;
    detector->known_tag[at] = (struct known_tag){.id = id};
}

/// Tags that are in the frame are the only finds so far.
static void find_tags(struct detector *detector, const struct hal_camera_luma *frame,
                      double elapsed_s, const struct detector_sight *sight,
                      struct detections *out) {
    for (uint32_t i = 0; i < detector->known_tag_count; i++) {
        detector->known_tag[i].unseen_s += elapsed_s;
    }
    tags_find(detector->tags, frame, sight->model, out);
    for (uint32_t i = 0; i < out->count; i++) {
        remember_tag(detector, out->item[i].id);
    }
    for (uint32_t i = detector->known_tag_count; i-- > 0U;) {
        if (detector->known_tag[i].unseen_s > TAG_KEEP_S) {
            out->gone[out->gone_count++] = detector->known_tag[i].id;
            detector->known_tag[i] = detector->known_tag[--detector->known_tag_count];
        }
    }
}

// ---------------------------------------------------------------- markers, followed

/// From the pixel of the last frame to that of this one.
struct turned {
    const struct detector *detector;
    const struct detector_sight *sight;
};

static void move_track(void *context, double pixel[2]) {
    const struct turned *turned = context;
    double ray[3], world[3], camera[3], out[2];
    if (!camera_model_ray(&turned->detector->model, pixel, ray)) {
        return;
    }
    camera_view_to_world(&turned->detector->view, ray, world);
    camera_view_from_world(&turned->sight->view, world, camera);
    if (camera_model_project(turned->sight->model, camera, out)) {
        pixel[0] = out[0];
        pixel[1] = out[1];
    }
}

static void find_markers(struct detector *detector, const struct hal_camera_luma *frame,
                         double elapsed_s, const struct detector_sight *sight,
                         struct detections *out) {
    struct markers_work *work = &detector->markers;
    struct tracks *tracks = &detector->marker_tracks;
    struct track_find finds[MARKERS_MAX];
    markers_find(work, &detector->marker_settings, frame);
    for (uint32_t i = 0; i < work->count; i++) {
        const struct marker *marker = &work->item[i];
        finds[i] = (struct track_find){.at = {marker->pixel[0], marker->pixel[1]},
                                       .half_px = {marker->radius_px, marker->radius_px},
                                       .confidence = marker->confidence};
    }
    if (sight->model != NULL && detector->has_view) {
        struct turned turned = {detector, sight};
        tracks_move(tracks, move_track, &turned);
    }
    tracks_update(tracks, &marker_tracks, finds, work->count, elapsed_s);
    for (uint32_t i = 0; i < work->count; i++) {
        const struct track *track =
            finds[i].track != UINT32_MAX ? &tracks->item[finds[i].track] : NULL;
        if (track == NULL || !track->confirmed) {
            continue;
        }
        if (out->count == DETECTIONS_MAX) {
            out->dropped++;
            continue;
        }
        struct detection *detection = &out->item[out->count++];
        *detection = (struct detection){.kind = DETECTION_MARKER,
                                        .id = track->id,
                                        .pixel = {work->item[i].pixel[0], work->item[i].pixel[1]},
                                        .radius_px = work->item[i].radius_px,
                                        .confidence = work->item[i].confidence};
        memcpy(detection->box_px, work->item[i].box_px, sizeof detection->box_px);
    }
    for (uint32_t i = 0; i < tracks->ended_count && out->gone_count < DETECTIONS_MAX; i++) {
        out->gone[out->gone_count++] = tracks->ended[i];
    }
}

// ---------------------------------------------------------------- a frame

void detector_frame(struct detector *detector, const struct hal_camera_luma *frame, uint32_t at_us,
                    const struct detector_sight *sight, struct detections *out) {
    static const struct detector_sight fixed = {0};
    sight = sight != NULL ? sight : &fixed;
    out->count = out->gone_count = out->dropped = 0;
    const uint32_t elapsed_us = detector->any_frame ? at_us - detector->last_us : 0U;
    const double elapsed_s = elapsed_us > INT32_MAX ? 0.0 : elapsed_us * 1e-6;
    detector->any_frame = true;
    detector->last_us = at_us;
    if (detector->tags != NULL) {
        find_tags(detector, frame, elapsed_s, sight, out);
    }
    if (detector->settings.wanted[DETECTION_MARKER]) {
        find_markers(detector, frame, elapsed_s, sight, out);
    }
    if (detector->motion != NULL) {
        motion_find(detector->motion, frame, elapsed_s, sight, out);
    }
    detector->has_view = sight->model != NULL;
    if (detector->has_view) {
        detector->model = *sight->model;
        detector->view = sight->view;
    }
}
