/// The camera of a test on the kernel's own devices, and waiting for it in real time.
#ifndef VM_SUPPORT_KERNEL_CAMERA_H
#define VM_SUPPORT_KERNEL_CAMERA_H

#include "linux/linux_camera.h"
#include "linux/linux_clock.h"

#define KERNEL_CAMERA_PATIENCE_MS 30000

extern struct linux_camera kernel_camera;
extern struct linux_clock kernel_camera_clock;

/// Once in a program. interval_us: of the frames; pauses of a quarter of it are of note (pauses.h).
void kernel_camera_begin(uint32_t interval_us);

/// Opens it as soon as it is there: the kernel takes its time to look at what was plugged in. Ends
/// the program if it never is.
void kernel_camera_open(const char *name);

/// The next frame, or what else comes.
enum hal_status kernel_camera_take(struct hal_camera_frame *frame);
void kernel_camera_give_back(const struct hal_camera_frame *frame);

#endif
