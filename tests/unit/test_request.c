/// link/request: commands and targets as they are typed, and every way to get them wrong.
#include "check.h"

#include "link/request.h"

static struct request request;
static struct target_update update;

static uint32_t size_of(const char *text) {
    uint32_t size = 0;
    while (text[size] != '\0') {
        size++;
    }
    return size;
}

static bool reads(const char *text, enum request_kind kind) {
    return request_read(text, size_of(text), &request) == NULL && request.kind == kind;
}

static bool says(const char *text, const char *wanted) {
    const char *wrong = request_read(text, size_of(text), &request);
    if (wrong == NULL) {
        return false;
    }
    while (*wanted != '\0' && *wrong == *wanted) {
        wrong++;
        wanted++;
    }
    return *wanted == '\0';
}

static bool target(const char *text) {
    return request_read_target(text, size_of(text), &update) == NULL;
}

static void words_alone(void) {
    CHECK(reads("help", REQUEST_HELP) && reads("status", REQUEST_STATUS));
    CHECK(reads(" arm ", REQUEST_ARM) && reads("stop", REQUEST_STOP) &&
          reads("home", REQUEST_HOME));
    CHECK(says("", "no such command") && says("  ", "no such command"));
    CHECK(says("ar", "no such command") && says("armed", "no such command"));
    CHECK(says("Arm", "no such command") && says("arm now", "expected nothing"));
    for (uint32_t i = 0; request_help(i) != NULL; i++) {
        CHECK(size_of(request_help(i)) <= 80U);
    }
}

static void pans(void) {
    CHECK(reads("pan 2 3.5 angle", REQUEST_PAN));
    CHECK(request.choice.one_object && request.choice.object == 2U);
    CHECK_EQ(request.duration_us, 3500000);
    CHECK_EQ(request.path, PAN_BY_ANGLE);
    CHECK(reads("pan all 0", REQUEST_PAN));
    CHECK(!request.choice.one_object && request.duration_us == 0U);
    CHECK_EQ(request.path, PAN_BY_SUM);
    CHECK(reads("pan 65535 3600 sum", REQUEST_PAN));
    CHECK_EQ(request.duration_us, 3600000000);
    static const char *const wrong[] = {"pan",          "pan 1",          "pan 65536 1",
                                        "pan -1 1",     "pan 1 -1",       "pan 1 3601",
                                        "pan 1 2 line", "pan 1 2 sum 3",  "pan one 2",
                                        "pan all all",  "pan 1 2 angle x"};
    for (unsigned i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        CHECK(says(wrong[i], "expected OBJECT or all, SECONDS"));
    }
}

static void aims(void) {
    CHECK(reads("aim 90 0", REQUEST_AIM));
    CHECK(request.update.id == REQUEST_AIM_ID && request.update.kind == TARGET_DIRECTION);
    CHECK_EQ(request.update.direction.x, Q30_ONE);
    CHECK_EQ(request.update.direction.y, 0);
    CHECK(reads("aim 0 -90 2.5", REQUEST_AIM));
    CHECK_EQ(request.update.direction.z, -Q30_ONE);
    CHECK_EQ(request.update.radius_bam32, 29826162); // 2.5 / 360 * 2^32 = 29826161.7
    CHECK(reads("aim -45 30", REQUEST_AIM));
    CHECK_NEAR(request.update.direction.x, -657529896, 2); // -sin 45 cos 30 * 2^30
    CHECK_NEAR(request.update.direction.y, 657529896, 2);
    CHECK_NEAR(request.update.direction.z, 536870912, 2);
    CHECK(reads("aim 360 90 89.999999", REQUEST_AIM));
    static const char *const wrong[] = {"aim",        "aim 1",      "aim 361 0", "aim 0 90.000001",
                                        "aim 0 0 90", "aim 0 0 -1", "aim a b",   "aim 1 2 3 4"};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK(says(wrong[i], "expected PAN TILT"));
    }
}

static void targets(void) {
    CHECK(reads("target 7 1.5 -2 0.000001", REQUEST_UPDATE));
    CHECK(request.update.kind == TARGET_POSITION && request.update.id == 7U);
    CHECK_EQ(request.update.position_um.x, 1500000);
    CHECK_EQ(request.update.position_um.y, -2000000);
    CHECK_EQ(request.update.position_um.z, 1);
    CHECK_EQ(request.update.weight_q16, TARGET_WEIGHT_ONE_Q16);
    CHECK(target("4294967294 0 0 1 .5 2.5 65535"));
    CHECK(update.radius_um == 500000U && update.weight_q16 == 163840U && update.object == 65535U);
    CHECK(target("8 dir 0 0 -3 1 0"));
    CHECK(update.kind == TARGET_DIRECTION && update.direction.z < -(INT32_C(1) << 29));
    CHECK_EQ(update.radius_bam32, 11930465);
    CHECK_EQ(update.weight_q16, 0);
    CHECK(target("9 gone") && update.kind == TARGET_GONE && update.id == 9U);
    CHECK(reads("gone 9", REQUEST_UPDATE) && request.update.kind == TARGET_GONE);
    static const char *const wrong[] = {"",
                                        "7",
                                        "7 1 2",
                                        "-1 0 0 1",
                                        "4294967295 0 0 1",
                                        "4294967295 gone",
                                        "7 gone 1",
                                        "7 dir 0 0 0",
                                        "7 dir 0 0 1000.1",
                                        "7 dir 1 0",
                                        "7 dir 1 0 0 90",
                                        "7 1 2 3 -1",
                                        "7 1 2 3 4000.1",
                                        "7 1 2 3 0 65536",
                                        "7 1 2 3 0 1 65536",
                                        "7 1 2 3 0 1 1.5",
                                        "7 1 2 3 0 1 2 3",
                                        "7 4503599627.370497 0 0",
                                        "7 1 2 nan"};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK(!target(wrong[i]));
    }
    CHECK(says("gone", "expected a number") && says("gone 1 2", "expected one number"));
}

/// However large or small the numbers are, the direction is theirs.
static void directions(void) {
    static const char *const same[] = {"1 dir 1 2 -3", "1 dir .000000001 .000000002 -.000000003",
                                       "1 dir 300 600 -900", "1 dir .333 .666 -.999"};
    for (unsigned i = 0; i < sizeof same / sizeof same[0]; i++) {
        CHECK(target(same[i]));
        const struct vec3 d = update.direction;
        CHECK(d.z < -(INT32_C(1) << 29));
        CHECK_NEAR((int64_t)d.x * -3, d.z, 8);
        CHECK_NEAR((int64_t)d.y * -3, (int64_t)d.z * 2, 8);
    }
}

static void settings_and_trace(void) {
    CHECK(reads("get", REQUEST_GET) && request.name.size_bytes == 0U);
    CHECK(reads("get pan.speed_max_dps", REQUEST_GET) &&
          word_is(request.name, "pan.speed_max_dps"));
    CHECK(says("get a b", "expected one name"));
    CHECK(reads("set a -1.5", REQUEST_SET) && request.value_micro == -1500000);
    CHECK(says("set a", "expected NAME VALUE") && says("set a 1 2", "expected NAME VALUE"));
    CHECK(says("set a b", "expected a number") && says("set a 1000000.1", "expected a number"));
    CHECK(reads("trace on", REQUEST_TRACE) && request.on && request.period_ms == 1000U);
    CHECK(reads("trace on 10", REQUEST_TRACE) && request.period_ms == 10U);
    CHECK(reads("trace off", REQUEST_TRACE) && !request.on);
    static const char *const wrong[] = {"trace",          "trace 5",      "trace on 9",
                                        "trace on 60001", "trace off 10", "trace on 10 10"};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CHECK(says(wrong[i], "expected on or off"));
    }
}

/// Bytes of all kinds: some answer, and never a motion but by its name.
static void any_bytes(void) {
    uint64_t state = 4711;
    check_note("seed", (int64_t)state);
    char text[64];
    for (uint32_t i = 0; i < 200000U; i++) {
        const uint32_t size = (uint32_t)(check_random(&state) % sizeof text);
        for (uint32_t at = 0; at < size; at++) {
            text[at] = (char)(check_random(&state) >> 40);
        }
        if (request_read(text, size, &request) == NULL) {
            CHECK_EQ(request.kind, -1);
        }
        (void)!request_read_target(text, size, &update);
    }
}

int main(void) {
    TEST(words_alone);
    TEST(pans);
    TEST(aims);
    TEST(targets);
    TEST(directions);
    TEST(settings_and_trace);
    TEST(any_bytes);
    return check_finish();
}
