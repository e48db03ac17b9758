/// A fake that does not bind is a bug of the fake: the program ends there.
#ifndef DEVICES_FAKE_BIND_H
#define DEVICES_FAKE_BIND_H

#include "hal/status.h"

#include <stdlib.h>

static inline void fake_bind_check(enum hal_status status) {
    if (status != HAL_OK) {
        abort();
    }
}

#endif
