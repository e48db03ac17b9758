#include "mcu/mcu_board.h"

#include "replay/layout.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------- wiring

// boards/stm32f405/README.md, "Wiring".
#define CAN_TX         GPIO_PIN('B', 9)
#define CAN_RX         GPIO_PIN('B', 8)
#define CONSOLE_TX     GPIO_PIN('A', 9)
#define CONSOLE_RX     GPIO_PIN('A', 10)
#define CONSOLE_BAUD   115200U
#define CONSOLE        0U // USART1
#define EMERGENCY_STOP GPIO_PIN('C', 0)
#define KEY_SWITCH     GPIO_PIN('C', 1)
#define PAN_LIMIT      GPIO_PIN('C', 2)
#define TILT_LIMIT     GPIO_PIN('C', 3)
#define SERVO_SUPPLY   GPIO_PIN('C', 4)
#define STORM_IRQ      37U // USART1, the console
#define STRAY_IRQ      38U // USART2, which nothing uses

static const unsigned servo_pins[MCU_BOARD_SERVOS] = {GPIO_PIN('C', 6), GPIO_PIN('C', 7),
                                                      GPIO_PIN('C', 8), GPIO_PIN('C', 9),
                                                      GPIO_PIN('B', 6), GPIO_PIN('B', 7)};

/// A servo takes about 50 pulses a second.
#define PERIOD_NS_MIN UINT64_C(5000000)
#define PERIOD_NS_MAX UINT64_C(25000000)

/// What comes out of a servo output, as pulse width. 0: no pulses.
static uint32_t pulse_at(struct soc *soc, unsigned pin) {
    const struct gpio_function function = gpio_connection(soc, pin);
    if (function.signal != GPIO_SIGNAL_TIMER) {
        return 0;
    }
    const struct timer_pulse pulse = timer_pulse_of(&soc->timer[function.part], function.channel);
    if (pulse.period_cycles == 0U) {
        return 0;
    }
    const uint64_t hz = soc->hclk_hz, second = UINT64_C(1000000000);
    const uint64_t period_ns = pulse.period_cycles * second / hz;
    if (period_ns < PERIOD_NS_MIN || period_ns > PERIOD_NS_MAX) {
        soc_complain(soc, "a servo output has a period of %llu us",
                     (unsigned long long)period_ns / 1000U);
        return 0;
    }
    return (uint32_t)((pulse.high_cycles * second + hz / 2U) / hz);
}

static void give_pulses(struct mcu_board *board) {
    struct soc *soc = &board->machine.soc;
    const bool supplied = gpio_output(soc, SERVO_SUPPLY) == GPIO_HIGH;
    for (unsigned i = 0; i < MCU_BOARD_SERVOS; i++) {
        board->sim->pulse_ns[i] = supplied ? pulse_at(soc, servo_pins[i]) : 0U;
    }
}

// ---------------------------------------------------------------- console

static void end_line(struct mcu_board *board) {
    board->line[board->line_bytes] = '\0';
    board->line_bytes = 0;
    board->lines++;
    memcpy(board->last_line, board->line, sizeof board->line);
    if (board->options.console != NULL) {
        fprintf(board->options.console, "%.3f %s\n", (double)soc_now_ns(&board->machine.soc) * 1e-9,
                board->line);
    }
}

static void on_console_byte(void *context, uint8_t byte, bool framed) {
    struct mcu_board *board = context;
    board->garbled += !framed;
    if (board->options.serial != NULL) {
        serial_pty_write(board->options.serial, byte);
    }
    if (byte == '\n') {
        end_line(board);
    } else if (byte != '\r') {
        board->line[board->line_bytes++] = byte >= ' ' && byte < 127U ? (char)byte : '?';
        if (board->line_bytes == sizeof board->line - 1U) {
            end_line(board);
        }
    }
}

// ---------------------------------------------------------------- faults

static const char *const fault_names[MCU_FAULT_COUNT] = {
    [MCU_FAULT_HSE_STUCK] = "hse-stuck",
    [MCU_FAULT_PLL_STUCK] = "pll-stuck",
    [MCU_FAULT_SWITCH_STUCK] = "switch-stuck",
    [MCU_FAULT_CAN_STUCK] = "can-stuck",
    [MCU_FAULT_HSE_FAILS] = "hse-fails",
    [MCU_FAULT_CAN_UNPLUGGED] = "can-unplugged",
    [MCU_FAULT_CAN_PLUGGED] = "can-plugged",
    [MCU_FAULT_CAN_SHORT] = "can-short",
    [MCU_FAULT_CAN_REPAIRED] = "can-repaired",
    [MCU_FAULT_HANG] = "hang",
    [MCU_FAULT_HANG_ALL] = "hang-all",
    [MCU_FAULT_STORM] = "storm",
    [MCU_FAULT_CALM] = "calm",
    [MCU_FAULT_STRAY] = "stray",
    [MCU_FAULT_STOP_PRESSED] = "stop-pressed",
    [MCU_FAULT_STOP_RELEASED] = "stop-released",
    [MCU_FAULT_PAN_SILENT] = "pan-silent",
    [MCU_FAULT_TILT_SILENT] = "tilt-silent",
    [MCU_FAULT_PAN_IDLE] = "pan-idle",
    [MCU_FAULT_TILT_IDLE] = "tilt-idle",
    [MCU_FAULT_DRIVES_WELL] = "drives-well",
};

const char *mcu_board_fault_names(void) {
    static char names[512];
    size_t used = 0;
    for (unsigned i = 0; i < MCU_FAULT_COUNT && used < sizeof names; i++) {
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i != 0U ? " " : "",
                                 fault_names[i]);
    }
    return names;
}

static const char *read_fault(const char *word, size_t size, struct mcu_board_fault *fault) {
    const char *at = memchr(word, '@', size);
    const size_t name_size = at != NULL ? (size_t)(at - word) : size;
    for (unsigned i = 0; i < MCU_FAULT_COUNT; i++) {
        if (strlen(fault_names[i]) == name_size && memcmp(fault_names[i], word, name_size) == 0) {
            char *end = NULL;
            const double seconds = at != NULL ? strtod(at + 1, &end) : 0.0;
            if (at != NULL &&
                (end != word + size || end == at + 1 || !(seconds >= 0.0) || seconds > 1e6)) {
                return "the time is no number of seconds";
            }
            *fault = (struct mcu_board_fault){(enum mcu_fault)i, (uint64_t)(seconds * 1e6)};
            return NULL;
        }
    }
    return "no fault of that name";
}

const char *mcu_board_read_faults(const char *text, struct mcu_board_options *options) {
    while (*text != '\0') {
        const size_t size = strcspn(text, ",");
        if (options->fault_count == MCU_BOARD_FAULTS_MAX) {
            return "too many faults";
        }
        const char *wrong = read_fault(text, size, &options->fault[options->fault_count++]);
        if (wrong != NULL) {
            return wrong;
        }
        text += size + (text[size] == ',' ? 1U : 0U);
    }
    return NULL;
}

/// Closed to ground is not pressed.
static void press(struct mcu_board *board, unsigned pin, bool pressed) {
    gpio_drive(&board->machine.soc, pin, pressed ? GPIO_FLOATING : GPIO_LOW);
}

static void fail_drive(struct mcu_board *board, unsigned axis, enum rmd_drive_failure failure,
                       bool on) {
    if (board->sim->axis[axis].kind == DRIVE_RMD) {
        rmd_drive_fail(&board->sim->axis[axis].drive, failure, on);
    }
}

/// The axes and what they are driven by.
static void inject_drive_fault(struct mcu_board *board, enum mcu_fault fault) {
    switch (fault) {
    case MCU_FAULT_PAN_SILENT:
        fail_drive(board, AXIS_PAN, RMD_DRIVE_FAIL_SILENT, true);
        break;
    case MCU_FAULT_TILT_SILENT:
        fail_drive(board, AXIS_TILT, RMD_DRIVE_FAIL_SILENT, true);
        break;
    case MCU_FAULT_PAN_IDLE:
        board->idle_axes |= 1U << AXIS_PAN;
        break;
    case MCU_FAULT_TILT_IDLE:
        board->idle_axes |= 1U << AXIS_TILT;
        break;
    case MCU_FAULT_DRIVES_WELL:
        board->idle_axes = 0;
        fail_drive(board, AXIS_PAN, RMD_DRIVE_FAIL_SILENT, false);
        fail_drive(board, AXIS_TILT, RMD_DRIVE_FAIL_SILENT, false);
        break;
    default:
        break;
    }
}

static void inject(struct mcu_board *board, enum mcu_fault fault) {
    struct cpu *cpu = &board->machine.cpu;
    switch (fault) {
    case MCU_FAULT_HSE_FAILS:
        rcc_fail_hse(&board->machine.soc.rcc);
        break;
    case MCU_FAULT_CAN_UNPLUGGED:
    case MCU_FAULT_CAN_PLUGGED:
        board->can.unplugged = fault == MCU_FAULT_CAN_UNPLUGGED;
        can_port_changed(&board->can);
        break;
    case MCU_FAULT_CAN_SHORT:
    case MCU_FAULT_CAN_REPAIRED:
        board->can.shorted = fault == MCU_FAULT_CAN_SHORT;
        break;
    case MCU_FAULT_HANG:
        cpu_hang(cpu, NVIC_PRIORITY_THREAD);
        break;
    case MCU_FAULT_HANG_ALL:
        cpu_hang(cpu, INT16_MIN);
        break;
    case MCU_FAULT_STORM:
    case MCU_FAULT_CALM:
        nvic_hold_line(&board->machine.soc.nvic, STORM_IRQ, fault == MCU_FAULT_STORM);
        break;
    case MCU_FAULT_STRAY:
        nvic_enable(&board->machine.soc.nvic, NVIC_IRQ0 + STRAY_IRQ, true);
        nvic_set_pending(&board->machine.soc.nvic, NVIC_IRQ0 + STRAY_IRQ, true);
        break;
    case MCU_FAULT_STOP_PRESSED:
    case MCU_FAULT_STOP_RELEASED:
        press(board, EMERGENCY_STOP, fault == MCU_FAULT_STOP_PRESSED);
        break;
    default:
        inject_drive_fault(board, fault);
        break;
    }
}

static void inject_due(struct mcu_board *board) {
    for (uint32_t i = 0; i < board->options.fault_count; i++) {
        const struct mcu_board_fault *fault = &board->options.fault[i];
        if ((board->faults_done >> i & 1U) == 0U && fault->at_us <= board->sim->time_us) {
            board->faults_done |= UINT32_C(1) << i;
            inject(board, fault->fault);
        }
    }
}

static uint32_t stuck_bits(const struct mcu_board_options *options) {
    uint32_t stuck = 0;
    for (uint32_t i = 0; i < options->fault_count; i++) {
        const enum mcu_fault fault = options->fault[i].fault;
        stuck |= fault == MCU_FAULT_HSE_STUCK      ? (uint32_t)SOC_STUCK_HSE
                 : fault == MCU_FAULT_PLL_STUCK    ? (uint32_t)SOC_STUCK_PLL
                 : fault == MCU_FAULT_SWITCH_STUCK ? (uint32_t)SOC_STUCK_SWITCH
                 : fault == MCU_FAULT_CAN_STUCK    ? (uint32_t)SOC_STUCK_CAN
                                                   : 0U;
    }
    return stuck;
}

// ---------------------------------------------------------------- in the simulator

static void on_step(void *context, const struct probe_tick *tick, bool started) {
    struct mcu_board *board = context;
    if (started) {
        if (!probe_config(&board->machine.cpu, tick->config_address, &board->config)) {
            soc_complain(&board->machine.soc, "the controller's settings are at 0x%08X",
                         tick->config_address);
        }
        sim_board_start(board->sim, &board->config);
    }
    struct sim_board_tick told = {.input = &tick->input, .output = &tick->output};
    memcpy(told.powered, tick->powered, sizeof told.powered);
    memcpy(told.ever_powered, tick->ever_powered, sizeof told.ever_powered);
    sim_board_tick(board->sim, &told);
}

static void on_world(void *context) {
    struct mcu_board *board = context;
    can_port_run(&board->can, soc_now_ns(&board->machine.soc));
}

static bool attach(void *context, struct sim *sim) {
    struct mcu_board *board = context;
    board->sim = sim;
    board->machine.soc.world = on_world;
    board->machine.soc.world_context = board;
    return can_port_init(&board->can, &board->machine.soc, 0, &sim->bus, CAN_TX, CAN_RX);
}

static bool push(void *context, const struct target_update *update) {
    struct mcu_board *board = context;
    return probe_push(&board->probe, update);
}

void mcu_board_command(struct mcu_board *board, uint32_t commands) {
    probe_command(&board->probe, commands);
}

static void command(void *context, uint32_t commands) {
    mcu_board_command(context, commands);
}

static void start_pan(void *context, const struct controller_pan *pan) {
    struct mcu_board *board = context;
    probe_pan(&board->probe, pan);
}

static void run(void *context, uint64_t until_ns) {
    struct mcu_board *board = context;
    inject_due(board);
    if (board->options.serial != NULL) {
        serial_pty_pass(board->options.serial, &board->machine.soc.usart[CONSOLE]);
    }
    for (unsigned axis = 0; axis < 2U; axis++) {
        if ((board->idle_axes >> axis & 1U) != 0U) {
            fail_drive(board, axis, RMD_DRIVE_FAIL_IDLE, true);
        }
    }
    cpu_run(&board->machine.cpu, until_ns);
    give_pulses(board);
}

const char *mcu_board_start(struct mcu_board *board, const struct mcu_board_options *options) {
    memset(board, 0, sizeof *board);
    board->options = *options;
    struct machine_options machine = machine_defaults();
    machine.soc.stuck = stuck_bits(options);
    machine.soc.log = options->log;
    machine.soc.lsi_hz = options->lsi_hz != 0U ? options->lsi_hz : machine.soc.lsi_hz;
    machine.exact = options->exact;
    const char *wrong = machine_start(&board->machine, options->image, &machine);
    if (wrong != NULL) {
        return wrong;
    }
    if (!probe_init(&board->probe, &board->machine.cpu, &board->machine.image)) {
        return "has no function controller_step: is it stripped?";
    }
    struct image_symbol rig;
    if (!image_symbol(&board->machine.image, "compiled_rig", &rig) ||
        !probe_config(&board->machine.cpu, rig.address, &board->config)) {
        return "has no compiled_rig";
    }
    board->probe.stepped = on_step;
    board->probe.context = board;
    const struct usart_line line = {.baud = CONSOLE_BAUD,
                                    .tx_pin = CONSOLE_TX,
                                    .rx_pin = CONSOLE_RX,
                                    .heard = on_console_byte,
                                    .context = board};
    usart_connect(&board->machine.soc.usart[CONSOLE], &line);
    press(board, EMERGENCY_STOP, false);
    press(board, KEY_SWITCH, false);
    press(board, PAN_LIMIT, false);
    press(board, TILT_LIMIT, false);
    board->board = (struct sim_board){attach, push, command, start_pan, run, board};
    return NULL;
}

void mcu_board_free(struct mcu_board *board) {
    machine_free(&board->machine);
}

const char *mcu_board_other_rig(const struct mcu_board *board,
                                const struct controller_config *config) {
    struct layout *layout = &layout_controller_config;
    uint8_t image[1024], rig[1024];
    struct controller_config wanted = *config;
    wanted.arm_on_start = board->config.arm_on_start;
    layout_to_arm(layout, &board->config, image);
    layout_to_arm(layout, &wanted, rig);
    for (unsigned i = 0; i < layout->field_count; i++) {
        const uint32_t from = layout_arm_offset(layout, layout->fields[i].name);
        const uint32_t to = i + 1U < layout->field_count
                                ? layout_arm_offset(layout, layout->fields[i + 1U].name)
                                : layout_arm_bytes(layout);
        if (memcmp(image + from, rig + from, to - from) != 0) {
            return layout->fields[i].name;
        }
    }
    return NULL;
}
