#include "options.h"

#include "decimal.h"
#include "message.h"
#include "points.h"
#include "suggest.h"

#include <stdio.h>
#include <string.h>

const char *option_flag(const struct option *option, const char *text, void *place) {
    (void)option;
    (void)text;
    *(bool *)place = true;
    return NULL;
}

const char *option_text(const struct option *option, const char *text, void *place) {
    (void)option;
    *(const char **)place = text;
    return NULL;
}

const char *option_choice(const struct option *option, const char *text, void *place) {
    static char why[256];
    size_t at = (size_t)snprintf(why, sizeof why, "choose one of");
    for (int i = 0; option->choices[i] != NULL; i++) {
        if (strcmp(text, option->choices[i]) == 0) {
            *(int *)place = i;
            return NULL;
        }
        const char *const comma = i == 0 ? "" : ",";
        if (at < sizeof why) {
            at += (size_t)snprintf(why + at, sizeof why - at, "%s %s", comma, option->choices[i]);
        }
    }
    return why;
}

const char *option_triple(const struct option *option, const char *text, void *place) {
    (void)option;
    return points_read_triple(text, place);
}

const char *option_u64(const struct option *option, const char *text, void *place) {
    (void)option;
    uint64_t value = 0;
    const char *at = text;
    for (; *at >= '0' && *at <= '9'; at++) {
        const uint64_t digit = (uint64_t)(*at - '0');
        if (value > (UINT64_MAX - digit) / 10U) {
            return "is too large";
        }
        value = value * 10U + digit;
    }
    if (at == text || *at != '\0') {
        return "is not a whole number";
    }
    *(uint64_t *)place = value;
    return NULL;
}

/// The option whose name is argument up to its `=`; *value what follows that, or NULL.
static const struct option *find(const struct option *options, size_t option_count,
                                 const char *argument, const char **value) {
    const size_t length = strcspn(argument, "=");
    *value = argument[length] == '=' ? argument + length + 1 : NULL;
    for (size_t i = 0; i < option_count; i++) {
        if (strncmp(options[i].name, argument, length) == 0 && options[i].name[length] == '\0') {
            return &options[i];
        }
    }
    return NULL;
}

static void tell_unknown(const char *command, const struct option *options, size_t option_count,
                         const char *argument) {
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(argument, "="), argument);
    struct suggestion suggestion = suggest_start(word);
    for (size_t i = 0; i < option_count; i++) {
        suggest_offer(&suggestion, options[i].name);
    }
    message_command(command, "unknown option %s%s; see 'boresight help %s'",
                    message_quoted(word, strlen(word)).text, suggest_tail(&suggestion).text,
                    command);
}

/// Reads the option at argv[*at]; *at moves on to a value that stands apart.
static bool read_option(const char *command, const struct option *options, size_t option_count,
                        int argc, char *const *argv, int *at, void *settings) {
    const char *value;
    const char *const argument = argv[*at];
    const struct option *const option = find(options, option_count, argument, &value);
    if (option == NULL) {
        tell_unknown(command, options, option_count, argument);
        return false;
    }
    if (option->value == NULL && value != NULL) {
        message_command(command, "%s takes no value", option->name);
        return false;
    }
    if (option->value != NULL && value == NULL) {
        if (*at + 1 >= argc) {
            message_command(command, "%s needs a value: %s", option->name, option->value);
            return false;
        }
        (*at)++;
        value = argv[*at];
    }
    const char *const why = option->read(option, value, (char *)settings + option->offset);
    if (why != NULL) {
        message_command(command, "%s %s: %s", option->name,
                        message_quoted(value, strlen(value)).text, why);
        return false;
    }
    return true;
}

bool options_read(const char *command, const struct option *options, size_t option_count, int argc,
                  char *const *argv, void *settings, const char **operands, size_t operand_most,
                  size_t *operand_count) {
    *operand_count = 0;
    bool only_operands = false;
    for (int i = 0; i < argc; i++) {
        const char *const argument = argv[i];
        if (!only_operands && strcmp(argument, "--") == 0) {
            only_operands = true;
            continue;
        }
        if (!only_operands && argument[0] == '-' && argument[1] != '\0') {
            if (!read_option(command, options, option_count, argc, argv, &i, settings)) {
                return false;
            }
            continue;
        }
        if (*operand_count == operand_most) {
            message_command(command, "unexpected argument %s; see 'boresight help %s'",
                            message_quoted(argument, strlen(argument)).text, command);
            return false;
        }
        operands[(*operand_count)++] = argument;
    }
    return true;
}

void options_print(const struct option *options, size_t option_count) {
    for (size_t i = 0; i < option_count; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", options[i].name,
                 options[i].value != NULL ? options[i].value : "");
        printf("  %-22s %s\n", left, options[i].help);
    }
}

bool options_read_file(const char *command, const struct option *options, size_t option_count,
                       int argc, char *const *argv, void *settings, const char *what,
                       const char **file) {
    size_t operands;
    if (!options_read(command, options, option_count, argc, argv, settings, file, 1, &operands)) {
        return false;
    }
    if (operands == 0U || strcmp(*file, "-") == 0) {
        message_command(command, "which %s? give its file", what);
        return false;
    }
    return true;
}

bool option_positive(const char *command, const char *name, const char *text, double *out) {
    struct decimal value;
    int64_t millionths = 0;
    if (decimal_read(text, strlen(text), &value) != DECIMAL_OK ||
        !decimal_scale(&value, 1000000, 1, &millionths) || millionths <= 0 ||
        millionths > INT64_C(4000000000000)) {
        message_command(command, "%s %s: must be a number above 0, at most 4000000", name,
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    *out = (double)millionths * 1e-6;
    return true;
}
