/// Lines written by another thread: in order, without waiting for a writer that is stuck.
#include "aside.h"

#include "message.h"

#include "check.h"

#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PRODUCERS = 4, LINES_EACH = 5000 };

static sem_t entered, released;
static unsigned written, last[PRODUCERS];
static bool in_order, own_thread;
static pthread_t ticks;

static void write_slowly(void *context, const struct aside_line *line) {
    (void)context;
    unsigned number = 0;
    own_thread = own_thread && !pthread_equal(pthread_self(), ticks);
    in_order = in_order && sscanf(line->text, "%u", &number) == 1 && number >= written;
    written++;
    sem_post(&entered);
    sem_wait(&released);
}

static void push(struct aside *aside, unsigned producer, unsigned number) {
    struct aside_line line = {.at_us = producer};
    snprintf(line.text, sizeof line.text, "%u", number);
    aside_push(aside, &line);
}

/// Were a push to wait for the writer, this would not come to its end.
static void a_writer_that_is_stuck_holds_nobody_up(void) {
    static struct aside aside;
    in_order = own_thread = true;
    written = 0;
    CHECK(aside_open(&aside, write_slowly, NULL));
    push(&aside, 0, 0);
    sem_wait(&entered); // it is in the middle of the first
    for (unsigned i = 1; i < 1000U; i++) {
        push(&aside, 0, i);
    }
    CHECK_EQ(aside_dropped(&aside), 1000 - ASIDE_LINES);
    for (unsigned i = 0; i < ASIDE_LINES; i++) {
        sem_post(&released);
    }
    aside_flush(&aside);
    CHECK_EQ(written, ASIDE_LINES);
    CHECK(in_order && own_thread);
    sem_post(&released);
    push(&aside, 0, 1000); // there is room again
    aside_close(&aside);
    CHECK_EQ(written, ASIDE_LINES + 1);
}

static void write_quickly(void *context, const struct aside_line *line) {
    (void)context;
    const unsigned number = (unsigned)strtoul(line->text, NULL, 10);
    in_order = in_order && number > last[line->at_us];
    last[line->at_us] = number;
    written++;
}

static struct aside shared;

static void *produce(void *context) {
    const unsigned producer = (unsigned)(size_t)context;
    for (unsigned i = 1; i <= LINES_EACH; i++) {
        push(&shared, producer, i);
    }
    return NULL;
}

static void several_at_once(void) {
    pthread_t thread[PRODUCERS];
    in_order = true;
    written = 0;
    memset(last, 0, sizeof last);
    CHECK(aside_open(&shared, write_quickly, NULL));
    for (size_t i = 0; i < PRODUCERS; i++) {
        CHECK_EQ(pthread_create(&thread[i], NULL, produce, (void *)i), 0);
    }
    for (size_t i = 0; i < PRODUCERS; i++) {
        pthread_join(thread[i], NULL);
    }
    aside_flush(&shared);
    CHECK_EQ(written + aside_dropped(&shared), PRODUCERS * LINES_EACH);
    CHECK(in_order);
    aside_close(&shared);
}

static int pipe_ends[2];
static char text[1 << 20];

static void *read_all(void *context) {
    size_t size = 0;
    ssize_t got;
    (void)context;
    while ((got = read(pipe_ends[0], text + size, sizeof text - 1U - size)) > 0) {
        size += (size_t)got;
    }
    return NULL;
}

/// Messages of a program whose stderr is a pipe that nobody reads for a while.
static void messages_into_a_full_pipe(void) {
    pthread_t reader;
    CHECK_EQ(pipe(pipe_ends), 0);
    FILE *const stream = fdopen(pipe_ends[1], "w");
    setvbuf(stream, NULL, _IOLBF, 256);
    message_stream(stream);
    message_aside_begin();
    for (unsigned i = 0; i < 3000U; i++) { // 180 kB: more than the pipe takes
        message_at("some/file.ini", i + 1U, "%s", "what is wrong with a line of that file");
    }
    CHECK_EQ(pthread_create(&reader, NULL, read_all, NULL), 0);
    message_aside_end();
    message_stream(NULL);
    fclose(stream);
    pthread_join(reader, NULL);
    CHECK(strncmp(text, "some/file.ini:1: what is wrong with a line of that file\n", 56) == 0);
    CHECK(strstr(text, " more lines are lost: nobody took them\n") != NULL);
    close(pipe_ends[0]);
}

int main(void) {
    ticks = pthread_self();
    sem_init(&entered, 0, 0);
    sem_init(&released, 0, 0);
    TEST(a_writer_that_is_stuck_holds_nobody_up);
    TEST(several_at_once);
    TEST(messages_into_a_full_pipe);
    return check_finish();
}
