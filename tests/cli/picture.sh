#!/bin/sh
# What `aim` tells about the picture: --project, --segments, --bounds box, --frame rect. The optimum of a rectangle is compared
# with a search of all directions in tests/property/rect_global.c.
. tests/cli/support/check.sh

# Four corners round +y: x = +-1, z = +-1 at distance 10, and one in the middle.
printf '1 10 1\n-1 10 1\n-1 10 -1\n1 10 -1\n0 5 0\n' >"$dir/points.txt"
run aim --project --json "$dir/points.txt"
has 'image at distance 1' 0 'scale=1' 'viewing_distance=1' 'ahead_q30[1]=1073741824' 'image[0].x=0.1' 'image[0].y=0.1' \
    'image[1].x=-0.1' 'image[2].y=-0.1' 'image[4].x=0' 'image[4].y=0' 'image[4].distortion=1' 'image[0].distortion=1.00995049384'
run aim --project --plot-radius 5 --json "$dir/points.txt"
# tan of the half-angle is sqrt(2) / 10: 5 / that.
has 'image of a given radius' 0 'image[4].x=0'
facts
awk -F= '$1 == "scale" && ($2 - 35.3553390593 > 1e-9 || 35.3553390593 - $2 > 1e-9) { bad = 1 }
    $1 == "image[0].x" && ($2 - 3.53553390593 > 1e-9 || 3.53553390593 - $2 > 1e-9) { bad = 1 }
    $1 == "viewing_distance" { d = $2 } $1 == "scale" { s = $2; n++ } END { exit !(n == 1 && !bad && d == s) }' "$dir/facts"
verdict 'the scale fits the radius, and is the viewing distance' $?
printf '0 1 0\n' >"$dir/in.txt"
run aim --project --plot-radius 5 --json "$dir/in.txt"
has 'one point has no scale' 0 'scale=null' 'viewing_distance=null' 'image[0].x=0' 'image[0].y=0'
run aim --project "$dir/points.txt"
grep -q '^  4    0 0  distortion 1$' "$dir/out"
verdict 'image as text' $?

# Segments: in front; through the plane of the viewer; with an end in it; behind; through the eye; both ends one; from behind; in the
# plane; with an end in it and one behind.
cat >"$dir/segments.txt" <<'END_OF'
# x y z x y z
1 1 0  0 2 2
1 1 0  2 -1 0
0 1 1  1 0 0
1 -1 0  0 -2 1
0 1 0  0 -3 0
1 2 0  1 2 0
-1 -1 0  1 1 1
1 0 0  2 0 1
1 0 0  0 -1 1
END_OF
run aim --project --segments "$dir/segments.txt" --json "$dir/points.txt"
has 'segments' 0 'segments[0][0][0]=1' 'segments[0][0][1]=0' 'segments[0][1][0]=0' 'segments[0][1][1]=1' \
    'segments[1].from[0]=1' 'segments[1].from[1]=0' 'segments[1].direction[0]=1' 'segments[1].direction[1]=0' \
    'segments[2].from[0]=0' 'segments[2].from[1]=1' 'segments[2].direction[0]=1' 'segments[2].direction[1]=0' \
    'segments[3]=null' 'segments[4][0][0]=0' 'segments[4][1][0]=0' 'segments[5][1][0]=0.5' \
    'segments[6].from[0]=1' 'segments[6].from[1]=1' 'segments[6].direction[0]=0' 'segments[6].direction[1]=1' \
    'segments[7]=null' 'segments[8]=null'
printf '0 1 0 1 1\n' >"$dir/short.txt"
run aim --project --segments "$dir/short.txt" "$dir/points.txt"
ends 'a segment of five numbers' 2 "$dir/short.txt:1: 5 columns, not 6 (x y z x y z)"
printf '\n0 1 0 0 0 0\n' >"$dir/eye.txt"
run aim --project --segments "$dir/eye.txt" "$dir/points.txt"
ends 'a segment that ends at the viewpoint' 2 "$dir/eye.txt:2: the point is at the viewpoint: it has no direction"
run aim --project --segments "$dir/missing.txt" "$dir/points.txt"
[ $status -eq 2 ] && [ ! -s "$dir/out" ]
verdict 'no file of segments' $?

# The box of a diagonal: its other corners are wider.
printf '2 10 3\n0 10 0\n' >"$dir/diagonal.txt"
run aim --bounds box --json "$dir/diagonal.txt"
facts
awk -F= '{ v[$1] = $2 } END { exit !(v["feasible"] == "true" && v["box_half_deg"] >= v["half_angle_deg"] && v["loss_deg"] >= 0) }' "$dir/facts"
verdict '--bounds box: the cone of the corners holds the points' $?
# Two points, one near and one far: the box puts the axis elsewhere. Corners (0,1,0) ... (10,10,0) hold 0 to atan(10) degrees.
printf '0 10 0\n1 1 0\n' >"$dir/depth.txt"
run aim --bounds box --json "$dir/depth.txt"
has '--bounds box: the loss' 0 'box_half_deg=22.500000023729' 'half_angle_deg=22.500000023729' 'loss_deg=0.000000000000'
printf '1 1 0\n-1 4 0\n' >"$dir/depth.txt"
run aim --bounds box --json "$dir/depth.txt"
facts
awk -F= '{ v[$1] = $2 } END { e = v["loss_deg"] - (v["half_angle_deg"] - 29.518122); exit !(v["box_half_deg"] > 44.9999 && v["box_half_deg"] < 45.0001 && e < 1e-5 && e > -1e-5) }' "$dir/facts"
verdict '--bounds box: what is lost' $?
printf '5 5 5\n-1 -1 3\n4 -2 -6\n' >"$dir/in.txt"
run aim --bounds box --json "$dir/in.txt"
has 'the viewpoint in the box' 3 'feasible=false' 'count=3'
printf '1 0 0\n0 1 0\n' >"$dir/in.txt"
run aim --bounds box --json "$dir/in.txt"
has 'a corner at the viewpoint' 3 'feasible=false'
run aim --bounds box --input q30 "$dir/none"
ends 'a box of directions' 2 'boresight aim: --bounds box goes with --input xyz only: directions have no box'

# A rectangle: 0.2 wide and 0.2 high; at 2:1 the height counts.
run aim --frame rect --aspect 2:1 --json "$dir/points.txt"
facts
awk -F= '{ v[$1] = $2 } END { w = v["hfov_deg"] - 22.6198649480404; h = v["vfov_deg"] - 11.4211862838; exit !(v["method"] == "\"rect\"" && w < 1e-5 && w >= -1e-9 && h < 1e-5 && h >= -1e-6) }' "$dir/facts"
verdict 'a rectangle of 2:1' $?
run aim --frame rect --aspect 2:1 --margin 50 --json "$dir/points.txt"
facts
awk -F= '{ v[$1] = $2 } END { w = v["hfov_deg"] - 33.3984884668; exit !(w < 1e-5 && w > -1e-5) }' "$dir/facts"
verdict 'a margin of 50 %' $?
run aim --frame rect --aspect 2:1 "$dir/points.txt"
grep -q '^hfov_deg  *22\.6' "$dir/out"
verdict 'a rectangle as text' $?
printf '0 0 1\n1 0 100\n-1 0 100\n' >"$dir/in.txt"
run aim --frame rect --aspect 16:9 --json "$dir/in.txt"
facts
awk -F= '{ v[$1] = $2 } END { w = v["hfov_deg"] - 0.998726707; exit !(v["tilt_deg"] > 89.99 && w < 1e-5 && w > -1e-5) }' "$dir/facts"
verdict 'at the zenith the diagonal lies along the points' $?
printf '1 0 0\n-1 0 0\n' >"$dir/in.txt"
run aim --frame rect --aspect 4:3 --json "$dir/in.txt"
has 'a rectangle that nothing holds' 3 'feasible=false' 'count=2'
# The camera's axes: at right angles, right x ahead = up, and level at the sides.
printf '3 4 2\n4 4 1\n3 5 3\n' >"$dir/in.txt"
run aim --frame rect --aspect 4:3 --json "$dir/in.txt"
facts
awk -F= '{ v[$1] = $2 / 1073741824 }
    function r(i) { return v["right_q30[" i "]"] } function a(i) { return v["ahead_q30[" i "]"] } function u(i) { return v["up_q30[" i "]"] }
    function off(x) { return x > 1e-8 || x < -1e-8 }
    END { exit off(r(1) * a(2) - r(2) * a(1) - u(0)) || off(r(2) * a(0) - r(0) * a(2) - u(1)) || off(r(0) * a(1) - r(1) * a(0) - u(2)) ||
        r(2) != 0 || off(r(0) * a(0) + r(1) * a(1)) || u(2) < 0.5 || a(2) < 0.2 }' "$dir/facts"
verdict "the axes of a rectangle's camera" $?

# A picture of two microradians, which Q1.30 would miss by a thousandth: 2 atan(1e-6).
printf '1 1000000 0\n-1 1000000 0.3\n0.2 1000000 0.9\n' >"$dir/in.txt"
run aim --frame rect --aspect 1:1 --json "$dir/in.txt"
facts
awk -F= '{ v[$1] = $2 } END { w = v["hfov_deg"] / 0.000114591559026 - 1; exit !(w < 1e-9 && w > -1e-9) }' "$dir/facts"
verdict 'a rectangle of two microradians' $?

# One unit from the boundary: the picture is nearly 180 degrees wide, and it is found. On it: none.
printf '2147483647 1 0\n-2147483647 1 0\n' >"$dir/edge.txt"
run aim --frame rect --aspect 4:3 --json "$dir/edge.txt"
has 'a rectangle one unit from the boundary' 0 'feasible=true' 'pan_deg=0.000000000000' 'tilt_deg=0.000000000000'
facts
awk -F= '/^hfov_deg=/ { n += $2 > 179.9999999 && $2 < 180 } /^vfov_deg=/ { n += $2 > 179.9999999 && $2 < 180 } END { exit n != 2 }' "$dir/facts"
verdict 'and it is below 180 degrees' $?
printf '2147483647 0 0\n-2147483647 0 0\n' >"$dir/edge.txt"
run aim --frame rect --aspect 4:3 --json "$dir/edge.txt"
has 'no rectangle on the boundary' 3 'feasible=false'
run aim --frame rect <"$dir/none"
ends 'no aspect' 2 'boresight aim: --frame rect needs --aspect W:H'
for aspect in 16 16: :9 0:1 1:-1 x:y 1:2000; do
    run aim --frame rect --aspect "$aspect" <"$dir/none"
    [ $status -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -q 'aspect' "$dir/err"
    verdict "not an aspect: $aspect" $?
done
for margin in x -1 1001; do
    run aim --frame rect --aspect 1:1 --margin "$margin" <"$dir/none"
    [ $status -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ]
    verdict "not a margin: $margin" $?
done
run aim --aspect 4:3 <"$dir/none"
ends 'an aspect of a cone' 2 'boresight aim: --aspect and --margin go with --frame rect only'
run aim --frame rect --aspect 4:3 --up 1,0,0 <"$dir/none"
ends 'up and a rectangle' 2 'boresight aim: --up, --method and --bounds do not go with --frame rect'
run aim --plot-radius 3 <"$dir/none"
ends 'a plot without --project' 2 'boresight aim: --plot-radius and --segments go with --project only'
run aim --project --plot-radius 0 <"$dir/none"
ends 'a plot without size' 2 "boresight aim: --plot-radius '0': must be a number above 0, at most 4000000"
finish
