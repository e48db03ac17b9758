#!/bin/sh
# `boresight scene measure`: what it counts in 720 views, against a count of faces by their planes and the other method's
# pictures. The counters of the pipeline's steps: tests/bench/levine, which makes the thesis' tables of them.
. tests/cli/support/check.sh

# x, y, z, r of the middle and the radius of boxes, as awk reads them from their lines.
extent='{ for (k = 0; k < 3; k++) {
        if (NR == 1 || $(2 + k) < low[k]) low[k] = $(2 + k)
        if (NR == 1 || $(2 + k) + $(5 + k) > high[k]) high[k] = $(2 + k) + $(5 + k)
        for (side = 0; side < 2; side++) { faces++; axis[faces] = k; at[faces] = $(2 + k) + side * $(5 + k); sign[faces] = 2 * side - 1 } } }
    function middle(k) { return (low[k] + high[k]) / 2 }
    function radius() { return sqrt((high[0] - low[0]) ^ 2 + (high[1] - low[1]) ^ 2 + (high[2] - low[2]) ^ 2) / 2 }
    function eye(turn, degrees, away,    s, c) {
        s = away * radius() * sin(degrees * atan2(0, -1) / 180); c = away * radius() * cos(degrees * atan2(0, -1) / 180)
        e[0] = middle(0) - (turn == "yaw" ? s : 0); e[1] = middle(1) - c; e[2] = middle(2) - (turn == "pitch" ? s : 0) }'
awk 'BEGIN { srand(16); for (i = 0; i < 16; i++) print "t" i, i % 4 * 3, int(i / 4) * 3, 0, 1 + rand(), 1 + rand(), 1 + 4 * rand() }' >"$dir/city.txt"
awk -f tests/cli/support/boxes.awk "$dir/city.txt" >"$dir/city.scene"
run scene measure "$dir/city.scene" --json
# The eye is off by a unit of the scene at most: faces that are seen that flat are not compared.
awk -v out="$dir/out" "$extent"'
    END { while ((getline line < out) > 0) {
            if (line !~ /"degrees"/) continue
            lines++; turn = line ~ /"yaw"/ ? "yaw" : "pitch"; match(line, /"degrees": ?[0-9]+/)
            degrees = substr(line, RSTART + 10, RLENGTH - 10) + 0
            match(line, /"front_faces": ?[0-9]+/); counted = substr(line, RSTART + 14, RLENGTH - 14) + 0
            if (degrees != (lines - 1) % 360 || turn != (lines <= 360 ? "yaw" : "pitch")) wrong++
            eye(turn, degrees, 1.25); front = flat = 0
            for (i = 1; i <= faces; i++) { d = sign[i] * (e[axis[i]] - at[i]); front += d > 0; flat += d * d < 1e-10 }
            wrong += !flat && front != counted; compared += !flat }
        if (wrong != 0 || lines != 720 || compared < 700) { print "  lines " lines ", wrong " wrong ", compared " compared; exit 1 } }' "$dir/city.txt" && [ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
verdict 'faces in front, every degree' $?
for view in 'yaw 17' 'yaw 123' 'yaw 290' 'pitch 33' 'pitch 101' 'pitch 222' 'pitch 340'; do
    set -- $view
    eye=$(awk -v turn="$1" -v degrees="$2" "$extent"' END { eye(turn, degrees, 1.25); printf "%.12g,%.12g,%.12g", e[0], e[1], e[2] }' "$dir/city.txt")
    middle=$(awk "$extent"' END { printf "%.12g,%.12g,%.12g", middle(0), middle(1), middle(2) }' "$dir/city.txt")
    run scene measure "$dir/city.scene" --json
    row=$(grep "\"$1\"" "$dir/out" | grep -E "\"degrees\": ?$2[,}]" | sed 's/.*"segments": *\([0-9]*\).*/\1/')
    run scene render "$dir/city.scene" --viewpoint="$eye" --aim="$middle" --fov 170 --size 4000x4000 -o "$dir/a.svg" --json
    has "as many segments as by shadows, $view" 0 "segments=$row"
done
run scene measure "$dir/city.scene"
awk '$1 == "yaw" || $1 == "pitch" { if ($2 == "mean") { for (k = 3; k <= NF; k++) { wrong += ($k - sum[k] / 360) ^ 2 > 0.0001; sum[k] = 0 } means++ }
        else for (k = 3; k <= NF; k++) sum[k] += $k }
    END { exit wrong != 0 || means != 2 || NR != 724 }' "$dir/out"
verdict 'as text: a table, and its means' $?
cp "$dir/out" "$dir/text"
run scene build "$dir/city.scene" -o "$dir/city.coca"
run scene measure "$dir/city.coca"
cmp -s "$dir/out" "$dir/text"
verdict 'a tree counts like its text' $?
run scene measure "$dir/city.scene" --distance 1e6
refused 'an eye too far away' 'distance'
run scene measure "$dir/city.scene" --distance -1
refused 'a distance that is none' 'distance'
printf 'left 0 0 0 10 10 10\nright 9 9 9 10 10 10\n' | awk -f tests/cli/support/boxes.awk >"$dir/overlap.scene"
run scene measure "$dir/overlap.scene"
refused 'solids that overlap' "overlap.scene:16: the object 'right' and the object 'left' of line 1 are not linearly separable"
run scene measure
refused 'no scene' 'needs a scene'
printf 'v 1 2 3\nv 4 5 6\n' >"$dir/points.scene"
run scene measure "$dir/points.scene" --json
[ "$status" -eq 0 ] && [ "$(grep -c '"edges": *0[.,]' "$dir/out")" -eq 722 ]
verdict 'nothing to draw' $?
finish
