/// The thesis' scenes of blocks, and a camera that goes around them.
#ifndef BENCH_LEVINE_BLOCKS_H
#define BENCH_LEVINE_BLOCKS_H

#include "property/support/hidden_scenes.h"

enum block_scene {
    BLOCKS_4, ///< unit cubes, 2 apart: the numbers as chapter VI.H has them
    BLOCKS_8,
    BLOCKS_16,
    BLOCKS_24,
    BLOCKS_32,
    BLOCKS_48,
    BLOCKS_CITY,   ///< 16 prisms; ours, for the thesis shows only pictures of its own
    BLOCKS_RANDOM, ///< 32 cubes, each less than 1 from its place in the lattice of 32
    BLOCKS_COUNT
};

const char *blocks_name(enum block_scene scene);

/// A 1 of the thesis is so many units. Sides of the lattice of 4,096 cubes are 46 * 2^20.
#define BLOCK_UNIT (INT32_C(1) << 20)

struct blocks {
    struct hidden_scene scene;
    double middle[3], radius; ///< of the sphere around the box of everything, in units
};

void blocks_open(struct blocks *blocks, enum block_scene scene);
/// A lattice of side^3 cubes.
void blocks_open_lattice(struct blocks *blocks, uint32_t side);
void blocks_close(struct blocks *blocks);

enum block_turn { TURN_YAW, TURN_PITCH };

/// The camera that sees what an eye on the z axis sees when the scene has been turned about the y
/// axis (yaw) or the x axis (pitch). distance: from the middle, in radii; 0: at the middle.
struct hidden_camera blocks_camera(const struct blocks *blocks, enum block_turn turn,
                                   double degrees, double distance);

/// Yaw and pitch at once, for views along no axis.
struct hidden_camera blocks_camera_tilted(const struct blocks *blocks, double yaw, double pitch,
                                          double distance);

#endif
