#!/bin/sh
# `regular`: its fields, forms, readers and refusals. tests/property/regular_*.c have the geometry.
. tests/cli/support/check.sh

printf '0 0\n1 1  # a comment\n\n0,2\n' >"$dir/plane.txt"
run regular points2-line decide --json "$dir/plane.txt"
printf '{"regular": false, "conflict": [0, 2]}\n' | cmp -s - "$dir/out" && [ "$status" -eq 0 ]
verdict 'decide names the conflict and ends well' $?
run regular points2-line compute --json "$dir/plane.txt"
printf '{"regular": true, "direction": [1, 3]}\n' | cmp -s - "$dir/out" && [ "$status" -eq 0 ]
verdict 'compute gives a direction' $?
# The lines are at 45, 90 and 135 degrees: a gap of a quarter turn about the x axis.
run regular points2-line optimize --json "$dir/plane.txt"
printf '{"regular": true, "direction": [1, 0], "tolerance_rad": 0.785398163397448222}\n' | cmp -s - "$dir/out"
verdict 'optimize gives a tolerance, rounded down' $?
run regular points2-line optimize "$dir/plane.txt"
printf '%s\n' 'regular           yes' 'direction         1 0' 'tolerance_rad     0.785398163397448222' | cmp -s - "$dir/out"
verdict 'the same as text' $?
for option in '' --buckets; do
    run regular points2-line decide $option --json <"$dir/plane.txt"
    has "stdin $option" 0 'regular=false' 'conflict[1]=2'
done
# Point 1 weighs 3, so its lines keep three times as far as the vertical one.
printf '0 0 1\n1 1 3\n0 2 1\n' >"$dir/weights.txt"
run regular points2-line optimize --weighted --json "$dir/weights.txt"
has 'weights' 0 'regular=true' 'direction[1]=0' 'direction[0]=1'

printf '0 0 0\n1 1 1\n2 2 2\n5 6 8\n' >"$dir/line.txt"
for step in compute optimize; do
    run regular points3-plane $step --json "$dir/line.txt"
    printf '{"regular": false, "conflict": [0, 1, 2]}\n' | cmp -s - "$dir/out" && [ "$status" -eq 3 ] && [ ! -s "$dir/err" ]
    verdict "$step: three points on one line" $?
done
printf '0 0 0 1 1 1\n0 0 1 1 2 3\n3 3 3 2 2 2\n' >"$dir/segments.txt"
run regular segments3-plane compute --json "$dir/segments.txt"
printf '{"regular": false, "conflict": [0, 2]}\n' | cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'compute: two segments on one line' $?
run regular points3-xyz compute --json "$dir/line.txt"
printf '{"regular": true, "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}\n' | cmp -s - "$dir/out"
verdict 'axes' $?
run regular points3-xyz optimize --json "$dir/line.txt"
has 'a bound is called so' 0 'regular=true' 'tolerance_is_bound=true'
printf '0 0 0\n1 0 0\n0 1 0\n1 1 0\n' >"$dir/square.txt"
run regular points3-cocircular decide --json "$dir/square.txt"
has 'a square is on a circle' 0 'regular=false' 'conflict[0]=0' 'conflict[3]=3'
run regular points3-cocircular compute "$dir/square.txt"
ends 'seen from elsewhere it is not' 0
run regular points3-cocircular optimize "$dir/square.txt"
ends 'an open problem' 2 'boresight regular: points3-cocircular has no optimize: it is an open problem'
for problem in points3-line points3-x points3-xy points3-plane points3-cocircular segments3-plane faces-vertical; do
    run regular $problem compute --json </dev/null
    has "$problem of nothing" 0 'regular=true'
done

# ---------------------------------------------------------------- OBJ
cat >"$dir/cube.obj" <<'E'
# a cube of side 0.5
o cube
v 0 0 0
v 0.5 0 0
v 0.5 0.5 0
v 0 0.5 0
v 0 0 0.5
v 0.5 0 0.5
v 0.5 0.5 0.5
v 0 0.5 0.5
f 1 2 3 4
f 5/1 6/2 7/3 8/4
f 1 2 6 5
f 3 4 8 7
f -8 -5 -1 -4
f 2 3 7 6
E
run regular faces-vertical optimize --json "$dir/cube.obj"
# The diagonal: asin(1/sqrt(3)) from each face.
has 'the faces of a cube' 0 'tolerance_rad=0.615479708670387253'
run regular faces-vertical optimize --cylinder --json "$dir/cube.obj"
has 'the same by cylinder' 0 'tolerance_rad=0.615479708670387253'
run regular faces-vertical optimize --above --json "$dir/cube.obj"
has 'nothing is above a vertical face' 3 'regular=false' 'conflict[0]=2'
run regular segments3-vertical decide --json "$dir/cube.obj"
has 'the sides of a cube, each once' 0 'regular=false' 'conflict[0]=8'
run regular segments3-plane optimize --json "$dir/cube.obj"
has 'a wire frame' 0 'regular=true'
run regular points2-line decide "$dir/cube.obj"
ends 'an OBJ in the plane' 2 'boresight regular: an OBJ has three coordinates a point, the problem two'
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3 4\n' >"$dir/bent.obj"
run regular faces-vertical decide "$dir/bent.obj"
ends 'a bent face' 2 "$dir/bent.obj:5: the corners of the face are not in one plane"
printf 'v 0 0 0\nv 0.0000001 0 0\nv 1 1 0\nf 1 2 3\n' >"$dir/fine.obj"
run regular faces-vertical decide "$dir/fine.obj"
ends 'too fine' 2 "$dir/fine.obj:3: in units of 1e-7, which all coordinates are whole multiples of, one is beyond 1048576"
printf 'v 0 0 0\nf 1 2 3\n' >"$dir/short.obj"
run regular faces-vertical decide "$dir/short.obj"
ends 'no such vertex' 2 "$dir/short.obj:2: '2': there is no such vertex above"

# ---------------------------------------------------------------- bad input
bad() { # NAME PROBLEM TEXT MESSAGE
    printf "$3" >"$dir/bad.txt"
    run regular "$2" decide "$dir/bad.txt"
    ends "$1" 2 "$dir/bad.txt:$4"
}
bad 'a repeated point' points3-line '1 2 3\n4 5 6\n1 2 3\n' '3: the same point as in line 1'
bad 'a coordinate out of range' points3-x '1 2 1048577\n' "1: '1048577' is beyond 1048576"
bad 'a fraction' points3-x '1 2 1.5\n' "1: '1.5' is not a whole number"
bad 'a word' points3-x '1 2 x\n' "1: 'x' is not a number"
bad 'too few columns' faces-vertical '1 2 3\n' '1: 3 columns, not 9 (3 points of 3 coordinates)'
bad 'a segment without length' segments2-vertical '1 2 3 4\n5 6 5 6\n' '2: the segment has no length'
bad 'a face without area' faces-vertical '0 0 0 1 1 1 2 2 2\n' '1: the points of the face are on one line'
printf '1 2 0\n' >"$dir/bad.txt"
run regular points2-line optimize --weighted "$dir/bad.txt"
ends 'no weight' 2 "$dir/bad.txt:1: a weight is at least 1"
awk 'BEGIN { for (i = 0; i < 33; i++) print i, i * i, i * i * i }' >"$dir/many.txt"
run regular points3-plane optimize "$dir/many.txt"
ends 'too many' 2 'boresight regular: 33 items: points3-plane optimize takes at most 32'
run regular nosuch decide </dev/null
ends 'an unknown problem' 2 "boresight regular: no problem 'nosuch'; see 'boresight help regular'"
run regular points3-x </dev/null
ends 'no step' 2 "boresight regular: no step; see 'boresight help regular'"
run regular points3-x compute --weighted </dev/null
ends 'weights elsewhere' 2 'boresight regular: --weighted is for points2-line optimize'
finish
