#include "mcu/rcc.h"

#include "mcu/soc.h"

#define CR_HSION      (UINT32_C(1) << 0)
#define CR_HSEON      (UINT32_C(1) << 16)
#define CR_HSEBYP     (UINT32_C(1) << 18)
#define CR_CSSON      (UINT32_C(1) << 19)
#define CR_PLLON      (UINT32_C(1) << 24)
#define CR_PLLI2SON   (UINT32_C(1) << 26)
#define CR_WRITABLE   (CR_HSION | 0xF8U | CR_HSEON | CR_HSEBYP | CR_CSSON | CR_PLLON | CR_PLLI2SON)
#define CR_HSICAL     0x7C00U // factory calibration: differs from chip to chip
#define PLLCFGR_BITS  0x0F437FFFU
#define PLLCFGR_RESET 0x24003010U
#define PLLCFGR_HSE   (UINT32_C(1) << 22)
#define CFGR_BITS     0xFFFFFCF3U
#define CIR_FLAGS     0xBFU
#define CIR_ENABLES   0x3F00U
#define CIR_CSSF      (UINT32_C(1) << 7)
#define CSR_LSION     1U
#define CSR_RMVF      (UINT32_C(1) << 24)
#define CSR_FLAGS     0xFE000000U
#define CSR_PINRSTF   (UINT32_C(1) << 26)
#define CSR_SFTRSTF   (UINT32_C(1) << 28)
#define CSR_IWDGRSTF  (UINT32_C(1) << 29)
#define CSR_POWER_ON  0x0E000000U // brown-out, pin and power-on reset
#define BDCR_LSEON    1U
#define BDCR_BITS     0x00018305U
#define BDCR_BDRST    (UINT32_C(1) << 16)
#define PLLI2S_BITS   0x70007FC0U
#define PLLI2S_RESET  0x20003000U
#define IRQ_RCC       5U

enum { SW_HSI, SW_HSE, SW_PLL };

#define HSI_HZ UINT32_C(16000000)

// ---------------------------------------------------------------- clocks

static bool is_running(const struct rcc *rcc, enum rcc_oscillator oscillator) {
    return (rcc->running >> oscillator & 1U) != 0U;
}

static uint32_t pll_input_hz(const struct rcc *rcc) {
    const uint32_t m = rcc->pllcfgr & 0x3FU;
    const uint32_t source = (rcc->pllcfgr & PLLCFGR_HSE) != 0U ? rcc->soc->options.hse_hz : HSI_HZ;
    return m >= 2U ? source / m : 0U;
}

static uint32_t vco_hz(const struct rcc *rcc) {
    return pll_input_hz(rcc) * (rcc->pllcfgr >> 6 & 0x1FFU);
}

static uint32_t sysclk_hz(const struct rcc *rcc) {
    switch (rcc->switched) {
    case SW_HSE:
        return rcc->soc->options.hse_hz;
    case SW_PLL:
        return vco_hz(rcc) / (2U * (rcc->pllcfgr >> 16 & 3U) + 2U);
    default:
        return HSI_HZ;
    }
}

/// Of HPRE and PPRE: 0xxx is not divided.
static uint32_t ahb_divider(uint32_t hpre) {
    static const uint16_t dividers[] = {2, 4, 8, 16, 64, 128, 256, 512};
    return (hpre & 8U) != 0U ? dividers[hpre & 7U] : 1U;
}

static uint32_t apb_divider(const struct rcc *rcc, enum rcc_bus bus) {
    const uint32_t ppre = rcc->cfgr >> (bus == RCC_APB1 ? 10 : 13) & 7U;
    return (ppre & 4U) != 0U ? UINT32_C(2) << (ppre & 3U) : 1U;
}

uint32_t rcc_pclk_hz(const struct rcc *rcc, enum rcc_bus bus) {
    return rcc->soc->hclk_hz / apb_divider(rcc, bus);
}

uint32_t rcc_timer_divider(const struct rcc *rcc, enum rcc_bus bus) {
    const uint32_t divider = apb_divider(rcc, bus);
    return divider == 1U ? 1U : divider / 2U;
}

void rcc_check_limits(struct rcc *rcc) {
    struct soc *soc = rcc->soc;
    const uint32_t hclk = soc->hclk_hz;
    // 2.7 V and more: a wait state for each 30 MHz begun.
    const uint32_t latency = hclk == 0U ? 0U : (hclk - 1U) / 30000000U;
    const uint32_t sysclk_max = pwr_scale_one(&soc->pwr) ? 168000000U : 144000000U;
    if (sysclk_hz(rcc) > sysclk_max) {
        soc_complain(soc, "the system clock of %u Hz is above %u Hz", sysclk_hz(rcc), sysclk_max);
    }
    if (flash_interface_latency(&soc->flash) < latency) {
        soc_complain(soc, "the flash has %u wait states, %u Hz need %u",
                     flash_interface_latency(&soc->flash), hclk, latency);
    }
    if (rcc_pclk_hz(rcc, RCC_APB1) > 42000000U || rcc_pclk_hz(rcc, RCC_APB2) > 84000000U) {
        soc_complain(soc, "APB1 has %u Hz (at most 42 MHz), APB2 %u Hz (84 MHz)",
                     rcc_pclk_hz(rcc, RCC_APB1), rcc_pclk_hz(rcc, RCC_APB2));
    }
}

static void check_pll(struct rcc *rcc) {
    const uint32_t input = pll_input_hz(rcc), vco = vco_hz(rcc);
    if (input < 950000U || input > 2100000U || vco < 100000000U || vco > 432000000U) {
        soc_complain(rcc->soc,
                     "the PLL gets %u Hz (1 to 2 MHz), its oscillator %u Hz (100 to 432 MHz)",
                     input, vco);
    }
    if ((rcc->pllcfgr >> 24 & 15U) < 2U) {
        soc_complain(rcc->soc, "PLLQ below 2 is a wrong configuration");
    }
    if (!is_running(rcc, (rcc->pllcfgr & PLLCFGR_HSE) != 0U ? RCC_HSE : RCC_HSI)) {
        soc_complain(rcc->soc, "the PLL is switched on before its source is ready");
    }
}

/// Everything that counts by a bus clock moves on with the old one before the new one holds.
static void change_clocks(struct rcc *rcc, uint32_t new_cfgr, uint32_t new_switched) {
    struct soc *soc = rcc->soc;
    for (unsigned i = 0; i < TIMER_COUNT; i++) {
        timer_hold(&soc->timer[i]);
    }
    rcc->cfgr = new_cfgr;
    rcc->switched = new_switched;
    soc_set_hclk(soc, sysclk_hz(rcc) / ahb_divider(rcc->cfgr >> 4 & 15U));
    for (unsigned i = 0; i < TIMER_COUNT; i++) {
        timer_clock_changed(&soc->timer[i]);
    }
    rcc_check_limits(rcc);
}

/// Changes over if the clock asked for is ready.
static void follow_switch(struct rcc *rcc) {
    static const enum rcc_oscillator source[] = {RCC_HSI, RCC_HSE, RCC_PLL};
    const uint32_t wanted = rcc->cfgr & 3U;
    if (wanted == rcc->switched || wanted > SW_PLL ||
        (rcc->soc->options.stuck & SOC_STUCK_SWITCH) != 0U) {
        return;
    }
    if (is_running(rcc, source[wanted])) {
        change_clocks(rcc, rcc->cfgr, wanted);
    }
}

// ---------------------------------------------------------------- oscillators

/// Typical start-up times of the data sheet.
static uint64_t start_ns(enum rcc_oscillator oscillator) {
    static const uint64_t ns[] = {
        [RCC_LSI] = 15000,   [RCC_LSE] = 2000000000, [RCC_HSI] = 2200,
        [RCC_HSE] = 2000000, [RCC_PLL] = 150000,     [RCC_PLLI2S] = 150000};
    return ns[oscillator];
}

static bool can_start(const struct rcc *rcc, enum rcc_oscillator oscillator) {
    const struct soc_options *options = &rcc->soc->options;
    switch (oscillator) {
    case RCC_HSE:
        return options->hse_hz != 0U && !rcc->hse_failed && (options->stuck & SOC_STUCK_HSE) == 0U;
    case RCC_PLL:
    case RCC_PLLI2S:
        return (options->stuck & SOC_STUCK_PLL) == 0U &&
               is_running(rcc, (rcc->pllcfgr & PLLCFGR_HSE) != 0U ? RCC_HSE : RCC_HSI);
    default:
        return true;
    }
}

static void schedule(struct rcc *rcc) {
    uint64_t first = SOC_NEVER;
    for (unsigned i = 0; i < RCC_OSCILLATORS; i++) {
        first = rcc->ready_ns[i] < first ? rcc->ready_ns[i] : first;
    }
    soc_schedule_ns(rcc->soc, SOC_RCC, first);
}

static void switch_oscillator(struct rcc *rcc, enum rcc_oscillator oscillator, bool on) {
    if (!on) {
        rcc->running &= ~(UINT32_C(1) << oscillator);
        rcc->ready_ns[oscillator] = SOC_NEVER;
    } else if (!is_running(rcc, oscillator) && rcc->ready_ns[oscillator] == SOC_NEVER) {
        if (oscillator == RCC_PLL) {
            check_pll(rcc);
        }
        rcc->ready_ns[oscillator] =
            can_start(rcc, oscillator) ? soc_now_ns(rcc->soc) + start_ns(oscillator) : SOC_NEVER;
    }
    schedule(rcc);
}

static void update_interrupt(struct rcc *rcc) {
    const bool ready = ((rcc->cir & rcc->cir >> 8) & 0x3FU) != 0U;
    nvic_set_line(&rcc->soc->nvic, IRQ_RCC, ready);
    if ((rcc->cir & CIR_CSSF) != 0U) {
        nvic_set_pending(&rcc->soc->nvic, NVIC_NMI, true);
    }
}

void rcc_due(struct rcc *rcc) {
    const uint64_t now = soc_now_ns(rcc->soc);
    for (unsigned i = 0; i < RCC_OSCILLATORS; i++) {
        if (rcc->ready_ns[i] <= now) {
            rcc->ready_ns[i] = SOC_NEVER;
            rcc->running |= UINT32_C(1) << i;
            rcc->cir |= (rcc->cir >> 8 >> i & 1U) << i;
        }
    }
    update_interrupt(rcc);
    follow_switch(rcc);
    if (rcc_lsi_runs(rcc)) {
        iwdg_lsi_started(&rcc->soc->iwdg);
    }
    schedule(rcc);
}

void rcc_force_lsi(struct rcc *rcc) {
    switch_oscillator(rcc, RCC_LSI, true);
}

bool rcc_lsi_runs(const struct rcc *rcc) {
    return is_running(rcc, RCC_LSI);
}

void rcc_fail_hse(struct rcc *rcc) {
    const bool used =
        rcc->switched == SW_HSE || (rcc->switched == SW_PLL && (rcc->pllcfgr & PLLCFGR_HSE) != 0U);
    rcc->hse_failed = true;
    if (!is_running(rcc, RCC_HSE)) {
        return;
    }
    switch_oscillator(rcc, RCC_HSE, false);
    if ((rcc->cr & CR_CSSON) == 0U) {
        if (used) {
            soc_complain(rcc->soc,
                         "the crystal fails and nothing monitors it: the chip stands still");
        }
        return;
    }
    rcc->cr &= ~(CR_HSEON | CR_CSSON);
    rcc->cir |= CIR_CSSF;
    if (used) {
        switch_oscillator(rcc, RCC_HSI, true);
        rcc->running |= UINT32_C(1) << RCC_HSI;
        if (rcc->switched == SW_PLL) {
            rcc->cr &= ~CR_PLLON;
            switch_oscillator(rcc, RCC_PLL, false);
        }
        change_clocks(rcc, rcc->cfgr & ~UINT32_C(3), SW_HSI);
    }
    update_interrupt(rcc);
}

// ---------------------------------------------------------------- reset

static uint32_t reset_flags(enum soc_reset cause) {
    switch (cause) {
    case SOC_RESET_SOFTWARE:
        return CSR_SFTRSTF | CSR_PINRSTF; // every reset inside pulls the pin low
    case SOC_RESET_WATCHDOG:
        return CSR_IWDGRSTF | CSR_PINRSTF;
    case SOC_RESET_PIN:
        return CSR_PINRSTF;
    default:
        return CSR_POWER_ON;
    }
}

void rcc_reset(struct rcc *rcc, struct soc *soc, enum soc_reset cause) {
    const bool power = cause == SOC_RESET_POWER;
    const uint32_t bdcr = power ? 0U : rcc->bdcr;
    const uint32_t flags = power ? 0U : rcc->csr & CSR_FLAGS;
    const bool failed = !power && rcc->hse_failed;
    const uint32_t backup = power ? 0U : rcc->running & UINT32_C(1) << RCC_LSE;
    *rcc = (struct rcc){.soc = soc,
                        .cr = 0x81U,
                        .pllcfgr = PLLCFGR_RESET,
                        .plli2scfgr = PLLI2S_RESET,
                        .bdcr = bdcr,
                        .csr = flags | reset_flags(cause),
                        .running = UINT32_C(1) << RCC_HSI | backup,
                        .hse_failed = failed};
    rcc->enable[RCC_AHB1] = 0x00100000U;
    rcc->low_power_enable[RCC_AHB1] = 0x7E6791FFU;
    rcc->low_power_enable[RCC_AHB2] = 0x000000F1U;
    rcc->low_power_enable[RCC_AHB3] = 0x00000001U;
    rcc->low_power_enable[RCC_APB1] = 0x36FEC9FFU;
    rcc->low_power_enable[RCC_APB2] = 0x00075F33U;
    for (unsigned i = 0; i < RCC_OSCILLATORS; i++) {
        rcc->ready_ns[i] = SOC_NEVER;
    }
    soc_set_hclk(soc, HSI_HZ);
    schedule(rcc);
}

// ---------------------------------------------------------------- registers

bool rcc_is_clocked(const struct rcc *rcc, enum rcc_bus bus, unsigned bit) {
    return bus >= RCC_BUS_COUNT ||
           ((rcc->enable[bus] >> bit & 1U) != 0U && (rcc->reset[bus] >> bit & 1U) == 0U);
}

/// Which bus a register of the three rows at 0x10, 0x30 and 0x50 belongs to; RCC_BUS_COUNT: none.
static enum rcc_bus bus_of(uint32_t offset) {
    static const enum rcc_bus buses[] = {RCC_AHB1, RCC_AHB2, RCC_AHB3,      RCC_BUS_COUNT,
                                         RCC_APB1, RCC_APB2, RCC_BUS_COUNT, RCC_BUS_COUNT};
    return buses[(offset - 0x10U) / 4U % 8U];
}

static uint32_t read_cr(const struct rcc *rcc) {
    static const uint8_t ready_bit[] = {
        [RCC_HSI] = 1, [RCC_HSE] = 17, [RCC_PLL] = 25, [RCC_PLLI2S] = 27};
    uint32_t value = rcc->cr | CR_HSICAL;
    for (unsigned i = RCC_HSI; i <= RCC_PLLI2S; i++) {
        value |= (rcc->running >> i & 1U) << ready_bit[i];
    }
    return value;
}

uint32_t rcc_read(void *model, uint32_t offset) {
    struct rcc *rcc = model;
    const enum rcc_bus bus = offset >= 0x10U && offset < 0x70U ? bus_of(offset) : RCC_BUS_COUNT;
    if (bus != RCC_BUS_COUNT) {
        return offset < 0x30U   ? rcc->reset[bus]
               : offset < 0x50U ? rcc->enable[bus]
                                : rcc->low_power_enable[bus];
    }
    switch (offset) {
    case 0x00:
        return read_cr(rcc);
    case 0x04:
        return rcc->pllcfgr;
    case 0x08:
        return rcc->cfgr | rcc->switched << 2;
    case 0x0C:
        return rcc->cir;
    case 0x70:
        return rcc->bdcr | (rcc->running >> RCC_LSE & 1U) << 1;
    case 0x74:
        return rcc->csr | (rcc->running >> RCC_LSI & 1U) << 1;
    case 0x80:
        return rcc->sscgr;
    case 0x84:
        return rcc->plli2scfgr;
    default:
        return 0;
    }
}

/// What runs the system stays on, whatever is written.
static uint32_t keep_in_use(const struct rcc *rcc, uint32_t cr) {
    const bool pll_used = rcc->switched == SW_PLL || (rcc->cfgr & 3U) == SW_PLL;
    const bool pll_from_hse = (rcc->pllcfgr & PLLCFGR_HSE) != 0U;
    if (rcc->switched == SW_HSI || (pll_used && !pll_from_hse)) {
        cr |= CR_HSION;
    }
    if (rcc->switched == SW_HSE || (pll_used && pll_from_hse)) {
        cr |= rcc->cr & CR_HSEON;
    }
    return pll_used ? cr | (rcc->cr & CR_PLLON) : cr;
}

static void write_cr(struct rcc *rcc, uint32_t value) {
    uint32_t cr = keep_in_use(rcc, value & CR_WRITABLE);
    if ((rcc->cr & CR_HSEON) != 0U) {
        cr = (cr & ~CR_HSEBYP) | (rcc->cr & CR_HSEBYP); // only while the oscillator is off
    }
    rcc->cr = cr;
    switch_oscillator(rcc, RCC_HSI, (cr & CR_HSION) != 0U);
    switch_oscillator(rcc, RCC_HSE, (cr & CR_HSEON) != 0U);
    switch_oscillator(rcc, RCC_PLL, (cr & CR_PLLON) != 0U);
    switch_oscillator(rcc, RCC_PLLI2S, (cr & CR_PLLI2SON) != 0U);
}

static void write_pllcfgr(struct rcc *rcc, uint32_t value) {
    if ((rcc->cr & CR_PLLON) != 0U) {
        soc_complain(rcc->soc, "PLLCFGR is written while the PLL runs");
        return;
    }
    rcc->pllcfgr = (value & PLLCFGR_BITS) | (PLLCFGR_RESET & ~PLLCFGR_BITS);
}

static void write_cir(struct rcc *rcc, uint32_t value) {
    const uint32_t cleared = value >> 16 & CIR_FLAGS;
    rcc->cir = (rcc->cir & CIR_FLAGS & ~cleared) | (value & CIR_ENABLES);
    update_interrupt(rcc);
}

static void write_bdcr(struct rcc *rcc, uint32_t value) {
    if (!pwr_backup_writable(&rcc->soc->pwr)) {
        return;
    }
    rcc->bdcr = (value & BDCR_BDRST) != 0U ? BDCR_BDRST : value & BDCR_BITS;
    switch_oscillator(rcc, RCC_LSE, (rcc->bdcr & BDCR_LSEON) != 0U);
}

static void write_csr(struct rcc *rcc, uint32_t value) {
    if ((value & CSR_RMVF) != 0U) {
        rcc->csr &= ~CSR_FLAGS;
    }
    rcc->csr = (rcc->csr & CSR_FLAGS) | (value & CSR_LSION);
    if ((value & CSR_LSION) != 0U || !iwdg_runs(&rcc->soc->iwdg)) {
        switch_oscillator(rcc, RCC_LSI, (value & CSR_LSION) != 0U);
    }
}

static void write_bus(struct rcc *rcc, enum rcc_bus bus, uint32_t offset, uint32_t value) {
    if (offset < 0x30U) {
        rcc->reset[bus] = value;
        soc_reset_parts(rcc->soc, bus, value);
    } else if (offset < 0x50U) {
        rcc->enable[bus] = value;
    } else {
        rcc->low_power_enable[bus] = value;
    }
}

void rcc_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct rcc *rcc = model;
    const enum rcc_bus bus = offset >= 0x10U && offset < 0x70U ? bus_of(offset) : RCC_BUS_COUNT;
    value = (rcc_read(rcc, offset) & ~lanes) | (value & lanes);
    if (bus != RCC_BUS_COUNT) {
        write_bus(rcc, bus, offset, value);
        return;
    }
    switch (offset) {
    case 0x00:
        write_cr(rcc, value);
        break;
    case 0x04:
        write_pllcfgr(rcc, value);
        break;
    case 0x08:
        change_clocks(rcc, value & CFGR_BITS, rcc->switched);
        follow_switch(rcc);
        break;
    case 0x0C:
        write_cir(rcc, value);
        break;
    case 0x70:
        write_bdcr(rcc, value);
        break;
    case 0x74:
        write_csr(rcc, value);
        break;
    case 0x80:
        rcc->sscgr = value;
        break;
    case 0x84:
        rcc->plli2scfgr = value & PLLI2S_BITS;
        break;
    default:
        break;
    }
}
