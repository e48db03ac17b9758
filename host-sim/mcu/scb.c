#include "mcu/scb.h"

#include "mcu/soc.h"

#define CPUID      0xE000ED00U
#define ICSR       0xE000ED04U
#define VTOR       0xE000ED08U
#define AIRCR      0xE000ED0CU
#define SCR        0xE000ED10U
#define CCR        0xE000ED14U
#define SHPR1      0xE000ED18U
#define SHPR3      0xE000ED20U
#define SHCSR      0xE000ED24U
#define CFSR       0xE000ED28U
#define HFSR       0xE000ED2CU
#define DFSR       0xE000ED30U
#define MMFAR      0xE000ED34U
#define BFAR       0xE000ED38U
#define AFSR       0xE000ED3CU
#define CPACR      0xE000ED88U
#define MPU_TYPE   0xE000ED90U
#define MPU_END    0xE000EDB8U
#define DHCSR      0xE000EDF0U
#define DEMCR      0xE000EDFCU
#define FPCCR      0xE000EF34U
#define ICTR       0xE000E004U
#define ACTLR      0xE000E008U
#define DWT_CTRL   0xE0001000U
#define DWT_CYCCNT 0xE0001004U
#define DBG_IDCODE 0xE0042000U

#define ICSR_NMIPENDSET  (UINT32_C(1) << 31)
#define ICSR_PENDSVSET   (UINT32_C(1) << 28)
#define ICSR_PENDSVCLR   (UINT32_C(1) << 27)
#define ICSR_PENDSTSET   (UINT32_C(1) << 26)
#define ICSR_PENDSTCLR   (UINT32_C(1) << 25)
#define ICSR_ISRPENDING  (UINT32_C(1) << 22)
#define ICSR_RETTOBASE   (UINT32_C(1) << 11)
#define AIRCR_KEY        0x05FAU
#define AIRCR_SYSRESET   (UINT32_C(1) << 2)
#define SCR_SLEEPONEXIT  (UINT32_C(1) << 1)
#define SCR_SEVONPEND    (UINT32_C(1) << 4)
#define SCR_BITS         0x16U
#define CCR_BITS         0x31BU
#define CCR_STKALIGN     0x200U
#define VTOR_BITS        0x3FFFFE00U
#define DEMCR_TRCENA     (UINT32_C(1) << 24)
#define DWT_CYCCNTENA    1U
#define DWT_NUMCOMP_FOUR 0x40000000U
#define FAULT_ENABLES    (UINT32_C(7) << 16)

void scb_reset(struct scb *scb, struct soc *soc) {
    *scb = (struct scb){.soc = soc, .ccr = CCR_STKALIGN, .fpccr = 0xC0000000U};
}

bool scb_sleeps_on_exit(const struct scb *scb) {
    return (scb->scr & SCR_SLEEPONEXIT) != 0U;
}

// ---------------------------------------------------------------- cycle counter

static bool counts_cycles(const struct scb *scb) {
    return (scb->demcr & DEMCR_TRCENA) != 0U && (scb->dwt_control & DWT_CYCCNTENA) != 0U;
}

static uint32_t awake_cycles(const struct scb *scb) {
    return (uint32_t)(scb->soc->cycle - scb->soc->slept_cycles);
}

static uint32_t cycle_count(const struct scb *scb) {
    return counts_cycles(scb) ? awake_cycles(scb) + scb->cycles_offset : scb->cycles_offset;
}

/// While it stands the offset is its value.
static void write_cycle_count(struct scb *scb, uint32_t value) {
    scb->cycles_offset = counts_cycles(scb) ? value - awake_cycles(scb) : value;
}

/// Changes one of the two bits that let it count, and keeps its value.
static void write_counting(struct scb *scb, uint32_t *bits, uint32_t value) {
    const uint32_t count = cycle_count(scb);
    *bits = value;
    write_cycle_count(scb, count);
}

// ---------------------------------------------------------------- exceptions

static bool any_irq_pending(const struct nvic *nvic) {
    bool any = nvic->pending[0] >> NVIC_IRQ0 != 0U;
    for (unsigned word = 1; word < NVIC_WORDS; word++) {
        any = any || nvic->pending[word] != 0U;
    }
    return any;
}

static uint32_t read_icsr(const struct scb *scb) {
    const struct nvic *nvic = &scb->soc->nvic;
    uint32_t value = scb->exception | nvic->candidate << 12;
    value |= nvic_active_count(nvic) <= 1U ? ICSR_RETTOBASE : 0U;
    value |= any_irq_pending(nvic) ? ICSR_ISRPENDING : 0U;
    value |= nvic_test(nvic->pending, NVIC_SYSTICK) ? ICSR_PENDSTSET : 0U;
    value |= nvic_test(nvic->pending, NVIC_PENDSV) ? ICSR_PENDSVSET : 0U;
    value |= nvic_test(nvic->pending, NVIC_NMI) ? ICSR_NMIPENDSET : 0U;
    return value;
}

static void write_icsr(struct scb *scb, uint32_t value) {
    struct nvic *nvic = &scb->soc->nvic;
    if ((value & ICSR_NMIPENDSET) != 0U) {
        nvic_set_pending(nvic, NVIC_NMI, true);
    }
    if ((value & (ICSR_PENDSVSET | ICSR_PENDSVCLR)) != 0U) {
        nvic_set_pending(nvic, NVIC_PENDSV, (value & ICSR_PENDSVSET) != 0U);
    }
    if ((value & (ICSR_PENDSTSET | ICSR_PENDSTCLR)) != 0U) {
        nvic_set_pending(nvic, NVIC_SYSTICK, (value & ICSR_PENDSTSET) != 0U);
    }
}

static void write_aircr(struct scb *scb, uint32_t value) {
    if (value >> 16 != AIRCR_KEY) {
        return; // without the key nothing is written
    }
    scb->prigroup = value >> 8 & 7U;
    nvic_set_grouping(&scb->soc->nvic, scb->prigroup);
    if ((value & AIRCR_SYSRESET) != 0U) {
        soc_want_reset(scb->soc, SOC_RESET_SOFTWARE);
    }
}

static uint32_t read_shcsr(const struct scb *scb) {
    // Where each exception's active and pended bits are.
    static const struct {
        uint8_t exception, active, pended;
    } bits[] = {{NVIC_MEM_MANAGE, 0, 13}, {NVIC_BUS_FAULT, 1, 14},     {NVIC_USAGE_FAULT, 3, 12},
                {NVIC_SVCALL, 7, 15},     {NVIC_DEBUG_MONITOR, 8, 31}, {NVIC_PENDSV, 10, 31},
                {NVIC_SYSTICK, 11, 31}};
    const struct nvic *nvic = &scb->soc->nvic;
    uint32_t value = 0;
    for (unsigned i = 0; i < sizeof bits / sizeof *bits; i++) {
        value |= (uint32_t)nvic_test(nvic->active, bits[i].exception) << bits[i].active;
        if (bits[i].pended != 31U) {
            value |= (uint32_t)nvic_test(nvic->pending, bits[i].exception) << bits[i].pended;
        }
    }
    for (unsigned i = 0; i < 3U; i++) {
        value |= (uint32_t)nvic_test(nvic->enabled, NVIC_MEM_MANAGE + i) << (16U + i);
    }
    return value;
}

static void write_shcsr(struct scb *scb, uint32_t value) {
    for (unsigned i = 0; i < 3U; i++) {
        nvic_enable(&scb->soc->nvic, NVIC_MEM_MANAGE + i, (value >> (16U + i) & 1U) != 0U);
    }
    if ((value & ~FAULT_ENABLES) != (read_shcsr(scb) & ~FAULT_ENABLES)) {
        soc_complain(scb->soc, "SHCSR: active and pended bits can't be written here");
    }
}

/// SHPR1 to SHPR3: four exceptions in each, from number 4 on.
static uint32_t read_priorities(const struct scb *scb, uint32_t address) {
    uint32_t value = 0;
    for (unsigned i = 0; i < 4U; i++) {
        value |= (uint32_t)scb->soc->nvic.priority[4U + address - SHPR1 + i] << (8U * i);
    }
    return value;
}

static void write_priorities(struct scb *scb, uint32_t address, uint32_t value, uint32_t lanes) {
    for (unsigned i = 0; i < 4U; i++) {
        const unsigned exception = 4U + address - SHPR1 + i;
        const bool exists = exception <= NVIC_USAGE_FAULT || exception == NVIC_SVCALL ||
                            exception == NVIC_DEBUG_MONITOR || exception >= NVIC_PENDSV;
        if (exists && (lanes >> (8U * i) & 0xFFU) != 0U) {
            nvic_set_priority(&scb->soc->nvic, exception, (uint8_t)(value >> (8U * i)));
        }
    }
}

// ---------------------------------------------------------------- registers

/// Registers whose reading is more than a copy are not in this table.
static uint32_t read_plain(const struct scb *scb, uint32_t address) {
    switch (address) {
    case CPUID:
        return 0x410FC241U; // Cortex-M4 r0p1
    case VTOR:
        return scb->vtor;
    case AIRCR:
        return 0xFA050000U | scb->prigroup << 8;
    case SCR:
        return scb->scr;
    case CCR:
        return scb->ccr;
    case CFSR:
        return scb->cfsr;
    case HFSR:
        return scb->hfsr;
    case MMFAR:
        return scb->mmfar;
    case BFAR:
        return scb->bfar;
    case CPACR:
        return scb->cpacr;
    case MPU_TYPE:
        return 0x800U; // eight regions
    case DEMCR:
        return scb->demcr;
    case FPCCR:
        return scb->fpccr;
    case ICTR:
        return NVIC_IRQS / 32U;
    case DWT_CTRL:
        return DWT_NUMCOMP_FOUR | scb->dwt_control;
    case DBG_IDCODE:
        return 0x10076413U;
    default:
        return 0; // DHCSR, DFSR, AFSR, ACTLR among them: no debugger, nothing implemented
    }
}

uint32_t scb_read(struct scb *scb, uint32_t address) {
    switch (address) {
    case ICSR:
        return read_icsr(scb);
    case SHCSR:
        return read_shcsr(scb);
    case DWT_CYCCNT:
        return cycle_count(scb);
    default:
        break;
    }
    if (address >= SHPR1 && address <= SHPR3) {
        return read_priorities(scb, address);
    }
    return read_plain(scb, address);
}

static void write_control(struct scb *scb, uint32_t address, uint32_t value) {
    switch (address) {
    case SCR:
        scb->scr = value & SCR_BITS;
        scb->soc->nvic.set_event_on_pending = (value & SCR_SEVONPEND) != 0U;
        return;
    case CCR:
        scb->ccr = value & CCR_BITS;
        return;
    case CFSR:
        scb->cfsr &= ~value;
        return;
    case HFSR:
        scb->hfsr &= ~value;
        return;
    case MMFAR:
        scb->mmfar = value;
        return;
    case BFAR:
        scb->bfar = value;
        return;
    case CPACR:
        scb->cpacr = value & 0x00F00000U;
        return;
    case FPCCR:
        scb->fpccr = value;
        return;
    case DEMCR:
        write_counting(scb, &scb->demcr, value & DEMCR_TRCENA);
        return;
    case DWT_CTRL:
        write_counting(scb, &scb->dwt_control, value & DWT_CYCCNTENA);
        return;
    case DWT_CYCCNT:
        write_cycle_count(scb, value);
        return;
    default:
        break;
    }
    if (address > MPU_TYPE && address < MPU_END && value != 0U) {
        soc_complain(scb->soc, "the memory protection unit has no model");
    }
}

void scb_write(struct scb *scb, uint32_t address, uint32_t value, uint32_t lanes) {
    switch (address) {
    case ICSR:
        write_icsr(scb, value);
        return;
    case VTOR:
        scb->vtor = value & VTOR_BITS;
        return;
    case AIRCR:
        write_aircr(scb, value);
        return;
    case SHCSR:
        write_shcsr(scb, value);
        return;
    default:
        break;
    }
    if (address >= SHPR1 && address <= SHPR3) {
        write_priorities(scb, address, value, lanes);
    } else {
        write_control(scb, address, value);
    }
}
