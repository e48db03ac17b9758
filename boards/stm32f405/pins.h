/// What is wired where; README.md has the same as a table for a person with a soldering iron.
/// Numbers of alternate functions: data sheet DS8626, table 9.
#ifndef STM32F405_PINS_H
#define STM32F405_PINS_H

#include "stm32f4/stm32f4_gpio.h"
#include "stm32f4/stm32f4_pwm.h"
#include "switches.h"

enum { PORT_A, PORT_B, PORT_C };

#define CRYSTAL_MHZ 8U

#define CONSOLE_BAUD 115200U
#define CONSOLE_TX   ((struct stm32f4_pin){PORT_A, 9})
#define CONSOLE_RX   ((struct stm32f4_pin){PORT_A, 10})
#define CONSOLE_AF   7U

#define CAN_RX ((struct stm32f4_pin){PORT_B, 8})
#define CAN_TX ((struct stm32f4_pin){PORT_B, 9})
#define CAN_AF 9U

/// Servo outputs by number: `channel` in a rig file.
static const struct stm32f4_pwm_channel pwm_channels[] = {
    {STM32F4_TIM3, 0, 2, {PORT_C, 6}}, {STM32F4_TIM3, 1, 2, {PORT_C, 7}},
    {STM32F4_TIM3, 2, 2, {PORT_C, 8}}, {STM32F4_TIM3, 3, 2, {PORT_C, 9}},
    {STM32F4_TIM4, 0, 2, {PORT_B, 6}}, {STM32F4_TIM4, 1, 2, {PORT_B, 7}}};

/// By number (switches.h).
static const struct stm32f4_pin gpio_pins[] = {
    [LINE_EMERGENCY_STOP] = {PORT_C, 0}, [LINE_KEY_SWITCH] = {PORT_C, 1},
    [LINE_PAN_LIMIT] = {PORT_C, 2},      [LINE_TILT_LIMIT] = {PORT_C, 3},
    [LINE_ENABLE] = {PORT_C, 4},
};

#endif
