/// The reader of points: what it takes, and the one line that it says of what it does not take.
#include "check.h"
#include "support/messages.h"

#include "lines.h"
#include "points.h"

#include <time.h>

static enum exit_status read_sized(const char *text, size_t size,
                                   const struct points_format *format, struct points *out) {
    FILE *const stream = messages_input(text, size);
    const enum exit_status status = points_read_stream(stream, "f", format, out);
    fclose(stream);
    return status;
}

static enum exit_status read_points(const char *text, const struct points_format *format,
                                    struct points *out) {
    return read_sized(text, strlen(text), format, out);
}

static bool is(const struct points *points, uint32_t i, int32_t x, int32_t y, int32_t z) {
    return CHECK(i < points->count) && CHECK_EQ(points->directions[i].x, x) &&
           CHECK_EQ(points->directions[i].y, y) && CHECK_EQ(points->directions[i].z, z);
}

static const struct points_format xyz = {.input = POINTS_XYZ};
static const struct points_format q30 = {.input = POINTS_Q30};
static const struct points_format radec = {.input = POINTS_RADEC};

static void layouts(void) {
    static const char *const same[] = {
        "1 2 3\n4 5 6\n",
        "1 2 3\n4 5 6",                    // no end of the last line
        "1 2 3\r\n4 5 6\r\n",              // CR LF
        "\xEF\xBB\xBF\x31 2 3\n4 5 6\n",   // byte order mark
        "\xEF\xBB\xBF# c\n1 2 3\n4 5 6\n", // and behind it a comment
        "1\t2\t3\n4\t\t5 \t6\n",           // tabs
        "1,2,3\n4, 5 ,6\n",                // commas
        "# a comment\n\n   \n1 2 3# c\n\t\n4 5 6 # , , ,\n#\n",
        "  1 2 3  \n\t4 5 6\t\n",
        "+1 2. 3.0\n4e0 0.5e1 600E-2\n",
    };
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        struct points points;
        if (CHECK_EQ(read_points(same[i], &xyz, &points), EXIT_STATUS_OK) &&
            CHECK_EQ(points.count, 2)) {
            // The last layout has decimals: 3.0 and 600E-2 are integers all the same.
            is(&points, 0, 1, 2, 3);
            is(&points, 1, 4, 5, 6);
        }
        if (!check_clean()) {
            printf("  layout %zu\n", i);
        }
        points_free(&points);
    }
    struct points none;
    CHECK_EQ(read_points("", &xyz, &none), EXIT_STATUS_OK);
    CHECK_EQ(none.count, 0);
    CHECK_EQ(read_points("# nothing\n\n", &xyz, &none), EXIT_STATUS_OK);
    CHECK_EQ(none.count, 0);
    points_free(&none);
}

/// The text can't be read, and this is what is said.
static void rejects(const char *text, const struct points_format *format, const char *wanted) {
    struct messages messages;
    struct points points;
    messages_start(&messages);
    CHECK_EQ(read_points(text, format, &points), EXIT_STATUS_USAGE);
    if (!messages_were(&messages, wanted)) {
        printf("  for: %s\n", text);
    }
    points_free(&points);
}

static void bad_decimals(void) {
    rejects("1 2 3\n1 x 3\n", &xyz, "f:2: 'x' is not a decimal number\n");
    rejects("nan 0 1\n", &xyz, "f:1: 'nan' is not a decimal number\n");
    rejects("0 inf 1\n", &xyz, "f:1: 'inf' is not a decimal number\n");
    rejects("0 1 -Infinity\n", &xyz, "f:1: '-Infinity' is not a decimal number\n");
    rejects("0x10 0 1\n", &xyz, "f:1: '0x10' is not a decimal number\n");
    rejects("1;2;3 0 1\n", &xyz, "f:1: '1;2;3' is not a decimal number\n");
    rejects("1e401 0 1\n", &xyz, "f:1: '1e401' has digits above 10^400 or below 10^-1100\n");
    rejects("0 0 1e-1101\n", &xyz, "f:1: '1e-1101' has digits above 10^400 or below 10^-1100\n");
    rejects("x,y,z\n1,2,3\n", &xyz, "f:1: 'x' is not a decimal number\n"); // a header
    // What is quoted can't play with the terminal, and is not endless.
    rejects("1 2 \x1b[2J\n", &xyz, "f:1: '?[2J' is not a decimal number\n");
    rejects("1 2 \xff\xfe\n", &xyz, "f:1: '?\?' is not a decimal number\n");
    rejects("1 2 \xc3\xa9\n", &xyz, "f:1: '\xc3\xa9' is not a decimal number\n");
    rejects("1 2 aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\n", &xyz,
            "f:1: 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...' is not a decimal number\n");
}

static void bad_columns(void) {
    rejects("1 2\n", &xyz, "f:1: 2 columns, not 3 (x y z)\n");
    rejects("\n\n1 2 3 4\n", &xyz, "f:3: 4 columns, not 3 (x y z)\n");
    rejects("1 2 3 4 5 6 7 8\n", &xyz, "f:1: 8 columns, not 3 (x y z)\n");
    rejects("7\n", &radec, "f:1: 1 column, not 2 (right ascension, declination)\n");
    rejects("1 2 3\n", &radec, "f:1: 3 columns, not 2 (right ascension, declination)\n");
    const char *const empty = "f:1: an empty column: a comma without a value beside it\n";
    rejects("1,,2,3\n", &xyz, empty);
    rejects(",1,2,3\n", &xyz, empty);
    rejects("1,2,3,\n", &xyz, empty);
    rejects("1, ,2\n", &xyz, empty);
    rejects(",\n", &xyz, empty);
}

static void bad_directions(void) {
    rejects("0 0 0\n", &xyz, "f:1: the point is at the viewpoint: it has no direction\n");
    rejects("-0 0.000 0e7\n", &xyz, "f:1: the point is at the viewpoint: it has no direction\n");
    rejects("0 0 0\n", &q30, "f:1: the zero vector has no direction\n");
    rejects("2147483648 0 0\n", &q30,
            "f:1: '2147483648' does not fit int32 (-2147483648 to 2147483647)\n");
    rejects("0 -2147483649 0\n", &q30,
            "f:1: '-2147483649' does not fit int32 (-2147483648 to 2147483647)\n");
    rejects("0 0 99999999999999999999999999\n", &q30,
            "f:1: '99999999999999999999999999' does not fit int32 (-2147483648 to 2147483647)\n");
    rejects("1.0 0 0\n", &q30, "f:1: '1.0' is not an integer\n");
    rejects("0 1e3 0\n", &q30, "f:1: '1e3' is not an integer\n");
    rejects("0 0 -\n", &q30, "f:1: '-' is not an integer\n");
    rejects("0 90.0001\n", &radec, "f:1: declination '90.0001' is beyond 90 degrees\n");
    rejects("0 -90.0000000000000000000000000000000000001\n", &radec,
            "f:1: declination '-90.0000000000000000000000000000000000001' is beyond 90 degrees\n");
    rejects("0 1e300\n", &radec, "f:1: declination '1e300' is beyond 90 degrees\n");
    rejects("1e10 5\n", &radec, "f:1: right ascension '1e10' is beyond 10^10 degrees\n");
}

static void lines_that_are_no_text(void) {
    static char text[LINES_MOST + 100];
    struct messages messages;
    struct points points;
    memset(text, ' ', sizeof text);
    memcpy(text, "1 2 3", 5);
    messages_start(&messages);
    text[LINES_MOST] = '\n'; // the longest line
    CHECK_EQ(read_sized(text, LINES_MOST + 1, &xyz, &points), EXIT_STATUS_OK);
    is(&points, 0, 1, 2, 3);
    points_free(&points);
    messages_were(&messages, "");
    for (size_t more = 1; more < 90; more += 44) {
        messages_start(&messages);
        text[LINES_MOST] = ' ';
        CHECK_EQ(read_sized(text, LINES_MOST + more, &xyz, &points), EXIT_STATUS_USAGE);
        messages_were(&messages, "f:1: the line is longer than 8191 bytes\n");
        points_free(&points);
    }
    messages_start(&messages);
    CHECK_EQ(read_sized("1 2 3\n1 \0 2\n", 12, &xyz, &points), EXIT_STATUS_USAGE);
    messages_were(&messages, "f:2: a NUL byte: this is no text file\n");
    points_free(&points);
}

static void nothing_is_half_done(void) {
    // A fault anywhere fails the whole file, also behind many good lines that straddle buffers.
    enum { LINES = 20000 };
    char *const text = malloc(LINES * 16 + 16);
    size_t size = 0;
    for (int i = 1; i <= LINES; i++) {
        size += (size_t)sprintf(text + size, "%d 2 %d\n", i, -i);
    }
    struct points points;
    CHECK_EQ(read_sized(text, size, &xyz, &points), EXIT_STATUS_OK);
    CHECK_EQ(points.count, LINES);
    for (int i = 1; i <= LINES && check_clean(); i++) {
        is(&points, (uint32_t)i - 1U, i, 2, -i);
    }
    points_free(&points);
    memcpy(text + size, "1 2\n", 5);
    rejects(text, &xyz, "f:20001: 2 columns, not 3 (x y z)\n");
    free(text);
}

static void names(void) {
    const struct points_format named = {.input = POINTS_XYZ, .named = true};
    struct points points;
    CHECK_EQ(read_points("nose 1 2 3\n7,4,5,6 # seven\nBig\xc3\x84r -1 0 0\n", &named, &points),
             EXIT_STATUS_OK);
    CHECK_EQ(points.count, 3);
    CHECK(strcmp(points_name(&points, 0), "nose") == 0);
    CHECK(strcmp(points_name(&points, 1), "7") == 0);
    CHECK(strcmp(points_name(&points, 2), "Big\xc3\x84r") == 0);
    is(&points, 1, 4, 5, 6);
    points_free(&points);
    rejects("1 2 3\n", &named, "f:1: 3 columns, not 4 (name x y z)\n");
    const struct points_format star = {.input = POINTS_RADEC, .named = true};
    rejects("1 2\n", &star, "f:1: 2 columns, not 3 (name, right ascension, declination)\n");
}

static void the_viewpoint(void) {
    struct triple viewpoint;
    CHECK(points_read_triple("0.1,0.2, -0.3", &viewpoint) == NULL && viewpoint.given);
    struct points_format format = {.input = POINTS_XYZ};
    memcpy(format.viewpoint, viewpoint.component, sizeof format.viewpoint);
    struct points points;
    CHECK_EQ(read_points("0.3 0.2 0.3\n0.1 0.2 -1000000\n", &format, &points), EXIT_STATUS_OK);
    is(&points, 0, 2, 0, 6);
    is(&points, 1, 0, 0, -9999997);
    points_free(&points);
    rejects("0.10 2e-1 -.3\n", &format,
            "f:1: the point is at the viewpoint: it has no direction\n");
    static const char *const bad[] = {"",     "1",     "1,2",    "1,2,3,4",
                                      "1,,2", "a,b,c", "1,2,3,", "1,2,x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(points_read_triple(bad[i], &viewpoint) != NULL);
    }
}

static void q30_is_used_as_given(void) {
    struct points points;
    CHECK_EQ(read_points("-2147483648 +2147483647 0\n2 4 6\n", &q30, &points), EXIT_STATUS_OK);
    is(&points, 0, INT32_MIN, INT32_MAX, 0);
    is(&points, 1, 2, 4, 6);
    CHECK(points.fine_exact && points.fine_error_rad == 0);
    points_free(&points);
}

/// Any bytes at all: a verdict, never a crash (the sanitizers watch), and no message without a
/// fault.
static void noise(void) {
    static const char *const words[] = {"1",   " ",       "\n",   "-",     ".",    "e",
                                        ",",   "#",       "\t",   "9 8 7", "\r\n", "0",
                                        "1e5", "4 5 6\n", "\xff", "1.5 "};
    static const enum points_input inputs[] = {POINTS_XYZ, POINTS_Q30, POINTS_RADEC};
    uint64_t seed = UINT64_C(0x2F8F6C3A91D7B04D);
    int good = 0;
    for (int i = 0; i < 30000 && check_clean(); i++) {
        char text[256] = "";
        const int count = (int)(check_random(&seed) % 30U);
        for (int j = 0; j < count; j++) {
            strcat(text, words[check_random(&seed) % 16U]);
        }
        const struct points_format format = {.input = inputs[check_random(&seed) % 3U],
                                             .named = check_random(&seed) % 4U == 0U};
        struct messages messages;
        struct points points;
        messages_start(&messages);
        const enum exit_status status = read_points(text, &format, &points);
        CHECK(status == EXIT_STATUS_OK || status == EXIT_STATUS_USAGE);
        fflush(messages.stream);
        CHECK_EQ(messages.size != 0U, status == EXIT_STATUS_USAGE);
        for (uint32_t p = 0; status == EXIT_STATUS_OK && p < points.count; p++) {
            good++;
            CHECK(!vec3_is_zero(points.directions[p]));
        }
        message_stream(NULL);
        fclose(messages.stream);
        free(messages.text);
        points_free(&points);
    }
    check_note("points in noise", good);
    CHECK(good > 100);
}

static void speed(void) {
    enum { LINES = 200000 };
    char *text;
    size_t size;
    FILE *const written = open_memstream(&text, &size);
    uint64_t seed = 1;
    for (int i = 0; i < LINES; i++) {
        const int x = (int)(check_random(&seed) % 1000000U);
        const int y = (int)(check_random(&seed) % 1000000U);
        fprintf(written, "%d.%06d %d.%06d 2.5\n", x % 100, x, y % 100 - 50, y);
    }
    fclose(written);
    struct points points;
    const clock_t start = clock();
    CHECK_EQ(read_sized(text, size, &xyz, &points), EXIT_STATUS_OK);
    const clock_t end = clock();
    free(text);
    CHECK_EQ(points.count, LINES);
    points_free(&points);
    const int64_t nanoseconds = (end - start) * (INT64_C(1000000000) / CLOCKS_PER_SEC) / LINES;
    check_note("nanoseconds a line", nanoseconds);
    CHECK(nanoseconds < 20000); // a loose bound: sanitizers and a busy machine run this too
}

int main(void) {
    TEST(layouts);
    TEST(bad_decimals);
    TEST(bad_columns);
    TEST(bad_directions);
    TEST(lines_that_are_no_text);
    TEST(nothing_is_half_done);
    TEST(names);
    TEST(the_viewpoint);
    TEST(q30_is_used_as_given);
    TEST(noise);
    TEST(speed);
    return check_finish();
}
