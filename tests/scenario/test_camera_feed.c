/// The camera's frames for the loop: which format is agreed on, with libjpeg-turbo and without;
/// what is counted; a camera that leaves, falls silent and comes back. The camera is a model below
/// the C library, the event loop and its time are the test's (the three functions at the top stand
/// for those of event_loop.c).
#include "camera_feed.h"

#include "check.h"
#include "contract/support/syscalls.h"
#include "contract/support/v4l2_model.h"
#include "devices/fake_clock.h"
#include "linux/linux_luma.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// ---------------------------------------------------------------- the loop

static struct fake_clock clock_; ///< of the frames
static struct event_loop loop_;  ///< never looked into
static uint64_t loop_us;
static struct {
    int fd; ///< -1: nothing is watched
    void (*ready)(void *context);
    void *context;
    unsigned count;
    bool full;
} watched = {.fd = -1};

uint64_t event_loop_now_us(void) {
    return loop_us;
}

bool event_loop_watch(struct event_loop *loop, int fd, void (*ready)(void *context),
                      void *context) {
    CHECK(loop == &loop_);
    if (watched.full) {
        return false;
    }
    CHECK_EQ(watched.fd, -1);
    watched.fd = fd;
    watched.ready = ready;
    watched.context = context;
    watched.count++;
    return true;
}

void event_loop_forget(struct event_loop *loop, int fd) {
    CHECK(loop == &loop_);
    CHECK(fd >= 0 && (fd == watched.fd || watched.full));
    watched.fd = -1;
}

// ---------------------------------------------------------------- the feed

static const char *path;
static struct camera_feed feed;
static struct taken {
    uint32_t count, sequence, width_px;
    uint8_t pixel;
    bool damaged;
} taken;

static void take(void *context, const struct hal_camera_format *format,
                 const struct hal_camera_frame *frame) {
    CHECK(context == &taken && format == &feed.format);
    taken.count++;
    taken.sequence = frame->sequence;
    taken.width_px = format->width_px;
    taken.pixel = frame->data[0];
    taken.damaged = frame->damaged;
}

static struct camera_feed_settings settings_of(struct hal_camera_format wish) {
    return (struct camera_feed_settings){
        .device = path, .wish = wish, .clock = &clock_.hal, .take = take, .context = &taken};
}

static const struct hal_camera_format fast = {
    .width_px = 320, .height_px = 240, .interval_us = 33333};

static void open_feed(void) {
    const struct camera_feed_settings settings = settings_of(fast);
    v4l2_model_reset();
    memset(&taken, 0, sizeof taken);
    CHECK_EQ(camera_feed_open(&feed, &settings), HAL_OK);
    CHECK(camera_feed_is_there(&feed) && watched.fd < 0);
    CHECK(camera_feed_watch(&feed, &loop_));
    CHECK_EQ(watched.fd, feed.camera.fd);
}

/// So many frames are exposed, then the loop sees that the camera can be read.
static void frames_come(uint32_t count) {
    fake_clock_advance(&clock_, count * feed.format.interval_us);
    watched.ready(watched.context);
}

/// The news since the last time: that text behind the camera's path; NULL: none.
static void expect_news(const char *wanted) {
    char line[LINUX_ERROR_BYTES] = "";
    if (wanted != NULL) {
        snprintf(line, sizeof line, "%s: %s", path, wanted);
    }
    if (!CHECK(strcmp(feed.news, line) == 0)) {
        printf("  told   %s\n  wanted %s\n", feed.news, line);
    }
    feed.news[0] = '\0';
}

/// A tick that long after the last one. Returns, when nothing goes on in the background any more,
/// whether it has begun to open the camera.
static bool tick(uint64_t span_us) {
    loop_us += span_us;
    camera_feed_tick(&feed, loop_us);
    const bool began = feed.attempt.running;
    side_job_wait(&feed.attempt);
    return began;
}

#define GONE   "the camera has left; plug it in again"
#define THERE  "the camera is there again"
#define SILENT "no frame for 3 s; it is opened anew"
#define NO_FORMAT                                                                                  \
    "it has none of the formats GREY, YUYV, MJPG; `v4l2-ctl --list-formats` shows what it has"
#define NO_JPEG                                                                                    \
    "it sends MJPEG only, and this program was built without libjpeg-turbo; install "              \
    "libjpeg62-turbo-dev and build it again"

// ---------------------------------------------------------------- formats

/// What is agreed on for a wish, by a program that can read JPEG and by one that can not. GREY and
/// YUYV are preferred in that order, but who asks for 30 pictures a second gets them where they
/// are.
static void formats_with_and_without_jpeg(void) {
    enum { GREY = 1, YUYV = 2, MJPG = 4 };
    static const struct {
        unsigned has;
        bool slow; ///< but for MJPG
        uint32_t wish_us;
        enum hal_camera_pixels with, without; ///< 0: refused
        uint32_t with_us, without_us;
    } cases[] = {
        {GREY | YUYV | MJPG, false, 33333, HAL_CAMERA_GREY, HAL_CAMERA_GREY, 33333, 33333},
        {YUYV | MJPG, false, 33333, HAL_CAMERA_YUYV, HAL_CAMERA_YUYV, 33333, 33333},
        {YUYV | MJPG, true, 33333, HAL_CAMERA_MJPEG, HAL_CAMERA_YUYV, 33333, 500000},
        {GREY | MJPG, true, 33333, HAL_CAMERA_MJPEG, HAL_CAMERA_GREY, 33333, 500000},
        {GREY | YUYV | MJPG, true, 33333, HAL_CAMERA_MJPEG, HAL_CAMERA_GREY, 33333, 500000},
        {YUYV | MJPG, true, 100000, HAL_CAMERA_MJPEG, HAL_CAMERA_YUYV, 100000, 500000},
        {YUYV | MJPG, true, 500000, HAL_CAMERA_YUYV, HAL_CAMERA_YUYV, 500000, 500000},
        {YUYV | MJPG, true, 0, HAL_CAMERA_YUYV, HAL_CAMERA_YUYV, 500000, 500000},
        {MJPG, false, 33333, HAL_CAMERA_MJPEG, 0, 33333, 0},
        {MJPG, false, 0, HAL_CAMERA_MJPEG, 0, 100000, 0},
        {YUYV, true, 33333, HAL_CAMERA_YUYV, HAL_CAMERA_YUYV, 500000, 500000},
    };
    const bool reads_jpeg = linux_luma_jpeg_library() != NULL;
    check_note(reads_jpeg ? "with libjpeg-turbo, cases" : "without libjpeg-turbo, cases",
               sizeof cases / sizeof *cases);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct hal_camera_format wish = fast;
        wish.interval_us = cases[i].wish_us;
        const struct camera_feed_settings settings = settings_of(wish);
        const enum hal_camera_pixels pixels = reads_jpeg ? cases[i].with : cases[i].without;
        const uint32_t files = syscalls_open_files();
        v4l2_model_reset();
        v4l2_model_faults.missing = 7U & ~cases[i].has;
        v4l2_model_faults.slow_pixels = cases[i].slow;
        memset(&taken, 0, sizeof taken);
        const enum hal_status status = camera_feed_open(&feed, &settings);
        CHECK_EQ(status, pixels == 0 ? HAL_ERROR_UNSUPPORTED : HAL_OK);
        expect_news(pixels == 0 ? NO_JPEG : NULL);
        if (status == HAL_OK) {
            CHECK_EQ(feed.format.pixels, pixels);
            CHECK_EQ(feed.format.interval_us, reads_jpeg ? cases[i].with_us : cases[i].without_us);
            CHECK(feed.format.width_px == 320U && feed.format.height_px == 240U);
            CHECK(camera_feed_watch(&feed, &loop_));
            frames_come(1);
            CHECK(taken.count == 1U && taken.width_px == 320U);
        } else {
            CHECK(!camera_feed_is_there(&feed));
            CHECK_EQ(syscalls_open_files(), files);
        }
        camera_feed_close(&feed);
        CHECK_EQ(syscalls_open_files(), files);
        CHECK_EQ(watched.fd, -1);
    }
}

static void a_camera_without_formats(void) {
    v4l2_model_reset();
    v4l2_model_faults.missing = 7;
    const struct camera_feed_settings settings = settings_of(fast);
    const uint32_t files = syscalls_open_files();
    CHECK_EQ(camera_feed_open(&feed, &settings), HAL_ERROR_UNSUPPORTED);
    expect_news(NO_FORMAT);
    CHECK_EQ(syscalls_open_files(), files);
    camera_feed_close(&feed);
}

// ---------------------------------------------------------------- frames

static void expect_counts(uint64_t frames, uint64_t lost, uint64_t late, uint64_t damaged) {
    CHECK_EQ(feed.frames, frames);
    CHECK_EQ(feed.lost, lost);
    CHECK_EQ(feed.late, late);
    CHECK_EQ(feed.damaged, damaged);
}

/// The model numbers its frames from 5 on, and paints them with their number.
static void frames_are_counted(void) {
    open_feed();
    frames_come(1);
    CHECK(taken.count == 1U && taken.sequence == 0U && taken.pixel == 5U && !taken.damaged);
    expect_counts(1, 0, 0, 0);
    frames_come(3); // that wait together: the newest is handed on
    CHECK(taken.count == 2U && taken.sequence == 3U && taken.pixel == 8U);
    expect_counts(4, 0, 2, 0);
    v4l2_model_faults.lose = 2;
    frames_come(3);
    CHECK(taken.count == 3U && taken.sequence == 6U && taken.pixel == 11U);
    expect_counts(5, 2, 2, 0);
    v4l2_model_faults.flag = 1; // handed on all the same
    frames_come(1);
    CHECK(taken.count == 4U && taken.pixel == 12U && taken.damaged);
    expect_counts(6, 2, 2, 1);
    frames_come(0);
    CHECK_EQ(taken.count, 4);
    expect_counts(6, 2, 2, 1);
    CHECK_EQ(feed.failures, 0);
    v4l2_model_faults.empty = 1;
    frames_come(1);
    CHECK_EQ(taken.count, 4);
    CHECK_EQ(feed.failures, 1);
    frames_come(2);
    CHECK(taken.count == 5U && taken.pixel == 15U);
    expect_counts(8, 3, 3, 1); // the one without a picture was never there
    CHECK_EQ(v4l2_model_queued(), LINUX_CAMERA_BUFFERS);

    // The kernel does not take a frame back: one buffer fewer, and the stream goes on.
    fake_clock_advance(&clock_, feed.format.interval_us);
    syscalls_at(2, SYSCALLS_FAIL, EIO);
    watched.ready(watched.context);
    CHECK_EQ(taken.count, 6);
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(feed.failures, 2);
    frames_come(1);
    CHECK(taken.count == 7U && taken.pixel == 17U);
    expect_news(NULL);
    camera_feed_close(&feed);
}

// ---------------------------------------------------------------- leaving

/// The next attempt comes at once, then twice a second; what is told is told once.
static void a_camera_leaves_and_returns(void) {
    const uint32_t files = syscalls_open_files();
    open_feed();
    frames_come(2);
    v4l2_model_unplug();
    frames_come(1);
    expect_news(GONE);
    CHECK(!camera_feed_is_there(&feed) && watched.fd == -1);
    CHECK(tick(1000));
    for (int times = 0; times < 3; times++) {
        CHECK(!tick(1000));
        CHECK(!tick(498999));
        CHECK(tick(1));
    }
    CHECK_EQ(syscalls_open_files(), files);
    expect_news(NULL);
    CHECK_EQ(feed.returns, 0);

    v4l2_model_reset();
    CHECK(!tick(499999) && !camera_feed_is_there(&feed));
    CHECK(tick(1) && !camera_feed_is_there(&feed)); // the loop takes it at the next tick
    CHECK(!tick(1000) && camera_feed_is_there(&feed));
    expect_news(THERE);
    CHECK_EQ(watched.fd, feed.camera.fd);
    CHECK_EQ(feed.returns, 1);
    frames_come(2);
    CHECK(taken.count == 2U && taken.sequence == 1U); // it counts anew, and nothing was lost
    expect_counts(4, 0, 2, 0);
    v4l2_model_unplug(); // so soon after an attempt: at once all the same
    frames_come(1);
    expect_news(GONE);
    CHECK(tick(1000));
    camera_feed_close(&feed);
    CHECK_EQ(syscalls_open_files(), files);
}

/// From the beginning in the background: the person hears once why it is not there.
static void a_camera_that_comes_later(void) {
    const struct camera_feed_settings settings = settings_of(fast);
    const uint32_t files = syscalls_open_files();
    v4l2_model_reset();
    v4l2_model_unplug();
    memset(&taken, 0, sizeof taken);
    camera_feed_open_later(&feed, &settings, &loop_);
    CHECK(!camera_feed_is_there(&feed));
    expect_news(NULL);
    CHECK(tick(1000));
    expect_news(NULL); // the next tick takes what has become of it
    CHECK(!tick(1000));
    expect_news(GONE);
    for (int times = 0; times < 3; times++) {
        CHECK(tick(500000));
        CHECK(!tick(1000));
        expect_news(NULL);
    }
    v4l2_model_reset();
    CHECK(tick(500000));
    CHECK(!tick(1000) && camera_feed_is_there(&feed));
    expect_news(THERE);
    frames_come(1);
    CHECK_EQ(taken.count, 1);
    camera_feed_close(&feed);
    CHECK_EQ(syscalls_open_files(), files);
}

/// 3 s without a frame: it is taken for hung and opened anew, again and again, and told once.
static void a_camera_falls_silent(void) {
    open_feed();
    loop_us += 1000000;
    frames_come(1);
    CHECK(!tick(3000000) && camera_feed_is_there(&feed));
    loop_us -= 3000001;
    camera_feed_tick(&feed, loop_us); // a frame may be newer than the tick
    CHECK(camera_feed_is_there(&feed));
    loop_us += 3000001;
    for (unsigned times = 1; times <= 3U; times++) {
        CHECK(tick(1)); // let go of, and opened anew in the background
        expect_news(times == 1U ? SILENT : NULL);
        CHECK_EQ(feed.silences, times);
        CHECK(!camera_feed_is_there(&feed) && watched.fd == -1);
        CHECK(!tick(0) && camera_feed_is_there(&feed));
        expect_news(NULL);
        CHECK_EQ(feed.returns, times);
        CHECK(!tick(3000000) && camera_feed_is_there(&feed));
    }
    frames_come(1);
    expect_news("frames come again");
    CHECK_EQ(taken.count, 2);
    frames_come(1);
    expect_news(NULL);
    CHECK(!tick(3000000) && camera_feed_is_there(&feed));
    CHECK(tick(1));
    expect_news(SILENT);
    camera_feed_close(&feed);
}

/// A camera of two pictures a second has ten intervals.
static void a_slow_camera_has_longer(void) {
    const struct camera_feed_settings settings = settings_of(fast);
    v4l2_model_reset();
    v4l2_model_faults.missing = 4;
    v4l2_model_faults.slow_pixels = true;
    CHECK_EQ(camera_feed_open(&feed, &settings), HAL_OK);
    CHECK(camera_feed_watch(&feed, &loop_));
    CHECK(!tick(5000000) && camera_feed_is_there(&feed));
    CHECK(tick(1));
    expect_news("no frame for 5 s; it is opened anew");
    camera_feed_close(&feed);
}

/// A loop that has no room for one more: it is let go of and tried again.
static void a_loop_without_room(void) {
    open_feed();
    v4l2_model_unplug();
    frames_come(1);
    expect_news(GONE);
    v4l2_model_reset();
    CHECK(tick(1000));
    watched.full = true;
    CHECK(!tick(1000) && !camera_feed_is_there(&feed));
    feed.news[0] = '\0';
    watched.full = false;
    CHECK(tick(500000));
    CHECK(!tick(1000) && camera_feed_is_there(&feed));
    expect_news(THERE);
    frames_come(1);
    camera_feed_close(&feed);
}

/// The first attempt is the one that succeeds; it leaves, which is told once.
static void a_camera_that_is_there_at_once(void) {
    const struct camera_feed_settings settings = settings_of(fast);
    v4l2_model_reset();
    camera_feed_open_later(&feed, &settings, &loop_);
    CHECK(tick(1000));
    CHECK(!tick(1000) && camera_feed_is_there(&feed));
    expect_news(THERE);
    v4l2_model_unplug();
    frames_come(1);
    expect_news(GONE);
    for (int times = 0; times < 3; times++) {
        CHECK(tick(500000));
        CHECK(!tick(1000));
        expect_news(NULL);
    }
    camera_feed_close(&feed);
}

/// The loop lets go of it before it is closed, at rest or while it is being opened.
static void closing_waits(void) {
    const uint32_t files = syscalls_open_files();
    open_feed();
    camera_feed_unwatch(&feed);
    CHECK_EQ(watched.fd, -1);
    camera_feed_close(&feed);
    CHECK_EQ(syscalls_open_files(), files);
    for (int times = 0; times < 20; times++) {
        const struct camera_feed_settings settings = settings_of(fast);
        camera_feed_open_later(&feed, &settings, &loop_);
        camera_feed_tick(&feed, loop_us);
        camera_feed_unwatch(&feed);
        camera_feed_close(&feed);
        CHECK_EQ(syscalls_open_files(), files);
    }
}

/// Let go of in the background, whatever it was doing.
static void it_ends_in_the_background(void) {
    const uint32_t files = syscalls_open_files();
    for (unsigned moment = 0; moment < 3U; moment++) {
        open_feed();
        if (moment > 0U) {
            v4l2_model_unplug();
            frames_come(1);
            CHECK(tick(1000)); // and is away
        }
        if (moment > 1U) {
            v4l2_model_reset();
            CHECK(tick(500000)); // has been opened, and nobody has taken it yet
        }
        unsigned calls = 0;
        while (!camera_feed_end(&feed) && calls < 300000U) {
            calls++;
            usleep(100);
        }
        CHECK(calls > 0U && calls < 300000U);
        CHECK(watched.fd == -1 && !camera_feed_is_there(&feed));
        CHECK_EQ(syscalls_open_files(), files);
        CHECK(camera_feed_end(&feed));
        camera_feed_close(&feed);
    }
}

int main(void) {
    fake_clock_init(&clock_, UINT32_MAX - 200000U);
    loop_us = 77000000;
    path = v4l2_model_plug(&clock_.hal);
    TEST(formats_with_and_without_jpeg);
    TEST(a_camera_without_formats);
    TEST(frames_are_counted);
    TEST(a_camera_leaves_and_returns);
    TEST(a_camera_that_comes_later);
    TEST(a_camera_falls_silent);
    TEST(a_slow_camera_has_longer);
    TEST(a_loop_without_room);
    TEST(a_camera_that_is_there_at_once);
    TEST(closing_waits);
    TEST(it_ends_in_the_background);
    (void)unlink(path);
    return check_finish();
}
