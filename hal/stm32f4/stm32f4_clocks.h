/// The clock tree: 168 MHz from an external crystal if there is one, else 16 MHz from inside.
/// Shown: tests/mcu/hal/suites.c, tests/mcu/cpu/faults.c (no crystal).
#ifndef STM32F4_STM32F4_CLOCKS_H
#define STM32F4_STM32F4_CLOCKS_H

#include <stdint.h>

/// How the start went. Anything but STM32F4_CLOCKS_FULL leaves the chip on its internal oscillator,
/// good to 1 %: enough for a serial port, not for a CAN bus.
enum stm32f4_clocks_state {
    STM32F4_CLOCKS_FULL,
    STM32F4_CLOCKS_NO_CRYSTAL,
    STM32F4_CLOCKS_NO_PLL,
    STM32F4_CLOCKS_NO_FLASH,
    STM32F4_CLOCKS_NO_SWITCH
};

struct stm32f4_clocks {
    enum stm32f4_clocks_state state;
    uint32_t core_hz;
    uint32_t apb1_hz, apb2_hz; ///< buses of the slow and of the fast peripherals
    uint32_t apb1_timer_hz;    ///< twice the bus when it is divided (RM0090 7.2)
};

/// Starts crystal and PLL, with bounded waits, and switches over.
/// crystal_mhz: 4 to 26, whole. Its failure later on resets the chip (clock security system, by way
///              of the non-maskable interrupt), which then stays on its internal oscillator.
/// Cost:        2 ms with a crystal, 100 ms without.
struct stm32f4_clocks stm32f4_clocks_start(uint32_t crystal_mhz);

/// "the crystal does not oscillate".
const char *stm32f4_clocks_state_name(enum stm32f4_clocks_state state);

/// Gives a block of registers its bus clock. Where a block's base address is a multiple of 1 KiB
/// into its bus, that multiple is its bit in the enable register: true of every block used here
/// (RM0090 2.3, 7.3.10, 7.3.13, 7.3.14).
void stm32f4_clocks_enable(const volatile void *block);

#endif
