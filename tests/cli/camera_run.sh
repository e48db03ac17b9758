#!/bin/sh
# `boresight run` on a simulated gimbal with a simulated camera, in real time: tags and lamps that only the camera sees are
# followed, the camera leaves and comes back, and SIGHUP changes the camera without touching the drives. Every step waits
# for what the rig itself says (--state), however long it takes.
. tests/cli/support/check.sh

detector=tags
if "$boresight" --version | grep -q 'no libapriltag'; then
    echo 'SKIP camera_run.tags: this program was built without libapriltag; lamps instead'
    detector=markers
fi
rig=$dir/rig.ini
world=$dir/world
# Where a thing is, by its direction: pan = atan2(x, y), tilt = atan2(z, hypot(x, y)).
show() { # [ID X Y Z]...: replaces all that there is to see
    : >"$world.new"
    while [ $# -gt 0 ]; do
        echo "{\"id\": $1, \"dir\": [$2, $3, $4]}" >>"$world.new"
        shift 4
    done
    mv "$world.new" "$world"
}
write_rig() { # DETECTOR [CAMERA-LINE...]
    # On a machine that is busy frames may be seconds apart: targets stay until they are told to have gone.
    sed "s/^detect.*/detect = $1\nrate_hz = 15/; s/^target_expiry_ms.*/target_expiry_ms = 0/" host-sim/rigs/camera.ini >"$rig.new"
    shift
    for line in "$@"; do
        sed -i "s|^\[camera\]|&\n$line|" "$rig.new"
    done
    mv "$rig.new" "$rig"
}
set_key() { # KEY VALUE: in [camera], where it stands already
    sed "s|^$1 = .*|$1 = $2|" "$rig" >"$rig.new" && mv "$rig.new" "$rig"
}
start() { # ARGUMENT...
    : >"$dir/out" >"$dir/err" # or what waits for words may find the last run's
    "$boresight" run "$rig" --json --state 0.05 --seconds 3000 "$@" >"$dir/out" 2>"$dir/err" &
    runner=$!
}
end() { # STATUS
    kill -INT $runner 2>/dev/null
    wait $runner
    status=$?
    grep '"build"' "$dir/out" >"$dir/summary"
    cp "$dir/summary" "$dir/out"
    [ "$status" -eq "$1" ]
}
says() { [ "$(grep -c -- "$1" "$dir/err")" -ge "${2:-1}" ]; }
state() { grep '^{"t_s"' "$dir/out" | tail -n 1; }
# looks_at PAN_DEG TILT_DEG: it tracks, and the joints are within 0.3 degree of that.
looks_at() {
    state | awk -v pan="$1" -v tilt="$2" '
        function value(name) { return match($0, "\"" name "\": [-0-9.]*") ? substr($0, RSTART + length(name) + 4, RLENGTH - length(name) - 4) + 0 : 1e9 }
        { good = /"mode": "tracking"/ && (value("pan_deg") - pan) ^ 2 + (value("tilt_deg") - tilt) ^ 2 < 0.09 }
        END { exit !good }'
}
state_has() { state | grep -q -- "$1"; }
verdict_of() { # NAME STATUS: with the end of the states
    tail -n 3 "$dir/out" >"$dir/tail"
    if [ "$2" -ne 0 ]; then sed 's/^/  state: /' "$dir/tail"; fi
    verdict "$1" "$2"
}

# ---------------------------------------------------------------- tags
write_rig $detector "device = fake:$world" 'right_deg = 0'
show 7 0.3 1 0.1 # 16.70, 5.47
start --arm --stay
until_true 30 looks_at 16.70 5.47
verdict_of 'a tag that the camera sees is followed' $?
show 7 0.1 1 0.2 # 5.71, 11.26
until_true 30 looks_at 5.71 11.26
verdict_of 'and again where it goes' $?
show 7 0.1 1 0.2 9 -0.1 1 0.2 # the middle of two: 0, 11.31
until_true 30 state_has '"targets": 2' && until_true 30 looks_at 0 11.31
verdict_of 'two tags: between them' $?
show 9 -0.1 1 0.2
until_true 30 state_has '"targets": 1' && until_true 30 looks_at -5.71 11.26
verdict_of 'one that has gone is no target any more' $?

# ---------------------------------------------------------------- the camera leaves
mv "$world" "$world.away"
until_true 30 says 'the simulated camera has left; put the file back' && until_true 30 state_has '"mode": "holding".*"targets": 0, "camera": false'
verdict_of 'a camera that leaves takes its targets with it, and the rig holds' $?
show 9 0 1 0.15 # 0, 8.53
until_true 30 says 'the camera is there again' && until_true 30 looks_at 0 8.53
verdict_of 'a camera that comes back is followed again, without anybody arming' $?

# ---------------------------------------------------------------- SIGHUP: only the camera changes
again() { # REGEX COUNT: SIGHUP, and then that is said so often
    kill -HUP $runner
    until_true 30 says "$1" "$2"
}
# A busy machine makes several ticks at once, so a mode may go by unseen: what matters is that it never came to rest.
armed_once() { ! says 'run: settling' 2 && ! says 'run: stopped' && ! says 'run: starting'; }
set_key fx_px 240
set_key fy_px 240
again 'read again: only the camera changes' 1 && until_true 30 says 'the camera is there again' 2 && until_true 30 looks_at 0 8.53 && armed_once
verdict_of 'other intrinsics: the camera is opened anew, and the drives go on' $?
set_key width_px 256
set_key height_px 192
set_key cx_px 127.5
set_key cy_px 95.5
set_key fx_px 220
set_key fy_px 220
again 'read again: only the camera changes' 2 && until_true 30 says 'the camera is there again' 3 &&
    show 9 0.05 1 0.1 && until_true 30 looks_at 2.86 5.70 && armed_once
verdict_of 'another size: the camera is opened anew, and the drives go on' $?
set_key right_deg 3 # it now sits otherwise, as far as the program knows: what it sees is where it was, 3 degrees to the right
again 'read again: only the camera changes' 3 && until_true 30 says 'the camera is there again' 4 && until_true 30 looks_at 2.86 5.70 && armed_once
verdict_of 'another seat' $?
cp "$rig" "$dir/kept.ini"
echo 'nonsense' >>"$rig"
again 'is not used: the rig stays as it was' 1 && says "^$rig:[0-9]*: 'nonsense' is neither" && show 9 -0.05 1 0.1 && until_true 30 looks_at -2.86 5.70 && armed_once
verdict_of 'a file that can not be read is told, and nothing changes' $?
sed 's|^device = fake:.*|device = fake:|' "$dir/kept.ini" >"$rig"
again 'is not used: the rig stays as it was' 2 && says "key 'device': is 'fake:'; a simulated camera is fake:FILE" && armed_once
verdict_of 'nor a camera that can not be' $?
sed '/^device = fake:/d' "$dir/kept.ini" >"$rig"
again 'read again: only the camera changes' 4 && until_true 30 state_has '"mode": "holding".*"targets": 0}' && armed_once
verdict_of 'a camera that is taken out of the file: the rig holds' $?
sed "s|^device = fake:.*|device = fake:$dir/elsewhere|" "$dir/kept.ini" >"$rig"
again 'read again: only the camera changes' 5 && until_true 30 says 'elsewhere: no such file for the simulated camera; write into it' && armed_once
verdict_of 'a camera that is not there is told, and the rig holds' $?
cp "$world" "$dir/elsewhere"
until_true 30 says 'elsewhere: the camera is there again' && until_true 30 looks_at -2.86 5.70 && armed_once
verdict_of 'until it is' $?
cp "$dir/kept.ini" "$rig"
sed -i 's/^speed_max_dps = 90/speed_max_dps = 45/' "$rig"
again 'rig.ini is read again$' 1 && says 'run: stopped' && until_true 30 looks_at -2.86 5.70
verdict_of 'where more than the camera changes all begins anew' $?
end 0
has_end=$?
facts && [ "$(fact reloads)" -eq 6 ] && [ $has_end -eq 0 ]
verdict 'the run ends well, and counts what it has read' $?

# ---------------------------------------------------------------- lamps, and other targets besides
write_rig markers "device = fake:$world" 'pixels = yuyv'
show 1 0.2 1 0.05 # 11.31, 2.81
mkfifo "$dir/targets"
start --arm --targets "$dir/targets"
exec 3>"$dir/targets"
until_true 30 looks_at 11.31 2.81
verdict_of 'a lamp in frames of another format is followed' $?
trap '' PIPE
echo '{"id": 5, "dir": [0, 1, 0.05]}' >&3 # the lamp's own width counts: half of 11.31 + 1.1
until_true 30 state_has '"targets": 2' && until_true 30 looks_at 6.2 2.85
verdict_of 'besides the targets of a stream' $?
mv "$world" "$world.away"
wait $runner
status=$?
exec 3>&-
[ $status -eq 4 ] && says 'the simulated camera has left'
verdict 'without --stay a camera that leaves is status 4' $?
start --arm
wait $runner
status=$?
[ $status -eq 4 ] && [ ! -s "$dir/out" ] && says 'no such file for the simulated camera'
verdict 'one that is not there is status 4, and nothing moves' $?
for wrong in 'fake' 'fake:' 'fake:x@' 'fake:x@-1' 'fake:x@1001' 'fake:x@5ms'; do
    write_rig markers "device = $wrong"
    run config check "$rig"
    [ $status -eq 2 ] && grep -q "key 'device': is '$wrong'; a simulated camera is fake:FILE or fake:FILE@MS" "$dir/err"
    verdict "'$wrong' is no camera" $?
done
run run "$rig" --state 0
[ $status -eq 2 ] && grep -q -- '--state' "$dir/err"
verdict 'states come at a rate' $?
finish
