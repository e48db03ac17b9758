/// Registers of the STM32F405, as far as they are used, from the reference manual RM0090; each
/// block names its section there. Addresses: section 2.3, table 1. Reset values in the comments are
/// what the drivers rely on.
#ifndef STM32F4_STM32F4_REGISTERS_H
#define STM32F4_STM32F4_REGISTERS_H

#include <stddef.h>
#include <stdint.h>

#define STM32F4_AT(block, member, offset)                                                          \
    _Static_assert(offsetof(struct block, member) == (offset), #member)

/// 7.3 Reset and clock control (STM32F405/407).
struct stm32f4_rcc {
    volatile uint32_t cr, pllcfgr, cfgr, cir;
    volatile uint32_t ahb1rstr, ahb2rstr, ahb3rstr, reserved_1c, apb1rstr, apb2rstr;
    uint32_t reserved_28[2];
    volatile uint32_t ahb1enr, ahb2enr, ahb3enr, reserved_3c, apb1enr, apb2enr;
    uint32_t reserved_48[2];
    volatile uint32_t ahb1lpenr, ahb2lpenr, ahb3lpenr, reserved_5c, apb1lpenr, apb2lpenr;
    uint32_t reserved_68[2];
    volatile uint32_t bdcr, csr;
};
STM32F4_AT(stm32f4_rcc, csr, 0x74);
#define STM32F4_RCC ((struct stm32f4_rcc *)0x40023800U)
enum { // cr: 0x83 after reset, apart from the trim values
    STM32F4_RCC_CR_HSION = 1 << 0,
    STM32F4_RCC_CR_HSIRDY = 1 << 1,
    STM32F4_RCC_CR_HSEON = 1 << 16,
    STM32F4_RCC_CR_HSERDY = 1 << 17,
    STM32F4_RCC_CR_CSSON = 1 << 19,
    STM32F4_RCC_CR_PLLON = 1 << 24,
    STM32F4_RCC_CR_PLLRDY = 1 << 25
};
enum { // pllcfgr: m, n, p / 2 - 1, source, q
    STM32F4_RCC_PLLCFGR_N_SHIFT = 6,
    STM32F4_RCC_PLLCFGR_SRC_HSE = 1 << 22,
    STM32F4_RCC_PLLCFGR_Q_SHIFT = 24
};
enum { // cfgr: 0 after reset
    STM32F4_RCC_CFGR_SW_HSI = 0,
    STM32F4_RCC_CFGR_SW_PLL = 2,
    STM32F4_RCC_CFGR_SWS_SHIFT = 2,
    STM32F4_RCC_CFGR_SWS = 3 << 2,
    STM32F4_RCC_CFGR_PPRE1_DIV4 = 5 << 10,
    STM32F4_RCC_CFGR_PPRE2_DIV2 = 4 << 13
};
enum { STM32F4_RCC_CIR_CSSF = 1 << 7, STM32F4_RCC_CIR_CSSC = 1 << 23 };
#define STM32F4_RCC_CSR_RMVF    (1U << 24) ///< clears the flags below
#define STM32F4_RCC_CSR_BORRSTF (1U << 25)
#define STM32F4_RCC_CSR_PINRSTF (1U << 26)
#define STM32F4_RCC_CSR_PORRSTF (1U << 27)
#define STM32F4_RCC_CSR_SFTRSTF (1U << 28)
#define STM32F4_RCC_CSR_IWDG    (1U << 29)
#define STM32F4_RCC_CSR_WWDG    (1U << 30)

/// 3.9 Flash interface.
struct stm32f4_flash {
    volatile uint32_t acr, keyr, optkeyr, sr, cr, optcr;
};
#define STM32F4_FLASH ((struct stm32f4_flash *)0x40023C00U)
enum {
    STM32F4_FLASH_ACR_LATENCY = 7 << 0,
    STM32F4_FLASH_ACR_LATENCY_5 = 5,
    STM32F4_FLASH_ACR_PREFETCH = 1 << 8,
    STM32F4_FLASH_ACR_INSTRUCTION_CACHE = 1 << 9,
    STM32F4_FLASH_ACR_DATA_CACHE = 1 << 10
};

/// 38.6.1 Device id of the debug block.
#define STM32F4_DBGMCU_IDCODE ((volatile uint32_t *)0xE0042000U)

/// 8.4 General-purpose I/O.
struct stm32f4_gpio_port {
    volatile uint32_t moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afr[2];
};
#define STM32F4_GPIO_PORT(index)                                                                   \
    ((struct stm32f4_gpio_port *)(0x40020000U + 0x400U * (uint32_t)(index)))

/// 18.4 General-purpose timers (TIM2 to TIM5). After reset all are 0, but arr is all ones.
struct stm32f4_timer {
    volatile uint32_t cr1, cr2, smcr, dier, sr, egr, ccmr[2], ccer, cnt, psc, arr;
    uint32_t reserved_30;
    volatile uint32_t ccr[4];
};
STM32F4_AT(stm32f4_timer, ccr, 0x34);
#define STM32F4_TIM2 ((struct stm32f4_timer *)0x40000000U)
#define STM32F4_TIM3 ((struct stm32f4_timer *)0x40000400U)
#define STM32F4_TIM4 ((struct stm32f4_timer *)0x40000800U)
#define STM32F4_TIM5 ((struct stm32f4_timer *)0x40000C00U)
enum {
    STM32F4_TIMER_CR1_CEN = 1 << 0,
    STM32F4_TIMER_CR1_ARPE = 1 << 7,
    STM32F4_TIMER_EGR_UG = 1 << 0,
    /// Of a channel's byte in ccmr: high while the counter is below ccr; ccr is taken over with the
    /// next period.
    STM32F4_TIMER_CCMR_PWM1 = 6 << 4,
    STM32F4_TIMER_CCMR_PRELOAD = 1 << 3
};

/// 21.4 Independent watchdog. After reset pr 0, rlr 0xFFF, sr 0.
struct stm32f4_iwdg {
    volatile uint32_t kr, pr, rlr, sr;
};
#define STM32F4_IWDG ((struct stm32f4_iwdg *)0x40003000U)
enum {
    STM32F4_IWDG_KR_FEED = 0xAAAA,
    STM32F4_IWDG_KR_UNLOCK = 0x5555,
    STM32F4_IWDG_KR_START = 0xCCCC,
    STM32F4_IWDG_SHIFT_MAX = 8, ///< divides by 4 << pr, pr at most 6
    STM32F4_IWDG_RLR_MAX = 0xFFF,
    STM32F4_IWDG_SR_BUSY = 3 ///< a new pr or rlr is on its way
};

/// 30.6 USART.
struct stm32f4_usart_block {
    volatile uint32_t sr, dr, brr, cr1, cr2, cr3, gtpr;
};
#define STM32F4_USART1 ((struct stm32f4_usart_block *)0x40011000U)
#define STM32F4_USART2 ((struct stm32f4_usart_block *)0x40004400U)
enum {
    STM32F4_USART_SR_FE = 1 << 1,
    STM32F4_USART_SR_NF = 1 << 2,
    STM32F4_USART_SR_ORE = 1 << 3,
    STM32F4_USART_SR_RXNE = 1 << 5,
    STM32F4_USART_SR_TXE = 1 << 7,
    STM32F4_USART_CR1_RE = 1 << 2,
    STM32F4_USART_CR1_TE = 1 << 3,
    STM32F4_USART_CR1_RXNEIE = 1 << 5,
    STM32F4_USART_CR1_TXEIE = 1 << 7,
    STM32F4_USART_CR1_UE = 1 << 13
};

/// 32.9 Controller area network (bxCAN). A transmit mailbox and a receive FIFO look alike.
struct stm32f4_can_mailbox {
    volatile uint32_t ir, dtr, dlr, dhr;
};
struct stm32f4_can_block {
    volatile uint32_t mcr, msr, tsr, rfr[2], ier, esr, btr;
    uint32_t reserved_020[88];
    struct stm32f4_can_mailbox transmit[3], receive[2];
    uint32_t reserved_1d0[12];
    volatile uint32_t fmr, fm1r;
    uint32_t reserved_208;
    volatile uint32_t fs1r;
    uint32_t reserved_210;
    volatile uint32_t ffa1r;
    uint32_t reserved_218;
    volatile uint32_t fa1r;
    uint32_t reserved_220[8];
    struct {
        volatile uint32_t id, mask;
    } filter[28];
};
STM32F4_AT(stm32f4_can_block, transmit, 0x180);
STM32F4_AT(stm32f4_can_block, fmr, 0x200);
STM32F4_AT(stm32f4_can_block, filter, 0x240);
#define STM32F4_CAN1 ((struct stm32f4_can_block *)0x40006400U)
enum { // mcr: SLEEP and 1 << 16 (frozen while debugged) after reset
    STM32F4_CAN_MCR_INRQ = 1 << 0,
    STM32F4_CAN_MCR_SLEEP = 1 << 1,
    STM32F4_CAN_MCR_TXFP = 1 << 2, ///< mailboxes in the order of their requests, not of their ids
    STM32F4_CAN_MCR_RFLM = 1 << 3, ///< a full FIFO keeps what it has
    STM32F4_CAN_MSR_INAK = 1 << 0,
    STM32F4_CAN_MSR_SLAK = 1 << 1,
    STM32F4_CAN_MSR_ERRI = 1 << 2,  ///< cleared by writing 1
    STM32F4_CAN_TSR_RQCP0 = 1 << 0, ///< of mailbox 0, 8 bits on for each next; by writing 1
    STM32F4_CAN_TSR_TXOK0 = 1 << 1,
    STM32F4_CAN_TSR_ABRQ0 = 1 << 7,
    STM32F4_CAN_TSR_RQCP = 0x010101,
    STM32F4_CAN_TSR_TXOK = 0x020202,
    STM32F4_CAN_TSR_ABRQ = 0x808080,
    STM32F4_CAN_TSR_TME0 = 1 << 26, ///< mailbox 0 is empty
    STM32F4_CAN_TSR_TME = 7 << 26,
    STM32F4_CAN_RFR_FMP = 3 << 0,  ///< how many frames
    STM32F4_CAN_RFR_FOVR = 1 << 4, ///< a frame was lost; by writing 1
    STM32F4_CAN_RFR_RFOM = 1 << 5, ///< lets the next frame come to the front
    STM32F4_CAN_IER_TMEIE = 1 << 0,
    STM32F4_CAN_IER_FMPIE0 = 1 << 1,
    STM32F4_CAN_IER_FOVIE0 = 1 << 3,
    STM32F4_CAN_IER_BOFIE = 1 << 10,
    STM32F4_CAN_IER_ERRIE = 1 << 15,
    STM32F4_CAN_ESR_EPVF = 1 << 1, ///< error passive
    STM32F4_CAN_ESR_BOFF = 1 << 2, ///< bus-off
    STM32F4_CAN_ESR_TEC_SHIFT = 16,
    STM32F4_CAN_ESR_REC_SHIFT = 24,
    STM32F4_CAN_IR_TXRQ = 1 << 0,
    STM32F4_CAN_IR_RTR = 1 << 1,
    STM32F4_CAN_IR_IDE = 1 << 2,
    STM32F4_CAN_IR_EXTENDED_SHIFT = 3,
    STM32F4_CAN_IR_STANDARD_SHIFT = 21,
    STM32F4_CAN_FMR_FINIT = 1 << 0,
    STM32F4_CAN_FILTERS = 14 ///< banks of CAN1; so many after reset (fmr.CAN2SB)
};

/// 12.2, table 62: positions in the vector table.
enum stm32f4_irq {
    STM32F4_IRQ_CAN1_TX = 19,
    STM32F4_IRQ_CAN1_RX0 = 20,
    STM32F4_IRQ_CAN1_RX1 = 21,
    STM32F4_IRQ_CAN1_SCE = 22,
    STM32F4_IRQ_USART1 = 37,
    STM32F4_IRQ_USART2 = 38,
    STM32F4_IRQ_COUNT = 82
};

#endif
