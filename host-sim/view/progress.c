#include "view/progress.h"

#include "view/markup.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define STATUS_EVERY_MS 100
#define BAR_COLUMNS     24
#define BAR_ALL_COLUMNS (BAR_COLUMNS + 10) ///< with its brackets, its number and the blanks

static int64_t now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/// Columns of the terminal; it may be resized while we run.
static int width_of(FILE *terminal) {
    struct winsize size;
    if (ioctl(fileno(terminal), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        return size.ws_col;
    }
    return 80;
}

/// Writes at most so many characters of a text and returns how many they were.
static int put_text(FILE *out, const char *text, int character_max) {
    int written = 0;
    while (*text != '\0' && written < character_max) {
        size_t bytes = markup_character_bytes(text);
        unsigned char first = (unsigned char)text[0];
        // Some terminals obey U+0080 to U+009F, too.
        bool control = first < 0x20 || first == 0x7F ||
                       (bytes == 2 && first == 0xC2 && (unsigned char)text[1] < 0xA0);
        if (bytes == 0 || control) {
            fputc('?', out);
        } else {
            fwrite(text, 1, bytes, out);
        }
        text += bytes == 0 ? 1 : bytes;
        written++;
    }
    return written;
}

void progress_start(struct progress *progress, FILE *lines, FILE *live) {
    const char *terminal = getenv("TERM");
    bool can_erase = terminal != NULL && terminal[0] != '\0' && strcmp(terminal, "dumb") != 0;
    *progress = (struct progress){.lines = lines};
    if (live != NULL && can_erase && isatty(fileno(live))) {
        progress->live = live;
    }
}

static void erase(struct progress *progress) {
    if (progress->shown) {
        fputs("\r\033[K", progress->live);
        fflush(progress->live);
        progress->shown = false;
    }
}

void progress_status(struct progress *progress, double done, const char *text) {
    if (progress->live == NULL) {
        return;
    }
    int64_t now = now_ms();
    if (progress->shown && now - progress->shown_ms < STATUS_EVERY_MS) {
        return;
    }
    // One column stays free: a terminal whose last column is full may go to the next line.
    int left = width_of(progress->live) - 1;
    fputc('\r', progress->live);
    if (done >= 0 && left >= BAR_ALL_COLUMNS) {
        char bar[BAR_COLUMNS + 1];
        double share = done < 1 ? done : 1;
        int full = (int)(share * BAR_COLUMNS);
        memset(bar, '-', BAR_COLUMNS);
        memset(bar, '#', (size_t)full);
        bar[BAR_COLUMNS] = '\0';
        left -= fprintf(progress->live, "[%s] %3d %%  ", bar, (int)(share * 100));
    }
    put_text(progress->live, text, left > 0 ? left : 0);
    fputs("\033[K", progress->live);
    fflush(progress->live);
    progress->shown = true;
    progress->shown_ms = now;
}

void progress_subject(struct progress *progress, const struct progress_subject *subject) {
    FILE *out = progress->lines;
    erase(progress);
    int used = put_text(out, subject->name, 60);
    int pad = progress->name_columns > used ? progress->name_columns - used : 0;
    fprintf(out, "%*s  %3zu ", pad, "", subject->count);
    put_text(out, subject->noun, 30);
    fprintf(out, "  pan %6.1f  tilt %5.1f  half-angle %4.1f deg", subject->pan_deg,
            subject->tilt_deg, subject->half_angle_deg);
    if (subject->focal_mm > 0) {
        fprintf(out, "  f %5.1f mm", subject->focal_mm);
    }
    if (subject->settled_s >= 0) {
        fprintf(out, "  settled in %4.1f s", subject->settled_s);
    } else {
        fprintf(out, "  not settled      ");
    }
    if (subject->error_deg >= 0) {
        fprintf(out, "  error %.4f deg", subject->error_deg);
    }
    fputc('\n', out);
    fflush(out);
}

void progress_line(struct progress *progress, const char *text) {
    erase(progress);
    put_text(progress->lines, text, 1000);
    fputc('\n', progress->lines);
    fflush(progress->lines);
}

void progress_end(struct progress *progress) {
    erase(progress);
}
