/// A board for the tests of `boresight run`: app/board_loop with the settings of a rig file, on a
/// pseudo-terminal, in real time. Its servos and lines are those of the tests' desk: only numbers.
///
/// Usage: pty_board RIG.ini LINK board|silent|chatter|ANSWER
/// LINK becomes a symbolic link to the terminal. ANSWER: what to answer to every hello. Ends after
/// two minutes at the latest. SIGUSR1: the emergency stop is pressed. SIGUSR2: the board is reset.
#include "rig.h"
#include "unit/desk.h"

#include "app/settings_digest.h"
#include "link/line_splitter.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

enum { TICKS_MAX = 120000 };

static volatile sig_atomic_t pressed, reset;
static int terminal;

static void on_signal(int number) {
    if (number == SIGUSR1) {
        pressed = 1;
    } else {
        reset = 1;
    }
}

// ---------------------------------------------------------------- devices

static enum hal_status serial_write(void *ctx, const uint8_t *data, size_t size, size_t *written) {
    (void)ctx;
    const ssize_t count = write(terminal, data, size);
    *written = count > 0 ? (size_t)count : 0U;
    return count > 0 ? HAL_OK : HAL_BUSY;
}

static enum hal_status serial_read(void *ctx, uint8_t *data, size_t capacity, size_t *read_bytes) {
    (void)ctx;
    const ssize_t count = read(terminal, data, capacity);
    *read_bytes = count > 0 ? (size_t)count : 0U;
    return count > 0 ? HAL_OK : HAL_EMPTY;
}

static enum hal_status serial_state(void *ctx, struct hal_serial_state *state) {
    (void)ctx;
    *state = (struct hal_serial_state){0, 0};
    return HAL_OK;
}

static const struct hal_serial_ops serial_ops = {serial_write, serial_read, serial_state};
static const struct hal_serial serial = {&serial_ops, NULL};
static const char *const notes[] = {"board: pty", NULL};

// ---------------------------------------------------------------- what it does in a tick

static void answer_hello(const char *answer) {
    static struct line_splitter splitter;
    uint8_t bytes[64];
    size_t count, written;
    if (serial_read(NULL, bytes, sizeof bytes, &count) != HAL_OK) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        if (line_splitter_take(&splitter, bytes[i]) == LINE_SPLITTER_LINE &&
            splitter.line.type == 'h') {
            char buffer[CHECKED_LINE_BYTES_MAX];
            struct text text;
            text_begin(&text, buffer, sizeof buffer);
            checked_line_begin(&text, splitter.line.host, splitter.line.sequence, 'H');
            text_string(&text, answer);
            if (checked_line_end(&text)) {
                (void)serial_write(NULL, (const uint8_t *)buffer, text.size_bytes, &written);
            }
        }
    }
}

static void tick(const char *mode, uint32_t number) {
    static const char chatter[] = "NMEA $GPGGA,,*00 or whatever\r\n";
    size_t written;
    desk.now_us += 1000U;
    desk.pressed = pressed != 0;
    if (strcmp(mode, "board") == 0) {
        board_loop_tick(&desk_loop, 0);
    } else if (strcmp(mode, "chatter") == 0) {
        if (number % 100U == 0U) {
            (void)serial_write(NULL, (const uint8_t *)chatter, sizeof chatter - 1U, &written);
        }
    } else if (strcmp(mode, "silent") != 0) {
        answer_hello(mode);
    }
}

// ---------------------------------------------------------------- set-up

static bool open_terminal(const char *link) {
    struct termios settings;
    terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) {
        return false;
    }
    const char *name = ptsname(terminal);
    const int other_end = open(name, O_RDWR | O_NOCTTY); // stays open: no hang-up between programs
    if (other_end < 0 || tcgetattr(other_end, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    (void)unlink(link);
    return tcsetattr(other_end, TCSANOW, &settings) == 0 && symlink(name, link) == 0;
}

static void start_board(const struct controller_config *settings) {
    desk_config = (struct board_config){settings, desk_stop_lines, 1, DESK_LINES, notes, NULL};
    const struct board_devices devices = {
        {&desk_clock, NULL, &desk_pwm}, &desk_gpio, &serial, &desk_watchdog};
    board_loop_init(&desk_loop, &desk_config, &devices);
}

int main(int argc, char **argv) {
    static struct rig rig;
    if (argc != 4 || rig_read(argv[1], 0, &rig) != EXIT_STATUS_OK) {
        fprintf(stderr, "usage: pty_board RIG.ini LINK board|silent|chatter|ANSWER\n");
        return 2;
    }
    const struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGUSR1, &action, NULL);
    sigaction(SIGUSR2, &action, NULL);
    rig.controller.arm_on_start = false;
    start_board(&rig.controller);
    if (!open_terminal(argv[2])) {
        fprintf(stderr, "pty_board: %s: %s\n", argv[2], strerror(errno));
        return 1;
    }
    struct timespec due;
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (uint32_t number = 0; number < TICKS_MAX; number++) {
        due.tv_nsec += 1000000;
        due.tv_sec += due.tv_nsec / 1000000000;
        due.tv_nsec %= 1000000000;
        (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
        if (reset != 0) {
            reset = 0;
            start_board(&rig.controller);
        }
        tick(argv[3], number);
    }
    (void)unlink(argv[2]);
    rig_free(&rig);
    return 0;
}
