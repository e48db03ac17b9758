/// For programs that run on the emulated processor: registers, and text on USART1 (PA9, 115200
/// baud).
#ifndef GUEST_H
#define GUEST_H

#include <stdbool.h>
#include <stdint.h>

#define REG(address)   (*(volatile uint32_t *)(address))
#define REG8(address)  (*(volatile uint8_t *)(address))
#define NVIC_ISER(irq) REG(0xE000E100U + 4U * ((irq) / 32U))
#define NVIC_ISPR(irq) REG(0xE000E200U + 4U * ((irq) / 32U))
#define NVIC_IPR(irq)  REG8(0xE000E400U + (irq))
#define BIT(irq)       (UINT32_C(1) << ((irq) % 32U))
#define SCB_ICSR       REG(0xE000ED04U)
#define SCB_AIRCR      REG(0xE000ED0CU)
#define SCB_SHCSR      REG(0xE000ED24U)
#define SCB_CFSR       REG(0xE000ED28U)
#define SCB_HFSR       REG(0xE000ED2CU)
#define SCB_BFAR       REG(0xE000ED38U)
#define RCC_CSR        REG(0x40023874U)
#define IWDG_KR        REG(0x40003000U)
#define IWDG_PR        REG(0x40003004U)
#define IWDG_RLR       REG(0x40003008U)

/// Handlers that a program may define; each has a name in start.c.
typedef void handler_fn(void);
extern handler_fn nmi_handler, hard_fault_handler, bus_fault_handler, usage_fault_handler,
    svc_handler, pend_sv_handler, sys_tick_handler, irq37_handler, irq38_handler, irq39_handler,
    reset_handler;

void guest_main(void);

void print(const char *text);
/// `NAME ok`, or `NAME: VALUE, not WANTED`.
void check(const char *name, uint32_t value, uint32_t wanted);

static inline void pend(uint32_t irq) {
    NVIC_ISPR(irq) = BIT(irq);
    __asm volatile("dsb\n\tisb" ::: "memory");
}

static inline void enable(uint32_t irq, uint8_t priority) {
    NVIC_IPR(irq) = priority;
    NVIC_ISER(irq) = BIT(irq);
}

#endif
