/// One CAN controller on one bus, classic frames. Bit rate and pins are the board's or the rig
/// file's business and set before the device is bound.
/// Shown: tests/contract/support/can_suite.h, on every implementation.
#ifndef HAL_CAN_H
#define HAL_CAN_H

#include "drive/can_frame.h"
#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// A frame passes if all bits of the masks agree. Which kind of frame, too: to hear only standard
/// data frames, flags is 0 and flags_mask CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE.
struct hal_can_filter {
    uint32_t id, id_mask;
    uint8_t flags, flags_mask;
};

/// Every implementation takes this many filters: a bxCAN has 14 filter banks for each controller.
#define HAL_CAN_FILTERS_MAX 14

enum hal_can_health {
    HAL_CAN_ACTIVE,
    /// An error counter is above 127: the controller can no longer destroy the frames of others.
    HAL_CAN_PASSIVE,
    /// Bus-off: the transmit error counter has passed 255 and the controller has let go of the bus.
    HAL_CAN_OFF
};

struct hal_can_state {
    enum hal_can_health health;
    /// 0 to 256; 256 stands for bus-off. Where a controller doesn't tell: 0, 128 or 256 by health.
    uint16_t transmit_error_count;
    /// 0 to 255, with the same stand-ins.
    uint16_t receive_error_count;
    /// Frames that arrived while the receive queue was full, or damaged where that shows, since the
    /// device was opened. Wraps.
    uint32_t lost_count;
};

struct hal_can_ops {
    enum hal_status (*send)(void *ctx, const struct can_frame *frame);
    enum hal_status (*receive)(void *ctx, struct can_frame *frame, uint32_t *received_us);
    enum hal_status (*state)(void *ctx, struct hal_can_state *state);
    enum hal_status (*set_filters)(void *ctx, const struct hal_can_filter *filters, uint32_t count);
    enum hal_status (*restart)(void *ctx);
};

struct hal_can {
    const struct hal_can_ops *ops;
    void *ctx;
};

/// Fills *can. HAL_ERROR_ARGUMENT (and *can as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status hal_can_bind(struct hal_can *can,
                                                      const struct hal_can_ops *ops, void *ctx) {
    if (can == NULL || ops == NULL || ops->send == NULL || ops->receive == NULL ||
        ops->state == NULL || ops->set_filters == NULL || ops->restart == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *can = (struct hal_can){ops, ctx};
    return HAL_OK;
}

/// Queues a frame. Frames leave in the order in which they were queued, whatever their ids; the
/// sender does not receive them itself.
/// Returns:  HAL_OK;
///           HAL_BUSY: the queue is full, the frame was not taken. Normal for one tick; a queue
///           that stays full means that nobody acknowledges: look at the state; HAL_ERROR_DOWN:
///           bus-off. Restart; HAL_ERROR_ARGUMENT: can_frame_is_valid says no; HAL_ERROR_IO,
///           HAL_ERROR_GONE.
/// Cost:     a copy of 16 bytes; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_can_send(const struct hal_can *can,
                                                      const struct can_frame *frame) {
    if (frame == NULL || !can_frame_is_valid(frame)) {
        return HAL_ERROR_ARGUMENT;
    }
    return can->ops->send(can->ctx, frame);
}

/// Takes the oldest frame that arrived, in order of arrival.
/// *received_us: when it arrived, on the clock of the device's board, as well as the device knows:
///               the end of the frame or a little later.
/// Returns:  HAL_OK, and *frame is valid (can_frame_is_valid);
///           HAL_EMPTY: nothing has arrived; frames that did are still delivered in bus-off;
///           HAL_ERROR_IO: one try failed, no frame is lost by that; HAL_ERROR_GONE.
///           *frame and *received_us are set with HAL_OK only.
/// Cost:     a copy of 16 bytes; on Linux one system call.
MUST_CHECK static inline enum hal_status
hal_can_receive(const struct hal_can *can, struct can_frame *frame, uint32_t *received_us) {
    if (frame == NULL || received_us == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return can->ops->receive(can->ctx, frame, received_us);
}

/// Health and counters.
/// Returns:  HAL_OK; HAL_ERROR_IO, HAL_ERROR_GONE: *state is not set.
/// Cost:     two register reads; on Linux one system call, and one more for each error that came.
MUST_CHECK static inline enum hal_status hal_can_state(const struct hal_can *can,
                                                       struct hal_can_state *state) {
    if (state == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return can->ops->state(can->ctx, state);
}

/// From now on only frames that pass at least one of the filters are received; count 0: none.
/// A device starts with every frame received. What is in the receive queue stays there.
/// filters:  count of them, 0 to HAL_CAN_FILTERS_MAX; copied.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT, HAL_ERROR_IO, HAL_ERROR_GONE: the old filters hold.
/// Cost:     at start-up only: hardware may miss frames while its filters change.
MUST_CHECK static inline enum hal_status hal_can_set_filters(const struct hal_can *can,
                                                             const struct hal_can_filter *filters,
                                                             uint32_t count) {
    if (count > HAL_CAN_FILTERS_MAX || (count > 0U && filters == NULL)) {
        return HAL_ERROR_ARGUMENT;
    }
    return can->ops->set_filters(can->ctx, filters, count);
}

/// Begins to leave bus-off, which takes 128 x 11 recessive bits (1.4 ms at 1 Mbit/s and more on a
/// busy bus); the state tells when it is done. Frames that were queued when the controller went
/// bus-off are gone for good: a setpoint of then must not move anything now.
/// Returns:  HAL_OK; also, with no effect, if it is not bus-off or already on its way;
///           HAL_ERROR_DENIED: this program may not (on Linux: set restart-ms with `ip link`);
///           HAL_ERROR_IO, HAL_ERROR_GONE.
/// Cost:     a few register writes; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_can_restart(const struct hal_can *can) {
    return can->ops->restart(can->ctx);
}

/// Whether a frame passes a filter, for implementations that filter in software.
static inline bool hal_can_filter_passes(const struct hal_can_filter *filter,
                                         const struct can_frame *frame) {
    return ((frame->id ^ filter->id) & filter->id_mask) == 0U &&
           ((unsigned)(frame->flags ^ filter->flags) & filter->flags_mask) == 0U;
}

#endif
