/// Plays two gs_usb adapters on one bus for the scripts, with the serial numbers 0001 and 0002:
/// plugged in until SIGTERM. SIGUSR1: the first is pulled out, or plugged in again. SIGUSR2: the
/// first goes bus-off.
#include "contract/support/candle_model.h"
#include "vm/support/usb_port.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t ended, plug_asked, bus_off_asked;

static void take(int number) {
    ended = ended || number == SIGTERM;
    plug_asked = plug_asked || number == SIGUSR1;
    bus_off_asked = bus_off_asked || number == SIGUSR2;
}

static struct candle_bus *bus;
static struct candle adapters[2];
static struct usb_port ports[2];

static void plug(unsigned number) {
    static const char *const serials[] = {"0001", "0002"};
    adapters[number] = (struct candle){.bus = bus, .first_node = number, .channel_count = 1};
    const struct usb_model model = {.device = candle_device,
                                    .configuration = candle_configuration,
                                    .strings = {"emulated", "gs_usb", serials[number]},
                                    .speed = USB_FULL_SPEED,
                                    .ctx = &adapters[number],
                                    .control = candle_control,
                                    .bulk_out = candle_bulk_out,
                                    .bulk_in = candle_bulk_in};
    usb_port_plug(&ports[number], number, &model);
}

int main(void) {
    const struct sigaction action = {.sa_handler = take};
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGUSR1, &action, NULL);
    sigaction(SIGUSR2, &action, NULL);
    bus = usb_port_share(sizeof *bus);
    memset(bus, 0, sizeof *bus);
    bus->carries = true;
    plug(0);
    plug(1);
    while (ended == 0) {
        usleep(20000);
        if (plug_asked != 0) {
            plug_asked = 0;
            if (ports[0].child > 0) {
                usb_port_unplug(&ports[0]);
            } else {
                plug(0);
            }
        }
        if (bus_off_asked != 0) {
            bus_off_asked = 0;
            bus->node[0].bus_off_wanted = true;
        }
    }
    usb_port_unplug(&ports[0]);
    usb_port_unplug(&ports[1]);
    return 0;
}
