/// app/program_link through a line of 115,200 baud: owners, commands, targets, status, silence.
#include "program.h"

#include "app/settings_digest.h"
#include "link/compact.h"

// ---------------------------------------------------------------- owner

static void hello_tells_who_it_is(void) {
    char wanted[80];
    desk_configure();
    desk_start(115200);
    me.sequence = 6;
    desk_ticks(50);
    send(&me, 'h', "1");
    desk_ticks(20);
    CHECK(hear('H') && got.host == ME && got.sequence == 7U);
    text_begin(&text, wanted, sizeof wanted - 1U);
    text_string(&text, "1 ");
    text_hex_digits(&text, settings_digest(&desk_settings), 8);
    text_character(&text, ' ');
    text_string(&text, build_id);
    wanted[text.size_bytes] = '\0';
    CHECK(body_is(wanted));
}

static void one_owner(void) {
    switch_on();
    send(&other, 'h', "1");
    desk_ticks(20);
    CHECK(hear('H') && got.host == OTHER && body_is("busy"));
    CHECK(command(&other, "arm", "no say hello first") && !desk_driven());
    CHECK(command(&me, "arm", "ok") && desk_driven());
    send(&other, 't', "----.1 0 10 0");
    send(&other, 'b', "");
    desk_ticks(20);
    CHECK(desk_loop.controller.targets.count == 0U && desk_driven());
    CHECK(command(&other, "stop", "ok")); // from anybody
    CHECK_EQ(desk_mode(), MODE_STOPPED);
}

static void a_person_may_look_and_stop(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    desk_forget();
    desk_type("aim 9 9\r");
    desk_ticks(30);
    CHECK(desk_says("error: a program has the board"));
    send(&me, 'p', "");
    desk_type("arm\rset pan.speed_max_dps 1\rtarget 1 1 1 1\rhome\rgone 1\r");
    desk_ticks(100);
    CHECK(desk_loop.controller.targets.count == 0U);
    desk_forget();
    desk_type("status\r");
    desk_ticks(100);
    CHECK(desk_says("mode: holding"));
    send(&me, 'p', "");
    desk_type("stop\r");
    desk_ticks(30);
    CHECK_EQ(desk_mode(), MODE_STOPPED);
}

static void silence_stops_and_forgets(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    send(&me, 't', "----.1 5 10 0;2 6 10 0");
    desk_ticks(470);
    CHECK(desk_mode() == MODE_TRACKING && desk_loop.controller.targets.count == 2U);
    desk_ticks(80);
    CHECK(desk_mode() == MODE_STOPPED && desk_loop.controller.targets.count == 0U);
    hear('S');
    desk_ticks(200);
    CHECK(!hear('S')); // nobody to tell
    send(&other, 'h', "1");
    desk_ticks(100);
    CHECK(hear('S') && got.host == OTHER && !desk_driven());
}

static void good_bye(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    send(&me, 't', "----.1 5 10 0");
    send(&me, 't', "----+2 5 10 0");
    desk_ticks(50);
    CHECK_EQ(desk_loop.controller.targets.count, 1);
    send(&me, 'b', "");
    desk_ticks(20);
    CHECK(hear('B') && desk_mode() == MODE_STOPPED && desk_loop.controller.targets.count == 0U);
}

// ---------------------------------------------------------------- commands

static void commands(void) {
    switch_on();
    CHECK(command(&me, "get pan.speed_max_dps", "ok pan.speed_max_dps 100"));
    CHECK(command(&me, "set pan.speed_max_dps 50", "ok"));
    CHECK(command(&me, "get pan.speed_max_dps", "ok pan.speed_max_dps 50"));
    CHECK(command(&me, "get", "no no such setting; `get` lists them"));
    CHECK(command(&me, "help", "no this is for people"));
    CHECK(command(&me, "fly", "no no such command; `help` lists them"));
    CHECK(command(&me, "", "no no such command; `help` lists them"));
    CHECK(command(&me, "arm", "ok") && command(&me, "aim 10 5", "ok"));
    send(&me, 'p', "");
    desk_ticks(400);
    send(&me, 'p', "");
    desk_ticks(400);
    CHECK(desk_cdeg(AXIS_PAN) == 1000 && desk_cdeg(AXIS_TILT) == 500);
    CHECK(command(&me, "home", "ok"));
    desk.pressed = true;
    desk_ticks(10);
    CHECK(command(&me, "arm", "no emergency stop"));
    CHECK(
        command(&me, "set pan.speed_max_dps 1",
                "no not while an axis is driven: it can be changed after a reset, before arming"));
}

/// A command that comes twice, because its answer was lost, is obeyed once and answered twice.
static void a_command_again(void) {
    switch_on();
    CHECK(command(&me, "arm", "ok"));
    CHECK(command(&other, "stop", "ok"));
    me.sequence--;
    CHECK(command(&me, "arm", "ok"));
    CHECK(desk_mode() == MODE_STOPPED && counted()->repeated == 1U);
    me.sequence++;
    CHECK(command(&me, "arm", "ok") && desk_driven());
}

// ---------------------------------------------------------------- targets

static void targets_as_text(void) {
    switch_on();
    send(&me, 't', "----.7 0 10 0 .5;8 dir 1 1 0;9 1 2 3;9 gone;");
    desk_ticks(30);
    const struct target_set *set = &desk_loop.controller.targets;
    uint32_t place = 0;
    CHECK(set->count == 2U && target_set_find(set, 7, &place));
    CHECK_NEAR(set->target[place].radius_bam32, 34192522, 100); // asin .05 / 360 * 2^32
    CHECK(target_set_find(set, 8, &place));
    CHECK_NEAR(set->direction_q30[place].x, 759250125, 1);
    send(&me, 't', "----.7 gone;8 nonsense;7 0 1 0");
    desk_ticks(30);
    CHECK(set->count == 1U && counted()->refused == 1U); // what follows nonsense is not read
}

static void compact_targets(void) {
    switch_on();
    begin(&me, 'd');
    text_string(&text, "----.10");
    compact_write(&text, bam32(BAM32_QUARTER), bam32(0));
    text_string(&text, "~");
    compact_write(&text, bam32(0), bam32(BAM32_QUARTER / 2U));
    end();
    desk_ticks(30);
    const struct target_set *set = &desk_loop.controller.targets;
    uint32_t place = 0;
    CHECK(set->count == 2U && target_set_find(set, 16, &place));
    CHECK_EQ(set->direction_q30[place].x, Q30_ONE);
    CHECK(!target_set_find(set, 17, &place) && target_set_find(set, 18, &place));
    CHECK_NEAR(set->direction_q30[place].z, 759250125, 1);
    static const char *const wrong[] = {
        "", "----.", "----.1", "----.1x000P00", "---010000P00", "----.20000P0", "----.20000P0p"};
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        send(&me, 'd', wrong[i]);
        desk_ticks(30);
        CHECK_EQ(counted()->refused + counted()->stale, i + 1U);
        CHECK_EQ(set->count, 2);
    }
}

static void stamps(void) {
    static const struct {
        int64_t age;
        bool taken;
    } cases[] = {{0, true},    {240, true},   {260, false},   {-40, true},
                 {-60, false}, {1000, false}, {32767, false}, {-32768, false}};
    switch_on();
    desk_ticks(123);
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const uint32_t before = counted()->taken;
        begin(&me, 't');
        put_stamp(cases[i].age);
        text_string(&text, ".1 0 1 0");
        end();
        desk_ticks(5);
        CHECK_EQ(counted()->taken - before, cases[i].taken);
    }
    CHECK_EQ(counted()->stale, 5);
}

static void overtaken_targets(void) {
    switch_on();
    me.sequence = 200;
    send(&me, 't', "----.1 0 1 0");
    me.sequence = 200;
    send(&me, 't', "----.2 0 1 0"); // the same number again
    me.sequence = 150;
    send(&me, 't', "----.3 0 1 0"); // an old one
    me.sequence = 10;               // 201 + 66
    send(&me, 't', "----.4 0 1 0");
    desk_ticks(30);
    uint32_t place = 0;
    const struct target_set *set = &desk_loop.controller.targets;
    CHECK(set->count == 2U && target_set_find(set, 1, &place) && target_set_find(set, 4, &place));
    CHECK_EQ(counted()->repeated, 2);
}

// ---------------------------------------------------------------- status

static void status(void) {
    switch_on();
    hear('S');
    send(&me, 'p', "");
    desk_ticks(250);
    CHECK(hear('S'));
    uint32_t lines = 0;
    for (uint32_t i = 0; i < 10U; i++) {
        send(&me, 'p', "");
        desk_ticks(100);
        CHECK(hear('S'));
        lines += got.count;
    }
    CHECK_EQ(lines, 20);
    CHECK_EQ(got.host, ME);
    CHECK_EQ(status_word(0).size_bytes, 16);
    CHECK(word_is(status_word(1), "ready") && word_is(status_word(2), "0"));
    CHECK(word_is(status_word(3), "0") && word_is(status_word(5), "-"));
    CHECK(command(&me, "arm", "ok") && command(&me, "aim 10.25 -5.5", "ok"));
    send(&me, 't', "----.");
    send(&me, 'p', "");
    desk_ticks(400);
    send(&me, 'p', "");
    desk_ticks(400);
    desk.pressed = true;
    send(&me, 'p', "");
    desk_ticks(100);
    CHECK(hear('S') && word_is(status_word(1), "stopped"));
    CHECK(word_is(status_word(3), "10.25") || word_is(status_word(3), "10.249"));
    CHECK(word_is(status_word(6), "-5.5") || word_is(status_word(6), "-5.501"));
    CHECK(word_is(status_word(10), "1")); // targets
    CHECK(word_is(status_word(12), "3")); // lines taken
    CHECK(word_is(status_word(17), "emergency") && word_is(status_word(18), "stop"));
}

/// What nobody takes is left out by whole lines.
static void nobody_listens(void) {
    static struct line_splitter splitter;
    switch_on();
    desk.deaf = true;
    for (uint32_t i = 0; i < 60U; i++) {
        send(&me, 'p', "");
        desk_ticks(20);
    }
    desk.deaf = false;
    desk_ticks(300);
    line_splitter_init(&splitter);
    for (uint32_t i = 0; i < desk.said_count; i++) {
        (void)line_splitter_take(&splitter, (uint8_t)desk.said[i]);
    }
    CHECK(desk.said_count > 1000U && splitter.damaged == 0U && desk_loop.console.lost_lines > 10U);
}

/// The time of the tick in which the line was read.
static void time_comes_back(void) {
    switch_on();
    for (uint32_t i = 0; i < 20U; i++) {
        send(&me, 'p', "");
        desk_ticks(20);
        CHECK(hear('P') && got.size == 16U && got.sequence == me.sequence);
        uint32_t low;
        CHECK(word_hex((struct word){got.body + 8, 8}, 8, &low));
        const int64_t age_us = (int64_t)(uint32_t)desk_loop.console.now_us - low;
        CHECK(age_us >= 17000 && age_us <= 19000);
    }
}

int main(void) {
    TEST(hello_tells_who_it_is);
    TEST(one_owner);
    TEST(a_person_may_look_and_stop);
    TEST(silence_stops_and_forgets);
    TEST(good_bye);
    TEST(commands);
    TEST(a_command_again);
    TEST(targets_as_text);
    TEST(compact_targets);
    TEST(stamps);
    TEST(overtaken_targets);
    TEST(status);
    TEST(nobody_listens);
    TEST(time_comes_back);
    return check_finish();
}
