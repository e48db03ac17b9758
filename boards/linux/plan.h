/// What `boresight plan` works on: targets, where a camera may be mounted, and what it sees from
/// there.
///
/// Targets, mounts and what stands between them are places in one grid of integers, on which every
/// decision is exact. Angles and pixels are measured in doubles.
/// Shown: tests/cli/plan.c, tests/cli/plan.sh.
#ifndef LINUX_PLAN_H
#define LINUX_PLAN_H

#include "plan_scene.h"
#include "points.h"
#include "rig.h"

#include "regular/lineup.h"
#include "regular/viewpoint.h"
#include "sphere/cone.h"

#include <stdbool.h>
#include <stddef.h>

/// A mount takes count^2 log count steps, and count^3 / 6 with margins of planes.
enum { PLAN_TARGETS_MAX = 2000, PLAN_TARGETS_PLANES_MAX = 200, PLAN_MOUNTS_MAX = 10000 };

struct plan_camera {
    const struct rig *rig; ///< NULL: no limits, and a lens that always fills the picture
    struct mount mount;
    uint32_t width_px, height_px;
};

struct plan {
    struct plan_camera camera;
    bool planes;                   ///< three targets on a line count, too
    double unit_cm;                ///< of the files' unit
    const struct scene_text *text; ///< what may be in the way; NULL: nothing
    const char *text_file;
    // The grid: in units of `grid` of the files' unit.
    bool exact; ///< the places are as written
    double grid;
    struct vec3 *targets;
    uint32_t target_count;
    struct vec3 *mounts;
    uint32_t mount_count;
    // The smallest sphere of the targets, in the files' unit.
    double center[3], radius;
    struct plan_scene scene;
    double *image; ///< scratch: x and y in pixels of each target
    uint32_t *hidden, *hidden_by;
    void *workspace;
    size_t workspace_bytes;
    struct vec3 *directions;
};

/// Lays targets and mounts into one grid. mounts: each three words with a NUL behind each, as in
/// struct points; reach: none is farther from the origin; 0: the words tell.
/// Returns: EXIT_STATUS_OK, or another after a line on stderr. Free with plan_free in any case.
enum exit_status plan_set(struct plan *plan, const struct points *targets, const char *mounts,
                          uint32_t mount_count, double reach);
void plan_free(struct plan *plan);

enum plan_zoom {
    PLAN_ZOOM_FITS,     ///< the cone and its margin fill the picture's short side
    PLAN_ZOOM_TIGHT,    ///< the margin does not fit at the short end
    PLAN_ZOOM_TOO_WIDE, ///< nor does the cone
    PLAN_ZOOM_SMALL     ///< at the long end the cone does not fill the picture
};

/// What a mount sees.
struct plan_view {
    struct vec3 at;
    double place[3];    ///< in the files' unit
    uint32_t at_target; ///< VIEWPOINT_AT_TARGET: this one; else target_count
    enum cone_status cone_status;
    struct cone_result cone;
    double half_angle_rad; ///< from cone.axis_q30, rounded up
    double pan_deg, tilt_deg;
    bool reachable;  ///< within the limits of the rig
    double focal_mm; ///< of the rig
    enum plan_zoom zoom;
    struct viewpoint_result margins;
    /// Triples of targets on one line in the picture, also those that are in space.
    struct lineup_result lineup;
    bool lineup_known;
    double line_cm, plane_cm, margin_cm; ///< INFINITY: nothing is forbidden
    double line_foot[3], plane_foot[3];  ///< the nearest forbidden places, in the files' unit
    // In the picture: the two targets that are closest together, and the flattest three.
    double focal_px, pair_px, triple_px, margin_px;
    uint32_t pair[2], triple[3];
    uint32_t hidden_count; ///< targets that the scene hides
    bool usable;
};

/// All of it; plan->mounts need not hold the place.
/// Returns: EXIT_STATUS_OK, or another after a line on stderr.
enum exit_status plan_look(struct plan *plan, struct vec3 at, struct plan_view *out);

/// Only what a search needs: the cone, what the rig can do, and the margins in pixels.
void plan_glance(struct plan *plan, struct vec3 at, struct plan_view *out);

/// The targets that the scene hides from there, and by which of its objects, in plan->hidden and
/// plan->hidden_by. Returns: how many.
uint32_t plan_hidden(struct plan *plan, struct vec3 at);

/// Where to look for mounts.
struct plan_region {
    uint32_t count;  ///< how many to propose
    double distance; ///< from the centre of the targets' smallest sphere, in the files' unit
    double above;    ///< no proposal's z is less
};

/// The distance from which the targets fill the picture in the middle of the zoom's range; without
/// a rig four times their radius.
double plan_distance(const struct plan *plan);

/// Proposes mounts: the best of directions all round, improved step by step, at least 15 degrees
/// apart. words: gets three decimals a mount, each with a NUL behind it, to be freed; fewer than
/// count where there are no more.
/// Returns: how many; UINT32_MAX: no memory.
uint32_t plan_propose(const struct points *targets, const struct plan *settings,
                      const struct plan_region *region, char **words);

/// The sphere about the targets' centre through a mount: its forbidden points, where the lines
/// through two targets pierce it, its forbidden circles, where the planes through three cut it, and
/// how far the mount may move on it in any direction.
struct plan_sphere {
    double radius;    ///< in the files' unit; 0: the mount is in the centre, and there is no sphere
    double toward[3]; ///< the mount's direction
    struct plan_point {
        double direction[3];
        double gap_rad; ///< from the mount's direction
    } * points;
    struct plan_circle {
        double normal[3], height; ///< of the plane above the centre, radius 1
        double gap_rad;
    } * circles;
    uint32_t point_count, circle_count; ///< the nearest first
    double tolerance_rad;               ///< the least gap; INFINITY: nothing is forbidden
};

/// Returns: false if there is no memory. Free with plan_sphere_free in any case.
bool plan_sphere_set(struct plan_sphere *sphere, const struct plan *plan,
                     const struct plan_view *view);
void plan_sphere_free(struct plan_sphere *sphere);

/// Writes the sphere as SVG: the side of the mount, and the far side.
/// Returns: EXIT_STATUS_OK, or another after a line on stderr.
enum exit_status plan_draw(const struct plan *plan, const struct plan_sphere *sphere,
                           const char *title, const char *path);

#endif
