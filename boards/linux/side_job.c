#include "side_job.h"

#include <sched.h>

bool side_job_thread(pthread_t *thread, void *(*run)(void *context), void *context) {
    pthread_attr_t attributes;
    const struct sched_param ordinary = {0};
    if (pthread_attr_init(&attributes) != 0) {
        return false;
    }
    const bool started = pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED) == 0 &&
                         pthread_attr_setschedpolicy(&attributes, SCHED_OTHER) == 0 &&
                         pthread_attr_setschedparam(&attributes, &ordinary) == 0 &&
                         pthread_create(thread, &attributes, run, context) == 0;
    pthread_attr_destroy(&attributes);
    return started;
}

static void *run(void *context) {
    struct side_job *const job = context;
    job->work(job->context);
    atomic_store(&job->done, true);
    return NULL;
}

bool side_job_start(struct side_job *job, void (*work)(void *context), void *context) {
    if (!side_job_is_over(job)) {
        return false;
    }
    atomic_store(&job->done, false);
    job->work = work;
    job->context = context;
    job->running = side_job_thread(&job->thread, run, job);
    return job->running;
}

bool side_job_is_over(struct side_job *job) {
    if (job->running && atomic_load(&job->done)) {
        side_job_wait(job);
    }
    return !job->running;
}

void side_job_wait(struct side_job *job) {
    if (job->running) {
        pthread_join(job->thread, NULL); // does not take long once it is done
        job->running = false;
    }
}
