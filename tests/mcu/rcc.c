/// Clocks and resets, against RM0090, chapter 7.
#include "chip.h"

#define CR      (RCC + 0x00U)
#define PLLCFGR (RCC + 0x04U)
#define CFGR    (RCC + 0x08U)
#define CIR     (RCC + 0x0CU)
#define CSR     (RCC + 0x74U)
#define HSION   (UINT32_C(1) << 0)
#define HSEON   (UINT32_C(1) << 16)
#define HSERDY  (UINT32_C(1) << 17)
#define CSSON   (UINT32_C(1) << 19)
#define PLLON   (UINT32_C(1) << 24)
#define PLLRDY  (UINT32_C(1) << 25)

static uint32_t running_from(void) {
    return peek(CFGR) >> 2 & 3U; // SWS
}

static uint64_t cycles_in_1_ms(void) {
    const uint64_t before = chip.cycle;
    pass_us(1000);
    return chip.cycle - before;
}

static void reset_values_are_the_manuals(void) {
    static const struct {
        uint32_t offset, value;
    } table[] = {{0x04, 0x24003010}, {0x08, 0},          {0x0C, 0},    {0x10, 0},
                 {0x14, 0},          {0x18, 0},          {0x20, 0},    {0x24, 0},
                 {0x30, 0x00100000}, {0x34, 0},          {0x38, 0},    {0x40, 0},
                 {0x44, 0},          {0x50, 0x7E6791FF}, {0x54, 0xF1}, {0x58, 1},
                 {0x60, 0x36FEC9FF}, {0x64, 0x00075F33}, {0x70, 0},    {0x74, 0x0E000000},
                 {0x80, 0},          {0x84, 0x20003000}};
    power_on();
    CHECK_EQ(peek(CR) & 0xFFFF00FFU, 0x83); // the calibration between is of the factory
    for (unsigned i = 0; i < sizeof table / sizeof *table; i++) {
        CHECK_EQ(peek(RCC + table[i].offset), table[i].value);
    }
}

static void it_starts_at_16_mhz(void) {
    power_on();
    CHECK_EQ(cycles_in_1_ms(), 16000);
    CHECK_EQ(running_from(), 0);
}

static void the_crystal_takes_its_time(void) {
    power_on();
    set_bits(CR, HSEON);
    pass_us(100);
    CHECK((peek(CR) & HSERDY) == 0U);
    pass_us(10000);
    CHECK((peek(CR) & HSERDY) != 0U);
}

static void without_crystal_it_never_gets_ready(void) {
    power_on_with((struct soc_options){.hse_hz = 0});
    set_bits(CR, HSEON);
    pass_us(1000000);
    CHECK((peek(CR) & HSERDY) == 0U);
    power_on_with((struct soc_options){.hse_hz = 8000000, .stuck = SOC_STUCK_HSE});
    set_bits(CR, HSEON);
    pass_us(1000000);
    CHECK((peek(CR) & HSERDY) == 0U);
}

static void the_pll_gives_168_mhz(void) {
    power_on();
    run_at_168_mhz();
    CHECK_EQ(running_from(), 2);
    CHECK_EQ(cycles_in_1_ms(), 168000);
    CHECK_EQ(rcc_pclk_hz(&chip.rcc, RCC_APB1), 42000000);
    CHECK_EQ(rcc_pclk_hz(&chip.rcc, RCC_APB2), 84000000);
    CHECK_EQ(chip.complaints, 0);
}

static void every_pll_factor_counts(void) {
    // M, N, P as a code, and what comes out of 8 MHz.
    static const uint32_t factors[][4] = {
        {8, 192, 0, 96000000}, {4, 100, 1, 50000000}, {5, 125, 2, 33333333}, {8, 384, 3, 48000000}};
    for (unsigned i = 0; i < 4U; i++) {
        power_on();
        set_bits(CR, HSEON);
        pass_us(10000);
        poke(FLASH, 5);
        poke(PLLCFGR, factors[i][0] | factors[i][1] << 6 | factors[i][2] << 16 | UINT32_C(1) << 22 |
                          7U << 24);
        poke(CFGR, 5U << 10 | 4U << 13);
        set_bits(CR, PLLON);
        pass_us(1000);
        set_bits(CFGR, 2);
        CHECK_NEAR(chip.hclk_hz, factors[i][3], 1);
        CHECK_EQ(chip.complaints, 0);
    }
}

static void the_switch_waits_for_its_clock(void) {
    power_on();
    set_bits(CFGR, 1); // to the crystal, which is off
    pass_us(10000);
    CHECK_EQ(running_from(), 0);
    set_bits(CR, HSEON);
    CHECK_EQ(running_from(), 0);
    pass_us(10000);
    CHECK_EQ(running_from(), 1);
    CHECK_EQ(cycles_in_1_ms(), 8000);
}

static void stuck_bits_stay(void) {
    power_on_with((struct soc_options){.hse_hz = 8000000, .stuck = SOC_STUCK_PLL});
    run_at_168_mhz();
    CHECK((peek(CR) & PLLRDY) == 0U);
    CHECK_EQ(running_from(), 0);
    power_on_with((struct soc_options){.hse_hz = 8000000, .stuck = SOC_STUCK_SWITCH});
    run_at_168_mhz();
    CHECK((peek(CR) & PLLRDY) != 0U);
    CHECK_EQ(running_from(), 0);
}

static void what_runs_the_system_stays_on(void) {
    power_on();
    poke(CR, peek(CR) & ~HSION);
    CHECK((peek(CR) & HSION) != 0U);
    run_at_168_mhz();
    poke(CR, peek(CR) & ~(PLLON | HSEON));
    CHECK((peek(CR) & (PLLON | HSEON)) == (PLLON | HSEON));
    CHECK_EQ(cycles_in_1_ms(), 168000);
    poke(CR, peek(CR) & ~HSION); // no longer in use
    CHECK((peek(CR) & 3U) == 0U);
}

static void bus_dividers(void) {
    static const uint32_t ahb[16] = {1, 1, 1, 1, 1, 1, 1, 1, 2, 4, 8, 16, 64, 128, 256, 512};
    static const uint32_t apb[8] = {1, 1, 1, 1, 2, 4, 8, 16};
    power_on();
    for (uint32_t i = 0; i < 16U; i++) {
        poke(CFGR, i << 4);
        CHECK_EQ(chip.hclk_hz, 16000000U / ahb[i]);
    }
    for (uint32_t i = 0; i < 8U; i++) {
        // The timers get twice the bus clock, unless the bus is not divided.
        const uint32_t timer = apb[i] == 1U ? 1U : apb[i] / 2U;
        poke(CFGR, i << 10);
        CHECK_EQ(rcc_pclk_hz(&chip.rcc, RCC_APB1), 16000000U / apb[i]);
        CHECK_EQ(rcc_pclk_hz(&chip.rcc, RCC_APB2), 16000000U);
        CHECK_EQ(rcc_timer_divider(&chip.rcc, RCC_APB1), timer);
        poke(CFGR, i << 13);
        CHECK_EQ(rcc_pclk_hz(&chip.rcc, RCC_APB2), 16000000U / apb[i]);
        CHECK_EQ(rcc_timer_divider(&chip.rcc, RCC_APB2), timer);
    }
}

static void a_part_without_clock_is_dead(void) {
    power_on();
    poke(GPIOC + 0x14U, 0xFFU);
    CHECK_EQ(chip.complaints, 1);
    CHECK_EQ(peek(GPIOC + 0x14U), 0);
    poke(RCC + 0x30U, 4);
    CHECK_EQ(peek(GPIOC + 0x14U), 0);
    poke(GPIOC + 0x14U, 0xFFU);
    CHECK_EQ(peek(GPIOC + 0x14U), 0xFF);
    poke(RCC + 0x30U, 0); // keeps what it has
    poke(RCC + 0x30U, 4);
    CHECK_EQ(peek(GPIOC + 0x14U), 0xFF);
    poke(RCC + 0x10U, 4); // held in reset
    poke(RCC + 0x10U, 0);
    CHECK_EQ(peek(GPIOC + 0x14U), 0);
}

static void registers_take_bytes(void) {
    power_on();
    soc_write(&chip, RCC + 0x30U, 1, 0x07);
    CHECK_EQ(peek(RCC + 0x30U), 0x00100007);
    soc_write(&chip, RCC + 0x41U, 1, 0x80); // APB1ENR, bits 8 to 15
    CHECK_EQ(peek(RCC + 0x40U), 0x8000);
    CHECK_EQ(soc_read(&chip, RCC + 0x32U, 2), 0x10);
}

static void complaints_of(const char *what, uint64_t wanted) {
    if (!CHECK_EQ(chip.complaints != 0U, wanted)) {
        check_note(what, (int64_t)chip.complaints);
    }
}

static void forbidden_clocks_are_complaints(void) {
    power_on();
    set_bits(CR, HSEON);
    pass_us(10000);
    poke(CFGR, 5U << 10 | 4U << 13);
    poke(PLLCFGR, 8U | 336U << 6 | UINT32_C(1) << 22 | 7U << 24);
    set_bits(CR, PLLON);
    pass_us(1000);
    complaints_of("so far all is well", 0);
    set_bits(CFGR, 2);
    complaints_of("168 MHz without wait states", 1);

    power_on();
    set_bits(CR, HSEON);
    pass_us(10000);
    poke(PLLCFGR, 2U | 100U << 6 | UINT32_C(1) << 22 | 7U << 24); // 4 MHz into the PLL
    set_bits(CR, PLLON);
    complaints_of("PLL input", 1);

    power_on();
    set_bits(CR, HSEON);
    pass_us(10000);
    poke(PLLCFGR, 8U | 60U << 6 | UINT32_C(1) << 22 | 7U << 24); // oscillator at 60 MHz
    set_bits(CR, PLLON);
    complaints_of("PLL oscillator", 1);

    power_on();
    run_at_168_mhz();
    complaints_of("so far all is well", 0);
    poke(CFGR, 2U | 4U << 10 | 4U << 13); // APB1 at 84 MHz
    complaints_of("APB1", 1);

    power_on();
    run_at_168_mhz();
    set_bits(RCC + 0x40U, UINT32_C(1) << 28);
    poke(PWR, 0); // voltage scale 2: 144 MHz at most
    complaints_of("voltage scale", 1);

    power_on();
    run_at_168_mhz();
    poke(PLLCFGR, 0x24003010U);
    complaints_of("PLLCFGR while the PLL runs", 1);
}

/// RM0090, table 10, at 2.7 V and more: a wait state for each 30 MHz begun.
static void flash_wait_states(void) {
    static const uint32_t cases[][2] = {{60, 1},  {62, 2},  {90, 2}, {92, 3},
                                        {120, 3}, {150, 4}, {152, 5}};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (uint32_t less = 0; less < 2U; less++) {
            power_on();
            poke(FLASH, cases[i][1] - less);
            poke(PLLCFGR, 16U | 2U * cases[i][0] << 6 | 8U << 24); // 1 MHz * 2 f / 2
            poke(CFGR, 5U << 10 | 4U << 13);
            set_bits(CR, PLLON);
            pass_us(1000);
            set_bits(CFGR, 2);
            CHECK_EQ(chip.hclk_hz, cases[i][0] * 1000000U);
            complaints_of("wait states", less);
        }
    }
}

static void the_clock_monitor_saves_the_system(void) {
    power_on();
    run_at_168_mhz();
    set_bits(CR, CSSON);
    pass_us(10);
    rcc_fail_hse(&chip.rcc);
    CHECK(is_pending(2)); // NMI
    CHECK((peek(CIR) & 0x80U) != 0U);
    CHECK_EQ(running_from(), 0);
    CHECK((peek(CR) & (HSEON | HSERDY | PLLON | PLLRDY)) == 0U);
    CHECK_EQ(cycles_in_1_ms(), 16000);
    poke(CIR, UINT32_C(1) << 23); // CSSC
    CHECK((peek(CIR) & 0x80U) == 0U);
    CHECK_EQ(chip.complaints, 0);
}

static void without_the_monitor_the_chip_stands_still(void) {
    power_on();
    run_at_168_mhz();
    rcc_fail_hse(&chip.rcc);
    CHECK(!is_pending(2));
    CHECK_EQ(chip.complaints, 1);
}

static void ready_interrupts(void) {
    power_on();
    poke(CIR, UINT32_C(1) << 11); // HSERDYIE
    set_bits(CR, HSEON);
    CHECK(!irq_is_pending(5));
    pass_us(10000);
    CHECK(irq_is_pending(5));
    CHECK_EQ(peek(CIR), 0x808);
    poke(CIR, UINT32_C(1) << 19 | UINT32_C(1) << 11); // HSERDYC
    CHECK_EQ(peek(CIR), 0x800);
}

static void reset_causes(void) {
    power_on();
    poke(CSR, UINT32_C(1) << 24); // RMVF
    CHECK_EQ(peek(CSR), 0);
    run_at_168_mhz();
    soc_reset(&chip, SOC_RESET_SOFTWARE);
    CHECK_EQ(peek(CSR), 0x14000000); // SFTRSTF, PINRSTF
    CHECK_EQ(running_from(), 0);
    CHECK_EQ(cycles_in_1_ms(), 16000);
    soc_reset(&chip, SOC_RESET_WATCHDOG);
    CHECK_EQ(peek(CSR), 0x34000000); // IWDGRSTF, and what was not removed
    poke(CSR, UINT32_C(1) << 24);
    soc_reset(&chip, SOC_RESET_PIN);
    CHECK_EQ(peek(CSR), 0x04000000);
}

static void the_low_speed_oscillator(void) {
    power_on();
    set_bits(CSR, 1);
    CHECK((peek(CSR) & 2U) == 0U);
    pass_us(100);
    CHECK((peek(CSR) & 2U) != 0U);
    poke(CSR, 0);
    CHECK((peek(CSR) & 2U) == 0U);
}

int main(void) {
    TEST(reset_values_are_the_manuals);
    TEST(it_starts_at_16_mhz);
    TEST(the_crystal_takes_its_time);
    TEST(without_crystal_it_never_gets_ready);
    TEST(the_pll_gives_168_mhz);
    TEST(every_pll_factor_counts);
    TEST(the_switch_waits_for_its_clock);
    TEST(stuck_bits_stay);
    TEST(what_runs_the_system_stays_on);
    TEST(bus_dividers);
    TEST(a_part_without_clock_is_dead);
    TEST(registers_take_bytes);
    TEST(forbidden_clocks_are_complaints);
    TEST(flash_wait_states);
    TEST(the_clock_monitor_saves_the_system);
    TEST(without_the_monitor_the_chip_stands_still);
    TEST(ready_interrupts);
    TEST(reset_causes);
    TEST(the_low_speed_oscillator);
    return check_finish();
}
