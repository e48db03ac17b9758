#include "mcu/machine.h"

#include <string.h>

struct machine_options machine_defaults(void) {
    return (struct machine_options){.soc = {.hse_hz = 8000000, .lsi_hz = 32000}};
}

const char *machine_start(struct machine *machine, const char *path,
                          const struct machine_options *options) {
    memset(machine, 0, sizeof *machine);
    const char *wrong = image_read(&machine->image, path);
    if (wrong != NULL) {
        return wrong;
    }
    soc_init(&machine->soc, &options->soc);
    if (!cpu_init(&machine->cpu, &machine->soc, options->exact)) {
        return "can't be run: no memory for the emulator";
    }
    wrong = image_flash(&machine->image, CPU_FLASH_BASE, machine->cpu.flash, CPU_FLASH_BYTES);
    if (wrong == NULL) {
        cpu_reset(&machine->cpu);
    }
    return wrong;
}

void machine_free(struct machine *machine) {
    cpu_free(&machine->cpu);
    image_free(&machine->image);
}
