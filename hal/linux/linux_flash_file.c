#include "linux/linux_flash_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define NEW_SUFFIX     ".new"
#define CHUNK_BYTES    4096U
#define MISSING_REMEDY "create its directory"

static enum hal_status failed(struct linux_flash_file *flash, int error_number) {
    if (error_number == EISDIR) {
        linux_error_set(&flash->error, flash->path, "is a folder", "name a file in it");
        return HAL_ERROR_UNSUPPORTED;
    }
    return linux_error_from_errno(&flash->error, flash->path, error_number, MISSING_REMEDY);
}

/// Whether the file can be worked on: it must not have been deleted, or all would go to nowhere.
static enum hal_status admit(struct linux_flash_file *flash) {
    if (flash->fd < 0) {
        return HAL_ERROR_GONE;
    }
    if (flash->syncing) {
        return HAL_BUSY;
    }
    struct stat about;
    if (fstat(flash->fd, &about) != 0) {
        return failed(flash, errno);
    }
    if (about.st_nlink == 0U) {
        linux_error_set(&flash->error, flash->path, "the file has been deleted",
                        "start again to make a new one");
        return HAL_ERROR_GONE;
    }
    return HAL_OK;
}

static enum hal_status read_all(struct linux_flash_file *flash, uint32_t address, uint8_t *data,
                                uint32_t size_bytes) {
    uint32_t done = 0;
    while (done < size_bytes) {
        const ssize_t count =
            pread(flash->fd, data + done, size_bytes - done, (off_t)address + done);
        if (count == 0) {
            linux_error_set(&flash->error, flash->path, "the file has been cut short",
                            "move it away and start again to make a new one");
            return HAL_ERROR_IO;
        }
        if (count < 0 && errno != EINTR) {
            return failed(flash, errno);
        }
        done += count < 0 ? 0U : (uint32_t)count;
    }
    return HAL_OK;
}

/// In ascending order: a kill in between leaves a first part done.
static enum hal_status write_all(struct linux_flash_file *flash, int fd, uint32_t address,
                                 const uint8_t *data, uint32_t size_bytes) {
    uint32_t done = 0;
    while (done < size_bytes) {
        const ssize_t count = pwrite(fd, data + done, size_bytes - done, (off_t)address + done);
        if (count < 0 && errno != EINTR) {
            return failed(flash, errno);
        }
        done += count < 0 ? 0U : (uint32_t)count;
    }
    return HAL_OK;
}

static enum hal_status write_erased(struct linux_flash_file *flash, int fd, uint32_t address,
                                    uint32_t size_bytes) {
    uint8_t erased[CHUNK_BYTES];
    memset(erased, HAL_FLASH_ERASED, sizeof erased);
    enum hal_status status = HAL_OK;
    for (uint32_t done = 0; done < size_bytes && status == HAL_OK; done += CHUNK_BYTES) {
        const uint32_t rest = size_bytes - done;
        status =
            write_all(flash, fd, address + done, erased, rest < CHUNK_BYTES ? rest : CHUNK_BYTES);
    }
    return status;
}

/// Begins the background wait for the disk, which ends the operation.
static enum hal_status begin_sync(struct linux_flash_file *flash) {
    flash->sync = (struct aiocb){.aio_fildes = flash->fd, .aio_sigevent.sigev_notify = SIGEV_NONE};
    if (aio_fsync(O_DSYNC, &flash->sync) != 0) {
        return failed(flash, errno);
    }
    flash->syncing = true;
    return HAL_OK;
}

static enum hal_status linux_flash_file_geometry(void *ctx, struct hal_flash_geometry *geometry) {
    const struct linux_flash_file *flash = ctx;
    if (flash->fd < 0) {
        return HAL_ERROR_GONE;
    }
    *geometry = flash->geometry;
    return HAL_OK;
}

static enum hal_status linux_flash_file_read(void *ctx, uint32_t address, uint8_t *data,
                                             uint32_t size_bytes) {
    struct linux_flash_file *flash = ctx;
    if (!hal_flash_has(&flash->geometry, address, size_bytes)) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = admit(flash);
    return status == HAL_OK ? read_all(flash, address, data, size_bytes) : status;
}

/// Whether programming data there would turn no bit from 0 to 1: HAL_OK if so.
static enum hal_status check_bits(struct linux_flash_file *flash, uint32_t address,
                                  const uint8_t *data, uint32_t size_bytes) {
    uint8_t now[CHUNK_BYTES];
    for (uint32_t done = 0; done < size_bytes; done += CHUNK_BYTES) {
        const uint32_t rest = size_bytes - done, count = rest < CHUNK_BYTES ? rest : CHUNK_BYTES;
        const enum hal_status status = read_all(flash, address + done, now, count);
        if (status != HAL_OK) {
            return status;
        }
        for (uint32_t i = 0; i < count; i++) {
            if ((data[done + i] & ~(unsigned)now[i]) != 0U) {
                return HAL_ERROR_ARGUMENT;
            }
        }
    }
    return HAL_OK;
}

static enum hal_status linux_flash_file_program(void *ctx, uint32_t address, const uint8_t *data,
                                                uint32_t size_bytes) {
    struct linux_flash_file *flash = ctx;
    if (!hal_flash_has(&flash->geometry, address, size_bytes) ||
        !hal_flash_is_aligned(&flash->geometry, address, size_bytes)) {
        return HAL_ERROR_ARGUMENT;
    }
    enum hal_status status = admit(flash);
    if (status == HAL_OK) {
        status = check_bits(flash, address, data, size_bytes);
    }
    if (status == HAL_OK) {
        status = write_all(flash, flash->fd, address, data, size_bytes);
    }
    return status == HAL_OK ? begin_sync(flash) : status;
}

static enum hal_status linux_flash_file_erase(void *ctx, uint32_t sector) {
    struct linux_flash_file *flash = ctx;
    if (sector >= flash->geometry.sector_count) {
        return HAL_ERROR_ARGUMENT;
    }
    enum hal_status status = admit(flash);
    if (status == HAL_OK) {
        const uint32_t sector_bytes = flash->geometry.sector_bytes;
        status = write_erased(flash, flash->fd, sector * sector_bytes, sector_bytes);
    }
    return status == HAL_OK ? begin_sync(flash) : status;
}

static enum hal_status linux_flash_file_poll(void *ctx) {
    struct linux_flash_file *flash = ctx;
    if (flash->fd < 0) {
        return HAL_ERROR_GONE;
    }
    if (flash->syncing) {
        const int error_number = aio_error(&flash->sync);
        if (error_number == EINPROGRESS) {
            return HAL_BUSY;
        }
        (void)aio_return(&flash->sync); // lets go of it; says no more than aio_error did
        flash->syncing = false;
        flash->last_status = error_number == 0 ? HAL_OK : failed(flash, error_number);
    }
    return flash->last_status;
}

static const struct hal_flash_ops ops = {linux_flash_file_geometry, linux_flash_file_read,
                                         linux_flash_file_program, linux_flash_file_erase,
                                         linux_flash_file_poll};

static enum hal_status lock(struct linux_flash_file *flash, int fd) {
    return flock(fd, LOCK_EX | LOCK_NB) == 0 ? HAL_OK : failed(flash, errno);
}

/// So that the new name survives a power failure, too.
static enum hal_status sync_directory(struct linux_flash_file *flash) {
    char directory[LINUX_FLASH_FILE_PATH_BYTES];
    snprintf(directory, sizeof directory, "%s", flash->path);
    char *slash = strrchr(directory, '/');
    if (slash == NULL) {
        snprintf(directory, sizeof directory, ".");
    } else {
        slash[slash == directory ? 1 : 0] = '\0';
    }
    const int fd = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) {
        return failed(flash, errno);
    }
    const enum hal_status status = fsync(fd) == 0 ? HAL_OK : failed(flash, errno);
    close(fd);
    return status;
}

/// Fills the new file and gives it its name. Whoever holds its lock creates; the name it was opened
/// by must still be its own, or another program has just finished creating it.
static enum hal_status fill_and_name(struct linux_flash_file *flash, const char *new_path) {
    struct stat opened, named;
    enum hal_status status = lock(flash, flash->fd);
    if (status != HAL_OK) {
        return status;
    }
    if (fstat(flash->fd, &opened) != 0) {
        return failed(flash, errno);
    }
    if (stat(new_path, &named) != 0 || named.st_ino != opened.st_ino ||
        access(flash->path, F_OK) == 0) {
        return failed(flash, EBUSY);
    }
    if (errno != ENOENT) { // what can't be looked at may be there
        return failed(flash, errno);
    }
    if (ftruncate(flash->fd, 0) != 0) {
        return failed(flash, errno);
    }
    status = write_erased(flash, flash->fd, 0,
                          flash->geometry.sector_count * flash->geometry.sector_bytes);
    if (status == HAL_OK && (fsync(flash->fd) != 0 || rename(new_path, flash->path) != 0)) {
        status = failed(flash, errno);
    }
    return status == HAL_OK ? sync_directory(flash) : status;
}

static enum hal_status create(struct linux_flash_file *flash) {
    char new_path[LINUX_FLASH_FILE_PATH_BYTES + sizeof NEW_SUFFIX];
    snprintf(new_path, sizeof new_path, "%s" NEW_SUFFIX, flash->path);
    flash->fd = open(new_path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    return flash->fd < 0 ? failed(flash, errno) : fill_and_name(flash, new_path);
}

/// Whether the file that was found can be the flash.
static enum hal_status look_at(struct linux_flash_file *flash) {
    struct stat about;
    enum hal_status status = lock(flash, flash->fd);
    if (status != HAL_OK) {
        return status;
    }
    if (fstat(flash->fd, &about) != 0) {
        return failed(flash, errno);
    }
    const uint32_t size_bytes = flash->geometry.sector_count * flash->geometry.sector_bytes;
    if (!S_ISREG(about.st_mode)) {
        linux_error_set(&flash->error, flash->path, "not a regular file", "name another file");
        return HAL_ERROR_UNSUPPORTED;
    }
    if (about.st_size != (off_t)size_bytes) {
        char reason[100];
        snprintf(reason, sizeof reason, "has %lld bytes, not the %u of a settings file",
                 (long long)about.st_size, (unsigned)size_bytes);
        linux_error_set(&flash->error, flash->path, reason,
                        "move it away and start again to make a new one");
        return HAL_ERROR_UNSUPPORTED;
    }
    // What a killed program wrote is read as done from now on, so the disk must have it.
    return fdatasync(flash->fd) == 0 ? HAL_OK : failed(flash, errno);
}

enum hal_status linux_flash_file_open(struct linux_flash_file *flash, const char *path,
                                      const struct hal_flash_geometry *geometry) {
    *flash = (struct linux_flash_file){.fd = -1, .geometry = *geometry};
    const size_t size = strlen(path);
    if (size >= sizeof flash->path || !hal_flash_is_sound(geometry)) {
        linux_error_set(&flash->error, path,
                        size >= sizeof flash->path ? "the name is too long" : "impossible geometry",
                        "name another file");
        return HAL_ERROR_ARGUMENT;
    }
    memcpy(flash->path, path, size + 1U);
    flash->fd = open(path, O_RDWR | O_CLOEXEC);
    enum hal_status status;
    if (flash->fd >= 0) {
        status = look_at(flash);
    } else if (errno == ENOENT) {
        status = create(flash);
    } else {
        const int error_number = errno;
        status = failed(flash, error_number);
        if (error_number == EISDIR) {
            status = HAL_ERROR_UNSUPPORTED;
        }
    }
    if (status == HAL_OK) {
        status = hal_flash_bind(&flash->hal, &ops, flash);
    }
    if (status != HAL_OK) {
        linux_flash_file_close(flash);
    }
    return status;
}

void linux_flash_file_close(struct linux_flash_file *flash) {
    if (flash->syncing) {
        const struct aiocb *const waited_for[] = {&flash->sync};
        while (aio_suspend(waited_for, 1, NULL) != 0 && errno == EINTR) {
        }
        (void)aio_return(&flash->sync);
        flash->syncing = false;
    }
    if (flash->fd >= 0) {
        close(flash->fd);
        flash->fd = -1;
    }
}
