/// hidden_clip and hidden_levine: the same parts of lines, exactly; and a ray to the middle of each
/// part and each gap, in rational numbers, says the same. SEED=N, COUNT=N views of each kind.
#include "check.h"
#include "property/support/hidden_scenes.h"
#include "property/support/solid_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed;
static unsigned long view_count = 60UL;

struct picture {
    struct hidden_segment *segments;
    uint32_t count, room;
};

static void keep_segment(void *context, const struct hidden_segment *segment) {
    struct picture *const p = context;
    if (p->count == p->room) {
        p->room = p->room == 0U ? 256U : 2U * p->room;
        p->segments = realloc(p->segments, p->room * sizeof *p->segments);
    }
    p->segments[p->count++] = *segment;
}

static int by_edge(const void *a, const void *b) {
    const struct hidden_segment *const x = a, *const y = b;
    if (x->edge != y->edge) {
        return x->edge < y->edge ? -1 : 1;
    }
    return fraction_cmp(x->part.from, y->part.from);
}

static void to_mpz(mpz_t out, struct i128 value) {
    mpz_set_si(out, value.hi);
    mpz_mul_2exp(out, out, 32);
    mpz_add_ui(out, out, (unsigned long)(value.lo >> 32));
    mpz_mul_2exp(out, out, 32);
    mpz_add_ui(out, out, (unsigned long)(value.lo & UINT32_MAX));
}

static void to_mpq(mpq_t out, struct fraction value) {
    to_mpz(mpq_numref(out), value.num);
    to_mpz(mpq_denref(out), value.den);
    mpq_canonicalize(out);
}

/// A point of a part of an edge: (from + weight * to) / (1 + weight).
static void between(const struct shape_set *set, uint32_t edge, struct fraction from,
                    struct fraction to, unsigned weight, struct ray_point *point) {
    const struct vec3 a = set->vertices[set->edges[edge].from],
                      b = set->vertices[set->edges[edge].to];
    const long start[3] = {a.x, a.y, a.z}, end[3] = {b.x, b.y, b.z};
    mpq_t t, s;
    mpz_t part;
    mpq_inits(t, s, NULL);
    mpz_init(part);
    to_mpq(t, from);
    to_mpq(s, to);
    mpz_mul_ui(mpq_numref(s), mpq_numref(s), weight);
    mpq_canonicalize(s);
    mpq_add(t, t, s);
    mpq_set_ui(s, 1U + weight, 1);
    mpq_div(t, t, s);
    mpz_set(point->w, mpq_denref(t));
    for (int i = 0; i < 3; i++) {
        mpz_mul_si(point->x[i], mpq_denref(t), start[i]);
        mpz_mul_si(part, mpq_numref(t), end[i] - start[i]);
        mpz_add(point->x[i], point->x[i], part);
    }
    mpq_clears(t, s, NULL);
    mpz_clear(part);
}

static int depth_sign(const struct hidden_camera *c, const struct ray_point *point) {
    const long axis[3] = {c->ahead.x, c->ahead.y, c->ahead.z},
               eye[3] = {c->eye.x, c->eye.y, c->eye.z};
    mpz_t sum, part;
    mpz_inits(sum, part, NULL);
    for (int i = 0; i < 3; i++) {
        mpz_mul_si(part, point->w, eye[i]);
        mpz_sub(part, point->x[i], part);
        mpz_mul_si(part, part, axis[i]);
        mpz_add(sum, sum, part);
    }
    const int sign = mpz_sgn(sum);
    mpz_clears(sum, part, NULL);
    return sign;
}

static bool ray_sees(const struct hidden_scene *scene, const struct hidden_camera *camera,
                     const struct ray_point *point) {
    const int32_t eye[3] = {camera->eye.x, camera->eye.y, camera->eye.z};
    bool sees = depth_sign(camera, point) > 0;
    for (uint32_t i = 0; i < scene->body_count && sees; i++) {
        sees = scene->body[i].face_count == 0U || !ray_is_stopped(&scene->body[i], eye, point);
    }
    return sees;
}

static uint64_t rays, hidden_rays;

/// A part in its middle. A gap may be what two objects hide that meet there in the picture, and a
/// line of sight passes between them: it is looked at elsewhere.
static bool agrees(const struct hidden_scene *scene, const struct hidden_camera *camera,
                   uint32_t edge, struct fraction from, struct fraction to, bool visible) {
    struct ray_point point;
    ray_point_init(&point);
    between(&scene->set, edge, from, to, visible ? 1U : 7919U, &point);
    const bool sees = ray_sees(scene, camera, &point);
    ray_point_clear(&point);
    rays++;
    hidden_rays += sees ? 0U : 1U;
    return sees == visible;
}

/// Each part and each gap of each edge that is not at the back.
static bool check_rays(const struct hidden_scene *scene, const struct hidden *hidden,
                       const struct picture *picture) {
    uint32_t k = 0;
    for (uint32_t e = 0; e < scene->set.edge_count; e++) {
        struct fraction at = fraction_whole(0);
        bool right = true;
        for (; k < picture->count && picture->segments[k].edge == e; k++) {
            const struct span part = picture->segments[k].part;
            if (fraction_cmp(at, part.from) < 0) {
                right = right && agrees(scene, &hidden->camera, e, at, part.from, false);
            }
            right = right && fraction_cmp(at, part.from) <= 0 &&
                    agrees(scene, &hidden->camera, e, part.from, part.to, true);
            at = part.to;
        }
        if (hidden->edge_class[e] != HIDDEN_BACK && fraction_cmp(at, fraction_whole(1)) < 0) {
            right = right && agrees(scene, &hidden->camera, e, at, fraction_whole(1), false);
        }
        if (!CHECK(right)) {
            return false;
        }
    }
    return CHECK_EQ(k, picture->count);
}

static bool check_same(const struct picture *a, const struct picture *b) {
    if (!CHECK_EQ(a->count, b->count)) {
        return false;
    }
    for (uint32_t i = 0; i < a->count; i++) {
        if (!CHECK(a->segments[i].edge == b->segments[i].edge &&
                   fraction_cmp(a->segments[i].part.from, b->segments[i].part.from) == 0 &&
                   fraction_cmp(a->segments[i].part.to, b->segments[i].part.to) == 0)) {
            return false;
        }
    }
    return true;
}

static struct hidden_counters counters;

/// One view by both methods; the thesis' with and without counters.
static bool check_view(const struct hidden_scene *scene, struct hidden *hidden,
                       struct separate *separate, const struct hidden_camera *camera) {
    struct picture clip = {NULL, 0, 0}, levine = {NULL, 0, 0};
    const struct hidden_sink clip_sink = {keep_segment, &clip},
                             levine_sink = {keep_segment, &levine};
    hidden_look(hidden, camera);
    hidden_clip(hidden, &clip_sink);
    bool right = check_rays(scene, hidden, &clip);
    for (int counted = 0; counted < 2 && right && separate != NULL; counted++) {
        separate_look(separate, camera->eye);
        levine.count = 0;
        hidden_levine(hidden, separate, &levine_sink, counted != 0 ? &counters : NULL);
        qsort(levine.segments, levine.count, sizeof *levine.segments, by_edge);
        right = check_same(&clip, &levine);
    }
    free(clip.segments);
    free(levine.segments);
    return right;
}

static void check_kind(enum hidden_scene_kind kind) {
    rays = hidden_rays = 0;
    for (unsigned long n = 0; n < view_count && check_clean(); n += 10U) {
        struct hidden_scene scene;
        struct hidden hidden;
        struct separate separate;
        uint32_t fault[2];
        hidden_scene_open(&scene, HIDDEN_BODIES_MAX);
        hidden_scene_draw(&scene, kind, &seed);
        const size_t bytes = hidden_workspace_bytes(&scene.set),
                     more = SEPARATE_WORKSPACE_BYTES(scene.set.object_count, 400);
        void *const workspace = malloc(bytes), *const planes = malloc(more);
        bool apart = kind != HIDDEN_OVERLAPPED;
        CHECK_EQ(hidden_open(&hidden, &scene.set, workspace, bytes), HIDDEN_OK);
        if (apart) {
            apart = CHECK_EQ(separate_build(&separate, &scene.set, 400, planes, more, fault),
                             SEPARATE_OK);
        }
        for (int view = 0; view < 10 && check_clean(); view++) {
            const struct hidden_camera camera = hidden_scene_camera(kind, &seed);
            if (!check_view(&scene, &hidden, apart ? &separate : NULL, &camera)) {
                printf("# %s, eye %d %d %d, ahead %d %d %d\n", hidden_scene_names[kind],
                       camera.eye.x, camera.eye.y, camera.eye.z, camera.ahead.x, camera.ahead.y,
                       camera.ahead.z);
            }
        }
        free(workspace);
        free(planes);
        hidden_scene_close(&scene);
    }
    printf("# %s: %llu rays, %llu of them hidden\n", hidden_scene_names[kind],
           (unsigned long long)rays, (unsigned long long)hidden_rays);
    CHECK(hidden_rays > 100U && rays - hidden_rays > 100U);
}

static void lattices(void) {
    check_kind(HIDDEN_LATTICE);
}

static void blocks_that_touch(void) {
    check_kind(HIDDEN_BLOCKS);
}

static void planes_and_wires(void) {
    check_kind(HIDDEN_MIXED);
}

static void crystals(void) {
    check_kind(HIDDEN_CRYSTALS);
}

static void solids_that_overlap(void) {
    check_kind(HIDDEN_OVERLAPPED);
}

int main(void) {
    const char *const count_text = getenv("COUNT"), *const seed_text = getenv("SEED");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) : 1975U;
    if (count_text != NULL) {
        view_count = strtoul(count_text, NULL, 10);
    }
    printf("# seed %llu\n", (unsigned long long)seed);
    TEST(lattices);
    TEST(blocks_that_touch);
    TEST(planes_and_wires);
    TEST(crystals);
    TEST(solids_that_overlap);
    return check_finish();
}
