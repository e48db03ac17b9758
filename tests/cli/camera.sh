#!/bin/sh
# Rig files with cameras, where there is no camera: what is refused, and in which words. tests/vm/guest/camera.sh has
# the cameras.
. tests/cli/support/check.sh
missing='/dev/no-such-camera: no such file or device; is it plugged in? `boresight probe` lists the cameras'
axis='limit_min_deg = -80
limit_max_deg = 80
speed_max_dps = 40
accel_max_dps2 = 100'
# rig DEVICE [MORE]: of a camera that turns itself; MORE goes to the end.
rig() {
    printf '[pan]\ndrive = uvc\ndevice = %s\n%s\n[tilt]\ndrive = uvc\ndevice = %s\n%s\n%s\n' "$1" "$axis" "$1" "$axis" "${2:-}" >"$dir/rig.ini"
}
at="$dir/rig.ini"

rig fake
run run "$at" --seconds 0.2 --json
verdict fake_axes_of_a_camera_are_simulated $([ $status -eq 0 ] && grep -q '"violations": 0' "$dir/out"; echo $?)
run config check "$at"
verdict config_explains_it $([ $status -eq 0 ] && grep -q '^  drive .* uvc ' "$dir/out" && grep -q 'simulated: every device is a fake' "$dir/out"; echo $?)
run config c "$at"
ends no_board_drives_it 2 "$at:2: key 'drive': is uvc, which only this computer can drive, not a board"
rig fake '[controller]
board = serial:/dev/null'
run run "$at"
ends not_even_one_that_is_there 2 "$at:2: key 'drive': is uvc, which only this computer can drive, not a board"

sed 's/^\[camera\]/&\ndevice = \/dev\/video0\ndetect = markers/' host-sim/rigs/hobby.ini >"$dir/board.ini"
printf '[controller]\nboard = serial:/dev/null\n' >>"$dir/board.ini"
run run "$dir/board.ini"
verdict a_board_has_no_eyes $([ $status -eq 2 ] && grep -q "'device': is not looked at when a board drives the rig" "$dir/err"; echo $?)

rig /dev/no-such-camera
run run "$at" --seconds 1
ends a_missing_camera_is_status_4 4 "$at: $missing"
rig fake "[camera]
device = /dev/no-such-camera
detect = markers"
run run "$at" --seconds 1
ends also_for_its_frames 4 "$at: $missing"
rig fake "[camera]
device = No such camera
detect = markers"
run run "$at" --seconds 1
ends also_by_its_name 4 "$at: No such camera: no camera of that name; is it plugged in? \`boresight probe\` lists the cameras"
rig fake "[camera]
device = /dev/null
detect = markers"
run run "$at" --seconds 1
ends what_is_no_camera_gives_no_frames 4 "$at: /dev/null: it gives no frames; \`boresight probe\` lists the cameras"

rig fake
sed -i 's/^limit_max_deg = 80/limit_max_deg = 181/' "$at"
run config check "$at"
ends more_than_half_a_turn_is_too_much 2 "$at:2: key 'drive': is uvc: its limits are at most 180 degrees to either side"
zoom='[zoom]
drive = uvc
focal_mm = 4, 20'
rig fake "$zoom"
run config check "$at"
ends zoom_needs_its_units 2 "$at:17: key 'focal_mm': and zoom_units need as many values as each other, 2 to 16"
rig fake "$zoom
zoom_units = 100, 100"
run config check "$at"
ends zoom_units_must_differ 2 "$at:18: key 'zoom_units': must rise from point to point (zoom_units may also fall)"
rig fake "$zoom
zoom_units = 500, 100"
run config check "$at"
verdict zoom_units_may_fall $([ $status -eq 0 ] && grep -q 'zoom   4.0 to 20.0 mm' "$dir/out"; echo $?)
rig fake "[zoom]
drive = pwm
focal_mm = 4, 20"
run config check "$at"
ends pulses_are_not_forgotten 2 "$at:17: key 'focal_mm': and pulse_us need as many values as each other, 2 to 16"

for wrong in "detect = faces|no detector 'faces': tags, markers or motion" \
    "tag_family = tag1|must be one of tag36h11, tag36h10, tag25h9, tag16h5, tagStandard41h12, tagCircle21h7"; do
    rig fake "[camera]
${wrong%%|*}"
    run config check "$at"
    ends "wrong_${wrong%% *}_is_named" 2 "$at:16: key '${wrong%% *}': ${wrong#*|}"
done
rig fake '[camera]
device = /dev/null'
run config check "$at"
ends a_camera_that_looks_for_nothing_is_of_no_use 2 "$at:16: key 'device': needs to be told what to look for: detect = tags, or markers, or motion"
rig fake '[camera]
pixels = rgb'
run config check "$at"
ends wrong_pixels_are_named 2 "$at:16: key 'pixels': 'rgb' is none of any, grey, yuyv, mjpeg"
finish
