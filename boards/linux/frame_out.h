/// Where `boresight sim --frames PATH` puts what the simulated camera sees: binary PGM pictures.
///
/// A pipe that stands at PATH gets one after the other, as `boresight detect -` and converters of
/// films read them; a picture that begins while the reader has not taken the one before is dropped,
/// and none is cut off. As long as nobody reads, all are. Otherwise PATH is a file that always
/// holds the newest, whole: each takes the place of the one before. Never blocks on a pipe. Shown:
/// tests/scenario/test_frame_out.c, tests/vm/guest/loop.sh.
#ifndef LINUX_FRAME_OUT_H
#define LINUX_FRAME_OUT_H

#include "fixed/must_check.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct frame_out {
    uint8_t *picture; ///< width_px * height_px of brightness, row by row: draw here, then send
    uint32_t width_px, height_px;
    uint64_t written, dropped;

    // Private from here on.
    const char *path;
    bool is_pipe;
    int fd; ///< of the pipe's reader; -1: nobody reads
    uint8_t *bytes;
    size_t size, sent; ///< of the picture that is under way
};

/// False: told on stderr; close it all the same. Must be the only user of its path.
bool frame_out_open(struct frame_out *out, const char *path, uint32_t width_px,
                    uint32_t height_px) MUST_CHECK;
void frame_out_close(struct frame_out *out);

/// The picture as it stands now, with a line of text (without line ends) as its comment. False: the
/// file can't be written; errno tells.
bool frame_out_send(struct frame_out *out, const char *comment) MUST_CHECK;
/// Goes on with what the pipe had no room for. At every tick.
void frame_out_tick(struct frame_out *out);

#endif
