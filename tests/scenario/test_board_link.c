/// A program's end of the line (boards/linux/board_link, board_targets) and a board's, joined by a
/// line of 115,200 baud that may be noisy.
#include "unit/desk.h"

#include "board_link.h"
#include "board_targets.h"

#include "app/settings_digest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// Our clock when the board's is 0.
#define OUR_START_US UINT64_C(7000000000)

static struct board_link link_;
static struct board_targets targets;
static uint32_t damage_in; ///< one byte in so many is damaged or lost; 0: none
static uint64_t dice = 99;
static bool unplugged;
static uint64_t bytes_read;

// ---------------------------------------------------------------- our end

/// What the noise makes of a byte. False: it is lost.
static bool pass(char *byte) {
    if (damage_in == 0U || check_random(&dice) % damage_in != 0U) {
        return true;
    }
    const uint64_t random = check_random(&dice);
    *byte = (char)(*byte ^ (char)(1U << (random >> 8) % 8U));
    // A stop key out of noise would be obeyed, rightly; these tests look at other things.
    return (random & 3U) != 0U && *byte != 3;
}

static enum hal_status our_write(void *ctx, const uint8_t *data, size_t size, size_t *written) {
    (void)ctx;
    if (unplugged) {
        return HAL_ERROR_GONE;
    }
    for (size_t i = 0; i < size; i++) {
        char byte = (char)data[i];
        if (pass(&byte)) {
            desk_send(&byte, 1);
        }
    }
    *written = size;
    return HAL_OK;
}

static enum hal_status our_read(void *ctx, uint8_t *data, size_t capacity, size_t *read_bytes) {
    (void)ctx;
    if (unplugged) {
        return HAL_ERROR_GONE;
    }
    while (*read_bytes < capacity && desk.said_seen < desk.said_count) {
        char byte = desk.said[desk.said_seen++];
        if (pass(&byte)) {
            data[(*read_bytes)++] = (uint8_t)byte;
        }
    }
    if (desk.said_seen == desk.said_count) {
        desk_forget();
    }
    bytes_read += *read_bytes;
    return *read_bytes != 0U ? HAL_OK : HAL_EMPTY;
}

static enum hal_status our_state(void *ctx, struct hal_serial_state *state) {
    (void)ctx;
    *state = (struct hal_serial_state){0, 0};
    return HAL_OK;
}

static const struct hal_serial_ops our_ops = {our_write, our_read, our_state};
static const struct hal_serial our_serial = {&our_ops, NULL};

static uint64_t our_time(void) {
    return OUR_START_US + desk.time_ns / 1000U;
}

static void run(uint32_t ms) {
    for (uint32_t i = 0; i < ms; i++) {
        desk_ticks(1);
        board_link_poll(&link_, our_time());
        if (board_targets_due(&targets, &link_, our_time())) {
            board_targets_send(&targets, &link_, our_time());
        }
    }
}

static void meet(void) {
    damage_in = 0;
    unplugged = false;
    bytes_read = 0;
    desk_configure();
    desk_start(115200);
    desk_ticks(50);
    board_link_init(&link_, &our_serial, 115200, 0x5e, our_time());
    board_targets_init(&targets, desk_settings.position_um);
    board_link_hello(&link_);
    run(300);
    CHECK(link_.identity.known);
}

/// Returns whether it was answered, at last.
static bool order(const char *text) {
    board_link_order(&link_, text, our_time());
    for (int i = 0; i < 2000 && link_.command == BOARD_LINK_WAITS; i++) {
        run(1);
    }
    return link_.command == BOARD_LINK_ANSWERED;
}

// ---------------------------------------------------------------- tests

static void they_meet(void) {
    meet();
    CHECK_EQ(link_.identity.version, 1);
    CHECK_EQ(link_.identity.digest, settings_digest(&desk_settings));
    CHECK(strcmp(link_.identity.build, build_id) == 0);
    CHECK(link_.status.mode == MODE_READY && link_.status_count > 3U);
    CHECK(link_.clock.answers >= 8U); // asked often at first
    CHECK(!link_.gone && link_.bytes_received == bytes_read);
    CHECK(order("arm") && !link_.refused);
    CHECK(order("aim 10.5 -3.25") && !link_.refused);
    run(2000);
    CHECK_EQ(link_.status.mode, MODE_TRACKING);
    CHECK_NEAR(link_.status.setpoint_mdeg[0], 10500, 1);
    CHECK_NEAR(link_.status.goal_mdeg[1], -3250, 1);
    CHECK(!link_.status.measured[0] && link_.status.targets == 1U);
    CHECK(order("get pan.speed_max_dps") && strcmp(link_.answer, "pan.speed_max_dps 100") == 0);
    CHECK(order("fly") && link_.refused && strstr(link_.answer, "no such command") != NULL);
    // The answer to another command, late.
    board_link_order(&link_, "stop", our_time());
    struct text late;
    text_begin(&late, desk.said + desk.said_count, 64);
    checked_line_begin(&late, link_.host, (uint8_t)(link_.command_sequence - 1U), 'C');
    text_string(&late, "no way");
    CHECK(checked_line_end(&late));
    desk.said_count += late.size_bytes;
    board_link_poll(&link_, our_time());
    CHECK_EQ(link_.command, BOARD_LINK_WAITS);
    run(250);
    CHECK(link_.command == BOARD_LINK_ANSWERED && !link_.refused);
    CHECK_EQ(link_.status.mode, MODE_STOPPED);
    desk.pressed = true;
    run(100);
    CHECK(strcmp(link_.status.held, "emergency stop") == 0);
    board_link_bye(&link_);
    run(100);
    CHECK(!desk_loop.console.link.owned);
}

/// The board's microsecond counter began at 0xFFFF0000, ours elsewhere.
static void clocks_agree(void) {
    uint64_t board_us, error_us, worst_us = 0, stated_us = 0;
    meet();
    for (uint32_t i = 0; i < 200U; i++) {
        run(37);
        CHECK(board_clock_read(&link_.clock, our_time(), &board_us, &error_us));
        const int64_t off = (int64_t)(board_us - desk_loop.console.now_us);
        const uint64_t size = (uint64_t)(off < 0 ? -off : off);
        CHECK(size <= error_us);
        worst_us = size > worst_us ? size : worst_us;
        stated_us = error_us > stated_us ? error_us : stated_us;
    }
    check_note("stated error, us, at most", (int64_t)stated_us);
    check_note("true error, us, at most", (int64_t)worst_us);
    CHECK(stated_us <= 3200U && link_.clock.restarts == 0U);
}

static struct target_update at(uint32_t id, int64_t x_um, int64_t y_um, int64_t z_um) {
    return (struct target_update){.kind = TARGET_POSITION,
                                  .id = id,
                                  .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                  .position_um = {x_um, y_um, z_um}};
}

/// The angle between what the board has of number `slot` and what `update` says, in nrad; -1: it
/// has none.
static int64_t apart_nrad(uint32_t slot, const struct target_update *update) {
    static struct target_set exact;
    uint32_t place, exact_place;
    target_set_init(&exact, desk_settings.position_um, 0);
    if (target_set_apply(&exact, update, 0) != TARGET_OK ||
        !target_set_find(&exact, update->id, &exact_place) ||
        !target_set_find(&desk_loop.controller.targets, slot, &place)) {
        return -1;
    }
    const struct vec3 a = exact.direction_q30[exact_place],
                      b = desk_loop.controller.targets.direction_q30[place];
    return llround(hypot(hypot(a.x - b.x, a.y - b.y), a.z - b.z) / 1073741824.0 * 1e9);
}

static void few_targets_go_as_they_are(void) {
    meet();
    struct target_update update[3] = {at(1000000, 1234567, 7654321, -999999),
                                      at(5, 1, -1, 1),
                                      {.kind = TARGET_DIRECTION,
                                       .id = 77,
                                       .object = 9,
                                       .weight_q16 = 98304,
                                       .direction = {-123456789, 2000000000, 5},
                                       .radius_bam32 = 11930465}};
    for (unsigned i = 0; i < 3U; i++) {
        CHECK(board_targets_take(&targets, &update[i], our_time()));
    }
    run(60);
    CHECK_EQ(desk_loop.controller.targets.count, 3);
    for (unsigned i = 0; i < 3U; i++) {
        const int64_t apart = apart_nrad(i, &update[i]);
        CHECK(apart >= 0 && apart <= 2);
    }
    uint32_t place = 0;
    CHECK(target_set_find(&desk_loop.controller.targets, 2, &place));
    const struct target *third = &desk_loop.controller.targets.target[place];
    CHECK(third->object == 9U && third->weight_q16 == 98304U);
    CHECK_NEAR(third->radius_bam32, 11930465, 12); // a millionth of a degree, rounded up
    update[1].kind = TARGET_GONE;
    CHECK(board_targets_take(&targets, &update[1], our_time()));
    run(60);
    CHECK(desk_loop.controller.targets.count == 2U && targets.count == 2U);
    CHECK(targets.text_frames == 2U && targets.compact_frames == 0U);
}

static void many_targets_20_times_a_second(void) {
    meet();
    CHECK(order("arm"));
    struct target_update last[64];
    const uint32_t bytes = desk.bytes_in;
    for (uint32_t frame = 0; frame < 100U; frame++) {
        for (uint32_t i = 0; i < 64U; i++) {
            last[i] = at(100U + i, (int64_t)(i * 31000U + frame * 10000U), 9000000 + i, i * 50000);
            CHECK(board_targets_take(&targets, &last[i], our_time()));
        }
        run(50);
    }
    CHECK(targets.compact_frames == 100U && targets.cut_frames == 0U && targets.most == 64U);
    CHECK_EQ(desk_loop.controller.targets.count, 64);
    int64_t worst = 0;
    for (uint32_t i = 0; i < 64U; i++) {
        const int64_t apart = apart_nrad(i, &last[i]);
        CHECK(apart >= 0);
        worst = apart > worst ? apart : worst;
    }
    check_note("bytes to the board in a second", (int64_t)(desk.bytes_in - bytes) / 5);
    check_note("largest error of a direction, nrad", worst);
    CHECK(worst <= 13500); // half a step of pan and of tilt: 12.0 and 6.0 urad
    CHECK(desk.lost == 0U && link_.status.damaged == 0U && link_.status.stale == 0U);
    CHECK_EQ(desk_mode(), MODE_TRACKING);
}

/// More than the line carries: each frame takes what fits, and the rest is first in the next.
/// Nothing piles up, nobody starves.
static void more_than_fits(void) {
    meet();
    for (uint32_t frame = 0; frame < 60U; frame++) {
        for (uint32_t i = 0; i < 128U; i++) {
            struct target_update update =
                at(i, (int64_t)(i * 10000U + frame), 9000000, (int64_t)frame);
            update.radius_um = 1000U + frame; // has to go as text
            CHECK(board_targets_take(&targets, &update, our_time()));
        }
        run(50);
        CHECK(board_link_waiting(&link_) <= 520U);
    }
    CHECK(targets.cut_frames > 30U);
    CHECK_EQ(desk_loop.controller.targets.count, 128);
    run(1000);
    for (uint32_t i = 0; i < 128U; i++) {
        struct target_update update = at(i, (int64_t)(i * 10000U + 59U), 9000000, 59);
        const int64_t apart = apart_nrad(i, &update);
        CHECK(apart >= 0 && apart <= 2);
    }
    CHECK(!targets.has_news && link_.status.stale == 0U &&
          desk_loop.pump.errors.updates_dropped == 0U);
    struct target_update one_more = at(5000, 1, 1, 1);
    for (uint32_t i = 128; i < 256U; i++) {
        const struct target_update update = at(i, 1, 1, 1);
        CHECK(board_targets_take(&targets, &update, our_time()));
    }
    CHECK(!board_targets_take(&targets, &one_more, our_time()));
}

/// A byte in 300 is damaged or lost, both ways: commands get through, once; targets get there; the
/// clocks' bounds hold; the board keeps its owner.
static void a_noisy_line(void) {
    check_note("seed", (int64_t)dice);
    meet();
    damage_in = 300;
    uint32_t retried = 0;
    for (uint32_t round = 0; round < 40U; round++) {
        if (!CHECK(order(round % 2U == 0U ? "arm" : "stop") && !link_.refused)) {
            return;
        }
        retried += link_.command_tries > 1U;
        run(1500); // longer than it takes to stop
        const struct target_update update = at(7, (int64_t)round * 100000, 5000000, 1000000);
        CHECK(board_targets_take(&targets, &update, our_time()));
        run(60);
        CHECK(desk_driven() == (round % 2U == 0U));
        CHECK(desk_loop.console.link.owned);
        uint64_t board_us, error_us;
        CHECK(board_clock_read(&link_.clock, our_time(), &board_us, &error_us));
        const int64_t off = (int64_t)(board_us - desk_loop.console.now_us);
        CHECK(off <= (int64_t)error_us && off >= -(int64_t)error_us);
        if (!check_clean()) {
            return;
        }
    }
    check_note("commands that had to be sent again", retried);
    check_note("lines damaged on the way there", desk_loop.console.splitter.damaged);
    check_note("and back", link_.splitter.damaged);
    CHECK(retried > 0U && link_.splitter.damaged > 10U);
    damage_in = 0;
    const struct target_update update = at(7, 0, 5000000, 0);
    CHECK(board_targets_take(&targets, &update, our_time()));
    run(60);
    CHECK(apart_nrad(0, &update) <= 2);
}

/// Told 20 times a second, the longest gap is one of those, or of the meeting.
static void gaps_are_told(void) {
    meet();
    run(2000);
    CHECK(link_.gap_us_max >= 45000U && link_.gap_us_max <= 150000U);
    const uint64_t before_us = link_.gap_us_max;
    desk.deaf = true;
    desk.queue_count = 0;
    run(700);
    CHECK_EQ(link_.gap_us_max, before_us);
}

/// A board is one program's: another one, which calls itself otherwise, hears so.
static void another_program_has_it(void) {
    meet();
    board_link_init(&link_, &our_serial, 115200, 0x11, our_time());
    board_link_hello(&link_);
    run(300);
    CHECK(link_.identity.busy && !link_.identity.known);
    board_link_init(&link_, &our_serial, 115200, 0x5e, our_time()); // the first one, started again
    board_link_hello(&link_);
    run(300);
    CHECK(link_.identity.known && !link_.identity.busy);
}

static void the_port_leaves(void) {
    meet();
    run(500);
    CHECK(!link_.gone);
    unplugged = true;
    run(2);
    CHECK(link_.gone);
    unplugged = false;
    run(50);
    CHECK(link_.gone); // for good, until it is opened again
}

/// The board does not answer at all.
static void a_dead_line(void) {
    meet();
    desk.deaf = true;
    desk.queue_count = 0;
    board_link_order(&link_, "arm", our_time());
    run(1500);
    CHECK_EQ(link_.command, BOARD_LINK_LOST);
    CHECK(our_time() - link_.heard_us > 1400000U);
}

/// From the moment at which the board falls silent nothing else may be said of it, whichever kind
/// of line was its last; and one that only answers has let go of us.
static void silent_or_let_go(void) {
    for (uint32_t phase_ms = 0; phase_ms < 100U; phase_ms += 7U) {
        meet();
        run(200U + phase_ms);
        desk.deaf = true;
        desk.queue_count = 0;
        enum board_link_presence presence = BOARD_LINK_THERE;
        for (uint32_t ms = 0; ms < 1500U && presence == BOARD_LINK_THERE; ms++) {
            run(1);
            presence = board_link_presence(&link_, our_time());
        }
        CHECK_EQ(presence, BOARD_LINK_SILENT);
        CHECK(our_time() - link_.heard_us <= BOARD_LINK_SILENCE_US + 1000U);
    }
    meet();
    run(200);
    const uint64_t left_us = our_time();
    desk_boot(); // now it belongs to nobody
    while (board_link_presence(&link_, our_time()) == BOARD_LINK_THERE &&
           our_time() - left_us < 3000000U) {
        run(1);
    }
    CHECK_EQ(board_link_presence(&link_, our_time()), BOARD_LINK_LET_GO);
    CHECK(our_time() - left_us <= BOARD_LINK_SILENCE_US + 100000U);
}

/// A stop does not wait for what is in front of it.
static void stop_goes_first(void) {
    meet();
    CHECK(order("arm"));
    for (uint32_t i = 0; i < 64U; i++) {
        const struct target_update update = at(i, (int64_t)(i * 31000U), 9000000, 0);
        CHECK(board_targets_take(&targets, &update, our_time()));
    }
    run(4); // the frame has just begun, and takes 38 ms
    CHECK(board_link_waiting(&link_) > 300U);
    board_link_order(&link_, "stop", our_time());
    uint32_t ms = 0;
    while (desk_mode() != MODE_STOPPED && ms < 100U) {
        run(1);
        ms++;
    }
    check_note("milliseconds to a stop with a frame on its way", ms);
    CHECK(ms <= 8U);
}

/// The examples of docs/link.md.
static void the_examples(void) {
    FILE *file = fopen("docs/link.md", "r");
    char text[512];
    unsigned count = 0;
    while (CHECK(file != NULL) && fgets(text, sizeof text, file) != NULL) {
        struct checked_line line;
        const size_t size = strcspn(text, "\n");
        if (text[0] == '$' && !CHECK(checked_line_read(text + 1, (uint32_t)size - 1U, &line))) {
            check_note("example", count);
        }
        count += text[0] == '$';
    }
    if (file != NULL) {
        fclose(file);
    }
    CHECK(count >= 13U);
}

int main(void) {
    TEST(they_meet);
    TEST(clocks_agree);
    TEST(few_targets_go_as_they_are);
    TEST(many_targets_20_times_a_second);
    TEST(more_than_fits);
    TEST(a_noisy_line);
    TEST(gaps_are_told);
    TEST(another_program_has_it);
    TEST(the_port_leaves);
    TEST(a_dead_line);
    TEST(silent_or_let_go);
    TEST(stop_goes_first);
    TEST(the_examples);
    return check_finish();
}
