/// detect/frame_file.h on every cut of every kind of picture, and on pixels that are known.
#include "check.h"

#include "detect/frame_file.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if HAVE_JPEG
#include <jpeglib.h>
#endif

enum { WIDTH = 24, HEIGHT = 16 };

static char path[64];

static void write_file(const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(bytes, 1, size, file) == size);
    fclose(file);
}

static enum frame_file_status read_first(struct frame_file *file, struct hal_camera_luma *frame) {
    CHECK(frame_file_open(file, path));
    const enum frame_file_status status = frame_file_next(file, frame);
    frame_file_close(file);
    return status;
}

static void greys_as_they_are(void) {
    static const char text[] = "P5\n# two numbers a line\n3 2 # like this\n255\n\1\2\3\4\5\377"
                               "P5 2 1 100\n\0\62";
    struct frame_file file = {0};
    struct hal_camera_luma frame;
    write_file(text, sizeof text - 1U);
    CHECK(frame_file_open(&file, path));
    CHECK(frame_file_next(&file, &frame) == FRAME_FILE_OK);
    CHECK(frame.width_px == 3U && frame.height_px == 2U && frame.stride_bytes == 3U);
    CHECK(memcmp(frame.luma, "\1\2\3\4\5\377", 6) == 0);
    CHECK(frame_file_next(&file, &frame) == FRAME_FILE_OK);
    CHECK(frame.width_px == 2U && frame.luma[0] == 0 && frame.luma[1] == 128); // 50 of 100
    CHECK(frame_file_next(&file, &frame) == FRAME_FILE_END);
    frame_file_free(&file);
}

/// White, red, green, blue: 0.299, 0.587, 0.114.
static void colours_by_their_weights(void) {
    static const char text[] = "P6 4 1 255\n\377\377\377\377\0\0\0\377\0\0\0\377";
    struct frame_file file = {0};
    struct hal_camera_luma frame;
    write_file(text, sizeof text - 1U);
    CHECK(read_first(&file, &frame) == FRAME_FILE_OK);
    CHECK_EQ(frame.luma[0], 255);
    CHECK_NEAR(frame.luma[1], 76, 1);
    CHECK_NEAR(frame.luma[2], 150, 1);
    CHECK_NEAR(frame.luma[3], 29, 1);
    frame_file_free(&file);
}

static void every_cut_is_refused(void) {
    char text[16 + WIDTH * HEIGHT];
    const int header = snprintf(text, sizeof text, "P5 %d %d 255\n", WIDTH, HEIGHT);
    memset(text + header, 77, WIDTH * HEIGHT);
    const size_t size = (size_t)header + WIDTH * HEIGHT;
    struct frame_file file = {0};
    struct hal_camera_luma frame;
    for (size_t cut = 0; cut < size; cut++) {
        write_file(text, cut);
        CHECK(read_first(&file, &frame) == FRAME_FILE_ERROR);
    }
    write_file(text, size);
    CHECK(read_first(&file, &frame) == FRAME_FILE_OK);
    frame_file_free(&file);
}

#if HAVE_JPEG
static void jpeg_pictures(void) {
    uint8_t row[WIDTH];
    unsigned char *bytes = NULL;
    unsigned long size = 0;
    struct jpeg_compress_struct jpeg = {0};
    struct jpeg_error_mgr errors;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = WIDTH;
    jpeg.image_height = HEIGHT;
    jpeg.input_components = 1;
    jpeg.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    for (int v = 0; v < HEIGHT; v++) {
        for (int u = 0; u < WIDTH; u++) {
            row[u] = (uint8_t)(40 + 5 * u + 3 * v);
        }
        JSAMPROW line = row;
        (void)jpeg_write_scanlines(&jpeg, &line, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    struct frame_file file = {0};
    struct hal_camera_luma frame;
    write_file(bytes, size);
    CHECK(read_first(&file, &frame) == FRAME_FILE_OK);
    CHECK(frame.width_px == WIDTH && frame.height_px == HEIGHT);
    for (int v = 0; v < HEIGHT; v++) {
        for (int u = 0; u < WIDTH; u++) {
            CHECK_NEAR(frame.luma[(uint32_t)v * frame.stride_bytes + (uint32_t)u],
                       40 + 5 * u + 3 * v, 2);
        }
    }
    for (unsigned long cut = 0; cut + 2U < size; cut++) { // without its last mark it is still whole
        write_file(bytes, cut);
        CHECK(read_first(&file, &frame) == FRAME_FILE_ERROR);
    }
    free(bytes);
    frame_file_free(&file);
}
#endif

int main(void) {
    snprintf(path, sizeof path, "build/frame_files.%ld", (long)getpid());
    FILE *quiet = fopen("/dev/null", "w");
    message_stream(quiet);
    TEST(greys_as_they_are);
    TEST(colours_by_their_weights);
    TEST(every_cut_is_refused);
#if HAVE_JPEG
    TEST(jpeg_pictures);
#endif
    message_stream(NULL);
    fclose(quiet);
    unlink(path);
    return check_finish();
}
