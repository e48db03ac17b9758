#include "aim_picture.h"

#include "decimal.h"
#include "measure.h"

#include <float.h>
#include <math.h>
#include <string.h>

const char *const picture_frames[] = {[FRAME_CONE] = "cone", [FRAME_RECT] = "rect", NULL};
const char *const picture_bounds[] = {[BOUNDS_POINTS] = "points", [BOUNDS_BOX] = "box", NULL};

static const double rad_per_deg = 0.017453292519943295769;

// ---------------------------------------------------------------- options

/// W:H, each above 0.
static bool read_aspect(const char *command, const char *text, struct picture_options *options) {
    char width[32];
    const char *const colon = strchr(text, ':');
    const size_t length = colon == NULL ? 0 : (size_t)(colon - text);
    if (length == 0 || length >= sizeof width || colon[1] == '\0') {
        message_command(command, "--aspect %s: must be W:H, for instance 16:9",
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    memcpy(width, text, length);
    width[length] = '\0';
    if (!option_positive(command, "--aspect", width, &options->width) ||
        !option_positive(command, "--aspect", colon + 1, &options->height)) {
        return false;
    }
    if (options->width > 1000 * options->height || options->height > 1000 * options->width) {
        message_command(command, "--aspect %s: one side is more than 1000 times the other",
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    return true;
}

static bool read_margin(const char *command, const char *text, double *part) {
    struct decimal value;
    int64_t millionths = 0;
    if (decimal_read(text, strlen(text), &value) != DECIMAL_OK ||
        !decimal_scale(&value, 1000000, 1, &millionths) || millionths < 0 ||
        millionths > 1000 * INT64_C(1000000)) {
        message_command(command, "--margin %s: must be a percentage from 0 to 1000",
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    *part = (double)millionths * 1e-8;
    return true;
}

/// What does not go together, in words; NULL: all does.
static const char *misfit(const struct picture_options *options, enum points_input input,
                          bool up_given, bool method_given) {
    const bool rect = options->frame == FRAME_RECT, box = options->bounds == BOUNDS_BOX;
    if (rect && options->aspect == NULL) {
        return "--frame rect needs --aspect W:H";
    }
    if (!rect && (options->aspect != NULL || options->margin != NULL)) {
        return "--aspect and --margin go with --frame rect only";
    }
    if (rect && (up_given || method_given || box)) {
        return "--up, --method and --bounds do not go with --frame rect";
    }
    if (box && input != POINTS_XYZ) {
        return "--bounds box goes with --input xyz only: directions have no box";
    }
    if (!options->project && (options->plot_radius != NULL || options->segments != NULL)) {
        return "--plot-radius and --segments go with --project only";
    }
    return NULL;
}

enum exit_status picture_options_read(const char *command, const struct points_format *format,
                                      bool up_given, bool method_given,
                                      struct picture_options *options) {
    const char *const why = misfit(options, format->input, up_given, method_given);
    if (why != NULL) {
        message_command(command, "%s", why);
        return EXIT_STATUS_USAGE;
    }
    if ((options->aspect != NULL && !read_aspect(command, options->aspect, options)) ||
        (options->margin != NULL &&
         !read_margin(command, options->margin, &options->margin_part)) ||
        (options->plot_radius != NULL &&
         !option_positive(command, "--plot-radius", options->plot_radius, &options->radius))) {
        return EXIT_STATUS_USAGE;
    }
    if (options->segments == NULL) {
        return EXIT_STATUS_OK;
    }
    struct points_format ends = *format;
    ends.named = false;
    ends.segments = true;
    ends.bounds = NULL;
    return points_read(options->segments, &ends, &options->ends);
}

void picture_options_free(struct picture_options *options) {
    points_free(&options->ends);
}

// ---------------------------------------------------------------- image

/// A direction in the observer's coordinates of the 1982 paper, times any positive number.
struct observed {
    long double right, ahead, up;
};

struct observer {
    struct observed x, y, z; // what +x, +y and +z of the world are
};

/// Right is ahead x up made unit, and up is right x ahead: from ahead_q30 as printed, so that they
/// are orthonormal in every digit.
static struct observer make_observer(struct vec3 ahead_q30, struct vec3 up_q30) {
    const long double ax = ahead_q30.x, ay = ahead_q30.y, az = ahead_q30.z,
                      a = sqrtl(ax * ax + ay * ay + az * az);
    const long double ux = up_q30.x, uy = up_q30.y, uz = up_q30.z;
    long double rx = ay * uz - az * uy, ry = az * ux - ax * uz, rz = ax * uy - ay * ux;
    const long double r = sqrtl(rx * rx + ry * ry + rz * rz);
    rx /= r;
    ry /= r;
    rz /= r;
    return (struct observer){{rx, ax / a, (ry * az - rz * ay) / a},
                             {ry, ay / a, (rz * ax - rx * az) / a},
                             {rz, az / a, (rx * ay - ry * ax) / a}};
}

static struct observed observe(const struct observer *o, struct vec3_i64 direction) {
    const long double x = (long double)direction.x, y = (long double)direction.y,
                      z = (long double)direction.z;
    return (struct observed){o->x.right * x + o->y.right * y + o->z.right * z,
                             o->x.ahead * x + o->y.ahead * y + o->z.ahead * z,
                             o->x.up * x + o->y.up * y + o->z.up * z};
}

/// As the image of a point or a segment is printed: with 12 digits, and no minus before a zero.
static const char *number(char text[32], long double value) {
    snprintf(text, 32, "%.12g", (double)(fabsl(value) < LDBL_MIN ? 0 : value));
    return text;
}

static void json_pair(struct json *json, long double x, long double y) {
    char text[32];
    json_begin_array(json);
    json_number(json, number(text, x));
    json_number(json, number(text, y));
    json_end_array(json);
}

static void text_pair(FILE *stream, long double x, long double y) {
    char one[32], other[32];
    fprintf(stream, "%s %s", number(one, x), number(other, y));
}

static void print_point(struct facts *facts, uint32_t index, struct observed seen, double scale) {
    const long double length =
        sqrtl(seen.right * seen.right + seen.ahead * seen.ahead + seen.up * seen.up);
    const long double x = seen.right / seen.ahead * scale, y = seen.up / seen.ahead * scale,
                      distortion = length / seen.ahead;
    char text[32];
    if (!facts->as_json) {
        fprintf(facts->stream, "  %-4lu ", (unsigned long)index);
        if (seen.ahead > 0) {
            text_pair(facts->stream, x, y);
            fprintf(facts->stream, "  distortion %s\n", number(text, distortion));
        } else {
            fputs("none: not in front\n", facts->stream);
        }
    } else if (seen.ahead > 0) {
        json_begin_object(&facts->json);
        json_key(&facts->json, "x");
        json_number(&facts->json, number(text, x));
        json_key(&facts->json, "y");
        json_number(&facts->json, number(text, y));
        json_key(&facts->json, "distortion");
        json_number(&facts->json, number(text, distortion));
        json_end_object(&facts->json);
    } else {
        json_null(&facts->json);
    }
}

/// What is seen of a segment: from one place to another, or along a ray.
struct image {
    enum { IMAGE_NONE, IMAGE_SEGMENT, IMAGE_RAY } kind;
    long double x, y, to_x, to_y;
};

/// The part of a segment that is in front: of one with an end behind, the ray from the image of the
/// other along (a1 r2 - a2 r1, a1 u2 - a2 u1), which is right also where that end has no image.
/// parallel: the ends are in one line with the eye.
static struct image image_of(struct observed a, struct observed b, bool parallel, double scale) {
    struct image image = {.kind = IMAGE_NONE};
    if (a.ahead <= 0 && b.ahead <= 0) {
        return image;
    }
    if (a.ahead <= 0) {
        const struct observed swap = a;
        a = b;
        b = swap;
    }
    image.x = a.right / a.ahead * scale;
    image.y = a.up / a.ahead * scale;
    image.kind = IMAGE_SEGMENT;
    if (parallel) {
        image.to_x = image.x;
        image.to_y = image.y;
    } else if (b.ahead > 0) {
        image.to_x = b.right / b.ahead * scale;
        image.to_y = b.up / b.ahead * scale;
    } else {
        const long double dx = a.ahead * b.right - b.ahead * a.right,
                          dy = a.ahead * b.up - b.ahead * a.up, size = hypotl(dx, dy);
        image.kind = IMAGE_RAY;
        image.to_x = dx / size;
        image.to_y = dy / size;
    }
    return image;
}

static void print_segment(struct facts *facts, uint32_t index, struct image image) {
    struct json *const json = &facts->json;
    if (!facts->as_json) {
        fprintf(facts->stream, "  %-4lu ", (unsigned long)index);
        if (image.kind == IMAGE_NONE) {
            fputs("none: not in front\n", facts->stream);
            return;
        }
        text_pair(facts->stream, image.x, image.y);
        fputs(image.kind == IMAGE_RAY ? "  direction " : "  to ", facts->stream);
        text_pair(facts->stream, image.to_x, image.to_y);
        fputc('\n', facts->stream);
    } else if (image.kind == IMAGE_NONE) {
        json_null(json);
    } else if (image.kind == IMAGE_SEGMENT) {
        json_begin_array(json);
        json_pair(json, image.x, image.y);
        json_pair(json, image.to_x, image.to_y);
        json_end_array(json);
    } else {
        json_begin_object(json);
        json_key(json, "from");
        json_pair(json, image.x, image.y);
        json_key(json, "direction");
        json_pair(json, image.to_x, image.to_y);
        json_end_object(json);
    }
}

static bool are_parallel(struct vec3_i64 a, struct vec3_i64 b) {
    const struct vec3_i128 cross = vec3_i64_cross(a, b);
    return i128_sign(cross.x) == 0 && i128_sign(cross.y) == 0 && i128_sign(cross.z) == 0;
}

static void begin_list(struct facts *facts, const char *name) {
    if (facts->as_json) {
        json_key(&facts->json, name);
        json_begin_array(&facts->json);
    } else {
        fprintf(facts->stream, "%s\n", name);
    }
}

static void end_list(struct facts *facts) {
    if (facts->as_json) {
        json_end_array(&facts->json);
    }
}

/// The scale that gives the image the radius that was asked for is also the distance from which it
/// should be looked at. Returns it.
static double print_scale(struct facts *facts, const struct picture_options *options,
                          uint64_t half_angle_pdeg) {
    double scale = 1;
    if (options->radius > 0) {
        const bool has_radius = half_angle_pdeg != 0U && half_angle_pdeg < 90U * MEASURE_DEGREE;
        if (!has_radius) {
            const char *const why =
                half_angle_pdeg == 0U ? "the image is one point" : "the image has no end";
            facts_null(facts, "scale", why);
            facts_null(facts, "viewing_distance", why);
            return scale;
        }
        scale = options->radius / measure_tangent(half_angle_pdeg);
    }
    facts_significant(facts, "scale", scale, 12);
    facts_significant(facts, "viewing_distance", scale, 12);
    return scale;
}

void picture_print_image(struct facts *facts, const struct picture_options *options,
                         struct vec3 ahead_q30, struct vec3 up_q30, uint64_t half_angle_pdeg,
                         const struct points *points) {
    if (!options->project) {
        return;
    }
    const double scale = print_scale(facts, options, half_angle_pdeg);
    const struct observer observer = make_observer(ahead_q30, up_q30);
    begin_list(facts, "image");
    for (uint32_t i = 0; i < points->count; i++) {
        print_point(facts, i, observe(&observer, points->fine[i]), scale);
    }
    end_list(facts);
    if (options->segments == NULL) {
        return;
    }
    begin_list(facts, "segments");
    for (uint32_t i = 0; i + 1U < options->ends.count; i += 2U) {
        const struct vec3_i64 a = options->ends.fine[i], b = options->ends.fine[i + 1U];
        print_segment(
            facts, i / 2U,
            image_of(observe(&observer, a), observe(&observer, b), are_parallel(a, b), scale));
    }
    end_list(facts);
}

// ---------------------------------------------------------------- rectangle

static double field_deg(double half_tangent) {
    return 2 * atan(half_tangent) / rad_per_deg * (1 + 4 * DBL_EPSILON);
}

void picture_print_field(struct facts *facts, const struct picture_options *options, double slope) {
    const double wider = slope * (1 + options->margin_part);
    facts_significant(facts, "hfov_deg", field_deg(wider * options->width), 15);
    facts_significant(facts, "vfov_deg", field_deg(wider * options->height), 15);
}

static q30_t round_q30(double value) {
    return (q30_t)lround(value * Q30_ONE);
}

struct picture_axes picture_axes(double pan_rad, double tilt_rad) {
    const double cp = cos(pan_rad), sp = sin(pan_rad), ct = cos(tilt_rad), st = sin(tilt_rad);
    return (struct picture_axes){
        .ahead_q30 = vec3(round_q30(sp * ct), round_q30(cp * ct), round_q30(st)),
        .right_q30 = vec3(round_q30(cp), round_q30(-sp), 0),
        .up_q30 = vec3(round_q30(-sp * st), round_q30(-cp * st), round_q30(ct))};
}
