/// A device that was lost is opened again in the background: while that takes long, the ticks go on
/// and the other devices work. Two slcan adapters on pseudo-terminals; the opening of the second
/// one stops in the middle of a system call for as long as the test wants.
#include "rig_devices.h"

#include "check.h"

#include "contract/support/syscalls.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static char folder[] = "/tmp/boresight-mend-XXXXXX";
static struct rig rig;
static struct rig_devices devices;
static pthread_t ticks; ///< the thread of the ticks
static sem_t entered, released;
static bool blocked_ticks;

static const char *path_of(const char *name) {
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/// An adapter appears under that name. Returns the test's end of it.
static int plug_in(const char *name) {
    char terminal[64];
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
        ptsname_r(master, terminal, sizeof terminal) != 0) {
        perror("no pseudo-terminal");
        exit(2);
    }
    (void)unlink(path_of(name));
    CHECK_EQ(symlink(terminal, path_of(name)), 0);
    return master;
}

static void read_rig(void) {
    FILE *file = fopen(path_of("rig.ini"), "w");
    static const char *const names[] = {"pan", "tilt"};
    for (unsigned axis = 0; file != NULL && axis < 2U; axis++) {
        fprintf(file,
                "[%s]\ndrive = rmd\nbus = slcan:%s/%s\nid = %u\nlimit_min_deg = -80\n"
                "limit_max_deg = 80\nspeed_max_dps = 60\naccel_max_dps2 = 100\n",
                names[axis], folder, names[axis], axis + 1U);
    }
    CHECK(file != NULL && fclose(file) == 0);
    CHECK_EQ(rig_read(path_of("rig.ini"), 0, &rig), EXIT_STATUS_OK);
}

/// Sends a question to a drive, as the pump does. Returns whether the adapter heard it.
static bool reaches(int master, uint8_t id) {
    const struct can_frame frame = {.id = 0x140U + id, .length = 8, .data = {0x92}};
    char wanted[8], heard[2048];
    snprintf(wanted, sizeof wanted, "t14%u8", id);
    CHECK_EQ(hal_can_send(devices.pump.can, &frame), HAL_OK); // to a bus that is lost, too
    struct pollfd end = {.fd = master, .events = POLLIN};
    size_t size = 0;
    while (poll(&end, 1, 1000) > 0 && (end.revents & POLLIN) != 0 && size < sizeof heard - 1U) {
        const ssize_t got = read(master, heard + size, sizeof heard - 1U - size);
        size += got > 0 ? (size_t)got : 0U;
        heard[size] = '\0';
        if (got <= 0 || strstr(heard, wanted) != NULL) {
            break;
        }
    }
    heard[size] = '\0';
    return strstr(heard, wanted) != NULL;
}

/// What a tick does with the devices.
static const char *tick(void) {
    struct can_frame frame;
    uint32_t at_us;
    for (unsigned i = 0; i < 16U && hal_can_receive(devices.pump.can, &frame, &at_us) == HAL_OK;
         i++) {
    }
    rig_devices_tick(&devices);
    return rig_devices_newly_lost(&devices);
}

/// In the middle of the first system call of the opening, by whichever thread makes it.
static void stand_still(void) {
    struct timespec until;
    blocked_ticks = pthread_equal(pthread_self(), ticks) != 0;
    sem_post(&entered);
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += blocked_ticks ? 0 : 60;
    while (sem_timedwait(&released, &until) != 0 && errno == EINTR) {
    }
}

static void ticks_go_on_while_a_device_is_opened(void) {
    const char *lost = NULL;
    int pan = plug_in("pan"), tilt = plug_in("tilt");
    read_rig();
    CHECK_EQ(rig_devices_open(&devices, &rig), EXIT_STATUS_OK);
    CHECK(reaches(pan, 1) && reaches(tilt, 2) && !rig_devices_incomplete(&devices));

    close(tilt);
    for (unsigned i = 0; i < 30000U && lost == NULL; i++) {
        lost = tick();
        usleep(1000);
    }
    CHECK(lost != NULL && strstr(lost, "tilt") != NULL);
    CHECK(rig_devices_incomplete(&devices) && tick() == NULL); // told once
    tilt = plug_in("tilt");

    syscalls_intruder(stand_still);
    syscalls_spare("pthread_create ");
    syscalls_at(1, SYSCALLS_INTRUDE, 0);
    rig_devices_mend(&devices);
    while (sem_wait(&entered) != 0 && errno == EINTR) {
    }
    CHECK(!blocked_ticks);
    for (unsigned i = 0; i < 200U && check_clean(); i++) {
        CHECK(tick() == NULL && rig_devices_incomplete(&devices));
        rig_devices_mend(&devices); // it is being mended
    }
    CHECK(reaches(pan, 1));
    sem_post(&released);
    for (unsigned i = 0; i < 30000U && rig_devices_incomplete(&devices); i++) {
        CHECK(tick() == NULL);
        usleep(1000);
    }
    CHECK(!rig_devices_incomplete(&devices));
    CHECK(reaches(tilt, 2) && reaches(pan, 1));
    rig_devices_close(&devices);
    rig_free(&rig);
    close(pan);
    close(tilt);
}

/// What is still missing stays lost, and is tried again.
static void a_device_that_stays_away_is_tried_again(void) {
    int pan = plug_in("pan"), tilt = plug_in("tilt");
    read_rig();
    CHECK_EQ(rig_devices_open(&devices, &rig), EXIT_STATUS_OK);
    close(pan);
    (void)unlink(path_of("pan"));
    for (unsigned i = 0; i < 30000U && !rig_devices_incomplete(&devices); i++) {
        (void)tick();
        usleep(1000);
    }
    for (unsigned tries = 0; tries < 3U; tries++) {
        rig_devices_mend(&devices);
        for (unsigned i = 0; i < 30000U && devices.mending_begun; i++) {
            CHECK(tick() == NULL);
            usleep(1000);
        }
        CHECK(rig_devices_incomplete(&devices));
    }
    CHECK(reaches(tilt, 2));
    pan = plug_in("pan");
    rig_devices_mend(&devices);
    for (unsigned i = 0; i < 30000U && rig_devices_incomplete(&devices); i++) {
        CHECK(tick() == NULL);
        usleep(1000);
    }
    CHECK(reaches(pan, 1));
    rig_devices_close(&devices);
    rig_free(&rig);
    close(pan);
    close(tilt);
}

int main(void) {
    ticks = pthread_self();
    sem_init(&entered, 0, 0);
    sem_init(&released, 0, 0);
    if (mkdtemp(folder) == NULL) {
        perror(folder);
        return 2;
    }
    TEST(ticks_go_on_while_a_device_is_opened);
    TEST(a_device_that_stays_away_is_tried_again);
    static const char *const names[] = {"pan", "tilt", "rig.ini"};
    for (unsigned i = 0; i < 3U; i++) {
        (void)unlink(path_of(names[i]));
    }
    (void)rmdir(folder);
    return check_finish();
}
