#include "detect/camera_pose.h"

#include <math.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)

/// Poses nearer to each other than this tell nothing new.
#define POSE_APART_US 1000U

// ---------------------------------------------------------------- history

void pose_history_init(struct pose_history *history) {
    history->count = history->next = 0U;
}

/// The i-th newest sample, from 0.
static const struct pose_sample *sample(const struct pose_history *history, uint32_t i) {
    return &history->ring[(history->next + 2U * POSE_HISTORY_SIZE - 1U - i) % POSE_HISTORY_SIZE];
}

void pose_history_add(struct pose_history *history, uint32_t at_us,
                      const struct camera_pose *pose) {
    if (history->count > 0U) {
        const uint32_t apart_us = at_us - sample(history, 0)->at_us;
        if (apart_us > INT32_MAX) {
            pose_history_init(history);
        } else if (history->count > 1U && at_us - sample(history, 1)->at_us < POSE_APART_US) {
            history->next = (history->next + POSE_HISTORY_SIZE - 1U) % POSE_HISTORY_SIZE;
            history->count--;
        }
    }
    history->ring[history->next] = (struct pose_sample){at_us, *pose};
    history->next = (history->next + 1U) % POSE_HISTORY_SIZE;
    history->count += history->count < POSE_HISTORY_SIZE;
}

static double between(double a, double b, double part) {
    return a + (b - a) * part;
}

static struct camera_pose mix(const struct camera_pose *a, const struct camera_pose *b,
                              double part) {
    return (struct camera_pose){between(a->pan_deg, b->pan_deg, part),
                                between(a->tilt_deg, b->tilt_deg, part),
                                between(a->zoom, b->zoom, part)};
}

/// It goes on as between the newest two until one is due again, and then stands.
static struct camera_pose after_newest(const struct pose_history *history, uint32_t by_us) {
    const struct pose_sample *newest = sample(history, 0);
    if (history->count < 2U || by_us == 0U) {
        return newest->pose;
    }
    const struct pose_sample *before = sample(history, 1);
    const double apart_us = (double)(newest->at_us - before->at_us);
    struct camera_pose pose =
        mix(&before->pose, &newest->pose, 1.0 + fmin((double)by_us / apart_us, 1.0));
    pose.zoom = newest->pose.zoom; // of a step in the zoom nothing follows
    return pose;
}

enum pose_status pose_history_at(const struct pose_history *history, uint32_t at_us,
                                 struct camera_pose *pose) {
    if (history->count == 0U) {
        return POSE_ERROR_UNKNOWN;
    }
    const struct pose_sample *newest = sample(history, 0);
    const uint32_t age_us = newest->at_us - at_us; // huge if at_us is after the newest
    if (age_us > INT32_MAX) {
        *pose = after_newest(history, at_us - newest->at_us);
        return at_us - newest->at_us <= POSE_AHEAD_US_MAX ? POSE_OK : POSE_ERROR_TOO_NEW;
    }
    if (age_us > newest->at_us - sample(history, history->count - 1U)->at_us) {
        return POSE_ERROR_TOO_OLD;
    }
    // The newest sample that is not after at_us: ages rise with the index.
    uint32_t low = 0, high = history->count - 1U;
    while (low < high) {
        const uint32_t middle = (low + high) / 2U;
        if (newest->at_us - sample(history, middle)->at_us >= age_us) {
            high = middle;
        } else {
            low = middle + 1U;
        }
    }
    const struct pose_sample *before = sample(history, low);
    if (low == 0U) {
        *pose = before->pose;
        return POSE_OK;
    }
    const struct pose_sample *after = sample(history, low - 1U);
    const double part = (double)(at_us - before->at_us) / (double)(after->at_us - before->at_us);
    *pose = mix(&before->pose, &after->pose, part);
    return POSE_OK;
}

// ---------------------------------------------------------------- view

static void widen(struct vec3 from_q30, double to[3]) {
    to[0] = ldexp(from_q30.x, -30);
    to[1] = ldexp(from_q30.y, -30);
    to[2] = ldexp(from_q30.z, -30);
}

/// a and b, orthogonal unit vectors, turned in their plane: a towards b.
static void turn(double a[3], double b[3], double angle_deg) {
    const double c = cos(angle_deg * DEGREE), s = sin(angle_deg * DEGREE);
    for (unsigned i = 0; i < 3U; i++) {
        const double along = a[i], across = b[i];
        a[i] = c * along + s * across;
        b[i] = c * across - s * along;
    }
}

struct camera_view camera_view_at(const struct mount *mount, const struct camera_seat *seat,
                                  const struct camera_pose *pose) {
    struct camera_view view;
    widen(mount->right_q30, view.right);
    widen(mount->ahead_q30, view.ahead);
    widen(mount->up_q30, view.up);
    turn(view.ahead, view.right, pose->pan_deg);
    turn(view.ahead, view.up, pose->tilt_deg);
    turn(view.ahead, view.right, seat->right_deg);
    turn(view.ahead, view.up, seat->up_deg);
    turn(view.up, view.right, seat->roll_deg);
    return view;
}

void camera_view_to_world(const struct camera_view *view, const double camera[3], double world[3]) {
    for (unsigned i = 0; i < 3U; i++) {
        world[i] =
            view->right[i] * camera[0] + view->ahead[i] * camera[1] + view->up[i] * camera[2];
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void camera_view_from_world(const struct camera_view *view, const double world[3],
                            double camera[3]) {
    camera[0] = dot(view->right, world);
    camera[1] = dot(view->ahead, world);
    camera[2] = dot(view->up, world);
}

struct vec3 camera_direction_q30(const double world[3]) {
    const double largest = fmax(fabs(world[0]), fmax(fabs(world[1]), fabs(world[2])));
    const double scale = ldexp(1.0, 30) / largest;
    return vec3((int32_t)lround(world[0] * scale), (int32_t)lround(world[1] * scale),
                (int32_t)lround(world[2] * scale));
}
