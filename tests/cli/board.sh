#!/bin/sh
# `boresight run` with a board on a serial line: a pseudo-terminal with the boards' own loop behind it. What comes of it, and every way
# in which it can fail: one line with a remedy, exit status 4.
. tests/cli/support/check.sh
pty_board=build/gcc/tests/cli/support/pty_board
rig=$dir/rig.ini
tty=$dir/tty

make_rig() { # LINES-OF-[controller]
    {
        sed 's/^settle_ms.*/settle_ms = 100/' host-sim/rigs/hobby.ini
        printf '[controller]\n%s\n' "$1"
    } >"$rig"
}
# board MODE: what is at the other end from now on.
board() {
    [ -z "${pid:-}" ] || { kill "$pid" && wait "$pid"; } 2>/dev/null
    rm -f "$tty"
    "$pty_board" "$rig" "$tty" "$1" &
    pid=$!
    until_true 30 [ -e "$tty" ]
}
trap 'kill "${pid:-}" 2>/dev/null; rm -rf "$dir"' EXIT
# drive [OPTION...]: a run with two targets in the background, once it tracks them; $child is its process.
drive() {
    : >"$dir/err"
    : >"$dir/out" >"$dir/err" # or what waits for words may find the last run's
    "$boresight" run "$rig" --arm --targets host-sim/scenarios/two.jsonl "$@" >"$dir/out" 2>"$dir/err" &
    child=$!
    until_true 30 told tracking
}
# Waits for its end, and takes its status.
driven() {
    wait $child
    status=$?
}
value() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$dir/out"; }
told() { grep -qF -- "$1" "$dir/err"; }

make_rig "board = serial:$tty"
board board

# In real time, on a machine that may be busy: a pause of half a second stops the board, as it should. So up to three tries, and what
# fails in all of them while the machine paused is skipped, by name.
tries() { # NAME FUNCTION
    if "$2" || "$2" || "$2"; then
        verdict "$1" 0
    elif [ "$(value status_gap_ms_max)" -gt 250 ]; then
        echo "SKIP $1: the machine paused for $(value status_gap_ms_max) ms"
    else
        verdict "$1" 1
    fi
}

# ---------------------------------------------------------------- the main job
follow_two() {
    run run "$rig" --arm --seconds 3 --json --targets host-sim/scenarios/two.jsonl
    [ "$status" -eq 0 ] && [ "$(value mode)" = stopped ] && [ "$(value targets)" -gt 0 ] &&
        [ "$(value lines_taken)" -gt 0 ] && [ "$(value lines_damaged)" = 0 ] && [ "$(value lines_stale)" = 0 ] &&
        [ "$(value clock_answers)" -gt 5 ] && told tracking
}
tries 'run follows targets with a board' follow_two

# What hides targets is looked at before they are sent: one of two stands behind a wall.
printf '%s\n' 'o wall' 'v 0.5 5 -3' 'v 10 5 -3' 'v 10 5 3' 'v 0.5 5 3' 'f 1 2 3 4' >"$dir/wall.scene"
printf '{"id": 1, "xyz": [-2, 10, 0]}\n{"id": 2, "xyz": [3, 10, 0]}\n' >"$dir/pair.jsonl"
hide_one() {
    run run "$rig" --arm --seconds 4 --json --targets "$dir/pair.jsonl" --scene "$dir/wall.scene"
    [ "$status" -eq 0 ] && [ "$(value targets)" = 2 ] && [ "$(value hidden_percent)" = 50.00 ] &&
        awk -v pan="$(value pan_deg)" 'BEGIN { wanted = atan2(-2, 10) * 57.29578; exit !(pan > wanted - 0.3 && pan < wanted + 0.3) }'
}
tries 'a scene hides a target from the board' hide_one

awk 'BEGIN { for (frame = 0; frame < 40; frame++) for (id = 1; id <= 64; id++)
    printf "{\"t_us\": %d, \"id\": %d, \"xyz\": [%.3f, 10, %.3f]}\n", frame * 50000, 1000 * id, id / 100 + frame / 50, id / 200 }' >"$dir/many.jsonl"
follow_many() {
    run run "$rig" --arm --seconds 4.5 --json --targets "$dir/many.jsonl"
    [ "$status" -eq 0 ] && [ "$(value targets)" = 64 ] && [ "$(value updates_rejected)" = 0 ] && [ "$(value lines_damaged)" = 0 ] &&
        [ "$(value frames_compact)" -ge 20 ] && [ "$(value frames_cut)" = 0 ] &&
        awk -v pan="$(value pan_deg)" 'BEGIN { wanted = atan2(1.105, 10) * 57.29578; exit !(pan > wanted - 0.3 && pan < wanted + 0.3) }'
}
tries '64 targets, 20 times a second, and the gimbal looks at their middle' follow_many

arm_nothing() {
    run run "$rig" --seconds 1 --json
    [ "$status" -eq 0 ] && [ "$(value targets)" = 0 ] && ! told tracking && ! told holding
}
tries 'without --arm nothing is armed' arm_nothing

drive
kill -INT $child
driven
[ "$status" -eq 0 ] && grep -q '^mode *stopped' "$dir/out"
verdict 'an interrupt stops, reports and ends with 0' $?

drive --json
kill -USR1 $pid
driven
[ "$status" -eq 5 ] && told 'the board stopped: emergency stop'
verdict 'the emergency stop ends it with 5 and says so' $?
run run "$rig" --arm --seconds 5
[ "$status" -eq 5 ] && told "the board refuses 'arm': emergency stop"
verdict 'a board that must not arm says why, status 5' $?

# ---------------------------------------------------------------- what can be wrong with the device
fails() { # NAME TEXT
    name=$1
    run run "$rig" --arm --seconds 5
    [ "$status" -eq 4 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && told "$rig: board = serial:" && told "$2" && told '; ' && [ ! -s "$dir/out" ]
    verdict "$name" $?
}
board silent
fails 'a silent board' 'the board is silent; is it powered'
board chatter
fails 'something else speaks' 'does not answer as a Boresight board does; is board_baud right'
board busy
fails 'another program has the board' 'another program has the board; end that one'
board '2 whatever comes'
fails 'another version of the protocol' 'speaks version 2 of the protocol, not 1; flash it'
board '1 00000000 0.0.1 another'
fails 'another build' "the board runs build '0.0.1 another', this program is"
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
board "1 00000000 $id"
fails 'another rig' 'the board was built for another rig file'
make_rig "board = serial:$tty
board_build = any"
board '1 00000000 0.0.1 another'
fails 'board_build = any: then only the rig counts' 'the board was built for another rig file'
make_rig "board = serial:$dir/nowhere"
fails 'no such device' "nowhere: no such file or device; is it plugged in?"
make_rig "board = serial:/dev/null"
fails 'not a serial port' 'not a serial port'
make_rig "board = serial:$tty
board_baud = 123456"
fails 'no usual speed' '123456 baud is no usual speed; use one of'

# A board that leaves while it drives.
make_rig "board = serial:$tty"
board board
drive
kill -STOP $pid
driven
kill -CONT $pid
[ "$status" -eq 4 ] && told 'the board has fallen silent; was it unplugged'
verdict 'a board that falls silent ends it with 4' $?

# A board that is reset, and a program that hangs for a second: the board answers, but has let go of it.
board board
for who in board program; do
    drive
    if [ $who = board ]; then
        kill -USR2 $pid
    else
        kill -STOP "$child"
        sleep 1
        kill -CONT "$child"
    fi
    driven
    case $who,$status in
    board,4) told 'the board has let go of this program; it was reset' ;;
    # It may still see, in what waited for it, that the board stopped.
    program,4) told 'the board has let go of this program' || told 'the board has fallen silent' ;;
    program,5) told 'the board stopped' ;;
    *) false ;;
    esac
    verdict "a $who that was away ends it" $?
done

drive
run run "$rig" --seconds 1
[ "$status" -eq 4 ] && told "$rig: board = serial:" && told 'in use' && [ "$(wc -l <"$dir/err")" -eq 1 ]
verdict 'a line that another program has open' $?
kill $child
driven

# ---------------------------------------------------------------- a board that comes and goes
says() { [ "$(grep -cF -- "$1" "$dir/err")" -eq "$2" ]; }
kill $pid
wait $pid 2>/dev/null
rm -f "$tty"
stay() { # [OPTION...]
    : >"$dir/out" >"$dir/err"
    "$boresight" run "$rig" --stay "$@" >"$dir/out" 2>"$dir/err" &
    child=$!
    until_true 30 told 'waiting until it is there'
}
printf '{"id": 1, "xyz": [-1, 10, 0]}\n{"id": 2, "xyz": [3, 10, 0]}\n' >"$dir/told_once.jsonl"
stay --arm --targets "$dir/told_once.jsonl" --state 0.1 --log "$dir/log" --json
until_true 30 grep -q '"board": false}$' "$dir/out"
verdict 'with --stay it waits for a board' $?
kill -USR1 $child # there is nothing to arm
sleep 1.5         # it is tried twice a second
board board
until_true 60 told tracking && told 'run: the board is there' && says 'no such file or device' 1 && says waiting 1
verdict 'that comes, and drives, each thing told once' $?
until_true 30 grep -q '"board": true, "mode": "tracking", "pan_deg": .*"tilt_goal_deg": .*"targets": 2}$' "$dir/out"
verdict 'its state is told' $?
board board
until_true 60 told 'run: the board is there again' && until_true 30 says 'run: ready' 2 && sleep 1 && says 'run: settling' 1
verdict 'one that was away does not move by itself' $?
kill -USR1 $child
until_true 30 says 'run: tracking' 2
verdict 'but by SIGUSR1, with the targets from before' $?
kill -HUP $child
until_true 30 told 'SIGHUP changes nothing'
verdict 'SIGHUP says why it does nothing' $?
kill -USR1 $pid
until_true 30 told 'the board stopped: emergency stop' && kill -USR1 $child && until_true 30 told "the board refuses 'arm': emergency stop"
verdict 'a stop, and a refusal, do not end it' $?
kill -INT $child
driven
[ "$status" -eq 0 ] && tail -n 1 "$dir/out" | grep -q '"board_returns": 1, .*"log_dropped": 0, "states_dropped": 0,' &&
    grep -q '"event": "device", "text": "the board is there again"' "$dir/log"
verdict 'an interrupt does' $?
kill $pid
wait $pid 2>/dev/null
pid=
rm -f "$tty"
stay
kill -TERM $child
driven
[ "$status" -eq 4 ] && [ ! -s "$dir/out" ]
verdict 'also while it waits, with status 4' $?

# ---------------------------------------------------------------- the rig file
for value in /dev/ttyACM0 serial: tcp:host; do
    make_rig "board = $value"
    run run "$rig"
    [ "$status" -eq 2 ] && told "rig.ini:" && told 'serial:/dev/ttyACM0'
    verdict "board = $value is refused with its line" $?
done
make_rig "board = serial:$tty"
run config check "$rig"
[ "$status" -eq 0 ] && grep -qF "driven by the board at $tty" "$dir/out"
verdict 'config check tells that a board drives it' $?
finish
