#!/bin/sh
# The figures of docs/geometry.md and docs/regular.md are what this build of the program draws; `make figures` mends it.
. tests/gate/verdict.sh
dir=$(mktemp -d)
same() { # FOLDER
    for figure in cone box rect rails voronoi lineup apart gap sphere-points sphere-circles sphere-near; do
        [ -s "$1/$figure.svg" ] && grep -q '</svg>' "$1/$figure.svg" && cmp -s "$1/$figure.svg" "docs/pictures/$figure.svg" || return 1
    done
}
sh docs/pictures/draw.sh "$dir" && same "$dir"
verdict 'the figures are what the program draws' $?
sed -i 's/cx="180"/cx="181"/' "$dir/cone.svg"
same "$dir"
caught 'a figure of another build' $?
mkdir "$dir/none"
BORESIGHT=false sh docs/pictures/draw.sh "$dir/none" && same "$dir/none"
caught 'a program that draws nothing' $?
rm -r "$dir"
exit $status
