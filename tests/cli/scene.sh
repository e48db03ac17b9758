#!/bin/sh
# `boresight scene`: the text it reads, the file it writes, and what is bad input. tests/property/scene_*.c have the rest.
. tests/cli/support/check.sh

cat >"$dir/town.scene" <<END
# five vertices, two objects and a cloud
v 0 10 0
v 1 10 0
v 0 11 2
vn 0 0 1
o cloud
v 3 12 1
v 4 12 1
group town
o house
f 1/1/1 2 3
o tower
detail 0
p 1
detail 3.5
l 1 -1
end
END
printf '0 10 0\n1 10 0\n0 11 2\n3 12 1\n4 12 1\n' >"$dir/town.txt"
run scene build "$dir/town.scene" -o "$dir/town.coca"
[ "$status" -eq 0 ] && [ ! -s "$dir/out" ] && [ ! -s "$dir/err" ] && [ ! -e "$dir/town.coca.new" ]
verdict 'build' $?
run scene info --json "$dir/town.coca"
has 'info' 0 'objects=3' 'solids=0' 'faces=1' 'lines=1' 'points=8' 'nodes=7' 'levels=4' "bytes=$(wc -c <"$dir/town.coca" | tr -d ' ')"
for eye in 0,0,0 -3,1.25,7 20,5,-1; do
    run aim --json --viewpoint $eye "$dir/town.txt"
    facts
    grep -E '^(feasible|ahead_q30|right_q30|up_q30|pan_deg|tilt_deg|half_angle)' "$dir/facts" >"$dir/wanted"
    run scene aim --json --viewpoint $eye "$dir/town.coca"
    facts
    grep -E '^(feasible|ahead_q30|right_q30|up_q30|pan_deg|tilt_deg|half_angle)' "$dir/facts" | cmp -s - "$dir/wanted"
    verdict "aim from $eye: as over all points" $?
done
has 'aim: its other fields' 0 'count=7' 'method="tree"' 'loss_px=0'
run scene aim --json --viewpoint 1.6,11,0.8 "$dir/town.coca"
has 'surrounded' 3 'feasible=false' 'count=7'
run scene aim --viewpoint 4,12,1 "$dir/town.coca"
ends 'from the place of a point' 2 "$dir/town.coca: a point is at the viewpoint: it has no direction"
run scene aim --viewpoint 1e9,0,0 "$dir/town.coca"
ends 'from too far away' 2 'boresight scene: --viewpoint is more than 128 from the origin of this scene'

# Objects that have moved, gone and come: as over the points where they are now.
cat >"$dir/changes" <<END
move 1 1 1 house   # and then
move 5 0 1 house
away cloud
copy -1 2 3 tower
point 9 9 9
away tower
back tower
END
printf '5 10 1\n6 10 1\n5 11 3\n0 10 0\n4 12 1\n-1 12 3\n3 14 4\n9 9 9\n' >"$dir/moved.txt"
for eye in 0,0,0 -3,1.25,7 20,5,-1; do
    run aim --json --viewpoint $eye "$dir/moved.txt"
    facts
    grep -E '^(count|feasible|ahead_q30|right_q30|up_q30|pan_deg|tilt_deg|half_angle)' "$dir/facts" >"$dir/wanted"
    run scene aim --json --viewpoint $eye --changes "$dir/changes" "$dir/town.coca"
    facts
    grep -E '^(count|feasible|ahead_q30|right_q30|up_q30|pan_deg|tilt_deg|half_angle)' "$dir/facts" | cmp -s - "$dir/wanted"
    verdict "with changes, from $eye: as over all points" $?
done
printf 'away house\naway tower\naway cloud\n' >"$dir/changes"
run scene aim --json --changes "$dir/changes" "$dir/town.coca"
printf '{"feasible": false, "count": 0}\n' | cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'everything gone' $?
changed() { # NAME LINE WHAT TEXT
    printf "$4" >"$dir/changes"
    run scene aim --changes "$dir/changes" "$dir/town.coca"
    ends "$1" 2 "$dir/changes:$2: $3"
}
changed 'no such object' 2 "the scene has no object 'barn'" 'away house\naway barn\n'
changed 'a cluster is no object' 1 "the scene has no object 'town'" 'away town\n'
changed 'no such change' 1 "'turn' is no change: away, back, move, copy or point" 'turn house\n'
changed 'two numbers' 1 'needs three numbers' 'move 1 2 house\n'
changed 'a move too far' 2 "'900' is beyond what this scene has room for" '\nmove 900 0 0 house\n'
changed 'a move a bit too far' 1 'would be beyond what this scene has room for' 'move 127.9 0 0 house\n'
changed 'four coordinates' 1 'a point has three coordinates' 'point 1 2 3 4\n'

# By distance: four corners from far away, all eight from within 10.
printf 'v 0 20 0\nv 1 20 0\nv 1 21 0\nv 0 21 3\no a\ndetail within 100\np 1 2\ndetail within 10\np 1 2 3 4\n' >"$dir/near.scene"
run scene build --coarse-px 0 -o "$dir/near.coca" "$dir/near.scene"
for eye in 0,0,0 0,13,0; do
    run scene aim --json --focal-px 1000 --viewpoint $eye "$dir/near.coca"
    facts
    [ "$(fact 'support[2]')" = "$([ $eye = 0,0,0 ] || echo 3)" ]
    verdict "a description by distance, from $eye" $?
done

# Ten thousand points in a hundred heaps: a few are read; a camera of low resolution reads fewer.
awk 'BEGIN { srand(5); for (o = 0; o < 100; o++) { print "o heap"; x = 100 * rand(); y = 300 + 100 * rand(); z = 50 * rand()
    for (i = 0; i < 100; i++) printf "v %.4f %.4f %.4f\n", x + rand(), y + rand(), z + rand() } }' >"$dir/heaps.scene"
run scene build -o "$dir/heaps.coca" "$dir/heaps.scene"
run scene aim --json "$dir/heaps.coca"
facts
fine=$(fact point_reads)
ahead=$(fact 'ahead_q30[0]')
[ "$(fact count)" -eq 10000 ] && [ "$fine" -lt 500 ]
verdict "ten thousand points: few are read ($fine)" $?
sed -n 's/^v //p' "$dir/heaps.scene" >"$dir/heaps.txt"
run aim --json "$dir/heaps.txt"
facts
[ "$(fact 'ahead_q30[0]')" -eq "$ahead" ]
verdict 'ten thousand points: the same axis' $?
run scene aim --json --focal-px 100 "$dir/heaps.coca"
facts
awk -v loss="$(fact loss_px)" -v reads="$(fact point_reads)" -v fine="$fine" \
    'BEGIN { exit !(loss > 0 && loss <= 0.5 && reads < fine) }'
verdict 'at 100 pixels: fewer, with a loss of at most half a pixel' $?

# Every scene that is none is named with its line.
bad() { # NAME LINE WHAT TEXT
    printf "$4" >"$dir/bad.scene"
    run scene build -o "$dir/bad.coca" <"$dir/bad.scene"
    said=$(cat "$dir/err")
    [ "$status" -eq 2 ] && [ "$said" = "stdin:$2: $3" ] && [ ! -e "$dir/bad.coca" ]
    verdict "$1" $?
}
bad 'not a number' 2 "'nan' is not a decimal number" 'o x\nv 0 nan 0\n'
bad 'two coordinates' 1 'a vertex has three coordinates' 'v 0 1\n'
bad 'four coordinates' 1 'a vertex has three coordinates' 'v 0 1 2 3\n'
bad 'a vertex that comes later' 2 "'2' is no vertex so far" 'v 0 1 2\np 2\nv 1 2 3\n'
bad 'vertex 0' 2 "'0' is no vertex so far" 'v 0 1 2\np 0\n'
bad 'an element without vertices' 1 'an element without vertices' 'p\n'
bad 'end without a group' 2 'end without a group' 'v 0 1 2\nend\n'
bad 'a group without end' 2 'the group has no end' 'v 0 1 2\ngroup a\no b\np 1\n'
bad 'detail outside of an object' 1 'detail outside of an object' 'detail 3\n'
bad 'details that do not grow' 6 'details go from coarse to fine: the radius has to grow' \
    'v 0 1 2\no a\ndetail 2\np 1\n\ndetail 2\np 1\n'
bad 'a description without points' 3 'the description has no points' 'v 0 1 2\no a\ndetail 2\ndetail 3\np 1\n'
bad 'points before the first detail' 4 'the object has points before its first detail' 'v 0 1 2\no a\np 1\ndetail 2\n'
cube='v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\no cube\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n'
printf "$cube" | run scene build -o "$dir/cube.coca"
run scene info --json "$dir/cube.coca"
has 'faces that close up are a solid' 0 'objects=1' 'solids=1' 'faces=6' 'lines=0' 'points=8'
printf "$cube" | sed '$d' >"$dir/input"
run scene build -o "$dir/cube.coca" <"$dir/input"
run scene info --json "$dir/cube.coca"
has 'faces that do not are none' 0 'objects=1' 'solids=0' 'faces=5'
bad 'a face that is not planar' 6 'the face is not planar: cut it into triangles' 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .001\no a\nf 1 2 3 4\n'
bad 'a face on a line' 4 'the face has no area: its corners are on one line' 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n'
bad 'a corner twice' 5 'the face names a vertex twice' 'v 0 0 0\nv 1 0 0\nv 2 1 0\no x\nf 1 2 1 3\n'
bad 'a face of two corners' 3 'a face has at least three corners' 'v 0 0 0\nv 1 0 0\nf 1 2\n'
bad 'a line of one end' 2 'a line has at least two ends' 'v 0 0 0\nl 1\n'
# A tetrahedron with a dent: its fifth vertex is inside.
dented='v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nv 1 1 1\no dented\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n'
bad 'a solid that is not convex' 10 'the solid is not convex: this face has corners on both sides; --points leaves faces out' "$dented"
printf "$dented" >"$dir/dented.scene"
run scene build --points -o "$dir/dented.coca" "$dir/dented.scene"
run scene info --json "$dir/dented.coca"
has 'only its points' 0 'objects=1' 'faces=0' 'points=5'
bad 'radius and distance' 6 'details of one object go by radius or by distance, not both' \
    'v 0 1 2\no a\ndetail 2\np 1\n\ndetail within 3\np 1\n'
bad 'distances that do not shrink' 5 'details go from coarse to fine: the distance has to shrink' \
    'v 0 1 2\no a\ndetail within 2\np 1\ndetail within 3\np 1\n'
bad 'no distance' 3 'detail within needs a distance above 0' 'v 0 1 2\no a\ndetail within -2\np 1\n'
bad 'another line' 2 "'curve' is no line of a scene" 'v 0 1 2\ncurve 1\n'
twins='o a\nv 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\no b\nv 1 1 1\nv 5 1 1\nv 1 5 1\nv 1 1 5\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n'
bad 'solids that overlap' 10 "the object 'b' and the object 'a' of line 1 are not linearly separable: no plane is between them" "$twins"
printf "$twins" >"$dir/twins.scene"
run scene build --points "$dir/twins.scene" -o "$dir/twins.coca"
[ "$status" -eq 0 ] && [ -s "$dir/twins.coca" ]
verdict 'but as points they are a scene' $?
bad 'groups too deep' 17 'groups nested deeper than 16' "$(awk 'BEGIN { for (i = 0; i < 17; i++) printf "group g\\n" }')"
# Sixteen groups in each other, with 32 objects each; the numbers are such that it is just too much.
awk 'function draw() { seed = (seed * 16807) % 2147483647; return seed / 2147483647 }
    BEGIN { seed = 9; for (g = 0; g < 16; g++) { print "group g"
        for (o = 0; o < 32; o++) { x = draw(); y = draw(); z = draw(); printf "o x\nv %.6f %.6f %.6f\n", x, y, z } }
    for (g = 0; g < 16; g++) print "end" }' >"$dir/deep.scene"
run scene build -o "$dir/bad.coca" "$dir/deep.scene"
said=$(cat "$dir/err")
line=$(printf '%s\n' "$said" | sed -n 's/.*deep.scene:\([0-9]*\): too deep: with this object the tree has more than 40 levels$/\1/p')
[ "$status" -eq 2 ] && [ -n "$line" ] && [ "$(sed -n "${line}p" "$dir/deep.scene")" = 'o x' ] && [ ! -e "$dir/bad.coca" ]
verdict 'a tree too deep' $?
run scene build "$dir/town.scene"
ends 'nowhere to write' 2 'boresight scene: build: -o FILE says where to write the tree'
run scene paint "$dir/town.coca"
ends 'another word' 2 'boresight scene: needs `build`, `info`, `aim`, `render` or `measure` first'
run scene aim
ends 'no tree' 2 'boresight scene: aim: needs a tree, FILE.coca'

# Nothing at all is an empty scene.
run scene build -o "$dir/empty.coca" <"$dir/none"
[ "$status" -eq 0 ]
verdict 'an empty scene' $?
run scene aim --json "$dir/empty.coca"
printf '{"feasible": false, "count": 0}\n' | cmp -s - "$dir/out" && [ "$status" -eq 3 ]
verdict 'nothing to aim at' $?

# Damaged files are refused with the offset.
damaged() { # NAME OFFSET BYTE WHAT
    cp "$dir/town.coca" "$dir/damaged.coca"
    printf "$3" | dd of="$dir/damaged.coca" bs=1 seek="$2" conv=notrunc 2>>"$dir/dd"
    run scene info "$dir/damaged.coca"
    ends "$1" 2 "$dir/damaged.coca: at offset $4"
}
damaged 'another kind of file' 0 'x' '0: is no sphere tree of this version'
damaged 'another version' 4 '\007' '4: is no sphere tree of this version'
damaged 'a byte of a point' 500 '\125' '12: is damaged: its checksum is wrong'
head -c 100 "$dir/town.coca" >"$dir/damaged.coca"
run scene info "$dir/damaged.coca"
ends 'a file cut short' 2 "$dir/damaged.coca: at offset 8: is not as long as it says"
run scene info "$dir/none"
ends 'an empty file' 2 "$dir/none: at offset 0: is too short for a sphere tree"
run scene info "$dir"
ends 'a folder' 2 "$dir: is no regular file"
finish
