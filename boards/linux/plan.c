#include "plan.h"

#include "places.h"

#include "solid/solid_sphere.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Adds places whose coordinates stand one after the other, each with a NUL behind it.
static bool add_words(struct points *all, const char *text, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        struct points_word word[3];
        for (int axis = 0; axis < 3; axis++) {
            word[axis] = (struct points_word){text, strlen(text)};
            text += word[axis].size + 1U;
        }
        if (!points_add_place(all, word)) {
            return false;
        }
    }
    return true;
}

static bool lay_grid(struct plan *plan, struct points *all, const struct points *targets,
                     const char *mounts, double reach) {
    char far[64];
    const int size = snprintf(far, sizeof far, "%.3e%c0%c0", reach, '\0', '\0');
    const struct points *const scene = plan->text == NULL ? NULL : &plan->text->vertices;
    if (!add_words(all, targets->place_text, plan->target_count) ||
        !add_words(all, mounts, plan->mount_count) ||
        (scene != NULL && !add_words(all, scene->place_text, scene->count)) ||
        (reach > 0 && (size < 0 || !add_words(all, far, 1)))) {
        return false;
    }
    places_finish(all, true, VIEWPOINT_COORDINATE_MAX);
    if (reach > 0) { // room between the places for a search
        places_spread(all, VIEWPOINT_COORDINATE_MAX);
    }
    plan->exact = all->places_exact;
    plan->grid = (double)all->unit;
    return true;
}

static bool enclose(struct plan *plan) {
    struct solid_sphere sphere;
    if (plan->target_count == 0U) {
        return true;
    }
    const size_t bytes = SOLID_SPHERE_WORKSPACE_BYTES(plan->target_count);
    void *const workspace = malloc(bytes);
    const bool good =
        workspace != NULL && solid_sphere_find(plan->targets, plan->target_count, workspace, bytes,
                                               &sphere) == SOLID_SPHERE_OK;
    free(workspace);
    if (!good) {
        return false;
    }
    const int64_t center[3] = {sphere.center_q30.x, sphere.center_q30.y, sphere.center_q30.z};
    for (int axis = 0; axis < 3; axis++) {
        plan->center[axis] = (double)center[axis] * 0x1p-30 * plan->grid;
    }
    plan->radius = 0;
    for (uint32_t i = 0; i < plan->target_count; i++) {
        const struct vec3 t = plan->targets[i];
        const double x = t.x * plan->grid - plan->center[0], y = t.y * plan->grid - plan->center[1],
                     z = t.z * plan->grid - plan->center[2];
        plan->radius = fmax(plan->radius, sqrt(x * x + y * y + z * z));
    }
    return true;
}

enum exit_status plan_set(struct plan *plan, const struct points *targets, const char *mounts,
                          uint32_t mount_count, double reach) {
    struct points all = {0};
    plan->target_count = targets->count;
    plan->mount_count = mount_count;
    bool good = lay_grid(plan, &all, targets, mounts, reach);
    plan->targets = all.directions;
    plan->mounts = all.directions == NULL ? NULL : all.directions + targets->count;
    all.directions = NULL;
    points_free(&all);
    const size_t of_cone = CONE_WORKSPACE_BYTES(targets->count),
                 of_lineup = LINEUP_WORKSPACE_BYTES(targets->count);
    plan->workspace_bytes = of_cone > of_lineup ? of_cone : of_lineup;
    plan->workspace = malloc(plan->workspace_bytes);
    plan->image = malloc((2U * (size_t)targets->count + 1U) * sizeof *plan->image);
    plan->directions = malloc(((size_t)targets->count + 1U) * sizeof *plan->directions);
    plan->hidden = malloc(((size_t)targets->count + 1U) * sizeof *plan->hidden);
    plan->hidden_by = malloc(((size_t)targets->count + 1U) * sizeof *plan->hidden_by);
    good = good && plan->workspace != NULL && plan->image != NULL && plan->directions != NULL &&
           plan->hidden != NULL && plan->hidden_by != NULL && enclose(plan);
    if (good && !(plan->grid > 1e-90 && plan->grid < 1e90)) {
        message_command("plan", "coordinates beyond 10^90, or none above 10^-90");
        return EXIT_STATUS_USAGE;
    }
    if (!good) {
        message_command("plan", "no memory for %lu targets and %lu mounts",
                        (unsigned long)targets->count, (unsigned long)mount_count);
        return EXIT_STATUS_FAILURE;
    }
    return plan->text == NULL ? EXIT_STATUS_OK
                              : plan_scene_set(&plan->scene, plan->text, plan->text_file,
                                               plan->mounts + plan->mount_count, plan->exact);
}

void plan_free(struct plan *plan) {
    free(plan->targets);
    free(plan->workspace);
    free(plan->image);
    free(plan->directions);
    free(plan->hidden);
    free(plan->hidden_by);
    plan_scene_free(&plan->scene);
    plan->hidden = plan->hidden_by = NULL;
    plan->targets = plan->mounts = plan->directions = NULL;
    plan->workspace = NULL;
    plan->image = NULL;
}
