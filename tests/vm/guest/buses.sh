# `boresight run` on a gs_usb adapter by the kernel's driver, and on one that it drives itself, against the simulator's drives behind the kernel's
# driver of another adapter on the same bus; and with each axis on a bus of its own.
. tests/vm/guest/check.sh
load -a vcan can_raw vhci-hcd gs_usb
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
# Slow ticks and long patience: the emulated machine has no real time.
rig() { # PAN-BUS TILT-BUS
    awk -v pan="$1" -v tilt="$2" '/^bus = / { print "bus = " (seen++ ? tilt : pan); next } { print }' host-sim/rigs/studio.ini |
        sed 's/^silence_ms.*/silence_ms = 2000\nfollow_error_ms = 10000/; s/^watchdog_ms.*/watchdog_ms = 0/; s/^heading_deg.*/heading_deg = 0/'
    printf '\n[controller]\ntick_us = 10000\n'
}
rig fake fake >"$work/sim.ini"
printf '[scenario]\nname = served\nrig = sim.ini\nseconds = 1\ntick_us = 10000\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
printf '{"t_us": 0, "id": 1, "dir": [0.5, 1, 0.2]}\n' >"$work/targets.jsonl"
# atan2(0.5, 1) and asin(0.2 / |(0.5, 1, 0.2)|)
wanted_pan=26.5651 wanted_tilt=10.1421

fact() { sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$1"; }
near() { awk -v a="$1" -v b="$2" 'BEGIN { d = a - b; exit !(a != "" && b != "" && d <= 0.05 && -d <= 0.05) }'; }
serve() { # NUMBER INTERFACE
    "$boresight" sim "$work/served.ini" --serve "can:$2" --json >"$work/serve$1.json" 2>"$work/serve$1.err" &
    eval "server$1=\$!"
}
end_serve() { # NUMBER
    eval "kill -INT \$server$1; wait \$server$1"
}
start() { # ARGUMENT...
    : >"$work/run.json" >"$work/run.err" # or what waits for words may find the last run's
    watched "$boresight" run "$work/rig.ini" --json --arm --targets "$work/targets.jsonl" "$@" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
}
says() { [ "$(grep -c "$1" "$work/run.err")" -ge "${2:-1}" ]; }
end_run() {
    sleep 3 # time to arrive
    kill -INT $runner
    wait $runner
}

# ---------------------------------------------------------------- a bus for each axis
for name in vcan0 vcan1; do ip link add dev $name type vcan && ip link set $name up; done
rig can:vcan0 can:vcan1 >"$work/rig.ini"
serve 0 vcan0
serve 1 vcan1
start --stay
until_true 30 says 'run: tracking'
verdict buses.each_axis_on_its_own_bus $? "$work/run.err"
ip link del vcan1
until_true 30 says 'vcan1: the interface has gone'
verdict buses.tells_which_has_left $? "$work/run.err"
wait $server1
ip link add dev vcan1 type vcan && ip link set vcan1 up
serve 1 vcan1
until_true 30 says 'all devices are there again' && arms_until 2 says 'run: tracking' 2
verdict buses.opens_it_again $? "$work/run.err"
end_run
[ $? -eq 0 ]
verdict buses.ends_well $? "$work/run.err"
end_serve 0
end_serve 1
near "$(fact "$work/serve0.json" pan_deg)" $wanted_pan && near "$(fact "$work/serve1.json" tilt_deg)" $wanted_tilt
verdict buses.both_arrive $? "$work/serve0.json" "$work/serve1.json"
near "$(fact "$work/serve0.json" tilt_deg)" 0 && near "$(fact "$work/serve1.json" pan_deg)" 0
verdict buses.requests_go_to_their_bus_only $? "$work/serve0.json" "$work/serve1.json"
ip link del vcan0
ip link del vcan1

# ---------------------------------------------------------------- two adapters
rig gs_usb:0001 gs_usb:0001 >"$work/rig.ini"
start
wait $runner
[ $? -eq 4 ] && says 'CAN adapter 0001: no such USB device; is it plugged in? '
verdict buses.no_adapter_is_status_4 $? "$work/run.err"
mkfifo "$work/words"
exec 8<>"$work/words"
"$VM_TESTS/gcc/tests/vm/plug_candles" <"$work/words" &
candles=$!
interfaces() { set -- /sys/bus/usb/drivers/gs_usb/*/net/*; [ -e "$1" ] && [ $# -eq "$count" ]; }
count=2
until_true 30 interfaces
"$boresight" probe >"$work/probe"
grep -q '^usb .* bus = gs_usb:0001 ' "$work/probe" && grep -q '^usb .* bus = gs_usb:0002 ' "$work/probe"
verdict buses.probe_lists_adapters $? "$work/probe"
ours=
peer=
for folder in /sys/bus/usb/drivers/gs_usb/*/net/*; do
    case $(cat "$(readlink -f "$folder/device/..")/serial") in
    0001) ours=${folder##*/} ;;
    0002) peer=${folder##*/} ;;
    esac
done
ip link set "$peer" up type can bitrate 1000000

# ---------------------------------------------------------------- the kernel's driver, and a bus that fails
# A short queue is full as soon as the adapter holds its ten frames back. Half as many ticks: two adapters take much of the emulated processors,
# and a queue that was full once stays so if they can't keep up.
ip link set "$ours" txqueuelen 4 up type can bitrate 1000000
rig "can:$ours" "can:$ours" | sed 's/^tick_us.*/tick_us = 20000/' >"$work/rig.ini"
"$boresight" sim "$work/served.ini" --serve "can:$peer" --state 0.2 --json >"$work/truth" 2>"$work/serve0.err" &
server=$!
until_true 60 test -s "$work/truth"
mkfifo "$work/aims"
exec 7<>"$work/aims"
aim() { # PAN_DEG TILT_DEG: from now on
    wanted="$1 $2"
    awk -v p="$1" -v t="$2" 'BEGIN { r = atan2(0, -1) / 180
        printf "{\"id\": 1, \"dir\": [%.6f, %.6f, %.6f]}\n", sin(p * r) * cos(t * r), cos(p * r) * cos(t * r), sin(t * r) }' >&7
}
# The drives' own place, as the simulator knows it.
arrives() {
    tail -n 1 "$work/truth" | awk -F '"pan_deg": |, "tilt_deg": ' -v wanted="$wanted" '{ split(wanted, w, " "); x = $2 - w[1]; y = $3 - w[2] }
        END { exit !(NF == 3 && x * x + y * y < 0.01) }'
}
works_again() { until_true 60 says "can:$ours: the bus works again" $((again = again + 1)); }
now_ms() { awk '{ print int($1 * 1000) }' /proc/uptime; }
again=0
watched "$boresight" run "$work/rig.ini" --json --arm --stay --targets "$work/aims" >"$work/run.json" 2>"$work/run.err" &
runner=$!
aim 20 10
until_true 60 arrives
verdict buses.aims_by_the_kernels_gs_usb $? "$work/run.err" "$work/truth"

began=$(now_ms)
echo hold >&8
until_true 60 says "can:$ours: takes no frames, nobody on the bus acknowledges; check cable, termination, bit rate and the drives' power"
full=$?
echo carry >&8
[ $full -eq 0 ] && works_again
verdict buses.tells_of_a_queue_that_is_full $? "$work/run.err"
took=$(($(now_ms) - began))
if says 'run: faulted' && [ $took -gt 1900 ]; then
    echo "SKIP vm.buses.goes_on_when_it_drains: nothing crossed the bus for up to $took ms, of 2000 that are allowed"
else
    aim -10 5
    until_true 60 arrives && ! says 'run: faulted'
    verdict buses.goes_on_when_it_drains $? "$work/run.err" "$work/truth"
fi
faults=$(grep -c 'run: faulted' "$work/run.err")
echo hold >&8
until_true 60 says 'run: faulted: [a-z]*: a drive does not answer' $((faults + 1))
verdict buses.drives_fall_silent_when_it_stays_full $? "$work/run.err"
aim 15 -5
echo carry >&8
works_again && arms_until 3 arrives
verdict buses.aims_when_it_has_drained $? "$work/run.err" "$work/truth"

echo passive >&8
until_true 60 says "can:$ours: error-passive, many frames fail; check cable, termination, bit rate and the drives' power" &&
    ip -details link show "$ours" | grep -q 'can .*state ERROR-PASSIVE'
verdict buses.tells_of_error_passive $? "$work/run.err"
echo active >&8
works_again
verdict buses.tells_that_it_is_over $? "$work/run.err"

echo off >&8
until_true 60 says "$ours: bus-off; check cable, termination and bit rate; it is restarted"
verdict buses.tells_of_bus_off $? "$work/run.err"
aim -25 20
works_again && arms_until 3 arrives
verdict buses.aims_after_bus_off $? "$work/run.err" "$work/truth"
! says 'has gone' && ! says 'has left'
verdict buses.none_of_this_is_a_lost_device $? "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ] && [ "$(fact "$work/run.json" can_offs)" = 1 ] && [ "$(fact "$work/run.json" can_restarts)" = 1 ] &&
    [ "$(fact "$work/run.json" can_send_failed)" -gt 2 ] && [ "$(fact "$work/run.json" can_frames_lost)" = 0 ]
verdict buses.counts_what_failed $? "$work/run.err" "$work/run.json"
kill -INT $server
wait $server
ip link set "$ours" down

# ---------------------------------------------------------------- gs_usb by libusb
rig gs_usb:0001 gs_usb:0001 >"$work/rig.ini"
serve 0 "$peer"
record "$peer"
start --stay
until_true 60 says 'run: tracking'
verdict buses.runs_on_gs_usb $? "$work/run.err"
echo off >&8
sleep 1
arms_until 2 says 'run: tracking' 1
verdict buses.survives_bus_off $? "$work/run.err"
before=$(grep -c 'run: tracking' "$work/run.err")
echo unplug >&8
until_true 60 says 'CAN adapter 0001: the \(device\|adapter\) has left; plug it in again'
verdict buses.tells_that_the_adapter_has_left $? "$work/run.err"
echo plug >&8
until_true 60 says 'all devices are there again' && arms_until 2 says 'run: tracking' $((before + 1))
verdict buses.opens_the_adapter_again $? "$work/run.err"
end_run
[ $? -eq 0 ]
verdict buses.gs_usb_ends_well $? "$work/run.err" "$work/run.json"
end_serve 0
near "$(fact "$work/serve0.json" pan_deg)" $wanted_pan && near "$(fact "$work/serve0.json" tilt_deg)" $wanted_tilt
verdict buses.gs_usb_aims $? "$work/serve0.json" "$work/run.json"
[ "$(fact "$work/run.json" can_restarts)" -ge 1 ]
verdict buses.bus_off_was_restarted $? "$work/run.json"
end_record
[ "$(grep -c ' 14[12]#' "$work/candump")" -gt 100 ]
verdict buses.candump_saw_the_requests $?
kill $candles
wait $candles
loop_only_waits buses
