/* The second boot stage: the first 256 bytes of the flash. The ROM copies them to the end of the RAM, checks the sum in the last word
   and calls them (RP2040 datasheet, 2.8.1.3). They set the flash interface (4.10) to the oldest read command, which every flash chip
   knows, and start the image behind them. 31 MHz at a core clock of 125 MHz; the cache hides most of the rest. */
    .syntax unified
    .cpu cortex-m0plus
    .thumb

    .equ SSI, 0x18000000
    .equ CTRLR0, 0x00
    .equ CTRLR1, 0x04
    .equ SSIENR, 0x08
    .equ BAUDR, 0x14
    .equ SPI_CTRLR0, 0xF4
    .equ VECTORS, 0x10000100
    .equ VTOR, 0xE000ED08

    .section .boot2, "ax"
    .global boot2
boot2:
    ldr r3, =SSI
    movs r0, #0
    str r0, [r3, #SSIENR]           /* off while it is set up */
    movs r1, #4
    str r1, [r3, #BAUDR]            /* core clock / 4 */
    ldr r1, =(31 << 16) | (3 << 8)  /* words of 32 bits, "EEPROM read" */
    str r1, [r3, #CTRLR0]
    str r0, [r3, #CTRLR1]           /* one word at a time */
    ldr r1, =(0x03 << 24) | (2 << 8) | (6 << 2) /* command 03h: 8 bits; address: 6 times 4 bits; all on one line */
    ldr r2, =SSI + SPI_CTRLR0
    str r1, [r2]
    movs r1, #1
    str r1, [r3, #SSIENR]
    ldr r0, =VECTORS
    ldr r1, =VTOR
    str r0, [r1]
    ldmia r0!, {r1, r2}             /* stack pointer, first instruction */
    msr msp, r1
    bx r2
    .pool

    /* The sum of the 252 bytes before it; make's UF2 writer checks it and says what it should be. */
    .org 252
    .word 0x35c5b51e
