/// CAN interfaces as the kernel's routing socket tells of them, with every error at every step. It
/// needs no CAN: that the kernel has none, and what else is there, is an answer as well.
/// tests/vm/linux_can.c has the same on a kernel with CAN, and changes interfaces, too.
#include "linux/linux_can_link.h"
#include "contract/support/contract.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"

#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static void live(void) {
    static struct linux_can_link links[64];
    struct linux_error error = {""};
    uint32_t count = 0;
    life_note("list", linux_can_list(links, 64, &count, &error), &error);
    life_value("count", count);
    // The loopback is in every machine, and is no CAN.
    life_note_refusal("find", linux_can_link_find("lo", &links[0], &error), HAL_ERROR_UNSUPPORTED,
                      &error);
    life_note_refusal("find", linux_can_link_find("boresight9", &links[0], &error), HAL_ERROR_GONE,
                      &error);
}

static void fails_at_every_step(void) {
    const struct life_error errors[] = {
        LIFE_EIO, LIFE_ENOMEM, LIFE_EACCES, {ENOBUFS, LIFE_STATUS(HAL_ERROR_IO)}};
    lives_each_failure(&(struct lives){.device = "", // lines of lists name none
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 4,
                                       .dies = true});
}

/// Each of the kernel's calls for a list fails in turn.
static void a_list_that_fails(void) {
    for (uint32_t nth = 1; nth <= 10U && check_clean(); nth++) {
        struct linux_can_link links[4];
        struct linux_error error = {""};
        uint32_t count = 77;
        syscalls_at(nth, SYSCALLS_FAIL, EIO);
        const enum hal_status status = linux_can_list(links, 4, &count, &error);
        const bool met = syscalls_met();
        const bool matters = strcmp(syscalls_met_name(), "setsockopt") != 0 && // only patience
                             strcmp(syscalls_met_name(), "close") != 0;
        syscalls_at(0, SYSCALLS_FAIL, 0);
        CHECK_EQ(status, met && matters ? HAL_ERROR_IO : HAL_OK);
        CHECK(status == HAL_OK ||
              strncmp(error.line, "network interfaces: Input/output error; ", 40) == 0);
    }
}

int main(void) {
    const int fd = socket(AF_NETLINK, SOCK_RAW, NETLINK_ROUTE);
    if (fd < 0) {
        contract_skip("linux_can_link", "all", "no routing socket here");
        return 0;
    }
    close(fd);
    CONTRACT("linux_can_link", fails_at_every_step);
    CONTRACT("linux_can_link", a_list_that_fails);
    return check_finish();
}
