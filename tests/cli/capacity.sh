#!/bin/sh
# More targets than the controller holds: what then is framed is not what was asked for, so it is told, with the number.
. tests/cli/support/check.sh

targets() { # COUNT
    awk -v count="$1" 'BEGIN { for (i = 1; i <= count; i++) printf "{\"id\": %d, \"xyz\": [%g, 10, 1]}\n", i, i / 100 }' >"$dir/targets.jsonl"
}
cat >"$dir/scenario.ini" <<END
[scenario]
name = Many
rig = $PWD/host-sim/rigs/studio.ini
seconds = 2
[targets]
file = targets.jsonl
format = jsonl
END
targets 256
run sim "$dir/scenario.ini" --quiet --json
has '256 targets fit' 0 'targets=256' 'violations=0'
targets 257
run sim "$dir/scenario.ini" --quiet
[ "$status" -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] &&
    grep -q '^boresight sim: at 0\.[0-9]* s more than 256 targets at a time: what does not fit is not framed$' "$dir/err"
verdict 'sim: one more does not, and the number is named' $?
run run host-sim/rigs/studio.ini --targets "$dir/targets.jsonl" --seconds 1
[ "$status" -eq 0 ] && [ "$(grep -c '^boresight run: more than 256 targets at a time: what does not fit is not framed$' "$dir/err")" -eq 1 ]
verdict 'run: the same, told once, and it goes on with those that fit' $?
targets 256
run run host-sim/rigs/studio.ini --targets "$dir/targets.jsonl" --seconds 1
[ "$status" -eq 0 ] && ! grep -q 'more than' "$dir/err"
verdict 'run: 256 fit' $?
finish
