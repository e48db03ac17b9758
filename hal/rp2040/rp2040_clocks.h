/// The clock tree: 125 MHz from a 12 MHz crystal; without the PLL 12 MHz, without the crystal what
/// the ring oscillator gives, about 6 MHz.
/// Shown: tests/mcu/rp2040/pico.sh.
#ifndef RP2040_RP2040_CLOCKS_H
#define RP2040_RP2040_CLOCKS_H

#include <stdbool.h>
#include <stdint.h>

/// How the start went. The ring oscillator is between 1.8 and 12 MHz, whatever core_hz says: too
/// vague for pulses, and a serial port then has a wrong speed.
enum rp2040_clocks_state {
    RP2040_CLOCKS_FULL,
    RP2040_CLOCKS_NO_CRYSTAL,
    RP2040_CLOCKS_NO_PLL,
    RP2040_CLOCKS_NO_SWITCH
};

struct rp2040_clocks {
    enum rp2040_clocks_state state;
    uint32_t core_hz; ///< of the core and of all peripherals; a multiple of 1 MHz
    bool usb;         ///< the USB has its 48 MHz
};

/// Resets the peripherals that the HAL uses, so that nothing of an earlier program drives a pin;
/// then starts crystal and PLL, with bounded waits, and switches over. Starts the tick of the
/// watchdog, 1 us with a crystal and at most so long without.
/// Cost: 6 ms with a crystal, less than 0.5 s without.
struct rp2040_clocks rp2040_clocks_start(void);

/// "the crystal does not oscillate".
const char *rp2040_clocks_state_name(enum rp2040_clocks_state state);

#endif
