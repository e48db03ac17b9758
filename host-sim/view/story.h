/// Watches a simulation and tells it: samples and pictures for the report, a line for each subject.
#ifndef VIEW_STORY_H
#define VIEW_STORY_H

#include "sim.h"
#include "view/report.h"

#include <stdbool.h>
#include <stdint.h>

/// A subject of the schedule, or a stretch of time when it has none.
struct story_subject {
    uint64_t from_us, until_us;
    char name[48];
};

/// What was seen of a subject, at its end.
struct story_line {
    const char *name;
    uint32_t target_count;
    double pan_deg, tilt_deg, half_angle_deg, focal_mm, error_deg;
    double settle_s; ///< negative: it never settled
};

struct story {
    const struct sim *sim;
    struct report report;
    bool collects; ///< whether samples and pictures are kept
    bool complete; ///< false once memory ran out
    uint64_t sample_period_us;
    struct story_subject *subjects;
    size_t subject_count, next_subject;
    double settled_s; ///< of the subject under way; negative: not yet
    void (*tell)(void *context,
                 const struct story_line *line); ///< at the end of each subject; may be NULL
    void *tell_context;
};

/// A story of `duration_us` of a simulation. sim and its schedule must outlive it. False: out of
/// memory.
bool story_begin(struct story *story, const struct sim *sim, const char *title,
                 const char *subtitle, uint64_t duration_us, bool collects);

/// After each sim_step.
void story_step(struct story *story);

void story_end(struct story *story);

#endif
