/// Whether the machine paused: a busy host stops an emulated processor for as long as it likes, and
/// what a test measures then is the host. A thread on each processor sleeps, and notes how late it
/// is woken.
#ifndef VM_SUPPORT_PAUSES_H
#define VM_SUPPORT_PAUSES_H

#include <stdint.h>

/// Starts to watch; waits of up to most_us are none of note. Once in a program.
void pauses_watch(uint32_t most_us);

/// For check_run_timed: the longest pause since the last call, in words; NULL if none was of note.
const char *pauses_excuse(void);

#endif
