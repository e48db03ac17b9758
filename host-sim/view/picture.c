#include "view/picture.h"

#include "view/labels.h"
#include "view/markup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Round the sensor, in the drawing: free space on all sides, and room for the scale below.
#define MARGIN_PX 10.0
#define SCALE_PX  18.0
/// How far beyond the sensor's edge the drawing reaches to show a cone or targets that are off it.
#define REACH_MAX       1.35
#define LABEL_HEIGHT_PX 11.0
#define LABEL_COUNT_MAX 80

/// Where the sensor lies in the drawing.
struct view {
    double px_per_mm, centre_x_px, centre_y_px, height_px;
    double half_width_px, half_height_px; ///< of the sensor
};

struct target {
    struct labels_dot dot;
    const char *label;
    bool inside;
};

static double usable(double value, double otherwise) {
    return isfinite(value) ? value : otherwise;
}

/// Half the part of the image plane that is shown along one axis.
static double reach_mm(double half_mm, double cone_mm, double cone_radius_mm, double target_mm) {
    double cone_reach_mm = fabs(usable(cone_mm, 0)) + usable(cone_radius_mm, 0);
    double wanted_mm = fmax(half_mm, fmax(cone_reach_mm, target_mm) * 1.02);
    return fmin(wanted_mm, half_mm * REACH_MAX);
}

static struct view view_of(const struct report_picture *picture) {
    double half_width_mm = picture->sensor_width_mm / 2;
    double half_height_mm = picture->sensor_height_mm / 2;
    if (!(half_width_mm > 1e-6 && half_height_mm > 1e-6 && half_width_mm < 1e6 &&
          half_height_mm < 1e6)) {
        half_width_mm = 1;
        half_height_mm = 1;
    }
    double farthest_x_mm = 0;
    double farthest_y_mm = 0;
    for (size_t i = 0; i < picture->point_count; i++) {
        if (picture->points[i].is_target) {
            farthest_x_mm = fmax(farthest_x_mm, fabs(picture->points[i].x_mm));
            farthest_y_mm = fmax(farthest_y_mm, fabs(picture->points[i].y_mm));
        }
    }
    double reach_x_mm =
        reach_mm(half_width_mm, picture->cone_x_mm, picture->cone_radius_mm, farthest_x_mm);
    double reach_y_mm =
        reach_mm(half_height_mm, picture->cone_y_mm, picture->cone_radius_mm, farthest_y_mm);
    double px_per_mm = fmin((PICTURE_WIDTH_PX - 2 * MARGIN_PX) / (2 * reach_x_mm),
                            (PICTURE_HEIGHT_MAX_PX - 2 * MARGIN_PX - SCALE_PX) / (2 * reach_y_mm));
    double height_px =
        fmax(2 * reach_y_mm * px_per_mm + 2 * MARGIN_PX + SCALE_PX, (double)PICTURE_HEIGHT_MIN_PX);
    return (struct view){.px_per_mm = px_per_mm,
                         .centre_x_px = PICTURE_WIDTH_PX / 2.0,
                         .centre_y_px = (height_px - SCALE_PX) / 2,
                         .height_px = height_px,
                         .half_width_px = half_width_mm * px_per_mm,
                         .half_height_px = half_height_mm * px_per_mm};
}

/// False: not in the drawing.
static bool dot_of(const struct view *view, const struct report_point *point, double unit_px,
                   struct labels_dot *dot) {
    double size = fmin(fmax(usable(point->size, 1), 0.05), 12);
    dot->x_px = view->centre_x_px + point->x_mm * view->px_per_mm;
    dot->y_px = view->centre_y_px - point->y_mm * view->px_per_mm;
    dot->radius_px = unit_px * sqrt(size);
    return dot->x_px > -dot->radius_px && dot->x_px < PICTURE_WIDTH_PX + dot->radius_px &&
           dot->y_px > -dot->radius_px && dot->y_px < view->height_px + dot->radius_px;
}

#define TARGET_UNIT_PX     2.3
#define BACKGROUND_UNIT_PX 1.0

static bool on_sensor(const struct view *view, const struct report_point *point) {
    return fabs(point->x_mm) * view->px_per_mm <= view->half_width_px &&
           fabs(point->y_mm) * view->px_per_mm <= view->half_height_px;
}

struct picture_drawn picture_survey(const struct report_picture *picture) {
    struct view view = view_of(picture);
    struct picture_drawn drawn = {.height_px = view.height_px};
    for (size_t i = 0; i < picture->point_count; i++) {
        struct labels_dot dot;
        if (picture->points[i].is_target) {
            drawn.target_count++;
            drawn.target_outside_count += !on_sensor(&view, &picture->points[i]);
        } else {
            drawn.background_count += dot_of(&view, &picture->points[i], BACKGROUND_UNIT_PX, &dot);
        }
    }
    drawn.background_drawn_count = drawn.background_count < PICTURE_BACKGROUND_MAX
                                       ? drawn.background_count
                                       : PICTURE_BACKGROUND_MAX;
    return drawn;
}

static int larger_dot_first(const void *left, const void *right) {
    const struct labels_dot *a = left;
    const struct labels_dot *b = right;
    if (a->radius_px != b->radius_px) {
        return a->radius_px > b->radius_px ? -1 : 1;
    }
    // qsort may swap equals: the order must not depend on how it does that.
    if (a->x_px != b->x_px) {
        return a->x_px > b->x_px ? -1 : 1;
    }
    return (a->y_px < b->y_px) - (a->y_px > b->y_px);
}

static int larger_target_first(const void *left, const void *right) {
    const struct target *a = left;
    const struct target *b = right;
    return larger_dot_first(&a->dot, &b->dot);
}

/// Background points are many: one path for all of a thickness, each a line of no length with round
/// ends.
static bool draw_background(FILE *out, const struct report_picture *picture,
                            const struct view *view) {
    static const double thickness_px[] = {0.7, 1.1, 1.6, 2.2, 3.0, 4.2};
    enum { CLASS_COUNT = sizeof thickness_px / sizeof *thickness_px };
    struct labels_dot *dot = malloc((picture->point_count + 1) * sizeof *dot);
    if (dot == NULL) {
        return false;
    }
    size_t count = 0;
    for (size_t i = 0; i < picture->point_count; i++) {
        if (!picture->points[i].is_target) {
            count += dot_of(view, &picture->points[i], BACKGROUND_UNIT_PX, &dot[count]);
        }
    }
    if (count > PICTURE_BACKGROUND_MAX) {
        qsort(dot, count, sizeof *dot, larger_dot_first);
        count = PICTURE_BACKGROUND_MAX;
    }
    double thinner_px = 0;
    for (int class = 0; class < CLASS_COUNT; class ++) {
        // Each dot goes to the class whose thickness is nearest.
        double limit_px = class + 1 < CLASS_COUNT
                              ? (thickness_px[class] + thickness_px[class + 1]) / 2
                              : INFINITY;
        bool any = false;
        for (size_t i = 0; i < count; i++) {
            double wanted_px = 2 * dot[i].radius_px;
            if (wanted_px < thinner_px || wanted_px >= limit_px) {
                continue;
            }
            if (!any) {
                fprintf(out, "<path class=\"background\" stroke-width=\"%.1f\" d=\"",
                        thickness_px[class]);
            }
            any = true;
            fputc('M', out);
            markup_px(out, dot[i].x_px);
            fputc(' ', out);
            markup_px(out, dot[i].y_px);
            fputs("h0", out);
        }
        if (any) {
            fputs("\"/>\n", out);
        }
        thinner_px = limit_px;
    }
    free(dot);
    return true;
}

static void draw_rectangle(FILE *out, double left_px, double top_px, double width_px,
                           double height_px) {
    fputc('M', out);
    markup_px(out, left_px);
    fputc(' ', out);
    markup_px(out, top_px);
    fputc('h', out);
    markup_px(out, width_px);
    fputc('v', out);
    markup_px(out, height_px);
    fputc('h', out);
    markup_px(out, -width_px);
    fputc('z', out);
}

/// What lies beside the sensor is veiled, not hidden; brackets mark the frame's corners.
static void draw_frame(FILE *out, const struct view *view) {
    double left_px = view->centre_x_px - view->half_width_px;
    double top_px = view->centre_y_px - view->half_height_px;
    fputs("<path class=\"veil\" fill-rule=\"evenodd\" d=\"", out);
    draw_rectangle(out, -1, -1, PICTURE_WIDTH_PX + 2, view->height_px + 2);
    draw_rectangle(out, left_px, top_px, 2 * view->half_width_px, 2 * view->half_height_px);
    fputs("\"/>\n<path class=\"frame\" d=\"", out);
    draw_rectangle(out, left_px, top_px, 2 * view->half_width_px, 2 * view->half_height_px);
    fputs("\"/>\n<path class=\"bracket\" d=\"", out);
    double arm_px = fmin(14, 0.3 * fmin(view->half_width_px, view->half_height_px));
    for (int corner = 0; corner < 4; corner++) {
        double right = corner % 2 == 0 ? -1 : 1;
        double down = corner / 2 == 0 ? -1 : 1;
        double x_px = view->centre_x_px + right * view->half_width_px;
        double y_px = view->centre_y_px + down * view->half_height_px;
        fputc('M', out);
        markup_px(out, x_px);
        fputc(' ', out);
        markup_px(out, y_px - down * arm_px);
        fputc('v', out);
        markup_px(out, down * arm_px);
        fputc('h', out);
        markup_px(out, -right * arm_px);
    }
    fputs("\"/>\n", out);
}

static void draw_circle(FILE *out, const char *class, double x_px, double y_px, double radius_px) {
    fprintf(out, "<circle class=\"%s\" cx=\"", class);
    markup_px(out, x_px);
    fputs("\" cy=\"", out);
    markup_px(out, y_px);
    fputs("\" r=\"", out);
    markup_px(out, radius_px);
    fputs("\"", out);
}

static bool has_cone(const struct report_picture *picture) {
    return isfinite(picture->cone_x_mm) && isfinite(picture->cone_y_mm) &&
           isfinite(picture->cone_radius_mm) && picture->cone_radius_mm > 0;
}

static void draw_cone(FILE *out, const struct report_picture *picture, const struct view *view) {
    if (!has_cone(picture)) {
        return;
    }
    double x_px = view->centre_x_px + picture->cone_x_mm * view->px_per_mm;
    double y_px = view->centre_y_px - picture->cone_y_mm * view->px_per_mm;
    draw_circle(out, "cone", x_px, y_px, picture->cone_radius_mm * view->px_per_mm);
    fputs("/>\n", out);
    if (hypot(x_px - view->centre_x_px, y_px - view->centre_y_px) > 3) {
        fputs("<path class=\"miss\" d=\"M", out);
        markup_px(out, view->centre_x_px);
        fputc(' ', out);
        markup_px(out, view->centre_y_px);
        fputc('L', out);
        markup_px(out, x_px);
        fputc(' ', out);
        markup_px(out, y_px);
        fputs("\"/>\n", out);
    }
    draw_circle(out, "cone-axis", x_px, y_px, 1.8);
    fputs("/>\n", out);
}

static void draw_boresight(FILE *out, const struct view *view) {
    fputs("<path class=\"boresight\" d=\"", out);
    for (int arm = 0; arm < 4; arm++) {
        double right = (double)((arm == 0) - (arm == 1));
        double down = (double)((arm == 2) - (arm == 3));
        fputc('M', out);
        markup_px(out, view->centre_x_px + 5 * right);
        fputc(' ', out);
        markup_px(out, view->centre_y_px + 5 * down);
        fputc('l', out);
        markup_px(out, 9 * right);
        fputc(' ', out);
        markup_px(out, 9 * down);
    }
    fputs("\"/>\n", out);
}

static void draw_label(FILE *out, const struct labels_box *box, const struct target *target) {
    double middle_px = (box->left + box->right) / 2;
    const char *anchor = "middle";
    double x_px = middle_px;
    if (box->left > target->dot.x_px) { // the text starts at the dot, however wide it comes out
        anchor = "start";
        x_px = box->left;
    } else if (box->right < target->dot.x_px) {
        anchor = "end";
        x_px = box->right;
    }
    fprintf(out, "<text class=\"label\" text-anchor=\"%s\" x=\"", anchor);
    markup_px(out, x_px);
    fputs("\" y=\"", out);
    markup_px(out, box->bottom - 0.2 * LABEL_HEIGHT_PX);
    fputs("\">", out);
    markup_text(out, target->label);
    fputs("</text>\n", out);
}

/// About the width of a text in the sans-serif faces of common systems, rather too wide than too
/// narrow.
static double label_width_px(const char *text) {
    double width_em = 0;
    for (; *text != '\0'; text++) {
        if (strchr("iljtfrI1.,:;'|()[] ", *text) != NULL) {
            width_em += 0.42;
        } else if (strchr("mwMW@%", *text) != NULL) {
            width_em += 0.98;
        } else if (*text >= 'A' && *text <= 'Z') {
            width_em += 0.72;
        } else if (((unsigned char)*text & 0xC0) != 0x80) { // the first byte of a character
            width_em += 0.63;
        }
    }
    return width_em * LABEL_HEIGHT_PX;
}

/// `target` is sorted: the larger a dot, the earlier it chooses the place of its name.
static bool draw_labels(FILE *out, const struct report_picture *picture, const struct view *view,
                        const struct target *target, size_t count) {
    struct labels_box placed[LABEL_COUNT_MAX];
    enum { ARM_COUNT = 4 };
    struct labels_dot *dot = malloc((count + ARM_COUNT) * sizeof *dot);
    if (dot == NULL) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        dot[i] = target[i].dot;
    }
    for (int arm = 0; arm < ARM_COUNT; arm++) {
        double right = (double)((arm == 0) - (arm == 1));
        double down = (double)((arm == 2) - (arm == 3));
        dot[count + (size_t)arm] =
            (struct labels_dot){view->centre_x_px + 9.5 * right, view->centre_y_px + 9.5 * down, 5};
    }
    struct labels_surroundings around = {
        .picture = {2, 2, PICTURE_WIDTH_PX - 2, view->height_px - SCALE_PX},
        .dot = dot,
        .dot_count = count + ARM_COUNT,
        .placed = placed};
    if (has_cone(picture)) {
        around.ring_x_px = view->centre_x_px + picture->cone_x_mm * view->px_per_mm;
        around.ring_y_px = view->centre_y_px - picture->cone_y_mm * view->px_per_mm;
        around.ring_radius_px = picture->cone_radius_mm * view->px_per_mm;
    }
    for (size_t i = 0; i < count && around.placed_count < LABEL_COUNT_MAX; i++) {
        double width_px = label_width_px(target[i].label);
        struct labels_box box;
        if (width_px > 0 &&
            labels_place(&around, &target[i].dot, width_px, LABEL_HEIGHT_PX, &box)) {
            draw_label(out, &box, &target[i]);
            placed[around.placed_count++] = box;
        }
    }
    free(dot);
    return true;
}

/// All lines of what stands in the way, as one path.
static void draw_lines(FILE *out, const struct report_picture *picture, const struct view *view) {
    for (size_t i = 0; i < picture->line_count; i++) {
        const struct report_line *line = &picture->lines[i];
        fputs(i == 0 ? "<path class=\"solid\" d=\"M" : "M", out);
        markup_px(out, view->centre_x_px + line->x0_mm * view->px_per_mm);
        fputc(' ', out);
        markup_px(out, view->centre_y_px - line->y0_mm * view->px_per_mm);
        fputc('L', out);
        markup_px(out, view->centre_x_px + line->x1_mm * view->px_per_mm);
        fputc(' ', out);
        markup_px(out, view->centre_y_px - line->y1_mm * view->px_per_mm);
    }
    fputs(picture->line_count != 0 ? "\"/>\n" : "", out);
}

static bool draw_targets(FILE *out, const struct report_picture *picture, const struct view *view) {
    struct target *target = malloc((picture->point_count + 1) * sizeof *target);
    if (target == NULL) {
        return false;
    }
    size_t count = 0;
    for (size_t i = 0; i < picture->point_count; i++) {
        const struct report_point *point = &picture->points[i];
        if (point->is_target && dot_of(view, point, TARGET_UNIT_PX, &target[count].dot)) {
            target[count].label = point->label;
            target[count].inside = on_sensor(view, point);
            count++;
        }
    }
    qsort(target, count, sizeof *target, larger_target_first);
    for (size_t i = 0; i < count; i++) {
        const struct labels_dot *dot = &target[i].dot;
        draw_circle(out, target[i].inside ? "target" : "target lost", dot->x_px, dot->y_px,
                    dot->radius_px);
        if (target[i].label[0] == '\0') {
            fputs("/>\n", out);
        } else { // a name that finds no place can still be had from the dot
            fputs("><title>", out);
            markup_text(out, target[i].label);
            fputs("</title></circle>\n", out);
        }
    }
    bool drawn = draw_labels(out, picture, view, target, count);
    free(target);
    return drawn;
}

/// A bar of a round angle, true at the centre of the picture, and the sensor's size.
static void draw_scale(FILE *out, const struct report_picture *picture, const struct view *view) {
    static const double angles_deg[] = {60,  45,  30,  20,   15,   10,   5,     2,     1,
                                        0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};
    double y_px = view->height_px - SCALE_PX / 2;
    // A cone that leaves the drawing must not run through the text.
    fputs("<rect class=\"strip\" y=\"", out);
    markup_px(out, view->height_px - SCALE_PX);
    fprintf(out, "\" width=\"%d\" height=\"", PICTURE_WIDTH_PX);
    markup_px(out, SCALE_PX);
    fputs("\"/>\n", out);
    double left_px = fmax(view->centre_x_px - view->half_width_px, MARGIN_PX);
    double right_px = fmin(view->centre_x_px + view->half_width_px, PICTURE_WIDTH_PX - MARGIN_PX);
    for (unsigned i = 0; i < sizeof angles_deg / sizeof *angles_deg; i++) {
        double half_rad = angles_deg[i] / 2 * acos(-1) / 180;
        double length_px = 2 * picture->focal_mm * tan(half_rad) * view->px_per_mm;
        if (!(picture->focal_mm > 0) || length_px > 0.25 * (right_px - left_px)) {
            continue;
        }
        fputs("<path class=\"scale\" d=\"M", out);
        markup_px(out, left_px);
        fputc(' ', out);
        markup_px(out, y_px - 3);
        fputs("v6m0-3h", out);
        markup_px(out, length_px);
        fputs("m0-3v6\"/>\n<text class=\"quiet\" x=\"", out);
        markup_px(out, left_px + length_px + 5);
        fputs("\" y=\"", out);
        markup_px(out, y_px + 3.5);
        fprintf(out, "\">%g\u00B0</text>\n", angles_deg[i]);
        break;
    }
    fputs("<text class=\"quiet\" text-anchor=\"end\" x=\"", out);
    markup_px(out, right_px);
    fputs("\" y=\"", out);
    markup_px(out, y_px + 3.5);
    fprintf(out, "\">%.3g \u00D7 %.3g mm</text>\n", picture->sensor_width_mm,
            picture->sensor_height_mm);
}

bool picture_draw(FILE *out, const struct report_picture *picture) {
    struct view view = view_of(picture);
    fprintf(out, "<rect class=\"sensor\" width=\"%d\" height=\"", PICTURE_WIDTH_PX);
    markup_px(out, view.height_px);
    fputs("\"/>\n", out);
    if (!draw_background(out, picture, &view)) {
        return false;
    }
    draw_lines(out, picture, &view);
    draw_frame(out, &view);
    draw_cone(out, picture, &view);
    draw_boresight(out, &view);
    if (!draw_targets(out, picture, &view)) {
        return false;
    }
    draw_scale(out, picture, &view);
    return true;
}
