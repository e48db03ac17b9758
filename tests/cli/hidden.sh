#!/bin/sh
# `boresight run` with a scene whose solids hide targets: from the rig file, from --scene, and what is bad input.
# tests/scenario/test_run_hidden.c has how the aim moves. Simulated drives: what counts is simulated time, however busy the machine is.
. tests/cli/support/check.sh

# Ann stands in sight at -16.699 degrees, Bob behind the wall at 21.801.
printf '%s\n' 'o wall' 'v 2 15 -3' 'v 32 15 -3' 'v 32 15.5 -3' 'v 2 15.5 -3' 'v 2 15 3' 'v 32 15 3' 'v 32 15.5 3' 'v 2 15.5 3' \
    'f 4 3 2 1' 'f 5 6 7 8' 'f 1 2 6 5' 'f 3 4 8 7' 'f 4 1 5 8' 'f 2 3 7 6' >"$dir/wall.scene"
printf '{"id": 1, "xyz": [-6, 20, 0]}\n{"id": 2, "xyz": [8, 20, 0]}\n' >"$dir/two.jsonl"
rig() { # FILE [LINE...]   a rig with an [occlusion] section of these lines
    file=$1
    shift
    { cat host-sim/rigs/moving.ini; echo; echo '[occlusion]'; [ $# -eq 0 ] || printf '%s\n' "$@"; } >"$dir/$file"
}
ends_at() { # NAME DEGREES ARGUMENT...
    name=$1
    deg=$2
    shift 2
    run run --arm --seconds 4 --targets "$dir/two.jsonl" --json "$@"
    [ "$status" -eq 0 ] && grep -q '"violations": 0' "$dir/out" &&
        sed 's/.*"pan_deg": \([-0-9.]*\).*/\1/' "$dir/out" | awk -v want="$deg" '{ off = $1 - want; if (off < 0) off = -off; exit !(off < 0.1) }'
    verdict "$name" $?
}
rig drop.ini 'policy = drop' 'scene = wall.scene'
ends_at 'the scene of the rig file hides a target' -16.699 "$dir/drop.ini"
grep -q '"hidden_percent": [1-9]' "$dir/out"
verdict 'the summary tells how much was hidden' $?
rig calm.ini 'policy = calm' 'scene = wall.scene'
ends_at 'calm: it leaves' -16.699 "$dir/calm.ini"
# A quarter of the way from Ann to Bob, on the ground: x = -6 + 14 / 4, so 7.125 degrees left; the middle of both.
rig weigh.ini 'policy = weigh' 'hidden_percent = 25' 'scene = wall.scene'
ends_at 'weigh: it counts a quarter' -11.912 "$dir/weigh.ini"
rig ignore.ini 'policy = ignore' 'scene = wall.scene'
ends_at 'ignore: it counts' 2.551 "$dir/ignore.ini"
rig none.ini 'policy = drop'
ends_at 'without a scene nothing is hidden' 2.551 "$dir/none.ini"
ends_at '--scene gives one' -16.699 "$dir/none.ini" --scene "$dir/wall.scene"
printf 'o far\nv 100 100 0\nv 101 100 0\nv 101 100 1\nf 1 2 3\n' >"$dir/other.scene"
ends_at '--scene takes the place of the scene in the rig file' 2.551 "$dir/drop.ini" --scene "$dir/other.scene"
printf '[scenario]\nname = x\nrig = drop.ini\nseconds = 4\n[targets]\nfile = two.jsonl\n' >"$dir/same.ini"
run sim "$dir/same.ini" --json
grep -q '"hidden_percent": 50' "$dir/out" && [ "$status" -eq 0 ]
verdict 'sim: the scene of the rig, if the scenario has none' $?

rig bad.ini 'policy = nervous'
line=$(grep -n '^policy' "$dir/bad.ini" | cut -d: -f1)
refuse 'an unknown policy' "bad.ini:$line: key 'policy'" config check "$dir/bad.ini"
rig bad.ini 'hidden_percent = 101'
refuse 'more than all of it' "bad.ini:$line: key 'hidden_percent'" run "$dir/bad.ini"
rig bad.ini 'ahead_s = 0.5'
refuse 'a fade beyond the forecast' "bad.ini:$line: key 'ahead_s'" run "$dir/bad.ini"
rig bad.ini 'scene = nowhere.scene'
refuse 'a scene that is not there' 'nowhere.scene' run "$dir/bad.ini"
sed 's/v 32 15.5 3/v 32 15.5 nan/' "$dir/wall.scene" >"$dir/nan.scene"
refuse 'a scene with NaN' "$dir/nan.scene:8: " run "$dir/none.ini" --scene "$dir/nan.scene"
sed 's/v 32 15.5 3/v 32 17 3/' "$dir/wall.scene" >"$dir/bent.scene"
refuse 'a face that is not planar' "$dir/bent.scene:" run "$dir/none.ini" --scene "$dir/bent.scene"
sed 's/^v 100/v 1e30/' "$dir/other.scene" >"$dir/huge.scene"
refuse 'a scene that is too large' "$dir/huge.scene" run "$dir/none.ini" --scene "$dir/huge.scene"
# A reload with a scene that can't be used changes nothing.
cp "$dir/wall.scene" "$dir/now.scene"
rig now.ini 'policy = drop' 'scene = now.scene'
"$boresight" run "$dir/now.ini" --arm --targets "$dir/two.jsonl" --json >"$dir/out" 2>"$dir/err" &
until_true 30 grep -q tracking "$dir/err"
cp "$dir/bent.scene" "$dir/now.scene"
kill -HUP $!
until_true 30 grep -q 'is not used: the rig stays as it was' "$dir/err"
kill -INT $!
wait $!
[ $? -eq 0 ] && grep -q "now.scene:.*not planar" "$dir/err" && grep -q '"reloads": 0' "$dir/out" && grep -q '"mode": "stopped"' "$dir/out"
verdict 'a reload with a scene that is wrong changes nothing' $?
run config check "$dir/none.ini"
[ "$status" -eq 0 ] && grep -q 'hidden nothing here: no scene' "$dir/out"
verdict 'config check says that nothing is hidden without a scene' $?
finish
