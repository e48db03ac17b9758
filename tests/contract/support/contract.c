#include "contract/support/contract.h"

/// Joins DEVICE and TEST; cut if they are longer than any name in use.
static const char *full_name(const char *device, const char *test) {
    static char name[96];
    size_t size = 0;
    const char *const parts[] = {device, ".", test};
    for (size_t i = 0; i < 3U; i++) {
        for (const char *c = parts[i]; *c != '\0' && size < sizeof name - 1U; c++) {
            name[size++] = *c;
        }
    }
    name[size] = '\0';
    return name;
}

void contract_run(const char *device, const char *test, void (*function)(void)) {
    check_run(full_name(device, test), function);
}

void contract_run_timed(const char *device, const char *test, void (*function)(void),
                        const char *(*excuse)(void)) {
    if (excuse == NULL) {
        contract_run(device, test, function);
    } else {
        check_run_timed(full_name(device, test), function, excuse);
    }
}

void contract_skip(const char *device, const char *test, const char *why) {
    const char *const parts[] = {"SKIP ", full_name(device, test), ": ", why, "\n"};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        check_write(parts[i], strlen(parts[i]));
    }
}

bool contract_failed(struct contract_plan *plan, enum hal_status status) {
    plan->calls++;
    if (status != plan->failure) {
        CHECK_EQ(status, HAL_OK);
        return false;
    }
    CHECK_EQ(plan->calls, plan->nth);
    plan->failures++;
    return true;
}

void contract_each_failure(const struct contract_failures *hands,
                           void (*exercise)(struct contract_plan *plan)) {
    const enum hal_status failures[] = {HAL_ERROR_IO, HAL_ERROR_GONE};
    uint32_t possible = 0, failed = 0;
    for (size_t i = 0; i < sizeof failures / sizeof failures[0]; i++) {
        struct contract_plan plan = {.failure = failures[i]};
        do {
            plan.nth++;
            plan.calls = plan.failures = 0;
            hands->reset(hands->context);
            if (!hands->fail_at(hands->context, plan.nth, plan.failure)) {
                break;
            }
            possible++;
            exercise(&plan);
            failed += plan.failures;
            // Each call had its turn; only when nth is beyond the last does none fail.
            const uint32_t due = plan.nth <= plan.calls ? 1 : 0;
            CHECK(plan.failures == due || (hands->some_cannot_fail && plan.failures == 0U));
        } while (plan.nth <= plan.calls && check_clean());
    }
    CHECK(possible > 2U && failed > 2U);
    hands->reset(hands->context);
}
