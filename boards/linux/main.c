/// The program `boresight`: finds the command and runs it. docs/cli.md is the user's manual.
#include "command.h"
#include "message.h"
#include "suggest.h"

#include "detect/tags.h"
#include "drawing.h"

#include "linux/linux_gpio.h"
#include "linux/linux_luma.h"
#include "linux/linux_usb.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

extern const char build_id[];

static const struct command *find_command(const char *name) {
    for (size_t i = 0; i < command_count; i++) {
        if (strcmp(commands[i]->name, name) == 0) {
            return commands[i];
        }
    }
    return NULL;
}

static void tell_unknown(const char *where, const char *kind, const char *word) {
    struct suggestion suggestion = suggest_start(word);
    for (size_t i = 0; i < command_count; i++) {
        suggest_offer(&suggestion, commands[i]->name);
    }
    message_command(where, "no %s %s%s; 'boresight help' lists them", kind,
                    message_quoted(word, strlen(word)).text, suggest_tail(&suggestion).text);
}

static void print_help(void) {
    printf("boresight aims a pan-tilt camera at a set of points.\n\n"
           "usage: boresight COMMAND [OPTION...] [FILE]\n\n"
           "commands:\n");
    for (size_t i = 0; i < command_count; i++) {
        printf("  %-22s %s\n", commands[i]->name, commands[i]->summary);
    }
    printf("  %-22s %s\n", "help [COMMAND]", "explain the program or a command");
    printf("  %-22s %s\n\n", "--version", "print the version, the commit and how it was built");
    printf("exit status: 0 done; 1 internal failure; 2 usage or bad input; 3 infeasible;\n"
           "  4 a device is missing or failed; 5 a safety stop ended the run.\n");
}

static void print_command_help(const struct command *command) {
    printf("usage: boresight %s [OPTION...] %s\n\n%s\noptions:\n", command->name, command->operands,
           command->help);
    options_print(command->options, command->option_count);
    printf("  %-22s %s\n", "--help", "print this help");
}

static enum exit_status help(int argc, char *const *argv) {
    if (argc == 0) {
        print_help();
        return EXIT_STATUS_OK;
    }
    const struct command *const command = find_command(argv[0]);
    if (command == NULL) {
        tell_unknown("help", "command", argv[0]);
        return EXIT_STATUS_USAGE;
    }
    print_command_help(command);
    return EXIT_STATUS_OK;
}

static void print_version(void) {
    printf("boresight %s\n", build_id);
#if defined(__clang__)
    printf("compiler           clang %d.%d.%d\n", __clang_major__, __clang_minor__,
           __clang_patchlevel__);
#else
    printf("compiler           gcc %d.%d.%d\n", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
#ifdef __OPTIMIZE__
    printf("optimised          yes\n");
#else
    printf("optimised          no\n");
#endif
    printf("pointer_bits       %zu\n", 8 * sizeof(void *));
    printf("long_double_bits   %d\n", LDBL_MANT_DIG);
    const char *const libraries[] = {linux_gpio_library(), linux_usb_library(),
                                     linux_luma_jpeg_library(), tags_library(),
                                     drawing_png_library()};
    static const char *const without[] = {"no libgpiod", "no libusb", "no libjpeg-turbo",
                                          "no libapriltag", "no cairo"};
    printf("libraries         ");
    for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++) {
        printf("%s%s", i > 0U ? ", " : " ", libraries[i] != NULL ? libraries[i] : without[i]);
    }
    printf("\n");
    printf("commands          ");
    for (size_t i = 0; i < command_count; i++) {
        printf(" %s", commands[i]->name);
    }
    printf("\n");
}

/// Whether one of the arguments asks for the command's help.
static bool asks_for_help(int argc, char *const *argv) {
    for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            return true;
        }
    }
    return false;
}

static enum exit_status run(int argc, char *const *argv) {
    if (argc < 2) {
        message_command(NULL, "which command? 'boresight help' lists them");
        return EXIT_STATUS_USAGE;
    }
    const char *const word = argv[1];
    if (strcmp(word, "--version") == 0) {
        print_version();
        return EXIT_STATUS_OK;
    }
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        return help(argc - 2, argv + 2);
    }
    const struct command *const command = find_command(word);
    if (command == NULL) {
        tell_unknown(NULL, word[0] == '-' ? "option" : "command", word);
        return EXIT_STATUS_USAGE;
    }
    if (asks_for_help(argc - 2, argv + 2)) {
        print_command_help(command);
        return EXIT_STATUS_OK;
    }
    return command->run(command, argc - 2, argv + 2);
}

/// A device that is opened must not become the place where results or messages go. What was closed
/// stays useless: reading and writing fail as before.
static void keep_standard_files(void) {
    static const int modes[] = {O_WRONLY, O_RDONLY, O_WRONLY};
    for (int fd = 0; fd < 3; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
            (void)!open("/dev/null", modes[fd]);
        }
    }
}

int main(int argc, char **argv) {
    keep_standard_files();
    const enum exit_status status = run(argc, argv);
    // Results that did not arrive (a full disk) must not look like success.
    if (fflush(stdout) != 0 || ferror(stdout)) {
        message_command(NULL, "can't write the results: %s", strerror(errno));
        return EXIT_STATUS_FAILURE;
    }
    return (int)status;
}
