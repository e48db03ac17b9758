#include "replay/recording.h"

#include "replay/layout.h"
#include "world/trace_hash.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define HASH_EVERY 1000U
/// A tick with everything in it: 16 frames of 30 characters, 64 updates of 120.
#define LINE_BYTES 16384U
#define BYTES_MAX  4096U

uint64_t recording_hash(uint64_t hash, uint64_t tick, const struct controller_output *output) {
    hash = trace_hash_u64(hash, tick);
    hash = trace_hash_u64(hash, output->frame_count);
    for (uint32_t i = 0; i < output->frame_count && i < CONTROLLER_FRAMES_OUT_MAX; i++) {
        const struct can_frame *frame = &output->frame[i];
        uint64_t data = 0;
        memcpy(&data, frame->data, frame->length <= 8U ? frame->length : 8U);
        hash = trace_hash_u64(hash, (uint64_t)frame->id << 16 | (uint64_t)frame->flags << 8 |
                                        frame->length);
        hash = trace_hash_u64(hash, data);
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        hash = trace_hash_u64(hash, (uint64_t)output->pulse_set[axis] << 63 |
                                        (uint64_t)output->pulse_channel[axis] << 32 |
                                        output->pulse_ns[axis]);
        hash = trace_hash_u64(hash, (uint64_t)output->status.axis[axis].setpoint_q48);
    }
    return trace_hash_u64(hash, (uint64_t)output->status.mode << 32 | output->status.faults);
}

// ---------------------------------------------------------------- writing

static void write_hex(FILE *file, const uint8_t *bytes, size_t count) {
    for (size_t i = 0; i < count; i++) {
        fprintf(file, "%02x", bytes[i]);
    }
}

static void write_struct(FILE *file, struct layout *layout, const void *host) {
    uint8_t arm[BYTES_MAX];
    layout_to_arm(layout, host, arm);
    write_hex(file, arm, layout_arm_bytes(layout));
}

bool recorder_open(struct recorder *recorder, const char *path) {
    *recorder = (struct recorder){.file = fopen(path, "w"), .hash = TRACE_HASH_START};
    return recorder->file != NULL && fputs("boresight recording 1\n", recorder->file) >= 0;
}

static void write_check(const struct recorder *recorder) {
    fprintf(recorder->file, "h %" PRIu64 " %016" PRIx64 "\n", recorder->ticks, recorder->hash);
}

bool recorder_close(struct recorder *recorder) {
    if (recorder->file == NULL) {
        return true;
    }
    write_check(recorder);
    const bool written = ferror(recorder->file) == 0;
    const bool closed = fclose(recorder->file) == 0;
    recorder->file = NULL;
    return written && closed;
}

void recorder_start(struct recorder *recorder, const struct controller_config *config) {
    if (recorder != NULL && recorder->file != NULL) {
        fputs("start ", recorder->file);
        write_struct(recorder->file, &layout_controller_config, config);
        fputc('\n', recorder->file);
    }
}

void recorder_tick(struct recorder *recorder, const struct controller_input *input,
                   const struct controller_output *output) {
    if (recorder == NULL || recorder->file == NULL) {
        return;
    }
    FILE *file = recorder->file;
    fprintf(file, "t %" PRIu32 " %" PRIu32, input->now_us, input->commands);
    if (input->pan_set) {
        fputs(" p ", file);
        write_struct(file, &layout_controller_pan, &input->pan);
    }
    for (uint32_t i = 0; i < input->frame_count && i < CONTROLLER_FRAMES_IN_MAX; i++) {
        const struct can_frame *frame = &input->frame[i];
        fprintf(file, " f %" PRIx32 " %x ", frame->id, frame->flags);
        write_hex(file, frame->data, frame->length);
        fputs(frame->length == 0U ? "-" : "", file);
        fprintf(file, " %" PRIu32, input->frame_us[i]);
    }
    for (uint32_t i = 0; i < input->update_count && i < CONTROLLER_UPDATES_MAX; i++) {
        fputs(" u ", file);
        write_struct(file, &layout_target_update, &input->update[i]);
    }
    fputc('\n', file);
    recorder->hash = recording_hash(recorder->hash, recorder->ticks++, output);
    if (recorder->ticks % HASH_EVERY == 0U) {
        write_check(recorder);
    }
}

// ---------------------------------------------------------------- reading

/// Everything that a replay needs while it runs.
struct reader {
    char line[LINE_BYTES];
    char *at; ///< in line
    struct controller_config config;
    struct controller controller;
    struct controller_input input;
    struct controller_output output;
    bool started;
    bool failed; ///< the rest of the line makes no sense
};

/// The next word of the line; empty at its end.
static char *next_word(struct reader *reader) {
    while (*reader->at == ' ') {
        reader->at++;
    }
    char *word = reader->at;
    while (*reader->at != '\0' && *reader->at != ' ') {
        reader->at++;
    }
    if (*reader->at == ' ') {
        *reader->at++ = '\0';
    }
    return word;
}

static uint64_t next_number(struct reader *reader, int base, uint64_t most) {
    const char *word = next_word(reader);
    char *end;
    const uint64_t value = isxdigit((unsigned char)*word) ? strtoull(word, &end, base) : 0U;
    if (!isxdigit((unsigned char)*word) || *end != '\0' || value > most) {
        reader->failed = true;
    }
    return value;
}

/// Bytes in hexadecimal; returns how many, at most `most`.
static size_t next_bytes(struct reader *reader, uint8_t *bytes, size_t most) {
    const char *word = next_word(reader);
    const size_t count = strlen(word) / 2U;
    if (strlen(word) % 2U != 0U || count > most) {
        reader->failed = true;
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        char pair[3] = {word[2U * i], word[2U * i + 1U], '\0'};
        char *end;
        bytes[i] = (uint8_t)strtoul(pair, &end, 16);
        reader->failed = reader->failed || *end != '\0' || !isxdigit((unsigned char)pair[0]);
    }
    return count;
}

static void next_struct(struct reader *reader, struct layout *layout, void *host) {
    uint8_t arm[BYTES_MAX] = {0};
    const uint32_t bytes = layout_arm_bytes(layout);
    if (next_bytes(reader, arm, bytes) != bytes) {
        reader->failed = true;
    }
    layout_to_host(layout, arm, host);
}

static void read_frame(struct reader *reader) {
    struct can_frame frame = {0};
    frame.id = (uint32_t)next_number(reader, 16, CAN_FRAME_EXTENDED_ID_MAX);
    frame.flags = (uint8_t)next_number(reader, 16, 3);
    if (*reader->at == '-') {
        (void)next_word(reader);
    } else {
        frame.length = (uint8_t)next_bytes(reader, frame.data, sizeof frame.data);
    }
    const uint32_t arrived_us = (uint32_t)next_number(reader, 10, UINT32_MAX);
    if (reader->input.frame_count == CONTROLLER_FRAMES_IN_MAX) {
        reader->failed = true;
        return;
    }
    reader->input.frame[reader->input.frame_count] = frame;
    reader->input.frame_us[reader->input.frame_count++] = arrived_us;
}

static void read_update(struct reader *reader) {
    struct target_update update;
    next_struct(reader, &layout_target_update, &update);
    if (reader->input.update_count == CONTROLLER_UPDATES_MAX) {
        reader->failed = true;
        return;
    }
    reader->input.update[reader->input.update_count++] = update;
}

static void read_tick(struct reader *reader, struct replay *replay) {
    reader->input.now_us = (uint32_t)next_number(reader, 10, UINT32_MAX);
    reader->input.commands = (uint32_t)next_number(reader, 10, UINT32_MAX);
    reader->input.frame_count = reader->input.update_count = 0;
    reader->input.pan_set = false;
    while (!reader->failed && *reader->at != '\0') {
        const char *word = next_word(reader);
        if (strcmp(word, "f") == 0) {
            read_frame(reader);
        } else if (strcmp(word, "u") == 0) {
            read_update(reader);
        } else if (strcmp(word, "p") == 0) {
            next_struct(reader, &layout_controller_pan, &reader->input.pan);
            reader->input.pan_set = true;
        } else {
            reader->failed = true;
        }
    }
    if (reader->failed || !reader->started) {
        reader->failed = true;
        return;
    }
    controller_step(&reader->controller, &reader->input, &reader->output);
    replay->hash = recording_hash(replay->hash, replay->ticks++, &reader->output);
}

static void read_check(struct reader *reader, struct replay *replay) {
    const uint64_t ticks = next_number(reader, 10, UINT64_MAX);
    const uint64_t hash = next_number(reader, 16, UINT64_MAX);
    if (replay->same && (ticks != replay->ticks || hash != replay->hash)) {
        replay->same = false;
        replay->differs_by_ticks = replay->ticks;
    }
}

static void read_line(struct reader *reader, struct replay *replay) {
    reader->at = reader->line;
    const char *word = next_word(reader);
    if (strcmp(word, "t") == 0) {
        read_tick(reader, replay);
    } else if (strcmp(word, "h") == 0) {
        read_check(reader, replay);
    } else if (strcmp(word, "start") == 0) {
        next_struct(reader, &layout_controller_config, &reader->config);
        (void)controller_init(&reader->controller, &reader->config);
        reader->started = true;
    } else if (replay->line != 1U || strcmp(word, "boresight") != 0) {
        reader->failed = true;
    }
}

static bool read_all(FILE *file, struct reader *reader, struct replay *replay) {
    bool checked = false;
    while (fgets(reader->line, sizeof reader->line, file) != NULL) {
        replay->line++;
        const size_t size = strlen(reader->line);
        if (size == 0U || reader->line[size - 1U] != '\n') {
            snprintf(replay->wrong, sizeof replay->wrong, "the line is cut off");
            return false;
        }
        reader->line[size - 1U] = '\0';
        checked = reader->line[0] == 'h';
        read_line(reader, replay);
        if (reader->failed) {
            snprintf(replay->wrong, sizeof replay->wrong, "is no line of a recording");
            return false;
        }
    }
    if (!checked || replay->ticks == 0U) {
        snprintf(replay->wrong, sizeof replay->wrong, "the recording has no end");
        return false;
    }
    return true;
}

bool recording_replay(FILE *file, struct replay *replay) {
    *replay = (struct replay){.hash = TRACE_HASH_START, .same = true};
    struct reader *reader = calloc(1, sizeof *reader);
    if (reader == NULL) {
        snprintf(replay->wrong, sizeof replay->wrong, "no memory");
        return false;
    }
    const bool read = read_all(file, reader, replay);
    free(reader);
    return read;
}
