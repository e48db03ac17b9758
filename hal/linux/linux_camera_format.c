#include "linux/linux_camera_format.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>

/// Of devices that don't say how fast they are.
#define INTERVAL_US_UNKNOWN 33333U

/// In the order in which they are preferred; enum hal_camera_pixels counts from 1.
static const uint32_t fourcc[] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
enum { KINDS = sizeof fourcc / sizeof *fourcc };

static unsigned kind_of(uint32_t pixelformat) {
    unsigned kind = 0;
    while (kind < KINDS && fourcc[kind] != pixelformat) {
        kind++;
    }
    if (kind == KINDS && pixelformat == V4L2_PIX_FMT_JPEG) {
        return HAL_CAMERA_MJPEG - 1;
    }
    return kind;
}

// ---------------------------------------------------------------- trying one

static bool is_sound(const struct hal_camera_format *format) {
    const uint64_t line = (uint64_t)format->width_px * (format->pixels == HAL_CAMERA_YUYV ? 2 : 1);
    if (format->width_px == 0U || format->height_px == 0U || format->frame_bytes_max == 0U) {
        return false;
    }
    if (format->pixels == HAL_CAMERA_MJPEG) {
        return true;
    }
    return (format->pixels != HAL_CAMERA_YUYV || format->width_px % 2U == 0U) &&
           format->stride_bytes >= line &&
           format->frame_bytes_max >= (uint64_t)format->stride_bytes * format->height_px;
}

/// Whether a request failed because the device has nothing of that kind.
static bool has_none(void) {
    return errno == EINVAL || errno == ENOTTY;
}

/// The interval that the device will keep; asks for one first, unless it doesn't matter. 0: errno.
static uint32_t agree_interval(int fd, uint32_t wish_us) {
    struct v4l2_streamparm parameters = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    const struct v4l2_fract *const got = &parameters.parm.capture.timeperframe;
    if (wish_us != 0U) {
        parameters.parm.capture.timeperframe = (struct v4l2_fract){wish_us, 1000000};
        if (ioctl(fd, VIDIOC_S_PARM, &parameters) != 0) {
            if (!has_none()) {
                return 0;
            }
            wish_us = 0;
        }
    }
    if (wish_us == 0U && ioctl(fd, VIDIOC_G_PARM, &parameters) != 0) {
        return has_none() ? INTERVAL_US_UNKNOWN : 0U;
    }
    if (got->numerator == 0U || got->denominator == 0U) {
        return INTERVAL_US_UNKNOWN;
    }
    const uint64_t us =
        ((uint64_t)got->numerator * 1000000U + got->denominator / 2U) / got->denominator;
    return us < 1U ? 1U : us > UINT32_MAX ? UINT32_MAX : (uint32_t)us;
}

/// Sets it and tells what came of it. false: errno, 0 if the device wants something else.
static bool try_kind(int fd, unsigned kind, const struct hal_camera_format *wish,
                     struct hal_camera_format *got) {
    struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
    struct v4l2_pix_format *const picture = &format.fmt.pix;
    if (ioctl(fd, VIDIOC_G_FMT, &format) != 0) {
        return false;
    }
    const uint32_t width_px = wish->width_px != 0U ? wish->width_px : picture->width;
    const uint32_t height_px = wish->height_px != 0U ? wish->height_px : picture->height;
    *picture = (struct v4l2_pix_format){.width = width_px,
                                        .height = height_px,
                                        .pixelformat = fourcc[kind],
                                        .field = V4L2_FIELD_NONE};
    if (ioctl(fd, VIDIOC_S_FMT, &format) != 0) {
        return false;
    }
    *got = (struct hal_camera_format){
        .pixels = (enum hal_camera_pixels)(kind + 1U),
        .width_px = picture->width,
        .height_px = picture->height,
        .stride_bytes = kind + 1U == HAL_CAMERA_MJPEG ? 0U : picture->bytesperline,
        .frame_bytes_max = picture->sizeimage};
    got->interval_us = agree_interval(fd, wish->interval_us);
    if (got->interval_us == 0U) {
        return false;
    }
    errno = 0;
    return kind_of(picture->pixelformat) == kind && is_sound(got);
}

// ---------------------------------------------------------------- choosing

static uint64_t apart(uint32_t a, uint32_t b) {
    return a > b ? a - b : b - a;
}

/// Is a nearer to the wish than b?
static bool is_nearer(const struct hal_camera_format *wish, const struct hal_camera_format *a,
                      const struct hal_camera_format *b) {
    const uint64_t size_a = (wish->width_px == 0U ? 0U : apart(a->width_px, wish->width_px)) +
                            (wish->height_px == 0U ? 0U : apart(a->height_px, wish->height_px));
    const uint64_t size_b = (wish->width_px == 0U ? 0U : apart(b->width_px, wish->width_px)) +
                            (wish->height_px == 0U ? 0U : apart(b->height_px, wish->height_px));
    if (size_a != size_b) {
        return size_a < size_b;
    }
    // A camera that is a few percent off is as good.
    const uint64_t fast_a = apart(a->interval_us, wish->interval_us);
    const uint64_t fast_b = apart(b->interval_us, wish->interval_us);
    return wish->interval_us != 0U && fast_a + wish->interval_us / 20U < fast_b;
}

uint32_t linux_camera_format_list(int fd, uint32_t *width_px, uint32_t *height_px) {
    uint32_t bits = 0;
    *width_px = *height_px = 0;
    int why = EINVAL; // no more, or more than anybody looks at
    for (uint32_t i = 0; i < 64U; i++) {
        struct v4l2_fmtdesc about = {.index = i, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        if (ioctl(fd, VIDIOC_ENUM_FMT, &about) != 0) {
            why = errno;
            break;
        }
        const unsigned kind = kind_of(about.pixelformat);
        if (kind == KINDS) {
            continue;
        }
        bits |= UINT32_C(2) << kind;
        for (uint32_t k = 0; k < 64U; k++) {
            struct v4l2_frmsizeenum size = {.index = k, .pixel_format = about.pixelformat};
            if (ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &size) != 0) {
                break;
            }
            const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
            const uint32_t width = discrete ? size.discrete.width : size.stepwise.max_width;
            const uint32_t height = discrete ? size.discrete.height : size.stepwise.max_height;
            if ((uint64_t)width * height > (uint64_t)*width_px * *height_px) {
                *width_px = width;
                *height_px = height;
            }
        }
    }
    errno = why;
    return bits;
}

enum linux_camera_format_answer linux_camera_format_agree(int fd, struct hal_camera_format *wish) {
    uint32_t ignored_px;
    uint32_t has = linux_camera_format_list(fd, &ignored_px, &ignored_px);
    if (errno != EINVAL) { // which only says that the list has ended
        return LINUX_CAMERA_FORMAT_FAILED;
    }
    const uint32_t wanted = UINT32_C(1) << wish->pixels;
    if (wish->pixels != 0 && (has & wanted) != 0U) {
        has = wanted; // as asked for; any other only where it is missing
    }
    struct hal_camera_format best = {0}, last = {0};
    int why = 0;
    for (unsigned kind = 0; kind < KINDS; kind++) {
        struct hal_camera_format got;
        if ((has & UINT32_C(2) << kind) == 0U) {
            continue;
        }
        if (try_kind(fd, kind, wish, &got)) {
            last = got;
            best = best.width_px == 0U || is_nearer(wish, &got, &best) ? got : best;
        } else if (errno != 0 && errno != EINVAL) {
            return LINUX_CAMERA_FORMAT_FAILED;
        } else {
            why = errno != 0 ? errno : why;
        }
    }
    if (best.width_px == 0U) {
        errno = why;
        return why == 0 ? LINUX_CAMERA_FORMAT_NONE : LINUX_CAMERA_FORMAT_FAILED;
    }
    // Another one was tried after the best.
    if (memcmp(&last, &best, sizeof best) != 0 &&
        !try_kind(fd, (unsigned)best.pixels - 1U, wish, &best)) {
        return errno == 0 ? LINUX_CAMERA_FORMAT_NONE : LINUX_CAMERA_FORMAT_FAILED;
    }
    *wish = best;
    return LINUX_CAMERA_FORMAT_AGREED;
}
