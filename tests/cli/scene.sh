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
has 'info' 0 'points=8' 'nodes=7' 'levels=4' "bytes=$(wc -c <"$dir/town.coca" | tr -d ' ')"
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
bad 'another line' 2 "'curve' is no line of a scene" 'v 0 1 2\ncurve 1\n'
bad 'groups too deep' 17 'groups nested deeper than 16' "$(awk 'BEGIN { for (i = 0; i < 17; i++) printf "group g\\n" }')"
run scene build "$dir/town.scene"
ends 'nowhere to write' 2 'boresight scene: build: -o FILE says where to write the tree'
run scene paint "$dir/town.coca"
ends 'another word' 2 'boresight scene: needs `build`, `info` or `aim` first'
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
