#!/bin/sh
# Every input that the controller of the image saw, replayed in the controllers of this machine, gives the same outputs: two
# processors, three compilations.
. tests/gate/verdict.sh
boards=build/boards/stm32f405
dir=$(mktemp -d)
replay() { # PROGRAM FILE
    "$1" sim --replay "$2" >"$dir/out" 2>"$dir/said"
}
record() { # SCENARIO IMAGE SECONDS [OPTION...]
    scenario=$1 image=$2 seconds=$3
    shift 3
    nice build/boresight sim host-sim/scenarios/$scenario.ini --quiet --seconds "$seconds" --mcu "$image" --record "$dir/$scenario" "$@" \
        >/dev/null 2>"$dir/said"
    result=$?
    for program in build/gcc/boresight build/clang/boresight; do
        replay $program "$dir/$scenario" && [ $result -lt 2 ]
        verdict "$scenario, replayed by $program: $(awk '$1 == "steps" || $1 == "output_hash" { printf "%s %s ", $1, $2 }' "$dir/out")" $?
    done
}
record stars $boards/boresight.elf 13
record moving $boards/moving/boresight.elf 10
record hobby $boards/hobby/boresight.elf 12
cp "$dir/stars" "$dir/first"
record stars $boards/boresight.elf 4 --mcu-faults hang@2
[ "$(grep -c '^start ' "$dir/stars")" -eq 2 ]
verdict 'a board that starts again is recorded, too' $?

# A drive tells of another angle from some moment on: the outputs are others.
awk '/ f 241 0 92/ && ++n >= 200 { sub(/ f 241 0 92............/, " f 241 0 920000000000ff") } { print }' "$dir/first" >"$dir/planted"
cmp -s "$dir/first" "$dir/planted" && echo 'nothing was planted'
replay build/boresight "$dir/planted"
caught 'another angle in the frames' $?
# The targets of the first message are a little farther round (a target alone need not matter to the cone).
awk '/ u / && !done { done = 1
    for (i = 1; i <= NF; i++)
        if ($i == "u") $(i + 1) = substr($(i + 1), 1, 37) (substr($(i + 1), 38, 1) == "7" ? "3" : "7") substr($(i + 1), 39) }
    { print }' "$dir/first" >"$dir/planted"
replay build/boresight "$dir/planted"
caught 'targets in other places' $?
sed 's/^h \([0-9]*\) .*/h \1 0123456789abcdef/' "$dir/first" >"$dir/planted"
replay build/boresight "$dir/planted"
caught 'outputs that differ' $?
sed '500d' "$dir/first" >"$dir/planted"
replay build/boresight "$dir/planted"
caught 'a tick that is missing' $?
head -c 100000 "$dir/first" >"$dir/planted"
replay build/boresight "$dir/planted"
[ $? -eq 2 ] && grep -q 'planted:[0-9]*: ' "$dir/said"
verdict 'a file that is cut off is named with its line' $?
rm -r "$dir"
exit $status
