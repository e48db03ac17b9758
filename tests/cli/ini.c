/// The reader of INI files and the table that gives them meaning.
#include "check.h"
#include "support/messages.h"

#include "ini_schema.h"

// ---------------------------------------------------------------- a format of our own

struct axis {
    int64_t limit_min_q48, steps;
    bool reversed;
    int drive;
};

struct event {
    const char *label;
    int64_t at_us;
    const char *action;
};

struct rig {
    const char *name;
    struct axis pan, zoom;
    bool has_zoom;
    struct ini_texts tags;
    struct ini_numbers table;
    struct event events[2];
    uint32_t event_count;
};

static const char *const drives[] = {"rmd", "pwm", "fake", NULL};

static const struct ini_key rig_keys[] = {
    {.name = "name", .type = INI_TEXT, .offset = offsetof(struct rig, name), .help = "its name"},
    {.name = "tags",
     .type = INI_TEXT_LIST,
     .fallback = "none",
     .offset = offsetof(struct rig, tags),
     .help = "words"},
    {.name = "focal_mm",
     .type = INI_DECIMAL_LIST,
     .fallback = "4.5, 50",
     .min = "0.1",
     .max = "1000",
     .numerator = 1000,
     .offset = offsetof(struct rig, table),
     .help = "focal lengths"},
};

static const struct ini_key axis_keys[] = {
    {.name = "limit_min_deg",
     .type = INI_DECIMAL,
     .min = "-360",
     .max = "360",
     .numerator = UINT64_C(1) << 48,
     .denominator = 360,
     .offset = offsetof(struct axis, limit_min_q48),
     .help = "lowest angle"},
    {.name = "steps",
     .type = INI_WHOLE,
     .fallback = "4096",
     .min = "1",
     .offset = offsetof(struct axis, steps),
     .help = "steps of the encoder"},
    {.name = "reversed",
     .type = INI_YES_NO,
     .fallback = "no",
     .offset = offsetof(struct axis, reversed),
     .help = "turns the other way"},
    {.name = "drive",
     .type = INI_CHOICE,
     .fallback = "fake",
     .choices = drives,
     .offset = offsetof(struct axis, drive),
     .help = "what moves it"},
};

static const struct ini_key event_keys[] = {
    {.name = "at_s",
     .type = INI_DECIMAL,
     .min = "0",
     .numerator = 1000000,
     .offset = offsetof(struct event, at_us),
     .help = "when"},
    {.name = "do", .type = INI_TEXT, .offset = offsetof(struct event, action), .help = "what"},
};

static const struct ini_section sections[] = {
    {.name = "rig", .keys = rig_keys, .key_count = 3, .help = "the whole"},
    {.name = "pan",
     .keys = axis_keys,
     .key_count = 4,
     .offset = offsetof(struct rig, pan),
     .help = "the pan axis"},
    {.name = "zoom",
     .presence = INI_OPTIONAL,
     .seen_offset = offsetof(struct rig, has_zoom),
     .keys = axis_keys,
     .key_count = 4,
     .offset = offsetof(struct rig, zoom),
     .help = "the lens"},
    {.name = "event",
     .presence = INI_MANY,
     .keys = event_keys,
     .key_count = 2,
     .offset = offsetof(struct rig, events),
     .seen_offset = offsetof(struct rig, event_count),
     .stride = sizeof(struct event),
     .most = 2,
     .label_offset = offsetof(struct event, label),
     .help = "something happens"},
};

static const struct ini_schema schema = {sections, sizeof sections / sizeof *sections};

/// Reads and applies a text; the caller frees the file.
static enum exit_status load(const char *text, struct ini *ini, struct rig *rig) {
    FILE *const stream = messages_input(text, strlen(text));
    memset(rig, 0x5A, sizeof *rig); // what is not stored is noticed
    enum exit_status status = ini_read_stream(stream, "f", ini);
    fclose(stream);
    if (status == EXIT_STATUS_OK) {
        status = ini_apply(ini, &schema, rig);
    }
    return status;
}

// ---------------------------------------------------------------- good files

#define GOOD "[rig]\nname = r\n[pan]\nlimit_min_deg = -170.5\n"

static void a_whole_file(void) {
    struct ini ini;
    struct rig rig;
    struct messages messages;
    messages_start(&messages);
    CHECK_EQ(load("\xEF\xBB\xBF# rig\r\n"
                  "[rig]  ; the rig\r\n"
                  "  name\t=  tower 7, north=up#1 # not;this \r\n"
                  "tags = a, b c ,d\n"
                  "focal_mm = 0.1,2.0005,1e3\n"
                  "\n"
                  "[ pan ]\n"
                  "limit_min_deg = -90\n"
                  "steps=65536\n"
                  "reversed = yes\n"
                  "drive = rmd\n"
                  "[event  lights  out ]\n"
                  "at_s = 1.5\n"
                  "do = dim ; and so on\n"
                  "[event last]\n"
                  "at_s = 0.0000005\n"
                  "do = stop",
                  &ini, &rig),
             EXIT_STATUS_OK);
    messages_were(&messages, "");
    CHECK(strcmp(rig.name, "tower 7, north=up#1") == 0);
    CHECK_EQ(rig.tags.count, 3);
    CHECK(strcmp(rig.tags.item[0], "a") == 0 && strcmp(rig.tags.item[1], "b c") == 0 &&
          strcmp(rig.tags.item[2], "d") == 0);
    CHECK_EQ(rig.table.count, 3);
    CHECK_EQ(rig.table.item[0], 100);
    CHECK_EQ(rig.table.item[1], 2001); // 2000.5, away from zero
    CHECK_EQ(rig.table.item[2], 1000000);
    CHECK_EQ(rig.pan.limit_min_q48, -(INT64_C(1) << 46));
    CHECK_EQ(rig.pan.steps, 65536);
    CHECK(rig.pan.reversed && rig.pan.drive == 0);
    CHECK(!rig.has_zoom);
    CHECK_EQ(rig.event_count, 2);
    CHECK(strcmp(rig.events[0].label, "lights  out") == 0);
    CHECK_EQ(rig.events[0].at_us, 1500000);
    CHECK(strcmp(rig.events[0].action, "dim") == 0);
    CHECK(strcmp(rig.events[1].label, "last") == 0);
    CHECK_EQ(rig.events[1].at_us, 1);
    ini_free(&ini);
}

static void defaults(void) {
    struct ini ini;
    struct rig rig;
    CHECK_EQ(load(GOOD, &ini, &rig), EXIT_STATUS_OK);
    CHECK_EQ(rig.pan.limit_min_q48, INT64_C(-133309676469908)); // round(-170.5 * 2^48 / 360)
    CHECK_EQ(rig.pan.steps, 4096);
    CHECK(!rig.pan.reversed && rig.pan.drive == 2);
    CHECK(!rig.has_zoom && rig.zoom.steps == 4096 && rig.zoom.drive == 2);
    CHECK_EQ(rig.table.count, 2);
    CHECK_EQ(rig.table.item[0], 4500);
    CHECK_EQ(rig.event_count, 0);
    ini_free(&ini);
    CHECK_EQ(load(GOOD "[zoom]\nlimit_min_deg=0\nsteps = 1\n", &ini, &rig), EXIT_STATUS_OK);
    CHECK(rig.has_zoom && rig.zoom.limit_min_q48 == 0 && rig.zoom.steps == 1);
    ini_free(&ini);
}

// ---------------------------------------------------------------- bad files

static void rejects(const char *text, const char *wanted) {
    struct ini ini;
    struct rig rig;
    struct messages messages;
    messages_start(&messages);
    CHECK_EQ(load(text, &ini, &rig), EXIT_STATUS_USAGE);
    if (!messages_were(&messages, wanted)) {
        printf("  for: %s\n", text);
    }
    ini_free(&ini);
}

static void bad_lines(void) {
    rejects("[rig\n", "f:1: a section ends with ]\n");
    rejects("[]\n", "f:1: a section without a name\n");
    rejects("[ ]\n", "f:1: a section without a name\n");
    rejects("[rig] name = 1\n", "f:1: a section ends with ]\n");
    rejects("name = 1\n", "f:1: key 'name' before the first [section]\n");
    rejects("[rig]\nname\n", "f:2: 'name' is neither [section] nor key = value\n");
    rejects("[rig]\n= 4\n", "f:2: '= 4' is neither [section] nor key = value\n");
    rejects("[rig]\nname =  # none\n", "f:2: key 'name': there is no value\n");
    rejects("[rig]\nname = a\nname = b\n", "f:3: key 'name' is there twice, first on line 2\n");
    rejects("[rig]\nname = a\n\n[rig]\n", "f:4: section 'rig' is there twice, first on line 1\n");
    rejects("[event a]\n[event b]\n[event a]\n",
            "f:3: section 'event a' is there twice, first on line 1\n");
    // All faulty lines are told, each once.
    rejects("x\n[rig]\ny\nname = a\nname = b\n",
            "f:1: 'x' is neither [section] nor key = value\n"
            "f:3: 'y' is neither [section] nor key = value\n"
            "f:5: key 'name' is there twice, first on line 4\n");
}

static void unknown_and_missing_names(void) {
    rejects(GOOD "[pam]\nx = 1\n", "f:5: unknown section 'pam', did you mean 'pan'?\n");
    rejects(GOOD "[lights]\nx = 1\n", "f:5: unknown section 'lights'\n");
    rejects(GOOD "limit_mn_deg = 1\n",
            "f:5: unknown key 'limit_mn_deg' in [pan], did you mean 'limit_min_deg'?\n");
    rejects(GOOD "volume = 1\n", "f:5: unknown key 'volume' in [pan]\n");
    rejects(GOOD "Steps = 1\n", "f:5: unknown key 'Steps' in [pan], did you mean 'steps'?\n");
    rejects("[rig]\nname = a\n", "f: section [pan] is missing: the pan axis\n");
    rejects("[pan]\n\n[rig]\nname = a\n",
            "f:1: key 'limit_min_deg' is missing in [pan]: lowest angle\n");
    rejects("", "f: section [rig] is missing: the whole\n"
                "f: section [pan] is missing: the pan axis\n");
    rejects(GOOD "[zoom]\n", "f:5: key 'limit_min_deg' is missing in [zoom]: lowest angle\n");
    rejects(GOOD "[event]\nat_s = 1\ndo = x\n", "f:5: section [event NAME] needs a name\n");
    rejects("[rig r]\n" GOOD, "f:1: section [rig] takes no name\n");
    rejects(GOOD "[event a]\nat_s=1\ndo=x\n[event b]\nat_s=1\ndo=x\n[event c]\nat_s=1\ndo=x\n",
            "f:11: more than 2 sections [event NAME]\n");
}

#define PAN_ONLY "[pan]\nlimit_min_deg = 0\n"
#define PAN      "[rig]\nname = r\n" PAN_ONLY

static void bad_values(void) {
    rejects(PAN "steps = many\n", "f:5: key 'steps': 'many' is not a decimal number\n");
    rejects(PAN "steps = nan\n", "f:5: key 'steps': 'nan' is not a decimal number\n");
    rejects(PAN "steps = 0x10\n", "f:5: key 'steps': '0x10' is not a decimal number\n");
    rejects(PAN "steps = 1.5\n", "f:5: key 'steps': '1.5' is not a whole number\n");
    rejects(PAN "steps = 0\n", "f:5: key 'steps': '0' is below 1\n");
    rejects(PAN "steps = 0.99999999999999999999999999\n",
            "f:5: key 'steps': '0.99999999999999999999999999' is not a whole number\n");
    rejects(PAN "steps = 9223372036854775808\n",
            "f:5: key 'steps': '9223372036854775808' is too large\n");
    rejects(PAN "reversed = true\n", "f:5: key 'reversed': 'true' is neither yes nor no\n");
    rejects(PAN "drive = RMD\n", "f:5: key 'drive': 'RMD' is none of rmd, pwm, fake\n");
    rejects("[rig]\nname=r\n[pan]\nlimit_min_deg = -360.0000000000000000000000001\n",
            "f:4: key 'limit_min_deg': '-360.0000000000000000000000001' is below -360\n");
    rejects("[rig]\nname=r\nfocal_mm = 4, 2000\n" PAN_ONLY,
            "f:3: key 'focal_mm': '2000' is above 1000\n");
    rejects("[rig]\nname=r\nfocal_mm = 4,,5\n" PAN_ONLY,
            "f:3: key 'focal_mm': an empty item in the list\n");
    rejects("[rig]\nname=r\ntags = a,\n" PAN_ONLY, "f:3: key 'tags': an empty item in the list\n");
    rejects(PAN "steps = 0\nreversed = 1\n", "f:5: key 'steps': '0' is below 1\n"
                                             "f:6: key 'reversed': '1' is neither yes nor no\n");
}

static void the_largest_values_fit(void) {
    struct ini ini;
    struct rig rig;
    CHECK_EQ(load(PAN "steps = 9223372036854775807\n", &ini, &rig), EXIT_STATUS_OK);
    CHECK_EQ(rig.pan.steps, INT64_MAX);
    ini_free(&ini);
    CHECK_EQ(load(PAN "steps = 1.000e3\n", &ini, &rig), EXIT_STATUS_OK);
    CHECK_EQ(rig.pan.steps, 1000);
    ini_free(&ini);
}

static void lists_and_files_have_an_end(void) {
    char text[4096] = "[rig]\nname=r\ntags = 0";
    for (int i = 1; i < INI_LIST_MOST; i++) {
        strcat(text, ",1");
    }
    const size_t size = strlen(text);
    strcpy(text + size, "\n[pan]\nlimit_min_deg = 0\n");
    struct ini ini;
    struct rig rig;
    CHECK_EQ(load(text, &ini, &rig), EXIT_STATUS_OK);
    CHECK_EQ(rig.tags.count, INI_LIST_MOST);
    ini_free(&ini);
    strcpy(text + size, ",2\n[pan]\nlimit_min_deg = 0\n");
    rejects(text, "f:3: key 'tags': more than 64 items\n");
    char *const many = malloc(20U * INI_KEYS_MOST);
    size_t at = 0;
    for (int i = 0; i <= INI_KEYS_MOST; i++) {
        at += (size_t)sprintf(many + at, "[a%d]\n", i);
    }
    rejects(many, "f:4097: more than 4096 keys or sections\n");
    free(many);
}

// ---------------------------------------------------------------- after reading

static void checks_across_keys_name_the_line(void) {
    struct ini ini;
    struct rig rig;
    struct messages messages;
    CHECK_EQ(load(GOOD "[event e]\nat_s = 2\ndo = x\n", &ini, &rig), EXIT_STATUS_OK);
    messages_start(&messages);
    ini_complain(&ini, "pan", "", "limit_min_deg", "%s %d", "above limit_max_deg", 7);
    ini_complain(&ini, "pan", "", "steps", "a default");
    ini_complain(&ini, "event", "e", "at_s", "too late");
    ini_complain(&ini, "zoom", "", "steps", "no such section");
    messages_were(&messages, "f:4: key 'limit_min_deg': above limit_max_deg 7\n"
                             "f:3: key 'steps': a default\n"
                             "f:6: key 'at_s': too late\n"
                             "f: key 'steps': no such section\n");
    ini_free(&ini);
}

static void explanation(void) {
    struct ini ini;
    struct rig rig;
    CHECK_EQ(load(GOOD "[event e]\nat_s = 2\ndo = x\n", &ini, &rig), EXIT_STATUS_OK);
    char *text;
    size_t size;
    FILE *const stream = open_memstream(&text, &size);
    ini_explain(&ini, &schema, stream);
    fclose(stream);
    const char *const wanted =
        "[rig]  the whole\n"
        "  name                     = r                line 2     its name\n"
        "  tags                     = none             default    words\n"
        "  focal_mm                 = 4.5, 50          default    focal lengths; 0.1 to 1000\n"
        "\n[pan]  the pan axis\n"
        "  limit_min_deg            = -170.5           line 4     lowest angle; -360 to 360\n"
        "  steps                    = 4096             default    steps of the encoder; 1 or more\n"
        "  reversed                 = no               default    turns the other way; yes or no\n"
        "  drive                    = fake             default    what moves it; one of rmd, pwm, "
        "fake\n"
        "\n[event e]  something happens\n"
        "  at_s                     = 2                line 6     when; 0 or more\n"
        "  do                       = x                line 7     what\n";
    if (!CHECK(strcmp(text, wanted) == 0)) {
        printf("%s", text);
    }
    free(text);
    ini_free(&ini);
}

/// Any bytes: a verdict, never a crash, and a message exactly where there is a fault.
static void noise(void) {
    static const char *const words[] = {"[",
                                        "]",
                                        "=",
                                        "\n",
                                        " ",
                                        "#",
                                        ";",
                                        "name",
                                        "pan",
                                        "rig",
                                        "\n[rig]\nname = y\n[pan]\nlimit_min_deg = 1\n",
                                        ",",
                                        "\n[pan]\n",
                                        "steps = 3\n",
                                        "\nlimit_min_deg = 2\n",
                                        "\n[rig]\nname = x\n"};
    uint64_t seed = UINT64_C(0x9C4A1B7D33E2F051);
    int good = 0;
    for (int i = 0; i < 30000 && check_clean(); i++) {
        char text[1024] = "";
        const int count = (int)(check_random(&seed) % 24U);
        for (int j = 0; j < count; j++) {
            strcat(text, words[check_random(&seed) % 16U]);
        }
        struct ini ini;
        struct rig rig;
        struct messages messages;
        messages_start(&messages);
        const enum exit_status status = load(text, &ini, &rig);
        fflush(messages.stream);
        CHECK_EQ(messages.size != 0U, status == EXIT_STATUS_USAGE);
        good += status == EXIT_STATUS_OK ? 1 : 0;
        message_stream(NULL);
        fclose(messages.stream);
        free(messages.text);
        ini_free(&ini);
    }
    check_note("good files in noise", good);
    CHECK(good > 20);
}

int main(void) {
    TEST(a_whole_file);
    TEST(defaults);
    TEST(bad_lines);
    TEST(unknown_and_missing_names);
    TEST(bad_values);
    TEST(the_largest_values_fit);
    TEST(lists_and_files_have_an_end);
    TEST(checks_across_keys_name_the_line);
    TEST(explanation);
    TEST(noise);
    return check_finish();
}
