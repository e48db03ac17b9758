#!/bin/sh
# `boresight calibrate` against the simulator's drives, whose ends and lag are known, and against sightings whose pointing
# model is known. What it writes back changes values and nothing else.
. tests/cli/support/check.sh
value() { sed -n "s/.*\"$1\": \"\{0,1\}\([^\"}]*\).*/\1/p" "$dir/out" | sed 's/, "*.*//'; }
# near VALUE CENTRE BELOW ABOVE
near() { awk -v v="$1" -v c="$2" -v a="$3" -v b="$4" 'BEGIN { exit !(v != "" && v + 0 >= c - a && v + 0 <= c + b) }'; }
# within VALUE LOW HIGH
within() { awk -v v="$1" -v low="$2" -v high="$3" 'BEGIN { exit !(v != "" && v + 0 >= low && v + 0 <= high) }'; }

# The plant's end stops are at +-200 degrees of pan and -100 and 110 of tilt (host-sim/plant/axis_plant.h); the drives' lag
# is 1 / 80 s, the inverse of their position gain, and a setpoint is sent every 4 ms.
sed 's/^limit_min_deg = -175/limit_min_deg = -250/; s/^limit_max_deg = 175/limit_max_deg = 250\t ; the cable/
    s/^limit_max_deg = 95/limit_max_deg = 75/; s/^speed_max_dps = 60/&   # slow;  heavy camera/' host-sim/rigs/studio.ini >"$dir/rig.ini"
chmod 640 "$dir/rig.ini"
cp "$dir/rig.ini" "$dir/before.ini"
run calibrate "$dir/rig.ini" --json --dry-run </dev/null
cmp -s "$dir/rig.ini" "$dir/before.ini" && [ "$status" -eq 0 ] && grep -q '"written": false' "$dir/out"
verdict 'a dry run writes nothing' $?
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 0 ] && grep -q '"written": true' "$dir/out" && grep -q 'pan and tilt move now' "$dir/err"
verdict 'says that it moves, and that it wrote' $?
[ "$(value pan_low_end)" = stop ] && [ "$(value pan_high_end)" = stop ] && within "$(value pan_min_deg)" -198.1 -197.9 &&
    within "$(value pan_max_deg)" 197.9 198.1
verdict 'finds the ends of pan, and stays 2 degrees away' $?
[ "$(value tilt_low_end)" = limit ] && [ "$(value tilt_high_end)" = limit ] && within "$(value tilt_max_deg)" 75 75
verdict 'tilt reaches its limits' $?
for axis in pan tilt; do
    within "$(value ${axis}_latency_ms)" 12.5 18.5
    verdict "$axis: latency is that of the simulated drive" $?
done
# Times of moves: rest to rest as `config check` works them out, less the slow last 0.1 degree, and the lag.
boresight_move() { "$boresight" config check "$dir/before.ini" | sed -n "s/^  $1 *turns 10 degrees in \([0-9.]*\) s and 90 degrees in \([0-9.]*\) s.*/\\$2/p"; }
for axis in pan tilt; do
    ten=$(boresight_move $axis 1) ninety=$(boresight_move $axis 2)
    times=$(sed -n "s/.*\"${axis}_move_s\": \[\([^]]*\)\].*/\1/p" "$dir/out")
    near "$(echo "$times" | cut -d, -f1)" "$ten" 0.08 0.03 && near "$(echo "$times" | cut -d, -f3)" "$ninety" 0.08 0.03
    verdict "$axis: moves take as long as their profile" $?
done
within "$(value pan_speed_dps)" 89 91 && within "$(value tilt_speed_dps)" 59 61
verdict 'the speeds that were seen' $?

# All that was there is there, with other limits, and the new keys behind the old ones of their section.
diff "$dir/before.ini" "$dir/rig.ini" >"$dir/diff"
[ "$(grep -c '^<' "$dir/diff")" -eq 2 ] && [ "$(grep -c '^>' "$dir/diff")" -eq 8 ] &&
    grep -q "^limit_max_deg = 198.00$(printf '\t') ; the cable # measured 20[0-9-]* [0-9:]* UTC: 2 degrees before what is in the way$" "$dir/rig.ini" &&
    [ "$(grep -c '^latency_ms = [0-9.]* # measured .*: median of 2 rounds, spread 0.[0-9]* ms$' "$dir/rig.ini")" -eq 2 ] &&
    [ "$(grep -c '^move_s = .* # measured .*: median of 2 rounds, spread 0.[0-9]* s$' "$dir/rig.ini")" -eq 2 ] &&
    grep -q '^speed_max_dps = 60   # slow;  heavy camera$' "$dir/rig.ini" && [ "$(stat -c %a "$dir/rig.ini")" = 640 ]
verdict 'only values change in the file' $?
run config check "$dir/rig.ini"
grep -q '^  pan    is 1[0-9.]* ms behind its setpoint, which leads moving targets by as much$' "$dir/out" && [ "$status" -eq 0 ]
verdict 'config check knows the new keys' $?
# What was measured is made up for: a target that goes by at up to 30 degrees a second is followed with less than half of
# the error.
mkdir "$dir/scenarios"
printf '[scenario]\nname = walk\nabout = a target that goes round\nrig = ../walk.ini\nseconds = 15\nseed = 1\n' >"$dir/scenarios/walk.ini"
printf '[mover ann]\nid = 1\nstart_m = 0, -10, 0\nradius_m = 4\nturn_dps = 60\nperiod_ms = 10\n' >>"$dir/scenarios/walk.ini"
walk() { "$boresight" sim "$dir/scenarios/walk.ini" --json | sed 's/.*"aim_error_rms_deg": \([0-9.]*\).*/\1/'; }
cp "$dir/rig.ini" "$dir/walk.ini"
with=$(walk)
sed -i '/^latency_ms/d' "$dir/walk.ini"
without=$(walk)
echo "MEASURED aim error of a target that goes round: $with degrees rms with the latencies that were measured, $without without"
awk -v a="$with" -v b="$without" 'BEGIN { exit !(a > 0 && a < 0.5 * b) }'
verdict 'setpoints lead by the latency that was measured' $?
cp "$dir/rig.ini" "$dir/once.ini"
run calibrate "$dir/rig.ini" --json </dev/null
diff "$dir/rig.ini" "$dir/once.ini" >"$dir/diff"
[ "$status" -eq 0 ] && ! grep -qv '^[<>] \(move_s\|latency_ms\)\|^[0-9-]' "$dir/diff" && near "$(value pan_latency_ms)" 15.5 3 3
verdict 'a second time leaves the limits where they are' $?
[ "$(grep -c '# measured' "$dir/rig.ini")" -eq 6 ] && ! grep -q '# measured.*# measured' "$dir/rig.ini" && grep -q '; the cable # measured' "$dir/rig.ini"
verdict 'nor does it note them twice' $?
cp "$dir/before.ini" "$dir/rig.ini"
chmod 440 "$dir/rig.ini"
run calibrate "$dir/rig.ini" --keep-limits --json </dev/null
[ "$status" -eq 1 ] && grep -q "^$dir/rig.ini: is read-only: nothing is written$" "$dir/err" && cmp -s "$dir/rig.ini" "$dir/before.ini" && ! grep -q 'move now' "$dir/err"
verdict 'a file that is read-only is left alone' $?
chmod 640 "$dir/rig.ini"
run calibrate "$dir/rig.ini" --keep-limits --json </dev/null
# 250 degrees can't be reached, so a rig whose limits are wrong is stopped, and says so.
[ "$status" -eq 0 ] && ! diff "$dir/before.ini" "$dir/rig.ini" | grep -q '^<' &&
    [ "$(value pan_low_end) $(value pan_high_end) $(value tilt_low_end) $(value tilt_high_end)" = 'limit limit limit limit' ]
verdict 'limits are kept when asked to' $?
# Nine degrees of room are none for a move of ten: its latency is measured on what there is.
sed 's/^limit_min_deg = .*/limit_min_deg = -4.5/; s/^limit_max_deg = .*/limit_max_deg = 4.5/' host-sim/rigs/studio.ini >"$dir/rig.ini"
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 0 ] && grep -q '"pan_move_s": \[\]' "$dir/out" && grep -q '"tilt_move_s": \[\]' "$dir/out" && ! grep -q '^move_s' "$dir/rig.ini" &&
    within "$(value pan_latency_ms)" 12.5 18.5 && within "$(value tilt_latency_ms)" 12.5 18.5 && [ "$(grep -c '^latency_ms = .* measured' "$dir/rig.ini")" -eq 2 ]
verdict 'an axis with little room' $?
sed 's/^limit_min_deg = .*/limit_min_deg = -0.2/; s/^limit_max_deg = .*/limit_max_deg = 0.2/' host-sim/rigs/studio.ini >"$dir/rig.ini"
cp "$dir/rig.ini" "$dir/small.ini"
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 1 ] && grep -qx 'boresight calibrate: pan has too little room to measure its latency' "$dir/err" && cmp -s "$dir/rig.ini" "$dir/small.ini"
verdict 'an axis with next to none' $?

# ---------------------------------------------------------------- the camera
# A simulated camera stamps its frames late by what its name says. What is measured is 0.3 ms less: so long a drive needs
# to say where it is, and the end of its answer is what is timed.
thing() { printf '{"id": 3, "dir": [0.05, 1, 0.02]}\n{"id": 4, "dir": [-0.15, 1, 0.1]}\n' >"$dir/world"; }
thing
for late in 5 20 35 60; do
    sed "s|^detect.*|detect = markers\nrate_hz = 12\ndevice = fake:$dir/world@$late|" host-sim/rigs/camera.ini >"$dir/rig.ini"
    cp "$dir/rig.ini" "$dir/before.ini"
    run calibrate "$dir/rig.ini" --camera --json </dev/null
    [ "$status" -eq 0 ] && near "$(value camera_latency_ms)" "$late" 0.8 0.2 && within "$(value camera_rms_deg)" 0.0001 0.1
    verdict "the latency of a camera that is $late ms late" $?
    diff "$dir/before.ini" "$dir/rig.ini" >"$dir/diff"
    [ "$(grep -c '^<' "$dir/diff")" -eq 0 ] && [ "$(grep -c '^> latency_ms = ' "$dir/diff")" -eq 1 ] && [ "$(grep -c '^>' "$dir/diff")" -eq 1 ] &&
        near "$(sed -n 's/^latency_ms = \([0-9.]*\) # measured .* sightings, 0.0.* degrees rms apart$/\1/p' "$dir/rig.ini")" "$late" 0.8 0.2 && ! grep -q 'pan_' "$dir/out"
    verdict "and is written back ($late)" $?
done
# The lens, too, which is that of the file; a line about it only where it is another one, and it is written where asked for.
fx=$("$boresight" config check "$dir/rig.ini" | awk '$1 == "fx_px" { print $3 }')
[ "$fx" = 0 ] && fx=$("$boresight" config check "$dir/rig.ini" | awk '$1 == "focal_mm" { f = $3 } $1 == "sensor_width_mm" { s = $3 } $1 == "width_px" { w = $3 } END { print f / s * w }')
run calibrate "$dir/rig.ini" --camera --lens --json </dev/null
[ "$status" -eq 0 ] && within "$(value camera_fx_px)" "$(awk -v f="$fx" 'BEGIN { print f * 0.997 }')" "$(awk -v f="$fx" 'BEGIN { print f * 1.003 }')" && ! grep -q 'fx_px =' "$dir/err" &&
    grep -q "^fx_px = $(value camera_fx_px | cut -c1-4)[0-9.]* # measured .* sightings, 0.0.* degrees rms apart\$" "$dir/rig.ini"
verdict 'the lens, by how far things move' $?
echo "MEASURED focal length of a lens of $fx px: $(value camera_fx_px)"
run calibrate "$dir/rig.ini" --keep-limits --json </dev/null # beside the axes; what is in the file already does not matter
[ "$status" -eq 0 ] && near "$(value camera_latency_ms)" 60 0.8 0.2 && within "$(value pan_latency_ms)" 12.5 18.5 && [ "$(grep -c '^latency_ms' "$dir/rig.ini")" -eq 3 ]
verdict 'axes and camera together' $?
# Hobby servos say nothing of where they are: what they are late by is in it, so that frames are placed right.
sed "s|^\[camera\]|&\ndetect = markers\nrate_hz = 12\nwidth_px = 320\nheight_px = 240\ndevice = fake:$dir/world@35|" host-sim/rigs/hobby.ini >"$dir/rig.ini"
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 0 ] && within "$(value camera_latency_ms)" 45 70
verdict 'on hobby servos, the camera and they together' $?
: >"$dir/world"
cp "$dir/rig.ini" "$dir/before.ini"
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 0 ] && grep -q '"camera_latency_ms": null' "$dir/out" && cmp -s "$dir/rig.ini" "$dir/before.ini" &&
    grep -q 'no latency of the camera: the camera sees nothing to measure by: put a tag or a lamp before it$' "$dir/err"
verdict 'a camera that sees nothing' $?
# Something that goes by itself is nothing to measure by.
awk 'BEGIN { for (i = 0; i < 900; i++) printf "{\"t_us\": %d, \"id\": 3, \"dir\": [%.5f, 1, %.5f]}\n", i * 20000, 0.15 * sin(i * 0.31), 0.1 * sin(i * 0.23) }' >"$dir/world"
run calibrate "$dir/rig.ini" --json </dev/null
[ "$status" -eq 0 ] && grep -q '"camera_latency_ms": null' "$dir/out" && cmp -s "$dir/rig.ini" "$dir/before.ini" && grep -q 'does not stand still' "$dir/err"
verdict 'nor one that sees something that moves' $?
run calibrate host-sim/rigs/studio.ini --camera </dev/null
ends 'no camera in the file' 2 'host-sim/rigs/studio.ini: [camera] names no device: there is nothing to measure'

# ---------------------------------------------------------------- sightings
# From a model by matrices, written out here: where each joint pair looks, at a distance, from the mount's position.
sightings() { # HEADING PITCH ROLL OFFSET COUNT NOISE
    awk -v h="$1" -v p="$2" -v r="$3" -v o="$4" -v count="$5" -v noise="$6" 'BEGIN {
        d = atan2(0, -1) / 180; h *= d; p *= d; r *= d; seed = 12345
        for (i = 0; i < count; i++) {
            pan = (i * 57) % 300 - 150; tilt = (i * 13) % 70 - 20
            a = pan * d; t = (tilt + o) * d
            x = cos(t) * sin(a); y = cos(t) * cos(a); z = sin(t)
            lx = sin(h); ly = cos(h); rx = cos(h); ry = -sin(h)
            ux = -lx * sin(p); uy = -ly * sin(p); uz = cos(p)
            qx = rx * cos(r) - ux * sin(r); qy = ry * cos(r) - uy * sin(r); qz = -uz * sin(r)
            vx = ux * cos(r) + rx * sin(r); vy = uy * cos(r) + ry * sin(r); vz = uz * cos(r)
            far = 3 + i
            seed = (seed * 1103 + 12289) % 65521
            printf "%.9f %.9f  %.9f,%.9f %.9f # %d\n", pan + noise * (seed / 65521 - 0.5), tilt,
                1 + far * (x * qx + y * lx * cos(p) + z * vx), -2 + far * (x * qy + y * ly * cos(p) + z * vy),
                0.5 + far * (x * qz + y * sin(p) + z * vz), i
        }
    }'
}
fitted() { # NAME HEADING PITCH ROLL OFFSET TOLERANCE
    good=$status
    for pair in heading_deg=$2 pitch_deg=$3 roll_deg=$4 tilt_offset_deg=$5; do
        near "$(value "${pair%=*}")" "${pair#*=}" "$6" "$6" || good=1
    done
    verdict "$1" $good
}
mounted() { # the rig with a position, without the attitude
    sed '/^heading_deg/d; s/^\[mount\]/&\nposition_m = 1, -2, 0.5 # the mast/' host-sim/rigs/studio.ini >"$dir/rig.ini"
}
for model in '33.3 -4.2 2.7 1.25' '-170 0 0 0' '179.9 3 -1 -2' '12 2 178.5 0.5' '0 0 0 0'; do
    set -- $model
    mounted
    sightings "$@" 8 0 >"$dir/sightings"
    # An upside down mount is found from a rough idea of it, as a person would write it.
    [ "$3" != 178.5 ] || sed -i 's/^\[mount\]/&\nroll_deg = 180/' "$dir/rig.ini"
    run calibrate "$dir/rig.ini" --sightings "$dir/sightings" --json </dev/null
    fitted "pointing model $model" "$@" 0.0002
done
sightings 33.3 -4.2 2.7 0 2 0 >"$dir/sightings"
mounted
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" --json </dev/null
fitted 'two sightings give the attitude' 33.3 -4.2 2.7 0 0.0002
grep -q '^position_m = 1, -2, 0.5 # the mast$' "$dir/rig.ini" && grep -q '^heading_deg = 33.3000$' "$dir/rig.ini" && ! grep -q '^zero_deg' "$dir/rig.ini"
verdict 'two sightings leave the zero of tilt alone' $?
sightings 20 1 -2 0.8 60 0.2 >"$dir/sightings"
mounted
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" --json </dev/null
fitted 'sightings that are off by up to 0.1 degree' 20 1 -2 0.8 0.05
within "$(value rms_deg)" 0.02 0.1
verdict 'and what is left is told' $?
grep -q '^zero_deg = -0.[78]' "$dir/rig.ini"
verdict 'the zero of tilt is written' $?
# Written back, the model is right: a second fit finds nothing to change but the zero that is now in the drive.
sightings 33.3 -4.2 2.7 0 12 0 >"$dir/sightings"
mounted
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" --json </dev/null
cp "$dir/rig.ini" "$dir/once.ini"
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" --json </dev/null
cmp -s "$dir/rig.ini" "$dir/once.ini"
verdict 'a second fit changes nothing' $?

# ---------------------------------------------------------------- bad input
mounted
printf '10 20 1 2\n' >"$dir/sightings"
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" </dev/null
ends 'a bad sighting' 2 "$dir/sightings:1: is no sighting; give PAN_DEG TILT_DEG and the X Y Z of what was seen"
printf '# none\n10 20 1 -2 0.5\n' >"$dir/sightings"
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" </dev/null
ends 'a sighting of the mount itself' 2 "$dir/sightings:2: is no sighting; give PAN_DEG TILT_DEG and the X Y Z of what was seen"
printf '10 20 5 5 5\n10 20 5 5 5\n10 20 5 5 5\n' >"$dir/sightings"
run calibrate "$dir/rig.ini" --sightings "$dir/sightings" </dev/null
ends 'sightings of one point' 3 "$dir/sightings: these sightings do not determine the model: give more, far apart in pan and tilt"
{
    cat host-sim/rigs/studio.ini
    printf '\n[controller]\nboard = serial:/dev/ttyACM0\n'
} >"$dir/rig.ini"
run calibrate "$dir/rig.ini" </dev/null
ends 'a rig that a board drives' 2 \
    "$dir/rig.ini:$(wc -l <"$dir/rig.ini"): key 'board': drives the rig: only what this program drives itself can be measured"
run calibrate </dev/null
ends 'no rig file' 2 'boresight calibrate: which rig? give its file'
run calibrate host-sim/rigs/hobby.ini </dev/null
[ "$status" -eq 2 ] && grep -q 'neither axis measures its position' "$dir/err"
verdict 'hobby servos are not measured' $?
finish
