/// The devices that interrupt handlers work on.
#ifndef STM32F405_DEVICES_H
#define STM32F405_DEVICES_H

#include "cortexm/cortexm_clock.h"
#include "stm32f4/stm32f4_can.h"
#include "stm32f4/stm32f4_usart.h"

struct board_devices_here {
    struct cortexm_clock clock;
    struct stm32f4_can can;
    struct stm32f4_usart console;
};
extern struct board_devices_here devices;

#endif
