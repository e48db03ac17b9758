#!/bin/sh
# `boresight scene render`: its pictures, what it tells of them, and what is bad input. tests/property/hidden.c has the lines
# themselves, against rays.
. tests/cli/support/check.sh

# Boxes of a line each.
boxes() { # VERTICES
    awk -v n="$1" -f tests/cli/support/boxes.awk
}
# The lines of the drawn pen, sorted: the two methods go through the edges in different orders.
lines() { # FILE
    grep 1b2733 "$1" | sed 's/.* d="//; s/".*//; s/M/\nM/g' | sort
}
{
    echo 'wall -10 20 -10 20 1 14
house -2 40 -10 4 4 30' | boxes 0
    printf 'o people\nv 0 30 0\nv 6 30 8\nv 0 10 0\n'
} >"$dir/town.scene"
run scene render "$dir/town.scene" --viewpoint 0,0,0 --aim 0,1,0 --fov 90 --size 400x300 -o "$dir/a.svg" --json
# Of both the front is seen; the lower edge of the house is hidden, its upright ones begin behind the wall.
has 'a wall and a house' 0 'objects=2' 'edges=8' 'segments=7' 'targets=3' 'targets_seen=2'
[ "$(grep -c '<circle.*#047857' "$dir/a.svg")" = 2 ] && [ "$(grep -c '<circle.*#b91c1c' "$dir/a.svg")" = 1 ]
verdict 'targets in sight are full, hidden ones are rings' $?
grep -q '#d97706' "$dir/a.svg" && grep -q 'viewBox="0 0 400 300"' "$dir/a.svg" && grep -q '#8a94a0' "$dir/a.svg"
verdict 'the cone and the frame are drawn' $?
# The wall's top, 4 above the eye at distance 20, has its picture at 150 - 200 * 4 / 20; the house's sides go up from there.
lines "$dir/a.svg" | grep -q '^M100 110L300 110$' && lines "$dir/a.svg" | grep -Eq '^M190 (110L190 50|50L190 110)$'
verdict 'lines end where they go behind' $?
run aim --json --viewpoint 0,0,0 - <<END
6 30 8
0 10 0
END
facts
wanted=$(awk -F= '$1 == "half_angle_deg" { print $2 }' "$dir/facts")
run scene render "$dir/town.scene" --fov 90 -o "$dir/b.svg" --json
facts
awk -F= -v wanted="$wanted" '$1 == "half_angle_deg" { found = ($2 - wanted) ^ 2 < 1e-16 } END { exit !found }' "$dir/facts"
verdict 'the cone is that of the targets in sight' $?

# A city, seen along its streets (every line meets another one's end) and from anywhere.
{
    awk 'BEGIN { for (i = 0; i < 16; i++) print "t" i, i % 4 * 3, int(i / 4) * 3, 0, 1, 1, 1 + i * 7 % 5 }' | boxes 0
    printf 'o ground\nv -2 -2 0\nv 14 -2 0\nv 14 14 0\nv 6 9 0\nv -2 14 0\nf 129 130 131 132 133\no wire\nv 0 5 1\nv 9 5 2\nl 134 135\n'
} >"$dir/city.scene"
for eye in 6,-9,2 -9,-9,1 25,24,9 2,2,0.5 1,-9,1; do
    run scene render "$dir/city.scene" --viewpoint $eye --aim 6,6,1 --fov 75 -o "$dir/clip.svg"
    run scene render "$dir/city.scene" --viewpoint $eye --aim 6,6,1 --fov 75 -o "$dir/levine.svg" --method levine
    [ "$status" -eq 0 ] && [ "$(lines "$dir/clip.svg" | wc -l)" -gt 20 ] && [ "$(lines "$dir/clip.svg")" = "$(lines "$dir/levine.svg")" ]
    verdict "the same lines by both methods from $eye" $?
done
run scene build "$dir/city.scene" -o "$dir/city.coca"
run scene render "$dir/city.coca" --viewpoint 25,24,9 --aim 6,6,1 -o "$dir/tree.svg" --json
has 'a tree' 0 'objects=18' 'half_angle_deg=null'
run scene render "$dir/city.scene" --viewpoint 25,24,9 --aim 6,6,1 -o "$dir/text.svg"
[ "$(lines "$dir/tree.svg")" = "$(lines "$dir/text.svg")" ]
verdict 'a tree is drawn like its text' $?
printf '6 -5 1\n6 7 30\n' >"$dir/more.txt"
run scene render "$dir/city.scene" --viewpoint 6,-9,2 --targets "$dir/more.txt" --fov 120 -o "$dir/m.svg" --json
has 'targets of a file' 0 'targets=2' 'targets_seen=2'
if "$boresight" --version | grep -q 'no cairo'; then
    run scene render "$dir/city.scene" -o "$dir/a.png"
    refused 'no PNG without cairo' 'without cairo'
else
    run scene render "$dir/city.scene" --viewpoint 6,-9,2 --aim 6,6,1 --size 320x200 -o "$dir/a.png"
    # The header of a PNG: 320 x 200.
    [ "$status" -eq 0 ] && [ "$(od -An -tx1 -N24 "$dir/a.png" | tr -d ' \n')" = 89504e470d0a1a0a0000000d4948445200000140000000c8 ]
    verdict 'a PNG of its size' $?
fi

# What is bad input, in one line; and no picture.
printf 'left 0 0 0 10 10 10\nright 9 9 9 10 10 10\n' | boxes 0 >"$dir/overlap.scene"
run scene render "$dir/overlap.scene" --viewpoint 0,-50,0 --aim 0,0,0 -o "$dir/none.svg"
refused 'solids that overlap' "overlap.scene:16: the object 'right' and the object 'left' of line 1 are not linearly separable"
printf 'left 0 0 0 10 10 10\nright 10 0 0 10 10 10\n' | boxes 0 >"$dir/touch.scene"
run scene render "$dir/touch.scene" --viewpoint 0,-50,0 --aim 0,0,0 -o "$dir/touch.svg" --json
has 'solids that touch' 0 'objects=2'
boxes 0 <<END | sed 's/^v 10 10 10$/v 10 10 11/' >"$dir/bent.scene"
box 0 0 0 10 10 10
END
run scene render "$dir/bent.scene" -o "$dir/none.svg"
refused 'a face that is not planar' 'bent.scene:11: the face is not planar'
printf 'v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nv 2 2 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n' >"$dir/dent.scene"
run scene render "$dir/dent.scene" -o "$dir/none.svg"
refused 'a solid that is not convex' 'the solid is not convex'
run scene render "$dir/city.scene" -o "$dir/none.gif"
refused 'another kind of picture' 'none.gif'
run scene render "$dir/city.scene"
refused 'no name for the picture' '-o FILE'
run scene render "$dir/city.scene" --fov 171 -o "$dir/none.svg"
refused 'an angle that is too wide' '--fov'
run scene render "$dir/city.scene" --size 320 -o "$dir/none.svg"
refused 'a size that is none' '--size'
run scene render "$dir/city.scene" --viewpoint 1,1,1 --aim 1,1,1 -o "$dir/none.svg"
refused 'a look at the viewpoint' 'look at'
[ ! -e "$dir/none.svg" ] && [ ! -e "$dir/none.gif" ]
verdict 'nothing half done' $?
finish
