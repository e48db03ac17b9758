#!/bin/sh
# `boresight solid`: fields, forms, and what is bad input. tests/property/solid_*.c compare the numbers with the definitions.
. tests/cli/support/check.sh

# A tetrahedron in tenths with a point inside and a corner twice.
printf '0 0 0\n1 0 0\n0 1 0\n0 0 1\n.2 .2 .2\n1 0 0\n' >"$dir/solid.txt"
for method in caps levine wrap; do
    run solid hull --method $method --json "$dir/solid.txt"
    has "hull by $method" 0 'count=6' 'exact=true' 'dimension=3' 'vertices[0]=0' 'vertices[1]=1' 'vertices[2]=2' 'vertices[3]=3'
    facts
    [ "$(grep -c '^faces\[[0-9]*\]\[0\]=' "$dir/facts")" -eq 4 ] && [ "$(fact 'vertices[4]')" = '' ]
    verdict "hull by $method: four faces, four vertices" $?
done
for method in pivot levine unsorted; do
    run solid sphere --method $method --json "$dir/solid.txt"
    has "sphere by $method" 0 'count=6' 'exact=true' 'center[0]=0.333333333333333' 'center[1]=0.333333333333333' \
        'center[2]=0.333333333333333' 'support[0]=1' 'support[1]=2' 'support[2]=3'
    [ "$(fact 'support[3]')" = '' ]
    verdict "sphere by $method: held by three" $?
done

run solid hull "$dir/solid.txt"
tests=$(awk '/^side_tests/ { print $2 }' "$dir/out")
cat >"$dir/wanted" <<END
count             6
exact             yes
dimension         3
vertices          0 1 2 3
faces             1-2-3 0-2-1 0-3-2 0-1-3
side_tests        $tests
END
cmp -s "$dir/out" "$dir/wanted"
verdict 'hull as text' $?

printf 'a 0 0 5\nb 2 2 5\nc 2 0 5\nd 1 1 5\n' >"$dir/input"
run solid hull --named <"$dir/input"
grep -qx 'vertices          0 (a) 2 (c) 1 (b)' "$dir/out" && grep -qx 'faces             none' "$dir/out"
verdict 'a flat set: its polygon in order, with names' $?
printf '0 0 0\n1 1 1\n-1 -1 -1\n1 1 1\n' >"$dir/input"
run solid hull --json <"$dir/input"
has 'a line: its ends' 0 'dimension=1' 'vertices[0]=1' 'vertices[1]=2' 'faces=[]'
printf '4 4 4\n4 4 4\n' >"$dir/input"
run solid hull --json <"$dir/input"
has 'equal points: the first' 0 'dimension=0' 'vertices[0]=0' 'faces=[]'
printf '4 4 4\n4 4 4\n' >"$dir/input"
run solid sphere --json <"$dir/input"
has 'the sphere of equal points' 0 'center[0]=4' 'radius=0' 'support[0]=0'
printf '0 0 0\n1e-20 0 0\n0 1 0\n' >"$dir/input"
run solid hull --json <"$dir/input"
has 'more digits than fit: rounded, and said so' 0 'exact=false' 'dimension=1'
printf -- '-2147483648 0 0\n2147483647 0 0\n0 0 0\n' >"$dir/input"
run solid sphere --input q30 --json <"$dir/input"
has 'int32 at its ends' 0 'exact=true' 'center[0]=-0.5' 'radius=2147483647.5000002' 'support[0]=0' 'support[1]=1'
printf '0 0 0\n1e-30 0 0\n0 1e-30 0\n0 0 1e-30\n' >"$dir/input"
run solid hull --json <"$dir/input"
has 'tiny units are exact' 0 'exact=true' 'dimension=3'

# The sphere as printed holds every point as written.
awk 'BEGIN { srand(3); for (i = 0; i < 2000; i++) printf "%.6f %.6f %.6f\n", 20 * rand() - 7, rand(), 3 * rand() }' >"$dir/many.txt"
run solid sphere --json "$dir/many.txt"
facts
awk -v x="$(fact 'center[0]')" -v y="$(fact 'center[1]')" -v z="$(fact 'center[2]')" -v r="$(fact radius)" '
    { d = sqrt(($1 - x) ^ 2 + ($2 - y) ^ 2 + ($3 - z) ^ 2); if (d > far) far = d }
    END { exit !(NR == 2000 && far <= r * (1 + 1e-15) && far > r * (1 - 1e-12)) }' "$dir/many.txt"
verdict 'the printed sphere holds every point, tightly' $?

run solid </dev/null
ends 'neither hull nor sphere' 2 'boresight solid: needs `hull` or `sphere` first'
run solid cube "$dir/solid.txt"
ends 'another word' 2 'boresight solid: needs `hull` or `sphere` first'
run solid hull --method pivot "$dir/solid.txt"
ends "the other one's method" 2 "boresight solid: --method 'pivot': must be one of caps, levine, wrap"
run solid sphere </dev/null
ends 'no points' 2 'stdin: no points'
printf '1 2 3\n1 2\n' >"$dir/input"
run solid hull <"$dir/input"
ends 'a short line' 2 'stdin:2: 2 columns, not 3 (x y z)'
printf '1 2 3\n1 nan 3\n' >"$dir/input"
run solid hull <"$dir/input"
ends 'not a number' 2 "stdin:2: 'nan' is not a decimal number"
run solid hull --input radec "$dir/solid.txt"
[ "$status" -eq 2 ] && [ "$(wc -l <"$dir/err")" -eq 1 ]
verdict 'directions are no places' $?
finish
