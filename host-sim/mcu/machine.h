/// An emulated board: chip, processor and image.
#ifndef MCU_MACHINE_H
#define MCU_MACHINE_H

#include "mcu/cpu.h"
#include "mcu/image.h"
#include "mcu/soc.h"

struct machine_options {
    struct soc_options soc;
    bool exact; ///< faults name the instruction (slow)
};

struct machine {
    struct soc soc;
    struct cpu cpu;
    struct image image;
};

/// 8 MHz crystal, 32 kHz low-speed oscillator, nothing stuck.
struct machine_options machine_defaults(void);

/// A board with an image in its flash, at power-on. Returns: NULL, or what is wrong with the file,
/// to follow its name. Free in any case. The struct must not move. cpu_run then lets it work.
const char *machine_start(struct machine *machine, const char *path,
                          const struct machine_options *options);
void machine_free(struct machine *machine);

#endif
