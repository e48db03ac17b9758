/// `boresight sim --mcu IMAGE`: the controller runs in an emulated microcontroller.
///
/// The emulator is another program, boresight-mcu, because it links a library under the GPL.
/// `boresight` runs that in its place, from its own folder and with the same arguments. It is the
/// same program again, but for the emulator that it brings along (host-sim/mcu/program.c).
/// Shown: tests/mcu/cpu/sim.sh.
#ifndef LINUX_EMULATOR_H
#define LINUX_EMULATOR_H

#include "command.h"
#include "facts.h"

#include "sim.h"

struct emulator_options {
    const char *image;
    const char *faults;  ///< "can-short@2.5,pan-silent@3"; NULL: none
    const char *serial;  ///< a link to make to a pseudo-terminal: its serial line; NULL: none
    const char *console; ///< file for what the board says; "-": stderr; NULL: none
};

struct emulator {
    /// What the help of --mcu-faults lists.
    const char *(*fault_names)(void);
    /// Switches a board on. Errors are told on stderr. *board: for sim_config; *handle: for the
    /// others.
    enum exit_status (*open)(const struct emulator_options *options,
                             const struct controller_config *rig, const struct sim_board **board,
                             void **handle);
    /// Its part of the summary.
    void (*facts)(void *handle, struct facts *facts);
    /// Faults that were injected.
    uint64_t (*faults_injected)(void *handle);
    /// Did the image do what the chip's manual forbids? Then it is told on stderr.
    bool (*is_sound)(void *handle);
    void (*close)(void *handle);
};

/// NULL in `boresight` (emulator_none.c).
extern const struct emulator *const emulator;

/// Runs boresight-mcu instead of this program; returns only if it can't.
enum exit_status emulator_run_program(const char *command, int argc, char *const *argv);

#endif
