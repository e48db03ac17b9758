#!/bin/sh
# The closed loop through a camera: the simulator renders what the gimbal's camera sees, a detector finds the targets in
# it, the controller follows what was found. Nothing else tells it of them.
. tests/cli/support/check.sh

# loop NAME LOOKS DETECTOR SIZE RMS: the scenario with other looks; the aim's error is at most RMS degrees.
loop() {
    mkdir -p "$dir/rigs" "$dir/scenarios"
    sed "s/^detect.*/detect = $3/" host-sim/rigs/camera.ini >"$dir/rigs/camera.ini"
    sed "s/^looks.*/looks = $2/; s/^size_deg.*/size_deg = $4/" host-sim/scenarios/camera.ini >"$dir/scenarios/camera.ini"
    run sim "$dir/scenarios/camera.ini" --seconds 8 --json
    has "$1: three targets, no violation" 0 'targets=3' 'violations=0' 'mode="tracking"'
    echo "MEASURED $1: aim error $(fact aim_error_rms_deg) degrees rms, $(fact in_frame_percent) % in the picture"
    awk -v rms="$(fact aim_error_rms_deg)" -v most="$5" -v in_frame="$(fact in_frame_percent)" -v settle="$(fact settle_s)" \
        'BEGIN { exit !(rms > 0 && rms <= most && in_frame >= 99 && settle > 0) }'
    verdict "$1: the camera follows them" $?
}
loop lamps lamps markers 1.5 0.6
loop people people motion 5 4
if "$boresight" --version | grep -q 'no libapriltag'; then
    echo 'SKIP tags: this program was built without libapriltag'
else
    loop tags tags tags 7 1
fi

# Frames that are old when they are told of cost nothing but their age in a manoeuvre: what goes is carried on.
sed "s/^detect.*/detect = markers/" host-sim/rigs/camera.ini >"$dir/rigs/camera.ini"
for late in 0 100; do
    sed "s/^latency_ms.*/latency_ms = $late/" host-sim/scenarios/camera.ini >"$dir/scenarios/camera.ini"
    run sim "$dir/scenarios/camera.ini" --seconds 5 --json
    facts
    eval "error_$late=$(fact aim_error_rms_deg)"
done
echo "MEASURED lamps: aim error $error_0 degrees rms by frames told at once, $error_100 when they are 100 ms old"
awk -v fresh="$error_0" -v old="$error_100" 'BEGIN { exit !(fresh > 0 && old <= 1.15 * fresh) }'
verdict 'old frames: what moves is where it is by now' $?

# Another seed is other noise; the same one the same bits, with every compiler.
hash_of() { "$1" sim host-sim/scenarios/camera.ini --seconds 2 --json --seed "$2" | sed 's/.*"trace_hash": "\([0-9a-f]*\)".*/\1/'; }
first=$(hash_of build/gcc/boresight 1)
[ ${#first} -eq 16 ] && [ "$first" = "$(hash_of build/clang/boresight 1)" ] && [ "$first" = "$(hash_of build/san/boresight 1)" ]
verdict 'gcc, clang and the sanitizers: the same trace hash' $?
[ "$first" != "$(hash_of build/gcc/boresight 2)" ]
verdict 'another seed, another trace hash' $?

# Without the camera's detector the rig sees nothing: it holds.
sed "/^detect/d" host-sim/rigs/camera.ini >"$dir/rigs/camera.ini"
cp host-sim/scenarios/camera.ini "$dir/scenarios/camera.ini"
run sim "$dir/scenarios/camera.ini" --seconds 1 --json
[ "$status" -eq 2 ] && grep -q 'needs detect = markers' "$dir/err"
verdict 'looks that the rig does not look for' $?
finish
