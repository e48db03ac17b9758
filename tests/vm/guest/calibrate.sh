# `boresight calibrate` over SocketCAN against the simulator's drives in another process, whose ends, profile and lag are known.
. tests/vm/guest/check.sh
load -a vcan can_raw
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
# Slow ticks and long patience: the emulated machine has no real time. Pan's end stop is at 200 degrees (host-sim/plant/axis_plant.h).
rig() { # BUS
    sed "s/^bus = .*/bus = $1/; s/^silence_ms.*/silence_ms = 2000/; s/^watchdog_ms.*/watchdog_ms = 0/
        s/^limit_min_deg = -175/home_deg = 150\nlimit_min_deg = 100/; s/^limit_max_deg = 175/limit_max_deg = 250 ; the cable/
        s/^limit_min_deg = -30/limit_min_deg = -15/; s/^limit_max_deg = 95/limit_max_deg = 20/" host-sim/rigs/studio.ini
    printf '\n[controller]\ntick_us = 10000\n'
}
rig fake >"$work/sim.ini"
rig can:vcan0 >"$work/before.ini"
printf '[scenario]\nname = served\nrig = sim.ini\nseconds = 1\ntick_us = 5000\nstart_deg = 150, 0\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
value() { sed -n "s/.*\"$1\": \"\{0,1\}\([^\"}]*\).*/\1/p" "$work/out" | sed 's/, "*.*//'; }
# item NAME NUMBER: of a list.
item() { sed -n "s/.*\"$1\": \[\([^]]*\)\].*/\1/p" "$work/out" | cut -d, -f"$2"; }
# within VALUE LOW HIGH
within() { awk -v v="$1" -v low="$2" -v high="$3" 'BEGIN { exit !(v != "" && v + 0 >= low && v + 0 <= high) }'; }
calibrate() { # ARGUMENT...
    cp "$work/before.ini" "$work/rig.ini"
    "$boresight" calibrate "$work/rig.ini" --json "$@" >"$work/out" 2>"$work/err"
}

# ---------------------------------------------------------------- what can't be measured
calibrate
[ $? -eq 4 ] && grep -q 'vcan0: no such interface; ' "$work/err" && cmp -s "$work/rig.ini" "$work/before.ini"
verdict calibrate.no_interface_is_status_4 $? "$work/err"
ip link add dev vcan0 type vcan && ip link set vcan0 up
calibrate
[ $? -eq 4 ] && grep -q 'vcan0: drive 1 does not answer' "$work/err" && cmp -s "$work/rig.ini" "$work/before.ini"
verdict calibrate.silent_drives_are_status_4 $? "$work/err"

# ---------------------------------------------------------------- a whole measurement
record vcan0
"$boresight" config check "$work/before.ini" >"$work/check"
# profile AXIS FIELD: seconds that 10 (1) and 90 degrees (2) take at best.
profile() { sed -n "s/^  $1 *turns 10 degrees in \([0-9.]*\) s and 90 degrees in \([0-9.]*\) s.*/\\$2/p" "$work/check"; }
# Drives follow with a time constant of 12.5 ms, and rest is within 0.1 degree, so nothing can be quicker than that; how much slower it is
# is the emulated machine's.
takes() { # LIST ITEM PROFILE
    within "$(item "$1" "$2")" "$(awk -v p="$3" 'BEGIN { print p - 0.1 }')" "$(awk -v p="$3" 'BEGIN { print p + 0.6 }')"
}
times_are_right() {
    takes pan_move_s 1 "$(profile pan 1)" && takes pan_move_s 3 "$(profile pan 2)" && takes tilt_move_s 1 "$(profile tilt 1)" &&
        within "$(value pan_latency_ms)" 12.5 100 && within "$(value tilt_latency_ms)" 12.5 100 && within "$(value pan_speed_dps)" 85 1000
}
# Where something is in the way does not depend on the time it takes to find out.
ends_are_right() {
    [ "$(value pan_low_end)" = limit ] && [ "$(value pan_high_end)" = stop ] && within "$(value pan_max_deg)" 197.5 198.1 &&
        [ "$(value tilt_low_end)" = limit ] && [ "$(value tilt_high_end)" = limit ]
}
# What a machine that paused measures of times is itself; it may also end it with a fault.
ends=0
for try in 1 2; do
    "$VM_TESTS/gcc/tests/vm/watch_pauses" 50 >"$work/pauses" &
    watch=$!
    serve
    calibrate
    status=$?
    kill $watch
    wait $watch
    cp "$work/err" "$work/measured.err"
    if [ $status -eq 0 ]; then
        ends_are_right || ends=1
    else
        cmp -s "$work/rig.ini" "$work/before.ini" || ends=1
    fi
    good=0
    { [ $status -eq 0 ] && times_are_right; } || good=1
    end_serve # a drive that was held too long remembers it
    { [ $ends -eq 0 ] && [ $good -ne 0 ] && [ -s "$work/pauses" ]; } || break
    echo "# try $try: $(cat "$work/pauses" "$work/err" "$work/out")"
done
serve
verdict calibrate.ends_are_found $ends "$work/out" "$work/measured.err"
if [ $good -ne 0 ] && [ -s "$work/pauses" ]; then
    for test in times_and_latency writes_them_back the_rig_runs_with_it; do
        echo "SKIP vm.calibrate.$test: $(cat "$work/pauses")"
    done
else
    times_are_right
    verdict calibrate.times_and_latency $? "$work/out" "$work/measured.err"
    for name in pan_move_s tilt_move_s; do echo "# calibrated over vcan: $name $(item $name 1) $(item $name 2) $(item $name 3)"; done
    for name in pan_latency_ms tilt_latency_ms pan_speed_dps; do echo "# calibrated over vcan: $name $(value $name)"; done
    # The limit that was too wide is narrower, with its comment; three new keys an axis, as printed; nothing else.
    diff "$work/before.ini" "$work/rig.ini" >"$work/diff"
    grep -q '"written": true' "$work/out" && [ "$(grep -c '^<' "$work/diff")" -eq 1 ] && [ "$(grep -c '^>' "$work/diff")" -eq 7 ] &&
        grep -q '^limit_max_deg = 19[78]\.[0-9]* ; the cable # measured .*$' "$work/rig.ini" && [ "$(grep -c '^move_s = ' "$work/rig.ini")" -eq 2 ] &&
        "$boresight" config check "$work/rig.ini" >"$work/check2" && grep -q '^  pan *is [0-9.]* ms behind its setpoint' "$work/check2"
    verdict calibrate.writes_them_back $? "$work/diff" "$work/out"
    # What was measured runs.
    printf '{"t_us": 0, "id": 1, "dir": [-0.5, 0.866, 0.2]}\n' >"$work/targets.jsonl"
    "$boresight" run "$work/rig.ini" --json --arm --targets "$work/targets.jsonl" --seconds 4 >"$work/out" 2>"$work/err"
    verdict calibrate.the_rig_runs_with_it $? "$work/err"
fi
# Requests of positions to both drives, and nobody else on the bus.
end_record
grep -q ' 141#A4' "$work/candump" && grep -q ' 142#A4' "$work/candump" && ! grep -qvE ' (14|24)[12]#[0-9A-F]{16}$' "$work/candump"
verdict calibrate.candump_saw_the_moves $?

# ---------------------------------------------------------------- ended by a person; a bus that leaves
: >"$work/err"
cp "$work/before.ini" "$work/rig.ini"
"$boresight" calibrate "$work/rig.ini" --json >"$work/out" 2>"$work/err" & # not the function, whose process would get the signal
runner=$!
until_true 60 grep -q 'move now' "$work/err"
kill -INT $runner
wait $runner
cmp -s "$work/rig.ini" "$work/before.ini"
verdict calibrate.sigint_writes_nothing $? "$work/err"
: >"$work/err"
calibrate &
runner=$!
until_true 60 grep -q 'move now' "$work/err"
ip link del vcan0
wait $runner
[ $? -eq 4 ] && cmp -s "$work/rig.ini" "$work/before.ini" && grep -q 'vcan0: the interface has gone' "$work/err"
verdict calibrate.a_bus_that_leaves_is_status_4 $? "$work/err"
wait $server
