#include "devices/fake_failures.h"

void fake_failures_at(struct fake_failures *failures, uint32_t nth, uint32_t count,
                      enum hal_status status) {
    failures->good_count = nth == 0U ? 0U : nth - 1U;
    failures->failing_count = nth == 0U ? 0U : count;
    failures->status = status;
}

void fake_failures_set_gone(struct fake_failures *failures, bool gone) {
    failures->gone = gone;
}

enum hal_status fake_failures_presence(const struct fake_failures *failures) {
    return failures->gone ? HAL_ERROR_GONE : HAL_OK;
}

enum hal_status fake_failures_call(struct fake_failures *failures) {
    failures->call_count++;
    if (failures->gone) {
        return HAL_ERROR_GONE;
    }
    if (failures->failing_count == 0U) {
        return HAL_OK;
    }
    if (failures->good_count > 0U) {
        failures->good_count--;
        return HAL_OK;
    }
    failures->failing_count--;
    return failures->status;
}
