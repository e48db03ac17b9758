/// Failures to order, a part of every fake device: "fail the Nth call with this status".
///
/// A call counts when it gets as far as the device; calls with wrong arguments do not, nor do those
/// that answer from memory (limits, identity, geometry). A call that fails to order has no effect,
/// unless the fake's header says otherwise.
#ifndef DEVICES_FAKE_FAILURES_H
#define DEVICES_FAKE_FAILURES_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stdint.h>

/// All zeros: nothing fails.
struct fake_failures {
    /// Calls so far, failed ones included. Wraps.
    uint32_t call_count;
    /// Calls that still go well, then calls that still fail.
    uint32_t good_count, failing_count;
    enum hal_status status;
    bool gone;
};

/// The nth call from now fails (1: the next), and as many as count in a row. Replaces any earlier
/// order; nth 0 or count 0: none fails.
void fake_failures_at(struct fake_failures *failures, uint32_t nth, uint32_t count,
                      enum hal_status status);

/// true: the device has left, and every call says HAL_ERROR_GONE. false: it is back.
void fake_failures_set_gone(struct fake_failures *failures, bool gone);

/// What this call is to answer; HAL_OK: let it do its work. Counts it.
enum hal_status fake_failures_call(struct fake_failures *failures) MUST_CHECK;

/// HAL_OK, or HAL_ERROR_GONE: for calls that answer from memory.
enum hal_status fake_failures_presence(const struct fake_failures *failures) MUST_CHECK;

#endif
