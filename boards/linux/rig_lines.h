/// The digital lines that a rig file names: emergency stop, limit switches, enable.
///
/// In the file a line is CHIP:NUMBER, and behind it what it needs: `low` (active is the low level),
/// `up`, `down` (pull). A normally closed switch to ground is `gpiochip0:17:up`: open, or its wire
/// broken, is active. Presses count after debounce_ms; the emergency stop at once, and its release
/// after that time. A line that can't be read counts as pressed. Lines that are lost are opened
/// again in the background, and belong to it until then.
/// Shown: tests/scenario/test_rig_lines.c, tests/vm/guest/rig.sh.
#ifndef LINUX_RIG_LINES_H
#define LINUX_RIG_LINES_H

#include "message.h"
#include "rig.h"
#include "side_job.h"

#include "linux/linux_gpio.h"

#include <stdbool.h>
#include <stdint.h>

/// A line's level once it has been the same for a while.
struct debounce {
    bool active;
    uint64_t changed_us; ///< since when the reading differs from active; 0: it does not
};

/// press_us, release_us: how long a reading must last. Returns whether it became active now.
bool debounce_update(struct debounce *debounce, bool reading, uint64_t now_us, uint64_t press_us,
                     uint64_t release_us);

enum { RIG_LINES_MAX = 6 };

struct rig_lines {
    struct linux_gpio gpio;
    uint32_t count;
    struct rig_line {
        const char *what; ///< "emergency stop", "pan switch_min", "enable"
        bool output, is_stop;
        struct debounce debounce;
    } line[RIG_LINES_MAX];
    uint64_t debounce_us;
    bool lost; ///< none is touched until all are open again
    struct side_job mending;
    bool mending_begun, mended; ///< the background is opening them; has opened them
    // As opened, to open them again.
    struct hal_gpio_line row[RIG_LINES_MAX];
    struct linux_gpio_pin pin[RIG_LINES_MAX];
    char chip[RIG_LINES_MAX][LINUX_GPIO_NAME_BYTES];
};

/// What the lines ask for.
struct rig_lines_state {
    bool stop;           ///< as long as the emergency stop is pressed
    const char *pressed; ///< a line that was pressed just now; NULL: none
    const char *lost;    ///< for a person, once: a line can't be read; NULL: all can
};

/// Reads CHIP:NUMBER[:low][:up|:down]. chip: at least as long as the text. False: it can't be read.
bool rig_line_parse(const char *text, char *chip, uint32_t *number, struct hal_gpio_line *line);

/// Opens the lines of a rig; none is fine. Returns: EXIT_STATUS_OK; EXIT_STATUS_DEVICE, and
/// lines->gpio.error is the line for the person; EXIT_STATUS_USAGE after a line on stderr.
enum exit_status rig_lines_open(struct rig_lines *lines, const struct rig *rig);
void rig_lines_close(struct rig_lines *lines);

/// Has a line been lost? rig_lines_mend tries to open them all again, in the background, unless it
/// is being tried. What comes of it is taken up by a later rig_lines_read.
bool rig_lines_lost(const struct rig_lines *lines);
void rig_lines_mend(struct rig_lines *lines);

struct rig_lines_state rig_lines_read(struct rig_lines *lines, uint64_t now_us);

/// Sets the enable line, if there is one.
void rig_lines_enable(struct rig_lines *lines, bool active);

#endif
