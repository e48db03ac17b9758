/// Names of devices that stay: links as udev makes them, to devices that every machine has.
#include "linux/linux_links.h"
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char root[64];

static void link_to(const char *folder, const char *name, const char *device) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s/%s", root, folder, name);
    CHECK_EQ(symlink(device, path), 0);
}

static bool becomes(const char *device, bool shared, const char *wanted) {
    char path[200], whole[200];
    snprintf(path, sizeof path, "%s", device);
    snprintf(whole, sizeof whole, "%s%s%s", wanted[0] == '/' ? "" : root,
             wanted[0] == '/' ? "" : "/", wanted);
    linux_links_prefer(root, shared, path, sizeof path);
    if (strcmp(path, whole) != 0) {
        printf("  %s became %s, not %s\n", device, path, whole);
    }
    return strcmp(path, whole) == 0;
}

/// Two cameras of one make, no serial numbers: they share a by-id link, which leads to the second.
static void the_socket_tells_twins_apart(void) {
    link_to("by-id", "usb-twin", "/dev/zero");
    link_to("by-path", "usb-1.1", "/dev/null");
    link_to("by-path", "usb-1.2", "/dev/zero");
    CHECK(!linux_links_has_id(root, "/dev/null") && linux_links_has_id(root, "/dev/zero"));
    CHECK(becomes("/dev/null", true, "by-path/usb-1.1"));
    CHECK(becomes("/dev/zero", true, "by-path/usb-1.2"));
}

static void a_serial_number_is_the_best_name(void) {
    link_to("by-id", "usb-another", "/dev/full");
    link_to("by-path", "usb-1.3", "/dev/full");
    CHECK(becomes("/dev/full", false, "by-id/usb-another"));
    CHECK(becomes("/dev/null", false, "by-path/usb-1.1")); // it has none
}

static void what_has_no_link_keeps_its_name(void) {
    CHECK(becomes("/dev/random", false, "/dev/random"));
    CHECK(becomes("/dev/random", true, "/dev/random"));
    CHECK(becomes("/dev/no-such-device", false, "/dev/no-such-device"));
}

static void a_link_that_does_not_fit_is_none(void) {
    char path[16] = "/dev/full";
    linux_links_prefer(root, false, path, sizeof path);
    CHECK(strcmp(path, "/dev/full") == 0);
}

int main(void) {
    snprintf(root, sizeof root, "/tmp/linux_links.XXXXXX");
    char path[200];
    if (mkdtemp(root) == NULL) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/by-id", root);
    CHECK_EQ(mkdir(path, 0755), 0);
    snprintf(path, sizeof path, "%s/by-path", root);
    CHECK_EQ(mkdir(path, 0755), 0);
    TEST(the_socket_tells_twins_apart);
    TEST(a_serial_number_is_the_best_name);
    TEST(what_has_no_link_keeps_its_name);
    TEST(a_link_that_does_not_fit_is_none);
    snprintf(path, sizeof path, "rm -r %s", root);
    return system(path) != 0 ? 1 : check_finish();
}
