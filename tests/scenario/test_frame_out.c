/// Pictures into a file and down a pipe: whole, in order, and never waiting for who reads them.
#include "check.h"
#include "detect/frame_file.h"
#include "frame_out.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define WIDTH  320U
#define HEIGHT 240U

static char folder[] = "/tmp/frame_out.XXXXXX", path[64];

/// A picture all of whose bytes are its number.
static void send(struct frame_out *out, unsigned number) {
    char comment[40];
    memset(out->picture, (int)number, (size_t)WIDTH * HEIGHT);
    snprintf(comment, sizeof comment, "number %u", number);
    CHECK(frame_out_send(out, comment));
}

static bool holds(const struct hal_camera_luma *frame, unsigned number) {
    bool all = frame->width_px == WIDTH && frame->height_px == HEIGHT;
    for (uint32_t y = 0; y < HEIGHT && all; y++) {
        for (uint32_t x = 0; x < WIDTH && all; x++) {
            all = frame->luma[(size_t)y * frame->stride_bytes + x] == number;
        }
    }
    return all;
}

static void a_file_holds_the_newest(void) {
    struct frame_out out;
    struct frame_file file = {0};
    struct hal_camera_luma frame;
    CHECK(frame_out_open(&out, path, WIDTH, HEIGHT));
    for (unsigned number = 0; number < 5U; number++) {
        CHECK(frame_file_open(&file, path)); // what a reader has open stays as it was
        send(&out, 10U + number);
        CHECK_EQ(frame_file_next(&file, &frame), FRAME_FILE_OK);
        CHECK(holds(&frame, number == 0U ? 0U : 9U + number));
        CHECK_EQ(frame_file_next(&file, &frame), FRAME_FILE_END);
        frame_file_close(&file);
    }
    CHECK_EQ(out.written, 5);
    CHECK_EQ(out.dropped, 0);
    char head[20] = "";
    FILE *stream = fopen(path, "rb");
    CHECK(stream != NULL && fread(head, 1, 14, stream) == 14U);
    CHECK(strcmp(head, "P5\n# number 14") == 0);
    fclose(stream);
    frame_out_close(&out);
    frame_file_free(&file);
    CHECK(unlink(path) == 0);
}

/// Reads all that the pipe has; returns how many bytes.
static size_t read_some(int fd, uint8_t *bytes, size_t capacity) {
    size_t size = 0;
    ssize_t got;
    while (size < capacity && (got = read(fd, bytes + size, capacity - size)) > 0) {
        size += (size_t)got;
    }
    return size;
}

static void a_pipe_gets_whole_pictures(void) {
    static uint8_t bytes[8U * (WIDTH * HEIGHT + 64U)];
    struct frame_out out;
    CHECK(mkfifo(path, 0600) == 0);
    CHECK(frame_out_open(&out, path, WIDTH, HEIGHT));
    send(&out, 1);
    CHECK_EQ(out.dropped, 1); // nobody reads
    const int reader = open(path, O_RDONLY | O_NONBLOCK);
    send(&out, 2); // more than a pipe holds: under way
    send(&out, 3); // and that one is in the way of this
    CHECK_EQ(out.written, 0);
    CHECK_EQ(out.dropped, 2);
    size_t size = 0;
    for (int i = 0; i < 100 && out.written < 1U; i++) {
        size += read_some(reader, bytes + size, sizeof bytes - size);
        frame_out_tick(&out);
    }
    size += read_some(reader, bytes + size, sizeof bytes - size);
    send(&out, 4);
    for (int i = 0; i < 100 && out.written < 2U; i++) {
        size += read_some(reader, bytes + size, sizeof bytes - size);
        frame_out_tick(&out);
    }
    size += read_some(reader, bytes + size, sizeof bytes - size);
    CHECK_EQ(out.written, 2);
    struct frame_file file = {.stream = fmemopen(bytes, size, "rb"), .name = "pipe"};
    struct hal_camera_luma frame;
    CHECK(frame_file_next(&file, &frame) == FRAME_FILE_OK && holds(&frame, 2));
    CHECK(frame_file_next(&file, &frame) == FRAME_FILE_OK && holds(&frame, 4));
    CHECK_EQ(frame_file_next(&file, &frame), FRAME_FILE_END);
    fclose(file.stream);
    file.stream = NULL;
    // A reader that leaves in the middle, and another that comes: it gets a picture from its
    // beginning.
    send(&out, 5);
    close(reader);
    send(&out, 6);
    CHECK_EQ(out.dropped, 4); // 5, cut off by the reader, and 6
    const int other = open(path, O_RDONLY | O_NONBLOCK);
    send(&out, 7);
    size = 0;
    for (int i = 0; i < 100 && out.written < 3U; i++) {
        size += read_some(other, bytes + size, sizeof bytes - size);
        frame_out_tick(&out);
    }
    size += read_some(other, bytes + size, sizeof bytes - size);
    CHECK_EQ(out.written, 3);
    CHECK_EQ(size, (size_t)WIDTH * HEIGHT + strlen("P5\n# number 7\n320 240\n255\n"));
    CHECK(memcmp(bytes, "P5\n# number 7\n", 14) == 0);
    close(other);
    frame_out_close(&out);
    frame_file_free(&file);
    CHECK(unlink(path) == 0);
}

static void what_can_not_be_written_is_told(void) {
    struct frame_out out;
    FILE *said = tmpfile();
    char line[200] = "";
    message_stream(said);
    CHECK(!frame_out_open(&out, folder, WIDTH, HEIGHT));
    frame_out_close(&out);
    CHECK(!frame_out_open(&out, "/nowhere/view.pgm", WIDTH, HEIGHT));
    frame_out_close(&out);
    message_stream(NULL);
    rewind(said);
    CHECK(fgets(line, sizeof line, said) != NULL && strstr(line, "Is a directory") != NULL);
    CHECK(fgets(line, sizeof line, said) != NULL &&
          strcmp(line, "/nowhere/view.pgm: No such file or directory\n") == 0);
    fclose(said);
}

int main(void) {
    CHECK(mkdtemp(folder) != NULL);
    snprintf(path, sizeof path, "%s/view", folder);
    TEST(a_file_holds_the_newest);
    TEST(a_pipe_gets_whole_pictures);
    TEST(what_can_not_be_written_is_told);
    CHECK(rmdir(folder) == 0);
    return check_finish();
}
