#!/bin/sh
# `boresight run` and `calibrate` on drives behind a serial CAN adapter, in real time: simulated drives on a pseudo-terminal
# (support/pty_drives.c), whose times are known. Real-time priority and locked memory where they may be had, and what is
# said where not.
. tests/cli/support/check.sh
drives=build/gcc/tests/cli/support/pty_drives
value() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$dir/out"; }
item() { sed -n "s/.*\"$1\": \[\([^]]*\)\].*/\1/p" "$dir/out" | cut -d, -f"$2"; }
sed "s/^watchdog_ms.*/watchdog_ms = 0/; s/^silence_ms.*/silence_ms = 1000/; s/^limit_min_deg = -175/limit_min_deg = -17/
    s/^limit_max_deg = 175/limit_max_deg = 17/; s/^limit_min_deg = -30/limit_min_deg = -7/; s/^limit_max_deg = 95/limit_max_deg = 7/" \
    host-sim/rigs/studio.ini >"$dir/sim.ini"
sed "s|^bus = fake|bus = slcan:$dir/link|" "$dir/sim.ini" >"$dir/rig.ini"
$drives "$dir/sim.ini" "$dir/link" 2>"$dir/drives.err" &
server=$!
until_true 30 test -e "$dir/link"

run run "$dir/rig.ini" --seconds 1 --json </dev/null
may() { chrt -f 30 true 2>/dev/null && [ "$(id -u)" -eq 0 ]; }
if may; then
    [ "$status" -eq 0 ] && [ "$(value realtime_priority)" = true ] && [ "$(value locked_memory)" = true ] && ! grep -q 'without' "$dir/err"
    verdict 'real-time priority and locked memory' $?
else
    echo 'SKIP real-time priority and locked memory: this user may not have them'
fi
if may && command -v setpriv >/dev/null; then
    set -- sys_nice:'real-time priority' ipc_lock:'locked memory' sys_nice,-ipc_lock:'real-time priority and locked memory'
    case $boresight in build/san/*) set -- sys_nice:'real-time priority' ;; esac # the sanitizers lock no memory, and say they did
    for what in "$@"; do
        setpriv --bounding-set="-${what%%:*}" --inh-caps="-${what%%:*}" sh -c 'ulimit -l 64; ulimit -r 0; exec "$@"' sh "$boresight" run "$dir/rig.ini" \
            --seconds 1 --json </dev/null >"$dir/out" 2>"$dir/err"
        status=$?
        [ "$status" -eq 0 ] && grep -q "^boresight run: without ${what#*:}: this process may not; start it as root, or as a service with AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK$" "$dir/err"
        verdict "without ${what#*:}: it says so, and runs" $?
    done
else
    echo 'SKIP without real-time priority: nothing to give up, or no setpriv'
fi

# A zero that is wrong: the axis is 120 degrees beyond its limits, and arming it would turn it all the way back.
sed '/^\[pan\]/a\
zero_deg = 120' "$dir/rig.ini" >"$dir/turned.ini"
beyond='pan is at -120.0 degrees, beyond its limits (-17.0 to 17.0), and not armed there; turn it back by hand, or mend zero_deg'
run run "$dir/turned.ini" --seconds 1 --json </dev/null
[ "$status" -eq 0 ] && [ "$(grep -c "^boresight run: $beyond\$" "$dir/err")" -eq 1 ] && [ "$(value pan_deg)" = -120.0000 ]
verdict 'an axis beyond its limits is told of' $?
run run "$dir/turned.ini" --arm --seconds 60 --json </dev/null
[ "$status" -eq 5 ] && [ "$(grep -c "^boresight run: $beyond\$" "$dir/err")" -eq 1 ] && [ "$(value pan_deg)" = -120.0000 ] && ! grep -q 'settling\|tracking\|holding' "$dir/err"
verdict 'and not armed' $?
: >"$dir/out" >"$dir/err" # or what waits for words may find the last run's
"$boresight" run "$dir/turned.ini" --arm --stay --json </dev/null >"$dir/out" 2>"$dir/err" &
runner=$!
until_true 30 grep -q 'beyond its limits' "$dir/err"
kill -USR1 $runner
again() { [ "$(grep -c 'beyond its limits' "$dir/err")" -eq 2 ]; }
until_true 30 again
status=$?
[ "$status" -eq 0 ] && ! grep -q 'settling\|tracking\|holding' "$dir/err"
verdict 'nor by SIGUSR1, which tells it again' $?
cp "$dir/turned.ini" "$dir/wrong.ini"
cp "$dir/rig.ini" "$dir/turned.ini"
kill -HUP $runner
until_true 30 grep -q settling "$dir/err"
verdict 'but with a zero that was mended meanwhile' $?
kill -INT $runner
wait $runner
cp "$dir/wrong.ini" "$dir/turned.ini"
run calibrate "$dir/turned.ini" --keep-limits --json --dry-run </dev/null
[ "$status" -ne 0 ] && grep -qF "calibrate: $beyond" "$dir/err" && [ ! -s "$dir/out" ]
verdict 'nor to be calibrated' $?

# Times are those of the profile (`config check`), less the slow last tenth of a degree, and the lag; a busy machine is told.
run config check "$dir/sim.ini"
ten=$(sed -n 's/^  pan *turns 10 degrees in \([0-9.]*\) s.*/\1/p' "$dir/out")
run calibrate "$dir/rig.ini" --keep-limits --json --dry-run </dev/null
if grep -q 'noisy: ' "$dir/err"; then
    echo "SKIP calibrate in real time: $(grep -m 1 'noisy: ' "$dir/err")"
else
    awk -v ten="$ten" -v pan="$(item pan_move_s 1)" -v wide="$(item pan_move_s 2)" -v lag="$(value pan_latency_ms)" \
        'BEGIN { exit !(pan > 0.94 * ten - 0.04 && pan < 1.06 * ten && wide > 0.83 && wide < 0.9 && lag > 12.5 && lag < 18.5) }'
    verdict 'calibrate in real time' $?
fi
echo "MEASURED calibrate in real time: 10 degrees in $(item pan_move_s 1) s (profile $ten), 30 in $(item pan_move_s 2), latency $(value pan_latency_ms) ms, rounds $(value pan_rounds)"
kill $server
wait $server
finish
