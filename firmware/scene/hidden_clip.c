/// The method for real work: edges clipped by shadows.
#include "scene/hidden.h"

bool hidden_begin_edge(struct hidden *h, const struct shape_edge *edge) {
    const int64_t from = h->vertices[edge->from].depth, to = h->vertices[edge->to].depth;
    h->spans.count = 0;
    if (from <= 0 && to <= 0) {
        return false;
    }
    if (from <= 0) {
        h->spans.spans[h->spans.count++] =
            (struct span){fraction_whole(0), {i128_from_i64(-from), i128_from_i64(to - from)}};
    } else if (to <= 0) {
        h->spans.spans[h->spans.count++] =
            (struct span){{i128_from_i64(from), i128_from_i64(from - to)}, fraction_whole(1)};
    }
    return true;
}

void hidden_end_edge(const struct hidden *h, uint32_t object, uint32_t edge,
                     const struct hidden_sink *sink) {
    struct fraction at = fraction_whole(0);
    const struct fraction end = fraction_whole(1);
    for (uint32_t i = 0; i <= h->spans.count; i++) {
        const bool last = i == h->spans.count;
        const struct hidden_segment segment = {
            object, edge, {at, last ? end : h->spans.spans[i].from}};
        if (fraction_cmp(segment.part.from, segment.part.to) < 0) {
            sink->segment(sink->context, &segment);
        }
        at = last ? end : h->spans.spans[i].to;
    }
}

bool hidden_add_shadow(struct hidden *h, uint32_t object, const struct shape_edge *edge) {
    const struct hidden_object *const o = &h->objects[object];
    bool any = false;
    for (uint32_t i = o->first_piece; i < o->first_piece + o->piece_count; i++) {
        struct span span;
        if (sight_clip(&h->sight, &h->sight.pieces[i], h->vertices[edge->from].place,
                       h->vertices[edge->to].place, &span)) {
            span_list_add(&h->spans, span);
            any = true;
        }
    }
    return any;
}

static void draw_object(struct hidden *h, uint32_t object, const struct hidden_window *border,
                        const struct hidden_sink *sink) {
    const struct shape_object *const o = &h->set->objects[object];
    const uint32_t count = hidden_neighbours(h, object);
    for (uint32_t e = o->first_edge; e < o->first_edge + o->edge_count; e++) {
        const struct shape_edge *const edge = &h->set->edges[e];
        if (h->edge_class[e] == HIDDEN_BACK || !edge->drawn || !hidden_begin_edge(h, edge)) {
            continue;
        }
        const struct hidden_window window = hidden_edge_window(h, edge);
        if (!hidden_windows_meet(&window, border)) {
            continue;
        }
        for (uint32_t k = 0; k < count && !span_list_is_full(&h->spans); k++) {
            if (hidden_windows_meet(&window, &h->objects[h->near[k]].window)) {
                (void)hidden_add_shadow(h, h->near[k], edge);
                h->shadow_tests++;
            }
        }
        hidden_end_edge(h, object, e, sink);
    }
}

void hidden_clip(struct hidden *hidden, const struct hidden_sink *sink) {
    hidden->shadow_tests = 0;
    for (uint32_t i = 0; i < hidden->set->object_count; i++) {
        if (hidden->objects[i].seen) {
            draw_object(hidden, i, &hidden->border, sink);
        }
    }
}
