#include "contract/support/line_speed.h"

// The kernel's own header, which can't be had together with <termios.h>.
#include <asm/termbits.h>
#include <sys/ioctl.h>

uint32_t line_speed_baud(int fd) {
    struct termios2 settings;
    return ioctl(fd, TCGETS2, &settings) == 0 && settings.c_ispeed == settings.c_ospeed
               ? settings.c_ospeed
               : 0U;
}
