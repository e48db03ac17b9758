/// What `boresight plan` says of a mount, from outside: the mount is moved, the picture is drawn by
/// other formulas, the sphere is walked on. SEED=N.
#include "check.h"
#include "support/messages.h"

#include "plan.h"

#include "property/support/xml.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

__extension__ typedef __int128 wide;

static uint64_t seed = 71123;

#define COUNT_MAX 9U

static int32_t draw(int32_t range) {
    return (int32_t)(check_random(&seed) % (uint64_t)(2 * range + 1)) - range;
}

// ---------------------------------------------------------------- a set, in hundredths

struct set {
    uint32_t count;
    int32_t target[COUNT_MAX][3]; ///< hundredths of a metre
    int32_t mount[3];
    struct points points;
    struct plan plan;
    struct plan_view view;
};

static void write_place(FILE *out, const int32_t c[3]) {
    fprintf(out, "%.2f %.2f %.2f\n", c[0] / 100.0, c[1] / 100.0, c[2] / 100.0);
}

/// Draws targets and a mount that is at none of them, and looks from there.
static bool look_past(struct set *s, uint32_t least, const struct scene_text *scene) {
    char text[1024], mount[100] = "";
    const char *const end = mount + sizeof mount;
    FILE *out = fmemopen(text, sizeof text, "w");
    s->count = least + (uint32_t)(check_random(&seed) % (COUNT_MAX + 1U - least));
    const int32_t range = check_random(&seed) % 2U != 0U ? 400 : 9;
    for (uint32_t i = 0; i < s->count;) {
        bool new = true;
        for (int k = 0; k < 3; k++) {
            s->target[i][k] = draw(range);
        }
        for (uint32_t j = 0; j < i; j++) {
            new = new &&memcmp(s->target[i], s->target[j], sizeof s->target[i]) != 0;
        }
        if (new) {
            write_place(out, s->target[i++]);
        }
    }
    fclose(out);
    for (int k = 0; k < 3; k++) {
        s->mount[k] = draw(3 * range);
    }
    out = fmemopen(mount, sizeof mount, "w");
    write_place(out, s->mount);
    fclose(out);
    for (char *at = mount; at < end; at++) { // each word ends with a NUL
        *at = *at == ' ' || *at == '\n' ? '\0' : *at;
    }
    FILE *const in = messages_input(text, strlen(text));
    const struct points_format format = {.input = POINTS_XYZ, .places = true};
    s->plan = (struct plan){.camera = {.width_px = 1280, .height_px = 720},
                            .planes = true,
                            .unit_cm = 100,
                            .text = scene,
                            .text_file = "scene"};
    const bool good = points_read_stream(in, "t", &format, &s->points) == EXIT_STATUS_OK &&
                      plan_set(&s->plan, &s->points, mount, 1, 0) == EXIT_STATUS_OK &&
                      plan_look(&s->plan, s->plan.mounts[0], &s->view) == EXIT_STATUS_OK;
    fclose(in);
    return CHECK(good);
}

static bool look(struct set *s, uint32_t least) {
    return look_past(s, least, NULL);
}

static void forget(struct set *s) {
    points_free(&s->points);
    plan_free(&s->plan);
}

// ---------------------------------------------------------------- exact: 2^-20 of a hundredth

struct fine {
    int64_t c[3];
};

static struct fine fine_of(const int32_t c[3]) {
    const int64_t unit = 1 << 20;
    return (struct fine){{c[0] * unit, c[1] * unit, c[2] * unit}};
}

static struct fine fine_at(const double metres[3]) {
    return (struct fine){
        {llround(metres[0] * 0x64p20), llround(metres[1] * 0x64p20), llround(metres[2] * 0x64p20)}};
}

/// Sign of det(b - a, c - a, m - a).
static int side_of(const struct set *s, uint32_t i, uint32_t j, uint32_t k, struct fine m) {
    const struct fine a = fine_of(s->target[i]), b = fine_of(s->target[j]),
                      c = fine_of(s->target[k]);
    wide det = 0;
    for (int x = 0; x < 3; x++) {
        const int y = (x + 1) % 3, z = (x + 2) % 3;
        const wide minor = (wide)(b.c[y] - a.c[y]) * (c.c[z] - a.c[z]) -
                           (wide)(b.c[z] - a.c[z]) * (c.c[y] - a.c[y]);
        det += minor * (m.c[x] - a.c[x]);
    }
    return (det > 0) - (det < 0);
}

/// How many triples turn the other way, or lie in a plane with the viewpoint, as seen from there.
static unsigned turned(const struct set *s, struct fine from, struct fine to) {
    unsigned count = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        for (uint32_t j = i + 1U; j < s->count; j++) {
            for (uint32_t k = j + 1U; k < s->count; k++) {
                count += side_of(s, i, j, k, from) != side_of(s, i, j, k, to) ? 1U : 0U;
            }
        }
    }
    return count;
}

/// The mount moved by a part of the way to a place.
static struct fine moved(const struct set *s, const double to[3], double part) {
    double at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = s->view.place[k] + part * (to[k] - s->view.place[k]);
    }
    return fine_at(at);
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static void margins(void) {
    unsigned moves = 0;
    for (int round = 0; round < 300 && check_clean(); round++) {
        struct set s;
        if (!look(&s, 3)) {
            return;
        }
        const struct plan_view *const v = &s.view;
        const struct fine here = fine_of(s.mount);
        if (v->at_target == s.count && isfinite(v->plane_cm) && v->plane_cm > 1e-3) {
            // By a thousandth less than the margin, and more.
            CHECK(fabs(distance(v->place, v->plane_foot) * 100 / v->plane_cm - 1) < 1e-9);
            CHECK_EQ(turned(&s, here, moved(&s, v->plane_foot, 0.999)), 0);
            CHECK(turned(&s, here, moved(&s, v->plane_foot, 1.001)) > 0U);
            const uint32_t *const t = v->margins.plane.target;
            CHECK_EQ(side_of(&s, t[0], t[1], t[2], moved(&s, v->plane_foot, 1.001)),
                     -side_of(&s, t[0], t[1], t[2], here));
            CHECK(fabs(distance(v->place, v->line_foot) * 100 / v->line_cm - 1) < 1e-9);
            CHECK(v->margin_cm == v->plane_cm);
            moves++;
        }
        forget(&s);
    }
    check_note("mounts moved", moves);
    CHECK(moves > 50U);
}

// ---------------------------------------------------------------- the picture

/// The picture's distances from angles only: no projection. With a target at the angle p from the
/// axis, and two of them at the angle q from each other, by the law of cosines on the picture.
static double image_distance(const struct set *s, uint32_t i, uint32_t j) {
    long double d[2][3], depth[2], length2[2] = {0, 0}, between = 0;
    const struct vec3 a = s->view.cone.axis_q30;
    const long double axis[3] = {a.x, a.y, a.z};
    const long double size = sqrtl(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int k = 0; k < 3; k++) {
        d[0][k] = s->target[i][k] - s->mount[k];
        d[1][k] = s->target[j][k] - s->mount[k];
    }
    for (int e = 0; e < 2; e++) {
        depth[e] = (d[e][0] * axis[0] + d[e][1] * axis[1] + d[e][2] * axis[2]) / size;
        for (int k = 0; k < 3; k++) {
            length2[e] += d[e][k] * d[e][k] / depth[e] / depth[e];
        }
    }
    for (int k = 0; k < 3; k++) {
        between += d[0][k] * d[1][k] / depth[0] / depth[1];
    }
    return (double)sqrtl(fmaxl(0, length2[0] + length2[1] - 2 * between)) * s->view.focal_px;
}

/// By Heron's formula, from the sides.
static double triangle_height(double a, double b, double c) {
    const double half = (a + b + c) / 2, area2 = half * (half - a) * (half - b) * (half - c);
    return 2 * sqrt(fmax(0, area2)) / fmax(a, fmax(b, c));
}

static void pixels(void) {
    unsigned pictures = 0;
    for (int round = 0; round < 300 && check_clean(); round++) {
        struct set s;
        if (!look(&s, 3)) {
            return;
        }
        if (s.view.cone_status == CONE_OK && s.view.half_angle_rad < 1.2) {
            double pair = INFINITY, triple = INFINITY, widest = 0;
            const double axis_distance = 360 / s.view.focal_px;
            for (uint32_t i = 0; i < s.count; i++) {
                for (uint32_t j = i + 1U; j < s.count; j++) {
                    const double ij = image_distance(&s, i, j);
                    pair = fmin(pair, ij);
                    widest = fmax(widest, ij);
                    for (uint32_t k = j + 1U; k < s.count; k++) {
                        const double height =
                            triangle_height(ij, image_distance(&s, i, k), image_distance(&s, j, k));
                        // Three on one line in space don't count.
                        const struct fine off = {{1234577, -7654321, 1357911}};
                        if (side_of(&s, i, j, k, off) != 0) {
                            triple = fmin(triple, height);
                        }
                    }
                }
            }
            CHECK(fabs(pair - s.view.pair_px) < 1e-6 * (1 + pair));
            CHECK(!isfinite(triple) || fabs(triple - s.view.triple_px) < 1e-3 * (1 + triple));
            // The cone touches the short side, 720 pixels, and all targets lie in it.
            CHECK(fabs(axis_distance / tan(s.view.half_angle_rad) - 1) < 1e-9);
            CHECK(widest <= 720.001 && widest > 360);
            pictures++;
        }
        forget(&s);
    }
    check_note("pictures", pictures);
    CHECK(pictures > 50U);
}

// ---------------------------------------------------------------- the sphere

/// From `from` by an angle toward the direction `to`, on the sphere about the targets' centre.
static struct fine walk(const struct set *s, const struct plan_sphere *sphere, const double to[3],
                        double angle) {
    const double *const w = sphere->toward;
    const double along = w[0] * to[0] + w[1] * to[1] + w[2] * to[2];
    double across[3], at[3], size = 0;
    for (int k = 0; k < 3; k++) {
        across[k] = to[k] - along * w[k];
        size += across[k] * across[k];
    }
    for (int k = 0; k < 3; k++) {
        at[k] = s->plan.center[k] +
                sphere->radius * (cos(angle) * w[k] + sin(angle) * across[k] / sqrt(size));
    }
    return fine_at(at);
}

static void spheres(void) {
    unsigned walks = 0;
    for (int round = 0; round < 200 && check_clean(); round++) {
        struct set s;
        struct plan_sphere sphere;
        if (!look(&s, 4) || !CHECK(plan_sphere_set(&sphere, &s.plan, &s.view))) {
            return;
        }
        const double tolerance = sphere.tolerance_rad;
        if (s.view.at_target == s.count && s.view.plane_cm > 1e-2 && sphere.circle_count != 0U &&
            isfinite(tolerance) && tolerance * sphere.radius > 1e-4) {
            const struct fine here = fine_of(s.mount);
            for (int way = 0; way < 12; way++) {
                const double to[3] = {sin(way), cos(way), sin(2.0 * way)};
                CHECK_EQ(turned(&s, here, walk(&s, &sphere, to, tolerance * 0.999)), 0);
            }
            // Toward the nearest circle, over it.
            const struct plan_circle *const c = &sphere.circles[0];
            const double *const n = c->normal, *const w = sphere.toward;
            const double sign = n[0] * w[0] + n[1] * w[1] + n[2] * w[2] > c->height ? -1.0 : 1.0;
            const double to[3] = {sign * n[0], sign * n[1], sign * n[2]};
            CHECK_EQ(turned(&s, here, walk(&s, &sphere, to, c->gap_rad * 0.999)), 0);
            CHECK(turned(&s, here, walk(&s, &sphere, to, c->gap_rad * 1.001)) > 0U);
            CHECK(sphere.points[0].gap_rad >= tolerance);
            walks++;
        }
        plan_sphere_free(&sphere);
        forget(&s);
    }
    check_note("spheres walked on", walks);
    CHECK(walks > 30U);
}

// ---------------------------------------------------------------- what is in the way

struct box {
    int32_t low[3], high[3];
};

/// As Wavefront OBJ: a solid, or only its lid as a face.
static void write_box(FILE *out, const struct box *box, bool solid, int number) {
    static const char *const faces[] = {"4 3 2 1", "5 6 7 8", "1 2 6 5",
                                        "2 3 7 6", "3 4 8 7", "4 1 5 8"};
    static const int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    fprintf(out, "o box%d\n", number);
    for (int i = 0; i < 8; i++) {
        int32_t c[3];
        for (int k = 0; k < 3; k++) {
            c[k] = corner[i][k] != 0 ? box->high[k] : box->low[k];
        }
        fputs("v ", out);
        write_place(out, c);
    }
    for (int i = solid ? 0 : 1; i < (solid ? 6 : 2); i++) {
        fputs("f", out);
        for (const char *at = faces[i]; *at != '\0'; at += 2) {
            fprintf(out, " %d", 8 * number + *at - '0');
            if (at[1] == '\0') {
                break;
            }
        }
        fputc('\n', out);
    }
}

/// Is some point of the way from a to b strictly inside the box? By slabs, in exact fractions.
static bool box_hides(const struct box *box, const int32_t a[3], const int32_t b[3]) {
    int64_t low_num = 0, low_den = 1, high_num = 1, high_den = 1;
    for (int k = 0; k < 3; k++) {
        const int64_t d = (int64_t)b[k] - a[k], den = d < 0 ? -d : d;
        const int64_t enter = (int64_t)box->low[k] - a[k], leave = (int64_t)box->high[k] - a[k];
        const int64_t first = d < 0 ? -leave : enter, last = d < 0 ? -enter : leave;
        if (d == 0 && !(enter < 0 && leave > 0)) {
            return false;
        }
        if (d != 0 && first * low_den > low_num * den) {
            low_num = first;
            low_den = den;
        }
        if (d != 0 && last * high_den < high_num * den) {
            high_num = last;
            high_den = den;
        }
    }
    return high_num * low_den > low_num * high_den;
}

/// Does the way from a to b pierce the box's lid, strictly inside and between the ends?
static bool lid_is_pierced(const struct box *box, const int32_t a[3], const int32_t b[3]) {
    const int64_t d = (int64_t)b[2] - a[2], up = (int64_t)box->high[2] - a[2];
    if (d == 0 || (d > 0 ? up <= 0 || up >= d : up >= 0 || up <= d)) {
        return false;
    }
    for (int k = 0; k < 2; k++) { // a + (b - a) up / d, strictly between the sides
        const int64_t at = ((int64_t)b[k] - a[k]) * up, sign = d > 0 ? 1 : -1;
        if (!(sign * (at - ((int64_t)box->low[k] - a[k]) * d) > 0 &&
              sign * (((int64_t)box->high[k] - a[k]) * d - at) > 0)) {
            return false;
        }
    }
    return true;
}

static void what_is_hidden(void) {
    char path[] = "build/plan.XXXXXX";
    unsigned hidden = 0, seen = 0;
    close(mkstemp(path));
    for (int round = 0; round < 400 && check_clean(); round++) {
        struct box box[3];
        bool solid[3];
        const int boxes = 1 + (int)(check_random(&seed) % 3U);
        FILE *const out = fopen(path, "w");
        for (int i = 0; i < boxes; i++) {
            solid[i] = check_random(&seed) % 3U != 0U;
            const int32_t size = round % 2 == 0 ? 1 : 40; // targets are within 9, or 400
            for (int k = 0; k < 3; k++) {
                box[i].low[k] = size * draw(20);
                box[i].high[k] = box[i].low[k] + size * (18 + draw(9));
            }
            write_box(out, &box[i], solid[i], i);
        }
        fclose(out);
        struct scene_text scene;
        struct set s;
        if (!CHECK_EQ(scene_text_read(path, true, &scene), EXIT_STATUS_OK) ||
            !look_past(&s, 3, &scene)) {
            break;
        }
        const uint32_t count = plan_hidden(&s.plan, s.view.at);
        for (uint32_t i = 0, at = 0; i < s.count; i++) {
            bool wanted = false;
            for (int k = 0; k < boxes; k++) {
                wanted = wanted || (solid[k] ? box_hides(&box[k], s.mount, s.target[i])
                                             : lid_is_pierced(&box[k], s.mount, s.target[i]));
            }
            const bool got = at < count && s.plan.hidden[at] == i;
            at += got ? 1U : 0U;
            if (!CHECK_EQ(got, wanted)) {
                printf("  from %d %d %d to %d %d %d\n", s.mount[0], s.mount[1], s.mount[2],
                       s.target[i][0], s.target[i][1], s.target[i][2]);
                for (int k = 0; k < boxes; k++) {
                    printf("  %s %d %d %d to %d %d %d\n", solid[k] ? "box" : "lid", box[k].low[0],
                           box[k].low[1], box[k].low[2], box[k].high[0], box[k].high[1],
                           box[k].high[2]);
                }
            }
            *(wanted ? &hidden : &seen) += 1U;
        }
        CHECK(s.view.cone_status != CONE_OK || s.view.hidden_count == count);
        CHECK(count == 0U || !s.view.usable);
        forget(&s);
        scene_text_free(&scene);
    }
    unlink(path);
    printf("# targets hidden %u, seen %u\n", hidden, seen);
    CHECK(hidden > 50U && seen > 100U);
}

static void pictures_are_xml(void) {
    char path[] = "build/plan.XXXXXX";
    const int file = mkstemp(path);
    CHECK(file >= 0);
    close(file);
    for (int round = 0; round < 20 && check_clean(); round++) {
        struct set s;
        struct plan_sphere sphere;
        if (!look(&s, 1) || !CHECK(plan_sphere_set(&sphere, &s.plan, &s.view))) {
            return;
        }
        if (sphere.radius > 0) {
            CHECK_EQ(plan_draw(&s.plan, &sphere, "a <b> & \"c\"", path), EXIT_STATUS_OK);
            static char text[200000];
            FILE *const in = fopen(path, "r");
            const size_t size = fread(text, 1, sizeof text, in);
            fclose(in);
            size_t at;
            CHECK(xml_check(text, size, &at) == NULL);
            CHECK(strstr(text, "nan") == NULL && strstr(text, "inf") == NULL);
        }
        plan_sphere_free(&sphere);
        forget(&s);
    }
    unlink(path);
}

int main(void) {
    seed = getenv("SEED") != NULL ? strtoull(getenv("SEED"), NULL, 10) : seed;
    check_note("seed", (int64_t)seed);
    TEST(margins);
    TEST(pixels);
    TEST(spheres);
    TEST(what_is_hidden);
    TEST(pictures_are_xml);
    return check_finish();
}
