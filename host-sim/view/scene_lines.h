/// The obstacles of a simulation as a camera sees them, without their hidden lines.
#ifndef VIEW_SCENE_LINES_H
#define VIEW_SCENE_LINES_H

#include "sim.h"
#include "view/report.h"

/// Lines on the sensor at this moment, to be freed; cut to twice its width and height. NULL: there
/// are no obstacles (*count 0), or out of memory (*count 1).
struct report_line *scene_lines(const struct sim *sim, const struct sim_view *view,
                                double sensor_width_mm, double sensor_height_mm, size_t *count);

#endif
