/// Programs of tests/mcu/guest/ on the emulated processor; each line that they print is a verdict.
/// With a file as argument: prints what that program says, for second_opinion.sh.
#include "check.h"
#include "mcu/machine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct machine machine;
static char said[8192];
static size_t said_bytes;

static void on_byte(void *context, uint8_t byte, bool framed) {
    (void)context;
    if (said_bytes < sizeof said - 1U) {
        said[said_bytes++] = framed ? (char)byte : '?';
        said[said_bytes] = '\0';
    }
}

static bool has_line(const char *line) {
    const size_t size = strlen(line);
    for (const char *at = strstr(said, line); at != NULL; at = strstr(at + 1, line)) {
        if ((at == said || at[-1] == '\n') && at[size] == '\n') {
            return true;
        }
    }
    return false;
}

/// Runs a program for a second at most, or until it says `end`.
static void run(const char *path, bool exact) {
    struct machine_options options = machine_defaults();
    options.exact = exact;
    said_bytes = 0;
    said[0] = '\0';
    const char *wrong = machine_start(&machine, path, &options);
    if (wrong != NULL) {
        printf("%s: %s\n", path, wrong);
        return;
    }
    const struct usart_line line = {
        .baud = 115200, .tx_pin = GPIO_PIN('A', 9), .rx_pin = GPIO_PIN('A', 10), .heard = on_byte};
    usart_connect(&machine.soc.usart[0], &line);
    for (uint64_t ms = 1; ms <= 1000U && !has_line("end"); ms++) {
        cpu_run(&machine.cpu, ms * 1000000U);
    }
}

/// Every line but the last ends in ` ok`.
static unsigned count_verdicts(void) {
    unsigned count = 0;
    for (const char *line = said; *line != '\0';) {
        const char *end = strchr(line, '\n');
        const size_t size = end != NULL ? (size_t)(end - line) : strlen(line);
        if (size >= 3U && memcmp(line + size - 3U, " ok", 3) == 0) {
            count++;
        } else if (size != 3U || memcmp(line, "end", 3) != 0) {
            printf("  %.*s\n", (int)size, line);
            CHECK(false);
        }
        line += size + (end != NULL ? 1U : 0U);
    }
    CHECK(has_line("end"));
    return count;
}

static void exceptions_go_as_the_manual_says(void) {
    run("build/guest/exceptions.elf", true);
    CHECK_EQ(count_verdicts(), 35);
    CHECK_EQ(machine.cpu.resets, 1);
    CHECK_EQ(machine.soc.complaints, 0);
    machine_free(&machine);
}

static void and_so_they_do_in_the_quick_mode(void) {
    run("build/guest/exceptions.elf", false);
    CHECK_EQ(count_verdicts(), 35);
    machine_free(&machine);
}

static void time_as_the_program_sees_it(void) {
    run("build/guest/timing.elf", false);
    CHECK_EQ(count_verdicts(), 4);
    machine_free(&machine);
}

static void the_watchdog_gets_a_locked_up_processor_going(void) {
    run("build/guest/lock_up.elf", false);
    CHECK(strcmp(said, "started\nhard fault\nreset by the watchdog\nend\n") == 0);
    CHECK_EQ(machine.cpu.resets, 1);
    CHECK_EQ(machine.soc.complaints, 1); // a lock-up is told
    CHECK(soc_now_ns(&machine.soc) >= 512000000U && soc_now_ns(&machine.soc) <= 530000000U);
    machine_free(&machine);
}

static void an_overflow_of_the_stack_locks_up(void) {
    run("build/guest/stack_overflow.elf", false);
    CHECK(strncmp(said, "started", 7) == 0 && !has_line("end"));
    CHECK_EQ(machine.cpu.state, CPU_LOCKED_UP);
    CHECK(strstr(machine.cpu.why_locked_up, "stack") != NULL);
    machine_free(&machine);
}

static void two_runs_are_alike(void) {
    uint64_t cycles[2], instructions[2];
    for (unsigned i = 0; i < 2U; i++) {
        run("build/guest/timing.elf", false);
        cycles[i] = machine.soc.cycle;
        instructions[i] = cpu_instructions(&machine.cpu);
        machine_free(&machine);
    }
    CHECK_EQ(cycles[0], cycles[1]);
    CHECK_EQ(instructions[0], instructions[1]);
}

static void files_that_are_no_images(void) {
    const struct machine_options options = machine_defaults();
    CHECK(machine_start(&machine, "build/guest/none.elf", &options) != NULL);
    machine_free(&machine);
    CHECK(machine_start(&machine, "tests/mcu/guest/start.c", &options) != NULL);
    machine_free(&machine);
    CHECK(machine_start(&machine, "build/gcc/boresight-mcu", &options) != NULL); // 64 bits
    machine_free(&machine);
}

int main(int argc, char **argv) {
    if (argc == 2) {
        run(argv[1], false);
        printf("%s", said);
        return EXIT_SUCCESS;
    }
    TEST(exceptions_go_as_the_manual_says);
    TEST(and_so_they_do_in_the_quick_mode);
    TEST(time_as_the_program_sees_it);
    TEST(the_watchdog_gets_a_locked_up_processor_going);
    TEST(an_overflow_of_the_stack_locks_up);
    TEST(two_runs_are_alike);
    TEST(files_that_are_no_images);
    return check_finish();
}
