/// The contract suites of the HAL on the drivers of the STM32F405, on the emulated chip: the far
/// side of the devices. The suites and their verdicts are the image's (tests/mcu/hal/suites.c).
#include "check.h"
#include "devices/bus_node_hal.h"
#include "mcu/can_port.h"
#include "mcu/hal/host_call.h"
#include "mcu/machine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEARD_BYTES 65536U
#define SECONDS_MAX 600U

static struct machine machine;
static struct can_bus bus;
static struct can_port port;
static struct bus_node_hal node;
static uint8_t heard[HEARD_BYTES];
static uint32_t heard_put, heard_taken, badly_framed;
static int exit_status = -1;

static void on_byte(void *context, uint8_t byte, bool framed) {
    (void)context;
    badly_framed += !framed;
    heard[heard_put++ % HEARD_BYTES] = byte;
}

static void new_line(uint32_t baud) {
    const struct usart_line line = {
        .baud = baud, .tx_pin = GPIO_PIN('A', 9), .rx_pin = GPIO_PIN('A', 10), .heard = on_byte};
    usart_connect(&machine.soc.usart[0], &line);
    heard_put = heard_taken = 0;
}

static void measure_pulse(uint32_t pin, uint32_t answer[2]) {
    struct soc *soc = &machine.soc;
    const struct gpio_function function = gpio_connection(soc, pin);
    if (function.signal != GPIO_SIGNAL_TIMER) {
        return;
    }
    const struct timer_pulse pulse = timer_pulse_of(&soc->timer[function.part], function.channel);
    answer[0] = (uint32_t)(pulse.high_cycles * UINT64_C(1000000000) / soc->hclk_hz);
    answer[1] = (uint32_t)(pulse.period_cycles * UINT64_C(1000000000) / soc->hclk_hz);
}

/// The bus has its own pace; what happens now happens at the chip's time.
static void keep_up(void) {
    can_port_run(&port, soc_now_ns(&machine.soc));
}

static void new_node(void) {
    const uint64_t now_ns = soc_now_ns(&machine.soc);
    can_bus_init(&bus, 1000000, 1);
    can_bus_run_until(&bus, now_ns);
    CHECK(can_port_init(&port, &machine.soc, 0, &bus, GPIO_PIN('B', 9), GPIO_PIN('B', 8)));
    CHECK(bus_node_hal_init(&node, &bus, 0));
}

static void on_world(void *context) {
    (void)context;
    keep_up();
}

static void serve_bus(struct host_call *call) {
    struct can_frame frame;
    struct hal_can_state state;
    struct hal_can_filter filters[HAL_CAN_FILTERS_MAX + 1];
    const uint32_t filter_bytes = call->argument * (uint32_t)sizeof filters[0];
    switch (call->operation) {
    case HOST_BUS_RESET:
        new_node();
        break;
    case HOST_BUS_SEND:
        CHECK(cpu_load(&machine.cpu, call->address, &frame, sizeof frame));
        call->answer[0] = (uint32_t)hal_can_send(&node.hal, &frame);
        break;
    case HOST_BUS_RECEIVE:
        call->answer[0] = (uint32_t)hal_can_receive(&node.hal, &frame, &call->answer[1]);
        CHECK((enum hal_status)call->answer[0] != HAL_OK ||
              cpu_store(&machine.cpu, call->address, &frame, sizeof frame));
        break;
    case HOST_BUS_STATE:
        CHECK_EQ(hal_can_state(&node.hal, &state), HAL_OK);
        call->answer[0] = state.health;
        call->answer[1] = state.transmit_error_count;
        call->answer[2] = state.receive_error_count;
        call->answer[3] = state.lost_count;
        break;
    case HOST_BUS_FILTERS:
        CHECK(filter_bytes <= sizeof filters &&
              (filter_bytes == 0U || cpu_load(&machine.cpu, call->address, filters, filter_bytes)));
        call->answer[0] = (uint32_t)hal_can_set_filters(&node.hal, filters, call->argument);
        break;
    default:
        port.shorted = call->argument != 0U;
        if (port.shorted && bus.busy) {
            bus.current.fate = CAN_DESTROYED; // the one on the wire, too
        }
        break;
    }
}

static void serve_line(struct host_call *call) {
    static uint8_t bytes[4096];
    const uint32_t size = call->size < sizeof bytes ? call->size : (uint32_t)sizeof bytes;
    if (call->operation == HOST_LINE_WRITE) {
        CHECK(cpu_load(&machine.cpu, call->address, bytes, size));
        call->answer[0] = usart_send(&machine.soc.usart[0], bytes, size);
        return;
    }
    uint32_t count = 0;
    while (count < size && heard_taken != heard_put) {
        bytes[count++] = heard[heard_taken++ % HEARD_BYTES];
    }
    CHECK(cpu_store(&machine.cpu, call->address, bytes, count));
    call->answer[0] = count;
}

static void serve(struct host_call *call) {
    struct soc *soc = &machine.soc;
    static char text[4096];
    switch (call->operation) {
    case HOST_WRITE:
        if (CHECK(call->size <= sizeof text &&
                  cpu_load(&machine.cpu, call->address, text, call->size))) {
            fwrite(text, 1, call->size, stdout);
        }
        break;
    case HOST_EXIT:
        exit_status = (int)call->argument;
        break;
    case HOST_NOW:
        call->answer[0] = (uint32_t)(soc_now_ns(soc) / 1000U);
        break;
    case HOST_PIN_DRIVE:
        gpio_drive(soc, call->argument,
                   call->size == 0U   ? GPIO_FLOATING
                   : call->size == 1U ? GPIO_LOW
                                      : GPIO_HIGH);
        break;
    case HOST_PIN_LEVEL:
        call->answer[0] = gpio_level(soc, call->argument);
        break;
    case HOST_PULSE:
        measure_pulse(call->argument, call->answer);
        break;
    case HOST_LINE_RESET:
        new_line(call->argument);
        break;
    case HOST_LINE_WRITE:
    case HOST_LINE_READ:
        serve_line(call);
        break;
    default:
        keep_up();
        serve_bus(call);
        keep_up();
        break;
    }
}

static void on_call(void *context, struct cpu *cpu, uint32_t address) {
    (void)context, (void)address;
    struct host_call call;
    const uint32_t at = cpu_register(cpu, 0);
    if (CHECK(cpu_load(cpu, at, &call, sizeof call))) {
        serve(&call);
        CHECK(cpu_store(cpu, at, &call, sizeof call));
    }
}

/// The verdicts in between are the image's.
static void the_image_comes_to_its_end(void) {
    struct machine_options options = machine_defaults();
    struct image_symbol symbol;
    options.soc.log = stdout;
    const char *wrong = machine_start(&machine, "build/mcu/hal/suites.elf", &options);
    if (wrong != NULL || !image_symbol(&machine.image, "host_call", &symbol)) {
        printf("suites.elf: %s\n", wrong != NULL ? wrong : "has no host_call");
        CHECK(false);
        return;
    }
    machine.soc.world = on_world;
    new_node();
    machine.cpu.watcher = on_call;
    cpu_watch(&machine.cpu, symbol.address & ~1U, true);
    for (uint64_t ms = 1; ms <= SECONDS_MAX * UINT64_C(1000) && exit_status < 0; ms++) {
        cpu_run(&machine.cpu, ms * 1000000U);
    }
    CHECK(exit_status >= 0);
    CHECK_EQ(machine.cpu.resets, 0);
    CHECK_EQ(machine.soc.complaints, 0);
    CHECK_EQ(badly_framed, 0);
    printf("# %.1f seconds on the chip\n", (double)soc_now_ns(&machine.soc) * 1e-9);
    machine_free(&machine);
}

int main(void) {
    TEST(the_image_comes_to_its_end);
    return check_finish() != 0 || exit_status != 0;
}
