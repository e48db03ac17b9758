/// Edges on pins as interrupts, and the register that says of which port's pins.
///
/// Source: RM0090, chapters 9 (SYSCFG) and 12 (EXTI). Lines 0 to 15. Left out: events, lines 16 to
/// 22, the memory remap (kept, without effect). Shown: tests/mcu/system_parts.c.
#ifndef MCU_EXTI_H
#define MCU_EXTI_H

#include <stdint.h>

struct soc;

struct exti {
    struct soc *soc;
    uint32_t imr, emr, rtsr, ftsr, pr;
    uint32_t port_of[4]; ///< SYSCFG_EXTICR1 to 4
    uint32_t memrmp, pmc;
};

void exti_reset(struct exti *exti, struct soc *soc);
uint32_t exti_read(void *model, uint32_t offset);
void exti_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);
void exti_syscfg_reset(struct exti *exti);
uint32_t exti_syscfg_read(void *model, uint32_t offset);
void exti_syscfg_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// Levels of a port's 16 pins before and after something changed.
void exti_port_changed(struct exti *exti, unsigned port, uint32_t before, uint32_t after);

#endif
