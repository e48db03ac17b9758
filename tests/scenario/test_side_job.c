/// Jobs in threads of their own: the caller goes on meanwhile, and learns when they are over.
#include "side_job.h"

#include "check.h"

#include <errno.h>
#include <sched.h>
#include <semaphore.h>
#include <unistd.h>

struct work {
    sem_t begun, go_on;
    int policy; ///< of the thread that did it
    unsigned done;
};

static void await(sem_t *semaphore) {
    while (sem_wait(semaphore) != 0 && errno == EINTR) {
    }
}

static void work(void *context) {
    struct work *const it = context;
    it->policy = sched_getscheduler(0);
    sem_post(&it->begun);
    await(&it->go_on);
    it->done++;
}

static void the_caller_goes_on(void) {
    static struct side_job job;
    static struct work it;
    sem_init(&it.begun, 0, 0);
    sem_init(&it.go_on, 0, 0);
    CHECK(side_job_is_over(&job)); // there is none
    side_job_wait(&job);
    for (unsigned round = 1; round <= 3U; round++) {
        CHECK(side_job_start(&job, work, &it));
        await(&it.begun);
        CHECK(!side_job_is_over(&job) && it.done == round - 1U);
        CHECK(!side_job_start(&job, work, &it)); // one at a time
        sem_post(&it.go_on);
        while (!side_job_is_over(&job)) {
            usleep(100);
        }
        CHECK_EQ(it.done, round);
        CHECK_EQ(it.policy, SCHED_OTHER);
    }
    CHECK(side_job_start(&job, work, &it));
    sem_post(&it.go_on);
    side_job_wait(&job);
    CHECK(side_job_is_over(&job) && it.done == 4U);
}

int main(void) {
    TEST(the_caller_goes_on);
    return check_finish();
}
