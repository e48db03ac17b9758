#include "aside.h"

#include "side_job.h"

static void *run(void *context) {
    struct aside *const aside = context;
    pthread_mutex_lock(&aside->mutex);
    while (!aside->ending || aside->head != aside->tail) {
        if (aside->head == aside->tail) {
            pthread_cond_wait(&aside->changed, &aside->mutex);
            continue;
        }
        const struct aside_line *const line = &aside->line[aside->tail % ASIDE_LINES];
        pthread_mutex_unlock(&aside->mutex);
        aside->write(aside->context, line);
        pthread_mutex_lock(&aside->mutex);
        aside->tail++;
        pthread_cond_broadcast(&aside->changed);
    }
    pthread_mutex_unlock(&aside->mutex);
    return NULL;
}

bool aside_open(struct aside *aside, void (*write)(void *context, const struct aside_line *line),
                void *context) {
    pthread_mutexattr_t attributes;
    aside->write = write;
    aside->context = context;
    aside->ending = false;
    aside->head = aside->tail = 0;
    aside->dropped = 0;
    // The writer, of ordinary priority, must not hold up a tick while others keep it from running.
    pthread_mutexattr_init(&attributes);
    (void)pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    const bool good = pthread_mutex_init(&aside->mutex, &attributes) == 0 ||
                      pthread_mutex_init(&aside->mutex, NULL) == 0; // a kernel without such mutexes
    pthread_mutexattr_destroy(&attributes);
    pthread_cond_init(&aside->changed, NULL);
    if (!good || !side_job_thread(&aside->thread, run, aside)) {
        pthread_cond_destroy(&aside->changed);
        return false;
    }
    return true;
}

void aside_push(struct aside *aside, const struct aside_line *line) {
    pthread_mutex_lock(&aside->mutex);
    if (aside->head - aside->tail == ASIDE_LINES) {
        aside->dropped++;
    } else {
        aside->line[aside->head % ASIDE_LINES] = *line;
        aside->head++;
    }
    pthread_cond_broadcast(&aside->changed);
    pthread_mutex_unlock(&aside->mutex);
}

void aside_flush(struct aside *aside) {
    pthread_mutex_lock(&aside->mutex);
    while (aside->head != aside->tail) {
        pthread_cond_wait(&aside->changed, &aside->mutex);
    }
    pthread_mutex_unlock(&aside->mutex);
}

uint64_t aside_dropped(struct aside *aside) {
    pthread_mutex_lock(&aside->mutex);
    const uint64_t dropped = aside->dropped;
    pthread_mutex_unlock(&aside->mutex);
    return dropped;
}

void aside_close(struct aside *aside) {
    pthread_mutex_lock(&aside->mutex);
    aside->ending = true;
    pthread_cond_broadcast(&aside->changed);
    pthread_mutex_unlock(&aside->mutex);
    pthread_join(aside->thread, NULL);
    pthread_cond_destroy(&aside->changed);
    pthread_mutex_destroy(&aside->mutex);
}
