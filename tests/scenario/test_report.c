/// The report as a file: well-formed whatever is in it, complete, small, and written whole or not
/// at all.
#include "check.h"
#include "property/support/xml.h"
#include "view/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "build/report-test.XXXXXX";
static char page_path[64], *page;
static size_t page_size;

/// Reads a file into `page`.
static bool read_page(const char *path) {
    free(page);
    page = NULL;
    FILE *file = fopen(path, "rb");
    if (!CHECK(file != NULL)) {
        return false;
    }
    page = calloc(1, 8000000);
    page_size = fread(page, 1, 7999999, file);
    fclose(file);
    return true;
}

static bool well_formed(void) {
    size_t at = 0;
    const char *wrong = xml_check(page, page_size, &at);
    if (wrong != NULL) {
        check_note(wrong, (int64_t)at);
    }
    return CHECK(wrong == NULL);
}

/// Writes the chapters, reads them back and checks what holds for every report.
static bool publish(const struct report *const *chapters, size_t count) {
    return CHECK(report_write(chapters, count, page_path)) && read_page(page_path) &&
           well_formed() && CHECK(strstr(page, "http") == NULL) &&
           CHECK(strstr(page, "//") == NULL) && CHECK(strstr(page, "url(") == NULL) &&
           CHECK(strstr(page, "src=") == NULL) && CHECK(strstr(page, "@import") == NULL) &&
           CHECK(strstr(page, "<script") == NULL);
}

static bool publish_one(const struct report *report) {
    return publish(&report, 1);
}

static size_t occurrences(const char *text, const char *word) {
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, word)) != NULL; at += strlen(word)) {
        count++;
    }
    return count;
}

/// The data of the n-th path of a class, from 0; NULL: there is none.
static const char *path_data(const char *class, size_t index) {
    char begin[64];
    snprintf(begin, sizeof begin, "<path class=\"%s\" d=\"", class);
    // The plot, not the legend before it.
    const char *at = strstr(page, "<svg class=\"plot\"");
    for (size_t i = 0; at != NULL && i <= index; i++) {
        at = strstr(at, begin);
        at = at == NULL ? NULL : at + strlen(begin);
    }
    return at;
}

/// The next pair of coordinates of a path; false at its end.
static bool next_point(const char **data, double *x, double *y) {
    while (**data != '"' && **data != '-' && (**data < '0' || **data > '9')) {
        (*data)++;
    }
    if (**data == '"') {
        return false;
    }
    char *end;
    *x = strtod(*data, &end);
    *y = strtod(end, &end);
    *data = end;
    return true;
}

static struct report_sample sample_at(double time_s) {
    return (struct report_sample){.time_s = time_s,
                                  .pan_deg = 10,
                                  .pan_setpoint_deg = 10,
                                  .tilt_deg = 20,
                                  .tilt_setpoint_deg = 20,
                                  .focal_mm = 12,
                                  .focal_setpoint_mm = 12,
                                  .error_deg = 0.01,
                                  .mode = "tracking"};
}

static struct report_picture picture_of(struct report_point *points, size_t count) {
    return (struct report_picture){.title = "A picture",
                                   .time_s = 1,
                                   .sensor_width_mm = 36,
                                   .sensor_height_mm = 24,
                                   .focal_mm = 50,
                                   .cone_radius_mm = 10,
                                   .half_angle_deg = 11.3,
                                   .error_deg = 0.0042,
                                   .pan_deg = -12.34,
                                   .tilt_deg = 56.78,
                                   .points = points,
                                   .point_count = count};
}

static void a_report_holds_what_it_was_given(void) {
    struct report report;
    report_init(&report, "Ten constellations", "As a person would show them");
    for (int i = 0; i < 1000; i++) {
        struct report_sample sample = sample_at(i * 0.01);
        CHECK(report_add_sample(&report, &sample));
    }
    struct report_point points[] = {
        {.x_mm = 5, .y_mm = 8, .size = 1, .is_target = true, .label = "Rigel"},
        {.x_mm = -30, .y_mm = 0, .size = 1, .is_target = true},
        {.x_mm = -3, .y_mm = 0, .size = 1}};
    struct report_picture picture = picture_of(points, 3);
    CHECK(report_add_picture(&report, &picture));
    memset(points, 0, sizeof points); // the report has its copy
    CHECK(report_add_fact(&report, "In frame", "99.4 %"));
    if (publish_one(&report)) {
        static const char *const wanted[] = {"Ten constellations",
                                             "As a person would show them",
                                             "<dt>In frame</dt><dd>99.4 %</dd>",
                                             "Pan (\u00B0)",
                                             "Tilt (\u00B0)",
                                             "Focal length (mm)",
                                             "Aim error (\u00B0), log scale",
                                             "Time (s)",
                                             "A picture",
                                             "\u221212.34\u00B0",
                                             "56.78\u00B0",
                                             "11.30\u00B0",
                                             "0.0042\u00B0",
                                             "2 targets, 1 outside the frame",
                                             "Rigel</text>",
                                             "Boresight 0.",
                                             "prefers-color-scheme:dark",
                                             "@media print",
                                             "href=\"#p1-1\"",
                                             "tracking"};
        for (unsigned i = 0; i < sizeof wanted / sizeof *wanted; i++) {
            if (!CHECK(strstr(page, wanted[i]) != NULL)) {
                check_note(wanted[i], 0);
            }
        }
    }
    report_free(&report);
}

static void the_same_run_gives_the_same_bytes(void) {
    char *before = NULL;
    for (int turn = 0; turn < 2; turn++) {
        struct report report;
        report_init(&report, "Same", "");
        for (int i = 0; i < 500; i++) {
            struct report_sample sample = sample_at(i);
            CHECK(report_add_sample(&report, &sample));
        }
        publish_one(&report);
        report_free(&report);
        CHECK(before == NULL || strcmp(before, page) == 0);
        free(before);
        before = strdup(page);
    }
    free(before);
}

static void texts_are_escaped(void) {
    const char *evil = "<script>alert(\"1\" & '2')</script>\x1B[2J\xFF";
    struct report report;
    report_init(&report, evil, evil);
    struct report_sample sample = sample_at(0);
    sample.mode = "<b>&";
    CHECK(report_add_sample(&report, &sample));
    sample.time_s = 10;
    CHECK(report_add_sample(&report, &sample));
    struct report_point point = {-9, 6, 1, true, "</text><b a='\xC3"};
    struct report_picture picture = picture_of(&point, 1);
    snprintf(picture.title, sizeof picture.title, "%s", evil);
    CHECK(report_add_picture(&report, &picture));
    CHECK(report_add_fact(&report, evil, evil));
    if (publish_one(&report)) { // well-formed, and no <script
        CHECK(occurrences(page, "&lt;script&gt;alert(&quot;1&quot; &amp; &#39;2&#39;)") >= 6);
        CHECK_EQ(occurrences(page, "&lt;/text&gt;&lt;b a=&#39;\uFFFD</t"), 2); // name and title
        CHECK(strstr(page, "<b") == NULL || strncmp(strstr(page, "<b"), "<body", 5) == 0);
    }
    report_free(&report);
}

static void long_texts_are_cut_between_characters(void) {
    struct report report;
    char text[400];
    for (size_t i = 0; i + 3 < sizeof text; i += 3) {
        memcpy(text + i, "\xE2\x82\xAC", 4);
    }
    report_init(&report, text, text);
    CHECK(report_add_fact(&report, text, text));
    CHECK_EQ(strlen(report.title), 78);
    CHECK_EQ(strlen(report.subtitle), 159);
    CHECK_EQ(strlen(report.facts[0].name), 45);
    publish_one(&report);
    CHECK(page == NULL || strstr(page, "\xEF\xBF\xBD") == NULL);
    report_free(&report);
}

static void empty_and_odd_reports_are_well_formed(void) {
    publish(NULL, 0);
    CHECK(page != NULL && strstr(page, "Nothing was recorded.") != NULL);
    struct report empty, odd;
    report_init(&empty, "", "");
    report_init(&odd, "odd", "");
    const struct report *both[] = {&empty, &odd};
    if (publish(both, 2)) {
        CHECK_EQ(occurrences(page, "No samples were recorded."), 2);
        CHECK(strstr(page, "What the camera saw") == NULL);
        CHECK(strstr(page, "<nav>") != NULL);
    }
    struct report_sample sample = sample_at(5);
    CHECK(report_add_sample(&odd, &sample)); // one alone
    publish(both, 2);
    static const double values[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 0, -1};
    struct report_point points[7] = {0};
    for (int i = 0; i < 7; i++) {
        double v = values[i];
        sample = (struct report_sample){i == 6 ? 7 : v, v, v, v, v, v, v, v, NULL};
        CHECK(report_add_sample(&odd, &sample));
        points[i] = (struct report_point){v, v, v, i % 2 == 0, "odd"};
        struct report_picture picture = {"", v, v, v, v, v, v, v, v, v, v, v, points, 7, NULL, 0};
        CHECK(report_add_picture(&odd, &picture));
        publish(both, 2);
        CHECK(report_picture_svg(&picture, page_path) && read_page(page_path) && well_formed());
    }
    CHECK(page != NULL && strstr(page, "nan") == NULL && strstr(page, "inf") == NULL);
    report_free(&empty);
    report_free(&odd);
}

/// Ten minutes at 100 samples a second of noise, the worst for a file.
static void fill_long(struct report *report, uint64_t *seed) {
    report_init(report, "Ten minutes", "Noise");
    for (int i = 0; i < 60000; i++) {
        struct report_sample sample = sample_at(i * 0.01);
        double *values[] = {&sample.pan_deg,  &sample.pan_setpoint_deg,
                            &sample.tilt_deg, &sample.tilt_setpoint_deg,
                            &sample.focal_mm, &sample.focal_setpoint_mm,
                            &sample.error_deg};
        for (unsigned v = 0; v < 7; v++) {
            *values[v] += (double)(check_random(seed) % 1000) / 1000 * *values[v];
        }
        sample.mode = i / 10 % 2 == 0 ? "settling" : "tracking";
        CHECK(report_add_sample(report, &sample));
    }
}

static void a_long_run_stays_small(void) {
    enum { POINT_COUNT = 4000, TARGET_COUNT = 40 };
    static struct report_point points[POINT_COUNT];
    struct report report;
    uint64_t seed = 7;
    check_note("seed", (int64_t)seed);
    fill_long(&report, &seed);
    for (int i = 0; i < 30; i++) {
        for (int p = 0; p < POINT_COUNT; p++) {
            points[p] = (struct report_point){(double)(check_random(&seed) % 3600) / 100 - 18,
                                              (double)(check_random(&seed) % 2400) / 100 - 12,
                                              (double)(check_random(&seed) % 50) / 10,
                                              p < TARGET_COUNT, "HIP 123456"};
        }
        struct report_picture picture = picture_of(points, POINT_COUNT);
        picture.time_s = 20 * i;
        CHECK(report_add_picture(&report, &picture));
    }
    if (publish_one(&report)) {
        check_note("bytes of a report of 10 minutes with 30 pictures:", (int64_t)page_size);
        CHECK(page_size < 2000000);
        CHECK_EQ(occurrences(page, "the largest 1500 of 3960 background points"), 30);
        CHECK(strstr(page, "Time (min)") != NULL);
    }
    report_free(&report);
}

/// A single sample that sticks out must be drawn at its height, wherever in the run it stands.
static void a_single_sample_that_sticks_out_is_drawn(void) {
    enum { SPIKE_COUNT = 60 };
    struct report report;
    report_init(&report, "Spikes", "");
    for (int i = 0; i < 60000; i++) {
        struct report_sample sample = sample_at(i * 0.01);
        sample.pan_deg = 0;
        if (i % 1000 == 137) { // 60 spikes, up and down in turn, the first two the highest
            sample.pan_deg = (i / 1000 % 2 == 0 ? 1 : -1) * (100.0 - i / 2000);
        }
        CHECK(report_add_sample(&report, &sample));
    }
    const char *data = publish_one(&report) ? path_data("actual", 0) : NULL;
    if (CHECK(data != NULL)) {
        // -100 to 100 lie where the extremes of the path lie; the rest must lie in between by rule.
        double x, y, top = INFINITY, foot = -INFINITY;
        for (const char *at = data; next_point(&at, &x, &y);) {
            top = fmin(top, y);
            foot = fmax(foot, y);
        }
        CHECK(foot - top > 80);
        for (int i = 0; i < SPIKE_COUNT; i++) {
            double wanted_x = 64 + (976 - 64) * (i * 1000 + 137) / 59999.0;
            double height = (i % 2 == 0 ? 1 : -1) * (100.0 - (i * 1000 + 137) / 2000);
            double wanted_y = foot + (height + 100) / 200 * (top - foot);
            bool found = false;
            for (const char *at = data; next_point(&at, &x, &y);) {
                found = found || (fabs(x - wanted_x) < 0.06 && fabs(y - wanted_y) < 0.11);
            }
            CHECK(found);
        }
    }
    report_free(&report);
}

static void errors_of_zero_and_gaps_are_drawn_as_said(void) {
    struct report report;
    report_init(&report, "Errors", "");
    static const double errors_deg[] = {10, 0.1, 0.001, -1, 0, 0, -1, 1};
    for (int i = 0; i < 8; i++) {
        struct report_sample sample = sample_at(i);
        sample.error_deg = errors_deg[i];
        CHECK(report_add_sample(&report, &sample));
    }
    const char *data = publish_one(&report) ? path_data("actual", 3) : NULL;
    if (CHECK(data != NULL)) {
        double x[8], y[8];
        size_t count = 0;
        for (const char *at = data; count < 6 && next_point(&at, &x[count], &y[count]);) {
            count++;
        }
        CHECK_EQ(count, 6);
        // Equal steps for equal factors; 0 below them all; three lines.
        CHECK(fabs((y[1] - y[0]) - (y[2] - y[1])) < 0.21);
        CHECK(fabs((y[5] - y[0]) - (y[1] - y[5])) < 0.21);
        CHECK(y[3] == y[4] && y[3] > y[2] + 10);
        char line[200];
        snprintf(line, sizeof line, "%.*s", (int)strcspn(data, "\""), data);
        CHECK_EQ(occurrences(line, "M"), 3);
        CHECK(strstr(page, "0, and anything below 0.001\u00B0, is drawn on the line marked 0") !=
              NULL);
    }
    report_free(&report);
}

static void without_a_zoom_there_is_no_plot_of_it(void) {
    struct report report;
    report_init(&report, "No zoom", "");
    struct report_sample sample = sample_at(0);
    sample.focal_mm = 0;
    sample.focal_setpoint_mm = 0;
    for (sample.time_s = 0; sample.time_s < 5; sample.time_s += 1) {
        CHECK(report_add_sample(&report, &sample));
    }
    if (publish_one(&report)) {
        CHECK(strstr(page, "Focal length") == NULL);
        CHECK(path_data("actual", 2) != NULL && path_data("actual", 3) == NULL);
    }
    report_free(&report);
}

static void the_briefest_mode_shows(void) {
    // One fault just before, one just after another brief mode in the same column.
    static const int faults[] = {11995, 31210};
    struct report report;
    report_init(&report, "Modes", "");
    for (int i = 0; i < 60000; i++) {
        struct report_sample sample = sample_at(i * 0.01);
        bool faulted = i == faults[0] || i == faults[1];
        sample.mode = faulted ? "faulted" : i % 300 == 0 ? "settling" : "tracking";
        CHECK(report_add_sample(&report, &sample));
    }
    const char *data = publish_one(&report) ? path_data("mode6", 0) : NULL;
    for (int i = 0; i < 2 && CHECK(data != NULL); i++) {
        double x, y;
        CHECK(next_point(&data, &x, &y) && x == floor(64 + 912 * faults[i] / 59999.0));
        data = strchr(data, 'M');
    }
    CHECK(path_data("mode3", 0) != NULL && path_data("mode2", 0) != NULL);
    report_free(&report);
}

static void a_picture_has_up_on_top(void) {
    struct report_point points[] = {{.x_mm = 5, .y_mm = 9, .size = 1, .is_target = true},
                                    {.x_mm = -9, .y_mm = -3, .size = 1, .is_target = true}};
    struct report_picture picture = picture_of(points, 2);
    if (CHECK(report_picture_svg(&picture, page_path)) && read_page(page_path) && well_formed()) {
        CHECK_EQ(occurrences(page, "http"), 1);
        CHECK(strncmp(page, "<svg xmlns=\"http://www.w3.org/2000/svg\"", 39) == 0);
        CHECK(strstr(page, "A picture</text>") != NULL);
        double cx[2], cy[2], r, cone_x, cone_y;
        const char *at = strstr(page, "<circle class=\"cone\"");
        CHECK(at != NULL && sscanf(at, "<circle class=\"cone\" cx=\"%lf\" cy=\"%lf\" r=\"%lf\"",
                                   &cone_x, &cone_y, &r) == 3);
        at = page;
        for (int i = 0; i < 2 && CHECK(at != NULL); i++) {
            at = strstr(at + 1, "<circle class=\"target\"");
            CHECK(at != NULL && sscanf(at, "<circle class=\"target\" cx=\"%lf\" cy=\"%lf\"", &cx[i],
                                       &cy[i]) == 2);
        }
        double scale = r / 10;
        int first = cx[0] > cx[1] ? 0 : 1;
        CHECK(fabs(cx[first] - cone_x - 5 * scale) < 0.3);
        CHECK(fabs(cy[first] - cone_y + 9 * scale) < 0.3);
        CHECK(fabs(cx[1 - first] - cone_x + 9 * scale) < 0.3);
        CHECK(fabs(cy[1 - first] - cone_y - 3 * scale) < 0.3);
    }
}

int main(void) {
    if (mkdtemp(folder) == NULL) {
        printf("FAIL report cannot make a folder in build/\n");
        return 1;
    }
    snprintf(page_path, sizeof page_path, "%s/report.html", folder);
    TEST(a_report_holds_what_it_was_given);
    TEST(the_same_run_gives_the_same_bytes);
    TEST(texts_are_escaped);
    TEST(long_texts_are_cut_between_characters);
    TEST(empty_and_odd_reports_are_well_formed);
    TEST(a_long_run_stays_small);
    TEST(a_single_sample_that_sticks_out_is_drawn);
    TEST(errors_of_zero_and_gaps_are_drawn_as_said);
    TEST(without_a_zoom_there_is_no_plot_of_it);
    TEST(the_briefest_mode_shows);
    TEST(a_picture_has_up_on_top);
    free(page);
    unlink(page_path);
    rmdir(folder);
    return check_finish();
}
