/// A program's end of the line to a board: checked lines out and in (docs/link.md).
///
/// Does no waiting of its own: call board_link_poll every millisecond or so. It says hello, asks
/// for the time ten times a second (which also tells the board that we are still here), sends
/// commands until they are answered, and writes no faster than the line carries, so that little
/// waits in buffers that nobody can take back. A stop drops what waits. Shown:
/// tests/scenario/test_board_link.c.
#ifndef LINUX_BOARD_LINK_H
#define LINUX_BOARD_LINK_H

#include "board_clock.h"

#include "control/controller.h"
#include "hal/serial.h"
#include "link/line_splitter.h"

#include <stdbool.h>
#include <stdint.h>

#define BOARD_LINK_OUT_BYTES   4096U
#define BOARD_LINK_PING_US     100000U
#define BOARD_LINK_RETRY_US    100000U
#define BOARD_LINK_SILENCE_US  1000000U
#define BOARD_LINK_TRIES_MAX   10U
#define BOARD_LINK_ANSWER_SIZE (CHECKED_LINE_BYTES_MAX + 1U)

/// Who answered a hello.
struct board_link_identity {
    bool known, busy; ///< busy: another program has the board
    uint32_t version, digest;
    char build[80];
};

/// As the board last told it; angles in thousandths of a degree.
struct board_link_status {
    uint64_t board_us;
    enum controller_mode mode;
    uint32_t faults;
    int32_t setpoint_mdeg[2], goal_mdeg[2], measured_mdeg[2];
    bool measured[2];
    uint32_t focal_um, targets, rejected, taken, damaged, stale, repeated, refused;
    char held[CHECKED_LINE_BYTES_MAX];
};

/// Whether the board is still there for us. LET_GO: it answers, but for BOARD_LINK_SILENCE_US it
/// has not told us its state, which its owner gets 20 times a second.
enum board_link_presence { BOARD_LINK_THERE, BOARD_LINK_SILENT, BOARD_LINK_LET_GO };

enum board_link_command { BOARD_LINK_IDLE, BOARD_LINK_WAITS, BOARD_LINK_ANSWERED, BOARD_LINK_LOST };

struct board_link {
    const struct hal_serial *serial;
    uint8_t host;
    bool gone; ///< the device has left
    struct board_clock clock;
    struct board_link_identity identity;
    struct board_link_status status;
    uint32_t status_count;
    uint64_t heard_us;       ///< a good line
    uint64_t told_us;        ///< a status: only the owner of the board gets them
    uint64_t gap_us_max;     ///< longest time between two of them
    uint64_t bytes_received; ///< of any kind
    uint32_t lines_sent, target_lines_sent;
    // A command.
    enum board_link_command command;
    bool refused;
    char answer[BOARD_LINK_ANSWER_SIZE]; ///< behind `ok` or `no`
    // Private from here on.
    bool says_hello;
    uint64_t hello_us, ping_us, command_us;
    /// Each kind of line counts for itself: the board compares with the last one of the kind.
    uint8_t question_sequence, ping_sequence, command_sequence, targets_sequence;
    bool ping_waits;
    uint32_t command_tries;
    char command_text[BOARD_LINK_ANSWER_SIZE];
    struct line_splitter splitter;
    uint32_t bytes_a_second;
    uint64_t paced_us, allowed_ub; ///< millionths of a byte
    uint32_t out_count;
    uint8_t out[BOARD_LINK_OUT_BYTES];
};

/// host: any number; two programs on one line need different ones.
void board_link_init(struct board_link *link, const struct hal_serial *serial, uint32_t baud,
                     uint8_t host, uint64_t now_us);

/// Reads, asks, repeats, writes.
void board_link_poll(struct board_link *link, uint64_t now_us);

/// Says hello until it is answered (identity.known or identity.busy).
void board_link_hello(struct board_link *link);

/// Sends a command: link->command tells how it goes. A `stop` goes first and takes the place of a
/// command that waits.
void board_link_order(struct board_link *link, const char *text, uint64_t now_us);

/// Queues a line of targets (type t or d). False: no room now.
bool board_link_send_targets(struct board_link *link, char type, const struct text *body);

/// Before the first status of a run, set told_us to its start.
enum board_link_presence board_link_presence(const struct board_link *link, uint64_t now_us);

/// How many bytes of lines still wait to be written.
uint32_t board_link_waiting(const struct board_link *link);

/// The stamp for lines of targets that hold at our time now_us: four characters.
void board_link_stamp(const struct board_link *link, uint64_t now_us, struct text *text);

/// Leaves: the board stops and forgets its targets.
void board_link_bye(struct board_link *link);

#endif
