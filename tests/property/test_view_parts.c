/// The parts of the report that are sums of their own: thinning of lines, ticks, places of names,
/// texts. Each is compared with a plain search over all cases.
#include "check.h"
#include "property/support/xml.h"
#include "view/labels.h"
#include "view/markup.h"
#include "view/reduce.h"
#include "view/scale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed = 20251122;

static double uniform(double low, double high) {
    return low + (high - low) * (double)(check_random(&seed) >> 11) / 9007199254740992.0;
}

static size_t pick(size_t count) {
    return (size_t)(check_random(&seed) % count);
}

// ---------------------------------------------------------------- thinning

enum { POINT_MAX = 4000 };

struct thinned {
    double x[POINT_MAX], y[POINT_MAX];
    bool starts[POINT_MAX];
    size_t count;
};

static void gather(void *context, double x_px, double y_px, bool starts) {
    struct thinned *thinned = context;
    if (thinned->count < POINT_MAX) {
        thinned->x[thinned->count] = x_px;
        thinned->y[thinned->count] = y_px;
        thinned->starts[thinned->count++] = starts;
    }
}

/// What a column of the input and of the output have in common: first, last, least and greatest.
struct ends {
    double first, last, least, greatest;
    int count;
};

static void ends_add(struct ends *ends, double y) {
    if (ends->count++ == 0) {
        *ends = (struct ends){y, y, y, y, 1};
    }
    ends->last = y;
    ends->least = fmin(ends->least, y);
    ends->greatest = fmax(ends->greatest, y);
}

enum { COLUMN_COUNT = 40 };

static bool thin_once(void) {
    static struct thinned thinned;
    struct ends in[COLUMN_COUNT] = {0};
    struct ends out[COLUMN_COUNT] = {0};
    struct reduce reduce;
    size_t count = 1 + pick(POINT_MAX / 2);
    thinned.count = 0;
    reduce_start(&reduce, gather, &thinned);
    for (size_t i = 0; i < count; i++) {
        double x = (double)i * COLUMN_COUNT / (double)count;
        // Few heights, so that equal extremes are common; now and then one far out.
        double y = pick(50) == 0 ? uniform(-1e3, 1e3) : (double)pick(5);
        reduce_add(&reduce, x, y);
        ends_add(&in[(int)x], y);
    }
    reduce_gap(&reduce);
    bool good = true;
    for (size_t i = 0; i < thinned.count; i++) {
        good = good && thinned.starts[i] == (i == 0);
        good = good && (i == 0 || thinned.x[i] > thinned.x[i - 1]);
        ends_add(&out[(int)thinned.x[i]], thinned.y[i]);
    }
    for (int i = 0; i < COLUMN_COUNT; i++) {
        good = good && out[i].count <= 4 && (out[i].count == 0) == (in[i].count == 0);
        good = good && out[i].first == in[i].first && out[i].last == in[i].last;
        good = good && out[i].least == in[i].least && out[i].greatest == in[i].greatest;
    }
    return good;
}

static void thinning_keeps_the_extremes_of_each_column(void) {
    for (int i = 0; i < 2000 && CHECK(thin_once()); i++) {
    }
}

static void a_gap_ends_the_line(void) {
    static struct thinned thinned;
    struct reduce reduce;
    thinned.count = 0;
    reduce_start(&reduce, gather, &thinned);
    reduce_add(&reduce, 0.1, 1);
    reduce_add(&reduce, 0.2, NAN);
    reduce_add(&reduce, 0.3, 2);
    reduce_add(&reduce, NAN, 2);
    reduce_gap(&reduce);
    reduce_add(&reduce, 0.4, INFINITY);
    reduce_add(&reduce, 0.5, 3);
    reduce_gap(&reduce);
    CHECK_EQ(thinned.count, 3);
    for (size_t i = 0; i < thinned.count; i++) {
        CHECK(thinned.starts[i]);
        CHECK(thinned.y[i] == (double)i + 1);
    }
}

// ---------------------------------------------------------------- ticks

/// Is the step 1, 2 or 5 times a power of ten?
static bool is_round(double step) {
    double digit = step / pow(10, floor(log10(step) + 1e-9));
    return fabs(digit - 1) < 1e-6 || fabs(digit - 2) < 1e-6 || fabs(digit - 5) < 1e-6;
}

static bool is_round_angle(double step_deg) {
    static const double steps[] = {10, 15, 30, 45, 90, 180, 360};
    for (unsigned i = 0; i < sizeof steps / sizeof *steps; i++) {
        if (step_deg == steps[i]) {
            return true;
        }
    }
    return step_deg > 360 ? fmod(step_deg, 360) == 0 : step_deg < 10 && is_round(step_deg);
}

/// The labels as they are printed are the ticks and all differ.
static bool labels_tell(const struct ticks *ticks) {
    char before[64] = "";
    for (int i = 0; i < ticks->count; i++) {
        char label[64];
        double value = scale_tick(ticks, i);
        snprintf(label, sizeof label, "%.*f", ticks->decimals, value);
        if (strcmp(label, before) == 0 || fabs(atof(label) - value) > 1e-3 * ticks->step) {
            return false;
        }
        strcpy(before, label);
    }
    return true;
}

static void ticks_are_round_and_within(void) {
    bool few_seen = false;
    for (int i = 0; i < 50000 && check_clean(); i++) {
        double low = uniform(-1, 1) * pow(10, uniform(-4, 5));
        double high = low + pow(10, uniform(-4, 5));
        int most = 2 + (int)pick(12);
        enum scale_unit unit = pick(2) == 0 ? SCALE_DECIMAL : SCALE_DEGREES;
        struct ticks ticks = scale_ticks(low, high, most, unit);
        CHECK(ticks.count <= most);
        CHECK(unit == SCALE_DECIMAL ? is_round(ticks.step) : is_round_angle(ticks.step));
        // The next smaller step is at worst 2.5 times smaller (3 in degrees) and had too many
        // ticks.
        CHECK(ticks.count >= (most - 2) / 3);
        few_seen = few_seen || ticks.count < most / 2;
        if (ticks.count > 0) {
            double slack = 1e-6 * ticks.step;
            CHECK(scale_tick(&ticks, 0) >= low - slack);
            CHECK(scale_tick(&ticks, 0) - ticks.step < low);
            CHECK(scale_tick(&ticks, ticks.count - 1) <= high + slack);
            CHECK(scale_tick(&ticks, ticks.count - 1) + ticks.step > high);
        }
        CHECK(labels_tell(&ticks));
    }
    CHECK(few_seen); // else the lower bound above says nothing
}

static void ticks_of_familiar_ranges(void) {
    struct ticks ticks = scale_ticks(-180, 180, 6, SCALE_DEGREES);
    CHECK(ticks.step == 90 && ticks.count == 5 && ticks.decimals == 0);
    ticks = scale_ticks(0, 60, 13, SCALE_DECIMAL);
    CHECK(ticks.step == 5 && ticks.count == 13);
    ticks = scale_ticks(12.30, 12.34, 6, SCALE_DEGREES);
    CHECK(ticks.step == 0.01 && ticks.count == 5 && ticks.decimals == 2);
    ticks = scale_ticks(0, 1e-9, 5, SCALE_DECIMAL);
    CHECK(ticks.count >= 2);
    ticks = scale_ticks(1e9, 1e9 + 1e-7, 5, SCALE_DECIMAL);
    CHECK(ticks.count == 0); // no doubles in between
}

static void a_range_is_widened(void) {
    double low = INFINITY;
    double high = -INFINITY;
    scale_widen(&low, &high, 0.05, 2);
    CHECK(low == -1 && high == 1);
    low = 3;
    high = 3;
    scale_widen(&low, &high, 0.05, 2);
    CHECK(low == 2 && high == 4);
    low = 0;
    high = 100;
    scale_widen(&low, &high, 0.1, 2);
    CHECK(fabs(low + 10) < 1e-9 && fabs(high - 110) < 1e-9);
}

// ---------------------------------------------------------------- names

static bool covers(const struct labels_box *box, double x, double y) {
    return x > box->left && x < box->right && y > box->top && y < box->bottom;
}

/// Samples the box on a fine grid against the dots and the boxes before it.
static bool is_free(const struct labels_surroundings *around, const struct labels_box *box) {
    for (double x = box->left + 0.01; x < box->right; x += 0.5) {
        for (double y = box->top + 0.01; y < box->bottom; y += 0.5) {
            for (size_t i = 0; i < around->placed_count; i++) {
                if (covers(&around->placed[i], x, y)) {
                    return false;
                }
            }
            for (size_t i = 0; i < around->dot_count; i++) {
                const struct labels_dot *dot = &around->dot[i];
                if (hypot(x - dot->x_px, y - dot->y_px) < dot->radius_px - 1e-9) {
                    return false;
                }
            }
        }
    }
    return box->left >= around->picture.left && box->right <= around->picture.right &&
           box->top >= around->picture.top && box->bottom <= around->picture.bottom;
}

static void names_cover_nothing(void) {
    enum { DOT_COUNT = 30 };
    int placed_total = 0;
    for (int round = 0; round < 50 && check_clean(); round++) {
        struct labels_dot dot[DOT_COUNT];
        struct labels_box placed[DOT_COUNT];
        struct labels_surroundings around = {.picture = {0, 0, 400, 270},
                                             .dot = dot,
                                             .dot_count = DOT_COUNT,
                                             .ring_x_px = 200,
                                             .ring_y_px = 135,
                                             .ring_radius_px = 110,
                                             .placed = placed};
        for (int i = 0; i < DOT_COUNT; i++) {
            dot[i] = (struct labels_dot){uniform(0, 400), uniform(0, 270), uniform(1, 5)};
        }
        for (int i = 0; i < DOT_COUNT; i++) {
            struct labels_box box;
            if (labels_place(&around, &dot[i], uniform(10, 90), 11, &box)) {
                CHECK(is_free(&around, &box));
                placed[around.placed_count++] = box;
                placed_total++;
            }
        }
    }
    check_note("names placed, of 1500:", placed_total);
    CHECK(placed_total > 750);
}

static void a_name_stands_beside_its_dot_and_off_the_ring(void) {
    struct labels_dot dot = {200, 100, 3};
    struct labels_surroundings around = {.picture = {0, 0, 400, 270},
                                         .dot = &dot,
                                         .dot_count = 1,
                                         .ring_x_px = 300,
                                         .ring_y_px = 100,
                                         .ring_radius_px = 80};
    struct labels_box box;
    CHECK(labels_place(&around, &dot, 40, 11, &box));
    CHECK(box.right < dot.x_px); // to the right the ring is in the way
    around.ring_radius_px = 0;
    CHECK(labels_place(&around, &dot, 40, 11, &box));
    CHECK(box.left > dot.x_px && box.left < dot.x_px + 10);
    around.picture = (struct labels_box){180, 90, 220, 110};
    CHECK(!labels_place(&around, &dot, 40, 11, &box));
}

// ---------------------------------------------------------------- texts and numbers

static char written[4096];

/// What `write` prints, as a string.
#define PRINTED(call)                                                                              \
    do {                                                                                           \
        FILE *out = fmemopen(written, sizeof written, "w");                                        \
        call;                                                                                      \
        fclose(out);                                                                               \
    } while (0)

static void any_bytes_become_well_formed_text(void) {
    for (int round = 0; round < 20000 && check_clean(); round++) {
        char text[64], page[5000];
        size_t size = pick(sizeof text - 1);
        for (size_t i = 0; i < size; i++) {
            // Half of the bytes begin or go on characters, so that whole ones happen, too.
            static const char frequent[] =
                "<>&\"'a\x1B\x7F\xC2\xE2\x82\xAC\xEF\xBF\xBE\xED\xF0\x9F\xF4";
            text[i] = pick(2) == 0 ? frequent[pick(sizeof frequent - 1)] : (char)(1 + pick(255));
        }
        text[size] = '\0';
        PRINTED(markup_text(out, text));
        int length = snprintf(page, sizeof page, "<p title=\"%s\">%s</p>", written, written);
        size_t at;
        CHECK(xml_check(page, (size_t)length, &at) == NULL);

        char field[17] = {0};
        size_t capacity = 1 + pick(16);
        field[capacity] = '#';
        markup_copy(field, capacity, text);
        CHECK(strlen(field) < capacity && field[capacity] == '#');
        CHECK(strncmp(field, text, strlen(field)) == 0);
        CHECK(strlen(text) < capacity ? strcmp(field, text) == 0 : strlen(field) + 4 >= capacity);
    }
    char field[6];
    markup_copy(field, sizeof field, "abcd\xC3\xA9");
    CHECK(strcmp(field, "abcd") == 0);
    CHECK_EQ(markup_length("a\xC3\xA9\xE2\x82\xAC"), 3);
    PRINTED(markup_text(out, "\xCE\xB1 \xF0\x9F\x94\xAD <&>"));
    CHECK(strcmp(written, "\xCE\xB1 \xF0\x9F\x94\xAD &lt;&amp;&gt;") == 0);
}

static void numbers_have_one_form(void) {
    static const struct {
        double value;
        int decimals;
        const char *text;
    } cases[] = {{1.005, 1, "1.0"},       {-12.34, 1, "\u221212.3"}, {-0.04, 1, "0.0"},
                 {-0.06, 1, "\u22120.1"}, {0, 4, "0.0000"},          {-0.0, 0, "0"},
                 {NAN, 2, "\u2013"},      {-INFINITY, 2, "\u2013"}};
    for (unsigned i = 0; i < sizeof cases / sizeof *cases; i++) {
        PRINTED(markup_number(out, cases[i].value, cases[i].decimals));
        CHECK(strcmp(written, cases[i].text) == 0);
    }
    PRINTED(markup_number(out, -1.7e308, 9));
    CHECK_EQ(strlen(written), 3 + 309 + 1 + 9);
    for (int i = 0; i < 20000 && check_clean(); i++) {
        double px = uniform(-1100, 1100);
        PRINTED(markup_px(out, px));
        CHECK(fabs(atof(written) - px) < 0.0501);
        CHECK(strcmp(written, "-0") != 0 && strstr(written, ".0") == NULL);
    }
    PRINTED(markup_px(out, -0.04));
    CHECK(strcmp(written, "0") == 0);
    PRINTED(markup_px(out, INFINITY));
    CHECK(strcmp(written, "0") == 0);
}

/// A checker that finds nothing wrong anywhere would make the tests above worthless.
static void the_checker_notices(void) {
    static const char *const bad[] = {"<a>",
                                      "<a></b>",
                                      "<a/>x",
                                      "<a>&nbsp;</a>",
                                      "<a>& </a>",
                                      "<a b=\"<\"></a>",
                                      "<a b='1'></a>",
                                      "<a b=\"1\" b=\"2\"></a>",
                                      "<a></a><a></a>",
                                      "<p/>",
                                      "<a>\x01</a>",
                                      "<a>\xC0\x80</a>",
                                      "<a>\xED\xA0\x80</a>",
                                      "<a><b id=\"x\"></b><b id=\"x\"></b></a>",
                                      "<a><b href=\"#y\"></b></a>",
                                      "<a b></a>",
                                      ""};
    size_t at;
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(xml_check(bad[i], strlen(bad[i]), &at) != NULL);
    }
    const char *good = "<!DOCTYPE html>\n<a b=\"&quot;\">&lt;<svg><c id=\"x\"/></svg>"
                       "<d href=\"#x\">\xC3\xA9</d></a>\n";
    CHECK(xml_check(good, strlen(good), &at) == NULL);
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(thinning_keeps_the_extremes_of_each_column);
    TEST(a_gap_ends_the_line);
    TEST(ticks_are_round_and_within);
    TEST(ticks_of_familiar_ranges);
    TEST(a_range_is_widened);
    TEST(names_cover_nothing);
    TEST(a_name_stands_beside_its_dot_and_off_the_ring);
    TEST(any_bytes_become_well_formed_text);
    TEST(numbers_have_one_form);
    TEST(the_checker_notices);
    return check_finish();
}
