#!/bin/sh
# Results of `aim` and `hull`: fields, forms, exit statuses. tests/cli/stars.c and measure.c have the numbers.
. tests/cli/support/check.sh

# The checker of JSON catches what is none.
for text in '' '{' '{}}' '{"a": 1} {"b": 2}' '{"a": 01}' '{"a": .5}' '{"a": nan}' '{"a": 1,}' '{"a" 1}' \
    '{"a": 1, "a": 2}' '[1]' '{"a": [1 2]}' '{"a": "\x"}' '{a: 1}'; do
    printf '%s\n' "$text" | awk -f tests/cli/support/json.awk >"$dir/out" 2>"$dir/err"
    [ $? -eq 1 ]
    verdict "no JSON: $text" $?
done
printf '{"a": [1, -2.5e3, {"b": null}], "c": "x\\"y", "d": []}\n' |
    awk -f tests/cli/support/json.awk >"$dir/out" 2>"$dir/err"
printf 'a[0]=1\na[1]=-2.5e3\na[2].b=null\nc="x\\"y"\nd=[]\n' | cmp -s - "$dir/out"
verdict 'JSON with everything' $?

printf 'a 1 0 0\nb 0 1 0\nc 1 1 0.1\n' >"$dir/points.txt"
run aim --named --json "$dir/points.txt"
has 'aim --json' 0 'feasible=true' 'count=3' 'method="pivot"' \
    'ahead_q30[0]=759250125' 'ahead_q30[1]=759250125' 'ahead_q30[2]=0' \
    'right_q30[0]=759250125' 'right_q30[1]=-759250125' 'right_q30[2]=0' \
    'up_q30[0]=0' 'up_q30[1]=0' 'up_q30[2]=1073741824' 'pan_deg=45.000000000000' 'tilt_deg=0.000000000000' 'half_angle_deg=45.000000000000' \
    'half_angle_bam32=536870912' 'image_radius=1' 'max_distortion=1.41421356237' 'support[0]=0' 'support[1]=1'
facts
sed 's/=.*//; s/\[.*//' "$dir/facts" | uniq | tr '\n' ' ' >"$dir/names"
{
    printf 'feasible count method ahead_q30 right_q30 up_q30 pan_deg tilt_deg '
    printf 'half_angle_deg half_angle_bam32 image_radius max_distortion support point_reads '
} | cmp -s - "$dir/names"
verdict 'aim --json: all fields and no others' $?

run aim --named "$dir/points.txt"
reads=$(awk '/^point_reads/ { print $2 }' "$dir/out")
cat >"$dir/wanted" <<END
feasible          yes
count             3
method            pivot
ahead_q30         759250125 759250125 0
right_q30         759250125 -759250125 0
up_q30            0 0 1073741824
pan_deg           45.000000000000
tilt_deg          0.000000000000
half_angle_deg    45.000000000000
half_angle_bam32  536870912
image_radius      1
max_distortion    1.41421356237
support           0 (a) 1 (b)
point_reads       $reads
END
cmp -s "$dir/out" "$dir/wanted"
verdict 'aim as text: the same facts, with names' $?

for method in auto pivot shrink voronoi hull-voronoi pyramid; do
    run aim --method $method --json <"$dir/none"
    has "no points, $method" 3 'feasible=false' 'count=0'
done
cp "$dir/out" "$dir/seen"
printf '{"feasible": false, "count": 0}\n' | cmp -s - "$dir/seen"
verdict 'no points: these two fields only' $?
run aim <"$dir/none"
printf 'feasible          no\ncount             0\n' | cmp -s - "$dir/out"
verdict 'no points as text' $?

printf '1 0 0\n5 1 1\n-1 1 0\n-1 -1 0\n' >"$dir/points.txt"
run aim --json "$dir/points.txt"
has 'infeasible' 3 'feasible=false' 'count=4' 'witness[0]=0' 'witness[1]=2' 'witness[2]=3'
run aim "$dir/points.txt"
printf 'feasible          no\ncount             4\nwitness           0 2 3\n' |
    cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'infeasible as text' $?

run aim --json <<END
0 0 3
END
has 'the zenith' 0 'pan_deg=0.000000000000' 'tilt_deg=90.000000000000' \
    'half_angle_deg=0.000000000000' 'half_angle_bam32=0' 'image_radius=0' 'max_distortion=1' \
    'right_q30[0]=1073741824' 'up_q30[1]=-1073741824' 'support[0]=0'
run aim --json <<END
0 0 -3
END
has 'the nadir' 0 'pan_deg=0.000000000000' 'tilt_deg=-90.000000000000' 'right_q30[0]=1073741824' 'up_q30[1]=1073741824'
run aim --json <<END
0 -2 0
END
has 'south' 0 'pan_deg=180.000000000000' 'tilt_deg=0.000000000000'
run aim --json --up 1,0,0 <<END
0 0 1
END
has 'another up' 0 'up_q30[0]=1073741824' 'right_q30[1]=1073741824' 'tilt_deg=90.000000000000' 'pan_deg=0.000000000000'
run aim --json --up 0.00000000000000000000000000000000001,0,0 <<END
5 0 0
END
has 'ahead parallel to up along x' 0 'right_q30[1]=1073741824' 'up_q30[2]=-1073741824'

# A feasible set whose cone, once printed in Q1.30, is not below 90 degrees: no picture, and valid JSON.
run aim --json <<END
1 0 1e-9
-1 1e-30 1e-9
END
has 'hardly feasible' 0 'feasible=true'
awk -F= '/^half_angle_deg/ { exit !($2 > 89.9 && $2 < 90.0001) }' "$dir/facts"
verdict 'hardly feasible: near 90 degrees' $?
run aim --json --input q30 <<END
2147483647 1 0
-2147483646 -1 1
1 -2147483647 0
END
has 'a cone of 90 degrees as printed: no picture' 0 'half_angle_deg=90.000000000000' \
    'half_angle_bam32=1073741824' 'image_radius=null' 'max_distortion=null'

cat >"$dir/points.txt" <<END
n 0 0 1
a 1 1 2
b -1 1 2
c -1 -1 2
d 1 -1 2
a2 2 2 4
e 0 1 2
END
run hull --named --json "$dir/points.txt"
printf '{"hemispherical": true, "count": 7, "hull": [1, 4, 3, 2]}\n' | cmp -s - "$dir/out"
verdict 'hull --json: clockwise from outside, from the smallest index' $?
run hull --named "$dir/points.txt"
printf 'hemispherical     yes\ncount             7\nhull              1 (a) 4 (d) 3 (c) 2 (b)\n' |
    cmp -s - "$dir/out"
verdict 'hull as text' $?
run hull --json <"$dir/none"
printf '{"hemispherical": false, "count": 0, "witness": []}\n' | cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'hull of no points' $?
run hull <"$dir/none"
printf 'hemispherical     no\ncount             0\nwitness           none\n' |
    cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'hull of no points as text' $?
printf '1 0 0\n-2 0 0\n' >"$dir/points.txt"
run hull --json "$dir/points.txt"
has 'hull of an antipodal pair' 3 'hemispherical=false' 'count=2' 'witness[0]=0' 'witness[1]=1'
printf '0.1 0.2 0.3\n0.3 0.2 0.1\n4 4 4\n0.2 0.4 0.6\n' >"$dir/points.txt"
run hull --json "$dir/points.txt"
printf '{"hemispherical": true, "count": 4, "hull": [0, 1]}\n' | cmp -s - "$dir/out"
verdict 'hull of an arc: the ends only, each once' $?

finish
