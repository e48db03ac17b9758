#include "plan.h"

#include "measure.h"

#include "view/markup.h"
#include "view/new_file.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Pixels of the drawing.
enum { WIDTH = 720, HEIGHT = 400, BALL = 165, BALL_Y = 185 };
/// The nearest ones are drawn; more would hide each other.
enum { CIRCLES_MOST = 400, POINTS_MOST = 2000 };

/// One side of the sphere, as seen from far away.
struct side {
    FILE *out;
    double middle;                     ///< x in pixels
    double right[3], up[3], toward[3]; ///< the viewer's axes
};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void put(const struct side *side, const char *name, double value, bool along_x) {
    fprintf(side->out, " %s=\"", name);
    markup_px(side->out, along_x ? side->middle + BALL * value : BALL_Y - BALL * value);
    fputc('"', side->out);
}

static void draw_dot(const struct side *side, const char *class, const double p[3], double radius) {
    fprintf(side->out, "<circle class=\"%s\"", class);
    put(side, "cx", dot(p, side->right), true);
    put(side, "cy", dot(p, side->up), false);
    fprintf(side->out, " r=\"%.1f\"/>\n", radius);
}

// ---------------------------------------------------------------- circles

/// height * normal + radius * (cos(angle) * u + sin(angle) * v), u at right angles to the line of
/// sight.
struct ring {
    double center[3], u[3], v[3];
    double radius;
};

static struct ring ring_of(const struct plan_circle *circle, const struct side *side) {
    struct ring ring = {.radius = sqrt(1 - circle->height * circle->height)};
    const double *const n = circle->normal, *const w = side->toward;
    const double along = dot(n, side->right), across = dot(n, side->up);
    const double size = sqrt(along * along + across * across);
    for (int k = 0; k < 3; k++) {
        ring.center[k] = circle->height * n[k];
        ring.u[k] =
            size > 1e-12 ? (across * side->right[k] - along * side->up[k]) / size : side->right[k];
    }
    ring.v[0] = n[1] * ring.u[2] - n[2] * ring.u[1];
    ring.v[1] = n[2] * ring.u[0] - n[0] * ring.u[2];
    ring.v[2] = n[0] * ring.u[1] - n[1] * ring.u[0];
    if (dot(ring.v, w) < 0) { // so that it is on this side round a quarter turn
        for (int k = 0; k < 3; k++) {
            ring.v[k] = -ring.v[k];
        }
    }
    return ring;
}

static void put_point(const struct side *side, const struct ring *ring, double angle) {
    double p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = ring->center[k] + ring->radius * (cos(angle) * ring->u[k] + sin(angle) * ring->v[k]);
    }
    markup_px(side->out, side->middle + BALL * dot(p, side->right));
    fputc(' ', side->out);
    markup_px(side->out, BALL_Y - BALL * dot(p, side->up));
}

/// The part of the circle on this side, as two arcs of its ellipse.
static void draw_circle(const struct side *side, const struct plan_circle *circle,
                        const char *class) {
    const struct ring ring = ring_of(circle, side);
    const double rise = ring.radius * dot(ring.v, side->toward),
                 depth = dot(ring.center, side->toward);
    // It is on this side where depth + rise sin(angle) > 0.
    double from = -M_PI_2, to = 1.5 * M_PI;
    if (depth < rise && -depth < rise) {
        from = asin(-depth / rise);
        to = M_PI - from;
    } else if (depth <= 0) {
        return;
    }
    const double tall = fabs(dot(circle->normal, side->toward)) * ring.radius * BALL,
                 turn = atan2(-dot(ring.u, side->up), dot(ring.u, side->right));
    const double way = dot(ring.u, side->right) * dot(ring.v, side->up) -
                       dot(ring.u, side->up) * dot(ring.v, side->right);
    fprintf(side->out, "<path class=\"%s\" d=\"M", class);
    put_point(side, &ring, from);
    for (int half = 1; half <= 2; half++) {
        fprintf(side->out, "A%.1f %.1f %.1f 0 %d ", ring.radius * BALL, tall,
                turn * MEASURE_DEG_PER_RAD, way < 0);
        put_point(side, &ring, from + (to - from) * half / 2);
    }
    fputs("\"/>\n", side->out);
}

// ---------------------------------------------------------------- the whole

static void draw_side(const struct side *side, const struct plan *plan,
                      const struct plan_sphere *sphere) {
    static const double center[3];
    draw_dot(side, "ball", center, BALL);
    for (uint32_t i = 0; i < sphere->circle_count && i < CIRCLES_MOST; i++) {
        draw_circle(side, &sphere->circles[i], i == 0U ? "nearest" : "circle");
    }
    for (uint32_t i = 0; i < sphere->point_count && i < POINTS_MOST; i++) {
        if (dot(sphere->points[i].direction, side->toward) > 0) {
            draw_dot(side, "point", sphere->points[i].direction, 1.6);
        }
    }
    for (uint32_t i = 0; i < plan->target_count; i++) {
        const struct vec3 t = plan->targets[i];
        const double c[3] = {(t.x * plan->grid - plan->center[0]) / sphere->radius,
                             (t.y * plan->grid - plan->center[1]) / sphere->radius,
                             (t.z * plan->grid - plan->center[2]) / sphere->radius};
        draw_dot(side, "target", c, 2.4);
    }
    if (dot(sphere->toward, side->toward) > 0) {
        const double disc = fmin(sphere->tolerance_rad, M_PI_2);
        draw_dot(side, "disc", center, BALL * sin(disc));
        draw_dot(side, "chosen", sphere->toward, 2.8);
    }
}

static void write_words(FILE *out, const struct plan_sphere *sphere, const char *title) {
    fprintf(out, "<text x=\"190\" y=\"372\">");
    markup_text(out, title);
    fputs("</text>\n<text x=\"530\" y=\"372\">the far side</text>\n", out);
    fprintf(out, "<text x=\"360\" y=\"392\">%" PRIu32 " forbidden points, %" PRIu32 " circles",
            sphere->point_count, sphere->circle_count);
    if (sphere->circle_count > CIRCLES_MOST || sphere->point_count > POINTS_MOST) {
        fputs(" (the nearest are drawn)", out);
    }
    if (isfinite(sphere->tolerance_rad)) {
        fprintf(out, "; tolerance %.3g degrees", sphere->tolerance_rad * MEASURE_DEG_PER_RAD);
    }
    fputs("</text>\n</svg>\n", out);
}

static void write_picture(FILE *out, const struct plan *plan, const struct plan_sphere *sphere,
                          const char *title) {
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "height=\"%d\">\n<title>",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    markup_text(out, title);
    fputs("</title>\n<style>.paper{fill:#fff}.ball{fill:#f6f7f9;stroke:#456}"
          ".circle,.nearest{fill:none;stroke:#68a;stroke-width:.5}"
          ".nearest{stroke:#c40;stroke-width:1.2}.point{fill:#456}.target{fill:#2a7}"
          ".disc{fill:#c40;fill-opacity:.15;stroke:#c40}.chosen{fill:#c40}"
          "text{font:13px sans-serif;text-anchor:middle;fill:#234}</style>\n"
          "<rect class=\"paper\" width=\"720\" height=\"400\"/>\n",
          out);
    struct side side = {.out = out, .middle = 190};
    memcpy(side.toward, sphere->toward, sizeof side.toward);
    const double *const w = side.toward, flat = hypot(w[0], w[1]);
    side.right[0] = flat > 1e-9 ? -w[1] / flat : 1;
    side.right[1] = flat > 1e-9 ? w[0] / flat : 0;
    side.up[0] = w[1] * side.right[2] - w[2] * side.right[1];
    side.up[1] = w[2] * side.right[0] - w[0] * side.right[2];
    side.up[2] = w[0] * side.right[1] - w[1] * side.right[0];
    draw_side(&side, plan, sphere);
    side.middle = 530;
    for (int k = 0; k < 3; k++) { // from behind
        side.toward[k] = -side.toward[k];
        side.right[k] = -side.right[k];
    }
    draw_side(&side, plan, sphere);
    write_words(out, sphere, title);
}

enum exit_status plan_draw(const struct plan *plan, const struct plan_sphere *sphere,
                           const char *title, const char *path) {
    char *bytes = NULL;
    size_t size = 0;
    FILE *const out = open_memstream(&bytes, &size);
    if (out == NULL) {
        message_command("plan", "no memory for a picture");
        return EXIT_STATUS_FAILURE;
    }
    write_picture(out, plan, sphere, title);
    const bool whole = fclose(out) == 0;
    enum exit_status status = EXIT_STATUS_OK;
    if (!whole || !new_file_write(path, bytes, size)) {
        message_at(path, 0, "can't be written: %s", strerror(errno));
        status = EXIT_STATUS_FAILURE;
    }
    free(bytes);
    return status;
}
