/// What a person is told of CAN buses that fail, and what is counted: buses whose drivers say
/// whatever the test wants, at the test's own time.
#include "rig_bus.h"

#include "check.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static struct world {
    uint32_t now_us;
    struct hal_can_state state[RIG_BUSES_MAX];
    enum hal_status send, restart;
    atomic_uint asked_to_restart, asked_by_the_loop;
    atomic_bool held; ///< a restart does not end
} world;
static pthread_t loop;

static uint32_t clock_now(void *ctx) {
    (void)ctx;
    return world.now_us;
}
static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    (void)ctx;
    (void)frame;
    return world.send;
}
static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    (void)ctx;
    (void)frame;
    (void)at_us;
    return HAL_EMPTY;
}
static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    *state = *(struct hal_can_state *)ctx;
    return HAL_OK;
}
static enum hal_status can_filters(void *ctx, const struct hal_can_filter *filters,
                                   uint32_t count) {
    (void)ctx;
    (void)filters;
    (void)count;
    return HAL_OK;
}
static enum hal_status can_restart(void *ctx) {
    (void)ctx;
    world.asked_to_restart++;
    world.asked_by_the_loop += pthread_equal(pthread_self(), loop) != 0;
    for (int ms = 0; world.held && ms < 10000; ms++) {
        usleep(1000);
    }
    return world.restart;
}

static const struct hal_clock_ops clock_ops = {clock_now};
static const struct hal_can_ops can_ops = {can_send, can_receive, can_state, can_filters,
                                           can_restart};
static struct hal_clock clock_;
static struct hal_can cans[RIG_BUSES_MAX];
static struct rig rig;
static struct rig_buses buses;

/// Near the clock's wrap. One bus for both axes, or one each.
static void start(unsigned count) {
    static const char *const texts[] = {"can:can0", "can:can1"};
    memset(&world, 0, sizeof world);
    world.now_us = UINT32_MAX - 500000U;
    CHECK_EQ(hal_clock_bind(&clock_, &clock_ops, NULL), HAL_OK);
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        rig.controller.axis[axis].drive =
            (struct drive_config){.kind = DRIVE_RMD, .rmd = {.id = (uint8_t)(axis + 1U)}};
        rig.bus[axis] = texts[count == 1U ? 0U : axis];
    }
    CHECK(rig_buses_find(&buses, &rig, &clock_));
    CHECK_EQ(buses.count, count);
    for (unsigned i = 0; i < count; i++) {
        CHECK_EQ(hal_can_bind(&cans[i], &can_ops, &world.state[i]), HAL_OK);
        buses.bus[i].hal = &cans[i];
    }
}

/// Time passes in ticks of 1 ms, and each line is as wanted; NULL: nothing is told meanwhile.
static void expect(uint32_t ms, const char *wanted, bool wanted_severe) {
    const char *line = NULL;
    bool severe = false;
    for (uint32_t i = 0; i <= ms && line == NULL; i++) {
        world.now_us += i == 0U ? 0U : 1000U;
        line = rig_buses_news(&buses, &severe);
    }
    if (wanted == NULL ? !CHECK(line == NULL) : !CHECK(line != NULL && strcmp(line, wanted) == 0)) {
        printf("  got    %s\n  wanted %s\n", line == NULL ? "-" : line,
               wanted == NULL ? "-" : wanted);
    }
    CHECK(wanted == NULL || severe == wanted_severe);
}

static void say(unsigned bus, const char *line) {
    snprintf(buses.bus[bus].can.error.line, sizeof buses.bus[bus].can.error.line, "%s", line);
}

static enum hal_status request(uint32_t id) {
    const struct can_frame frame = {.id = id, .length = 8};
    return hal_can_send(&buses.front, &frame);
}

static void a_well_bus_says_nothing(void) {
    start(1);
    for (int i = 0; i < 100; i++) {
        CHECK_EQ(request(0x141), HAL_OK);
        expect(10, NULL, false);
    }
    CHECK_EQ(buses.offs + buses.frames_lost, 0);
}

static void bus_off_and_back(void) {
    start(1);
    world.state[0].health = HAL_CAN_OFF;
    say(0, "can0: bus-off; check it");
    expect(0, "can0: bus-off; check it", true);
    expect(5000, NULL, false); // as long as that is so
    world.state[0].health = HAL_CAN_ACTIVE;
    expect(0, "can:can0: the bus works again", false);
    expect(5000, NULL, false);
    CHECK_EQ(buses.offs, 1);
}

/// The reason why it stays off, which comes later, is told, too.
static void the_remedy_is_told(void) {
    start(1);
    world.state[0].health = HAL_CAN_OFF;
    say(0, "can0: bus-off; check it");
    expect(0, "can0: bus-off; check it", true);
    say(0, "can0: bus-off, and this user may not restart it; do so");
    expect(998, NULL, false);
    expect(2, "can0: bus-off, and this user may not restart it; do so", true);
    expect(5000, NULL, false);
}

/// Off and on every 10 ms: a line a second, and each bus-off counted.
static void one_that_flaps_says_so_once_a_second(void) {
    start(1);
    say(0, "can0: bus-off; check it");
    unsigned lines = 0;
    bool severe;
    for (unsigned ms = 0; ms < 10000U; ms++) {
        world.state[0].health = ms / 5U % 2U == 0U ? HAL_CAN_OFF : HAL_CAN_ACTIVE;
        world.now_us += 1000;
        const char *line = rig_buses_news(&buses, &severe);
        lines += line != NULL;
        CHECK(line == NULL || strcmp(line, "can0: bus-off; check it") == 0);
    }
    CHECK_EQ(lines, 10);
    CHECK_EQ(buses.offs, 1000);
    expect(1000, "can0: bus-off; check it", true); // it was, since the last line
    expect(1000, "can:can0: the bus works again", false);
}

/// A short one between two looks is told even though it is over when it may be told.
static void a_short_one_is_not_missed(void) {
    start(1);
    world.state[0].health = HAL_CAN_PASSIVE;
    expect(0,
           "can:can0: error-passive, many frames fail; check cable, termination, bit rate and "
           "the drives' power",
           true);
    say(0, "can0: bus-off; check it");
    world.state[0].health = HAL_CAN_OFF;
    expect(10, NULL, false);
    world.state[0].health = HAL_CAN_ACTIVE;
    say(0, "something else");
    expect(1000, "can0: bus-off; check it", true);
    expect(1000, "can:can0: the bus works again", false);
}

static void a_full_queue_is_told_when_it_stays_full(void) {
    static const char wanted[] = "can:can0: takes no frames, nobody on the bus acknowledges; check "
                                 "cable, termination, bit rate and the drives' power";
    start(1);
    for (int i = 0; i < 20; i++) { // as on a busy bus: now and then
        world.send = HAL_BUSY;
        CHECK_EQ(request(0x141), HAL_BUSY);
        expect(18, NULL, false);
        world.send = HAL_OK;
        CHECK_EQ(request(0x142), HAL_OK);
        expect(1, NULL, false);
    }
    world.send = HAL_BUSY;
    for (int i = 0; i < 7; i++) {
        CHECK_EQ(request(0x141), HAL_BUSY);
        expect(2, NULL, false);
    }
    expect(20, NULL, false); // of a few it is none the worse, however long ago
    world.send = HAL_OK;
    CHECK_EQ(request(0x141), HAL_OK);
    world.send = HAL_BUSY;
    for (int i = 0; i < 8; i++) {
        CHECK_EQ(request(0x141), HAL_BUSY);
        expect(2, NULL, false);
    }
    expect(3, NULL, false);
    expect(1, wanted, true);
    world.state[0].health = HAL_CAN_PASSIVE; // less than that
    expect(3000, NULL, false);
    world.send = HAL_OK;
    CHECK_EQ(request(0x141), HAL_OK);
    world.state[0].health = HAL_CAN_ACTIVE;
    expect(0, "can:can0: the bus works again", false);
}

static void lost_frames_are_told_once_in_ten_seconds(void) {
    start(1);
    world.state[0].lost_count = 3;
    expect(0, "can:can0: 3 frames came damaged, or faster than they were read", true);
    for (int i = 0; i < 9; i++) {
        world.state[0].lost_count += 2;
        expect(1000, NULL, false);
    }
    expect(1000, "can:can0: 21 frames came damaged, or faster than they were read", true);
    expect(20000, NULL, false);
    CHECK_EQ(buses.frames_lost, 21);
    buses.bus[0].lost = true; // it leaves, and another one comes
    buses.bus[0].condition = (struct rig_bus_condition){0};
    expect(100, NULL, false);
    buses.bus[0].lost = false;
    world.state[0].lost_count = 4;
    expect(0, "can:can0: 4 frames came damaged, or faster than they were read", true);
    CHECK_EQ(buses.frames_lost, 25);
}

static void each_of_two_has_its_own(void) {
    start(2);
    world.state[1].health = HAL_CAN_OFF;
    world.send = HAL_ERROR_DOWN;
    say(1, "can1: bus-off; check it");
    expect(0, "can1: bus-off; check it", true);
    for (int i = 0; i < 350; i++) {       // of a ms
        CHECK_EQ(request(0x142), HAL_OK); // dropped, so that the other goes on
        side_job_wait(&buses.bus[1].restart);
        expect(1, NULL, false);
    }
    CHECK_EQ((int)world.asked_to_restart, 4);
    CHECK_EQ(buses.restarts, 1);
    CHECK_EQ(buses.dropped, 350);
    world.state[0].health = HAL_CAN_OFF;
    say(0, "can0: bus-off; check it");
    expect(0, "can0: bus-off; check it", true);
    world.send = HAL_OK;
    CHECK_EQ(request(0x142), HAL_OK);
    world.send = HAL_ERROR_DOWN;
    world.now_us += RIG_BUS_RESTART_US;
    CHECK_EQ(request(0x142), HAL_OK);
    side_job_wait(&buses.bus[1].restart);
    expect(0, NULL, false);
    CHECK_EQ(buses.restarts, 2);
    world.restart = HAL_ERROR_DENIED;
    CHECK_EQ(request(0x141), HAL_OK);
    side_job_wait(&buses.bus[0].restart);
    expect(0, NULL, false);
    CHECK_EQ((int)world.asked_to_restart, 6);
    CHECK_EQ(buses.restarts, 2);
    CHECK_EQ(buses.offs, 2);
}

/// The kernel takes its time: meanwhile the bus is off, nothing comes from it, and no call waits.
static void a_restart_that_blocks_holds_up_nothing(void) {
    struct can_frame frame;
    struct hal_can_state state;
    uint32_t at_us;
    start(1);
    world.state[0] = (struct hal_can_state){.health = HAL_CAN_OFF, .lost_count = 7};
    world.send = HAL_ERROR_DOWN;
    say(0, "can0: bus-off; check it");
    expect(0, "can0: bus-off; check it", true);
    expect(0, "can:can0: 7 frames came damaged, or faster than they were read", true);
    world.held = true;
    CHECK_EQ(request(0x141), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(&buses.front), HAL_OK);
    world.state[0] = (struct hal_can_state){.health = HAL_CAN_ACTIVE, .lost_count = 8};
    world.send = HAL_OK;
    for (int i = 0; i < 300; i++) {
        CHECK_EQ(request(0x141), HAL_ERROR_DOWN);
        CHECK_EQ(hal_can_restart(&buses.front), HAL_OK);
        CHECK_EQ(hal_can_receive(&buses.front, &frame, &at_us), HAL_EMPTY);
        CHECK_EQ(hal_can_state(&buses.front, &state), HAL_OK);
        CHECK_EQ(state.health, HAL_CAN_OFF);
        CHECK_EQ(state.lost_count, 7);
        CHECK(rig_buses_newly_lost(&buses) == NULL);
        world.now_us += 1000;
    }
    CHECK_EQ(buses.restarts, 0); // not yet
    world.held = false;
    side_job_wait(&buses.bus[0].restart);
    CHECK_EQ(request(0x141), HAL_OK);
    CHECK_EQ(buses.restarts, 1);
    CHECK_EQ((int)world.asked_to_restart, 1);
    CHECK_EQ((int)world.asked_by_the_loop, 0);
    expect(1000, "can:can0: the bus works again", false);
}

int main(void) {
    loop = pthread_self();
    TEST(a_well_bus_says_nothing);
    TEST(bus_off_and_back);
    TEST(the_remedy_is_told);
    TEST(one_that_flaps_says_so_once_a_second);
    TEST(a_short_one_is_not_missed);
    TEST(a_full_queue_is_told_when_it_stays_full);
    TEST(lost_frames_are_told_once_in_ten_seconds);
    TEST(each_of_two_has_its_own);
    TEST(a_restart_that_blocks_holds_up_nothing);
    return check_finish();
}
