#include "mcu/exti.h"

#include "mcu/soc.h"

#define LINES 0x007FFFFFU

static unsigned port_of_line(const struct exti *exti, unsigned line) {
    return exti->port_of[line / 4U] >> (4U * (line % 4U)) & 15U;
}

/// Lines 0 to 4 have an interrupt each, 5 to 9 and 10 to 15 share one.
static void update_interrupts(const struct exti *exti) {
    struct nvic *nvic = &exti->soc->nvic;
    const uint32_t wanted = exti->pr & exti->imr;
    for (unsigned line = 0; line < 5U; line++) {
        nvic_set_line(nvic, 6U + line, (wanted >> line & 1U) != 0U);
    }
    nvic_set_line(nvic, 23, (wanted & 0x03E0U) != 0U);
    nvic_set_line(nvic, 40, (wanted & 0xFC00U) != 0U);
}

void exti_reset(struct exti *exti, struct soc *soc) {
    exti->soc = soc;
    exti->imr = exti->emr = exti->rtsr = exti->ftsr = exti->pr = 0;
    update_interrupts(exti);
}

void exti_syscfg_reset(struct exti *exti) {
    for (unsigned i = 0; i < 4U; i++) {
        exti->port_of[i] = 0;
    }
    exti->memrmp = exti->pmc = 0;
}

void exti_port_changed(struct exti *exti, unsigned port, uint32_t before, uint32_t after) {
    for (uint32_t left = before ^ after; left != 0U; left &= left - 1U) {
        const unsigned line = (unsigned)__builtin_ctz(left);
        const uint32_t bit = UINT32_C(1) << line;
        const uint32_t edges = (after & bit) != 0U ? exti->rtsr : exti->ftsr;
        if (port_of_line(exti, line) == port) {
            exti->pr |= edges & (exti->imr | exti->emr) & bit;
        }
    }
    update_interrupts(exti);
}

uint32_t exti_read(void *model, uint32_t offset) {
    const struct exti *exti = model;
    switch (offset) {
    case 0x00:
        return exti->imr;
    case 0x04:
        return exti->emr;
    case 0x08:
        return exti->rtsr;
    case 0x0C:
        return exti->ftsr;
    case 0x14:
        return exti->pr;
    default:
        return 0;
    }
}

void exti_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct exti *exti = model;
    (void)lanes;
    value &= LINES;
    switch (offset) {
    case 0x00:
        exti->imr = value;
        break;
    case 0x04:
        exti->emr = value;
        break;
    case 0x08:
        exti->rtsr = value;
        break;
    case 0x0C:
        exti->ftsr = value;
        break;
    case 0x10: // SWIER: as if an edge had come
        exti->pr |= value & exti->imr;
        break;
    case 0x14:
        exti->pr &= ~value;
        break;
    default:
        break;
    }
    update_interrupts(exti);
}

uint32_t exti_syscfg_read(void *model, uint32_t offset) {
    const struct exti *exti = model;
    if (offset >= 0x08U && offset <= 0x14U) {
        return exti->port_of[(offset - 0x08U) / 4U];
    }
    return offset == 0x00U ? exti->memrmp : offset == 0x04U ? exti->pmc : 0U;
}

void exti_syscfg_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct exti *exti = model;
    (void)lanes;
    if (offset >= 0x08U && offset <= 0x14U) {
        exti->port_of[(offset - 0x08U) / 4U] = value & 0xFFFFU;
    } else if (offset == 0x00U) {
        exti->memrmp = value & 3U;
    } else if (offset == 0x04U) {
        exti->pmc = value & (UINT32_C(1) << 23);
    }
}
