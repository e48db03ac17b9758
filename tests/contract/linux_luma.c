/// Frames as brightness: pictures whose pixels are known, JPEG pictures that this test encodes, and
/// the same cut off, changed and without tables.
#include "linux/linux_luma.h"
#include "contract/support/contract.h"

#include <stdio.h>
#include <stdlib.h>
#if HAVE_JPEG
#include <jpeglib.h>
#endif

#define WIDTH  48U
#define HEIGHT 32U

/// Smooth, so that JPEG changes it by little, and different in every place.
static int pixel_at(uint32_t x, uint32_t y) {
    return (int)(20U + 3U * x + 2U * y);
}

static struct linux_luma luma;

static void expect_pixels(const struct hal_camera_luma *got, int tolerance, uint32_t lines) {
    CHECK_EQ(got->width_px, WIDTH);
    CHECK_EQ(got->height_px, HEIGHT);
    for (uint32_t y = 0; y < HEIGHT && check_clean(); y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            CHECK_NEAR(got->luma[y * got->stride_bytes + x], y < lines ? pixel_at(x, y) : 0,
                       tolerance);
        }
    }
}

static void grey_is_not_copied(void) {
    enum { STRIDE = 64 };
    uint8_t picture[STRIDE * HEIGHT];
    memset(picture, 255, sizeof picture);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            picture[y * STRIDE + x] = (uint8_t)pixel_at(x, y);
        }
    }
    const struct hal_camera_format format = {
        .pixels = HAL_CAMERA_GREY, .width_px = WIDTH, .height_px = HEIGHT, .stride_bytes = STRIDE};
    struct hal_camera_frame frame = {.data = picture,
                                     .size_bytes = STRIDE * (HEIGHT - 1U) + WIDTH,
                                     .exposed_us = 4000000000U,
                                     .sequence = 77,
                                     .buffer_index = 3};
    struct hal_camera_luma got = {0};
    CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
    CHECK(got.luma == picture);
    CHECK_EQ(got.stride_bytes, STRIDE);
    CHECK_EQ(got.exposed_us, 4000000000U);
    CHECK_EQ(got.sequence, 77);
    CHECK(!got.damaged);
    expect_pixels(&got, 0, HEIGHT);
    // One byte short, a line is missing; nothing beyond the frame is looked at.
    uint8_t *const part = malloc(frame.size_bytes - 1U);
    memcpy(part, picture, frame.size_bytes - 1U);
    frame.data = part;
    frame.size_bytes--;
    CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
    CHECK(got.damaged);
    expect_pixels(&got, 0, HEIGHT - 1U);
    free(part);
    frame.size_bytes = 0;
    CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_ERROR_IO);
}

static void yuyv_gives_every_second_byte(void) {
    enum { STRIDE = 2 * 48 + 32 };
    uint8_t picture[STRIDE * HEIGHT];
    memset(picture, 200, sizeof picture);
    for (uint32_t y = 0; y < HEIGHT; y++) {
        for (uint32_t x = 0; x < WIDTH; x++) {
            picture[y * STRIDE + 2U * x] = (uint8_t)pixel_at(x, y);
        }
    }
    const struct hal_camera_format format = {
        .pixels = HAL_CAMERA_YUYV, .width_px = WIDTH, .height_px = HEIGHT, .stride_bytes = STRIDE};
    struct hal_camera_frame frame = {
        .data = picture, .size_bytes = sizeof picture, .damaged = true};
    struct hal_camera_luma got = {0};
    CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
    CHECK(got.damaged); // as the frame said
    expect_pixels(&got, 0, HEIGHT);
    frame.damaged = false;
    CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
    CHECK(!got.damaged);
    for (uint32_t lines = 1; lines < HEIGHT; lines++) {
        frame.size_bytes = lines * STRIDE;
        CHECK_EQ(linux_luma_take(&luma, &format, &frame, &got), HAL_OK);
        CHECK(got.damaged);
        expect_pixels(&got, 0, lines);
    }
}

static void formats_without_pixels_are_refused(void) {
    uint8_t byte = 0;
    const struct hal_camera_frame frame = {.data = &byte, .size_bytes = 1};
    const struct hal_camera_format none[] = {
        {.pixels = HAL_CAMERA_GREY, .width_px = 0, .height_px = 1},
        {.pixels = HAL_CAMERA_YUYV, .width_px = 2, .height_px = 0},
        {.width_px = 1, .height_px = 1},
        {.pixels = (enum hal_camera_pixels)(HAL_CAMERA_MJPEG + 1), .width_px = 1, .height_px = 1}};
    struct hal_camera_luma got = {.sequence = 77};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        CHECK_EQ(linux_luma_take(&luma, &none[i], &frame, &got), HAL_ERROR_ARGUMENT);
    }
    CHECK_EQ(got.sequence, 77);
}

#if HAVE_JPEG

static const struct hal_camera_format jpeg_format = {
    .pixels = HAL_CAMERA_MJPEG, .width_px = WIDTH, .height_px = HEIGHT};

/// The picture in colour, half the resolution in colour as cameras do. size: in, room; out, bytes.
static void encode(uint8_t *data, unsigned long *size, uint32_t width, uint32_t height) {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &data, size);
    jpeg.image_width = width;
    jpeg.image_height = height;
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_YCbCr;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 95, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    while (jpeg.next_scanline < height) {
        uint8_t line[3U * 2U * WIDTH];
        for (uint32_t x = 0; x < width; x++) {
            line[3U * x] = (uint8_t)pixel_at(x, jpeg.next_scanline);
            line[3U * x + 1U] = (uint8_t)(40U + x); // colours that must not matter
            line[3U * x + 2U] = (uint8_t)(200U - x);
        }
        JSAMPROW row = line;
        (void)jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
}

static uint8_t encoded[65536];
static unsigned long encoded_bytes;

static enum hal_status take_bytes(const uint8_t *data, size_t size, struct hal_camera_luma *got) {
    // In memory of just that size, so that the sanitizers see any look beyond it.
    uint8_t *const copy = malloc(size + (size == 0U ? 1U : 0U));
    memcpy(copy, data, size);
    const struct hal_camera_frame frame = {.data = copy, .size_bytes = (uint32_t)size};
    const enum hal_status status = linux_luma_take(&luma, &jpeg_format, &frame, got);
    free(copy);
    return status;
}

static void jpeg_is_decoded(void) {
    struct hal_camera_luma got = {0};
    CHECK_EQ(take_bytes(encoded, encoded_bytes, &got), HAL_OK);
    CHECK(!got.damaged);
    expect_pixels(&got, 3, HEIGHT);
}

/// As most cameras send them: the tables of the standard (segments DHT, FF C4) are left out.
static void tables_may_be_missing(void) {
    static uint8_t bare[sizeof encoded];
    size_t size = 2, at = 2;
    memcpy(bare, encoded, 2);
    while (encoded[at + 1U] != 0xDAU) { // until the picture itself
        const size_t segment = 2U + ((size_t)encoded[at + 2U] << 8 | encoded[at + 3U]);
        if (encoded[at + 1U] != 0xC4U) {
            memcpy(bare + size, encoded + at, segment);
            size += segment;
        }
        at += segment;
    }
    memcpy(bare + size, encoded + at, encoded_bytes - at);
    size += encoded_bytes - at;
    CHECK(size < encoded_bytes - 300U);
    struct hal_camera_luma got = {0};
    CHECK_EQ(take_bytes(bare, size, &got), HAL_OK);
    CHECK(!got.damaged);
    expect_pixels(&got, 3, HEIGHT);
}

/// Cut anywhere: refused, or told to be damaged.
static void every_cut_is_noticed(void) {
    for (size_t size = 0; size + 2U < encoded_bytes && check_clean(); size++) {
        struct hal_camera_luma got = {.sequence = 77};
        const enum hal_status status = take_bytes(encoded, size, &got);
        CHECK(status == HAL_ERROR_IO || (status == HAL_OK && got.damaged));
        CHECK(status == HAL_OK || got.sequence == 77U);
    }
}

/// Any byte changed: whatever comes of it, nothing outside of the picture is touched (the
/// sanitizers watch), and a good picture is decoded afterwards.
static void every_changed_byte_is_survived(void) {
    static uint8_t changed[sizeof encoded];
    uint64_t random = 20261123;
    uint32_t refused = 0;
    check_note("seed", (int64_t)random);
    for (size_t at = 0; at < encoded_bytes; at++) {
        memcpy(changed, encoded, encoded_bytes);
        changed[at] = (uint8_t)(check_random(&random) >> 40);
        struct hal_camera_luma got;
        const enum hal_status status = take_bytes(changed, encoded_bytes, &got);
        CHECK(status == HAL_OK || status == HAL_ERROR_IO);
        refused += status != HAL_OK ? 1U : 0U;
    }
    CHECK(refused > 10U);
    jpeg_is_decoded();
}

/// A picture of another size than agreed on has no place in the plane.
static void other_sizes_are_refused(void) {
    static uint8_t other[sizeof encoded];
    const uint32_t sizes[][2] = {{2 * WIDTH, HEIGHT}, {WIDTH, 2 * HEIGHT}, {WIDTH / 2U, HEIGHT}};
    for (size_t i = 0; i < 3U; i++) {
        unsigned long size = sizeof other;
        encode(other, &size, sizes[i][0], sizes[i][1]);
        struct hal_camera_luma got;
        CHECK_EQ(take_bytes(other, size, &got), HAL_ERROR_IO);
    }
}

#endif

int main(void) {
    TEST(grey_is_not_copied);
    TEST(yuyv_gives_every_second_byte);
    TEST(formats_without_pixels_are_refused);
#if HAVE_JPEG
    encoded_bytes = sizeof encoded;
    encode(encoded, &encoded_bytes, WIDTH, HEIGHT);
    TEST(jpeg_is_decoded);
    TEST(tables_may_be_missing);
    TEST(every_cut_is_noticed);
    TEST(every_changed_byte_is_survived);
    TEST(other_sizes_are_refused);
#else
    contract_skip("linux_luma", "jpeg", "built without libjpeg-turbo");
#endif
    linux_luma_free(&luma);
    return check_finish();
}
