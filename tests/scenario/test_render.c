/// The renderer against geometry of its own: where balls and plates have to appear through a lens
/// that only this file knows.
#include "check.h"

#include "view/render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 240 };
#define FOCAL 280.0
#define CX    159.5
#define CY    119.5

static uint8_t picture[HEIGHT][WIDTH];
static const struct render_view level = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
static const struct render_backdrop even = {1, 40.0, 0.0, 10.0};
static const struct render_sensor clean = {0.0, 0.0, 1.0};

static bool pinhole(void *context, const double pixel[2], double direction[3]) {
    (void)context;
    direction[0] = (pixel[0] - CX) / FOCAL;
    direction[1] = 1.0;
    direction[2] = -(pixel[1] - CY) / FOCAL;
    return true;
}

static struct render render;

static void draw(const struct render_view *view, const struct render_object *objects,
                 uint32_t count, const struct render_sensor *sensor) {
    render_frame(&render, view, &even, objects, count, sensor, &picture[0][0], WIDTH);
}

/// Sum and centroid of what is brighter than the backdrop.
static double centroid(double at[2]) {
    double sum = 0.0;
    at[0] = at[1] = 0.0;
    for (int v = 0; v < HEIGHT; v++) {
        for (int u = 0; u < WIDTH; u++) {
            const double extra = picture[v][u] - 40.0;
            sum += extra;
            at[0] += extra * u;
            at[1] += extra * v;
        }
    }
    at[0] /= sum;
    at[1] /= sum;
    return sum;
}

/// A ball's image is an ellipse whose ends are the tangent rays: axis along the direction from the
/// picture's middle from tan(theta - alpha) to tan(theta + alpha), sin(alpha) = radius / distance.
static void balls_where_they_belong(void) {
    uint64_t seed = UINT64_C(0xBA11);
    double worst = 0.0, worst_area = 0.0;
    for (int i = 0; i < 40; i++) {
        double p[4];
        for (unsigned k = 0; k < 4U; k++) {
            p[k] = (double)(check_random(&seed) >> 11) * 0x1p-53;
        }
        const double east = 4.0 * p[0] - 2.0, north = 5.0 + p[1], up = 3.0 * p[2] - 1.5;
        const double radius = 0.1 + 0.2 * p[3];
        const struct render_object ball = {
            .shape = RENDER_BALL, .centre_m = {east, north, up}, .radius_m = radius, .luma = 240};
        draw(&level, &ball, 1, &clean);
        const double distance = sqrt(east * east + north * north + up * up);
        const double off = hypot(east, up), theta = atan2(off, north);
        const double alpha = asin(radius / distance);
        const double inner = tan(theta - alpha), outer = tan(theta + alpha);
        const double middle = 0.5 * (inner + outer) * FOCAL;
        const double wanted[2] = {CX + middle * east / off, CY - middle * up / off};
        const double half = 0.5 * (outer - inner);
        // The other half axis of the conic section.
        const double other = sqrt(half * half * (1.0 - pow(sin(theta) / cos(alpha), 2.0)));
        double at[2];
        const double sum = centroid(at);
        worst = fmax(worst, hypot(at[0] - wanted[0], at[1] - wanted[1]));
        const double area = 3.14159265358979 * half * other * FOCAL * FOCAL;
        worst_area = fmax(worst_area, fabs(sum / 200.0 / area - 1.0));
    }
    CHECK(worst < 0.02);
    CHECK(worst_area < 0.01);
    check_note("centroid of a ball, worst, in 1/1000 px", (int64_t)(worst * 1e3));
    check_note("area of a ball, worst, in 1/1000", (int64_t)(worst_area * 1e3));
}

/// A square ahead from u = 100.25 to 140.75 and v = 60.5 to 80.125: its edges cover known parts of
/// their pixels.
static void plates_cover_parts_of_pixels(void) {
    const double left = 100.25 - CX, right = 140.75 - CX, top = CY - 60.5, bottom = CY - 80.125;
    const double depth = 2.0, per_px = depth / FOCAL;
    const struct render_object plate = {
        .shape = RENDER_PLATE,
        .centre_m = {0.5 * (left + right) * per_px, depth, 0.5 * (top + bottom) * per_px},
        .right_m = {0.5 * (right - left) * per_px, 0, 0},
        .up_m = {0, 0, 0.5 * (top - bottom) * per_px},
        .luma = 240};
    draw(&level, &plate, 1, &clean);
    CHECK_EQ(picture[70][99], 40);
    CHECK_NEAR(picture[70][100], 40 + 200 * 0.25, 1);
    CHECK_EQ(picture[70][101], 240);
    CHECK_EQ(picture[70][140], 240);
    CHECK_NEAR(picture[70][141], 40 + 200 * 0.25, 1);
    CHECK_EQ(picture[70][142], 40);
    CHECK_EQ(picture[60][120], 40);
    CHECK_EQ(picture[61][120], 240);
    CHECK_NEAR(picture[80][120], 40 + 200 * 0.625, 1);
}

/// Texture rows run from the upper left, 0 is a hole, the nearer object hides the farther one, and
/// a camera that turns right moves the picture left.
static void textures_holes_and_order(void) {
    const uint8_t texture[4] = {200, 0, 100, 150};
    const struct render_object objects[] = {{.shape = RENDER_PLATE,
                                             .centre_m = {0, 4, 0},
                                             .right_m = {0.5, 0, 0},
                                             .up_m = {0, 0, 0.5},
                                             .texture = texture,
                                             .columns = 2,
                                             .rows = 2},
                                            {.shape = RENDER_PLATE,
                                             .centre_m = {0, 8, 0},
                                             .right_m = {2, 0, 0},
                                             .up_m = {0, 0, 2},
                                             .luma = 60}};
    draw(&level, objects, 2, &clean);
    CHECK_EQ(picture[110][150], 200);
    CHECK_EQ(picture[110][170], 60); // through the hole
    CHECK_EQ(picture[130][150], 100);
    CHECK_EQ(picture[130][170], 150);
    CHECK_EQ(picture[119][100], 60);
    CHECK_EQ(picture[119][20], 40);
    const double c = cos(0.1), s = sin(0.1);
    const struct render_view right = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}, {0, 0, 0}};
    draw(&right, objects, 1, &clean);
    double at[2];
    (void)centroid(at);
    CHECK(at[0] < CX - 0.09 * FOCAL && at[0] > CX - 0.15 * FOCAL);
    CHECK_EQ(picture[110][170 - 28], 40); // the hole shows the backdrop now
    const struct render_view behind = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, 0}};
    draw(&behind, objects, 2, &clean);
    CHECK_EQ(picture[119][159], 40);
}

static void noise_and_blur_as_asked_for(void) {
    const struct render_sensor noisy = {0.0, 4.0, 1.0};
    draw(&level, NULL, 0, &noisy);
    double sum = 0.0, squares = 0.0;
    for (int v = 0; v < HEIGHT; v++) {
        for (int u = 0; u < WIDTH; u++) {
            sum += picture[v][u];
            squares += (double)picture[v][u] * picture[v][u];
        }
    }
    const double mean = sum / (WIDTH * HEIGHT);
    const double deviation = sqrt(squares / (WIDTH * HEIGHT) - mean * mean);
    CHECK(fabs(mean - 40.0) < 0.1 && fabs(deviation - 4.0) < 0.1);
    // An edge that is blurred by s passes 84 % of its step s pixels behind the edge.
    const struct render_sensor blurred = {2.0, 0.0, 1.0};
    const struct render_object plate = {.shape = RENDER_PLATE,
                                        .centre_m = {5.0, 5.0, 0},
                                        .right_m = {5.0, 0, 0},
                                        .up_m = {0, 0, 5.0},
                                        .luma = 240};
    draw(&level, &plate, 1, &blurred); // its edge is at u = 159.5
    CHECK_NEAR(picture[120][162], 40 + 200 * 0.894, 3);
    CHECK_NEAR(picture[120][157], 40 + 200 * 0.106, 3);
}

static void backdrops_turn_with_the_world(void) {
    const struct render_backdrop rough = {7, 100.0, 60.0, 4.0};
    render_frame(&render, &level, &rough, NULL, 0, &clean, &picture[0][0], WIDTH);
    static uint8_t first[HEIGHT][WIDTH];
    memcpy(first, picture, sizeof first);
    // 20 pixels to the right of the middle come to the middle.
    const double angle = atan(20.0 / FOCAL), c = cos(angle), s = sin(angle);
    const struct render_view right = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}, {0, 0, 0}};
    render_frame(&render, &right, &rough, NULL, 0, &clean, &picture[0][0], WIDTH);
    int least = 255, most = 0;
    for (int v = 100; v < 140; v++) {
        CHECK_NEAR((picture[v][159] + picture[v][160]) / 2, (first[v][179] + first[v][180]) / 2, 2);
    }
    for (int v = 0; v < HEIGHT; v++) {
        for (int u = 0; u < WIDTH; u++) {
            least = first[v][u] < least ? first[v][u] : least;
            most = first[v][u] > most ? first[v][u] : most;
        }
    }
    CHECK(least < 80 && most > 120);
}

int main(void) {
    if (!render_create(&render, WIDTH, HEIGHT, pinhole, NULL, 1)) {
        return 1;
    }
    TEST(balls_where_they_belong);
    TEST(plates_cover_parts_of_pixels);
    TEST(textures_holes_and_order);
    TEST(noise_and_blur_as_asked_for);
    TEST(backdrops_turn_with_the_world);
    render_destroy(&render);
    return check_finish();
}
