/// Registers of the RP2040, as far as they are used. Section numbers are those of the "RP2040
/// Datasheet" (Raspberry Pi Ltd).
#ifndef RP2040_RP2040_REGISTERS_H
#define RP2040_RP2040_REGISTERS_H

#include <stdint.h>

/// 2.1.2: a write to one of these copies of a register sets or clears the bits that are 1.
#define RP2040_SET(reg)   (*(volatile uint32_t *)((uintptr_t) & (reg) + 0x2000U))
#define RP2040_CLEAR(reg) (*(volatile uint32_t *)((uintptr_t) & (reg) + 0x3000U))

/// 2.14 Subsystem resets.
struct rp2040_resets {
    volatile uint32_t reset, watchdog_select, reset_done;
};
#define RP2040_RESETS ((struct rp2040_resets *)0x4000C000U)
enum {
    RP2040_RESET_IO_BANK0 = 1 << 5,
    RP2040_RESET_PADS_BANK0 = 1 << 8,
    RP2040_RESET_PLL_SYS = 1 << 12,
    RP2040_RESET_PLL_USB = 1 << 13,
    RP2040_RESET_PWM = 1 << 14,
    RP2040_RESET_UART0 = 1 << 22,
    RP2040_RESET_USB = 1 << 24
};

/// 2.13 Power-on state machine: what a watchdog reset takes along. Bits 0 and 1 are the
/// oscillators.
struct rp2040_psm {
    volatile uint32_t force_on, force_off, watchdog_select, done;
};
#define RP2040_PSM                 ((struct rp2040_psm *)0x40010000U)
#define RP2040_PSM_BUT_OSCILLATORS 0x0001FFFCU

/// 2.12.8 Why the chip started.
#define RP2040_CHIP_RESET (*(volatile uint32_t *)0x40064008U)
enum { RP2040_CHIP_RESET_POWER = 1 << 8, RP2040_CHIP_RESET_RUN_PIN = 1 << 16 };

/// 2.15 Clocks: one generator, and those used.
struct rp2040_clock {
    volatile uint32_t control, divisor, selected;
};
#define RP2040_CLOCK_REF  ((struct rp2040_clock *)0x40008030U)
#define RP2040_CLOCK_SYS  ((struct rp2040_clock *)0x4000803CU)
#define RP2040_CLOCK_PERI ((struct rp2040_clock *)0x40008048U)
#define RP2040_CLOCK_USB  ((struct rp2040_clock *)0x40008054U)
enum {
    RP2040_CLOCK_REF_RING = 0,
    RP2040_CLOCK_REF_CRYSTAL = 2,
    RP2040_CLOCK_SYS_REF = 0,
    RP2040_CLOCK_SYS_AUX = 1,
    RP2040_CLOCK_SYS_AUX_PLL = 0 << 5,
    RP2040_CLOCK_PERI_ENABLE = 1 << 11,
    RP2040_CLOCK_PERI_SYS = 0 << 5,
    RP2040_CLOCK_USB_ENABLE = 1 << 11,
    RP2040_CLOCK_USB_PLL = 0 << 5
};

/// 2.16 Crystal oscillator.
struct rp2040_xosc {
    volatile uint32_t control, status, dormant, startup;
};
#define RP2040_XOSC                ((struct rp2040_xosc *)0x40024000U)
#define RP2040_XOSC_CONTROL_ENABLE 0x00FABAA0U ///< with the range 1 to 15 MHz
#define RP2040_XOSC_STATUS_STABLE  (UINT32_C(1) << 31)

/// 2.18 PLL.
struct rp2040_pll {
    volatile uint32_t control, power, feedback, post;
};
#define RP2040_PLL_SYS          ((struct rp2040_pll *)0x40028000U)
#define RP2040_PLL_USB          ((struct rp2040_pll *)0x4002C000U)
#define RP2040_PLL_CONTROL_LOCK (UINT32_C(1) << 31)
enum {
    RP2040_PLL_POWER_DOWN = 1 << 0,
    RP2040_PLL_POWER_POST_DOWN = 1 << 3,
    RP2040_PLL_POWER_VCO_DOWN = 1 << 5
};

/// 4.7 Watchdog.
struct rp2040_watchdog_block {
    volatile uint32_t control, load, reason, scratch[8], tick;
};
#define RP2040_WATCHDOG                ((struct rp2040_watchdog_block *)0x40058000U)
#define RP2040_WATCHDOG_CONTROL_ENABLE (UINT32_C(1) << 30)
#define RP2040_WATCHDOG_LOAD_MAX       UINT32_C(0x00FFFFFF)
enum {
    RP2040_WATCHDOG_CONTROL_PAUSE = 7 << 24, ///< while a debugger holds a core
    RP2040_WATCHDOG_REASON_TIMER = 1 << 0,
    RP2040_WATCHDOG_REASON_FORCE = 1 << 1,
    RP2040_WATCHDOG_TICK_ENABLE = 1 << 9
};

/// 2.19 Pins: function and pads.
struct rp2040_pin_function {
    volatile uint32_t status, control;
};
#define RP2040_PIN_FUNCTION ((struct rp2040_pin_function *)0x40014000U)
#define RP2040_PIN_PAD      ((volatile uint32_t *)0x4001C004U)
enum {
    RP2040_FUNCTION_UART = 2,
    RP2040_FUNCTION_PWM = 4,
    RP2040_FUNCTION_SIO = 5,
    RP2040_PAD_SCHMITT = 1 << 1,
    RP2040_PAD_PULL_DOWN = 1 << 2,
    RP2040_PAD_PULL_UP = 1 << 3,
    RP2040_PAD_DRIVE_4MA = 1 << 4,
    RP2040_PAD_INPUT_ENABLE = 1 << 6
};

/// 2.3.1 Pins as inputs and outputs of the program.
struct rp2040_sio {
    volatile uint32_t cpuid, in, in_high, reserved, out, out_set, out_clear, out_xor;
    volatile uint32_t enable, enable_set, enable_clear, enable_xor;
};
#define RP2040_SIO ((struct rp2040_sio *)0xD0000000U)

/// 4.5 PWM: eight slices of two channels.
struct rp2040_pwm_slice {
    volatile uint32_t control, divisor, counter, compare, top;
};
#define RP2040_PWM_SLICES         ((struct rp2040_pwm_slice *)0x40050000U)
#define RP2040_PWM_CONTROL_ENABLE 1U

/// 4.2 UART (PL011).
struct rp2040_uart_block {
    volatile uint32_t data, status, reserved0[4], flags, reserved1, low_power, divisor,
        divisor_64ths, line, control, fifo_levels, mask, raw, masked, clear;
};
#define RP2040_UART0 ((struct rp2040_uart_block *)0x40034000U)
enum {
    RP2040_UART_DATA_DAMAGED = 7 << 8, ///< framing, parity, break
    RP2040_UART_DATA_OVERRUN = 1 << 11,
    RP2040_UART_FLAGS_SEND_FULL = 1 << 5,
    RP2040_UART_FLAGS_RECEIVE_EMPTY = 1 << 4,
    RP2040_UART_LINE_FIFOS = 1 << 4,
    RP2040_UART_LINE_8_BITS = 3 << 5,
    RP2040_UART_CONTROL_ENABLE = 1 << 0,
    RP2040_UART_CONTROL_SEND = 1 << 8,
    RP2040_UART_CONTROL_RECEIVE = 1 << 9,
    RP2040_UART_INTERRUPT_RECEIVE = 1 << 4,
    RP2040_UART_INTERRUPT_SEND = 1 << 5,
    RP2040_UART_INTERRUPT_IDLE = 1 << 6 ///< bytes have waited for 32 bit times
};

/// 4.1.3 USB: registers, as far as a device needs them.
struct rp2040_usb_block {
    volatile uint32_t address, host[15], control, frame_write, frame, line_control, line_status,
        host_poll, buffers_done, which_buffer, abort, abort_done, stall_arm, nak_poll, stalled,
        muxing, power, phy[4], raw, enable, force, status;
};
#define RP2040_USB ((struct rp2040_usb_block *)0x50110000U)
enum {
    RP2040_USB_CONTROL_ENABLE = 1 << 0,
    RP2040_USB_LINE_CONTROL_PULL_UP = 1 << 16,
    RP2040_USB_LINE_CONTROL_EP0_INTERRUPT = 1 << 29,
    RP2040_USB_LINE_STATUS_SETUP = 1 << 17,
    RP2040_USB_LINE_STATUS_RESET = 1 << 19,
    RP2040_USB_STALL_EP0 = 3 << 0, ///< both directions
    RP2040_USB_MUXING_PHY = 1 << 0,
    RP2040_USB_MUXING_SOFT = 1 << 3,
    RP2040_USB_POWER_DETECT = 1 << 2,          ///< as if the bus had power ...
    RP2040_USB_POWER_DETECT_OVERRIDE = 1 << 3, ///< ... whatever the pin says
    RP2040_USB_INTERRUPT_HOST_ONLY = 1 << 0,
    RP2040_USB_INTERRUPT_BUFFERS = 1 << 4,
    RP2040_USB_INTERRUPT_RESET = 1 << 12,
    RP2040_USB_INTERRUPT_SETUP = 1 << 16
};

/// 4.1.2.5 The memory that processor and USB share.
#define RP2040_USB_MEMORY_BYTES 4096U
struct rp2040_usb_memory {
    volatile uint8_t setup[8];
    volatile uint32_t endpoint[15][2]; ///< from 1 on; in, out
    volatile uint32_t buffer[16][2];   ///< control of each endpoint's buffer; in, out
    volatile uint8_t data[RP2040_USB_MEMORY_BYTES - 0x100U];
};
#define RP2040_USB_MEMORY ((struct rp2040_usb_memory *)0x50100000U)
enum { RP2040_USB_IN, RP2040_USB_OUT }; // as the host sees it
#define RP2040_USB_ENDPOINT_ENABLE (UINT32_C(1) << 31)
enum {
    RP2040_USB_ENDPOINT_INTERRUPT = 1 << 29,
    RP2040_USB_ENDPOINT_BULK = 2 << 26,
    RP2040_USB_ENDPOINT_NOTICES = 3 << 26,
    RP2040_USB_BUFFER_FULL = 1 << 15,
    RP2040_USB_BUFFER_DATA1 = 1 << 13,
    RP2040_USB_BUFFER_STALL = 1 << 11,
    RP2040_USB_BUFFER_AVAILABLE = 1 << 10,
    RP2040_USB_BUFFER_LENGTH = 0x3FF
};

/// 2.3.2 Interrupts.
enum rp2040_irq { RP2040_IRQ_USB = 5, RP2040_IRQ_UART0 = 20, RP2040_IRQ_COUNT = 26 };

#endif
