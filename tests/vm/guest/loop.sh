# The whole loop: `boresight run` takes frames of a USB camera and moves a gimbal on CAN; the gimbal is the simulator's, in another process on the
# same bus, and the camera shows what it sees from where those drives have really brought it. The camera is emulated at the USB level, under
# the kernel's own driver. How well it aims is told by the simulator, which alone knows the truth; what is on the bus, by candump.
. tests/vm/guest/check.sh
load -a vcan can_raw can-gw vhci-hcd uvcvideo
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
# Slow ticks and long patience: the emulated machine has no real time.
cat >"$work/sim.ini" <<'END'
[pan]
drive = rmd
bus = fake
id = 1
limit_min_deg = -80
limit_max_deg = 80
speed_max_dps = 10
accel_max_dps2 = 20
[tilt]
drive = rmd
bus = fake
id = 2
limit_min_deg = -28
limit_max_deg = 28
speed_max_dps = 10
accel_max_dps2 = 20
[camera]
device = Boresight test camera
pixels = grey
rate_hz = 10
width_px = 160
height_px = 120
fx_px = 150
detect = markers
latency_ms = 90
[safety]
silence_ms = 2000
follow_error_ms = 10000
watchdog_ms = 0
[controller]
tick_us = 10000
smoothing_percent = 60
END
printf '[scenario]\nname = served\nrig = sim.ini\nseconds = 1\ntick_us = 10000\n[targets]\nfile = none.jsonl\n[camera]\nsize_deg = 4\nfps = 6\n' >"$work/served.ini"
: >"$work/none.jsonl"

# ---------------------------------------------------------------- what there is, and what is seen of it
# Two buses, of the program and of the drives, and the kernel's gateway between them: so that one can leave and the other stays.
ours=vcan0
theirs=vcan1
link_add() { ip link add dev "$1" type vcan && ip link set "$1" up; }
join() { cangw -A -s $ours -d $theirs -e && cangw -A -s $theirs -d $ours -e; }
index_of() { cat "/sys/class/net/$1/ifindex"; }
has_camera() { grep -qs 'Boresight test camera' /sys/class/video4linux/*/name; } # the list is made anew each time
plug_camera() {
    "$VM_TESTS/gcc/tests/vm/plug_camera" "$work/camera" "$work/none.jsonl" "$work/view.pgm" &
    camera=$!
    until_true 60 has_camera
}
unplug_camera() {
    kill -TERM $camera
    wait $camera
}
says() { [ "$(grep -c "$1" "$work/run.err")" -ge "${2:-1}" ]; }
fact() { sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$1" | tail -n 1; }
# lamp PAN_DEG TILT_DEG: is there from now on. Afterwards lines of the truth count from here.
lamp() {
    mark=$(wc -l <"$work/truth")
    awk -v p="$1" -v t="$2" 'BEGIN { r = atan2(0, -1) / 180
        printf "{\"id\": 1, \"dir\": [%.6f, %.6f, %.6f]}\n", sin(p * r) * cos(t * r), cos(p * r) * cos(t * r), sin(t * r) }' >&9
}
# Since it moved the camera was far off, and has been within half a degree for 15 lines.
settled() {
    sleep 0.3
    awk -F '"aim_error_deg": ' -v mark="$mark" 'NR > mark { error = $2 + 0; away = away || error > 3; near = error < 0.5 ? near + 1 : 0 }
        END { exit !(away && near >= 15) }' "$work/truth"
}
# It is off, and has not moved for a second: 10 lines.
holds() {
    sleep 0.3
    tail -n 10 "$work/truth" | awk -F '"pan_deg": |, "tilt_deg": |"aim_error_deg": ' 'NR == 1 { first = $2 }
        { moved = $2 - first; if (moved > 0.05 || moved < -0.05 || $4 + 0 < 3) bad = 1 } END { exit bad || NR < 10 }'
}
comes_back() { arms_until 2 settled; }

mkfifo "$work/lamps"
exec 9<>"$work/lamps"
link_add $ours && link_add $theirs && join
sed "s/^bus = fake/bus = can:$ours/; s/^tick_us.*/tick_us = 5000/" "$work/sim.ini" >"$work/rig.ini"
record $theirs
"$boresight" sim "$work/served.ini" --serve "can:$theirs" --frames "$work/view.pgm" --targets "$work/lamps" --state 0.1 --json >"$work/truth" 2>"$work/serve.err" &
server=$!
until_true 60 test -s "$work/truth"
plug_camera
verdict loop.buses_and_camera_are_there $? "$work/serve.err"
lamp 15 6
"$boresight" run "$work/rig.ini" --json --arm --stay >"$work/run.json" 2>"$work/run.err" &
runner=$!

until_true 30 settled
verdict loop.finds_the_lamp_and_aims $? "$work/run.err" "$work/truth"
lamp -5 -4
until_true 30 settled
verdict loop.follows_it $? "$work/run.err" "$work/truth"

# ---------------------------------------------------------------- what leaves and returns
unplug_camera
until_true 60 says 'the camera has left'
verdict loop.tells_that_the_camera_has_left $? "$work/run.err"
lamp 4 3
until_true 30 holds
verdict loop.holds_while_it_is_blind $? "$work/run.err" "$work/truth"
plug_camera
until_true 60 says 'the camera is there again' && comes_back
verdict loop.aims_when_the_camera_is_back $? "$work/run.err" "$work/truth"

before=$(index_of $ours)
take_link() { ip link del $ours && until_true 60 says "$ours: the interface has gone" "$1"; }
put_link() { link_add $ours && join; }
take_link 1
verdict loop.tells_that_the_interface_has_left $? "$work/run.err"
lamp -6 0
put_link
[ "$(index_of $ours)" != "$before" ]
verdict loop.it_returns_with_another_index $?
until_true 60 says 'all devices are there again' && comes_back
verdict loop.aims_when_the_interface_is_back $? "$work/run.err" "$work/truth"

# An error frame that says bus-off, as a card's driver hands it to every listener: the interface is restarted, here by being taken down and up.
cansend $ours 20000040#0000000000000000
lamp 7 -3
comes_back && says "$ours: bus-off; check cable, termination and bit rate; it is restarted"
verdict loop.aims_after_bus_off $? "$work/run.err" "$work/truth"

ip link set $ours down
lamp -3 5
until_true 30 holds && says "$ours: the interface was taken down; sudo ip link set $ours up"
verdict loop.holds_while_the_interface_is_down $? "$work/run.err" "$work/truth"
ip link set $ours up
comes_back
verdict loop.aims_when_it_is_up_again $? "$work/run.err" "$work/truth"

unplug_camera
take_link 2 && until_true 60 says 'the camera has left' 2
verdict loop.tells_that_both_have_left $? "$work/run.err"
lamp 10 0
plug_camera
put_link
until_true 60 says 'the camera is there again' 2 && until_true 60 says 'all devices are there again' 2 && comes_back
verdict loop.aims_when_both_are_back $? "$work/run.err" "$work/truth"

# ---------------------------------------------------------------- in the end
kill -INT $runner
wait $runner
[ $? -eq 0 ] && [ "$(fact "$work/run.json" camera_returns)" -ge 2 ] && [ "$(fact "$work/run.json" can_restarts)" -ge 1 ]
verdict loop.run_ends_well $? "$work/run.err" "$work/run.json"
kill -INT $server
wait $server
[ $? -le 1 ] && [ "$(fact "$work/truth" pictures)" -gt 100 ] && # 1: a drive that heard nothing for a while turned faster than it should
    awk -F '"pan_deg": |, "tilt_deg": |, "targets": ' 'NF == 4 && ($2 > 80 || $2 < -80 || $3 > 28 || $3 < -28) { bad = 1 } END { exit bad }' "$work/truth"
verdict loop.the_gimbal_kept_its_limits $? "$work/serve.err" "$work/truth"
end_record
unplug_camera
