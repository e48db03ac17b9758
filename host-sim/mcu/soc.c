#include "mcu/soc.h"

#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#define PERIPHERALS     0x40000000U
#define PERIPHERALS_END 0x40080000U
#define CORE            0xE0000000U
#define CORE_END        0xE0100000U
#define BLOCK_BYTES     0x400U
#define BLOCKS          ((PERIPHERALS_END - PERIPHERALS) / BLOCK_BYTES)
/// AHB1 begins here: its parts take bytes and halves; the bridges before it only words.
#define AHB 0x40020000U
/// Times are worked out up to so far ahead; farther ones are looked at again then.
#define HORIZON_NS UINT64_C(100000000000)
#define SECOND_NS  UINT64_C(1000000000)

// ---------------------------------------------------------------- the parts

struct part {
    uint32_t base;
    enum rcc_bus bus; ///< where its clock is switched
    uint8_t bit;
    size_t offset; ///< of its model in struct soc
    uint32_t (*read)(void *model, uint32_t offset);
    void (*write)(void *model, uint32_t offset, uint32_t value, uint32_t lanes);
};

#define PART(base, bus, bit, member, module)                                                       \
    { base, bus, bit, offsetof(struct soc, member), module##_read, module##_write }

static const struct part parts[SOC_PART_COUNT] = {
    [SOC_RCC] = PART(0x40023800U, RCC_UNGATED, 0, rcc, rcc),
    [SOC_FLASH] = PART(0x40023C00U, RCC_UNGATED, 0, flash, flash_interface),
    [SOC_PWR] = PART(0x40007000U, RCC_APB1, 28, pwr, pwr),
    [SOC_SYSCFG] = PART(0x40013800U, RCC_APB2, 14, exti, exti_syscfg),
    [SOC_EXTI] = PART(0x40013C00U, RCC_UNGATED, 0, exti, exti),
    [SOC_IWDG] = PART(0x40003000U, RCC_UNGATED, 0, iwdg, iwdg),
    [SOC_GPIOA + 0] = PART(0x40020000U, RCC_AHB1, 0, gpio[0], gpio),
    [SOC_GPIOA + 1] = PART(0x40020400U, RCC_AHB1, 1, gpio[1], gpio),
    [SOC_GPIOA + 2] = PART(0x40020800U, RCC_AHB1, 2, gpio[2], gpio),
    [SOC_GPIOA + 3] = PART(0x40020C00U, RCC_AHB1, 3, gpio[3], gpio),
    [SOC_GPIOA + 4] = PART(0x40021000U, RCC_AHB1, 4, gpio[4], gpio),
    [SOC_GPIOA + 5] = PART(0x40021400U, RCC_AHB1, 5, gpio[5], gpio),
    [SOC_GPIOA + 6] = PART(0x40021800U, RCC_AHB1, 6, gpio[6], gpio),
    [SOC_GPIOA + 7] = PART(0x40021C00U, RCC_AHB1, 7, gpio[7], gpio),
    [SOC_GPIOA + 8] = PART(0x40022000U, RCC_AHB1, 8, gpio[8], gpio),
    [SOC_TIM1 + 0] = PART(0x40010000U, RCC_APB2, 0, timer[0], timer),
    [SOC_TIM1 + 1] = PART(0x40000000U, RCC_APB1, 0, timer[1], timer),
    [SOC_TIM1 + 2] = PART(0x40000400U, RCC_APB1, 1, timer[2], timer),
    [SOC_TIM1 + 3] = PART(0x40000800U, RCC_APB1, 2, timer[3], timer),
    [SOC_TIM1 + 4] = PART(0x40000C00U, RCC_APB1, 3, timer[4], timer),
    [SOC_USART1 + 0] = PART(0x40011000U, RCC_APB2, 4, usart[0], usart),
    [SOC_USART1 + 1] = PART(0x40004400U, RCC_APB1, 17, usart[1], usart),
    [SOC_USART1 + 2] = PART(0x40004800U, RCC_APB1, 18, usart[2], usart),
    [SOC_USART1 + 3] = PART(0x40004C00U, RCC_APB1, 19, usart[3], usart),
    [SOC_USART1 + 4] = PART(0x40005000U, RCC_APB1, 20, usart[4], usart),
    [SOC_USART1 + 5] = PART(0x40011400U, RCC_APB2, 5, usart[5], usart),
    [SOC_CAN1] = PART(0x40006400U, RCC_APB1, 25, can[0], bxcan),
    [SOC_CAN2] = PART(0x40006800U, RCC_APB1, 26, can[1], bxcan),
};

static void *model_of(struct soc *soc, const struct part *part) {
    return (char *)soc + part->offset;
}

/// The part whose registers are at an address; NULL: none that has a model.
static const struct part *part_at(const struct soc *soc, uint32_t address) {
    if (address < PERIPHERALS || address >= PERIPHERALS_END) {
        return NULL;
    }
    const uint8_t index = soc->part_of_block[(address - PERIPHERALS) / BLOCK_BYTES];
    return index != 0U ? &parts[index - 1U] : NULL;
}

static void reset_part(struct soc *soc, unsigned index) {
    if (index >= SOC_GPIOA && index < SOC_GPIO_END) {
        gpio_reset(&soc->gpio[index - SOC_GPIOA], soc, index - SOC_GPIOA);
    } else if (index >= SOC_TIM1 && index < SOC_TIM_END) {
        timer_reset(&soc->timer[index - SOC_TIM1], soc, index - SOC_TIM1);
    } else if (index >= SOC_USART1 && index < SOC_USART_END) {
        usart_reset(&soc->usart[index - SOC_USART1], soc, index - SOC_USART1);
    } else if (index == SOC_CAN1 || index == SOC_CAN2) {
        bxcan_reset(&soc->can[index - SOC_CAN1], soc, index - SOC_CAN1);
    } else if (index == SOC_PWR) {
        pwr_reset(&soc->pwr, soc);
    } else if (index == SOC_SYSCFG) {
        exti_syscfg_reset(&soc->exti);
    }
}

void soc_reset_parts(struct soc *soc, enum rcc_bus bus, uint32_t bits) {
    for (unsigned i = 0; i < SOC_PART_COUNT; i++) {
        if (parts[i].read != NULL && parts[i].bus == bus && (bits >> parts[i].bit & 1U) != 0U) {
            reset_part(soc, i);
        }
    }
}

void soc_reset(struct soc *soc, enum soc_reset cause) {
    soc->reset_wanted = SOC_RESET_NONE;
    nvic_reset(&soc->nvic, &soc->attend_cycle);
    scb_reset(&soc->scb, soc);
    systick_reset(&soc->systick, soc);
    // What the clocks are checked against comes first.
    flash_interface_reset(&soc->flash, soc);
    pwr_reset(&soc->pwr, soc);
    iwdg_reset(&soc->iwdg, soc);
    exti_reset(&soc->exti, soc);
    rcc_reset(&soc->rcc, soc, cause);
    for (unsigned i = 0; i < SOC_PART_COUNT; i++) {
        reset_part(soc, i);
    }
}

void soc_init(struct soc *soc, const struct soc_options *options) {
    memset(soc, 0, sizeof *soc);
    soc->options = *options;
    soc->hclk_hz = 16000000;
    for (unsigned i = 0; i < SOC_PART_COUNT; i++) {
        soc->due_cycle[i] = soc->due_ns[i] = SOC_NEVER;
        if (parts[i].read != NULL) {
            soc->part_of_block[(parts[i].base - PERIPHERALS) / BLOCK_BYTES] = (uint8_t)(i + 1U);
        }
    }
    soc->next_cycle = soc->attend_cycle = SOC_NEVER;
    soc_reset(soc, SOC_RESET_POWER);
}

// ---------------------------------------------------------------- accesses

static uint32_t read_core(struct soc *soc, uint32_t address) {
    if (address >= 0xE000E010U && address < 0xE000E020U) {
        return systick_read(&soc->systick, address - 0xE000E010U);
    }
    if (address >= 0xE000E100U && address < 0xE000ED00U) {
        return nvic_read(&soc->nvic, address);
    }
    return scb_read(&soc->scb, address);
}

static void write_core(struct soc *soc, uint32_t address, uint32_t value, uint32_t lanes) {
    if (address >= 0xE000E010U && address < 0xE000E020U) {
        systick_write(&soc->systick, address - 0xE000E010U, value);
    } else if ((address >= 0xE000E100U && address < 0xE000ED00U) || address == 0xE000EF00U) {
        nvic_write(&soc->nvic, address, value, lanes);
    } else {
        scb_write(&soc->scb, address, value, lanes);
    }
}

/// A register without a model, or whose part has no clock.
static bool is_usable(struct soc *soc, const struct part *part, uint32_t address) {
    if (part == NULL) {
        soc_complain(soc, "no model of a register at 0x%08X", address & ~(BLOCK_BYTES - 1U));
        return false;
    }
    if (!rcc_is_clocked(&soc->rcc, part->bus, part->bit)) {
        soc_complain(soc, "a register of 0x%08X is used, whose clock is off", part->base);
        return false;
    }
    return true;
}

/// Bits of a word that an access of some bytes reaches.
static uint32_t lanes_of(uint32_t address, unsigned size_bytes) {
    const uint32_t ones = size_bytes >= 4U ? UINT32_MAX : (UINT32_C(1) << (8U * size_bytes)) - 1U;
    return ones << (8U * (address & 3U));
}

uint32_t soc_read(struct soc *soc, uint32_t address, unsigned size_bytes) {
    const uint32_t aligned = address & ~3U;
    uint32_t word = 0;
    if (address >= CORE && address < CORE_END) {
        word = read_core(soc, aligned);
    } else {
        const struct part *part = part_at(soc, address);
        if (is_usable(soc, part, address)) {
            word = part->read(model_of(soc, part), aligned - part->base);
        }
    }
    return (word & lanes_of(address, size_bytes)) >> (8U * (address & 3U));
}

void soc_write(struct soc *soc, uint32_t address, unsigned size_bytes, uint32_t value) {
    const uint32_t aligned = address & ~3U;
    uint32_t lanes = lanes_of(address, size_bytes);
    uint32_t word = value << (8U * (address & 3U)) & lanes;
    if (address >= CORE && address < CORE_END) {
        write_core(soc, aligned, word, lanes);
        return;
    }
    const struct part *part = part_at(soc, address);
    if (!is_usable(soc, part, address)) {
        return;
    }
    if (address < AHB && size_bytes < 4U) {
        // The bridges repeat a byte or half over the whole word (RM0090, 2.1).
        word = size_bytes == 1U ? (value & 0xFFU) * 0x01010101U : (value & 0xFFFFU) * 0x00010001U;
        lanes = UINT32_MAX;
    }
    part->write(model_of(soc, part), aligned - part->base, word, lanes);
}

// ---------------------------------------------------------------- time

uint64_t soc_cycle_at(const struct soc *soc, uint64_t ns) {
    const uint64_t now_ns = soc_now_ns(soc);
    const uint64_t until = ns < now_ns + HORIZON_NS ? ns : now_ns + HORIZON_NS;
    if (until <= soc->epoch_ns) {
        return soc->epoch_cycle;
    }
    const uint64_t ahead = until - soc->epoch_ns;
    const uint64_t seconds = ahead / SECOND_NS, rest = ahead % SECOND_NS;
    return soc->epoch_cycle + seconds * soc->hclk_hz +
           (rest * soc->hclk_hz + SECOND_NS - 1U) / SECOND_NS;
}

static void find_next(struct soc *soc) {
    uint64_t next = SOC_NEVER;
    for (unsigned i = 0; i < SOC_PART_COUNT; i++) {
        next = soc->due_cycle[i] < next ? soc->due_cycle[i] : next;
    }
    soc->next_cycle = next;
    soc->attend_cycle = soc->attend_cycle != 0U ? next : 0U;
}

/// A part's due time changes. Only if it was the earliest do the others matter.
static void set_due(struct soc *soc, enum soc_part part, uint64_t cycle) {
    const uint64_t before = soc->due_cycle[part];
    soc->due_cycle[part] = cycle;
    if (cycle <= soc->next_cycle) {
        soc->next_cycle = cycle;
        soc->attend_cycle = soc->attend_cycle != 0U ? cycle : 0U;
    } else if (before == soc->next_cycle) {
        find_next(soc);
    }
}

void soc_set_hclk(struct soc *soc, uint32_t hz) {
    soc->epoch_ns = soc_now_ns(soc);
    soc->epoch_cycle = soc->cycle;
    soc->hclk_hz = hz != 0U ? hz : 1U;
    for (unsigned i = 0; i < SOC_PART_COUNT; i++) {
        if (soc->due_ns[i] != SOC_NEVER) {
            soc->due_cycle[i] = soc_cycle_at(soc, soc->due_ns[i]);
        }
    }
    find_next(soc);
}

void soc_schedule(struct soc *soc, enum soc_part part, uint64_t cycle) {
    soc->due_ns[part] = SOC_NEVER;
    set_due(soc, part, cycle);
}

void soc_schedule_ns(struct soc *soc, enum soc_part part, uint64_t ns) {
    if (soc->due_ns[part] != ns || ns == SOC_NEVER) {
        soc->due_ns[part] = ns;
        set_due(soc, part, ns != SOC_NEVER ? soc_cycle_at(soc, ns) : SOC_NEVER);
    }
}

static void call_due(struct soc *soc, unsigned index) {
    if (index >= SOC_TIM1 && index < SOC_TIM_END) {
        timer_due(&soc->timer[index - SOC_TIM1]);
    } else if (index >= SOC_USART1 && index < SOC_USART_END) {
        usart_due(&soc->usart[index - SOC_USART1]);
    } else if (index == SOC_CAN1 || index == SOC_CAN2) {
        bxcan_due(&soc->can[index - SOC_CAN1]);
    } else if (index == SOC_SYSTICK) {
        systick_due(&soc->systick);
    } else if (index == SOC_RCC) {
        rcc_due(&soc->rcc);
    } else if (index == SOC_IWDG) {
        iwdg_due(&soc->iwdg);
    } else if (index == SOC_WORLD && soc->world != NULL) {
        soc->world(soc->world_context);
    } else if (index == SOC_END) {
        soc->ended = true;
    }
}

void soc_run_due(struct soc *soc) {
    // Whole seconds move into the epoch, so that times never overflow.
    while (soc->cycle - soc->epoch_cycle >= soc->hclk_hz) {
        soc->epoch_cycle += soc->hclk_hz;
        soc->epoch_ns += SECOND_NS;
    }
    while (soc->next_cycle <= soc->cycle) {
        unsigned first = 0;
        for (unsigned i = 1; i < SOC_PART_COUNT; i++) {
            first = soc->due_cycle[i] < soc->due_cycle[first] ? i : first;
        }
        soc_schedule(soc, (enum soc_part)first, SOC_NEVER);
        call_due(soc, first);
    }
    soc->attend_cycle =
        soc->nvic.attention || soc->reset_wanted != SOC_RESET_NONE ? 0U : soc->next_cycle;
}

void soc_set_end(struct soc *soc, uint64_t ns) {
    soc->ended = false;
    soc_schedule_ns(soc, SOC_END, ns);
}

void soc_advance_ns(struct soc *soc, uint64_t ns) {
    const uint64_t end_ns = soc_now_ns(soc) + ns;
    while (soc_now_ns(soc) < end_ns) {
        soc_set_end(soc, end_ns); // farther than the horizon takes several
        while (!soc->ended) {
            soc->cycle = soc->next_cycle > soc->cycle ? soc->next_cycle : soc->cycle;
            soc_run_due(soc);
        }
    }
}

// ---------------------------------------------------------------- complaints

void soc_complain(struct soc *soc, const char *format, ...) {
    char text[sizeof soc->complaint[0]];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    soc->complaints++;
    for (unsigned i = 0; i < soc->complaint_kinds; i++) {
        if (strcmp(soc->complaint[i], text) == 0) {
            return;
        }
    }
    if (soc->complaint_kinds < SOC_COMPLAINTS_KEPT) {
        memcpy(soc->complaint[soc->complaint_kinds++], text, sizeof text);
        if (soc->options.log != NULL) {
            fprintf(soc->options.log, "board at %.6f s: %s\n", (double)soc_now_ns(soc) * 1e-9,
                    text);
        }
    }
}
