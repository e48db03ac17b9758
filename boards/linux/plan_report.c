#include "plan_report.h"

#include "facts.h"
#include "measure.h"
#include "point_options.h"

#include <float.h>
#include <math.h>

struct page {
    const struct plan_ranking *ranking;
    struct plan *plan;
};

static void print_targets(struct facts *facts, const struct page *page, const char *name,
                          const uint32_t *targets, uint32_t count) {
    facts_indices(facts, name, targets, count, point_options_name_of, &page->ranking->targets);
}

/// Cut behind the last place, but for the last digits of a double; infinite: nothing of the kind.
static void print_margin(struct facts *facts, const char *name, double value, int places) {
    if (isfinite(value)) {
        const double scale = pow(10, places);
        facts_fixed(facts, name, floor(value * scale * (1 + 4 * DBL_EPSILON)) / scale, places);
    } else {
        facts_null(facts, name, "nothing is forbidden");
    }
}

static const char *why_not(const struct plan_view *view, const struct plan *plan) {
    return view->at_target < plan->target_count ? "at a target"
           : view->cone_status != CONE_OK       ? "no direction sees all targets"
           : !view->reachable                   ? "out of the rig's reach"
           : view->zoom == PLAN_ZOOM_TOO_WIDE   ? "wider than the lens"
           : view->hidden_count != 0U           ? "targets are hidden"
                                                : NULL;
}

static void print_px(struct facts *facts, const char *name, double value) {
    if (isfinite(value)) {
        facts_fixed(facts, name, value, 3);
    } else {
        facts_null(facts, name, "nothing is forbidden");
    }
}

static void print_cone(struct facts *facts, const struct page *page, const struct plan_view *view) {
    static const char *const zooms[] = {"fits", "no margin", "too wide", "small"};
    if (view->cone_status != CONE_OK) {
        print_targets(facts, page, "witness", view->cone.witness, view->cone.witness_count);
        return;
    }
    facts_fixed(facts, "pan_deg", view->pan_deg, 9);
    facts_fixed(facts, "tilt_deg", view->tilt_deg, 9);
    facts_trillionths(facts, "half_angle_deg", measure_pdeg(view->cone.half_angle_turn64));
    if (page->plan->camera.rig != NULL) {
        facts_bool(facts, "reachable", view->reachable);
        facts_text(facts, "zoom", zooms[view->zoom]);
        facts_significant(facts, "focal_mm", view->focal_mm, 9);
    }
}

/// The hidden targets, and the names of what hides them; unnamed objects have none.
static void print_hidden(struct facts *facts, const struct page *page,
                         const struct plan_view *view) {
    struct plan *const plan = page->plan;
    if (plan->text == NULL) {
        return;
    }
    const uint32_t count = plan_hidden(plan, view->at);
    print_targets(facts, page, "hidden", plan->hidden, count);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t name = plan->text->objects[plan->hidden_by[i]].name;
        if (name != SCENE_NONE) {
            facts_text(facts, "hidden_by", plan->text->names + name);
            return;
        }
    }
}

/// The unit normal of the plane in which the first triple lines up.
static void print_way_out(struct facts *facts, const struct lineup_result *lineup) {
    const double n[3] = {(double)lineup->normal.x, (double)lineup->normal.y,
                         (double)lineup->normal.z};
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (size > 0) {
        const double unit[3] = {n[0] / size, n[1] / size, n[2] / size};
        facts_reals(facts, "lined_up_normal", unit, 3);
    }
}

static void print_margins(struct facts *facts, const struct page *page,
                          const struct plan_view *view) {
    const struct viewpoint_result *const m = &view->margins;
    facts_u64(facts, "lines_through", m->line.through);
    if (isfinite(view->line_cm)) {
        print_targets(facts, page, "line", m->line.target, 2);
        facts_reals(facts, "line_at", view->line_foot, 3);
    }
    print_margin(facts, "line_cm", view->line_cm, 6);
    if (!view->lineup_known) {
        facts_null(facts, "lined_up", "no exact turn brings these targets into general position");
    } else {
        facts_u64(facts, "lined_up", view->lineup.triples);
        if (view->lineup.triples != 0U) {
            print_targets(facts, page, "lined_up_first", view->lineup.first, 3);
            print_way_out(facts, &view->lineup);
        }
    }
    if (page->plan->planes) {
        facts_u64(facts, "planes_through", m->plane.through);
        if (isfinite(view->plane_cm)) {
            print_targets(facts, page, "plane", m->plane.target, 3);
            facts_reals(facts, "plane_at", view->plane_foot, 3);
        }
        print_margin(facts, "plane_cm", view->plane_cm, 6);
    }
    print_margin(facts, "margin_cm", view->margin_cm, 6);
    if (view->cone_status != CONE_OK) {
        return;
    }
    if (isfinite(view->pair_px)) {
        print_targets(facts, page, "pair", view->pair, 2);
    }
    print_px(facts, "pair_px", view->pair_px);
    if (page->plan->planes) {
        if (isfinite(view->triple_px)) {
            print_targets(facts, page, "triple", view->triple, 3);
        }
        print_px(facts, "triple_px", view->triple_px);
    }
    print_px(facts, "margin_px", view->margin_px);
}

static void print_view(struct facts *facts, const struct page *page, uint32_t rank) {
    const uint32_t index = page->ranking->order[rank];
    const struct plan_view *const view = &page->ranking->views[index];
    const char *const name = points_name(&page->ranking->mounts, index);
    const char *const why = why_not(view, page->plan);
    if (facts->as_json) {
        json_begin_object(&facts->json);
    } else {
        fputc('\n', facts->stream);
    }
    facts_u64(facts, "rank", rank + 1U);
    facts_u64(facts, "mount", index);
    if (name != NULL) {
        facts_text(facts, "name", name);
    }
    facts_reals(facts, "at", view->place, 3);
    facts_bool(facts, "usable", view->usable);
    if (why != NULL) {
        facts_text(facts, "why_not", why);
    }
    facts_bool(facts, "feasible", view->cone_status == CONE_OK);
    if (view->at_target < page->plan->target_count) {
        print_targets(facts, page, "target", &view->at_target, 1);
    } else {
        print_cone(facts, page, view);
        print_hidden(facts, page, view);
        print_margins(facts, page, view);
    }
    if (facts->as_json) {
        json_end_object(&facts->json);
    }
}

void plan_report(const struct plan_ranking *ranking, struct plan *plan,
                 const struct plan_sphere *sphere, bool as_json) {
    const struct page whole = {ranking, plan}, *const page = &whole;
    const struct viewpoint_result *const any =
        ranking->count == 0U ? NULL : &ranking->views[0].margins;
    struct facts facts;
    facts_begin(&facts, stdout, as_json);
    facts_u64(&facts, "targets", plan->target_count);
    facts_u64(&facts, "mounts", ranking->count);
    facts_bool(&facts, "proposed", ranking->proposed);
    facts_bool(&facts, "exact", plan->exact);
    if (any != NULL && any->collinear != 0U) {
        facts_u64(&facts, "collinear_triples", any->collinear);
        print_targets(&facts, page, "collinear", any->collinear_first, 3);
    }
    if (sphere->radius > 0) {
        print_margin(&facts, "tolerance_deg", sphere->tolerance_rad * MEASURE_DEG_PER_RAD, 6);
    }
    if (as_json) {
        json_key(&facts.json, "ranking");
        json_begin_array(&facts.json);
    }
    for (uint32_t rank = 0; rank < ranking->count; rank++) {
        print_view(&facts, page, rank);
    }
    if (as_json) {
        json_end_array(&facts.json);
    }
    facts_end(&facts);
}
