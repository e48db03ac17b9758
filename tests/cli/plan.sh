#!/bin/sh
# `boresight plan`: fields, ranking, proposals, and what is bad input. tests/cli/plan.c moves the mounts, tests/property/viewpoint.c
# compares with rational numbers.
. tests/cli/support/check.sh

printf 'a 0 0 0\nb 2 0 0\nc 0 2 0\n' >"$dir/targets"
printf 'front 1 1 3\nflat 5 0 0\ninside 1 1 0\nat 0 2 0\nlow 1 1 0.5\n' >"$dir/mounts"
run plan --named --mounts "$dir/mounts" --json "$dir/targets"
has 'three targets, five mounts: the order and who is usable' 0 'targets=3' 'mounts=5' 'proposed=false' 'exact=true' \
    'ranking[1].mount=4' 'ranking[1].name="low"' 'ranking[1].usable=true' 'ranking[1].plane_cm=50.000000' \
    'ranking[0].mount=0' 'ranking[0].at[2]=3' 'ranking[0].plane[0]=0' 'ranking[0].plane[2]=2' 'ranking[0].plane_cm=300.000000' \
    'ranking[0].plane_at[0]=1' 'ranking[0].plane_at[2]=0' 'ranking[0].lines_through=0' 'ranking[0].line[0]=1' 'ranking[0].line[1]=2' \
    'ranking[0].line_cm=300.000000' 'ranking[0].margin_cm=300.000000' 'ranking[0].margin_px=360.000' 'ranking[1].margin_px=360.000' \
    'ranking[2].mount=1' 'ranking[2].usable=true' 'ranking[2].lines_through=1' 'ranking[2].planes_through=1' 'ranking[2].line[1]=1' \
    'ranking[2].margin_cm=0.000000' 'ranking[2].margin_px=0.000' 'ranking[2].lined_up=1' 'ranking[2].lined_up_first[2]=2' 'ranking[2].lined_up_normal[0]=0' 'ranking[0].lined_up=0' \
    'ranking[3].usable=false' 'ranking[3].feasible=false' 'ranking[3].why_not="no direction sees all targets"' 'ranking[3].witness[0]=1' \
    'ranking[4].why_not="at a target"' 'ranking[4].target[0]=2'
printf 'far 9 1 8\nnear 1 1 2\n' >"$dir/two"
run plan --named --mounts "$dir/two" --json "$dir/targets"
has 'by the picture: the near mount is first' 0 'ranking[0].name="near"' 'ranking[1].name="far"'
run plan --named --mounts "$dir/two" --rank cm --json "$dir/targets"
has 'by the place: the farther mount is first' 0 'ranking[0].name="far"' 'ranking[0].margin_cm=800.000000' 'ranking[1].name="near"'
run plan --named --mounts "$dir/mounts" --lines --unit-cm 1 --json "$dir/targets"
has 'lines only, in centimetres' 0 'ranking[0].name="front"' 'ranking[1].line_cm=0.500000' 'ranking[0].margin_cm=3.000000'
[ "$(grep -c plane "$dir/facts")" -eq 0 ]
verdict 'no planes with --lines' $?

# From above the middle of a square its corners stand on the cone, 360 pixels from the middle.
printf '1 1 3\n' >"$dir/mounts"
run plan --mounts "$dir/mounts" --json <"$dir/none"
ends 'no targets' 2 'stdin: no points'
printf '0 0 0\n2 0 0\n0 2 0\n2 2 0\n1 1 0\n' >"$dir/square"
run plan --mounts "$dir/mounts" --json "$dir/square"
has 'a square from above its middle' 0 'collinear_triples=2' 'ranking[0].lined_up=2' 'collinear[0]=0' 'collinear[1]=3' 'collinear[2]=4' 'ranking[0].tilt_deg=-90.000000000' \
    'ranking[0].pair_px=360.000' 'ranking[0].triple_px=254.558' 'ranking[0].margin_px=254.558'

# A rig that looks south, 175 degrees to each side, 30 down to 95 up, 2.4 to 24 mm on 4.8 x 3.6 mm with 12 percent to spare.
cat >"$dir/targets" <<'END'
-1 0 0
1 0 0
0 0.5 1
END
cat >"$dir/mounts" <<'END'
0.2 9 0.4
0.2 -9 0.4
0.2 3 9
0.1 1.4 0.6
0.1 1.2 0.6
0.2 90 0.4
END
run plan --rig host-sim/rigs/studio.ini --mounts "$dir/mounts" --size 1920x1440 --json "$dir/targets"
facts
sed -n 's/^ranking\[\([0-9]*\)\]\.mount=/\1 /p' "$dir/facts" | sort -k2n >"$dir/ranks"
of() { fact "ranking[$(awk -v m="$1" '$2 == m { print $1 }' "$dir/ranks")].$2"; } # MOUNT FIELD
[ "$(of 0 usable)$(of 0 zoom)" = 'true"fits"' ] && [ "$(of 1 why_not)" = "\"out of the rig's reach\"" ] && [ "$(of 1 reachable)" = false ] &&
    [ "$(of 2 reachable)" = false ] && [ "$(of 3 usable)$(of 3 zoom)" = 'true"no margin"' ] && [ "$(of 4 why_not)" = '"wider than the lens"' ] &&
    [ "$(of 5 usable)$(of 5 zoom)" = 'true"small"' ] && [ "$(of 5 focal_mm)" = 24 ] && [ "$(of 3 focal_mm)" = 2.4 ]
verdict "a rig's reach and lens" $?
awk -v f="$(of 0 focal_mm)" -v h="$(of 0 half_angle_deg)" 'BEGIN { h *= 0.017453292519943295; exit !(f * sin(h) / cos(h) * 1.12 - 1.8 < 0.001 && f * sin(h) / cos(h) * 1.12 - 1.8 > -0.001) }'
verdict 'the focal length fits the cone and its margin' $?

# From far away the picture is a parallel projection: the sphere's tolerance is that of the best direction, which other code finds.
printf '0 0 0\n10 0 0\n0 20 0\n3 2 15\n10 12 4\n' >"$dir/five"
for problem in points3-line points3-plane; do
    lines=
    [ $problem = points3-plane ] || lines=--lines
    "$boresight" regular $problem optimize "$dir/five" >"$dir/best"
    awk '$1 == "direction" { s = 5000 / sqrt($2 * $2 + $3 * $3 + $4 * $4); printf "%.3f %.3f %.3f\n", $2 * s, $3 * s, $4 * s }' "$dir/best" >"$dir/far"
    run plan $lines --mounts "$dir/far" --json "$dir/five"
    facts
    awk -v got="$(fact tolerance_deg)" '$1 == "tolerance_rad" { d = got - $2 * 57.29577951308232; exit !(got > 20 && d > -0.3 && d < 0.3) }' "$dir/best"
    verdict "seen from far away: the tolerance of regular $problem" $?
done

# Proposals: as many as asked for, apart, the best first, none below, and what is printed can be given back.
awk 'function random() { state = state * 16807 % 2147483647; return state / 2147483647 }
    BEGIN { state = 5; for (i = 0; i < 12; i++) { x = 6 * random(); y = 4 * random(); printf "%.2f %.2f %.2f\n", x, y, 1 + 2 * random() } }' >"$dir/stage"
run plan --count 4 --distance 12 --above 2.5 --picture "$dir/sphere.svg" --json "$dir/stage"
has 'proposals' 0 'mounts=4' 'proposed=true' 'exact=true' 'ranking[3].usable=true'
cp "$dir/facts" "$dir/proposed"
sed -n 's/^ranking\[[0-9]*\]\.at\[\([0-9]\)\]=\(.*\)/\1 \2/p' "$dir/facts" | awk '{ printf "%s%s", $2, $1 == 2 ? "\n" : " " }' >"$dir/places"
awk '$3 < 2.5 { low = 1 } { x[NR] = $1 - 3; y[NR] = $2 - 2; z[NR] = $3 - 2 } END {
    for (i = 1; i <= NR; i++) for (j = 1; j < i; j++) if ((x[i] - x[j]) ^ 2 + (y[i] - y[j]) ^ 2 + (z[i] - z[j]) ^ 2 < 6) near = 1
    exit low || near || NR != 4 }' "$dir/places"
verdict 'they are apart, and not below' $?
run plan --mounts "$dir/places" --json "$dir/stage"
facts
grep -v proposed= "$dir/proposed" >"$dir/wanted"
grep -v proposed= "$dir/facts" | cmp -s - "$dir/wanted"
verdict 'proposals given back as mounts: the same results' $?
awk -F= '/margin_px/ { if (NR > 1 && last != "" && $2 > last) exit 1; last = $2 }' "$dir/facts"
verdict 'the best first' $?
# No direction in a coarse search of the same sphere is better than the first one.
awk -v PI=3.141592653589793 'BEGIN { for (t = 15; t < 90; t += 15) for (p = 0; p < 360; p += 15)
    printf "%.3f %.3f %.3f\n", 3 + 12 * cos(t * PI / 180) * cos(p * PI / 180), 2 + 12 * cos(t * PI / 180) * sin(p * PI / 180), 2 + 12 * sin(t * PI / 180) }' >"$dir/grid"
best=$(fact 'ranking[0].margin_px')
run plan --mounts "$dir/grid" --json "$dir/stage"
facts
awk -v a="$best" -v b="$(fact 'ranking[0].margin_px')" 'BEGIN { exit !(a >= b) }'
verdict "no place of a coarse search is better than the first proposal" $?
grep -q '<title>proposed, at ' "$dir/sphere.svg" && grep -q 'class="disc"' "$dir/sphere.svg" && grep -q '>132 forbidden points, 220 circles; tolerance ' "$dir/sphere.svg"
verdict 'the picture' $?
run plan --rig host-sim/rigs/watch.ini --above 50 --json "$dir/stage"
[ "$status" -eq 3 ] && facts && [ "$(fact mounts)" = 0 ] && [ "$(fact ranking)" = '[]' ]
verdict 'nowhere to mount: exit status 3' $?

run plan --mounts "$dir/places" "$dir/stage"
grep -qx 'rank              1' "$dir/out" && grep -q '^margin_cm  *[0-9.]*$' "$dir/out" && [ "$status" -eq 0 ]
verdict 'as text' $?
printf '0 0 0\n' >"$dir/one"
run plan --json "$dir/one"
has 'one target: nothing is forbidden' 0 'targets=1' 'ranking[0].margin_cm=null' 'ranking[0].margin_px=null'
printf '0.1234567891 0 0\n5 1 1\n2 2 2\n' >"$dir/input"
run plan --count 1 --json "$dir/input"
has 'more digits than the grid: said so' 0 'exact=false'
printf '1e200 0 0\n5e200 1e200 1\n2 2e200 2\n' >"$dir/input"
run plan --count 1 --json "$dir/input"
ends 'coordinates out of range' 2 'boresight plan: coordinates beyond 10^90, or none above 10^-90'
printf '1e60 0 0\n5e60 1e60 1\n2 2e60 2\n' >"$dir/input"
run plan --count 1 --json "$dir/input"
has 'any unit' 0 'targets=3' 'ranking[0].usable=true'

# A crate between the mount and one target, and a wall with a lamp on it.
cat >"$dir/stage.scene" <<'END'
o crate
v 1 4 0
v 2 4 0
v 2 5 0
v 1 5 0
v 1 4 2
v 2 4 2
v 2 5 2
v 1 5 2
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
o wall
v -5 9 0
v 5 9 0
v 5 9 4
v -5 9 4
f -4 -3 -2 -1
o wire
v 0 2 0
v 0 2 4
l -2 -1
END
printf 'behind 1.5 8 1\nlamp -3 9 2\nfree 0 6 1\n' >"$dir/input"
printf 'front 1.6 0 1\nhigh 1.6 0 6\nbeyond 0 12 1\n' >"$dir/two"
run plan --named --scene "$dir/stage.scene" --mounts "$dir/two" --json "$dir/input"
has 'a scene: what is hidden, and by what' 0 'ranking[0].name="high"' 'ranking[0].usable=true' 'ranking[0].hidden=[]' 'ranking[1].usable=false' \
    'ranking[1].why_not="targets are hidden"'
facts
front=$(sed -n 's/^ranking\[\(.\)\].name="front"$/\1/p' "$dir/facts")
beyond=$(sed -n 's/^ranking\[\(.\)\].name="beyond"$/\1/p' "$dir/facts")
[ "$(fact "ranking[$front].hidden[0]")" = 0 ] && [ "$(fact "ranking[$front].hidden[1]")" = '' ] && [ "$(fact "ranking[$front].hidden_by")" = '"crate"' ] &&
    [ "$(fact "ranking[$beyond].hidden[0]")" = 0 ] && [ "$(fact "ranking[$beyond].hidden[1]")" = 2 ] && [ "$(fact "ranking[$beyond].hidden_by")" = '"wall"' ]
verdict 'the crate hides what is behind it, the wall all but the lamp on it' $?
run plan --named --scene "$dir/stage.scene" --distance 12 --json "$dir/input"
has 'proposals see past the scene' 0 'ranking[0].usable=true' 'ranking[0].hidden=[]' 'ranking[4].hidden=[]'
echo 'v 1 2' >"$dir/bad.scene"
run plan --named --scene "$dir/bad.scene" "$dir/input"
ends 'a bad scene' 2 "$dir/bad.scene:1: a vertex has three coordinates"

# ---------------------------------------------------------------- bad input
printf '1 2 3\n\n# the same\n1 2 3.0\n' >"$dir/input"
run plan "$dir/input"
ends 'two targets at one place' 2 "$dir/input:4: the same place as in line 1"
run plan --mounts "$dir/none" "$dir/stage"
ends 'no mounts' 2 "$dir/none: no mounts"
awk 'BEGIN { for (i = 0; i < 2001; i++) print i, i * i % 211, i * i * i % 197 }' >"$dir/input"
run plan "$dir/input"
ends 'too many targets' 2 "$dir/input: 2001 targets; at most 2000"
head -n 201 "$dir/input" >"$dir/some"
printf '9 7 400\n' >"$dir/over"
wanted=$(awk '{ x[NR] = $1 - 9; y[NR] = $2 - 7; z[NR] = $3 - 400 } END {
    for (i = 1; i <= NR; i++) for (j = 1; j < i; j++) {
        a = y[i] * z[j] - z[i] * y[j]; b = z[i] * x[j] - x[i] * z[j]; c = x[i] * y[j] - y[i] * x[j]
        for (k = 1; k < j; k++) if (a * x[k] + b * y[k] + c * z[k] == 0) n++
    }
    print n + 0 }' "$dir/some")
run plan --mounts "$dir/over" --json "$dir/some"
has 'many targets: no planes, but what lines up' 0 'targets=201' "ranking[0].lined_up=$wanted"
[ "$(grep -c plane "$dir/facts")" -eq 0 ]
verdict 'no planes beyond 200 targets' $?
run plan --mounts "$dir/places" --count 3 "$dir/stage"
ends 'mounts and proposals' 2 'boresight plan: --mounts goes without --count, --distance and --above'
run plan --size 640 "$dir/stage"
ends 'a size' 2 "boresight plan: --size '640': must be WxH, each from 16 to 32768"
run plan --distance -3 "$dir/stage"
ends 'a distance' 2 "boresight plan: --distance '-3': must be a number above 0, at most 4000000"
run plan --above high "$dir/stage"
ends 'a height' 2 "boresight plan: --above 'high': must be a number"
run plan --count 101 "$dir/stage"
ends 'a count' 2 'boresight plan: --count: at most 100'
printf '1 2\n' >"$dir/input"
run plan --mounts "$dir/input" "$dir/stage"
ends 'a short line of mounts' 2 "$dir/input:1: 2 columns, not 3 (x y z)"
run plan --rig "$dir/nothing" "$dir/stage"
[ "$status" -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ]
verdict 'no rig file' $?
run plan --picture "$dir/no/where.svg" "$dir/stage"
ends 'a picture that can not be written' 1 "$dir/no/where.svg: can't be written: No such file or directory"
finish
