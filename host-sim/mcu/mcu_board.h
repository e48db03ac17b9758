/// An STM32F405 board as the README of boards/stm32f405 wires it, in the simulator: its CAN
/// transceiver on the simulated bus, its servo outputs to the servos, its switches closed, its
/// console to a file.
///
/// `struct sim_board` (sim.h) drives it. A scenario's targets and commands go in by the probe
/// (probe.h); whoever opens the pseudo-terminal (serial_pty.h) is at the board's serial line.
/// Faults of docs/safety.md that concern the board are switched on here, at a time.
/// Shown: tests/mcu/cpu/board.c, tests/mcu/cpu/faults.c, tests/mcu/cpu/sim.sh.
#ifndef MCU_MCU_BOARD_H
#define MCU_MCU_BOARD_H

#include "mcu/can_port.h"
#include "mcu/machine.h"
#include "mcu/probe.h"
#include "mcu/serial_pty.h"
#include "sim.h"

#define MCU_BOARD_SERVOS     6U
#define MCU_BOARD_FAULTS_MAX 16U
#define MCU_BOARD_LINE_BYTES 256U

enum mcu_fault {
    MCU_FAULT_HSE_STUCK,     ///< from power-on
    MCU_FAULT_PLL_STUCK,     ///< from power-on
    MCU_FAULT_SWITCH_STUCK,  ///< from power-on: the system clock does not change over
    MCU_FAULT_CAN_STUCK,     ///< from power-on: the controller never enters its initialisation
    MCU_FAULT_HSE_FAILS,     ///< the crystal stops
    MCU_FAULT_CAN_UNPLUGGED, ///< the cable at our end
    MCU_FAULT_CAN_PLUGGED,   ///< back in
    MCU_FAULT_CAN_SHORT,     ///< the bus is shorted
    MCU_FAULT_CAN_REPAIRED,
    MCU_FAULT_HANG,     ///< the program hangs; interrupts go on
    MCU_FAULT_HANG_ALL, ///< everything hangs
    MCU_FAULT_STORM,    ///< an interrupt that never ends (the console's)
    MCU_FAULT_CALM,     ///< it ends
    MCU_FAULT_STRAY,    ///< an interrupt that nobody expects
    MCU_FAULT_STOP_PRESSED,
    MCU_FAULT_STOP_RELEASED,
    MCU_FAULT_PAN_SILENT, ///< a drive hears and says nothing
    MCU_FAULT_TILT_SILENT,
    MCU_FAULT_PAN_IDLE, ///< a drive falls to idle whenever it is told to move, and says nothing of
                        ///< it
    MCU_FAULT_TILT_IDLE,
    MCU_FAULT_DRIVES_WELL, ///< all drives answer and move again
    MCU_FAULT_COUNT
};

struct mcu_board_fault {
    enum mcu_fault fault;
    uint64_t at_us;
};

struct mcu_board_options {
    const char *image;
    struct mcu_board_fault fault[MCU_BOARD_FAULTS_MAX];
    uint32_t fault_count;
    FILE *log;                 ///< complaints of the chip; NULL: nobody
    struct serial_pty *serial; ///< the other end of the serial line; NULL: nobody
    FILE *console;             ///< what the board says, a line at a time; NULL: nobody
    bool exact;                ///< see cpu.h
    uint32_t lsi_hz;           ///< of the watchdog's oscillator; 0: 32,000
};

struct mcu_board {
    struct sim_board board; ///< for sim_config
    struct mcu_board_options options;
    struct machine machine;
    struct can_port can;
    struct probe probe;
    struct controller_config config; ///< as the image has it
    struct sim *sim;
    uint32_t faults_done;
    uint32_t idle_axes; ///< a bit for each drive that falls to idle again and again
    char line[MCU_BOARD_LINE_BYTES], last_line[MCU_BOARD_LINE_BYTES]; ///< of the console
    uint32_t line_bytes;
    uint64_t lines, garbled; ///< whole lines, and bytes with a wrong stop bit
};

/// Switches a board on. Returns: NULL, or what is wrong with the image, to follow its name. Free in
/// any case. The struct must not move.
const char *mcu_board_start(struct mcu_board *board, const struct mcu_board_options *options);
void mcu_board_free(struct mcu_board *board);

/// Into the input of the controller's next step, as a person at the console would give it.
void mcu_board_command(struct mcu_board *board, uint32_t commands);

/// Whether the image was built for a rig; NULL, or the name of a setting that differs. What the
/// scenario decides (arm_on_start) does not count.
const char *mcu_board_other_rig(const struct mcu_board *board,
                                const struct controller_config *config);

/// "can-short@2.5,pan-silent@3": returns NULL, or what is wrong with it.
const char *mcu_board_read_faults(const char *text, struct mcu_board_options *options);
/// The names, separated by blanks.
const char *mcu_board_fault_names(void);

#endif
