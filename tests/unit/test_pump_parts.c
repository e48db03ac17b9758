/// firmware/app/pump: what it needs, and the ring of updates. Its work: test_pump.c.
#include "check.h"

#include "app/pump.h"

static struct controller_config config;
static struct controller controller;
static struct pump pump;

/// Whichever axis alone needs the device.
static void devices_that_one_axis_misses(void) {
    static const struct hal_can can;
    static const struct hal_pwm pwm;
    static const struct hal_clock clock;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        for (unsigned by_can = 0; by_can < 2U; by_can++) {
            for (unsigned other = 0; other < AXIS_COUNT; other++) {
                config.axis[other].drive.kind =
                    (other == axis) == (by_can != 0U) ? DRIVE_RMD : DRIVE_PWM;
            }
            controller.config = &config;
            CHECK(pump_init(&pump, &controller, &(struct pump_devices){&clock, &can, &pwm}));
            CHECK(pump.pulse_ns[axis] > 20000000U); // unknown: the first is written whatever it is
            pump.pulse_ns[axis] = 0;
            CHECK(!pump_init(&pump, &controller,
                             &(struct pump_devices){&clock, by_can != 0U ? NULL : &can,
                                                    by_can != 0U ? &pwm : NULL}));
        }
    }
}

/// What is marked to pass as it is stays so, wherever in the ring it waits.
static void marks_stay_with_their_updates(void) {
    enum { ROUNDS = 3000 };
    uint64_t seed = UINT64_C(0x9A55);
    static bool marked[ROUNDS];
    uint32_t pushed = 0, taken = 0;
    while (pushed < ROUNDS && check_clean()) {
        for (uint64_t n = check_random(&seed) % (PUMP_UPDATES_MAX - (pushed - taken) + 1U);
             n > 0U && pushed < ROUNDS; n--) {
            const struct target_update update = {.kind = TARGET_GONE, .id = pushed};
            marked[pushed] = (check_random(&seed) >> 40 & 1U) != 0U;
            CHECK(marked[pushed] ? pump_push_as_is(&pump, &update) : pump_push(&pump, &update));
            pushed++;
        }
        for (uint64_t n = check_random(&seed) % (pushed - taken + 1U); n > 0U; n--) {
            struct target_update update;
            bool as_is;
            CHECK(pump_take(&pump, &update, &as_is));
            CHECK_EQ(update.id, taken);
            CHECK_EQ(as_is, marked[taken]);
            taken++;
        }
    }
}

int main(void) {
    TEST(devices_that_one_axis_misses);
    TEST(marks_stay_with_their_updates);
    return check_finish();
}
