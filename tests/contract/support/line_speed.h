/// The speed of a terminal as a number, straight from the kernel.
#ifndef CONTRACT_SUPPORT_LINE_SPEED_H
#define CONTRACT_SUPPORT_LINE_SPEED_H

#include <stdint.h>

/// Bits a second that fd sends with; 0 if it can't be told.
uint32_t line_speed_baud(int fd);

#endif
