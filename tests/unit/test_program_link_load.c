/// app/program_link under load: 64 targets 20 times a second through 115,200 baud, floods, damage.
#include "program.h"

#include "link/compact.h"

// ---------------------------------------------------------------- throughput

/// A frame of 64 directions in three lines, as docs/link.md describes them. Returns its bytes.
static uint32_t send_frame(uint32_t frame) {
    uint32_t bytes = 0;
    for (uint32_t first = 0; first < 64U; first += 22U) {
        begin(&me, 'd');
        put_stamp(0);
        text_character(&text, first + 22U < 64U ? '+' : '.');
        text_hex_digits(&text, first, 2);
        for (uint32_t i = first; i < first + 22U && i < 64U; i++) {
            compact_write(&text, bam32((i * 20000000U + frame * 1000000U)), bam32(i * 4000000U));
        }
        end();
        bytes += text.size_bytes;
    }
    return bytes;
}

static void sixty_four_targets_at_20_hz(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    const uint32_t frames = 100;
    const uint32_t bytes_before = desk.bytes_in, out_before = desk.bytes_out;
    const uint32_t taken_before = counted()->taken;
    uint32_t bytes = 0, waited_ms = 0;
    for (uint32_t frame = 0; frame < frames; frame++) {
        bytes = send_frame(frame);
        uint32_t ms = 0;
        while (desk_loop.controller.targets.count < 64U || desk.queue_count != 0U) {
            desk_ticks(1);
            if (!CHECK(++ms < 50U)) {
                return;
            }
        }
        waited_ms = ms > waited_ms ? ms : waited_ms;
        desk_ticks(50U - ms);
    }
    check_note("bytes in a frame of 64 targets", bytes);
    check_note("bytes to the board in a second",
               (int64_t)(desk.bytes_in - bytes_before) * 20 / frames);
    check_note("of 11,520 that 115,200 baud carries, percent",
               (int64_t)(desk.bytes_in - bytes_before) * 2000 / frames / 11520 + 1);
    check_note("bytes from the board in a second",
               (int64_t)(desk.bytes_out - out_before) * 20 / frames);
    check_note("milliseconds until the last target of a frame is in", waited_ms);
    CHECK_EQ(counted()->taken - taken_before, 3U * frames);
    CHECK_EQ(desk_loop.controller.targets.count, 64);
    CHECK(desk.lost == 0U && desk_loop.console.splitter.damaged == 0U);
    CHECK(desk_loop.pump.errors.updates_dropped == 0U && desk_mode() == MODE_TRACKING);
    CHECK(desk_loop.console.lost_lines == 0U);
    // The last frame is what the controller has.
    uint32_t place = 0;
    CHECK(target_set_find(&desk_loop.controller.targets, 63, &place));
    const struct target_update last =
        request_aim(bam32(63U * 20000000U + 99U * 1000000U), bam32(63U * 4000000U), 0);
    const struct vec3 *direction = &desk_loop.controller.targets.direction_q30[place];
    CHECK_NEAR(direction->x, last.direction.x, 20000); // 19 millionths: a step of pan
    CHECK_NEAR(direction->y, last.direction.y, 20000);
    CHECK_NEAR(direction->z, last.direction.z, 20000);
}

/// However long its lines take, a frame changes the aim once.
static void a_frame_in_one_tick(void) {
    switch_on();
    (void)send_frame(0);
    uint32_t steps = 0, before = 0;
    for (uint32_t i = 0; i < 60U; i++) {
        desk_ticks(1);
        steps += desk_loop.controller.framing.framed_count != before;
        before = desk_loop.controller.framing.framed_count;
    }
    CHECK(steps == 1U && before == 64U);
    // The last line lost: what came is taken after a while, and the next frame is one again.
    send(&me, 't', "----+64 0 1 0");
    desk_ticks(90);
    CHECK_EQ(desk_loop.controller.targets.count, 64);
    desk_ticks(30);
    CHECK_EQ(desk_loop.controller.targets.count, 65);
    send(&me, 't', "----+65 0 1 0");
    send(&me, 't', "----+66 0 1 0");
    send(&me, 't', "----.");
    desk_ticks(30);
    CHECK_EQ(desk_loop.controller.targets.count, 67);
    // A command does not overtake the targets before it.
    send(&me, 't', "----+67 0 1 0");
    CHECK(command(&me, "gone 0", "ok") && command(&me, "gone 1", "ok"));
    CHECK_EQ(desk_loop.controller.targets.count, 66);
}

static uint32_t ticks_until_stopped(void) {
    uint32_t ticks = 0;
    while (desk_mode() != MODE_STOPPED && ticks < 1000U) {
        desk_ticks(1);
        ticks++;
    }
    return ticks;
}

/// The line is never free for two seconds: nothing is lost, and a stop takes no longer than it
/// takes to come down the line.
static void a_full_line(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    for (uint32_t i = 0; i < 2000U; i++) {
        if (desk.queue_count - desk.queue_at < 40U) {
            (void)send_frame(i);
        }
        desk_ticks(1);
    }
    CHECK(desk.lost == 0U && desk_loop.console.splitter.damaged == 0U);
    CHECK_EQ(desk_mode(), MODE_TRACKING);
    desk.queue_at = desk.queue_count; // a program drops what waits
    send(&me, 'c', "stop");
    CHECK(ticks_until_stopped() <= 6U);
}

/// Ten times more than a line carries, so that bytes are lost: what is whole counts, and somebody
/// who holds Ctrl-C down is heard at once.
static void flood(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    desk.byte_ns = 8680;
    for (uint32_t i = 0; i < 500U; i++) {
        (void)send_frame(i);
        desk_ticks(4);
    }
    CHECK(desk_mode() == MODE_TRACKING && desk.lost > 10000U);
    for (uint32_t i = 0; i < 30U; i++) {
        (void)send_frame(i);
        desk_type("\003");
        desk_ticks(1);
        if (desk_mode() == MODE_STOPPED) {
            check_note("a stop key held down, ticks", i + 1U);
            return;
        }
    }
    CHECK_EQ(desk_mode(), MODE_STOPPED);
}

// ---------------------------------------------------------------- damage

/// Good lines that must move nothing, and damaged ones that would: `arm` and targets with bytes
/// changed, lost, added. Nothing may arm; after each round a good line is understood.
static void damage_moves_nothing(void) {
    uint64_t state = 424242;
    check_note("seed", (int64_t)state);
    switch_on();
    for (uint32_t round = 0; round < CHECK_ROUNDS(4000U); round++) {
        begin(&me, 'c');
        text_string(&text, (round & 1U) != 0U ? "arm" : "aim 40 30");
        CHECK(checked_line_end(&text));
        me.sequence--;
        const uint32_t hits = 1U + (uint32_t)(check_random(&state) % 3U);
        char whole[CHECKED_LINE_BYTES_MAX];
        bool differs = false;
        for (uint32_t i = 0; i < text.size_bytes; i++) {
            whole[i] = buffer[i];
        }
        for (uint32_t i = 0; i < hits; i++) {
            const uint64_t random = check_random(&state);
            const uint32_t at = (uint32_t)(random >> 32) % text.size_bytes;
            const char byte = (char)(random >> 8);
            const bool is_end = at == text.size_bytes - 1U; // CR ends a line as well
            buffer[at] = is_end || byte == 3 ? buffer[at] : byte;
        }
        for (uint32_t i = 0; i < text.size_bytes; i++) {
            differs = differs || whole[i] != buffer[i];
        }
        if (!differs) {
            continue;
        }
        desk_send(buffer, text.size_bytes);
        desk_ticks(4);
        desk_type("\n");
        desk_ticks(1);
        const uint32_t before = counted()->taken;
        send(&me, 't', "----.1 gone");
        desk_ticks(4);
        if (!CHECK(!desk_driven() && desk_loop.controller.targets.count == 0U &&
                   counted()->taken == before + 1U)) {
            check_note("round", round);
            return;
        }
    }
    CHECK_EQ(desk.pulses, 0);
    check_note("damaged lines", desk_loop.console.splitter.damaged);
}

/// Good lines of any type and any body, from any host: bounded work, a defined answer, nothing
/// moves that was not armed.
static void any_good_line(void) {
    static const char types[] = "hcptdbxHCPS";
    static const char *const bodies[] = {"stop",      "home",   "set pan.speed_max_dps ",
                                         "target 1 ", "----.",  "----.00",
                                         ";;;;",      "gone 1", "0000",
                                         "~~~~",      "1"};
    uint64_t state = 777;
    check_note("seed", (int64_t)state);
    switch_on();
    for (uint32_t i = 0; i < CHECK_ROUNDS(12000U); i++) {
        const uint64_t random = check_random(&state);
        struct program any = {(random & 3U) != 0U ? ME : (uint8_t)(random >> 8),
                              (uint8_t)(random >> 16)};
        begin(&any, types[(random >> 24) % (sizeof types - 1U)]);
        text_string(&text, bodies[(random >> 32) % 11U]);
        const uint32_t more = (uint32_t)(random >> 40) % 60U;
        for (uint32_t c = 0; c < more; c++) {
            const char byte = (char)(' ' + check_random(&state) % 95U);
            text_character(&text, byte == '$' || byte == '*' ? '~' : byte);
        }
        end();
        desk_ticks((random >> 60) == 0U ? 600U : 3U);
        desk_forget();
        if (!CHECK(!desk_driven())) {
            return;
        }
    }
    CHECK_EQ(desk.pulses, 0);
    desk_ticks(600);
    me.sequence = 0;
    send(&me, 'h', "1");
    desk_ticks(30);
    CHECK(hear('H') && body_begins("1 "));
}

int main(void) {
    TEST(sixty_four_targets_at_20_hz);
    TEST(a_frame_in_one_tick);
    TEST(a_full_line);
    TEST(flood);
    TEST(damage_moves_nothing);
    TEST(any_good_line);
    return check_finish();
}
