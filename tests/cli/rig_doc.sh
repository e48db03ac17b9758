#!/bin/sh
# docs/rig.md says nothing that isn't there: every command and option of this program in it, every key of a rig file, and
# every message that a symptom quotes.
. tests/cli/support/check.sh

# What is between backticks, a line each.
quoted() { tr '\n' ' ' <"$1" | grep -o '`[^`]*`' | tr -d '`'; }

# commands FILE: `boresight COMMAND` and its options that the program does not know.
commands() {
    quoted "$1" | grep -oE '(^| )boresight [a-z]*.*' | while read -r _ command words; do
        if ! "$boresight" help "$command" >"$dir/help" 2>/dev/null; then
            echo "no command: $command"
            continue
        fi
        for word in $words; do
            case $word in
            --*) grep -q -e "^  $word[ ,]" "$dir/help" || echo "no option of $command: $word" ;;
            esac
        done
    done
}
# keys FILE: `KEY = VALUE` that a rig file may not have.
keys() {
    quoted "$1" | grep -oE '^[a-z_0-9]+ = .+' | while read -r key _; do
        grep -qw -e "$key" "$dir/known" || echo "no key: $key"
    done
}
# symptoms FILE: quoted in the first column of the last table, and said nowhere. Names, numbers and `...` are left out; what
# is left must be in a message of the sources.
symptoms() {
    awk '/^\| symptom/ { on = 1; next } on && /^\|[^-]/ { split($0, cell, "|"); print cell[2] }' "$1" | grep -o '`[^`]*`' | tr -d '`' |
        sed -E "s/^[^:]*[0-9]+(:[0-9]+)?: //; s/^CAN adapter [^ ]*: //; s/^Maestro [^ ]*: //; s/^faulted: \.\.\. //; s/ 'NAME'//; s/^drive 1 //; s/[0-9]+ s;.*//" |
        while read -r words; do
            grep -rqF -e "$words" hal/linux boards/linux firmware/control || echo "nobody says: $words"
        done
}
for rig in host-sim/rigs/*.ini; do "$boresight" config check "$rig"; done >"$dir/known"
sed -n 's/.*\.name = "\([a-z_0-9]*\)".*/\1/p' boards/linux/rig_schema.c >>"$dir/known"

none() { # NAME FILE
    status=0
    cp "$2" "$dir/out"
    : >"$dir/err"
    [ ! -s "$2" ]
    verdict "$1" $?
}
found() { # NAME WANTED FILE
    status=0
    cp "$3" "$dir/out"
    grep -qxF -e "$2" "$3"
    verdict "$1" $?
}
[ "$(quoted docs/rig.md | grep -c 'boresight [a-z]')" -ge 8 ] && [ "$(quoted docs/rig.md | grep -cE '^[a-z_0-9]+ = ')" -ge 15 ]
status=$? && cp "$dir/none" "$dir/out" && cp "$dir/none" "$dir/err"
verdict 'the text has commands and keys to look at' $status
commands docs/rig.md >"$dir/c"
none 'every command of the text exists' "$dir/c"
keys docs/rig.md >"$dir/k"
none 'every key of the text exists' "$dir/k"
symptoms docs/rig.md >"$dir/s"
none 'every symptom is a message of the program' "$dir/s"

# The tag to print, ten cells wide, as a picture of 20 pixels a cell on grey: it is found, and its size is what docs/camera.md
# works the lens out from: 1.414 times the radius is the edge of the black square, eight cells.
raster() { # FILE.svg
    tr -d '\n' <"$1" | sed 's/.* d="//; s/z".*/z/; s/z/\n/g' | LC_ALL=C awk -F '[Mhv ]' '
        NF > 3 { for (y = $3; y < $3 + $5; y++) for (x = $2; x < $2 + $4; x++) black[x, y] = 1 }
        END {
            printf "P5\n320 320\n255\n"
            for (v = 0; v < 320; v++) for (u = 0; u < 320; u++) {
                x = int((u - 60) / 20); y = int((v - 60) / 20)
                inside = u >= 60 && v >= 60 && u < 260 && v < 260
                printf "%c", !inside ? 150 : (x, y) in black ? 25 : 235
            }
        }'
}
measured() { # FILE.svg
    raster "$1" >"$dir/tag.pgm"
    run detect --find tags "$dir/tag.pgm"
    [ "$(wc -l <"$dir/out")" -eq 1 ] && grep -q '"id": 0, "object": "tag", "px": \[159\.[45]' "$dir/out" &&
        awk -v r="$(sed 's/.*"radius": \([0-9.]*\).*/\1/' "$dir/out")" 'BEGIN { exit !(1.414 * r > 159 && 1.414 * r < 161) }'
}
if "$boresight" --version | grep -q libapriltag; then
    measured docs/pictures/tag.svg
    verdict 'the tag to print is found, as large as it is' $?
    sed 's/M4 6h1/M3 6h1/' docs/pictures/tag.svg >"$dir/wrong.svg"
    measured "$dir/wrong.svg"
    [ $? -ne 0 ] || grep -q '"confidence": 0\.[0-6]' "$dir/out" # one bit is put right, at half the confidence
    verdict 'a tag of a wrong cell is caught' $?
else
    echo 'SKIP the tag to print is found, as large as it is: built without libapriltag'
fi

# Planted.
sed 's/boresight calibrate rig.ini --dry-run/boresight calibrate rig.ini --dry/; s/`boresight probe`/`boresight prode`/; s/tick_us = 4000/tik_us = 4000/
    s/can0: the interface is down/can0: the interface sleeps/' docs/rig.md >"$dir/wrong.md"
commands "$dir/wrong.md" >"$dir/c"
found 'a wrong command is caught' 'no command: prode' "$dir/c"
found 'a wrong option is caught' 'no option of calibrate: --dry' "$dir/c"
keys "$dir/wrong.md" >"$dir/k"
found 'a wrong key is caught' 'no key: tik_us' "$dir/k"
symptoms "$dir/wrong.md" >"$dir/s"
found 'a symptom that nobody says is caught' 'nobody says: the interface sleeps' "$dir/s"
finish
