/// hal/serial.h on a terminal device: USB adapters and boards (/dev/ttyACM*, /dev/ttyUSB*), UARTs
/// (/dev/ttyAMA*, /dev/ttyS*), pseudo-terminals.
/// Shown: tests/contract/linux_serial.c; by cable: tests/vm/guest/serial.sh.
#ifndef HAL_LINUX_SERIAL_H
#define HAL_LINUX_SERIAL_H

#include "fixed/must_check.h"
#include "hal/serial.h"
#include "linux/linux_error.h"

#include <stdbool.h>

#define LINUX_SERIAL_PATH_BYTES 256

struct linux_serial {
    struct hal_serial hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    int fd;
    bool gone, exclusive;
    struct hal_serial_state at_open;
    char path[LINUX_SERIAL_PATH_BYTES];
};

/// Opens path for this program alone: raw bytes, 8N1, no flow control, what waited to be read is
/// thrown away. Must not move in memory afterwards.
/// baud:     a usual one from 1200 to 4000000; the error line lists them. Pseudo-terminals and
///           USB-CDC boards take any and ignore it.
/// Returns:  HAL_OK: serial->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such device; HAL_ERROR_DENIED: no permission or in use;
///           HAL_ERROR_UNSUPPORTED: not a serial port, or it can't do that speed;
///           HAL_ERROR_ARGUMENT: path too long or no usual speed;
///           HAL_ERROR_IO. If not HAL_OK, nothing is open and serial->error has the line.
enum hal_status linux_serial_open(struct linux_serial *serial, const char *path,
                                  uint32_t baud) MUST_CHECK;

/// After HAL_ERROR_GONE, close it soon: as long as it is open the kernel gives the returning device
/// another name (ttyUSB1 for ttyUSB0). Nothing is waited for: bytes not sent yet may be lost.
void linux_serial_close(struct linux_serial *serial);

#endif
