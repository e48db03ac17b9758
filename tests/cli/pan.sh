#!/bin/sh
# `boresight pan`. The optimum is compared with a search of the sphere in tests/property/weigh_global.c.
. tests/cli/support/check.sh

# Two objects to the north and the east, each of two points.
printf 'a -1 10 0\na 1 10 0\nb 10 -1 0\nb 10 1 0\n' >"$dir/objects.txt"
run pan --from 1,0 --to 0,1 --steps 2 --json "$dir/objects.txt"
cat >"$dir/wanted" <<'JSON'
{"weights": [1, 0], "ahead_q30": [0, 1073741824, 0], "pan_deg": 0.000000000000, "tilt_deg": 0.000000000000}
{"weights": [0.5, 0.5], "ahead_q30": [759250125, 759250125, 0], "pan_deg": 45.000000000000, "tilt_deg": 0.000000000000}
{"weights": [0, 1], "ahead_q30": [1073741824, 0, 0], "pan_deg": 90.000000000000, "tilt_deg": 0.000000000000}
JSON
[ $status -eq 0 ] && cmp -s "$dir/out" "$dir/wanted"
verdict 'from one object to another' $?
run pan --from 1,0 --to 0,1 --steps 4 --cost angle2 --json "$dir/objects.txt"
sed 's/.*pan_deg": \([^,]*\).*/\1/' "$dir/out" | awk '{ e = $1 - 22.5 * (NR - 1); if (e > 1e-7 || e < -1e-7) bad = 1 } END { exit bad || NR != 5 }'
verdict 'at constant speed' $?
run pan --from 1,0 --to 0,1 "$dir/objects.txt"
[ $status -eq 0 ] && [ "$(grep -c '^weights  ' "$dir/out")" -eq 11 ] && [ "$(grep -c '^pan_deg  ' "$dir/out")" -eq 11 ]
verdict 'as text, in ten steps' $?
run pan --from 3,1 --to 3,1 --steps 0 --json "$dir/objects.txt"
[ "$(wc -l <"$dir/out")" -eq 1 ] && grep -q '"weights": \[3, 1\]' "$dir/out"
verdict 'no steps: one direction' $?

# No direction sees both objects, and none is needed.
printf 'a 1 0 0.1\nb -1 0 0.1\n' >"$dir/apart.txt"
run pan --from 1,0 --to 0,1 --steps 4 --json "$dir/apart.txt"
[ $status -eq 0 ] && [ "$(wc -l <"$dir/out")" -eq 5 ]
verdict 'objects that no picture holds together' $?
printf 'a 1 0 0\nb -1 0 0\n' >"$dir/opposite.txt"
run pan --from 1,0 --to 0,1 --steps 2 --json "$dir/opposite.txt"
[ "$(sed -n 2p "$dir/out" | grep -c '"ahead_q30": \[1073741824, 0, 0\]')" -eq 1 ]
verdict 'where the axes cancel the last direction is kept' $?
run pan --cost 1/cos --from 1,0 --to 0,1 --steps 2 --json "$dir/opposite.txt"
[ $status -eq 3 ] && [ "$(cat "$dir/out")" = '{"feasible": false, "weights": [0.5, 0.5]}' ]
verdict '1/cos needs a direction that sees all' $?

# An object that nothing holds is named.
printf 'a 0 1 0\nb 1 0 0\nb 0 1 0\nb -1 0 0\n' >"$dir/bad.txt"
run pan --from 1,0 --to 0,1 --json "$dir/bad.txt"
[ $status -eq 3 ] && [ "$(cat "$dir/out")" = '{"feasible": false, "object": "b", "witness": [1, 3]}' ]
verdict 'an object without an orientation is named' $?

run pan --from 1,0 "$dir/objects.txt"
ends 'no --to' 2 'boresight pan: --to W1,W2,... is missing'
run pan --from 1,0,0 --to 0,1 "$dir/objects.txt"
ends 'too many weights' 2 "boresight pan: --from '1,0,0': 3 weights for 2 objects"
run pan --from 0,0 --to 0,1 "$dir/objects.txt"
ends 'no weight at all' 2 'boresight pan: --from: at least one weight must be above 0'
for weights in 1,-1 1,x 1, ,1 nan,1 1e99,1; do
    run pan --from "$weights" --to 0,1 "$dir/objects.txt"
    ends "no weights: $weights" 2 "boresight pan: --from '$weights': weights are numbers from 0 to 1000000, apart by commas"
done
run pan --from 1 --to 1 "$dir/none"
ends 'no objects' 2 'boresight pan: there are no objects'
run pan --from 1,0 --to 0,1 --steps 1000001 "$dir/objects.txt"
ends 'too many steps' 2 'boresight pan: --steps: at most 1000000'
awk 'BEGIN { for (i = 0; i < 257; i++) print "o" i, 1, i / 100, 1 }' >"$dir/many.txt"
run pan --from 1 --to 1 "$dir/many.txt"
ends 'too many objects' 2 'boresight pan: more than 256 objects'
printf 'a 1 2\n' >"$dir/short.txt"
run pan --from 1 --to 1 "$dir/short.txt"
ends 'a line without a name' 2 "$dir/short.txt:1: 3 columns, not 4 (name x y z)"
finish
