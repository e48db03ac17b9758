/// The report of a run: one HTML file that needs no other, with plots over time and a picture of
/// each framing.
///
/// Texts are UTF-8; what is not valid in them is replaced, what is too long for its field is cut
/// between two characters. Numbers that are not finite leave a gap in a plot, a dash in a caption.
/// Shown: tests/scenario/test_report.c.
#ifndef VIEW_REPORT_H
#define VIEW_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// One moment, as the simulator knows it (the controller knows less). Samples come in order of
/// time.
struct report_sample {
    double time_s;
    double pan_deg, tilt_deg;                   ///< where the camera really looks, joint angles
    double pan_setpoint_deg, tilt_setpoint_deg; ///< what the controller asked for
    double focal_mm, focal_setpoint_mm;         ///< 0 without zoom
    double error_deg; ///< angle from the optimal axis; negative: nothing to aim at
    const char *mode; ///< controller_mode_name; kept by address; NULL: not known
};

/// A point in a picture: image coordinates on the sensor, x right, y up, in millimetres from the
/// centre.
struct report_point {
    double x_mm, y_mm;
    double size;    ///< relative area of the dot, about 0.2 to 5
    bool is_target; ///< else background
    char label[24]; ///< may be empty
};

/// A visible line of what stands in the way, likewise.
struct report_line {
    double x0_mm, y0_mm, x1_mm, y1_mm;
};

/// What the camera saw at one moment.
struct report_picture {
    char title[80];
    double time_s;
    double sensor_width_mm, sensor_height_mm;
    double focal_mm;
    double cone_x_mm, cone_y_mm,
        cone_radius_mm; ///< image of the narrowest cone (drawn as a circle)
    double half_angle_deg, error_deg, pan_deg, tilt_deg;
    struct report_point *points; ///< report_add_picture copies them; the report owns its copy
    size_t point_count;
    struct report_line *lines; ///< likewise
    size_t line_count;
};

/// A row of the summary table.
struct report_fact {
    char name[48], value[96];
};

struct report {
    char title[80], subtitle[160];
    struct report_sample *samples;
    size_t sample_count, sample_capacity;
    struct report_picture *pictures;
    size_t picture_count, picture_capacity;
    struct report_fact *facts;
    size_t fact_count, fact_capacity;
};

/// An empty report. Free it with report_free.
void report_init(struct report *report, const char *title, const char *subtitle);
void report_free(struct report *report);

/// Each copies what it is given. False: out of memory; the report is as before.
bool report_add_sample(struct report *report, const struct report_sample *sample);
bool report_add_picture(struct report *report, const struct report_picture *picture);
bool report_add_fact(struct report *report, const char *name, const char *value);

/// Writes several reports (chapters) into one HTML file: inline SVG and CSS, no script needed to
/// read it, no address of another host. False: errno tells why the file could not be written; no
/// half-written file stays, and a file that stood at the path is as before.
/// Size:     below 2 MB for a chapter of 10 minutes at 100 samples a second with 30 pictures of
/// 1500
///           background points: a line keeps the first, smallest, largest and last sample of each
///           pixel column, a picture its 1500 largest background points (and says so).
bool report_write(const struct report *const *chapters, size_t chapter_count, const char *path);

/// Writes one picture with its title and caption as an SVG file of its own, for a page that shows
/// it 400 pixels wide or more. It has its own ground, so it reads on white as on black. False: as
/// report_write.
bool report_picture_svg(const struct report_picture *picture, const char *path);

#endif
