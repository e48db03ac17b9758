#include "devices/fake_can.h"

#include "devices/fake_bind.h"

static bool is_full(const struct fake_can_queue *queue) {
    return queue->count == queue->capacity;
}

static void put(struct fake_can_queue *queue, const struct can_frame *frame, uint32_t now_us) {
    const uint32_t at = (queue->head + queue->count) % FAKE_CAN_QUEUE_FRAMES;
    queue->frames[at] = *frame;
    queue->times_us[at] = now_us;
    queue->count++;
}

static void drop_oldest(struct fake_can_queue *queue) {
    queue->head = (queue->head + 1U) % FAKE_CAN_QUEUE_FRAMES;
    queue->count--;
}

static enum hal_status fake_can_send(void *ctx, const struct can_frame *frame) {
    struct fake_can *can = ctx;
    const enum hal_status status = fake_failures_call(&can->failures);
    if (status != HAL_OK) {
        return status;
    }
    if (can->state.health == HAL_CAN_OFF) {
        return HAL_ERROR_DOWN;
    }
    if (is_full(&can->sending)) {
        return HAL_BUSY;
    }
    put(&can->sending, frame, 0);
    return HAL_OK;
}

static enum hal_status fake_can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    struct fake_can *can = ctx;
    const enum hal_status status = fake_failures_call(&can->failures);
    if (status != HAL_OK) {
        return status;
    }
    struct fake_can_queue *queue = &can->received;
    if (queue->count == 0U) {
        return HAL_EMPTY;
    }
    *frame = queue->frames[queue->head];
    *received_us = queue->times_us[queue->head];
    drop_oldest(queue);
    return HAL_OK;
}

static enum hal_status fake_can_state(void *ctx, struct hal_can_state *state) {
    struct fake_can *can = ctx;
    const enum hal_status status = fake_failures_call(&can->failures);
    if (status == HAL_OK) {
        *state = can->state;
    }
    return status;
}

static enum hal_status fake_can_set_filters(void *ctx, const struct hal_can_filter *filters,
                                            uint32_t count) {
    struct fake_can *can = ctx;
    const enum hal_status status = fake_failures_call(&can->failures);
    if (status == HAL_OK) {
        for (uint32_t i = 0; i < count; i++) {
            can->filters[i] = filters[i];
        }
        can->filter_count = count;
    }
    return status;
}

static enum hal_status fake_can_restart(void *ctx) {
    struct fake_can *can = ctx;
    const enum hal_status status = fake_failures_call(&can->failures);
    if (status == HAL_OK) {
        can->recovering = can->state.health == HAL_CAN_OFF;
    }
    return status;
}

static const struct hal_can_ops ops = {fake_can_send, fake_can_receive, fake_can_state,
                                       fake_can_set_filters, fake_can_restart};

void fake_can_init(struct fake_can *can, const struct hal_clock *clock, uint32_t send_capacity,
                   uint32_t receive_capacity) {
    *can = (struct fake_can){.clock = clock,
                             .sending.capacity = send_capacity,
                             .received.capacity = receive_capacity,
                             .filter_count = 1}; // one filter of zeros lets everything pass
    if (send_capacity - 1U >= FAKE_CAN_QUEUE_FRAMES ||
        receive_capacity - 1U >= FAKE_CAN_QUEUE_FRAMES) {
        abort();
    }
    fake_bind_check(hal_can_bind(&can->hal, &ops, can));
}

const struct can_frame *fake_can_next(const struct fake_can *can) {
    return can->sending.count == 0U ? NULL : &can->sending.frames[can->sending.head];
}

void fake_can_take(struct fake_can *can) {
    if (can->sending.count > 0U) {
        drop_oldest(&can->sending);
    }
}

void fake_can_give(struct fake_can *can, const struct can_frame *frame) {
    bool wanted = false;
    for (uint32_t i = 0; i < can->filter_count && !wanted; i++) {
        wanted = hal_can_filter_passes(&can->filters[i], frame);
    }
    if (!wanted || can->state.health == HAL_CAN_OFF) {
        return;
    }
    if (is_full(&can->received)) {
        can->state.lost_count++;
        return;
    }
    put(&can->received, frame, hal_clock_now_us(can->clock));
}

void fake_can_set_errors(struct fake_can *can, uint16_t transmit, uint16_t receive) {
    can->state.transmit_error_count = transmit;
    can->state.receive_error_count = receive;
    if (can->state.health == HAL_CAN_OFF) {
        return;
    }
    if (transmit > 255U) {
        can->state.health = HAL_CAN_OFF;
        can->sending.count = 0;
    } else {
        can->state.health = transmit > 127U || receive > 127U ? HAL_CAN_PASSIVE : HAL_CAN_ACTIVE;
    }
}

void fake_can_recover(struct fake_can *can) {
    if (can->recovering) {
        can->recovering = false;
        can->state.health = HAL_CAN_ACTIVE;
        can->state.transmit_error_count = 0;
        can->state.receive_error_count = 0;
    }
}

/// Moves one frame; false if there was none.
static bool carry_one(struct fake_can *from, struct fake_can *to) {
    const struct can_frame *next = fake_can_next(from);
    if (next == NULL) {
        return false;
    }
    fake_can_give(to, next);
    fake_can_take(from);
    return true;
}

void fake_can_carry(struct fake_can *a, struct fake_can *b) {
    fake_can_recover(a);
    fake_can_recover(b);
    bool moved = true;
    while (moved) {
        moved = carry_one(a, b);
        moved = carry_one(b, a) || moved;
    }
}
