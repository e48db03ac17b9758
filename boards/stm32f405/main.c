/// The image of the STM32F405: sets up the chip, then runs the loop that all boards share.
#include "devices.h"

#include "app/board_loop.h"
#include "compiled_rig.h"
#include "cortexm/cortexm.h"
#include "cortexm/cortexm_start.h"
#include "greeting.h"
#include "pins.h"
#include "scene.h"
#include "stm32f4/stm32f4_clocks.h"
#include "stm32f4/stm32f4_watchdog.h"
#include "switches.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TICK_US      1000U

struct board_devices_here devices;

static struct stm32f4_gpio gpio;
static struct stm32f4_pwm pwm;
static struct stm32f4_watchdog watchdog;
static struct board_loop loop;
static struct greeting greeting;

// ---------------------------------------------------------------- set-up

/// Returns why the board must not arm, or NULL.
static const char *set_up(void) {
    stm32f4_watchdog_init(&watchdog);
    const struct stm32f4_clocks clocks = stm32f4_clocks_start(CRYSTAL_MHZ);
    greeting_init(&greeting, "board: stm32f405");
    greeting_clock(&greeting, clocks.core_hz, stm32f4_clocks_state_name(clocks.state), "");
    // The only one of this chip is that of its clock monitor (RM0090 7.2.7).
    greeting_crash(&greeting, "the crystal stopped, exception");
    cortexm_clock_start(&devices.clock, clocks.core_hz, TICK_US);
    stm32f4_gpio_init(&gpio, gpio_lines, gpio_pins, COUNT(gpio_lines));
    stm32f4_pwm_init(&pwm, pwm_channels, COUNT(pwm_channels), clocks.apb1_timer_hz);
    stm32f4_gpio_set_alternate(CONSOLE_TX, CONSOLE_AF, HAL_GPIO_PULL_NONE);
    stm32f4_gpio_set_alternate(CONSOLE_RX, CONSOLE_AF, HAL_GPIO_PULL_UP);
    stm32f4_usart_init(&devices.console, STM32F4_USART1, STM32F4_IRQ_USART1, clocks.apb2_hz,
                       CONSOLE_BAUD);
    stm32f4_can_init(&devices.can, &devices.clock);
    if (clocks.state != STM32F4_CLOCKS_FULL) {
        return stm32f4_clocks_state_name(clocks.state); // and a wrong clock disturbs the bus
    }
    stm32f4_gpio_set_alternate(CAN_TX, CAN_AF, HAL_GPIO_PULL_NONE);
    stm32f4_gpio_set_alternate(CAN_RX, CAN_AF, HAL_GPIO_PULL_UP);
    return stm32f4_can_start(&devices.can) == HAL_OK ? NULL : "the CAN controller does not start";
}

int main(void) {
    static struct board_config config = {.controller = &compiled_rig,
                                         .stop_lines = stop_lines,
                                         .stop_line_count = COUNT(stop_lines),
                                         .enable_line = LINE_ENABLE,
                                         .notes = greeting.notes};
    // Until the watchdog runs nothing may interrupt: a storm would hang the board for good.
    cortexm_interrupts_disable();
    config.refusal = set_up();
    scene_open();
    board_loop_init(
        &loop, &config,
        &(struct board_devices){
            .pump = {.clock = &devices.clock.hal, .can = &devices.can.hal, .pwm = &pwm.hal},
            .gpio = &gpio.hal,
            .console = &devices.console.hal,
            .watchdog = &watchdog.hal});
    scene_attach(&loop);
    cortexm_interrupts_enable();
    uint32_t tick = devices.clock.ticks;
    for (;;) {
        const uint32_t next = cortexm_clock_wait_tick(&devices.clock, tick);
        board_loop_tick(&loop, next - tick - 1U);
        tick = next;
        scene_work(&loop);
    }
}
