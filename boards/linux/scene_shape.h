/// What the faces and lines of a scene's objects are: solids, faces or lines; and whether they are
/// what they have to be.
/// Shown: tests/cli/render.sh.
#ifndef LINUX_SCENE_SHAPE_H
#define LINUX_SCENE_SHAPE_H

#include "scene_text.h"

/// Sets the shape of every description. The vertices are whole units already, and every decision is
/// exact for them. A solid whose faces all turn inward is turned inside out. A face that is not
/// planar, or a solid that is not convex, is told with the line of that face.
/// Cost: corners * log corners; for a solid faces * vertices tests of a point and a plane (about
///       2 ns each).
enum exit_status scene_shape_check(struct scene_text *scene, const char *file);

#endif
