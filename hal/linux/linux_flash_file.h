/// hal/flash.h on a file: settings on a machine that has no flash of its own for them.
///
/// The file is the flash, byte for byte, with nothing else in it. It is created erased, under
/// another name (FILE.new) until it is whole. A program that is killed at any point leaves what a
/// flash would be left with: the operation under way done in part, ascending, and nothing else
/// (tests/contract/linux_flash_file.c kills it at every system call). An operation is done when the
/// disk has it, which is waited for in the background: by a thread of the C library, so a process
/// forked after the first operation can't begin any.
#ifndef HAL_LINUX_FLASH_FILE_H
#define HAL_LINUX_FLASH_FILE_H

#include "fixed/must_check.h"
#include "hal/flash.h"
#include "linux/linux_error.h"

#include <aio.h>

#define LINUX_FLASH_FILE_PATH_BYTES 256

struct linux_flash_file {
    struct hal_flash hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    int fd;
    struct hal_flash_geometry geometry;
    /// The background wait for the disk.
    struct aiocb sync;
    bool syncing;
    enum hal_status last_status;
    char path[LINUX_FLASH_FILE_PATH_BYTES];
};

/// Opens the file for this program alone, or creates it erased; its directory must exist. Must not
/// move in memory afterwards.
/// Returns:  HAL_OK: flash->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such directory; HAL_ERROR_DENIED: no permission or in use;
///           HAL_ERROR_UNSUPPORTED: no regular file, or not of the geometry's size;
///           HAL_ERROR_ARGUMENT: path too long or geometry against hal/flash.h;
///           HAL_ERROR_IO. If not HAL_OK, nothing is open and flash->error has the line.
enum hal_status linux_flash_file_open(struct linux_flash_file *flash, const char *path,
                                      const struct hal_flash_geometry *geometry) MUST_CHECK;

/// Waits for the disk if an operation is under way.
void linux_flash_file_close(struct linux_flash_file *flash);

#endif
