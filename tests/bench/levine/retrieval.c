/// Chapter II: what it costs to find the objects in the picture, on the views of appendix III.
#include "bench/levine/blocks.h"
#include "bench/levine/levine.h"
#include "bench/levine/regions.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PICTURE_PX 1000U

/// How the scene is looked at in the thesis, where everything is in view; with a narrow picture;
/// and from the middle of the scene.
static const struct {
    const char *name;
    double distance, field_deg;
} looks[] = {{"all in view", 1.25, 110}, {"40 degrees", 1.25, 40}, {"from the middle", 0, 60}};

static const char *const tree_names[REGION_TREES] = {"octree", "boxes", "spheres"};

struct sum {
    double tested, distances, read, objects, size, near;
};

static struct view view_of(const struct blocks *blocks, int degree, double distance,
                           double field_deg) {
    const struct hidden_camera camera =
        blocks_camera(blocks, degree < 360 ? TURN_YAW : TURN_PITCH, degree % 360, distance);
    const double focal_px = PICTURE_PX / 2.0 / tan(field_deg / 2 * 0.017453292519943295);
    struct view view;
    view_set(&view, camera.eye, camera.right, camera.ahead, camera.up,
             (uint32_t)lrint(256 * focal_px), PICTURE_PX, PICTURE_PX);
    return view;
}

/// No tree loses an object whose box is in the picture.
static void check_found(const struct regions *regions, const struct view *view, const bool *found,
                        double *near) {
    uint32_t lost = 0;
    for (uint32_t i = 0; i < regions->set->object_count; i++) {
        const bool is_near = regions_is_near(regions, i, view);
        lost += is_near && !found[i] ? 1U : 0U;
        *near += is_near ? 1 : 0;
    }
    CHECK_EQ(lost, 0);
}

static void look_around(const char *name, struct blocks *blocks, struct regions *regions,
                        int step) {
    bool *const found = malloc(regions->set->object_count);
    for (size_t k = 0; k < sizeof looks / sizeof *looks; k++) {
        for (int tree = 0; tree < REGION_TREES; tree++) {
            struct sum sum = {0, 0, 0, 0, 0, 0};
            const double share = step / 720.0;
            for (int degree = 0; degree < 720; degree += step) {
                const struct view view =
                    view_of(blocks, degree, looks[k].distance, looks[k].field_deg);
                memset(found, 0, regions->set->object_count);
                const struct region_counts c =
                    regions_look(regions, (enum region_tree)tree, &view, found);
                check_found(regions, &view, found, &sum.near);
                sum.tested += c.tested;
                sum.distances += c.distances;
                sum.read += c.read;
                sum.objects += c.objects;
                sum.size += c.size;
            }
            printf("| %s | %s | %s | %u |", looks[k].name, tree_names[tree], name,
                   regions->set->object_count);
            levine_cell(sum.tested * share);
            levine_cell(sum.distances * share);
            levine_cell(sum.size * share);
            levine_cell(sum.read * share);
            levine_cell(sum.objects * share);
            levine_cell(sum.near * share);
            printf("\n");
            fflush(stdout);
        }
    }
    free(found);
}

static void print_trees(const char *name, const struct regions *regions) {
    for (int tree = 0; tree < REGION_TREES; tree++) {
        uint32_t levels;
        const uint32_t nodes = regions_nodes(regions, (enum region_tree)tree, &levels);
        const double references =
            tree == REGION_OCTREE ? regions->reference_count : regions->set->object_count;
        printf("| %s | %s | %u | %u |", name, tree_names[tree], nodes, levels);
        levine_cell(references / regions->set->object_count);
        printf("\n");
    }
}

/// Every degree; of the lattice of 4,096 every tenth.
void levine_retrieval(bool few) {
    static const enum block_scene scenes[] = {BLOCKS_CITY, BLOCKS_RANDOM, BLOCKS_48};
    for (int pass = 0; pass < 2; pass++) {
        levine_table(pass == 0 ? "trees" : "retrieval");
        for (int i = 0; i < (few ? 1 : 4); i++) {
            struct blocks blocks;
            struct regions regions;
            const char *const name = i < 3 ? blocks_name(scenes[i]) : "4,096 cubes";
            if (i < 3) {
                blocks_open(&blocks, scenes[i]);
            } else {
                blocks_open_lattice(&blocks, 16);
            }
            regions_open(&regions, &blocks.scene.set);
            if (pass == 0) {
                print_trees(name, &regions);
            } else {
                look_around(name, &blocks, &regions, i < 3 ? 1 : 10);
            }
            regions_close(&regions);
            blocks_close(&blocks);
        }
    }
}
