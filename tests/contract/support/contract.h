/// What the contract suites share.
///
/// A suite is a function `X_suite(const struct X_fixture *)` that holds a device class to its
/// header (hal/include/hal/X.h). The fixture has the device and the few hands that the suite needs
/// on the far side: what is on the pins, the other end of the line, a cut cable. A hand that a rig
/// doesn't have is null, and the tests that need it are skipped by name. So one suite runs on the
/// fakes, on Linux, on register models and inside a virtual machine. Suites use no libc but the
/// memory functions.
///
/// fail_at in fixtures: of the calls that get as far as the device (those with wrong arguments do
/// not), the nth from now on, 1 being the next, fails with the status and has no effect. false: the
/// rig can't make it fail with that status.
#ifndef CONTRACT_SUPPORT_CONTRACT_H
#define CONTRACT_SUPPORT_CONTRACT_H

#include "check.h"
#include "hal/status.h"

#include <string.h>

/// Prints the verdict as DEVICE.TEST.
void contract_run(const char *device, const char *test, void (*function)(void));

/// The same for a test that needs a machine that does not pause (check.h); excuse NULL: it doesn't.
void contract_run_timed(const char *device, const char *test, void (*function)(void),
                        const char *(*excuse)(void));

/// Prints `SKIP DEVICE.TEST: WHY`.
void contract_skip(const char *device, const char *test, const char *why);

/// Runs the test if the fixture has what it needs, else skips it.
#define CONTRACT_IF(has, why_not, device, function)                                                \
    ((has) ? contract_run((device), #function, function)                                           \
           : contract_skip((device), #function, why_not))

#define CONTRACT(device, function) contract_run((device), #function, function)

/// The device's table binds; without any one of its operations, whichever, it does not.
#define CONTRACT_EVERY_OP(class, device)                                                           \
    do {                                                                                           \
        const size_t op_bytes_ = sizeof(void (*)(void));                                           \
        struct hal_##class##_ops ops_ = *(device)->ops;                                            \
        struct hal_##class bound_ = {NULL, NULL};                                                  \
        int there_ = 0;                                                                            \
        CHECK_EQ(hal_##class##_bind(NULL, &ops_, &there_), HAL_ERROR_ARGUMENT);                    \
        CHECK_EQ(hal_##class##_bind(&bound_, NULL, &there_), HAL_ERROR_ARGUMENT);                  \
        for (size_t at_ = 0; at_ < sizeof ops_; at_ += op_bytes_) {                                \
            ops_ = *(device)->ops;                                                                 \
            memset((char *)&ops_ + at_, 0, op_bytes_);                                             \
            CHECK_EQ(hal_##class##_bind(&bound_, &ops_, &there_), HAL_ERROR_ARGUMENT);             \
            CHECK(bound_.ops == NULL && bound_.ctx == NULL);                                       \
        }                                                                                          \
        ops_ = *(device)->ops;                                                                     \
        CHECK_EQ(hal_##class##_bind(&bound_, &ops_, &there_), HAL_OK);                             \
        CHECK(bound_.ops == &ops_ && bound_.ctx == &there_);                                       \
    } while (0)

/// Failure at the Nth call, for every N: an exercise is done again and again, once with each of its
/// calls failing, with each status a broken device answers.
struct contract_plan {
    enum hal_status failure;
    /// Which call is to fail; how many were made; how many failed.
    uint32_t nth, calls, failures;
};

/// Counts a call. True if it failed as planned; else it must have been HAL_OK.
bool contract_failed(struct contract_plan *plan, enum hal_status status);

/// Makes a call, and once more if it was the one to fail.
#define CONTRACT_DO(plan, call)                                                                    \
    do {                                                                                           \
        if (contract_failed((plan), (call))) {                                                     \
            CHECK(!contract_failed((plan), (call)));                                               \
        }                                                                                          \
    } while (0)

/// What a fixture has for that: reset makes the device as new, fail_at as above.
struct contract_failures {
    void *context;
    void (*reset)(void *context);
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
    /// Some calls ask nobody, so they don't fail when it is their turn.
    bool some_cannot_fail;
};

void contract_each_failure(const struct contract_failures *hands,
                           void (*exercise)(struct contract_plan *plan));

#endif
