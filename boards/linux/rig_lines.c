#include "rig_lines.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool debounce_update(struct debounce *debounce, bool reading, uint64_t now_us, uint64_t press_us,
                     uint64_t release_us) {
    if (reading == debounce->active) {
        debounce->changed_us = 0;
        return false;
    }
    if (debounce->changed_us == 0U) {
        debounce->changed_us = now_us == 0U ? 1U : now_us;
    }
    if (now_us - debounce->changed_us < (reading ? press_us : release_us)) {
        return false;
    }
    debounce->active = reading;
    debounce->changed_us = 0;
    return reading;
}

// ---------------------------------------------------------------- the text

static bool take_word(const char **at, const char *word) {
    const size_t size = strlen(word);
    if (strncmp(*at, word, size) != 0 || ((*at)[size] != ':' && (*at)[size] != '\0')) {
        return false;
    }
    *at += size;
    return true;
}

bool rig_line_parse(const char *text, char *chip, uint32_t *number, struct hal_gpio_line *line) {
    const char *at = strchr(text, ':');
    if (at == NULL || at == text || at[1] < '0' || at[1] > '9') {
        return false;
    }
    memcpy(chip, text, (size_t)(at - text));
    chip[at - text] = '\0';
    char *end;
    const unsigned long value = strtoul(at + 1, &end, 10);
    *number = (uint32_t)value;
    at = end;
    while (*at == ':') {
        at++;
        if (take_word(&at, "low")) {
            line->active_low = true;
        } else if (take_word(&at, "up")) {
            line->pull = HAL_GPIO_PULL_UP;
        } else if (take_word(&at, "down")) {
            line->pull = HAL_GPIO_PULL_DOWN;
        } else {
            return false;
        }
    }
    return *at == '\0' && value <= 4095U;
}

// ---------------------------------------------------------------- opening

static bool add(struct rig_lines *lines, const struct rig *rig, const char *section,
                const char *key, const char *text, const struct rig_line *line) {
    if (text == NULL || text[0] == '\0') {
        return true;
    }
    const uint32_t at = lines->count;
    lines->row[at].direction = line->output ? HAL_GPIO_OUTPUT : HAL_GPIO_INPUT;
    if (strlen(text) >= LINUX_GPIO_NAME_BYTES ||
        !rig_line_parse(text, lines->chip[at], &lines->pin[at].offset, &lines->row[at])) {
        ini_complain(&rig->ini, section, "", key,
                     "is no line; write CHIP:NUMBER, as gpiochip0:17:up");
        return false;
    }
    lines->pin[at].chip = lines->chip[at];
    lines->line[at] = *line;
    lines->count++;
    return true;
}

enum exit_status rig_lines_open(struct rig_lines *lines, const struct rig *rig) {
    memset(lines, 0, sizeof *lines);
    lines->debounce_us = rig->debounce_us;
    const bool good = add(lines, rig, "safety", "estop", rig->estop,
                          &(struct rig_line){.what = "emergency stop", .is_stop = true}) &&
                      add(lines, rig, "safety", "enable", rig->enable,
                          &(struct rig_line){.what = "enable", .output = true}) &&
                      add(lines, rig, "pan", "switch_min", rig->limit_switch[0][0],
                          &(struct rig_line){.what = "pan switch_min"}) &&
                      add(lines, rig, "pan", "switch_max", rig->limit_switch[0][1],
                          &(struct rig_line){.what = "pan switch_max"}) &&
                      add(lines, rig, "tilt", "switch_min", rig->limit_switch[1][0],
                          &(struct rig_line){.what = "tilt switch_min"}) &&
                      add(lines, rig, "tilt", "switch_max", rig->limit_switch[1][1],
                          &(struct rig_line){.what = "tilt switch_max"});
    if (!good) {
        lines->count = 0;
        return EXIT_STATUS_USAGE;
    }
    if (lines->count > 0U &&
        linux_gpio_open(&lines->gpio, lines->row, lines->pin, lines->count) != HAL_OK) {
        lines->count = 0;
        return EXIT_STATUS_DEVICE;
    }
    return EXIT_STATUS_OK;
}

void rig_lines_close(struct rig_lines *lines) {
    if (lines->count > 0U) {
        side_job_wait(&lines->mending);
        rig_lines_enable(lines, false);
        linux_gpio_close(&lines->gpio);
        lines->count = 0;
    }
}

bool rig_lines_lost(const struct rig_lines *lines) {
    return lines->lost;
}

static void mend(void *context) {
    struct rig_lines *const lines = context;
    linux_gpio_close(&lines->gpio);
    lines->mended = linux_gpio_open(&lines->gpio, lines->row, lines->pin, lines->count) == HAL_OK;
}

void rig_lines_mend(struct rig_lines *lines) {
    if (lines->lost && !lines->mending_begun) {
        lines->mending_begun = side_job_start(&lines->mending, mend, lines);
    }
}

static void take_mended(struct rig_lines *lines) {
    if (lines->mending_begun && side_job_is_over(&lines->mending)) {
        lines->mending_begun = false;
        lines->lost = !lines->mended;
    }
}

// ---------------------------------------------------------------- use

struct rig_lines_state rig_lines_read(struct rig_lines *lines, uint64_t now_us) {
    struct rig_lines_state state = {0};
    take_mended(lines);
    for (uint32_t i = 0; i < lines->count; i++) {
        struct rig_line *line = &lines->line[i];
        bool reading = true;
        if (!lines->lost && hal_gpio_read(&lines->gpio.hal, i, &reading) != HAL_OK) {
            state.lost = lines->gpio.error.line;
            lines->lost = true;
        }
        reading = reading || lines->lost; // the worst
        if (line->output) {
            continue; // read to notice that the chip has left
        }
        const uint64_t press_us = line->is_stop ? 0U : lines->debounce_us;
        if (debounce_update(&line->debounce, reading, now_us, press_us, lines->debounce_us)) {
            state.pressed = line->what;
        }
        state.stop = state.stop || (line->is_stop && line->debounce.active);
    }
    return state;
}

void rig_lines_enable(struct rig_lines *lines, bool active) {
    for (uint32_t i = 0; i < lines->count && !lines->lost; i++) {
        if (lines->line[i].output) {
            (void)!hal_gpio_write(&lines->gpio.hal, i, active);
        }
    }
}
