/// The pointing model of a rig, from sightings: how its base stands, and where its tilt scale
/// begins.
///
/// A sighting is what the joints read while the camera looked exactly at a known direction. The
/// sum of the squared angles between where the model says that the camera looked, and the
/// directions, is minimised (Gauss-Newton with damping). The zero of pan is a part of the heading.
/// Shown: tests/cli/calibrate.sh.
#ifndef LINUX_POINTING_H
#define LINUX_POINTING_H

#include <stdbool.h>
#include <stddef.h>

enum { POINTING_SIGHTINGS_MAX = 256 };

struct pointing_sighting {
    double pan_deg, tilt_deg;
    double direction[3]; ///< unit, world axes
};

struct pointing_model {
    double heading_deg, pitch_deg, roll_deg; ///< as in [mount]
    double tilt_offset_deg;                  ///< to be added to what the tilt axis reads
};

/// Improves *model, which has the values of now. with_offset: the tilt offset, too, which takes
/// three sightings of different pan or tilt; without it two are enough. *rms_deg: what is left.
/// Returns: false: the sightings do not determine the model.
bool pointing_fit(const struct pointing_sighting *sightings, size_t count, bool with_offset,
                  struct pointing_model *model, double *rms_deg);

#endif
