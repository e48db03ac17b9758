#include "vm/support/sim_gpio.h"

#include "check.h"
#include "vm/support/shell.h"

#include <stdio.h>
#include <string.h>

#define CONFIG "/sys/kernel/config/gpio-sim/boresight"

static char folder[200]; ///< of the lines, in sysfs

static void read_line(const char *path, char *text, size_t capacity) {
    FILE *file = fopen(path, "r");
    text[0] = '\0';
    if (!CHECK(file != NULL)) {
        printf("  can't read %s\n", path);
        return;
    }
    CHECK(fgets(text, (int)capacity, file) != NULL);
    text[strcspn(text, "\n")] = '\0';
    fclose(file);
}

void sim_gpio_create(uint32_t line_count, char *chip, size_t capacity) {
    char device[64];
    shell("mkdir -p " CONFIG "/bank0 && echo %u >" CONFIG "/bank0/num_lines && echo " SIM_GPIO_LABEL
          " >" CONFIG "/bank0/label && echo 1 >" CONFIG "/live",
          (unsigned)line_count);
    read_line(CONFIG "/bank0/chip_name", chip, capacity);
    read_line(CONFIG "/dev_name", device, sizeof device);
    snprintf(folder, sizeof folder, "/sys/devices/platform/%s/%s", device, chip);
}

void sim_gpio_remove(void) {
    shell("echo 0 >" CONFIG "/live && rmdir " CONFIG "/bank0 " CONFIG);
}

void sim_gpio_drive(uint32_t offset, bool high) {
    char path[256];
    snprintf(path, sizeof path, "%s/sim_gpio%u/pull", folder, (unsigned)offset);
    FILE *file = fopen(path, "w");
    if (CHECK(file != NULL)) {
        fputs(high ? "pull-up" : "pull-down", file);
        CHECK_EQ(fclose(file), 0);
    }
}

bool sim_gpio_is_high(uint32_t offset) {
    char path[256], text[8];
    snprintf(path, sizeof path, "%s/sim_gpio%u/value", folder, (unsigned)offset);
    read_line(path, text, sizeof text);
    return text[0] == '1';
}
