/// The contract suites of hal/include/hal on the drivers of the STM32F405, on the emulated chip.
///
/// The far side (the other node of the bus, the other end of the line, what is on the pins) is the
/// emulator's, by host_call. The watchdog has no suite here: it would reset the test.
#include "devices.h"
#include "host_call.h"

#include "check.h"
#include "contract/support/can_suite.h"
#include "contract/support/clock_suite.h"
#include "contract/support/gpio_suite.h"
#include "contract/support/pwm_suite.h"
#include "contract/support/serial_suite.h"
#include "cortexm/cortexm.h"
#include "cortexm/cortexm_start.h"
#include "pins.h"
#include "stm32f4/stm32f4_clocks.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

void host_call(struct host_call *call);

struct board_devices_here devices;
static struct stm32f4_clocks clocks;

/// Watched by the emulator.
__attribute__((noinline)) void host_call(struct host_call *call) {
    __asm volatile("" ::"r"(call) : "memory");
}

static struct host_call ask(enum host_operation operation, uint32_t argument, const void *address,
                            size_t size) {
    struct host_call call = {operation, argument, (uint32_t)(uintptr_t)address, size, {0}};
    host_call(&call);
    return call;
}

void check_write(const char *text, size_t size) {
    (void)ask(HOST_WRITE, 0, text, size);
}

static uint32_t host_now_us(void) {
    return ask(HOST_NOW, 0, NULL, 0).answer[0];
}

static void pass(void *context, uint32_t span_us) {
    (void)context;
    const uint32_t start = host_now_us();
    while (host_now_us() - start <= span_us) { // both ends are cut to microseconds
    }
}

/// Asleep, which takes the emulator no time: ticks of the clock, which its own suite has checked.
static void sleep_ms(uint32_t ms) {
    uint32_t tick = devices.clock.ticks;
    for (uint32_t i = 0; i <= ms; i++) {
        tick = cortexm_clock_wait_tick(&devices.clock, tick);
    }
}

// ---------------------------------------------------------------- clock

static void start_at(void *context, uint32_t start_us) {
    (void)context;
    cortexm_interrupts_disable();
    CORTEXM_SYSTICK->value = 0;
    devices.clock.ticks = start_us / 1000U;
    cortexm_interrupts_enable();
    while (cortexm_clock_now_us(&devices.clock) - start_us >= 0x80000000U) {
    }
}

// ---------------------------------------------------------------- pins

static const struct hal_gpio_line lines[] = {
    {.direction = HAL_GPIO_INPUT, .pull = HAL_GPIO_PULL_UP, .active_low = true},
    {.direction = HAL_GPIO_INPUT, .pull = HAL_GPIO_PULL_UP},
    {.direction = HAL_GPIO_INPUT, .pull = HAL_GPIO_PULL_DOWN},
    {.direction = HAL_GPIO_INPUT, .pull = HAL_GPIO_PULL_NONE, .active_low = true},
    {.direction = HAL_GPIO_OUTPUT, .initially_active = true},
    {.direction = HAL_GPIO_OUTPUT, .active_low = true},
    {.direction = HAL_GPIO_OUTPUT, .active_low = true, .initially_active = true},
    {.direction = HAL_GPIO_OUTPUT},
};
static const struct stm32f4_pin line_pins[] = {{PORT_C, 0}, {PORT_A, 1},  {PORT_B, 15},
                                               {PORT_C, 3}, {PORT_C, 13}, {PORT_A, 0},
                                               {PORT_B, 2}, {PORT_C, 4}};
static struct stm32f4_gpio gpio;

static uint32_t number_of(struct stm32f4_pin pin) {
    return pin.port * 16U + pin.bit;
}

static void reset_gpio(void *context) {
    (void)context;
    for (uint32_t i = 0; i < COUNT(lines); i++) {
        (void)ask(HOST_PIN_DRIVE, number_of(line_pins[i]), NULL, 0);
    }
    stm32f4_gpio_init(&gpio, lines, line_pins, COUNT(lines));
}

static void drive_pin(void *context, uint32_t line, bool high) {
    (void)context;
    (void)ask(HOST_PIN_DRIVE, number_of(line_pins[line]), NULL, high ? 2U : 1U);
}

static bool pin_is_high(void *context, uint32_t line) {
    (void)context;
    return ask(HOST_PIN_LEVEL, number_of(line_pins[line]), NULL, 0).answer[0] != 0U;
}

// ---------------------------------------------------------------- pulses

static struct stm32f4_pwm pwm;

static void reset_pwm(void *context) {
    (void)context;
    stm32f4_pwm_init(&pwm, pwm_channels, COUNT(pwm_channels), clocks.apb1_timer_hz);
}

static void measure(void *context, uint32_t channel, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    sleep_ms(33); // the longest period
    const struct host_call call = ask(HOST_PULSE, number_of(pwm_channels[channel].pin), NULL, 0);
    *pulse_ns = call.answer[0];
    *period_ns = call.answer[1];
    struct hal_pwm_limits limits;
    if (*period_ns == 0U && CHECK_EQ(hal_pwm_limits(&pwm.hal, channel, &limits), HAL_OK)) {
        *period_ns = limits.period_ns; // a line that does not move shows none
    }
}

// ---------------------------------------------------------------- serial line

static void reset_serial(void *context) {
    (void)context;
    sleep_ms(100); // what the last test sent
    (void)ask(HOST_LINE_RESET, CONSOLE_BAUD, NULL, 0);
    stm32f4_usart_init(&devices.console, STM32F4_USART1, STM32F4_IRQ_USART1, clocks.apb2_hz,
                       CONSOLE_BAUD);
}

static size_t peer_write(void *context, const uint8_t *data, size_t size_bytes) {
    (void)context;
    return ask(HOST_LINE_WRITE, 0, data, size_bytes).answer[0];
}

static size_t peer_read(void *context, uint8_t *data, size_t capacity_bytes) {
    (void)context;
    return ask(HOST_LINE_READ, 0, data, capacity_bytes).answer[0];
}

static void settle_serial(void *context) {
    (void)context;
    sleep_ms(50); // the receive queue full, and more
}

// ---------------------------------------------------------------- bus

static enum hal_status peer_send(void *ctx, const struct can_frame *frame) {
    (void)ctx;
    return (enum hal_status)ask(HOST_BUS_SEND, 0, frame, sizeof *frame).answer[0];
}

static enum hal_status peer_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    (void)ctx;
    const struct host_call call = ask(HOST_BUS_RECEIVE, 0, frame, sizeof *frame);
    if (call.answer[0] == HAL_OK) {
        *received_us = call.answer[1];
    }
    return (enum hal_status)call.answer[0];
}

static enum hal_status peer_state(void *ctx, struct hal_can_state *state) {
    (void)ctx;
    const struct host_call call = ask(HOST_BUS_STATE, 0, NULL, 0);
    *state = (struct hal_can_state){.health = (enum hal_can_health)call.answer[0],
                                    .transmit_error_count = (uint16_t)call.answer[1],
                                    .receive_error_count = (uint16_t)call.answer[2],
                                    .lost_count = call.answer[3]};
    return HAL_OK;
}

static enum hal_status peer_set_filters(void *ctx, const struct hal_can_filter *filters,
                                        uint32_t count) {
    (void)ctx;
    return (enum hal_status)ask(HOST_BUS_FILTERS, count, filters, 0).answer[0];
}

static enum hal_status peer_restart(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static uint32_t peer_now_us(void *ctx) {
    (void)ctx;
    return host_now_us();
}

static const struct hal_can_ops peer_can_ops = {peer_send, peer_receive, peer_state,
                                                peer_set_filters, peer_restart};
static const struct hal_clock_ops peer_clock_ops = {peer_now_us};
static const struct hal_can peer = {&peer_can_ops, NULL};
static const struct hal_clock peer_clock = {&peer_clock_ops, NULL};

/// RM0090 7.3.8: CAN1RST. The block forgets its errors and what it holds.
static void reset_bus(void *context) {
    (void)context;
    sleep_ms(4); // what the last test sent
    (void)ask(HOST_BUS_SHORT, 0, NULL, 0);
    (void)ask(HOST_BUS_RESET, 0, NULL, 0);
    cortexm_interrupts_disable();
    STM32F4_RCC->apb1rstr |= 1U << 25;
    STM32F4_RCC->apb1rstr &= ~(1U << 25);
    stm32f4_can_init(&devices.can, &devices.clock);
    CHECK_EQ(stm32f4_can_start(&devices.can), HAL_OK);
    cortexm_interrupts_enable();
    sleep_ms(1); // it joins after 11 quiet bits
}

static void settle_bus(void *context) {
    (void)context;
    sleep_ms(4); // 32 frames, or the recovery of a node that was off
}

static void drive_off(void *context) {
    (void)context;
    (void)ask(HOST_BUS_SHORT, 1, NULL, 0);
    sleep_ms(10);
    (void)ask(HOST_BUS_SHORT, 0, NULL, 0);
}

static void run_can_suites(void) {
    stm32f4_gpio_set_alternate(CAN_TX, CAN_AF, HAL_GPIO_PULL_NONE);
    stm32f4_gpio_set_alternate(CAN_RX, CAN_AF, HAL_GPIO_PULL_UP);
    reset_bus(NULL);
    can_suite(&(struct can_fixture){.name = "stm32f4_can_sends",
                                    .a = &devices.can.hal,
                                    .b = &peer,
                                    .clock = &peer_clock,
                                    .reset = reset_bus,
                                    .settle = settle_bus,
                                    .bus_off = drive_off,
                                    .receive_capacity = 64,
                                    .send_capacity = STM32F4_CAN_SEND_FRAMES + 3U});
    reset_bus(NULL);
    can_suite(&(struct can_fixture){.name = "stm32f4_can_receives",
                                    .a = &peer,
                                    .b = &devices.can.hal,
                                    .clock = &devices.clock.hal,
                                    .reset = reset_bus,
                                    .settle = settle_bus,
                                    .receive_capacity = STM32F4_CAN_RECEIVE_FRAMES});
}

int main(void) {
    clocks = stm32f4_clocks_start(CRYSTAL_MHZ);
    cortexm_clock_start(&devices.clock, clocks.core_hz, 1000);
    clock_suite(&(struct clock_fixture){.name = "cortexm_clock",
                                        .clock = &devices.clock.hal,
                                        .start_at = start_at,
                                        .pass = pass,
                                        .slack_us = 3});
    reset_gpio(NULL);
    gpio_suite(&(struct gpio_fixture){.name = "stm32f4_gpio",
                                      .gpio = &gpio.hal,
                                      .lines = lines,
                                      .line_count = COUNT(lines),
                                      .reset = reset_gpio,
                                      .drive = drive_pin,
                                      .is_high = pin_is_high});
    reset_pwm(NULL);
    pwm_suite(&(struct pwm_fixture){.name = "stm32f4_pwm",
                                    .pwm = &pwm.hal,
                                    .channel_count = COUNT(pwm_channels),
                                    .reset = reset_pwm,
                                    .measure = measure,
                                    .measure_error_ns = 1});
    stm32f4_gpio_set_alternate(CONSOLE_TX, CONSOLE_AF, HAL_GPIO_PULL_NONE);
    stm32f4_gpio_set_alternate(CONSOLE_RX, CONSOLE_AF, HAL_GPIO_PULL_UP);
    reset_serial(NULL);
    serial_suite(&(struct serial_fixture){.name = "stm32f4_usart",
                                          .serial = &devices.console.hal,
                                          .reset = reset_serial,
                                          .peer_write = peer_write,
                                          .peer_read = peer_read,
                                          .settle = settle_serial,
                                          .receive_capacity = STM32F4_USART_RECEIVE_BYTES});
    run_can_suites();
    (void)ask(HOST_EXIT, (uint32_t)check_finish(), NULL, 0);
    for (;;) {
        cortexm_wait_for_interrupt();
    }
}
