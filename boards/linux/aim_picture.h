/// What `boresight aim` does beyond the cone: the image of points and segments, aiming by the
/// corners of a box, framing a rectangle.
/// Shown: tests/cli/aim.sh, tests/cli/picture.sh.
#ifndef LINUX_AIM_PICTURE_H
#define LINUX_AIM_PICTURE_H

#include "bounds.h"
#include "facts.h"
#include "options.h"
#include "points.h"
#include "rect.h"

#include <stdbool.h>

struct picture_options {
    int frame;  ///< enum picture_frame
    int bounds; ///< enum picture_bounds
    const char *aspect, *margin, *plot_radius, *segments;
    bool project;
    // What they say:
    double width, height; ///< of the picture, in any unit
    double margin_part;   ///< 0.1 for 10 %
    double radius;        ///< of the plot; 0: not asked for
    struct points ends;   ///< of the segments, two for each
};

enum picture_frame { FRAME_CONE, FRAME_RECT };
enum picture_bounds { BOUNDS_POINTS, BOUNDS_BOX };

extern const char *const picture_frames[], *const picture_bounds[];

#define PICTURE_OPTIONS(settings_type, member)                                                     \
    {"--frame",                                                                                    \
     "cone|rect",                                                                                  \
     "what shall hold every point (cone)",                                                         \
     option_choice,                                                                                \
     offsetof(settings_type, member.frame),                                                        \
     picture_frames},                                                                              \
        {"--aspect",                                                                               \
         "W:H",                                                                                    \
         "its sides, width first",                                                                 \
         option_text,                                                                              \
         offsetof(settings_type, member.aspect),                                                   \
         NULL},                                                                                    \
        {"--margin",                                                                               \
         "PERCENT",                                                                                \
         "how much wider the rectangle shall be (0)",                                              \
         option_text,                                                                              \
         offsetof(settings_type, member.margin),                                                   \
         NULL},                                                                                    \
        {"--bounds",                                                                               \
         "points|box",                                                                             \
         "aim by the points, or by the corners of their box",                                      \
         option_choice,                                                                            \
         offsetof(settings_type, member.bounds),                                                   \
         picture_bounds},                                                                          \
        {"--project",                                                                              \
         NULL,                                                                                     \
         "print the image of every point",                                                         \
         option_flag,                                                                              \
         offsetof(settings_type, member.project),                                                  \
         NULL},                                                                                    \
        {"--plot-radius",                                                                          \
         "R",                                                                                      \
         "scale the image to this radius",                                                         \
         option_text,                                                                              \
         offsetof(settings_type, member.plot_radius),                                              \
         NULL},                                                                                    \
    {                                                                                              \
        "--segments", "FILE", "print segments: two ends a line", option_text,                      \
            offsetof(settings_type, member.segments), NULL                                         \
    }

#define PICTURE_HELP                                                                               \
    "pictures:\n"                                                                                  \
    "  --frame rect --aspect W:H [--margin PERCENT]\n"                                             \
    "                   pan, tilt and the smallest picture of that aspect, without roll, that\n"   \
    "                   holds every point, instead of the narrowest cone: adds hfov_deg and\n"     \
    "                   vfov_deg, from pan_deg and tilt_deg as printed, margin included\n"         \
    "  --bounds box     aims by the eight corners of the box round the points: adds\n"             \
    "                   box_half_deg, of the cone of the corners, and loss_deg, how much\n"        \
    "                   wider half_angle_deg is than if aimed by the points\n"                     \
    "  --project [--plot-radius R] [--segments FILE]\n"                                            \
    "                   adds scale and viewing_distance (how far from the plot an eye sees it\n"   \
    "                   undistorted), and image: x to the right and y up for each point, times\n"  \
    "                   scale, and distortion, how much longer than across things are drawn\n"     \
    "                   there along the line to the centre (null for a point that is not in\n"     \
    "                   front); and segments: two ends, or one end and a direction for one\n"      \
    "                   that passes the plane of the viewer, or null\n"

/// Checks that the options go together, and reads the segments.
/// up_given, method_given: whether --up and --method were.
enum exit_status picture_options_read(const char *command, const struct points_format *format,
                                      bool up_given, bool method_given,
                                      struct picture_options *options);
void picture_options_free(struct picture_options *options);

/// Image of the points, scale, segments, if asked for. up_q30: of the camera, across ahead.
/// half_angle_pdeg: of the cone round ahead.
void picture_print_image(struct facts *facts, const struct picture_options *options,
                         struct vec3 ahead_q30, struct vec3 up_q30, uint64_t half_angle_pdeg,
                         const struct points *points);

/// Field of view of a rectangle that was measured from pan and tilt.
void picture_print_field(struct facts *facts, const struct picture_options *options, double slope);

/// The camera's axes at a pan and tilt, without roll.
struct picture_axes {
    struct vec3 ahead_q30, right_q30, up_q30;
};
struct picture_axes picture_axes(double pan_rad, double tilt_rad);

#endif
