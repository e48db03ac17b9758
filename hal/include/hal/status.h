/// What every operation of the hardware abstraction layer may answer, and what to do then.
///
/// A device is a `struct hal_X { ops, ctx }`: a table of functions, all present (hal_X_bind checks
/// that once), and what they work on. Callers use the inline wrappers hal_X_verb only. These check
/// whatever can be checked without knowing the device (null pointers, ranges of the value types);
/// an implementation can rely on that and checks the rest (numbers of lines, channels, sectors).
///
/// None blocks: an operation that can't be done now says so and has changed nothing. The time comes
/// from hal/clock.h alone. A device is used from one thread or interrupt level.
/// Shown: every suite of tests/contract/support/.
#ifndef HAL_STATUS_H
#define HAL_STATUS_H

enum hal_status {
    HAL_OK = 0,
    /// Not now: a queue is full, or an operation is still under way. Nothing was taken. The same
    /// call may succeed later, so try at the next tick, not in a loop.
    HAL_BUSY = -1,
    /// Nothing is there to be read.
    HAL_EMPTY = -2,
    /// The call is wrong and always will be. Nothing was done. Our own bug: report it.
    HAL_ERROR_ARGUMENT = -3,
    /// This device can't do that, or refused it. Do without.
    HAL_ERROR_UNSUPPORTED = -4,
    /// It went wrong this time; the device is still there. Count it; retry a bounded number of
    /// times.
    HAL_ERROR_IO = -5,
    /// No answer within the time that the caller set.
    HAL_ERROR_TIMEOUT = -6,
    /// The caller cancelled it.
    HAL_ERROR_CANCELLED = -7,
    /// The device is there but out of action until it is started again: bus-off, a camera that is
    /// stopped. Its own restart or start operation is the remedy.
    HAL_ERROR_DOWN = -8,
    /// The device is there, but not for us: no permission, or another program holds it.
    HAL_ERROR_DENIED = -9,
    /// The device has left or lost power. Every later call says the same; open it again.
    HAL_ERROR_GONE = -10
};

#endif
