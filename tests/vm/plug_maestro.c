/// Plays a Maestro for the scripts: plugged in until SIGTERM. Usage: plug_maestro FILE. FILE always
/// holds the last targets of its six channels, in quarter microseconds.
#include "contract/support/maestro_model.h"
#include "vm/support/usb_port.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t ended;

static void end(int number) {
    (void)number;
    ended = 1;
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: plug_maestro FILE\n");
        return 2;
    }
    struct maestro_model *model = usb_port_share(sizeof *model);
    const struct usb_model plugged = {.device = maestro_model_device,
                                      .configuration = maestro_model_configuration,
                                      .strings = {"Pololu", "Maestro", MAESTRO_MODEL_SERIAL},
                                      .speed = USB_FULL_SPEED,
                                      .ctx = model,
                                      .control = maestro_model_control,
                                      .bulk_out = maestro_model_bulk_out,
                                      .bulk_in = maestro_model_bulk_in};
    struct usb_port port;
    memset(model, 0, sizeof *model);
    signal(SIGTERM, end);
    usb_port_plug(&port, 2, &plugged);
    while (ended == 0) {
        FILE *file = fopen(argv[1], "w");
        for (int i = 0; file != NULL && i < 6; i++) {
            fprintf(file, "%u%c", model->target[i], i < 5 ? ' ' : '\n');
        }
        if (file != NULL) {
            fclose(file);
        }
        usleep(50000);
    }
    usb_port_unplug(&port);
    return 0;
}
