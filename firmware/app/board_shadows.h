/// What the solids and faces of a scene in flash hide from where the gimbal stands: worked out once
/// at the start, then only the shadows stay in RAM.
///
/// The mount does not move, nor does the scene, so its shadows don't either; what is hidden behind
/// them is then decided in the time that ticks leave over. Shown: tests/unit/test_board_scene.c,
/// tests/mcu/cpu/hidden.c (in the image, on the emulated chip).
#ifndef APP_BOARD_SHADOWS_H
#define APP_BOARD_SHADOWS_H

#include "app/pump_occlusion.h"
#include "scene/tree_shape.h"
#include "scene/walk.h"

#define BOARD_SHADOWS_BOUNDS 512U ///< a box has 5 to 9
#define BOARD_SHADOWS_PIECES 128U
/// Of one solid or face.
#define BOARD_SHADOWS_POINTS  48U
#define BOARD_SHADOWS_FACES   64U
#define BOARD_SHADOWS_CORNERS 192U
#define BOARD_SHADOWS_EDGES   96U
/// Bounds of one piece: what a unit of work takes at most follows from it.
#define BOARD_SHADOWS_PIECE_BOUNDS 24U

enum board_shadows_status {
    BOARD_SHADOWS_OK = 0,
    BOARD_SHADOWS_NONE = -1,  ///< the scene has no solids and no faces
    BOARD_SHADOWS_ROOM = -2,  ///< too many of them, or too large ones
    BOARD_SHADOWS_SHAPE = -3, ///< one is not convex, or not flat
    BOARD_SHADOWS_FAR = -4    ///< the gimbal is too far from the scene, or the scene has no unit
};

/// About 45 KB.
struct board_shadows {
    struct pump_occlusion stage;
    struct occlusion occlusion;
    struct occlusion_config config;
    struct sight sight;
    uint32_t solids; ///< and faces: how many have a shadow
    struct sight_bound bounds[BOARD_SHADOWS_BOUNDS];
    struct sight_piece pieces[BOARD_SHADOWS_PIECES];
};

/// For one shape at a time, while shadows are cast: about 13 KB.
struct board_shadows_memory {
    struct vec3 points[BOARD_SHADOWS_POINTS];
    uint32_t source[BOARD_SHADOWS_POINTS], corners[BOARD_SHADOWS_CORNERS],
        counts[BOARD_SHADOWS_FACES];
    struct vec3 vertices[BOARD_SHADOWS_POINTS];
    uint32_t set_corners[BOARD_SHADOWS_CORNERS];
    struct shape_face faces[BOARD_SHADOWS_FACES];
    struct shape_plane planes[BOARD_SHADOWS_FACES];
    struct shape_edge edges[BOARD_SHADOWS_EDGES];
    struct shape_object object;
    struct walk walk;
};

/// Casts the shadows of a tree, of each object in its finest description. tree: open. After an
/// error nothing is hidden.
enum board_shadows_status board_shadows_cast(struct board_shadows *shadows, const struct tree *tree,
                                             struct vec3_i64 viewpoint_um, uint64_t expiry_us,
                                             const struct occlusion_settings *settings,
                                             struct board_shadows_memory *memory) MUST_CHECK;

#endif
