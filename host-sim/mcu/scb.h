/// The system control block, the cycle counter and what else the processor has of registers.
///
/// Source: ARMv7-M Architecture Reference Manual, B3.2 and C1.8; PM0214, 4.4.
/// CYCCNT counts HCLK cycles in which the processor does not sleep. There is no debugger.
/// Left out: the memory protection unit (writes complain), traps for unaligned accesses and
/// division by zero (the bits can be set, the processor does not obey them), the floating-point
/// unit (firmware is compiled without). Shown: tests/mcu/scb.c.
#ifndef MCU_SCB_H
#define MCU_SCB_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

/// Bits of CFSR.
#define SCB_CFSR_IACCVIOL    (UINT32_C(1) << 0)
#define SCB_CFSR_IBUSERR     (UINT32_C(1) << 8)
#define SCB_CFSR_PRECISERR   (UINT32_C(1) << 9)
#define SCB_CFSR_IMPRECISERR (UINT32_C(1) << 10)
#define SCB_CFSR_BFARVALID   (UINT32_C(1) << 15)
#define SCB_CFSR_UNDEFINSTR  (UINT32_C(1) << 16)
#define SCB_CFSR_INVSTATE    (UINT32_C(1) << 17)
#define SCB_CFSR_INVPC       (UINT32_C(1) << 18)
/// Bits of HFSR.
#define SCB_HFSR_VECTTBL  (UINT32_C(1) << 1)
#define SCB_HFSR_FORCED   (UINT32_C(1) << 30)
#define SCB_HFSR_DEBUGEVT (UINT32_C(1) << 31)

struct scb {
    struct soc *soc;
    uint32_t vtor, prigroup, scr, ccr, cfsr, hfsr, mmfar, bfar, cpacr;
    uint32_t demcr, dwt_control, fpccr;
    uint32_t cycles_offset; ///< CYCCNT = awake cycles + offset, while it counts
    unsigned exception;     ///< IPSR, kept by the processor
};

void scb_reset(struct scb *scb, struct soc *soc);

/// SCR.SLEEPONEXIT.
bool scb_sleeps_on_exit(const struct scb *scb);

/// Any register from 0xE0000000 on that is not the interrupt controller's or SysTick's.
uint32_t scb_read(struct scb *scb, uint32_t address);
void scb_write(struct scb *scb, uint32_t address, uint32_t value, uint32_t lanes);

#endif
