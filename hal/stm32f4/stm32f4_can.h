/// CAN1 (bxCAN): frames in both directions through queues that the interrupt handlers work on.
///
/// - Sending: 16 frames in the queue and 3 in the mailboxes, in order. What could not be sent for
///   20 ms (nobody acknowledges: the cable is out) is dropped with the next send, so that no stale
///   setpoint moves anything when the cable is back; counted in dropped_count.
/// - Bus-off: everything queued is dropped; only a restart leads back.
/// - Filters: a bank each. One that leaves the kind of frame open passes everything in hardware,
///   because standard and extended ids lie at different places there; the handler then looks again.
/// Shown: tests/mcu/hal/suites.c.
#ifndef STM32F4_STM32F4_CAN_H
#define STM32F4_STM32F4_CAN_H

#include "cortexm/cortexm_clock.h"
#include "cortexm/cortexm_ring.h"
#include "hal/can.h"
#include "stm32f4/stm32f4_registers.h"

/// Powers of two. A 1 Mbit/s bus carries 9 frames of 8 bytes a millisecond.
#define STM32F4_CAN_RECEIVE_FRAMES 32U
#define STM32F4_CAN_SEND_FRAMES    16U

struct stm32f4_can {
    struct hal_can hal;
    const struct cortexm_clock *clock;
    bool started;
    bool restarting; ///< on its way out of bus-off
    struct cortexm_ring received, sending;
    struct can_frame receive_frame[STM32F4_CAN_RECEIVE_FRAMES];
    uint32_t received_us[STM32F4_CAN_RECEIVE_FRAMES];
    struct can_frame send_frame[STM32F4_CAN_SEND_FRAMES];
    volatile uint32_t sent_us;    ///< when a frame left last, or the queue began to fill
    volatile bool drop;           ///< asks the handler to drop all that is queued
    volatile uint32_t lost_count; ///< received, no room
    volatile uint32_t dropped_count;
    uint32_t filter_count;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX];
};

/// Not yet on the bus: sends are answered with HAL_ERROR_DOWN, and it stays so without an exact
/// clock. Restart has no effect.
void stm32f4_can_init(struct stm32f4_can *can, const struct cortexm_clock *clock);

/// Joins the bus at 1 Mbit/s; every frame is received. bus_hz: 42 MHz. Pins are the caller's
/// business.
/// Returns: HAL_OK; HAL_ERROR_IO: the block does not answer: not on the bus. Until the bus has been
///          quiet for 11 bits, the state says bus-off.
enum hal_status stm32f4_can_start(struct stm32f4_can *can) MUST_CHECK;

/// The handlers: of its transmit and status interrupts, and of receive FIFO 0.
void stm32f4_can_on_transmit(struct stm32f4_can *can);
void stm32f4_can_on_receive(struct stm32f4_can *can);

#endif
