/// Reads a scene as text: Wavefront OBJ with groups and details.
///
/// `v X Y Z` is a vertex; `o NAME` or `g NAME` begins an object; `f`, `l` and `p` list vertices,
/// counted from 1, or from -1 backwards, with anything after a slash ignored. `group NAME` ...
/// `end` makes a cluster of the objects between. `detail MIN_RADIUS_PX` begins a description of the
/// object, the coarsest first, and so does `detail within DISTANCE`. An object's points are the
/// vertices that its elements name; without any element, the vertices that stand in it. Other OBJ
/// lines (vn, vt, s, usemtl, mtllib) are skipped.
///
/// Faces that close up (each edge is in two faces, once in each direction) are a solid, which has
/// to be convex; other faces stand for themselves.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_TEXT_H
#define LINUX_SCENE_TEXT_H

#include "points.h"

#include "scene/tree.h"

/// Deepest nesting of groups.
enum { SCENE_DEPTH_MOST = 16 };

#define SCENE_NONE UINT32_MAX

/// A face or a line: corners[first..first+count) of the scene's list, which are vertices.
struct scene_element {
    enum tree_element_kind kind;
    uint32_t first, count;
    unsigned long line;
};

/// One description of an object: points[first..first+count) of the scene's list.
struct scene_detail {
    uint32_t radius_px_q8;
    double distance; ///< in the file's unit; 0: goes by radius_px_q8
    uint32_t first, count;
    unsigned long line;
    uint32_t first_element, element_count;
    enum tree_shape_kind shape; ///< if there are elements
};

struct scene_object {
    int32_t group; ///< -1: in none
    uint32_t first_detail, detail_count;
    unsigned long line;
    uint32_t name; ///< offset in the names; SCENE_NONE: ""
};

struct scene_group {
    int32_t parent;
};

struct scene_text {
    struct points vertices; ///< places, within +-(2^30 - 1)
    struct scene_object *objects;
    struct scene_detail *details;
    struct scene_group *groups;
    uint32_t *points; ///< vertices, by detail
    struct scene_element *elements;
    uint32_t *corners;
    char *names;
    uint32_t object_count, detail_count, group_count, point_count;
    uint32_t element_count, corner_count, name_bytes;
    uint32_t object_room, detail_room, group_room, point_room;
    uint32_t element_room, corner_room, name_room;
};

/// Reads the file. shapes: also how faces and lines go, and that faces are planar and solids
/// convex; else only points. A fault is told in one line on stderr. Free with scene_text_free in
/// any case.
enum exit_status scene_text_read(const char *path, bool shapes, struct scene_text *out);

void scene_text_free(struct scene_text *scene);

#endif
