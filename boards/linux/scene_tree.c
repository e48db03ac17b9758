#include "scene_tree.h"

#include "scene_drawn.h"

#include <stdlib.h>
#include <string.h>

static const char *name_of(const char *path) {
    return path == NULL || strcmp(path, "-") == 0 ? "stdin" : path;
}

static enum exit_status build(const struct scene_text *scene, const char *name,
                              const struct scene_build_options *options, struct scene_tree *out) {
    struct scene_build_options told = *options;
    unsigned long line = 0;
    size_t fault;
    told.fault_line = &line;
    switch (scene_build(scene, &told, &out->block, &out->size_bytes)) {
    case SCENE_BUILD_OK:
        break;
    case SCENE_BUILD_NO_MEMORY:
        message_at(name, 0, "no memory for the tree of this scene");
        return EXIT_STATUS_FAILURE;
    case SCENE_BUILD_TOO_DEEP:
        message_at(name, line, "too deep: with this object the tree has more than %d levels",
                   (int)TREE_LEVELS_MAX);
        return EXIT_STATUS_USAGE;
    default:
        message_at(name, 0, "the tree would be larger than 4 GiB");
        return EXIT_STATUS_USAGE;
    }
    if (tree_open(out->block, out->size_bytes, &out->tree, &fault) != TREE_OK) {
        message_at(name, 0, "the tree of this scene is wrong at offset %zu", fault);
        return EXIT_STATUS_FAILURE;
    }
    return EXIT_STATUS_OK;
}

enum exit_status scene_tree_read(const char *path, bool shapes,
                                 const struct scene_build_options *options,
                                 struct scene_tree *out) {
    struct scene_text scene;
    *out = (struct scene_tree){.block = NULL};
    enum exit_status status = scene_text_read(path, shapes, &scene);
    if (status == EXIT_STATUS_OK) {
        status = build(&scene, name_of(path), options, out);
    }
    scene_text_free(&scene);
    return status;
}

enum exit_status scene_tree_check(const struct scene_tree *scene, const char *path) {
    struct scene_drawn drawn = {.bytes = 0};
    if (scene->tree.header->shape_count == 0U) {
        return EXIT_STATUS_OK;
    }
    enum exit_status status = scene_drawn_gather(&drawn, &scene->tree, NULL, name_of(path));
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_check(&drawn, &scene->tree, name_of(path));
    }
    scene_drawn_free(&drawn);
    return status;
}

void scene_tree_free(struct scene_tree *scene) {
    free(scene->block);
    scene->block = NULL;
}
