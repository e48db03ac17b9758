#include "view/labels.h"

#include <math.h>

enum { PLACE_COUNT = 8 };

static bool overlap(const struct labels_box *a, const struct labels_box *b) {
    return a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom;
}

static bool covers_dot(const struct labels_box *box, const struct labels_dot *dot) {
    double x = fmin(fmax(dot->x_px, box->left), box->right);
    double y = fmin(fmax(dot->y_px, box->top), box->bottom);
    return hypot(dot->x_px - x, dot->y_px - y) < dot->radius_px;
}

static bool crosses_ring(const struct labels_surroundings *around, const struct labels_box *box) {
    double x = around->ring_x_px;
    double y = around->ring_y_px;
    double near_px =
        hypot(x - fmin(fmax(x, box->left), box->right), y - fmin(fmax(y, box->top), box->bottom));
    double far_px = hypot(fmax(fabs(x - box->left), fabs(x - box->right)),
                          fmax(fabs(y - box->top), fabs(y - box->bottom)));
    return near_px < around->ring_radius_px && around->ring_radius_px < far_px;
}

/// The eight places in the order a map maker prefers them: right first, then left, then the rest.
static struct labels_box place_of(const struct labels_dot *dot, double width_px, double height_px,
                                  int index) {
    static const signed char side[PLACE_COUNT][2] = {{1, 0},   {-1, 0}, {1, -1}, {1, 1},
                                                     {-1, -1}, {-1, 1}, {0, -1}, {0, 1}};
    const double gap_px = dot->radius_px + 3;
    double right = side[index][0];
    double down = side[index][1];
    bool diagonal = right != 0 && down != 0;
    double reach_px = diagonal ? gap_px * 0.7 : gap_px;
    double left = dot->x_px + right * reach_px + (right - 1) / 2 * width_px;
    double top = dot->y_px + down * reach_px + (down - 1) / 2 * height_px;
    return (struct labels_box){left, top, left + width_px, top + height_px};
}

bool labels_place(const struct labels_surroundings *around, const struct labels_dot *dot,
                  double width_px, double height_px, struct labels_box *box) {
    double best_cost = INFINITY;
    for (int index = 0; index < PLACE_COUNT; index++) {
        struct labels_box candidate = place_of(dot, width_px, height_px, index);
        double cost = index + (crosses_ring(around, &candidate) ? PLACE_COUNT : 0);
        bool taken =
            candidate.left < around->picture.left || candidate.right > around->picture.right ||
            candidate.top < around->picture.top || candidate.bottom > around->picture.bottom;
        for (size_t i = 0; i < around->placed_count && !taken; i++) {
            taken = overlap(&candidate, &around->placed[i]);
        }
        if (taken || cost >= best_cost) {
            continue;
        }
        for (size_t i = 0; i < around->dot_count && !taken; i++) {
            taken = covers_dot(&candidate, &around->dot[i]);
        }
        if (!taken) {
            best_cost = cost;
            *box = candidate;
        }
    }
    return best_cost < INFINITY;
}
