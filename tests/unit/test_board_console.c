/// app/board_console for a person: golden transcripts, what commands do, and any bytes at all.
#include "desk.h"

/// Past the greeting, with a prompt.
static void sit_down(void) {
    desk_configure();
    desk_start(0);
    desk_ticks(20);
    desk_forget();
    desk_type("\r");
    desk_ticks(2);
    CHECK(desk_said("\r> \033[K\r\n\r> \033[K"));
}

/// Types a line and checks all that comes of it, echo and prompt included.
static bool command(const char *line, const char *wanted) {
    desk_type(line);
    desk_type("\r");
    desk_ticks(30);
    return desk_said(wanted);
}

static void transcript_of_a_first_session(void) {
    desk_configure();
    desk_start(0);
    desk_ticks(2100);
    CHECK(desk_says("\r\nboard: desk\r\nreset: power-on\r\n"));
    CHECK(desk_says(
        "     2 s  ready  pan    0.00  tilt    0.00  targets 0  busy 0 us  missed 0\r\n"));
    desk_forget();
    desk_type("h");
    desk_ticks(3000); // no more telemetry from here on
    CHECK(desk_said("\r> \033[Kh"));
    CHECK(command("\177arn",
                  "\r> \033[Karn\r\nerror: no such command; `help` lists them\r\n\r> \033[K"));
    CHECK(command("arm", "arm\r\nok\r\n\r> \033[K"));
    CHECK(desk_driven() && desk.enable);
    CHECK(command("aim 10 -5", "aim 10 -5\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK(desk_cdeg(AXIS_PAN) == 1000 && desk_cdeg(AXIS_TILT) == -500);
    CHECK(desk_mode() == MODE_TRACKING);
    desk_type("status\r");
    desk_ticks(30);
    CHECK(desk_says("status\r\nboresight ") && desk_says(build_id));
    CHECK(desk_says("\r\nmode: tracking\r\n"
                    "pan:  at 10.00, goal 10.00, not measured\r\n"
                    "tilt: at -5.00, goal -5.00, not measured\r\n"
                    "targets: 1, rejected 0, dropped 0\r\n"
                    "tick: busy 0 us at most, missed 0\r\n"
                    "\r> \033[K"));
    desk_forget();
    CHECK(command("home", "home\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK(desk_cdeg(AXIS_PAN) == 0 && desk_cdeg(AXIS_TILT) == 0);
    CHECK(command("stop", "stop\r\nok\r\n\r> \033[K"));
    CHECK_EQ(desk_mode(), MODE_STOPPED);
}

static void targets_and_aims(void) {
    sit_down();
    CHECK(command("arm", "arm\r\nok\r\n\r> \033[K"));
    CHECK(command("aim 40 0", "aim 40 0\r\nok\r\n\r> \033[K"));
    CHECK(command("target 1 0 10 0", "target 1 0 10 0\r\nok\r\n\r> \033[K"));
    CHECK(command("target 2 dir 1 1 0", "target 2 dir 1 1 0\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK_EQ(desk_loop.controller.targets.count, 2); // not what was aimed at
    CHECK_EQ(desk_cdeg(AXIS_PAN), 2250);             // halfway from 0 to 45
    CHECK(command("gone 2", "gone 2\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK_EQ(desk_cdeg(AXIS_PAN), 0);
    CHECK(command("aim -20 5", "aim -20 5\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK_EQ(desk_loop.controller.targets.count, 1);
    CHECK_EQ(desk_cdeg(AXIS_PAN), -2000);
}

/// From one object to another, with the aim on the way in between.
static void pans_between_objects(void) {
    sit_down();
    CHECK(command("arm", "arm\r\nok\r\n\r> \033[K"));
    CHECK(command("pan 1 0", "pan 1 0\r\nok\r\n\r> \033[K"));
    CHECK(command("target 1 0 10 0 0 1 1", "target 1 0 10 0 0 1 1\r\nok\r\n\r> \033[K"));
    CHECK(command("target 2 dir 1 1 0 0 1 2", "target 2 dir 1 1 0 0 1 2\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK_EQ(desk_cdeg(AXIS_PAN), 0);
    CHECK(command("pan 2 2 angle", "pan 2 2 angle\r\nok\r\n\r> \033[K"));
    desk_ticks(800);
    CHECK(desk_loop.pump.output.status.panning);
    CHECK(desk_cdeg(AXIS_PAN) > 500 && desk_cdeg(AXIS_PAN) < 4000);
    desk_ticks(3000);
    CHECK(!desk_loop.pump.output.status.panning);
    CHECK_EQ(desk_cdeg(AXIS_PAN), 4500);
    CHECK(command("pan all 0", "pan all 0\r\nok\r\n\r> \033[K"));
    desk_ticks(2000);
    CHECK_EQ(desk_cdeg(AXIS_PAN), 2250);
}

/// As many as there is room for; then the number is named, and what is watched already still moves.
static void the_257th_target(void) {
    sit_down();
    for (uint32_t id = 1; id <= TARGET_CAPACITY; id++) {
        const struct target_update update = {.kind = TARGET_DIRECTION,
                                             .id = id,
                                             .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                             .direction = {(int32_t)id, 1000, 0}};
        CHECK(pump_push(&desk_loop.pump, &update));
        desk_ticks(1);
    }
    CHECK_EQ(desk_loop.controller.targets.count, TARGET_CAPACITY);
    CHECK(command("target 300 0 10 0",
                  "target 300 0 10 0\r\nerror: 256 targets are watched, and there is no room for "
                  "more\r\n\r> \033[K"));
    CHECK(command("target 5 0 10 0", "target 5 0 10 0\r\nok\r\n\r> \033[K"));
    CHECK(command("gone 5", "gone 5\r\nok\r\n\r> \033[K"));
    desk_ticks(2);
    CHECK(command("target 300 0 10 0", "target 300 0 10 0\r\nok\r\n\r> \033[K"));
    desk_ticks(2);
    CHECK_EQ(desk_loop.controller.targets.count, TARGET_CAPACITY);
    CHECK_EQ(desk_loop.controller.updates_rejected, 0);
}

static void wrong_commands_move_nothing(void) {
    sit_down();
    CHECK(command("aim 1",
                  "aim 1\r\nerror: expected PAN TILT [RADIUS] in degrees: aim 30 -5.5; pan "
                  "-360 to 360, tilt -90 to 90, radius below 90\r\n\r> \033[K"));
    CHECK(command("set a 1", "set a 1\r\nerror: no such setting; `get` lists them\r\n\r> \033[K"));
    desk.pressed = true;
    desk_ticks(2);
    CHECK(command("arm", "arm\r\nerror: emergency stop\r\n\r> \033[K"));
    desk.pressed = false;
    desk_ticks(10);
    CHECK(!desk_driven() && desk.pulses == 0U);
    CHECK(command("", "\r\n\r> \033[K"));
    CHECK(command("   ", "   \r\n\r> \033[K"));
}

static void stop_key_stops(void) {
    sit_down();
    CHECK(command("arm", "arm\r\nok\r\n\r> \033[K"));
    CHECK(command("aim 90 0", "aim 90 0\r\nok\r\n\r> \033[K"));
    desk_ticks(200);
    desk_type("aim 4\003");
    desk_ticks(2);
    CHECK(desk_said("aim 4^C\r\n\r> \033[K"));
    CHECK_EQ(desk_mode(), MODE_STOPPED);
}

static void help_lists_every_command(void) {
    sit_down();
    desk_type("help\r");
    desk_ticks(30);
    static const char *const names[] = {"\nhelp ", "\nstatus ", "\narm ",    "\nstop ",
                                        "\nhome ", "\naim ",    "\ntarget ", "\ngone ",
                                        "\npan ",  "\nget ",    "\nset ",    "\ntrace "};
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) {
        CHECK(desk_says(names[i]));
    }
    CHECK(desk_says("a line of telemetry every so often\r\n\r> \033[K"));
}

/// Telemetry goes above what is being typed, which is shown again.
static void trace_while_typing(void) {
    sit_down();
    CHECK(command("trace on 100", "trace on 100\r\nok\r\n\r> \033[K"));
    desk_type("ai");
    desk_ticks(75);
    CHECK(desk_said(
        "ai\r\033[K     0 s  ready  pan    0.00  tilt    0.00  targets 0  busy 0 us  missed "
        "0\r\n\r> ai\033[K"));
    desk_ticks(1000);
    uint32_t count = 0;
    for (uint32_t i = 0; i < desk.said_count; i++) {
        count += desk.said[i] == '\n';
    }
    CHECK_EQ(count, 10);
    desk_type("\025trace off\r");
    desk_ticks(20);
    desk_forget();
    desk_ticks(3000);
    CHECK_EQ(desk.said_count, 0);
}

/// A terminal that nobody reads must not slow the board down, and gets whole lines later.
static void a_deaf_terminal(void) {
    sit_down();
    desk_type("trace on 10\r");
    desk.deaf = true;
    desk_ticks(2000);
    desk_type("arm\r");
    desk_ticks(10);
    CHECK(desk_driven());
    desk_type("\003");
    desk_ticks(5);
    CHECK_EQ(desk_mode(), MODE_STOPPED);
    desk.deaf = false;
    desk_type("\rtrace off\r");
    desk_ticks(200);
    desk_forget();
    CHECK(command("get pan.speed_max_dps",
                  "get pan.speed_max_dps\r\npan.speed_max_dps 100\r\n\r> \033[K"));
}

/// Any bytes, with pieces of commands and lines among them. None of it is a whole command that
/// moves, so nothing may move; and what comes after it is understood.
static void any_bytes(void) {
    static const char *const pieces[] = {"arm", "aim 10 1", "$3f1ac",   "*c96c",           "\033[A",
                                         "\r",  "stop",     "target 1", "home\t",          "set ",
                                         "\n",  "get",      "$3f00h",   "$3f1acarm*c96d\n"};
    uint64_t state = 31337;
    check_note("seed", (int64_t)state);
    sit_down();
    for (uint32_t round = 0; round < 300U; round++) {
        for (uint32_t i = 0; i < 300U; i++) {
            const uint64_t random = check_random(&state);
            if ((random & 7U) == 0U) {
                const uint32_t which = (uint32_t)(random >> 32) % 14U;
                desk_type(pieces[which]);
                desk_type("\x80x"); // not even a command in pieces
            } else {
                // Not the keys that end a line, erase or recall: they could make a command of the
                // pieces.
                char byte = (char)(random >> 40);
                byte = byte == '\r' || byte == '\n' || (byte >= 1 && byte < 27) ? '~' : byte;
                desk_send(&byte, 1);
            }
        }
        desk_ticks(60);
        CHECK(!desk_driven());
        desk_forget();
        desk_type("\003\r");
        desk_ticks(20);
        desk_forget();
        if (!CHECK(command("get pan.speed_max_dps",
                           "get pan.speed_max_dps\r\npan.speed_max_dps 100\r\n\r> \033[K"))) {
            return;
        }
    }
    CHECK_EQ(desk.pulses, 0);
}

int main(void) {
    TEST(transcript_of_a_first_session);
    TEST(targets_and_aims);
    TEST(pans_between_objects);
    TEST(the_257th_target);
    TEST(wrong_commands_move_nothing);
    TEST(stop_key_stops);
    TEST(help_lists_every_command);
    TEST(trace_while_typing);
    TEST(a_deaf_terminal);
    TEST(any_bytes);
    return check_finish();
}
