# Cameras: the kernel's vivid, and a USB camera emulated below uvcvideo.
. tests/vm/guest/check.sh
load vivid n_devs=1 node_types=0x1
"$VM_PROGRAMS/linux_vivid"
verdict camera$VM_SUFFIX.linux_vivid_ended_well $?
load -a vhci-hcd uvcvideo
"$VM_PROGRAMS/linux_camera"
verdict camera$VM_SUFFIX.linux_camera_ended_well $?
[ -z "$VM_SUFFIX" ] || exit

# ---------------------------------------------------------------- boresight run with a camera that turns itself
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
# Slow: what the camera has turned since a frame was exposed is an error of its direction, and the emulated machine takes
# long for a frame.
cat >"$work/rig.ini" <<'END'
[pan]
drive = uvc
device = Boresight test camera
limit_min_deg = -80
limit_max_deg = 80
speed_max_dps = 10
accel_max_dps2 = 40

[tilt]
drive = uvc
device = Boresight test camera
limit_min_deg = -28
limit_max_deg = 28
speed_max_dps = 10
accel_max_dps2 = 40

[camera]
device = Boresight test camera
pixels = grey
rate_hz = 5
width_px = 160
height_px = 120
fx_px = 150
detect = markers
latency_ms = 60

[controller]
tick_us = 10000
END
start() { # ARGUMENT...
    : >"$work/run.json" >"$work/run.err" # or what waits for words may find the last run's
    watched "$boresight" run "$work/rig.ini" --json --seconds 3000 "$@" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
}
end() { # STATUS
    kill -INT $runner 2>/dev/null
    wait $runner
    [ $? -eq "$1" ]
}
says() { [ "$(grep -c "$1" "$work/run.err")" -ge "${2:-1}" ]; }
# The thing's place and kind, for the camera; and whether the camera looks at it, within half a degree.
show() { echo "$*" >"$work/wish.new" && mv "$work/wish.new" "$work/wish"; }
looks_at() { # PAN_DEG TILT_DEG
    read -r pan tilt _ <"$work/state" && awk -v a="$pan" -v b="$1" -v c="$tilt" -v d="$2" \
        'BEGIN { exit !((a - b) ^ 2 + (c - d) ^ 2 < 0.25) }'
}
plugged() { grep -qs 'Boresight test camera' /sys/class/video4linux/*/name; } # the list is made anew each time
plug() {
    "$VM_TESTS/gcc/tests/vm/plug_camera" "$work/state" "$work/wish" &
    camera=$!
    until_true 60 plugged
}
unplug() {
    kill -TERM $camera
    wait $camera
}
fact() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$work/run.json"; }

show lamp 15 6
start --arm
wait $runner
[ $? -eq 4 ] && says 'Boresight test camera: no camera of that name; is it plugged in'
verdict camera.none_is_status_4 $? "$work/run.err"
plug
"$boresight" probe >"$work/probe"
grep '^camera ' "$work/probe" | grep -q 'device = /dev/video.*grey, yuyv, mjpeg up to 320x240; moves itself: pan, tilt, zoom 100 to 500 (drive = uvc)'
verdict camera.probe_shows_it $? "$work/probe"
sed 's/^limit_max_deg = 28/limit_max_deg = 40/' "$work/rig.ini" >"$work/far.ini"
"$boresight" run "$work/far.ini" --seconds 1 >/dev/null 2>"$work/run.err"
[ $? -eq 4 ] && says 'its tilt goes from -30.00 to 30.00 degrees; set limit_min_deg and limit_max_deg'
verdict camera.limits_beyond_its_reach_are_status_4 $? "$work/run.err"

start --arm --stay
until_true 60 looks_at 15 6
verdict camera.turns_to_the_lamp $? "$work/run.err" "$work/state"
show lamp -5 -4
until_true 60 looks_at -5 -4 && show lamp -22 -8 && until_true 60 looks_at -22 -8
verdict camera.follows_the_lamp $? "$work/run.err" "$work/state"

show lamp -22 -8 silent
until_true 60 says 'no frame for 3 s; it is opened anew'
verdict camera.tells_that_it_is_silent $? "$work/run.err"
show lamp -10 0
until_true 60 says 'frames come again' && until_true 60 looks_at -10 0
verdict camera.goes_on_when_frames_come_again $? "$work/run.err" "$work/state"

unplug
until_true 30 says 'the camera has left; plug it in again'
verdict camera.tells_that_it_has_left $? "$work/run.err"
show lamp 5 3
plug
until_true 60 says 'the camera is there again' && until_true 60 says 'all devices are there again'
verdict camera.opens_it_again $? "$work/run.err"
kill -USR1 $runner
until_true 60 looks_at 5 3
verdict camera.follows_it_again $? "$work/run.err" "$work/state"

# It refuses every setting: it is asked again and again, then told to be lost, opened anew, and used when it has come round.
# A small step: while it stays where it was, each frame makes the lamp seem that much farther away, until it is out of sight.
show lamp 6.2 3 stubborn
until_true 60 says 'it refuses to be turned; unplug it and plug it in again'
verdict camera.tells_that_it_refuses_to_be_turned $? "$work/run.err" "$work/state"
show lamp 6.2 3
comes_round() { # lost once more perhaps, so armed until it turns
    kill -USR1 $runner
    sleep 1
    looks_at 6.2 3
}
until_true 6 comes_round # 60 times
verdict camera.turns_when_it_has_come_round $? "$work/run.err" "$work/state"

end 0 && [ "$(fact camera_returns)" -ge 2 ] && [ "$(fact detected_updates)" -gt 10 ]
verdict camera.run_ends_well $? "$work/run.err" "$work/run.json"
for name in camera_frames camera_lost detected_frames detected_not detect_us_max; do
    echo "# camera loop in the emulator: $name $(fact $name)"
done

show lamp 9 5 # elsewhere: what looks there has opened the camera and sees
start --arm
until_true 60 looks_at 9 5
unplug
wait $runner
[ $? -eq 4 ] && says 'the camera has left'
verdict camera.a_lost_camera_is_status_4 $? "$work/run.err"
loop_only_waits camera
