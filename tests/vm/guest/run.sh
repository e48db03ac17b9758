# `boresight run` on SocketCAN against the simulator's drives in another process, with can-utils and python3-can as
# witnesses that share no code with either.
. tests/vm/guest/check.sh
load -a vcan can_raw
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
# Slow ticks and long patience: the emulated machine has no real time. Little jerk, so that it shows between two commands.
{
    sed 's/^bus = fake/bus = can:vcan0/; s/^jerk_max_dps3.*/jerk_max_dps3 = 1000/; s/^silence_ms.*/silence_ms = 2000\nfollow_error_ms = 10000/; s/^watchdog_ms.*/watchdog_ms = 0/
        s/^heading_deg.*/heading_deg = 0/' \
        host-sim/rigs/studio.ini
    printf '\n[controller]\ntick_us = 10000\n'
} >"$work/rig.ini"
printf '[scenario]\nname = served\nrig = rig.ini\nseconds = 1\ntick_us = 10000\nstart_deg = 12.34, -5.67\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
# Three points so far off that both axes reach their greatest speed on the way.
cat >"$work/targets.jsonl" <<'END'
{"t_us": 0, "id": 1, "dir": [0.75, 0.35, 0.6]}
{"t_us": 0, "id": 2, "dir": [0.7, 0.1, 0.7]}
{"t_us": 0, "id": 3, "dir": [0.7, 0.2, 0.65]}
END
sed 's/.*\[\(.*\)\].*/\1/; s/,//g' "$work/targets.jsonl" >"$work/points"

bus_up() { ip link add dev vcan0 type vcan && ip link set vcan0 up; }
# fact FILE NAME: a value of the last JSON object.
fact() { sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$1" | tail -n 1; }
# near A B TOLERANCE
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; exit !(a != "" && b != "" && d <= t && -d <= t) }'; }
drive() { # ARGUMENT...: in the place of this shell: give it an `&`, or brackets
    exec "$boresight" run "$work/rig.ini" --json --log "$work/log" "$@" >"$work/run.json" 2>"$work/run.err"
}

# ---------------------------------------------------------------- the closed loop, and its witnesses
(drive --seconds 1)
[ $? -eq 4 ] && grep -q 'vcan0: no such interface; ' "$work/run.err"
verdict run.no_interface_is_status_4 $? "$work/run.err"
bus_up
record vcan0
timeout 600 python3 tests/vm/guest/witness.py listen vcan0 "$work/heard" >"$work/python" 2>&1 &
python=$!
until_true 200 grep -q listening "$work/python"
serve
all_listen() { [ "$(grep -c ' vcan0 .*raw' /proc/net/can/rcvlist_all)" -eq 3 ]; } # so that the first request is answered, too
until_true 60 all_listen
verdict run.both_witnesses_and_the_drives_listen $?
"$boresight" aim --json "$work/points" >"$work/aim.json"
aims() { # FILE TOLERANCE
    near "$(fact "$1" pan_deg)" "$(fact "$work/aim.json" pan_deg)" "$2" && near "$(fact "$1" tilt_deg)" "$(fact "$work/aim.json" tilt_deg)" "$2"
}
arrived() { # and has stood there for a while, on the loop's own clock
    aims "$work/run.json" 0.05 && awk -v t="$(fact "$work/run.json" t_s)" 'BEGIN { exit !(t > 5) }'
}
drive --arm --targets "$work/targets.jsonl" --state 0.5 &
runner=$!
until_true 60 arrived
kill -INT $runner
wait $runner
status=$?
kill $python
wait $python
listened=$?
end_serve
served=$?
end_record
# Setpoints that the machine held up come all at once, and a drive that makes up for them turns faster than the rig allows. Then only that
# is let pass, and by name.
held_up=
late_us=$(printf '%s\n' "$(fact "$work/run.json" late_us_max)" "$(fact "$work/serve.json" late_us_max)" | sort -n | tail -n 1)
if [ "$late_us" -gt 20000 ] && ! grep 'invariant violated' "$work/serve.err" | grep -qv 'I2 rates'; then
    held_up="the machine stood still for $late_us us"
fi
[ $status -eq 0 ] && { [ $served -eq 0 ] || [ -n "$held_up" ]; }
verdict run.closed_loop_ends_well $? "$work/run.err" "$work/serve.err" "$work/run.json"
for axis in pan_deg tilt_deg; do
    wanted=$(fact "$work/aim.json" $axis)
    near "$(fact "$work/run.json" $axis)" "$wanted" 0.05 && near "$(fact "$work/serve.json" $axis)" "$wanted" 0.05
    verdict run.closed_loop_aims_$axis $? "$work/aim.json" "$work/run.json" "$work/serve.json"
done
python3 tests/vm/guest/witness.py judge "$work/heard" "$work/candump" "$work/rig.ini" "$work/targets.jsonl" "$work/run.json" 2>"$work/judge.err" &&
    [ $listened -eq 0 ]
verdict run.python_can_judges_all $? "$work/python" "$work/judge.err"
[ "$(fact "$work/serve.json" frames_lost)" = 0 ]
verdict run.plant_lost_no_frame $? "$work/serve.json"
if [ "$(fact "$work/serve.json" violations)" != 0 ] && [ -n "$held_up" ]; then
    echo "SKIP vm.run.plant_kept_its_limits: $held_up"
else
    [ "$(fact "$work/serve.json" violations)" = 0 ]
    verdict run.plant_kept_its_limits $? "$work/serve.json"
fi
# All that went over the bus was seen: requests as many as the drives got, replies as many as they gave.
seen() { grep -c " $1" "$work/candump"; }
requests=$(($(seen '14[12]#')))
replies=$(($(seen '24[12]#')))
[ "$requests" -eq "$(fact "$work/serve.json" frames_in)" ] && [ "$replies" -eq "$(fact "$work/serve.json" frames_out)" ] &&
    [ "$requests" -gt 100 ]
verdict run.candump_saw_every_frame $? "$work/serve.json"
! grep -vqE ' (14|24)[12]#[0-9A-F]{16}$' "$work/candump"
verdict run.candump_saw_nothing_else $?
for name in late_us_p50 late_us_p99 late_us_p999 late_us_max missed_ticks realtime_priority; do
    echo "# closed loop in the emulator: $name $(fact "$work/run.json" $name)"
done
[ "$(fact "$work/run.json" realtime_priority)" = true ] && [ "$(fact "$work/run.json" locked_memory)" = true ]
verdict run.root_gets_real_time $? "$work/run.json"
grep -q '"event": "mode", "text": "tracking"' "$work/log"
verdict run.log_tells_the_mode $? "$work/log"

# ---------------------------------------------------------------- drives and interface that fail
(drive --arm --seconds 20)
[ $? -eq 4 ] && grep -q 'can:vcan0: drive 1 does not answer' "$work/run.err"
verdict run.silent_drives_at_the_start_are_status_4 $? "$work/run.err"

in_background() { # ARGUMENT...
    : >"$work/run.json" >"$work/run.err" # or what waits for words may find the last run's
    watched "$boresight" run "$work/rig.ini" --json "$@" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
}
tracks() { [ "$(grep -c 'run: tracking' "$work/run.err")" -ge "$1" ]; }
serve
in_background --arm --targets "$work/targets.jsonl"
until_true 60 tracks 1
kill -STOP $server
wait $runner
[ $? -eq 5 ] && grep -q 'faulted: .*: a drive does not answer' "$work/run.err"
verdict run.drives_that_fall_silent_are_status_5 $? "$work/run.err"
kill -CONT $server

in_background --arm --targets "$work/targets.jsonl" --stay
until_true 60 tracks 1
kill -STOP $server
until_true 60 grep -q 'faulted' "$work/run.err"
kill -CONT $server
sleep 1
! tracks 2
verdict run.a_fault_stays_until_rearmed $? "$work/run.err"
kill -USR1 $runner
until_true 60 tracks 2
verdict run.rearmed_by_sigusr1 $? "$work/run.err"

sed -i 's/^speed_max_dps = 90/speed_max_dps = 45/' "$work/rig.ini"
kill -HUP $runner
until_true 60 tracks 3
verdict run.reloads_on_sighup $? "$work/run.err"
echo 'nonsense' >>"$work/rig.ini"
kill -HUP $runner
until_true 60 grep -q 'the rig stays as it was' "$work/run.err"
verdict run.keeps_its_rig_when_the_new_one_is_bad $? "$work/run.err"
sed -i '$d' "$work/rig.ini"

ip link del vcan0
until_true 60 grep -q 'vcan0: the interface has gone' "$work/run.err"
verdict run.tells_of_an_interface_that_leaves $? "$work/run.err"
wait $server
[ $? -eq 4 ]
verdict run.serve_ends_with_status_4 $? "$work/serve.err"
bus_up
serve
until_true 60 grep -q 'all devices are there again' "$work/run.err"
verdict run.opens_an_interface_that_returns $? "$work/run.err"
sleep 1
kill -USR1 $runner
until_true 60 tracks 4
verdict run.tracks_again $? "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ]
verdict run.survived_it_all $? "$work/run.err" "$work/run.json"
end_serve

serve
in_background --arm --targets "$work/targets.jsonl"
until_true 60 tracks 1
ip link del vcan0
wait $runner
[ $? -eq 4 ]
verdict run.a_lost_interface_is_status_4 $? "$work/run.err"
wait $server

in_background --arm --targets "$work/targets.jsonl" --stay
until_true 60 grep -q 'vcan0: no such interface; ' "$work/run.err"
ip link add dev vcan0 type vcan
until_true 60 grep -q 'vcan0: the interface is down; ' "$work/run.err" && ip link set vcan0 up && serve && until_true 60 tracks 1
verdict run.waits_for_an_interface_that_appears_late $? "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ] && [ "$(grep -c 'waiting until' "$work/run.err")" -eq 1 ]
verdict run.and_ends_well $? "$work/run.err"
end_serve

# ---------------------------------------------------------------- the journal: a socket where it would stand
mkdir -p /run/systemd/journal
python3 -c '
import socket
journal = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
journal.bind("/run/systemd/journal/socket")
print("listening", flush=True)
while True:
    print(journal.recv(65536).decode(), flush=True)' >"$work/journal" 2>&1 &
journal=$!
until_true 200 grep -q listening "$work/journal"
{ cat host-sim/rigs/hobby.ini && printf '\n[controller]\ntick_us = 20000\n'; } >"$work/hobby.ini"
: >"$work/run.err"
JOURNAL_STREAM=$(stat -c %d:%i "$work/run.err") "$boresight" run "$work/hobby.ini" --json --arm --seconds 3 --log journal \
    >"$work/run.json" 2>"$work/run.err"
[ $? -eq 0 ] && grep -q '"log_dropped": 0' "$work/run.json"
verdict run.logs_to_the_journal $? "$work/run.err" "$work/run.json"
until_true 30 grep -q '^MESSAGE=exit status 0$' "$work/journal" && grep -q '^SYSLOG_IDENTIFIER=boresight$' "$work/journal" &&
    grep -q '^BORESIGHT_EVENT=mode$' "$work/journal"
verdict run.journal_has_the_events $? "$work/journal"
[ ! -s "$work/run.err" ]
verdict run.a_service_says_them_once $? "$work/run.err"
kill $journal
loop_only_waits run
