/// Plays two gs_usb adapters on one bus for the scripts, with the serial numbers 0001 and 0002:
/// plugged in until SIGTERM. Words on stdin, a line each, do something to the first: `unplug`,
/// `plug`; `off`: it goes bus-off; `passive`, `active`: it says so of its errors; `hold`: nobody
/// acknowledges, on the whole bus, so nothing crosses it until `carry`.
#include "contract/support/candle_model.h"
#include "vm/support/usb_port.h"

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t ended;

static void take(int number) {
    (void)number;
    ended = 1;
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

/// An error frame about the controller, with its counters.
static void tell_errors(uint8_t state, uint8_t count) {
    const uint8_t frame[20] = {0xFF, 0xFF, 0xFF, 0xFF,  0x04, 0x02, 0, 0x20, 8,     0,
                               0,    0,    0,    state, 0,    0,    0, 0,    count, 0};
    candle_inject(bus, 0, frame);
}

static void obey(const char *word) {
    if (strcmp(word, "unplug\n") == 0) {
        usb_port_unplug(&ports[0]);
    } else if (strcmp(word, "plug\n") == 0) {
        plug(0);
    } else if (strcmp(word, "off\n") == 0) {
        bus->node[0].bus_off_wanted = true;
    } else if (strcmp(word, "passive\n") == 0) {
        tell_errors(0x20, 130);
    } else if (strcmp(word, "active\n") == 0) {
        tell_errors(0x40, 5);
    } else if (strcmp(word, "hold\n") == 0 || strcmp(word, "carry\n") == 0) {
        bus->carries = word[0] == 'c';
    } else {
        fprintf(stderr, "plug_candles: what is %s", word);
    }
}

int main(void) {
    const struct sigaction action = {.sa_handler = take};
    char word[40];
    bool listens = true;
    setvbuf(stdin, NULL, _IONBF, 0); // so that poll tells of every line
    sigaction(SIGTERM, &action, NULL);
    bus = usb_port_share(sizeof *bus);
    memset(bus, 0, sizeof *bus);
    bus->carries = true;
    plug(0);
    plug(1);
    while (ended == 0) {
        struct pollfd ready = {.fd = listens ? 0 : -1, .events = POLLIN};
        if (poll(&ready, 1, 20) > 0) {
            listens = fgets(word, sizeof word, stdin) != NULL;
            if (listens) {
                obey(word);
            }
        }
    }
    usb_port_unplug(&ports[0]);
    usb_port_unplug(&ports[1]);
    return 0;
}
