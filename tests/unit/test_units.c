/// firmware/scene/units: micrometres in whole units, against integers of 128 bits.
#include "check.h"

#include "scene/shape.h"
#include "scene/units.h"

#include "fixed/wide.h"

static struct tree_header header;
static struct tree_node root;
static const struct tree tree = {.header = &header, .nodes = &root};

static void set_unit(uint32_t high, uint32_t low) {
    header.unit_double[1] = high;
    header.unit_double[0] = low;
}

static void whole_micrometres(void) {
    uint64_t random = 71;
    static const uint32_t units_um[] = {1, 2, 3, 10, 125, 999, 1000, 1024, 65535, 999999, 1000000};
    for (unsigned u = 0; u < sizeof units_um / sizeof *units_um; u++) {
        const struct units units = units_of_um(units_um[u]);
        for (int i = 0; i < CHECK_ROUNDS(2000) && check_clean(); i++) {
            const int64_t count = (int64_t)(check_random(&random) >> 36); // below 2^28
            const int64_t um = count * units_um[u];
            CHECK_EQ(units_from_um(units, um), count); // whole units stay whole
            CHECK_EQ(units_from_um(units, -um), -count);
            CHECK_EQ(units_from_um(units, um + units_um[u] - 1), count); // just below the next
        }
    }
}

static void of_a_tree(void) {
    struct units units;
    set_unit(0x3F50624D, 0xD2F1A9FC); // 0.001
    CHECK(units_of_tree(&tree, 0, &units));
    CHECK_EQ(units_from_um(units, 12345678), 12345);
    CHECK_EQ(units_from_um(units, -12345678), -12345);
    CHECK(units_of_tree(&tree, 3, &units));
    CHECK_EQ(units_from_um(units, 12345000), 12345 * 8);
    set_unit(0x3FF00000, 0); // 1
    CHECK(units_of_tree(&tree, 0, &units));
    CHECK_EQ(units_from_um(units, INT64_C(268435455999999)), 268435455);
    CHECK(units_of_tree(&tree, 10, &units));
    CHECK_EQ(units_from_um(units, 1500000), 1536);
    set_unit(0x412E8480, 0); // 10^6: a place of 7,000 km
    CHECK(units_of_tree(&tree, 0, &units));
    CHECK_EQ(units_from_um(units, INT64_C(7000001000000)), 7);
    set_unit(0x3DDB7CDF, 0xD9D7BDBB); // 10^-10
    CHECK(units_of_tree(&tree, 0, &units));
    CHECK_NEAR(units_from_um(units, 1000), 10000000, 1);
    // What is no length.
    static const uint32_t bad[][2] = {{0, 0}, {0x7FF00000, 0}, {0xBFF00000, 0}, {0x00100000, 0}};
    for (unsigned i = 0; i < sizeof bad / sizeof *bad; i++) {
        set_unit(bad[i][0], bad[i][1]);
        CHECK(!units_of_tree(&tree, 0, &units));
    }
}

static void ends(void) {
    const struct units fine = units_of_um(1);
    CHECK_EQ(units_from_um(fine, INT64_MAX), INT64_C(1) << 62);
    CHECK_EQ(units_from_um(fine, INT64_MIN), -(INT64_C(1) << 62));
    CHECK_EQ(units_from_um(fine, 0), 0);
    struct units units;
    set_unit(0x3D719799, 0x812DEA11); // 10^-12: so many a micrometre that far away is too far
    CHECK(units_of_tree(&tree, 0, &units));
    CHECK_EQ(units_from_um(units, INT64_C(1) << 50), INT64_C(1) << 62);
    CHECK_NEAR(units_from_um(units, 2), 2000000, 1);
}

static void finer(void) {
    header.node_count = 1;
    set_unit(0x3FF00000, 0); // metres, 80 of them
    root = (struct tree_node){.x = -30, .y = 40, .z = 0, .radius = 40};
    CHECK_EQ(units_finer(&tree), 13); // 1 / 8192 m is below an eighth of a millimetre
    root.radius = 100000;
    CHECK_EQ(units_finer(&tree), 11); // 2^28 / 100,040
    root.radius = 1U << 29;
    CHECK_EQ(units_finer(&tree), 0);
    set_unit(0x3F1A36E2, 0xEB1C432D); // 10^-4 is fine enough
    root.radius = 100;
    CHECK_EQ(units_finer(&tree), 0);
    header.node_count = 0;
    CHECK_EQ(units_finer(&tree), 0);
}

int main(void) {
    TEST(whole_micrometres);
    TEST(of_a_tree);
    TEST(ends);
    TEST(finer);
    return check_finish();
}
