/// Settings that a device refuses: a camera is played here that takes or refuses what it is sent.
#include "refusals.h"

#include "check.h"

struct camera {
    struct refusals refusals;
    uint32_t failed, taken;
    int32_t wanted, held;
    uint32_t sent;
};

static void send(struct camera *camera, bool takes) {
    camera->sent++;
    if (takes) {
        camera->taken++;
        camera->held = camera->wanted;
    } else {
        camera->failed++;
    }
}

/// A millisecond passes. Returns whether something was sent again.
static bool tick(struct camera *camera, uint32_t now_us, bool takes) {
    const bool again = refusals_look(&camera->refusals, camera->failed, camera->taken, now_us);
    if (again) {
        send(camera, takes);
    }
    return again;
}

static void what_is_refused_is_sent_again(void) {
    struct camera camera = {.wanted = 5};
    uint32_t now_us = 0xFFFFF000U; // it wraps
    send(&camera, false);
    CHECK(tick(&camera, now_us, false)); // at once, and refused again
    for (unsigned i = 1; i < 200U; i++) {
        CHECK(!tick(&camera, now_us + i * 1000U, true));
    }
    CHECK(tick(&camera, now_us + 200000U, true) && camera.held == 5);
    for (unsigned i = 201; i < 5000U; i++) {
        CHECK(!tick(&camera, now_us + i * 1000U, true)); // it has been taken
    }
    CHECK(!refusals_give_up(&camera.refusals) && camera.sent == 3U);
}

static void one_that_takes_nothing_is_given_up(void) {
    struct camera camera = {.wanted = 5};
    unsigned given_up_ms = 0;
    send(&camera, false);
    for (unsigned i = 0; i < 5000U && given_up_ms == 0U; i++) {
        (void)tick(&camera, i * 1000U, false);
        given_up_ms = refusals_give_up(&camera.refusals) ? i : 0U;
    }
    CHECK_EQ(given_up_ms, (REFUSALS_MAX - 1U) * REFUSALS_AGAIN_US / 1000U);
}

/// New settings all the time, of which every third is taken: that is a slow camera, no broken one.
static void one_that_takes_some_is_not(void) {
    struct camera camera = {.wanted = 5};
    for (unsigned i = 0; i < 20000U; i++) {
        if (i % 50U == 0U) {
            send(&camera, i % 150U == 0U);
        }
        (void)tick(&camera, i * 1000U, false);
        CHECK(!refusals_give_up(&camera.refusals));
    }
    CHECK(camera.failed > 200U);
}

int main(void) {
    TEST(what_is_refused_is_sent_again);
    TEST(one_that_takes_nothing_is_given_up);
    TEST(one_that_takes_some_is_not);
    return check_finish();
}
