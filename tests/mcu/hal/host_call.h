/// What the suites on the emulated chip ask of the emulator: the far side of their devices.
///
/// The image calls host_call; the test program on the host sees the call, answers it in the image's
/// memory, and lets the image go on. Shown: tests/mcu/cpu/hal_contract.c, which is that program.
#ifndef MCU_HAL_HOST_CALL_H
#define MCU_HAL_HOST_CALL_H

#include <stdint.h>

enum host_operation {
    HOST_WRITE,       ///< text at address, size
    HOST_EXIT,        ///< argument: exit status
    HOST_NOW,         ///< answer[0]: microseconds since power-on
    HOST_PIN_DRIVE,   ///< argument: pin (port * 16 + bit), size: 0 floating, 1 low, 2 high
    HOST_PIN_LEVEL,   ///< argument: pin; answer[0]: 1 high
    HOST_PULSE,       ///< argument: pin; answer: how long it is high, and its period, in ns
    HOST_LINE_RESET,  ///< argument: baud; a new serial line
    HOST_LINE_WRITE,  ///< bytes at address, size; answer[0]: how many went
    HOST_LINE_READ,   ///< room at address, size; answer[0]: how many came
    HOST_BUS_RESET,   ///< a new node on the CAN bus beside the chip
    HOST_BUS_SEND,    ///< frame at address; answer[0]: status
    HOST_BUS_RECEIVE, ///< room for a frame at address; answer: status, time of arrival
    HOST_BUS_STATE,   ///< answer: health, transmit errors, receive errors, lost frames
    HOST_BUS_FILTERS, ///< filters at address, argument: how many; answer[0]: status
    HOST_BUS_SHORT,   ///< argument: 1: every frame is destroyed, 0: no longer
};

struct host_call {
    uint32_t operation; ///< enum host_operation
    uint32_t argument, address, size;
    uint32_t answer[4];
};

#endif
