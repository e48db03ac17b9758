#include "linux/linux_can_errors.h"

enum controller_state { // in data 1
    RECEIVE_OVERFLOW = 0x01,
    RECEIVE_WARNING = 0x04,
    TRANSMIT_WARNING = 0x08,
    RECEIVE_PASSIVE = 0x10,
    TRANSMIT_PASSIVE = 0x20,
    ACTIVE = 0x40
};

void linux_can_set_health(struct hal_can_state *state, enum hal_can_health health) {
    static const uint16_t stand_in[] = {
        [HAL_CAN_ACTIVE] = 0, [HAL_CAN_PASSIVE] = 128, [HAL_CAN_OFF] = 256};
    state->health = health;
    state->transmit_error_count = stand_in[health];
    state->receive_error_count = health == HAL_CAN_PASSIVE ? 128 : 0;
}

bool linux_can_digest_error(struct hal_can_state *state, uint32_t classes, const uint8_t data[8]) {
    if ((classes & LINUX_CAN_ERROR_CONTROLLER) != 0U) {
        const unsigned now = data[1];
        state->lost_count += (now & RECEIVE_OVERFLOW) != 0U;
        if ((now & (RECEIVE_PASSIVE | TRANSMIT_PASSIVE)) != 0U) {
            linux_can_set_health(state, HAL_CAN_PASSIVE);
        } else if ((now & (RECEIVE_WARNING | TRANSMIT_WARNING | ACTIVE)) != 0U) {
            linux_can_set_health(state, HAL_CAN_ACTIVE);
        }
    }
    if ((classes & LINUX_CAN_ERROR_RESTARTED) != 0U) {
        linux_can_set_health(state, HAL_CAN_ACTIVE);
    }
    if ((classes & LINUX_CAN_ERROR_OFF) != 0U) {
        linux_can_set_health(state, HAL_CAN_OFF);
        return true;
    }
    if ((classes & LINUX_CAN_ERROR_COUNTERS) != 0U && state->health != HAL_CAN_OFF) {
        state->transmit_error_count = data[6];
        state->receive_error_count = data[7];
    }
    return false;
}
