#include "view/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Rays a pixel, in each direction.
#define SAMPLES 8

/// Objects are looked for in tiles of so many pixels.
#define TILE_PX 8U

// ---------------------------------------------------------------- the lens

bool render_create(struct render *render, uint32_t width_px, uint32_t height_px,
                   bool (*ray)(void *context, const double pixel[2], double direction[3]),
                   void *context, uint64_t seed) {
    const size_t pixels = (size_t)width_px * height_px;
    const size_t corners = ((size_t)width_px + 1U) * (height_px + 1U);
    *render = (struct render){.width_px = width_px,
                              .height_px = height_px,
                              .corner = calloc(corners, sizeof *render->corner),
                              .light = calloc(pixels, sizeof *render->light),
                              .scratch = calloc(pixels, sizeof *render->scratch),
                              .backdrop = calloc(pixels, sizeof *render->backdrop),
                              .random = seed * 2U + 1U};
    if (render->corner == NULL || render->light == NULL || render->scratch == NULL ||
        render->backdrop == NULL) {
        return false;
    }
    for (uint32_t v = 0; v <= height_px; v++) {
        for (uint32_t u = 0; u <= width_px; u++) {
            const double pixel[2] = {u - 0.5, v - 0.5};
            double direction[3];
            if (!ray(context, pixel, direction) || !(direction[1] > 0.0)) {
                return false;
            }
            float *corner = render->corner[(size_t)v * (width_px + 1U) + u];
            corner[0] = (float)(direction[0] / direction[1]);
            corner[1] = 1.0F;
            corner[2] = (float)(direction[2] / direction[1]);
        }
    }
    return true;
}

void render_destroy(struct render *render) {
    free(render->corner);
    free(render->light);
    free(render->scratch);
    free(render->backdrop);
    memset(render, 0, sizeof *render);
}

/// The ray at a place within a pixel, each part from 0 to 1.
static void ray_in(const struct render *render, uint32_t u, uint32_t v, float right, float down,
                   float ray[3]) {
    const size_t line = render->width_px + 1U, first = v * line + u;
    const float *a = render->corner[first], *b = render->corner[first + 1U];
    const float *c = render->corner[first + line], *d = render->corner[first + line + 1U];
    for (unsigned i = 0; i < 3U; i++) {
        const float upper = a[i] + (b[i] - a[i]) * right;
        const float lower = c[i] + (d[i] - c[i]) * right;
        ray[i] = upper + (lower - upper) * down;
    }
}

// ---------------------------------------------------------------- the backdrop

static uint32_t scramble(uint32_t x, uint32_t y, uint32_t z, uint32_t seed) {
    uint32_t h = seed ^ (x * 0x9E3779B1U) ^ (y * 0x85EBCA77U) ^ (z * 0xC2B2AE3DU);
    h ^= h >> 15;
    h *= 0x2C1B3C6DU;
    h ^= h >> 12;
    h *= 0x297A2D39U;
    return h ^ (h >> 15);
}

static float mix(float a, float b, float part) {
    return a + (b - a) * part;
}

/// Smooth noise in space, -1 to 1: random numbers at whole places, blended between them.
static float noise_at(const float at[3], uint32_t seed) {
    uint32_t cell[3];
    float part[3];
    for (unsigned i = 0; i < 3U; i++) {
        const float whole = floorf(at[i]);
        const float t = at[i] - whole;
        cell[i] = (uint32_t)(int32_t)whole;
        part[i] = t * t * (3.0F - 2.0F * t);
    }
    float edge[4];
    for (unsigned k = 0; k < 4U; k++) {
        const uint32_t y = cell[1] + (k & 1U), z = cell[2] + (k >> 1);
        const float a = (float)(scramble(cell[0], y, z, seed) >> 8);
        const float b = (float)(scramble(cell[0] + 1U, y, z, seed) >> 8);
        edge[k] = mix(a, b, part[0]);
    }
    const float low = mix(edge[0], edge[1], part[1]), high = mix(edge[2], edge[3], part[1]);
    return mix(low, high, part[2]) * (2.0F / 16777216.0F) - 1.0F;
}

static void to_world(const struct render_view *view, const float camera[3], float world[3]) {
    for (unsigned i = 0; i < 3U; i++) {
        world[i] = (float)(view->right[i] * (double)camera[0] + view->ahead[i] * (double)camera[1] +
                           view->up[i] * (double)camera[2]);
    }
}

static bool same_turn(const struct render_view *a, const struct render_view *b) {
    return memcmp(a->right, b->right, sizeof a->right) == 0 &&
           memcmp(a->ahead, b->ahead, sizeof a->ahead) == 0 &&
           memcmp(a->up, b->up, sizeof a->up) == 0;
}

/// The backdrop's brightness where the corner (u, v) of pixels looks.
static float backdrop_at(const struct render *render, const struct render_view *view,
                         const struct render_backdrop *backdrop, uint32_t u, uint32_t v) {
    const float *ray = render->corner[(size_t)v * (render->width_px + 1U) + u];
    float world[3], at[3], sum = 0.0F, share = 0.5F;
    to_world(view, ray, world);
    const float length = sqrtf(world[0] * world[0] + world[1] * world[1] + world[2] * world[2]);
    float scale = (float)(180.0 / 3.14159265358979323846 / backdrop->grain_deg) / length;
    for (uint32_t octave = 0; octave < 3U; octave++) {
        for (unsigned i = 0; i < 3U; i++) {
            at[i] = world[i] * scale + 100.0F;
        }
        sum += share * noise_at(at, backdrop->seed + octave);
        scale *= 2.7F;
        share *= 0.6F;
    }
    return (float)(backdrop->luma + backdrop->contrast * (double)sum);
}

/// Its finest patches are many pixels wide: worked out at every second corner, and between them by
/// lines.
static void draw_backdrop(struct render *render, const struct render_view *view,
                          const struct render_backdrop *backdrop) {
    if (render->has_backdrop && same_turn(view, &render->backdrop_view) &&
        memcmp(backdrop, &render->backdrop_of, sizeof *backdrop) == 0) {
        return;
    }
    const uint32_t width = render->width_px, columns = width / 2U + 1U;
    float *upper = render->scratch, *lower = render->scratch + columns;
    for (uint32_t u = 0; u < columns; u++) {
        lower[u] = backdrop_at(render, view, backdrop, 2U * u, 0);
    }
    for (uint32_t v = 0; v < render->height_px; v++) {
        if (v % 2U == 0U) {
            float *swap = upper;
            upper = lower;
            lower = swap;
            const uint32_t below = v + 2U <= render->height_px ? v + 2U : render->height_px;
            for (uint32_t u = 0; u < columns; u++) {
                lower[u] = backdrop_at(render, view, backdrop, 2U * u, below);
            }
        }
        const float down = v % 2U == 0U ? 0.25F : 0.75F;
        float *row = render->backdrop + (size_t)v * width;
        for (uint32_t u = 0; u < width; u++) {
            const uint32_t left = u / 2U, right = left + 1U < columns ? left + 1U : left;
            const float across = u % 2U == 0U ? 0.25F : 0.75F;
            row[u] = mix(mix(upper[left], upper[right], across),
                         mix(lower[left], lower[right], across), down);
        }
    }
    render->has_backdrop = true;
    render->backdrop_view = *view;
    render->backdrop_of = *backdrop;
}

// ---------------------------------------------------------------- objects

/// An object as the camera has it: in its axes, metres from it.
struct seen {
    const struct render_object *object;
    double distance_m;
    float centre[3], right[3], up[3], normal[3];
    float depth;                 ///< plate: centre . normal
    float right_norm2, up_norm2; ///< plate
    float radius2, distance2;    ///< ball
    float unit[3], reach;        ///< the cone that holds it, its half-angle in radians
};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float dotf(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void to_camera(const struct render_view *view, const double world[3], float camera[3]) {
    camera[0] = (float)dot(view->right, world);
    camera[1] = (float)dot(view->ahead, world);
    camera[2] = (float)dot(view->up, world);
}

static struct seen see(const struct render_view *view, const struct render_object *object) {
    struct seen seen = {.object = object};
    double away[3];
    for (unsigned i = 0; i < 3U; i++) {
        away[i] = object->centre_m[i] - view->at_m[i];
    }
    seen.distance_m = sqrt(dot(away, away));
    to_camera(view, away, seen.centre);
    to_camera(view, object->right_m, seen.right);
    to_camera(view, object->up_m, seen.up);
    double radius_m = object->radius_m;
    if (object->shape == RENDER_PLATE) {
        const float *r = seen.right, *u = seen.up;
        seen.normal[0] = r[1] * u[2] - r[2] * u[1];
        seen.normal[1] = r[2] * u[0] - r[0] * u[2];
        seen.normal[2] = r[0] * u[1] - r[1] * u[0];
        seen.depth = dotf(seen.centre, seen.normal);
        seen.right_norm2 = dotf(r, r);
        seen.up_norm2 = dotf(u, u);
        radius_m = sqrt((double)seen.right_norm2) + sqrt((double)seen.up_norm2);
    }
    seen.radius2 = (float)(radius_m * radius_m);
    seen.distance2 = (float)(seen.distance_m * seen.distance_m);
    for (unsigned i = 0; i < 3U; i++) {
        seen.unit[i] = seen.centre[i] / (float)seen.distance_m;
    }
    seen.reach = (float)asin(fmin(1.0, radius_m / seen.distance_m));
    return seen;
}

/// Where a ray is relative to a plate: beyond which of its edges, else which of its cells.
struct meeting {
    unsigned beyond; ///< bits: left, right, below, above, behind the camera
    uint32_t cell;
};

static struct meeting meet_plate(const struct seen *seen, const float ray[3]) {
    const struct render_object *object = seen->object;
    const float reach = seen->depth / dotf(ray, seen->normal);
    if (!(reach > 0.0F)) { // also when the ray is in the plane
        return (struct meeting){.beyond = 16U};
    }
    float across = 0.0F, up = 0.0F;
    for (unsigned i = 0; i < 3U; i++) {
        const float off = ray[i] * reach - seen->centre[i];
        across += off * seen->right[i];
        up += off * seen->up[i];
    }
    across /= seen->right_norm2;
    up /= seen->up_norm2;
    const unsigned beyond = (across <= -1.0F ? 1U : 0U) | (across >= 1.0F ? 2U : 0U) |
                            (up <= -1.0F ? 4U : 0U) | (up >= 1.0F ? 8U : 0U);
    if (beyond != 0U || object->texture == NULL) {
        return (struct meeting){.beyond = beyond};
    }
    uint32_t column = (uint32_t)((across + 1.0F) * 0.5F * (float)object->columns);
    uint32_t row = (uint32_t)((1.0F - up) * 0.5F * (float)object->rows);
    column = column < object->columns ? column : object->columns - 1U;
    row = row < object->rows ? row : object->rows - 1U;
    return (struct meeting){.cell = row * object->columns + column};
}

static bool meets_ball(const struct seen *seen, const float ray[3]) {
    const float along = dotf(ray, seen->centre);
    return along > 0.0F && seen->distance2 - along * along / dotf(ray, ray) <= seen->radius2;
}

/// What a ray meets: -1: nothing, else its brightness.
static float hit(const struct seen *seen, const float ray[3]) {
    const struct render_object *object = seen->object;
    if (object->shape == RENDER_BALL) {
        return meets_ball(seen, ray) ? (float)object->luma : -1.0F;
    }
    const struct meeting meeting = meet_plate(seen, ray);
    if (meeting.beyond != 0U) {
        return -1.0F;
    }
    const uint8_t luma = object->texture == NULL ? object->luma : object->texture[meeting.cell];
    return luma == 0U && object->texture != NULL ? -1.0F : (float)luma;
}

enum cover { COVERED_IN_PART, COVERED_WHOLLY, NOT_COVERED };

/// Pixels, cells and discs are convex: where all four corners of a pixel are in one cell, or in the
/// disc, all of it is; and where all are beyond the same edge, nothing is.
static enum cover cover_of(const struct render *render, const struct seen *seen, uint32_t u,
                           uint32_t v) {
    const size_t line = render->width_px + 1U, first = v * line + u;
    const size_t corner[4] = {first, first + 1U, first + line, first + line + 1U};
    if (seen->object->shape == RENDER_BALL) {
        unsigned within = 0;
        for (unsigned i = 0; i < 4U; i++) {
            within += meets_ball(seen, render->corner[corner[i]]);
        }
        return within == 4U ? COVERED_WHOLLY : COVERED_IN_PART;
    }
    unsigned any = 0, all = ~0U;
    bool same = true;
    uint32_t cell = 0;
    for (unsigned i = 0; i < 4U; i++) {
        const struct meeting meeting = meet_plate(seen, render->corner[corner[i]]);
        any |= meeting.beyond;
        all &= meeting.beyond;
        cell = i == 0U ? meeting.cell : cell;
        same = same && meeting.cell == cell;
    }
    // Beyond the camera's own plane edges change sides: no short cut there.
    return (any & 16U) != 0U   ? COVERED_IN_PART
           : all != 0U         ? NOT_COVERED
           : any == 0U && same ? COVERED_WHOLLY
                               : COVERED_IN_PART;
}

static void draw_pixel(struct render *render, const struct seen *seen, uint32_t u, uint32_t v) {
    const enum cover cover = cover_of(render, seen, u, v);
    if (cover == NOT_COVERED) {
        return;
    }
    const unsigned side = cover == COVERED_WHOLLY ? 1U : SAMPLES;
    float sum = 0.0F;
    unsigned hits = 0;
    for (unsigned i = 0; i < side * side; i++) {
        float ray[3];
        ray_in(render, u, v, ((float)(i % side) + 0.5F) / (float)side,
               ((float)(i / side) + 0.5F) / (float)side, ray);
        const float luma = hit(seen, ray);
        hits += luma >= 0.0F;
        sum += luma >= 0.0F ? luma : 0.0F;
    }
    const float samples = (float)(side * side);
    float *light = &render->light[(size_t)v * render->width_px + u];
    *light = *light * (1.0F - (float)hits / samples) + sum / samples;
}

/// Can any of the tile's pixels show the object? The tile's own half diagonal counts.
static bool tile_near(const struct render *render, const struct seen *seen, uint32_t u, uint32_t v,
                      uint32_t right, uint32_t bottom) {
    float middle[3], corner[3];
    ray_in(render, (u + right) / 2U, (v + bottom) / 2U, 0.0F, 0.0F, middle);
    float own = 0.0F;
    for (unsigned k = 0; k < 4U; k++) {
        ray_in(render, k & 1U ? right - 1U : u, k & 2U ? bottom - 1U : v, (float)(k & 1U),
               (float)(k >> 1), corner);
        const float x = corner[0] - middle[0], y = corner[2] - middle[2];
        own = fmaxf(own, x * x + y * y);
    }
    // A distance in the plane ahead = 1 is at least the angle.
    const float reach = seen->reach + sqrtf(own);
    const float along = dotf(middle, seen->unit) / sqrtf(dotf(middle, middle));
    // cos x >= 1 - x^2 / 2, so this never leaves out too much.
    return along >= 1.0F - 0.5F * reach * reach - 1e-6F;
}

static void draw_object(struct render *render, const struct seen *seen) {
    for (uint32_t v = 0; v < render->height_px; v += TILE_PX) {
        const uint32_t bottom = v + TILE_PX < render->height_px ? v + TILE_PX : render->height_px;
        for (uint32_t u = 0; u < render->width_px; u += TILE_PX) {
            const uint32_t right = u + TILE_PX < render->width_px ? u + TILE_PX : render->width_px;
            if (!tile_near(render, seen, u, v, right, bottom)) {
                continue;
            }
            for (uint32_t y = v; y < bottom; y++) {
                for (uint32_t x = u; x < right; x++) {
                    draw_pixel(render, seen, x, y);
                }
            }
        }
    }
}

static int compare_seen(const void *a, const void *b) {
    const struct seen *x = a, *y = b;
    return (x->distance_m < y->distance_m) - (x->distance_m > y->distance_m);
}

// ---------------------------------------------------------------- the sensor

enum { BLUR_REACH_MAX = 16 };

/// Adds weight * from, shifted by `shift` pixels to the right within the row; the ends repeat.
static void add_shifted(float *to, const float *from, int count, int shift, float weight) {
    const int begin = shift < 0 ? -shift : 0, end = shift > 0 ? count - shift : count;
    for (int i = 0; i < begin; i++) {
        to[i] += weight * from[0];
    }
    for (int i = begin; i < end; i++) {
        to[i] += weight * from[i + shift];
    }
    for (int i = end; i < count; i++) {
        to[i] += weight * from[count - 1];
    }
}

static void blur(struct render *render, double deviation_px) {
    float weight[BLUR_REACH_MAX + 1], sum = 0.0F;
    int reach = (int)ceil(3.5 * deviation_px);
    reach = reach > BLUR_REACH_MAX ? BLUR_REACH_MAX : reach;
    for (int i = 0; i <= reach; i++) {
        weight[i] = (float)exp(-0.5 * i * i / (deviation_px * deviation_px));
        sum += (i == 0 ? 1.0F : 2.0F) * weight[i];
    }
    for (int i = 0; i <= reach; i++) {
        weight[i] /= sum;
    }
    const int width = (int)render->width_px, height = (int)render->height_px;
    memset(render->scratch, 0, (size_t)width * (size_t)height * sizeof *render->scratch);
    for (int v = 0; v < height; v++) {
        const size_t row = (size_t)v * (size_t)width;
        for (int k = -reach; k <= reach; k++) {
            add_shifted(render->scratch + row, render->light + row, width, k, weight[abs(k)]);
        }
    }
    memset(render->light, 0, (size_t)width * (size_t)height * sizeof *render->light);
    for (int v = 0; v < height; v++) {
        for (int k = -reach; k <= reach; k++) {
            const int from = v + k < 0 ? 0 : v + k >= height ? height - 1 : v + k;
            add_shifted(render->light + (size_t)v * (size_t)width,
                        render->scratch + (size_t)from * (size_t)width, width, 0, weight[abs(k)]);
        }
    }
}

/// Nearly Gaussian with deviation 1: four bytes added up.
static float noise(uint64_t *random) {
    uint64_t x = *random;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *random = x;
    const uint64_t bits = (x * UINT64_C(0x2545F4914F6CDD1D)) >> 32;
    const int sum =
        (int)((bits & 255U) + (bits >> 8 & 255U) + (bits >> 16 & 255U) + (bits >> 24 & 255U));
    return ((float)sum - 510.0F) * (1.0F / 147.8F);
}

static void expose(struct render *render, const struct render_sensor *sensor, uint8_t *picture,
                   uint32_t stride_bytes) {
    const float gain = (float)sensor->gain, grain = (float)sensor->noise_luma;
    for (uint32_t v = 0; v < render->height_px; v++) {
        const float *light = render->light + (size_t)v * render->width_px;
        uint8_t *row = picture + (size_t)v * stride_bytes;
        for (uint32_t u = 0; u < render->width_px; u++) {
            float luma = light[u] * gain + 0.5F;
            luma += grain > 0.0F ? grain * noise(&render->random) : 0.0F;
            row[u] = luma < 0.0F ? 0U : luma > 255.0F ? 255U : (uint8_t)luma;
        }
    }
}

void render_frame(struct render *render, const struct render_view *view,
                  const struct render_backdrop *backdrop, const struct render_object *objects,
                  uint32_t object_count, const struct render_sensor *sensor, uint8_t *picture,
                  uint32_t stride_bytes) {
    draw_backdrop(render, view, backdrop);
    memcpy(render->light, render->backdrop,
           (size_t)render->width_px * render->height_px * sizeof *render->light);
    struct seen *seen = calloc(object_count + 1U, sizeof *seen);
    if (seen == NULL) {
        abort(); // a frame without its objects would be a wrong truth
    }
    for (uint32_t i = 0; i < object_count; i++) {
        seen[i] = see(view, &objects[i]);
    }
    qsort(seen, object_count, sizeof *seen, compare_seen);
    for (uint32_t i = 0; i < object_count; i++) {
        draw_object(render, &seen[i]);
    }
    free(seen);
    if (sensor->blur_px > 0.0) {
        blur(render, sensor->blur_px);
    }
    expose(render, sensor, picture, stride_bytes);
}
