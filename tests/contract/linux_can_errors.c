/// What error frames of SocketCAN and gs_usb mean, bit by bit, as linux/can/error.h names the bits.
#include "linux/linux_can_errors.h"
#include "contract/support/contract.h"

#include <linux/can/error.h>

static struct hal_can_state state;

static bool digest(enum hal_can_health before, uint32_t classes, uint8_t controller) {
    state = (struct hal_can_state){.health = before, 7, 8, 100};
    const uint8_t data[8] = {0, controller, 0, 0, 0, 0, 31, 32};
    return linux_can_digest_error(&state, classes, data);
}

static void expect(enum hal_can_health health, int transmit, int receive, int lost) {
    CHECK_EQ(state.health, health);
    CHECK_EQ(state.transmit_error_count, transmit);
    CHECK_EQ(state.receive_error_count, receive);
    CHECK_EQ(state.lost_count, 100 + lost);
}

static void bits_of_the_controller(void) {
    for (unsigned bit = 0; bit < 8U; bit++) {
        const unsigned now = 1U << bit;
        const bool passive = now == CAN_ERR_CRTL_RX_PASSIVE || now == CAN_ERR_CRTL_TX_PASSIVE;
        const bool active = now == CAN_ERR_CRTL_RX_WARNING || now == CAN_ERR_CRTL_TX_WARNING ||
                            now == CAN_ERR_CRTL_ACTIVE;
        const int lost = now == CAN_ERR_CRTL_RX_OVERFLOW;
        CHECK(!digest(HAL_CAN_PASSIVE, CAN_ERR_CRTL, (uint8_t)now));
        expect(active ? HAL_CAN_ACTIVE : HAL_CAN_PASSIVE,
               passive  ? 128
               : active ? 0
                        : 7,
               passive  ? 128
               : active ? 0
                        : 8,
               lost);
        CHECK(!digest(HAL_CAN_ACTIVE, CAN_ERR_CRTL | CAN_ERR_CNT, (uint8_t)now));
        expect(passive ? HAL_CAN_PASSIVE : HAL_CAN_ACTIVE, 31, 32, lost);
        CHECK(!digest(HAL_CAN_ACTIVE, CAN_ERR_PROT, (uint8_t)now)); // data 1 says nothing then
        expect(HAL_CAN_ACTIVE, 7, 8, 0);
    }
}

static void off_and_back(void) {
    CHECK(digest(HAL_CAN_ACTIVE, CAN_ERR_BUSOFF | CAN_ERR_CNT, 0));
    expect(HAL_CAN_OFF, 256, 0, 0);
    CHECK(!digest(HAL_CAN_OFF, CAN_ERR_CNT, 0)); // counters of a chip that is off mean nothing
    expect(HAL_CAN_OFF, 7, 8, 0);
    CHECK(!digest(HAL_CAN_OFF, CAN_ERR_RESTARTED, 0));
    expect(HAL_CAN_ACTIVE, 0, 0, 0);
    CHECK(!digest(HAL_CAN_PASSIVE, 0, 0xFF));
    expect(HAL_CAN_PASSIVE, 7, 8, 0);
}

int main(void) {
    CONTRACT("linux_can_errors", bits_of_the_controller);
    CONTRACT("linux_can_errors", off_and_back);
    return check_finish();
}
