#!/bin/sh
# Stepper drivers in a rig file: what is accepted, and one line for what is not.
. tests/cli/support/check.sh
# rig KEY VALUE...: hobby.ini with a stepper for tilt, and these keys of [tilt] changed.
rig() {
    awk '/^\[/ { section = $1 } section == "[tilt]" && /^calibration/ { next } section == "[tilt]" && /^drive/ { print "drive = step"; next }
        section == "[tilt]" && /^device/ { print "device = gpio:gpiochip0"; next }
        section == "[tilt]" && /^channel/ { print "channel = 17\ndirection_channel = 27\nsteps_per_deg = 44.4444"; next } { print }' host-sim/rigs/hobby.ini >"$dir/rig.ini"
    while [ $# -gt 1 ]; do
        sed -i "/^\[tilt\]/,/^\[camera\]/ s/^$1 = .*/$1 = $2/" "$dir/rig.ini"
        shift 2
    done
    line=$(grep -n "^\[tilt\]" "$dir/rig.ini" | cut -d: -f1)
}
# at KEY: the line of a key of [tilt].
at() { awk -v key="$1" '/^\[tilt\]/ { on = 1 } on && $1 == key { print NR; exit }' "$dir/rig.ini"; }
rig
run config check "$dir/rig.ini"
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ] && grep -q '^ *steps_per_deg' "$dir/out" && grep -q 'names real devices' "$dir/out"
verdict 'a stepper driver is explained' $?
rig steps_per_deg 0
run config check "$dir/rig.ini"
ends 'no scale' 2 "$dir/rig.ini:$(at steps_per_deg): key 'steps_per_deg': has to be told for drive = step"
rig steps_per_deg 100000 limit_max_deg 179 limit_min_deg -179
run config check "$dir/rig.ini"
ends 'too many steps' 2 "$dir/rig.ini:$(at steps_per_deg): key 'steps_per_deg': gives too many steps between the limits"
rig speed_max_dps 3600
run config check "$dir/rig.ini"
ends 'too fast' 2 "$dir/rig.ini:$(at speed_max_dps): key 'speed_max_dps': takes more than 75000 steps a second"
rig device fake
run config check "$dir/rig.ini"
ends 'not on plain lines' 2 "$dir/rig.ini:$(at device): key 'device': is 'fake'; a stepper driver is on gpio:CHIP"
rig
run config c "$dir/rig.ini"
ends 'not for a board' 2 "$dir/rig.ini:$(at drive): key 'drive': is step, which only this computer can drive, not a board"
rig
run run "$dir/rig.ini" --seconds 1
[ "$status" -eq 4 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -q "gpiochip0.*; \|without libgpiod" "$dir/err"
verdict 'no such chip: one line, exit status 4' $?
finish
