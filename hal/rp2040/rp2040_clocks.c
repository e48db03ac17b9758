#include "rp2040/rp2040_clocks.h"

#include "cortexm/cortexm.h"
#include "rp2040/rp2040_registers.h"

#define CRYSTAL_MHZ    12U
#define RING_MHZ       6U
#define RING_MHZ_LEAST 1U ///< 1.8, rounded down
#define FULL_MHZ       125U

/// 2.18.2: crystal * feedback / (first * second).
#define PLL_POST(first, second) ((first) << 16 | (second) << 12)
#define SYS_FEEDBACK            125U // 1,500 MHz
#define SYS_POST                PLL_POST(6U, 2U)
#define USB_FEEDBACK            100U             // 1,200 MHz
#define USB_POST                PLL_POST(5U, 5U) // 48 MHz

/// Of a register at most so often: 100 ms at 12 MHz.
#define READS_MAX 120000U

#define BLOCKS                                                                                     \
    (RP2040_RESET_IO_BANK0 | RP2040_RESET_PADS_BANK0 | RP2040_RESET_PLL_SYS |                      \
     RP2040_RESET_PLL_USB | RP2040_RESET_PWM | RP2040_RESET_UART0 | RP2040_RESET_USB)

/// 2.15.3.2: the glitchless multiplexer tells when it has switched.
static bool switch_to(struct rp2040_clock *clock, uint32_t control, uint32_t source) {
    clock->control = control;
    return cortexm_wait_bits(&clock->selected, UINT32_MAX, UINT32_C(1) << source, READS_MAX);
}

static bool start_crystal(void) {
    RP2040_XOSC->startup = 196; // 256 cycles each: 4 ms (2.16.3)
    RP2040_XOSC->control = RP2040_XOSC_CONTROL_ENABLE;
    return cortexm_wait_bits(&RP2040_XOSC->status, RP2040_XOSC_STATUS_STABLE,
                             RP2040_XOSC_STATUS_STABLE, READS_MAX) &&
           switch_to(RP2040_CLOCK_REF, RP2040_CLOCK_REF_CRYSTAL, RP2040_CLOCK_REF_CRYSTAL);
}

/// 2.18.2.1, in the order given there.
static bool start_pll(struct rp2040_pll *pll, uint32_t feedback, uint32_t post) {
    pll->control = 1; // the crystal undivided
    pll->feedback = feedback;
    RP2040_CLEAR(pll->power) = RP2040_PLL_POWER_DOWN | RP2040_PLL_POWER_VCO_DOWN;
    if (!cortexm_wait_bits(&pll->control, RP2040_PLL_CONTROL_LOCK, RP2040_PLL_CONTROL_LOCK,
                           READS_MAX)) {
        return false;
    }
    pll->post = post;
    RP2040_CLEAR(pll->power) = RP2040_PLL_POWER_POST_DOWN;
    return true;
}

static struct rp2040_clocks start_sources(void) {
    // A core that reset itself after a crash still runs from the PLL, which is about to stop.
    const bool back = switch_to(RP2040_CLOCK_SYS, RP2040_CLOCK_SYS_REF, RP2040_CLOCK_SYS_REF) &&
                      switch_to(RP2040_CLOCK_REF, RP2040_CLOCK_REF_RING, RP2040_CLOCK_REF_RING);
    RP2040_SET(RP2040_RESETS->reset) = BLOCKS;
    RP2040_CLEAR(RP2040_RESETS->reset) = BLOCKS;
    const bool there = cortexm_wait_bits(&RP2040_RESETS->reset_done, BLOCKS, BLOCKS, READS_MAX);
    if (!back || !there) {
        return (struct rp2040_clocks){RP2040_CLOCKS_NO_SWITCH, RING_MHZ * 1000000U, false};
    }
    if (!start_crystal()) {
        return (struct rp2040_clocks){RP2040_CLOCKS_NO_CRYSTAL, RING_MHZ * 1000000U, false};
    }
    if (!start_pll(RP2040_PLL_SYS, SYS_FEEDBACK, SYS_POST)) {
        return (struct rp2040_clocks){RP2040_CLOCKS_NO_PLL, CRYSTAL_MHZ * 1000000U, false};
    }
    if (!switch_to(RP2040_CLOCK_SYS, RP2040_CLOCK_SYS_AUX_PLL | RP2040_CLOCK_SYS_AUX,
                   RP2040_CLOCK_SYS_AUX)) {
        return (struct rp2040_clocks){RP2040_CLOCKS_NO_SWITCH, CRYSTAL_MHZ * 1000000U, false};
    }
    return (struct rp2040_clocks){RP2040_CLOCKS_FULL, FULL_MHZ * 1000000U,
                                  start_pll(RP2040_PLL_USB, USB_FEEDBACK, USB_POST)};
}

struct rp2040_clocks rp2040_clocks_start(void) {
    const struct rp2040_clocks clocks = start_sources();
    RP2040_CLOCK_PERI->control = RP2040_CLOCK_PERI_ENABLE | RP2040_CLOCK_PERI_SYS;
    RP2040_CLOCK_USB->control =
        clocks.usb ? RP2040_CLOCK_USB_ENABLE | RP2040_CLOCK_USB_PLL : RP2040_CLOCK_USB_PLL;
    const bool crystal = clocks.core_hz != RING_MHZ * 1000000U;
    RP2040_WATCHDOG->tick = RP2040_WATCHDOG_TICK_ENABLE | (crystal ? CRYSTAL_MHZ : RING_MHZ_LEAST);
    return clocks;
}

const char *rp2040_clocks_state_name(enum rp2040_clocks_state state) {
    static const char *const names[] = {"crystal and PLL run", "the crystal does not oscillate",
                                        "the PLL does not lock", "the clock does not switch"};
    return names[state];
}
