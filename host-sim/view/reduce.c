#include "view/reduce.h"

#include <math.h>

void reduce_start(struct reduce *reduce, reduce_sink *sink, void *context) {
    *reduce = (struct reduce){.sink = sink, .context = context, .starts = true};
}

static void close_column(struct reduce *reduce) {
    if (reduce->count == 0) {
        return;
    }
    bool smallest_first = reduce->smallest.order < reduce->largest.order;
    const struct reduce_point *kept[] = {
        &reduce->first,
        smallest_first ? &reduce->smallest : &reduce->largest,
        smallest_first ? &reduce->largest : &reduce->smallest,
        &reduce->last,
    };
    for (unsigned i = 0; i < 4; i++) {
        if (i > 0 && kept[i]->order == kept[i - 1]->order) {
            continue;
        }
        reduce->sink(reduce->context, kept[i]->x_px, kept[i]->y_px, reduce->starts);
        reduce->starts = false;
    }
    reduce->count = 0;
}

void reduce_add(struct reduce *reduce, double x_px, double y_px) {
    if (!isfinite(x_px) || !isfinite(y_px)) {
        reduce_gap(reduce);
        return;
    }
    if (reduce->count > 0 && floor(x_px) != reduce->column) {
        close_column(reduce);
    }
    struct reduce_point point = {.x_px = x_px, .y_px = y_px, .order = reduce->count};
    if (reduce->count == 0) {
        reduce->column = floor(x_px);
        reduce->first = point;
        reduce->smallest = point;
        reduce->largest = point;
    }
    if (y_px < reduce->smallest.y_px) {
        reduce->smallest = point;
    }
    if (y_px > reduce->largest.y_px) {
        reduce->largest = point;
    }
    reduce->last = point;
    reduce->count++;
}

void reduce_gap(struct reduce *reduce) {
    close_column(reduce);
    reduce->starts = true;
}
