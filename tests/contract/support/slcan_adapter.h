/// A slcan adapter that the test plays on a pseudo-terminal, its driver open at the other end.
#ifndef CONTRACT_SUPPORT_SLCAN_ADAPTER_H
#define CONTRACT_SUPPORT_SLCAN_ADAPTER_H

#include "linux/linux_slcan.h"

/// An adapter: it looks at the first letter of a line only, and hands frames on as text.
struct slcan_adapter {
    struct linux_slcan port;
    int master;
    char path[64];
    bool open, refusing, flagged;
    char line[64];
    size_t size;
    char heard[4096]; ///< everything that the driver sent
    size_t heard_size;
    uint32_t marks; ///< that have come
};

/// A new terminal, and the driver opened on it; zeroes and a master of -1 before the first time.
/// Exits with 2 where there is none.
void slcan_adapter_plug_in(struct slcan_adapter *adapter, const struct hal_clock *clock);

/// To the driver. Returns when it can read it: the kernel takes its time.
void slcan_adapter_say(struct slcan_adapter *adapter, const char *text, size_t size);

/// Obeys what has come by now; frames go to the other one.
void slcan_adapter_serve(struct slcan_adapter *adapter, struct slcan_adapter *other);

/// Until everything that its driver has sent is there and served.
void slcan_adapter_settle(struct slcan_adapter *adapter, struct slcan_adapter *other);

#endif
