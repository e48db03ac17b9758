/// The log of `boresight run`: a file line by line, and a disk that is full.
#include "run_log.h"

#include "event_loop.h"
#include "message.h"

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
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

static unsigned lines_of(const char *file_path) {
    unsigned lines = 0;
    FILE *file = fopen(file_path, "r");
    for (int byte; file != NULL && (byte = getc(file)) != EOF;) {
        lines += byte == '\n';
    }
    if (file != NULL) {
        fclose(file);
    }
    return lines;
}

static void a_line_an_event(void) {
    static struct run_log log;
    CHECK(run_log_open(&log, path, event_loop_now_us()));
    run_log_event(&log, false, "mode", "%s %d", "tracking", 7);
    CHECK_EQ(run_log_dropped(&log), 0); // and all is written
    CHECK(strcmp(last_line(), ", \"event\": \"mode\", \"text\": \"tracking 7\"}\n") == 0);
    run_log_event(&log, true, "device", "a \"quoted\" back\\slash and\nnewline\x01");
    CHECK_EQ(run_log_dropped(&log), 0);
    CHECK(strcmp(last_line(),
                 ", \"event\": \"device\", \"text\": "
                 "\"a \\\"quoted\\\" back\\\\slash and\\u000anewline\\u0001\"}\n") == 0);
    char giant[5000];
    memset(giant, '"', sizeof giant - 1U);
    giant[sizeof giant - 1U] = '\0';
    run_log_event(&log, true, "mode", "%s", giant); // cut, and still one line
    CHECK_EQ(run_log_dropped(&log), 0);
    const char *line = last_line();
    CHECK(strlen(line) > 1000U && line[strlen(line) - 1U] == '\n' &&
          line[strlen(line) - 2U] == '}');
    run_log_close(&log);
    CHECK(run_log_open(&log, path, event_loop_now_us())); // appends
    run_log_event(&log, false, "end", "again");
    run_log_close(&log);
    CHECK_EQ(lines_of(path), 4);
}

/// What logrotate does, with and without `create` and `copytruncate`, while it is written to.
static void a_file_that_is_rotated_begins_anew(void) {
    static struct run_log log;
    char older[sizeof path + 2U];
    snprintf(older, sizeof older, "%s.1", path);
    CHECK(truncate(path, 0) == 0 && run_log_open(&log, path, event_loop_now_us()));
    run_log_event(&log, false, "mode", "one");
    CHECK_EQ(run_log_dropped(&log), 0);
    CHECK(rename(path, older) == 0);
    run_log_event(&log, false, "mode", "two");
    run_log_event(&log, false, "mode", "three");
    CHECK_EQ(run_log_dropped(&log), 0);
    CHECK_EQ(lines_of(older), 1);
    CHECK_EQ(lines_of(path), 2);
    CHECK(rename(path, older) == 0);
    FILE *file = fopen(path, "w"); // create
    CHECK(file != NULL && fclose(file) == 0);
    run_log_event(&log, false, "mode", "four");
    CHECK_EQ(run_log_dropped(&log), 0);
    CHECK_EQ(lines_of(older), 2);
    CHECK_EQ(lines_of(path), 1);
    CHECK(truncate(path, 0) == 0); // copytruncate
    run_log_event(&log, false, "mode", "five");
    CHECK_EQ(run_log_dropped(&log), 0);
    CHECK_EQ(lines_of(path), 1);
    CHECK(unlink(path) == 0 && unlink(older) == 0);
    run_log_event(&log, false, "mode", "six");
    run_log_close(&log); // writes what is left
    CHECK_EQ(lines_of(path), 1);
}

static void full_disk_is_counted(void) {
    static struct run_log log;
    CHECK(run_log_open(&log, "/dev/full", event_loop_now_us()));
    run_log_event(&log, false, "mode", "ready");
    run_log_event(&log, false, "mode", "tracking");
    CHECK_EQ(run_log_dropped(&log), 2);
    run_log_close(&log);
}

static void no_log_and_no_place_for_one(void) {
    static struct run_log log;
    CHECK(run_log_open(&log, NULL, 0));
    run_log_event(&log, false, "mode", "nobody hears");
    CHECK_EQ(run_log_dropped(&log), 0);
    char told[256] = "";
    FILE *stream = fmemopen(told, sizeof told, "w");
    message_stream(stream);
    CHECK(!run_log_open(&log, "/nowhere/at/all.log", 0));
    fclose(stream);
    message_stream(NULL);
    CHECK(strcmp(told,
                 "/nowhere/at/all.log: No such file or directory; create its folder first\n") == 0);
    run_log_close(&log);
}

/// A socket that stands where the journal's does.
static void journal_gets_fields(void) {
    char folder[] = "/tmp/boresight-journal-XXXXXX", text[4096];
    CHECK(mkdtemp(folder) != NULL);
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    snprintf(address.sun_path, sizeof address.sun_path, "%s/socket", folder);
    static struct run_log log;
    run_log_journal = address.sun_path;
    message_stream(stdout); // what is said of the first try is not the test's
    CHECK(!run_log_open(&log, "journal", event_loop_now_us())); // nobody listens
    message_stream(NULL);
    const int journal = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    CHECK_EQ(bind(journal, (const struct sockaddr *)&address, sizeof address), 0);
    CHECK(run_log_open(&log, "journal", event_loop_now_us()));
    run_log_event(&log, false, "mode", "%s", "tracking");
    CHECK_EQ(run_log_dropped(&log), 0); // and all is written
    ssize_t size = recv(journal, text, sizeof text - 1U, 0);
    text[size > 0 ? size : 0] = '\0';
    CHECK(strcmp(text, "PRIORITY=6\nSYSLOG_IDENTIFIER=boresight\nBORESIGHT_EVENT=mode\n"
                       "MESSAGE=tracking\n") == 0);
    run_log_event(&log, true, "fault", "two\nlines=no field"); // must not begin a field
    CHECK_EQ(run_log_dropped(&log), 0);
    size = recv(journal, text, sizeof text - 1U, 0);
    text[size > 0 ? size : 0] = '\0';
    CHECK(strcmp(text, "PRIORITY=3\nSYSLOG_IDENTIFIER=boresight\nBORESIGHT_EVENT=fault\n"
                       "MESSAGE=two lines=no field\n") == 0);
    CHECK_EQ(run_log_dropped(&log), 0);
    for (int i = 0; i < 5000; i++) { // a journal that is stuck holds nobody up
        run_log_event(&log, false, "mode", "%d", i);
    }
    CHECK(run_log_dropped(&log) > 0U);
    close(journal);
    const uint64_t dropped = run_log_dropped(&log);
    run_log_event(&log, false, "mode", "gone"); // and one that has ended
    CHECK_EQ(run_log_dropped(&log), dropped + 1U);
    CHECK_EQ(unlink(address.sun_path), 0);
    const int another = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    CHECK_EQ(bind(another, (const struct sockaddr *)&address, sizeof address), 0);
    run_log_event(&log, false, "mode", "back"); // one that was started again
    CHECK_EQ(run_log_dropped(&log), dropped + 1U);
    size = recv(another, text, sizeof text - 1U, MSG_DONTWAIT);
    text[size > 0 ? size : 0] = '\0';
    CHECK(strstr(text, "\nMESSAGE=back\n") != NULL);
    close(another);
    run_log_close(&log);
    CHECK(unlink(address.sun_path) == 0 && rmdir(folder) == 0);
}

static bool takes_stderr(const char *target, const char *stream) {
    static struct run_log log;
    CHECK_EQ(setenv("JOURNAL_STREAM", stream, 1), 0);
    CHECK(run_log_open(&log, target, event_loop_now_us()));
    const bool takes = log.takes_stderr;
    run_log_close(&log);
    CHECK_EQ(unsetenv("JOURNAL_STREAM"), 0);
    return takes;
}

/// What a service says on stderr is in the journal already.
static void a_journal_may_be_stderr(void) {
    char folder[] = "/tmp/boresight-journal-XXXXXX", stream[64];
    CHECK(mkdtemp(folder) != NULL);
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    snprintf(address.sun_path, sizeof address.sun_path, "%s/socket", folder);
    run_log_journal = address.sun_path;
    const int journal = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    CHECK_EQ(bind(journal, (const struct sockaddr *)&address, sizeof address), 0);
    struct stat opened;
    CHECK_EQ(fstat(STDERR_FILENO, &opened), 0);
    const unsigned long long device = opened.st_dev, inode = opened.st_ino;
    snprintf(stream, sizeof stream, "%llu:%llu", device, inode);
    CHECK(takes_stderr("journal", stream));
    CHECK(!takes_stderr("/dev/null", stream)); // a file is another place
    snprintf(stream, sizeof stream, "%llu:%llu", device, inode + 1U);
    CHECK(!takes_stderr("journal", stream)); // stderr was sent elsewhere
    snprintf(stream, sizeof stream, "%llu:%llu", device + 1U, inode);
    CHECK(!takes_stderr("journal", stream));
    CHECK(!takes_stderr("journal", "") && !takes_stderr("journal", "nonsense"));
    close(journal);
    CHECK(unlink(address.sun_path) == 0 && rmdir(folder) == 0);
}

int main(void) {
    const int fd = mkstemp(path);
    if (fd < 0) {
        return 2;
    }
    close(fd);
    TEST(a_line_an_event);
    TEST(a_file_that_is_rotated_begins_anew);
    TEST(full_disk_is_counted);
    TEST(no_log_and_no_place_for_one);
    unlink(path);
    TEST(journal_gets_fields);
    TEST(a_journal_may_be_stderr);
    return check_finish();
}
