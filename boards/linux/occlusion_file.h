/// What hides targets, in files: the section [occlusion] of rig files and scenarios, and the solids
/// of a scene.
/// Shown: tests/cli/hidden.sh, tests/cli/obstacle.sh.
#ifndef LINUX_OCCLUSION_FILE_H
#define LINUX_OCCLUSION_FILE_H

#include "ini_schema.h"
#include "scene_drawn.h"

#include "app/pump_occlusion.h"

/// The section, as the file has it.
struct occlusion_file {
    int policy; ///< enum occlusion_policy
    int64_t frame_us, ahead_us, fade_us, hidden_q16;
    const char *scene; ///< of rig files: "" none
};

/// A rig file has all of them; a scenario, whose scene stands elsewhere, all but the last.
enum { OCCLUSION_KEYS = 6 };
extern const struct ini_key occlusion_keys[OCCLUSION_KEYS];

/// False: told on stderr what does not fit.
bool occlusion_file_read(const struct occlusion_file *file, const struct ini *ini,
                         struct occlusion_settings *out);

/// The solids and faces of a scene, in metres, and room for some boxes more. path: the scene as
/// text; NULL: none, then the units are millimetres. drawn: zero; free with scene_drawn_free in any
/// case. Faults are told on stderr, with the line of the scene.
enum exit_status occlusion_solids_read(const char *path, uint32_t extra_boxes,
                                       struct scene_drawn *drawn, struct units *units);

/// What hides the targets of a rig that `run` drives, with all its memory.
struct occlusion_rig {
    struct scene_drawn drawn;
    struct occlusion_config config;
    struct occlusion occlusion;
    struct pump_occlusion hiding; ///< for who has a pump
    void *workspace;
};

/// scene: NULL: none. *out: NULL if nothing is hidden; to be closed in any case. Faults are told on
/// stderr.
enum exit_status occlusion_rig_open(const char *scene, const struct occlusion_settings *settings,
                                    struct vec3_i64 viewpoint_um, uint64_t expiry_us,
                                    struct occlusion_rig **out);
void occlusion_rig_close(struct occlusion_rig *rig);

#endif
