#!/bin/sh
# The serial line of the emulated STM32F405 image: a person at its console, and `boresight run`, which drives it in the closed loop: targets
# down the line, frames on the CAN bus, simulated drives and plant. In real time.
. tests/gate/verdict.sh
elf=build/boards/stm32f405/boresight.elf
dir=$(mktemp -d)
tty=$dir/tty
sim=
trap 'kill $sim 2>/dev/null; rm -rf "$dir"' EXIT
cp host-sim/rigs/studio.ini "$dir/rig.ini"
printf '[scenario]\nname = Line\nabout = A board and whoever is at its line.\nrig = rig.ini\nseconds = 100\narm = no\n' >"$dir/idle.ini"
cp "$dir/rig.ini" "$dir/board.ini"
printf '\n[controller]\nboard = serial:%s\n' "$tty" >>"$dir/board.ini"

start() { # SECONDS [OPTION...]
    seconds=$1
    shift
    build/boresight sim "$dir/idle.ini" "$@" --seconds "$seconds" --speed 1 --quiet --json --mcu $elf --mcu-serial "$tty" >"$dir/sim" 2>"$dir/sim.err" &
    sim=$!
    tries=0
    while [ ! -e "$tty" ] && [ $tries -lt 100 ]; do
        sleep 0.05
        tries=$((tries + 1))
    done
}
value() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$2"; }
show() { sed 's/^/    /' "$@" | cut -c 1-600; }
# What the board says for SECONDS after a line is typed.
type_line() { # LINE SECONDS
    exec 3<>"$tty"
    printf '%s\r' "$1" >&3
    timeout "$2" cat <&3 | tr -d '\r' >"$dir/said"
    exec 3>&-
}

# ---------------------------------------------------------------- a person
start 12
sleep 1
type_line 'status' 1
grep -q '^tick: ' "$dir/said" || type_line 'status' 2 # a busy machine
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
grep -q "^boresight $id$" "$dir/said" && grep -q '^mode: ready$' "$dir/said" && grep -q '^tick: busy .* can active' "$dir/said"
result=$?
[ $result -eq 0 ] || show "$dir/said"
verdict 'the image answers a person: status, with its build' $result
type_line 'arm' 0.5
type_line 'aim 170 10' 3
type_line 'status' 0.5
grep -q '^mode: tracking$' "$dir/said" && grep -q '^pan:  at -10' "$dir/said" || type_line 'status' 2
grep -q '^pan:  at -10\.0*, goal -10\.0*, measured -\(10\.0\|9\.9\)' "$dir/said" && grep -q '^mode: tracking$' "$dir/said"
result=$?
[ $result -eq 0 ] || show "$dir/said"
verdict 'arm and aim at the console move the drives on the bus' $result
wait $sim
result=$?
show "$dir/sim.err"
[ $result -eq 0 ] && [ "$(value violations "$dir/sim")" = 0 ]
verdict 'without a violation, the chip used as its manual says' $?

# ---------------------------------------------------------------- a program
cat >"$dir/two.jsonl" <<'JSON'
{"t_us": 0, "id": 77, "xyz": [1, -6, 1.5]}
{"t_us": 0, "id": 99, "xyz": [3, -6, 0.5]}
JSON
# Each of these in real time, on a machine that may be busy: a pause of half a second stops the board, as it should. So up to three tries.
drive() { # SECONDS-OF-THE-SIMULATION SECONDS-OF-THE-RUN TARGETS: 0 if all went well
    start "$1"
    sleep 0.3
    build/boresight run "$dir/board.ini" --arm --seconds "$2" --json --targets "$3" >"$dir/out" 2>"$dir/err"
    result=$?
    wait $sim && [ $result -eq 0 ] && [ "$(value lines_damaged "$dir/out")" = 0 ] && [ "$(value lines_stale "$dir/out")" = 0 ]
}
drive_to_the_end() {
    drive "$@" || drive "$@" || drive "$@"
    result=$?
    if [ $result -ne 0 ] && [ "$(value status_gap_ms_max "$dir/out")" -gt 250 ]; then
        echo "SKIP the emulated board in real time: the machine paused for $(value status_gap_ms_max "$dir/out") ms"
        exit $status
    fi
    sed "s/^/# /" "$dir/err" "$dir/sim.err" "$dir/out" "$dir/sim"
    return $result
}
drive_to_the_end 9 5 "$dir/two.jsonl"
verdict 'run drives the image, and no line is lost' $?
awk -v pan="$(value pan_deg "$dir/out")" -v tilt="$(value tilt_deg "$dir/out")" 'BEGIN {
    a = sqrt(1 + 36 + 2.25); b = sqrt(9 + 36 + 0.25); deg = 57.29577951
    x = 1 / a + 3 / b; y = -6 / a - 6 / b; z = 1.5 / a + 0.5 / b
    p = atan2(x, y) * deg - 180; t = atan2(z, sqrt(x * x + y * y)) * deg     # the mount looks south
    exit !(pan - p < 0.05 && p - pan < 0.05 && tilt - t < 0.05 && t - tilt < 0.05) }'
verdict 'it looks between two targets' $?
[ "$(value clock_answers "$dir/out")" -gt 20 ] && [ "$(value board_build "$dir/out")" = "$id" ]
verdict 'clocks together, the same build' $?
[ "$(value violations "$dir/sim")" = 0 ] && [ "$(value mode "$dir/sim")" = stopped ]
verdict 'the simulator saw it stop, without a violation' $?

# 64 targets that walk, 20 times a second.
awk 'BEGIN { for (frame = 0; frame < 80; frame++) for (id = 1; id <= 64; id++)
    printf "{\"t_us\": %d, \"id\": %d, \"xyz\": [%.3f, -10, %.3f]}\n", frame * 50000, 1000 * id, id / 100 + frame / 100, id / 200 }' >"$dir/many.jsonl"
drive_to_the_end 10 6.5 "$dir/many.jsonl" && [ "$(value targets "$dir/out")" = 64 ] && [ "$(value updates_rejected "$dir/out")" = 0 ] &&
    [ "$(value frames_compact "$dir/out")" -ge 40 ]
verdict '64 targets, 20 times a second, at 115200 baud' $?
[ "$(value violations "$dir/sim")" = 0 ]
verdict "without a violation; the busiest tick, 64 targets at once, $(value mcu_loop_percent "$dir/sim") % of 1 ms by instructions" $?

# ---------------------------------------------------------------- a fault
start 7 --mcu-faults pan-silent@3
sleep 0.3
build/boresight run "$dir/board.ini" --arm --seconds 6 --targets "$dir/two.jsonl" >"$dir/out" 2>"$dir/err"
[ $? -eq 5 ] && grep -q 'the board stopped: a drive does not answer' "$dir/err"
result=$?
[ $result -eq 0 ] || show "$dir/err"
verdict 'a drive that falls silent ends the run with 5, and it says why' $result
wait $sim

# ---------------------------------------------------------------- refused
sed 's/^limit_max_deg = 175/limit_max_deg = 170/' "$dir/board.ini" >"$dir/other.ini"
start 3
sleep 0.3
build/boresight run "$dir/other.ini" --seconds 1 >"$dir/out" 2>"$dir/err"
[ $? -eq 4 ] && grep -q 'the board was built for another rig file' "$dir/err" && [ "$(wc -l <"$dir/err")" -eq 1 ]
result=$?
[ $result -eq 0 ] || show "$dir/err"
verdict 'an image for another rig is refused' $result
wait $sim
exit $status
