#include "contract/support/failing_can.h"

#include "check.h"

static bool begin(struct failing_can *can) {
    const bool due = can->nth == 1U;
    can->nth -= can->nth > 0U;
    if (due) {
        can->fail(true);
    }
    return due;
}

static enum hal_status end(const struct failing_can *can, bool due, enum hal_status status) {
    if (due) {
        can->fail(false);
    }
    return status;
}

static enum hal_status failing_send(void *ctx, const struct can_frame *frame) {
    struct failing_can *can = ctx;
    const bool due = begin(can);
    return end(can, due, hal_can_send(can->inside, frame));
}

static enum hal_status failing_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    struct failing_can *can = ctx;
    const bool due = begin(can);
    return end(can, due, hal_can_receive(can->inside, frame, at_us));
}

static enum hal_status failing_state(void *ctx, struct hal_can_state *state) {
    struct failing_can *can = ctx;
    const bool due = begin(can);
    return end(can, due, hal_can_state(can->inside, state));
}

static enum hal_status failing_filters(void *ctx, const struct hal_can_filter *filters,
                                       uint32_t count) {
    struct failing_can *can = ctx;
    const bool due = begin(can);
    return end(can, due, hal_can_set_filters(can->inside, filters, count));
}

static enum hal_status failing_restart(void *ctx) {
    struct failing_can *can = ctx;
    const bool due = begin(can);
    return end(can, due, hal_can_restart(can->inside));
}

void failing_can_init(struct failing_can *can, const struct hal_can *inside,
                      void (*fail)(bool on)) {
    static const struct hal_can_ops ops = {failing_send, failing_receive, failing_state,
                                           failing_filters, failing_restart};
    *can = (struct failing_can){.inside = inside, .fail = fail};
    CHECK_EQ(hal_can_bind(&can->hal, &ops, can), HAL_OK);
}

bool failing_can_at(struct failing_can *can, uint32_t nth, enum hal_status status) {
    can->nth = nth;
    return status == HAL_ERROR_IO;
}
