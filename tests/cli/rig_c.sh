#!/bin/sh
# `boresight config c`: the settings as C, compiled and compared with the rig file they came from.
. tests/gate/verdict.sh
program=${BORESIGHT:-build/boresight}
dir=$(mktemp -d)

# Every kind of value that a rig file can have away from its default.
cat >"$dir/odd.ini" <<'INI'
[mount]
position_m = -1.5, 2.25, 1000
heading_deg = -37.5
pitch_deg = 3.25
roll_deg = 180
[pan]
drive = rmd
id = 32
dialect = lktech
reversed = yes
zero_deg = -123.456
limit_min_deg = -3600
limit_max_deg = 3600
speed_max_dps = 0.001
accel_max_dps2 = 0.01
[tilt]
drive = pwm
channel = 63
calibration_deg = -90.5, 90.25
calibration_us = 2400.125, 600
limit_min_deg = -45.125
limit_max_deg = 60
home_deg = 12.5
speed_max_dps = 60
accel_max_dps2 = 150
jerk_max_dps3 = 3000
[camera]
frame = rect
sensor_width_mm = 6.4
[occlusion]
policy = weigh
frame_ms = 50
ahead_s = 2.5
fade_s = 0.25
hidden_percent = 12.5
[controller]
tick_us = 5000
target_expiry_ms = 86400000
smoothing_percent = 62.5
coast_ms = 17
jump_deg = 180
[safety]
silence_ms = 10000
settle_ms = 60000
follow_error_deg = 0.1
follow_error_ms = 60000
watchdog_ms = 60000
arm_on_start = yes
INI
compile() { # RIG
    "$program" config c "$1" >"$dir/rig.c" &&
        gcc -std=c11 -Wall -Wextra -Werror -D_GNU_SOURCE -Ifirmware -Ihal/include -Iboards -Iboards/linux -o "$dir/same" \
            tests/cli/support/same_rig.c "$dir/rig.c" build/gcc/libprogram.a build/gcc/libsim.a build/gcc/libhal.a \
            build/gcc/libfirmware.a -Wl,--as-needed -ljansson $(cat build/features.libs) -lm
}
for rig in host-sim/rigs/*.ini "$dir/odd.ini"; do
    compile "$rig" && "$dir/same" "$rig"
    verdict "${rig##*/} is the same as C" $?
done
sed 's/^zero_deg = .*/zero_deg = -123.457/' "$dir/odd.ini" >"$dir/other.ini"
"$dir/same" "$dir/other.ini" >/dev/null
caught 'another rig' $?
echo '[pan]' >"$dir/bad.ini"
"$program" config c "$dir/bad.ini" >"$dir/out" 2>"$dir/err"
[ $? -eq 2 ] && [ ! -s "$dir/out" ] && grep -q 'bad.ini' "$dir/err"
verdict 'a bad rig gives no C, but a line that names the file' $?
rm -r "$dir"
exit $status
