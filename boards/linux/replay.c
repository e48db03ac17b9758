#include "replay.h"

#include "facts.h"

#include "replay/recording.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

extern const char build_id[];

enum exit_status replay_file(const struct command *command, const char *path, bool json) {
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        message_at(path, 0, "%s", strerror(errno));
        return EXIT_STATUS_USAGE;
    }
    struct replay replay;
    const bool read = recording_replay(file, &replay);
    fclose(file);
    if (!read) {
        message_at(path, replay.line, "%s", replay.wrong);
        return EXIT_STATUS_USAGE;
    }
    char hash[17];
    snprintf(hash, sizeof hash, "%016" PRIx64, replay.hash);
    struct facts facts;
    facts_begin(&facts, stdout, json);
    facts_text(&facts, "build", build_id);
    facts_u64(&facts, "steps", replay.ticks);
    facts_text(&facts, "output_hash", hash);
    facts_bool(&facts, "same", replay.same);
    facts_end(&facts);
    if (!replay.same) {
        message_command(command->name, "the outputs differ, at step %" PRIu64 " at the latest",
                        replay.differs_by_ticks);
        return EXIT_STATUS_FAILURE;
    }
    return EXIT_STATUS_OK;
}
