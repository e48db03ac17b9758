/// The PWM driver on files that stand for those of /sys/class/pwm. They keep what is written to
/// them and check nothing; what the kernel would refuse is looked for here.
#include "linux/linux_pwm.h"
#include "contract/support/contract.h"
#include "contract/support/pwm_suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHANNELS 4U

static struct linux_pwm pwm;
static char root[] = "/tmp/boresight-pwm-XXXXXX";

static void put(const char *file, const char *text) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", root, file);
    FILE *stream = fopen(path, "w");
    if (CHECK(stream != NULL)) {
        fputs(text, stream);
        fclose(stream);
    }
}

static uint32_t get(const char *file) {
    char path[300];
    unsigned number = 0;
    snprintf(path, sizeof path, "%s/%s", root, file);
    FILE *stream = fopen(path, "r");
    if (CHECK(stream != NULL)) {
        CHECK_EQ(fscanf(stream, "%u", &number), 1);
        fclose(stream);
    }
    return number;
}

static uint32_t get_of(uint32_t channel, const char *file) {
    char path[64];
    snprintf(path, sizeof path, "pwmchip3/pwm%u/%s", (unsigned)channel, file);
    return get(path);
}

static void make_chip(void) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwmchip3", root);
    mkdir(path, 0755);
    put("pwmchip3/npwm", "4\n");
    put("pwmchip3/export", "");
    for (unsigned i = 0; i < CHANNELS; i++) {
        char file[64];
        snprintf(path, sizeof path, "%s/pwmchip3/pwm%u", root, i);
        mkdir(path, 0755);
        // As a program left them that died.
        snprintf(file, sizeof file, "pwmchip3/pwm%u/period", i);
        put(file, "5000000\n");
        snprintf(file, sizeof file, "pwmchip3/pwm%u/duty_cycle", i);
        put(file, "1500000\n");
        snprintf(file, sizeof file, "pwmchip3/pwm%u/enable", i);
        put(file, "1\n");
    }
}

static void reset(void *context) {
    (void)context;
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 15), HAL_OK);
}

static void measure(void *context, uint32_t channel, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    *period_ns = get_of(channel, "period");
    *pulse_ns = get_of(channel, "enable") == 1U ? get_of(channel, "duty_cycle") : 0U;
    CHECK(*pulse_ns < *period_ns); // else the kernel would have refused it
}

static void closing_ends_the_pulses(void) {
    reset(NULL);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_OK);
    CHECK_EQ(get_of(1, "enable"), 1);
    linux_pwm_close(&pwm);
    CHECK_EQ(get_of(1, "enable"), 0);
    CHECK_EQ(get_of(1, "duty_cycle"), 0);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_ERROR_GONE);
    CHECK_EQ(get_of(1, "duty_cycle"), 0);
}

/// Only what was asked for is touched.
static void other_outputs_are_let_be(void) {
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 2), HAL_OK);
    CHECK_EQ(get_of(2, "enable"), 0);
    CHECK_EQ(get_of(1, "enable"), 1);
    CHECK_EQ(get_of(1, "period"), 5000000);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 2, 1500000), HAL_OK);
}

/// An output whose files are not there is asked for; here nobody makes them.
static void outputs_are_exported(void) {
    char path[300];
    linux_pwm_close(&pwm);
    put("pwmchip3/npwm", "6\n");
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 5), HAL_ERROR_GONE);
    CHECK_EQ(get("pwmchip3/export"), 5);
    CHECK(strncmp(pwm.error.line, "pwmchip3 output 5: no such file or device; is the overlay",
                  57) == 0);
    snprintf(path, sizeof path, "%s/pwmchip3/export", root);
    CHECK_EQ(unlink(path), 0);
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 4), HAL_ERROR_GONE);
}

static void refusals_say_what_to_do(void) {
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip4", 1), HAL_ERROR_GONE);
    CHECK(strcmp(pwm.error.line, "pwmchip4: no such PWM chip; is the overlay loaded "
                                 "(dtoverlay=pwm-2chan)? `boresight probe` lists the chips") == 0);
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 4), HAL_ERROR_ARGUMENT);
    CHECK(strcmp(pwm.error.line, "pwmchip3: has 4 outputs, 0 to 3; choose another channel") == 0);
    struct hal_pwm_limits limits;
    CHECK_EQ(hal_pwm_limits(&pwm.hal, 0, &limits), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 20000000), HAL_ERROR_GONE);
}

static void chips_are_listed(void) {
    char path[300];
    struct linux_pwm_chip chips[4];
    make_chip();
    snprintf(path, sizeof path, "%s/pwmchip12", root);
    mkdir(path, 0755);
    put("pwmchip12/npwm", "2\n");
    CHECK_EQ(linux_pwm_list(root, chips, 4), 2);
    CHECK(strcmp(chips[0].name, "pwmchip3") == 0 && chips[0].channel_count == 4U);
    CHECK(strcmp(chips[1].name, "pwmchip12") == 0 && chips[1].channel_count == 2U);
    CHECK_EQ(linux_pwm_list(root, chips, 1), 2);
    CHECK_EQ(linux_pwm_list("/nowhere", chips, 4), 0);
}

int main(void) {
    if (mkdtemp(root) == NULL) {
        return 2;
    }
    reset(NULL);
    pwm_suite(&(struct pwm_fixture){.name = "linux_pwm",
                                    .pwm = &pwm.hal,
                                    .channel_count = CHANNELS,
                                    .reset = reset,
                                    .measure = measure});
    CONTRACT("linux_pwm", closing_ends_the_pulses);
    CONTRACT("linux_pwm", other_outputs_are_let_be);
    CONTRACT("linux_pwm", outputs_are_exported);
    CONTRACT("linux_pwm", refusals_say_what_to_do);
    CONTRACT("linux_pwm", chips_are_listed);
    linux_pwm_close(&pwm);
    char command[100];
    snprintf(command, sizeof command, "rm -r %s", root);
    CHECK_EQ(system(command), 0);
    return check_finish();
}
