/// Serial ports, against RM0090, chapter 30.
#include "chip.h"

#define SR   (USART1 + 0x00U)
#define DR   (USART1 + 0x04U)
#define BRR  (USART1 + 0x08U)
#define CR1  (USART1 + 0x0CU)
#define CR3  (USART1 + 0x14U)
#define UE   0x2000U
#define TE   0x0008U
#define RE   0x0004U
#define TXE  0x80U
#define TC   0x40U
#define RXNE 0x20U
#define IDLE 0x10U
#define ORE  0x08U
#define FE   0x02U
#define IRQ  37U

static uint8_t heard[64];
static unsigned heard_count, garbled;
static uint64_t heard_ns[64];

static void on_byte(void *context, uint8_t byte, bool framed) {
    (void)context;
    garbled += !framed;
    if (heard_count < sizeof heard) {
        heard_ns[heard_count] = soc_now_ns(&chip);
        heard[heard_count++] = byte;
    }
}

/// 16 MHz, PA9 and PA10 connected to the port and to a line of this speed.
static void begin(uint32_t line_baud, uint32_t brr, uint32_t cr1) {
    heard_count = garbled = 0;
    power_on();
    clock_everything();
    const struct usart_line line = {.baud = line_baud,
                                    .tx_pin = GPIO_PIN('A', 9),
                                    .rx_pin = GPIO_PIN('A', 10),
                                    .heard = on_byte};
    usart_connect(&chip.usart[0], &line);
    poke(GPIOA + 0x24U, 0x770); // AF7 for pins 9 and 10
    poke(GPIOA, (peek(GPIOA) & ~0x3C0000U) | 0x280000U);
    poke(BRR, brr);
    poke(CR1, cr1);
}

static void send_to_chip(const char *text) {
    (void)usart_send(&chip.usart[0], (const uint8_t *)text, (uint32_t)strlen(text));
}

static void reset_values(void) {
    power_on();
    clock_everything();
    CHECK_EQ(peek(SR), 0xC0);
    CHECK_EQ(peek(BRR), 0);
    CHECK_EQ(peek(CR1), 0);
    CHECK_EQ(chip.complaints, 0);
}

static void baud_rates_are_the_manuals(void) {
    // RM0090, table 136 and 137: values of BRR as mantissa and fraction of 16ths.
    power_on();
    clock_everything();
    poke(BRR, 104U << 4 | 3U); // 16 MHz, 9600: 104.1875
    CHECK_NEAR(usart_baud(&chip.usart[0]), 9598, 1);
    poke(BRR, 8U << 4 | 11U); // 16 MHz, 115200: 8.6875
    CHECK_NEAR(usart_baud(&chip.usart[0]), 115108, 1);
    poke(CR1, 0x8000);        // OVER8
    poke(BRR, 17U << 4 | 3U); // 16 MHz, 115200: 17.375
    CHECK_NEAR(usart_baud(&chip.usart[0]), 115108, 1);
    run_at_168_mhz();
    poke(CR1, 0);
    poke(BRR, 45U << 4 | 9U); // 84 MHz, 115200: 45.5625
    CHECK_NEAR(usart_baud(&chip.usart[0]), 115226, 1);
    poke(USART2 + 0x08U, 22U << 4 | 13U); // 42 MHz: 22.8125
    CHECK_NEAR(usart_baud(&chip.usart[1]), 115068, 1);
}

static void bytes_go_out_one_after_the_other(void) {
    begin(115200, 139, UE | TE);
    const uint64_t from = soc_now_ns(&chip);
    poke(DR, 'a');
    CHECK_EQ(peek(SR) & (TXE | TC), TXE | TC); // into the shift register at once
    (void)peek(SR);
    poke(DR, 'b');
    CHECK_EQ(peek(SR) & (TXE | TC), 0);
    pass_us(86);
    CHECK_EQ(heard_count, 0);
    pass_us(2); // 10 bits at 115,108 baud: 86.9 us
    CHECK_EQ(heard_count, 1);
    CHECK_NEAR(heard_ns[0] - from, 86875, 200);
    CHECK_EQ(peek(SR) & (TXE | TC), TXE);
    pass_us(87);
    CHECK_EQ(heard_count, 2);
    CHECK(heard[0] == 'a' && heard[1] == 'b');
    CHECK_EQ(peek(SR) & (TXE | TC), TXE | TC);
    CHECK_EQ(garbled, 0);
}

static void tc_is_cleared_by_reading_sr_and_writing_dr(void) {
    begin(115200, 139, UE | TE);
    (void)peek(SR);
    poke(DR, 'a');
    CHECK_EQ(peek(SR) & TC, 0);
    pass_us(100);
    CHECK_EQ(peek(SR) & TC, TC);
    poke(SR, ~TC); // or by writing 0
    CHECK_EQ(peek(SR) & TC, 0);
}

static void a_write_while_txe_is_0_loses_a_byte(void) {
    begin(115200, 139, UE | TE);
    poke(DR, 'a');
    poke(DR, 'b');
    poke(DR, 'c');
    CHECK_EQ(chip.complaints, 1);
    pass_us(1000);
    CHECK_EQ(heard_count, 2);
    CHECK_EQ(heard[1], 'c');
}

static void nothing_comes_out_of_a_port_that_is_off(void) {
    begin(115200, 139, TE);
    poke(DR, 'a');
    pass_us(1000);
    CHECK_EQ(heard_count, 0);
    begin(115200, 139, UE | TE);
    poke(GPIOA + 0x24U, 0); // another function at the pin
    poke(DR, 'a');
    pass_us(1000);
    CHECK_EQ(heard_count, 0);
    CHECK_EQ(peek(SR) & TC, TC); // the port itself has sent it
}

static void a_wrong_speed_is_heard_as_nonsense(void) {
    begin(115200, 104U << 4 | 3U, UE | TE); // 9600
    poke(DR, 'a');
    pass_us(2000);
    CHECK(heard_count >= 1U);
    CHECK(heard[0] != 'a' || garbled != 0U);
    begin(115200, 142, UE | TE); // 2 % off is heard all right
    poke(DR, 0x55);
    pass_us(200);
    CHECK_EQ(heard[0], 0x55);
    CHECK_EQ(garbled, 0);
    begin(115200, 153, UE | TE); // 10 % is not
    poke(DR, 0x55);
    pass_us(200);
    CHECK(heard[0] != 0x55 || garbled != 0U);
}

/// At half the speed of the other end a byte of zeros is still low where that one looks for the
/// stop bit.
static void a_stop_bit_that_is_low_is_a_framing_error(void) {
    begin(115200, 278, UE | TE);
    poke(DR, 0);
    pass_us(1000);
    CHECK(garbled != 0U);
    begin(57600, 139, UE | RE);
    send_to_chip("\x80");
    pass_us(1000);
    CHECK_EQ(peek(SR) & FE, FE);
    begin(115200, 139, UE | TE | RE);
    poke(DR, 0);
    send_to_chip("\x80");
    pass_us(1000);
    CHECK_EQ(garbled, 0);
    CHECK_EQ(peek(SR) & FE, 0);
}

static void received_bytes_wait_in_dr(void) {
    begin(115200, 139, UE | RE);
    send_to_chip("x");
    pass_us(80);
    CHECK_EQ(peek(SR) & RXNE, 0);
    pass_us(10);
    CHECK_EQ(peek(SR) & RXNE, RXNE);
    CHECK_EQ(peek(DR), 'x');
    CHECK_EQ(peek(SR) & RXNE, 0);
}

static void a_byte_that_nobody_takes_is_an_overrun(void) {
    begin(115200, 139, UE | RE);
    send_to_chip("xy");
    pass_us(200);
    CHECK_EQ(peek(SR) & (RXNE | ORE), RXNE | ORE);
    CHECK_EQ(peek(DR), 'x'); // the second one is lost
    CHECK_EQ(peek(SR) & (RXNE | ORE), 0);
    send_to_chip("zz");
    pass_us(200);
    (void)peek(DR); // without a look at SR the flag stays
    CHECK_EQ(peek(SR) & ORE, ORE);
}

static void a_wrong_speed_is_received_as_nonsense(void) {
    begin(9600, 139, UE | RE);
    send_to_chip("U");
    pass_us(2000);
    CHECK((peek(SR) & FE) != 0U || peek(DR) != 'U');
    begin(230400, 139, UE | RE);
    send_to_chip("U");
    pass_us(2000);
    CHECK((peek(SR) & FE) != 0U || peek(DR) != 'U');
}

static void deaf_ports_hear_nothing(void) {
    begin(115200, 139, UE | TE);
    send_to_chip("x");
    pass_us(200);
    CHECK_EQ(peek(SR) & RXNE, 0);
}

static void idle_after_a_byte_of_silence(void) {
    begin(115200, 139, UE | RE);
    send_to_chip("x");
    pass_us(100);
    CHECK_EQ(peek(SR) & IDLE, 0);
    pass_us(100);
    CHECK_EQ(peek(SR) & IDLE, IDLE);
    (void)peek(DR);
    CHECK_EQ(peek(SR) & IDLE, 0);
    pass_us(1000);
    CHECK_EQ(peek(SR) & IDLE, 0); // not again without a byte
}

static void interrupts(void) {
    begin(115200, 139, UE | TE | RE);
    CHECK(!irq_is_pending(IRQ));
    poke(CR1, UE | TE | RE | 0x80U); // TXEIE: at once
    CHECK(irq_is_pending(IRQ));
    poke(CR1, UE | TE | RE);
    clear_irq(IRQ);
    CHECK(!irq_is_pending(IRQ));
    poke(CR1, UE | TE | RE | 0x20U); // RXNEIE
    CHECK(!irq_is_pending(IRQ));
    send_to_chip("x");
    pass_us(100);
    CHECK(irq_is_pending(IRQ));
    (void)peek(DR);
    clear_irq(IRQ);
    CHECK(!irq_is_pending(IRQ));
    send_to_chip("xy");
    pass_us(200);
    (void)peek(DR); // RXNE is gone, the overrun still calls
    clear_irq(IRQ);
    CHECK(irq_is_pending(IRQ));
    (void)peek(SR);
    (void)peek(DR);
    clear_irq(IRQ);
    poke(CR1, UE | TE | RE | 0x40U); // TCIE
    CHECK(irq_is_pending(IRQ));
}

static void what_has_no_model_complains(void) {
    begin(115200, 139, UE | TE);
    poke(CR3, 0x80); // DMA
    CHECK_EQ(chip.complaints, 1);
    begin(115200, 139, UE | TE | 0x400U); // parity
    CHECK_EQ(chip.complaints, 1);
}

int main(void) {
    TEST(reset_values);
    TEST(baud_rates_are_the_manuals);
    TEST(bytes_go_out_one_after_the_other);
    TEST(tc_is_cleared_by_reading_sr_and_writing_dr);
    TEST(a_write_while_txe_is_0_loses_a_byte);
    TEST(nothing_comes_out_of_a_port_that_is_off);
    TEST(a_wrong_speed_is_heard_as_nonsense);
    TEST(a_stop_bit_that_is_low_is_a_framing_error);
    TEST(received_bytes_wait_in_dr);
    TEST(a_byte_that_nobody_takes_is_an_overrun);
    TEST(a_wrong_speed_is_received_as_nonsense);
    TEST(deaf_ports_hear_nothing);
    TEST(idle_after_a_byte_of_silence);
    TEST(interrupts);
    TEST(what_has_no_model_complains);
    return check_finish();
}
