/// The vector table (RM0090 12.2, table 62): whatever is not handled here is a crash.
#include "devices.h"

#include "cortexm/cortexm_crash.h"
#include "cortexm/cortexm_start.h"

enum { SYSTICK = 15, CORE_VECTORS = 16 };

static void on_tick(void) {
    cortexm_clock_on_tick(&devices.clock);
}

static void on_can_transmit(void) {
    stm32f4_can_on_transmit(&devices.can);
}

static void on_can_receive(void) {
    stm32f4_can_on_receive(&devices.can);
}

static void on_console(void) {
    stm32f4_usart_on_interrupt(&devices.console);
}

#define IRQ(name) CORE_VECTORS + STM32F4_IRQ_##name
#define CRASH     cortexm_crash_handler

extern void (*const vectors[])(void);

__attribute__((section(".vectors"),
               used)) void (*const vectors[CORE_VECTORS + STM32F4_IRQ_COUNT])(void) = {
    (void (*)(void))(void *)stack_top,
    reset_handler,
    [2 ... SYSTICK - 1] = CRASH,
    [SYSTICK] = on_tick,
    [CORE_VECTORS... IRQ(CAN1_TX) - 1] = CRASH,
    [IRQ(CAN1_TX)] = on_can_transmit,
    [IRQ(CAN1_RX0)] = on_can_receive,
    [IRQ(CAN1_RX1)] = CRASH,
    [IRQ(CAN1_SCE)] = on_can_transmit,
    [IRQ(CAN1_SCE) + 1 ... IRQ(USART1) - 1] = CRASH,
    [IRQ(USART1)] = on_console,
    [IRQ(USART1) + 1 ... CORE_VECTORS + STM32F4_IRQ_COUNT - 1] = CRASH,
};
