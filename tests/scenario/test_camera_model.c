/// The camera model against rationals worked out by hand and against numbers that OpenCV 4.6's
/// projectPoints printed; there and back at every pixel; and distortions that have no inverse.
#include "check.h"

#include "detect/camera_model.h"

#include <math.h>

static const struct camera_model webcam = {640,     480,    612.3,   609.8,    317.4,   243.9,
                                           -0.3121, 0.1263, 0.00081, -0.00127, -0.0241, 0.0};
static const struct camera_model wide = {640,     480,    431.7,    432.9,   330.2,   228.8,
                                         -0.2874, 0.0971, -0.00043, 0.00062, -0.0098, 0.0};
static const struct camera_model tele = {640,    480,     2210.5,  2207.1,  309.7,  251.3,
                                         0.1533, -0.4127, 0.00173, 0.00094, 0.8812, 0.0};

/// Direction as right, ahead, up (OpenCV's x, z, -y) and its pixel.
static const struct known {
    const struct camera_model *camera;
    double direction[3], pixel[2];
} opencv[] = {
    {&webcam, {2.6752, 23.3827, -6.3971}, {385.5398276646, 406.3810833357}},
    {&webcam, {-6.6022, 26.2698, 3.6157}, {167.2016979977, 162.0550112243}},
    {&webcam, {-10.8656, 24.0135, -5.3129}, {59.5251305607, 369.5062420838}},
    {&webcam, {-0.2555, 8.7136, 1.1821}, {299.5408850428, 161.6886629275}},
    {&webcam, {-3.4490, 15.3842, 0.5820}, {182.1866503743, 221.2089298278}},
    {&webcam, {1.1686, 23.8835, -8.1509}, {346.2205741282, 444.8014264773}},
    {&webcam, {0.7656, 6.8516, -2.3074}, {383.1839151319, 441.7090886293}},
    {&webcam, {-0.5582, 1.7963, -0.1392}, {132.7171880100, 289.7977179018}},
    {&wide, {-2.9126, 9.9020, -5.7900}, {216.9134617237, 454.7788008797}},
    {&wide, {5.9045, 12.0370, -5.3429}, {519.2558612595, 400.1618017753}},
    {&wide, {-0.3860, 3.6551, 0.5581}, {285.0655233526, 163.3409054562}},
    {&wide, {-0.2891, 8.0858, 2.5096}, {315.2065275190, 98.0382857508}},
    {&wide, {-13.1352, 24.5079, 9.0033}, {123.2618325303, 86.4071984570}},
    {&wide, {-2.3477, 17.9316, 5.2521}, {275.3164866446, 105.5964225067}},
    {&wide, {4.8543, 27.3850, -4.8261}, {405.4003628922, 303.7430213094}},
    {&wide, {-5.2902, 8.8963, 1.3730}, {98.1757752435, 168.3173051077}},
    {&tele, {0.0220, 11.1573, -0.7884}, {314.0734305317, 407.4343377926}},
    {&tele, {0.2969, 11.9351, 1.0010}, {364.7545747920, 66.0514476896}},
    {&tele, {-1.1020, 24.5820, 1.6363}, {210.5526690077, 104.3126984900}},
    {&tele, {-0.5468, 17.9048, -1.6312}, {242.1014462951, 452.7405252440}},
    {&tele, {0.5444, 20.4553, -0.5372}, {368.5542880890, 309.2890552226}},
    {&tele, {-0.6695, 7.5671, 0.0859}, {113.9489846854, 226.2511176040}},
    {&tele, {-0.7176, 29.0509, 2.2295}, {255.0744671311, 81.8287656080}},
    {&tele, {-0.6760, 9.3624, -0.3060}, {149.9592389261, 323.5273529526}},
};

static double apart(const double a[2], const double b[2]) {
    return hypot(a[0] - b[0], a[1] - b[1]);
}

/// x = 0.4, y = -0.3, r2 = 1/4: radial = 1 - 1/16 + 0.08/16 - 0.01/64 = 0.94234375,
/// x' = 0.376937500 - 0.00024 - 0.000285, y' = -0.282703125 + 0.00043 + 0.00012.
static void a_pixel_worked_out_by_hand(void) {
    struct camera_model model = {640,   480,  500.0, 500.0,   320.0, 240.0,
                                 -0.25, 0.08, 0.001, -0.0005, -0.01, 0.0};
    CHECK(camera_model_check(&model) == NULL);
    const double direction[3] = {0.8, 2.0, 0.6};
    const double wanted[2] = {508.20625, 98.9234375};
    double pixel[2];
    CHECK(camera_model_project(&model, direction, pixel));
    CHECK(apart(pixel, wanted) < 1e-9);
    double ray[3];
    CHECK(camera_model_ray(&model, wanted, ray));
    const double length = sqrt(5.0);
    for (unsigned i = 0; i < 3U; i++) {
        CHECK(fabs(ray[i] - direction[i] / length) < 1e-12);
    }
}

static void pixels_of_opencv(void) {
    double worst = 0.0;
    for (unsigned i = 0; i < sizeof opencv / sizeof *opencv; i++) {
        struct camera_model model = *opencv[i].camera;
        CHECK(camera_model_check(&model) == NULL);
        double pixel[2];
        CHECK(camera_model_project(&model, opencv[i].direction, pixel));
        worst = fmax(worst, apart(pixel, opencv[i].pixel));
    }
    CHECK(worst < 1e-9);
}

static void there_and_back_at_every_pixel(void) {
    const struct camera_model *const cameras[] = {&webcam, &wide, &tele};
    for (unsigned i = 0; i < 3U; i++) {
        struct camera_model model = *cameras[i];
        CHECK(camera_model_check(&model) == NULL);
        double worst = 0.0;
        for (int v = 0; v <= 480; v += 5) {
            for (int u = 0; u <= 640; u += 5) {
                const double pixel[2] = {u - 0.5, v - 0.5};
                double ray[3], back[2];
                if (!CHECK(camera_model_ray(&model, pixel, ray)) ||
                    !CHECK(camera_model_project(&model, ray, back))) {
                    return;
                }
                worst = fmax(worst, apart(pixel, back));
                CHECK(fabs(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2] - 1.0) < 1e-14);
            }
        }
        CHECK(worst < 1e-9);
        check_note("there and back, worst, in 1e-15 px", (int64_t)(worst * 1e15));
    }
}

static void directions_that_no_pixel_shows(void) {
    struct camera_model model = wide;
    CHECK(camera_model_check(&model) == NULL);
    double pixel[2] = {7.0, 7.0};
    CHECK(!camera_model_project(&model, (const double[3]){0.1, 0.0, 0.1}, pixel));
    CHECK(!camera_model_project(&model, (const double[3]){0.1, -1.0, 0.1}, pixel));
    CHECK(!camera_model_project(&model, (const double[3]){NAN, 1.0, 0.0}, pixel));
    // Beyond the fold two directions would share a pixel.
    for (int i = 0; i < 24; i++) {
        const double far = 3.0, right = far * cos(i * 0.261799), up = far * sin(i * 0.261799);
        CHECK(!camera_model_project(&model, (const double[3]){right, 1.0, up}, pixel));
        CHECK(camera_model_project(&model, (const double[3]){right, 6.0, up}, pixel));
    }
    double ray[3];
    CHECK(!camera_model_ray(&model, (const double[2]){5000.0, 200.0}, ray));
    CHECK(!camera_model_ray(&model, (const double[2]){NAN, 200.0}, ray));
}

static bool refused(struct camera_model model) {
    return camera_model_check(&model) != NULL;
}

static void cameras_that_are_none(void) {
    struct camera_model model = webcam;
    CHECK(!refused(model));
    model.fx_px = 0.0;
    CHECK(refused(model));
    model = webcam;
    model.k2 = NAN;
    CHECK(refused(model));
    model = webcam;
    model.width_px = 0;
    CHECK(refused(model));
    model = webcam;
    model.k1 = -0.9; // the corners are beyond the fold
    model.k2 = model.k3 = 0.0;
    CHECK(refused(model));
}

/// r (1 - r^2 / 4) turns back at r^2 = 4/3, where it is 2/3 of r.
static void the_fold_is_where_it_should_be(void) {
    struct camera_model model = camera_model_pinhole(100, 100, 200.0);
    model.k1 = -0.25;
    CHECK(camera_model_check(&model) == NULL);
    CHECK(fabs(model.r2_max - 4.0 / 3.0) < 1e-9);
    double ray[3];
    const double edge = 49.5 + 200.0 * sqrt(4.0 / 3.0) * 2.0 / 3.0;
    CHECK(camera_model_ray(&model, (const double[2]){edge - 0.01, 49.5}, ray));
    CHECK(!camera_model_ray(&model, (const double[2]){edge + 0.01, 49.5}, ray));
}

/// The fold is 153.96 pixels from the centre here. Of pictures whose centre is not in their middle
/// one corner after the other is a third of a pixel inside of it, and then as far beyond.
static void each_corner_has_to_have_a_direction(void) {
    for (int corner = 0; corner < 4; corner++) {
        for (int beyond = 0; beyond < 2; beyond++) {
            const double off = (153.96 + (beyond != 0 ? 0.33 : -0.33)) / sqrt(2.0) - 50.0;
            struct camera_model model = camera_model_pinhole(100, 100, 200.0);
            model.k1 = -0.25;
            model.cx_px += (corner & 1) != 0 ? off : -off;
            model.cy_px += (corner & 2) != 0 ? off : -off;
            CHECK_EQ(camera_model_check(&model) != NULL, beyond);
        }
    }
}

/// The edges of the picture show the same directions at any size of it, and zooming by two doubles
/// distances from the centre.
static void other_sizes_and_zooms(void) {
    struct camera_model model = wide;
    CHECK(camera_model_check(&model) == NULL);
    const struct camera_model half = camera_model_resized(&model, 320, 120);
    for (unsigned corner = 0; corner < 4U; corner++) {
        const double right = corner % 2U, down = corner / 2U; // from edge to edge
        double a[3], b[3];
        CHECK(camera_model_ray(&model, (const double[2]){640.0 * right - 0.5, 480.0 * down - 0.5},
                               a));
        CHECK(
            camera_model_ray(&half, (const double[2]){320.0 * right - 0.5, 120.0 * down - 0.5}, b));
        for (unsigned i = 0; i < 3U; i++) {
            CHECK(fabs(a[i] - b[i]) < 1e-12);
        }
    }
    const struct camera_model zoomed = camera_model_zoomed(&model, 2.0);
    const double direction[3] = {0.1, 1.0, 0.05};
    double near[2], far[2];
    CHECK(camera_model_project(&model, direction, near));
    CHECK(camera_model_project(&zoomed, direction, far));
    CHECK(fabs(far[0] - model.cx_px - 2.0 * (near[0] - model.cx_px)) < 1e-9);
    CHECK(fabs(far[1] - model.cy_px - 2.0 * (near[1] - model.cy_px)) < 1e-9);
}

int main(void) {
    TEST(a_pixel_worked_out_by_hand);
    TEST(pixels_of_opencv);
    TEST(there_and_back_at_every_pixel);
    TEST(directions_that_no_pixel_shows);
    TEST(cameras_that_are_none);
    TEST(the_fold_is_where_it_should_be);
    TEST(each_corner_has_to_have_a_direction);
    TEST(other_sizes_and_zooms);
    return check_finish();
}
