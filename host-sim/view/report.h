/// The report of a run: one HTML file that needs no other, with plots over time and a picture of
/// each framing.
#ifndef VIEW_REPORT_H
#define VIEW_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// One moment, as the simulator knows it (the controller knows less).
struct report_sample {
    double time_s;
    double pan_deg, tilt_deg;                   ///< where the camera really looks, joint angles
    double pan_setpoint_deg, tilt_setpoint_deg; ///< what the controller asked for
    double focal_mm, focal_setpoint_mm;         ///< 0 without zoom
    double error_deg; ///< angle from the optimal axis; negative: nothing to aim at
    const char *mode; ///< controller_mode_name
};

/// A point in a picture: image coordinates on the sensor, x right, y up, in millimetres from the
/// centre.
struct report_point {
    double x_mm, y_mm;
    double size;    ///< relative area of the dot, about 0.2 to 5
    bool is_target; ///< else background
    char label[24]; ///< may be empty
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
    struct report_point *points; ///< owned by the report
    size_t point_count;
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
/// half-written file stays.
bool report_write(const struct report *const *chapters, size_t chapter_count, const char *path);

#endif
