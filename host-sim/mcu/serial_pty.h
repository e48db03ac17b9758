/// The other end of the board's serial line: a pseudo-terminal, for terminal programs and for
/// `boresight run`, or a serial port of this computer, for those at the end of its cable.
///
/// What is written to it goes down the line at the line's speed; what nobody reads is lost, as on a
/// wire. Shown: tests/mcu/cpu/link.sh, tests/vm/guest/serial.sh.
#ifndef MCU_SERIAL_PTY_H
#define MCU_SERIAL_PTY_H

#include "mcu/usart.h"

#include <stdbool.h>

#define SERIAL_PTY_PATH_BYTES 256U

struct serial_pty {
    int board_end, other_end; ///< the other end stays open, so that programs may come and go
    char link[SERIAL_PTY_PATH_BYTES];
};

/// If link is a serial port, that is the line, at 115200 baud. Otherwise opens a pseudo-terminal
/// and makes link a symbolic link to it; a link that is there is replaced, another file is not.
/// False: errno says why; nothing is open.
bool serial_pty_open(struct serial_pty *pty, const char *link);
void serial_pty_close(struct serial_pty *pty);

void serial_pty_write(struct serial_pty *pty, uint8_t byte);

/// Puts on the line what was written to the terminal, as far as there is room.
void serial_pty_pass(struct serial_pty *pty, struct usart *usart);

#endif
