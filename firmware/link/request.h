/// What a line asks of the board: the words of a person and of a program, read into values.
///
/// Shown: tests/unit/test_request.c.
#ifndef LINK_REQUEST_H
#define LINK_REQUEST_H

#include "aim/framing.h"
#include "aim/pan.h"
#include "fixed/must_check.h"
#include "link/words.h"
#include "target/target_set.h"

#include <stdbool.h>
#include <stdint.h>

enum request_kind {
    REQUEST_HELP,
    REQUEST_STATUS,
    REQUEST_ARM,
    REQUEST_STOP,
    REQUEST_HOME,
    REQUEST_AIM,    ///< update: a direction that takes the place of all targets
    REQUEST_UPDATE, ///< update: of one target
    REQUEST_GET,    ///< name: of a setting; empty: all of them
    REQUEST_SET,    ///< name, value_micro
    REQUEST_TRACE,  ///< on, period_ms
    REQUEST_SCENE,  ///< update.position_um: where to see the scene from
    REQUEST_PAN     ///< choice, duration_us, path
};

/// The target that `aim` and `home` set. No other target may have this number.
#define REQUEST_AIM_ID UINT32_MAX

/// A period of `trace`.
#define REQUEST_TRACE_MS_MIN     10U
#define REQUEST_TRACE_MS_MAX     60000U
#define REQUEST_TRACE_MS_DEFAULT 1000U

/// A setting's value: any number up to a million, with six places.
#define REQUEST_VALUE_MICRO_MAX INT64_C(1000000000000)

struct request {
    enum request_kind kind;
    struct target_update update;
    struct word name; ///< a part of the line that was read
    int64_t value_micro;
    bool on;
    uint32_t period_ms;
    struct framing_choice choice;
    uint32_t duration_us;
    enum pan_path path;
};

/// The longest pan: an hour.
#define REQUEST_PAN_US_MAX INT64_C(3600000000)

/// Reads a command: `aim 30 10`. text: without the end of the line.
/// Returns: NULL, or what was expected instead: one line, without an end.
const char *request_read(const char *text, uint32_t size_bytes, struct request *request) MUST_CHECK;

/// Reads one target of a list: `7 1.5 2 0.25`, `8 dir .1 1 .2`, `9 gone`.
/// Returns: NULL, or what was expected instead.
const char *request_read_target(const char *text, uint32_t size_bytes,
                                struct target_update *update) MUST_CHECK;

/// The update that looks at this pan and tilt in the world (bam32), framing that half-angle.
struct target_update request_aim(bam32_t pan, bam32_t tilt, uint32_t radius_bam32);

/// Line `index` of the list of commands; NULL behind the last.
const char *request_help(uint32_t index);

#endif
