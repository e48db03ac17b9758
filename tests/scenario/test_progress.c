/// Progress as a terminal shows it: the test holds the other end of a pseudo-terminal and keeps the
/// screen.
#include "check.h"
#include "view/progress.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { WIDTH = 60, ROW_COUNT = 20 };

/// What stands on the screen. Knows what the program may use: \r, \n and erase to the end of line.
struct screen {
    char line[ROW_COUNT][WIDTH * 4];
    int row, column, widest;
    bool odd; ///< something else came, or far too much
};

static void screen_take(struct screen *screen, const char *text) {
    for (const char *at = text; *at != '\0'; at++) {
        char *line = screen->line[screen->row];
        if (*at == '\r') {
            screen->column = 0;
        } else if (*at == '\n') {
            screen->row = screen->row + 1 < ROW_COUNT ? screen->row + 1 : screen->row;
        } else if (strncmp(at, "\033[K", 3) == 0) {
            line[screen->column] = '\0';
            at += 2;
        } else if ((unsigned char)*at < 0x20 || screen->column >= WIDTH * 4 - 1) {
            screen->odd = true;
        } else {
            bool at_end = line[screen->column] == '\0';
            line[screen->column++] = *at;
            line[screen->column] = at_end ? '\0' : line[screen->column];
            screen->widest = screen->column > screen->widest ? screen->column : screen->widest;
        }
    }
}

static int controller = -1;
static FILE *terminal;

static bool open_terminal(void) {
    controller = posix_openpt(O_RDWR | O_NOCTTY);
    if (controller < 0 || grantpt(controller) != 0 || unlockpt(controller) != 0) {
        return false;
    }
    struct winsize size = {.ws_row = 24, .ws_col = WIDTH};
    terminal = fopen(ptsname(controller), "r+");
    return terminal != NULL && ioctl(controller, TIOCSWINSZ, &size) == 0;
}

/// Lets the screen take all that was written so far. It travels through the kernel in its own time,
/// so a bell goes behind it.
static void show(struct screen *screen) {
    fputs("\a", terminal);
    fflush(terminal);
    struct pollfd ready = {.fd = controller, .events = POLLIN};
    char text[4096] = "";
    size_t size = 0;
    while (strchr(text, '\a') == NULL) {
        bool more = size + 1 < sizeof text && poll(&ready, 1, 10000) == 1;
        ssize_t got = more ? read(controller, text + size, sizeof text - 1 - size) : -1;
        if (!CHECK(got > 0)) {
            return;
        }
        size += (size_t)got;
        text[size] = '\0';
    }
    *strchr(text, '\a') = '\0';
    screen_take(screen, text);
}

static const struct progress_subject orion = {"Ori", 23, "stars", 12.34, -45.6,
                                              13.2,  12, 1.2,     0.004};

static void a_status_line_is_written_over_and_goes(void) {
    struct screen screen = {0};
    struct progress progress;
    progress_start(&progress, terminal, terminal);
    progress_status(&progress, 0.25, "a text that is far too long for what is left of the line");
    show(&screen);
    CHECK(strncmp(screen.line[0], "[######------------------]  25 %  a text", 40) == 0);
    CHECK_EQ(strlen(screen.line[0]), WIDTH - 1);
    progress.shown_ms += 3600000; // the clock is the machine's; the test moves the other end
    progress_status(&progress, 0.5, "too soon");
    show(&screen);
    CHECK(strstr(screen.line[0], "25 %") != NULL);
    progress.shown_ms -= 3600000 + 101;
    progress_status(&progress, 1, "short");
    show(&screen);
    CHECK(strcmp(screen.line[0], "[########################] 100 %  short") == 0);
    progress_line(&progress, "a line that stays");
    progress_status(&progress, -1, "no bar");
    show(&screen);
    CHECK(strcmp(screen.line[0], "a line that stays") == 0);
    CHECK(strcmp(screen.line[1], "no bar") == 0);
    progress_end(&progress);
    progress_end(&progress);
    show(&screen);
    CHECK(strcmp(screen.line[1], "") == 0);
    CHECK(screen.row == 1 && screen.column == 0 && !screen.odd);
    CHECK_EQ(screen.widest, WIDTH - 1);
}

static void a_narrow_terminal_is_not_overrun(void) {
    for (unsigned short columns = 1; columns < 40; columns++) {
        struct winsize size = {.ws_row = 24, .ws_col = columns};
        struct screen screen = {0};
        struct progress progress;
        CHECK(ioctl(controller, TIOCSWINSZ, &size) == 0);
        progress_start(&progress, terminal, terminal);
        progress_status(&progress, 0.5, "a text that is far too long for such a terminal");
        progress_end(&progress);
        show(&screen);
        CHECK(screen.widest < columns && !screen.odd);
    }
    struct winsize size = {.ws_row = 24, .ws_col = WIDTH};
    CHECK(ioctl(controller, TIOCSWINSZ, &size) == 0);
}

static void without_a_terminal_only_lines_come(void) {
    char text[1000] = "";
    FILE *file = fmemopen(text, sizeof text, "w");
    int ends[2];
    CHECK(pipe(ends) == 0);
    FILE *no_terminal = fdopen(ends[1], "w");
    struct screen screen = {0};
    struct progress progress;
    progress_start(&progress, file, no_terminal);
    progress.name_columns = 5;
    progress_status(&progress, 0.5, "not shown");
    progress_subject(&progress, &orion);
    progress_line(&progress, "done");
    progress_end(&progress);
    CHECK(strcmp(text, "Ori     23 stars  pan   12.3  tilt -45.6  half-angle 13.2 deg  f  12.0 mm  "
                       "settled in  1.2 s  error 0.0040 deg\ndone\n") == 0);
    setenv("TERM", "dumb", 1);
    progress_start(&progress, file, terminal);
    progress_status(&progress, 0.5, "not shown");
    progress_end(&progress);
    setenv("TERM", "xterm", 1);
    show(&screen);
    CHECK(screen.widest == 0);
    fclose(file);
    fclose(no_terminal);
    CHECK_EQ(read(ends[0], text, 1), 0); // nothing, and its end
    close(ends[0]);
}

static void what_is_not_known_is_not_said(void) {
    char text[1000] = "";
    FILE *file = fmemopen(text, sizeof text, "w");
    struct progress progress;
    progress_start(&progress, file, NULL);
    progress_subject(&progress, &(struct progress_subject){"x", 0, "people", 0, 0, 0, 0, -1, -1});
    CHECK(strstr(text, "not settled") != NULL);
    CHECK(strstr(text, " f ") == NULL && strstr(text, "error") == NULL);
    fclose(file);
}

static void names_cannot_steer_the_terminal(void) {
    char text[1000] = "";
    FILE *file = fmemopen(text, sizeof text, "w");
    struct progress progress;
    progress_start(&progress, file, NULL);
    progress_line(&progress, "\033[2Ja\r\nb\x7F \xC2\x9B \x9B \xC3\xA9 \xE2\x82");
    CHECK(strcmp(text, "?[2Ja??b? ? ? \xC3\xA9 ??\n") == 0);
    fclose(file);
}

int main(void) {
    setenv("TERM", "xterm", 1);
    if (!open_terminal()) {
        printf("FAIL progress cannot open a pseudo-terminal\n");
        return 1;
    }
    TEST(a_status_line_is_written_over_and_goes);
    TEST(a_narrow_terminal_is_not_overrun);
    TEST(without_a_terminal_only_lines_come);
    TEST(what_is_not_known_is_not_said);
    TEST(names_cannot_steer_the_terminal);
    fclose(terminal);
    close(controller);
    return check_finish();
}
