#!/bin/sh
# `boresight sim SCENARIO --mcu IMAGE`: the image that is flashed moves the simulated gimbal, through its CAN controller and its timers.
# It does not do worse than the controller on the host does; every step of it is compared with that one (invariant I5).
. tests/gate/verdict.sh
boards=build/boards/stm32f405
dir=$(mktemp -d)
value() { # NAME FILE
    awk -v name="$1" '$1 == name { print $2 }' "$2"
}
is() { # NAME FACT WANTED
    [ "$(value "$2" "$out")" = "$3" ]
    verdict "$1: $2 is $3" $?
}

closed_loop() { # SCENARIO IMAGE SECONDS
    out=$dir/$1.mcu
    nice build/boresight sim host-sim/scenarios/$1.ini --quiet --seconds "$3" >"$dir/$1.host"
    nice build/boresight sim host-sim/scenarios/$1.ini --quiet --seconds "$3" --mcu "$2" >"$out" 2>"$dir/said"
    verdict "$1 on the image" $?
    sed 's/^/    /' "$dir/said"
    is "$1" violations 0
    is "$1" mcu_complaints 0
    is "$1" mcu_resets 0
    is "$1" mode tracking
    for fact in aim_error_rms_deg settle_s in_frame_percent; do
        # The image takes some milliseconds to start, and both see other noise.
        awk -v wide="$([ $fact = settle_s ] && echo 0.1 || echo 0.02)" -v here="$(value $fact "$dir/$1.host")" -v there="$(value $fact "$out")" 'BEGIN {
            difference = here - there
            exit !(here != "" && there != "" && (difference < 0 ? -difference : difference) <= 0.02 * here + wide) }'
        verdict "$1: $fact, $(value $fact "$out") and on the host $(value $fact "$dir/$1.host")" $?
    done
    echo "# $1: a step takes $(value mcu_step_mean "$out") instructions, $(value mcu_step_max "$out") at most;" \
        "the loop $(value mcu_loop_percent "$out") % of a tick; $(value times_real_time "$out") times real time"
}
closed_loop stars $boards/boresight.elf 13
closed_loop moving $boards/moving/boresight.elf 10
closed_loop pedestrians $boards/watch/boresight.elf 10
# A picture framed by its own sides, and pans between two objects that no direction sees at once.
closed_loop objects $boards/objects/boresight.elf 16
[ "$(value mcu_step_max "$dir/objects.mcu")" -le 100800 ]
verdict "objects: a step takes at most 60 % of a millisecond at 168 MHz: $(value mcu_step_max "$dir/objects.mcu") instructions of 100800" $?
closed_loop hobby $boards/hobby/boresight.elf 12
[ "$(value trace_hash "$dir/hobby.mcu")" = "$(build/boresight sim host-sim/scenarios/hobby.ini --quiet --mcu $boards/hobby/boresight.elf |
    awk '$1 == "trace_hash" { print $2 }')" ]
verdict 'the same run again is the same, bit for bit' $?

# An image whose arithmetic differs in one bit (of the sine's terms) is caught by the comparison of every step.
# Where the table lies in the file: its address is an offset into .text, which begins somewhere in the file.
table=$(arm-none-eabi-nm $boards/boresight.elf | awk '$3 == "trig_sin_terms" { print $1 }')
text=$(arm-none-eabi-objdump -h $boards/boresight.elf | awk -v table="$table" '
    $4 ~ /^08/ && ($4 "") <= (table "") { address = $4; offset = $6 }
    END { print address, offset }')
at=$((0x$table - 0x${text% *} + 0x${text#* } + 5))
cp $boards/boresight.elf "$dir/planted.elf"
byte=$(od -An -tu1 -j $at -N 1 "$dir/planted.elf")
printf "\\$(printf %o $((byte ^ 64)))" | dd of="$dir/planted.elf" bs=1 seek=$at conv=notrunc 2>/dev/null
build/boresight sim host-sim/scenarios/stars.ini --quiet --seconds 7 --mcu "$dir/planted.elf" >"$dir/out" 2>"$dir/said"
caught 'an image with one wrong bit in a table' $?
grep -q 'I5' "$dir/said"
verdict 'and it is named' $?
sed 's/^/    /' "$dir/said"

refused() { # NAME STATUS PATTERN ARGUMENTS...
    name=$1 wanted=$2 pattern=$3
    shift 3
    build/boresight sim "$@" >/dev/null 2>"$dir/said"
    [ $? -eq "$wanted" ] && grep -q "$pattern" "$dir/said"
    result=$?
    [ $result -eq 0 ] || cat "$dir/said"
    verdict "$name" $result
}
stars=host-sim/scenarios/stars.ini
refused 'an image for another rig' 2 "hobby/boresight.elf: is built for another rig: its '[a-z]*' differs" \
    $stars --mcu $boards/hobby/boresight.elf
refused 'no image' 2 'none.elf: No such file' $stars --mcu "$dir/none.elf"
refused 'a file that is no image' 2 'README.md: ' $stars --mcu README.md
refused 'a fault that does not exist' 2 'no fault of that name; there are: .*can-unplugged' \
    $stars --mcu $boards/boresight.elf --mcu-faults can-eaten@1
refused 'faults without an image' 2 'belong to --mcu' $stars --mcu-faults storm@1
# Without a symbol table nobody could tell where the controller is.
arm-none-eabi-strip -o "$dir/stripped.elf" $boards/boresight.elf
refused 'a stripped image' 2 'stripped' $stars --mcu "$dir/stripped.elf"
rm -r "$dir"
exit $status
