/// Errors at every step of a device's life.
///
/// A life is a function that opens a device, does everything that can be done with it, and closes
/// it; it notes what each call answered. It is lived once as it is, and then again and again: each
/// time another one of the calls that the driver makes of the kernel, or of a library, fails
/// (syscalls.h), with each error that it may fail with. Of each such life has to hold:
/// - the driver reports it, by a status that its header has for that error and with a line that
///   names the device; or all that was noted is as if nothing had failed;
/// - nothing stays open, mapped or running when it is over;
/// - the next one, in which nothing fails, is like the first.
#ifndef CONTRACT_SUPPORT_LIVES_H
#define CONTRACT_SUPPORT_LIVES_H

#include "hal/status.h"
#include "linux/linux_error.h"

#include <stdbool.h>
#include <stdint.h>

/// For a life: what a call of that name answered. error: the driver's line; null: the call has
/// none. Returns the status.
enum hal_status life_note(const char *what, enum hal_status status,
                          const struct linux_error *error);
/// The same of a call that has to answer something else than HAL_OK.
enum hal_status life_note_refusal(const char *what, enum hal_status status, enum hal_status wanted,
                                  const struct linux_error *error);
/// What came of it: is the same in all lives of a device that does not fail.
void life_value(const char *what, int64_t value);

#define LIFE_STATUS(status) (1U << (unsigned)-(status))

/// An error of the kernel (or a library's code), and the statuses by which it may be reported.
struct life_error {
    int error_number;
    uint32_t statuses; ///< LIFE_STATUS of each
};

/// What the headers have for errors of a device, but for those of serial ports.
#define LIFE_EIO                                                                                   \
    { EIO, LIFE_STATUS(HAL_ERROR_IO) }
#define LIFE_ENODEV                                                                                \
    { ENODEV, LIFE_STATUS(HAL_ERROR_GONE) }
#define LIFE_EACCES                                                                                \
    { EACCES, LIFE_STATUS(HAL_ERROR_DENIED) }
#define LIFE_ENOMEM                                                                                \
    { ENOMEM, LIFE_STATUS(HAL_ERROR_IO) }

/// Of runs in the emulated machine: below the sanitizers, which are slow there, a part of the
/// calls. What they would find is found on the host, where all fail.
#ifdef BORESIGHT_DEBUG
#define LIVES_VM_STRIDE 5U
#else
#define LIVES_VM_STRIDE 1U
#endif

struct lives {
    const char *device; ///< is in every line
    void (*live)(void);
    const struct life_error *errors;
    uint32_t error_count;
    bool share_out;         ///< each call fails with one of the errors, in turn, instead of all
    uint32_t stride;        ///< only each so manyth call fails; 0: 1
    const char *spared;     ///< see syscalls_spare; null: none
    uint32_t recover_every; ///< after so many failures a life without one; 0: 1
    /// Once more with each error: from the nth call on, all fail. Only that nothing is left behind,
    /// and that the next life is well, has to hold then.
    bool dies;
};

/// Prints how many calls a life has.
void lives_each_failure(const struct lives *lives);

#endif
