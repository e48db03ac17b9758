/// The log of `boresight run`: a file line by line, and a disk that is full.
#include "run_log.h"

#include "event_loop.h"
#include "message.h"

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[] = "/tmp/boresight-log-XXXXXX";

/// The last line of the file, without the time in front.
static const char *last_line(void) {
    static char line[8192];
    char next[8192];
    FILE *file = fopen(path, "r");
    line[0] = '\0';
    while (file != NULL && fgets(next, sizeof next, file) != NULL) {
        memcpy(line, next, sizeof line);
    }
    if (file != NULL) {
        fclose(file);
    }
    const char *after = strchr(line, ',');
    return after != NULL && strncmp(line, "{\"t_s\": ", 8) == 0 ? after : line;
}

static void a_line_an_event(void) {
    struct run_log log;
    CHECK(run_log_open(&log, path, event_loop_now_us()));
    run_log_event(&log, false, "mode", "%s %d", "tracking", 7);
    CHECK(strcmp(last_line(), ", \"event\": \"mode\", \"text\": \"tracking 7\"}\n") == 0);
    run_log_event(&log, true, "device", "a \"quoted\" back\\slash and\nnewline\x01");
    CHECK(strcmp(last_line(),
                 ", \"event\": \"device\", \"text\": "
                 "\"a \\\"quoted\\\" back\\\\slash and\\u000anewline\\u0001\"}\n") == 0);
    char giant[5000];
    memset(giant, '"', sizeof giant - 1U);
    giant[sizeof giant - 1U] = '\0';
    run_log_event(&log, true, "mode", "%s", giant); // cut, and still one line
    const char *line = last_line();
    CHECK(strlen(line) > 1000U && line[strlen(line) - 1U] == '\n' &&
          line[strlen(line) - 2U] == '}');
    CHECK_EQ(log.dropped, 0);
    run_log_close(&log);
    CHECK(run_log_open(&log, path, event_loop_now_us())); // appends
    run_log_event(&log, false, "end", "again");
    run_log_close(&log);
    FILE *file = fopen(path, "r");
    int lines = 0;
    for (int byte; file != NULL && (byte = getc(file)) != EOF;) {
        lines += byte == '\n';
    }
    CHECK_EQ(lines, 4);
    if (file != NULL) {
        fclose(file);
    }
}

static void full_disk_is_counted(void) {
    struct run_log log;
    CHECK(run_log_open(&log, "/dev/full", event_loop_now_us()));
    run_log_event(&log, false, "mode", "ready");
    run_log_event(&log, false, "mode", "tracking");
    CHECK_EQ(log.dropped, 2);
    run_log_close(&log);
}

static void no_log_and_no_place_for_one(void) {
    struct run_log log;
    CHECK(run_log_open(&log, NULL, 0));
    run_log_event(&log, false, "mode", "nobody hears");
    CHECK_EQ(log.dropped, 0);
    char told[256] = "";
    FILE *stream = fmemopen(told, sizeof told, "w");
    message_stream(stream);
    CHECK(!run_log_open(&log, "/nowhere/at/all.log", 0));
    fclose(stream);
    message_stream(NULL);
    CHECK(strcmp(told, "/nowhere/at/all.log: No such file or directory\n") == 0);
    run_log_close(&log);
}

int main(void) {
    const int fd = mkstemp(path);
    if (fd < 0) {
        return 2;
    }
    close(fd);
    TEST(a_line_an_event);
    TEST(full_disk_is_counted);
    TEST(no_log_and_no_place_for_one);
    unlink(path);
    return check_finish();
}
