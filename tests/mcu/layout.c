/// Structures as the board has them in memory, and back. That the layouts are those of the
/// compilers: tests/mcu/cpu/layout.sh, which calls this with `arm` or `host`.
#include "check.h"

#include "control/controller.h"
#include "replay/layout.h"

#include <stdlib.h>
#include <string.h>

/// Random bytes in a structure of the board's, there and back again.
static void there_and_back(struct layout *layout, size_t host_bytes) {
    static uint8_t host[65536];
    uint8_t arm[4096], again[4096];
    uint64_t random = 1;
    const uint32_t bytes = layout_arm_bytes(layout);
    CHECK(bytes <= sizeof arm && host_bytes <= sizeof host);
    for (unsigned round = 0; round < 50U; round++) {
        for (uint32_t i = 0; i < bytes; i++) {
            arm[i] = (uint8_t)check_random(&random);
        }
        layout_to_host(layout, arm, host);
        layout_to_arm(layout, host, again); // padding is 0 now
        memset(host, 0xEE, host_bytes);
        layout_to_host(layout, again, host);
        layout_to_arm(layout, host, arm);
        CHECK(memcmp(arm, again, bytes) == 0);
    }
}

static void structures_survive(void) {
    there_and_back(&layout_target_update, sizeof(struct target_update));
    there_and_back(&layout_controller_output, sizeof(struct controller_output));
    there_and_back(&layout_controller_config, sizeof(struct controller_config));
}

static void an_update_by_hand(void) {
    const struct target_update update = {.kind = TARGET_GONE,
                                         .id = 0x11223344,
                                         .weight_q16 = 0x55667788,
                                         .position_um = {-1, 2, -3}};
    uint8_t arm[256];
    layout_to_arm(&layout_target_update, &update, arm);
    // AAPCS32: the enum is a byte, then integers by their own alignment, least significant byte
    // first.
    CHECK_EQ(arm[0], TARGET_GONE);
    CHECK_EQ(layout_arm_offset(&layout_target_update, "id"), 4);
    CHECK(memcmp(arm + 4, "\x44\x33\x22\x11", 4) == 0);
    const uint32_t at = layout_arm_offset(&layout_target_update, "position_um");
    CHECK_EQ(at % 8U, 0);
    CHECK(memcmp(arm + at, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x02\0\0\0\0\0\0\0", 16) == 0);
    struct target_update back;
    memset(&back, 0x77, sizeof back);
    layout_to_host(&layout_target_update, arm, &back);
    CHECK_EQ(back.kind, TARGET_GONE);
    CHECK_EQ(back.id, 0x11223344);
    CHECK_EQ(back.weight_q16, 0x55667788);
    CHECK_EQ(back.position_um.z, -3);
}

static void a_signed_enum_keeps_its_sign(void) {
    struct controller_output output, back;
    memset(&output, 0, sizeof output);
    output.status.framing.status = (enum framing_status) - 1;
    uint8_t arm[4096];
    layout_to_arm(&layout_controller_output, &output, arm);
    memset(&back, 0x77, sizeof back);
    layout_to_host(&layout_controller_output, arm, &back);
    CHECK_EQ((int)back.status.framing.status, -1);
}

int main(int argc, char **argv) {
    if (argc == 2) {
        layout_write_assertions(stdout, strcmp(argv[1], "arm") == 0);
        return EXIT_SUCCESS;
    }
    TEST(structures_survive);
    TEST(an_update_by_hand);
    TEST(a_signed_enum_keeps_its_sign);
    return check_finish();
}
