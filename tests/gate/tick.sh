#!/bin/sh
# The instructions of a control tick with 256 targets that are re-aimed in each tick (tests/mcu/tick/tick.c), counted in QEMU, against 60 % of
# a millisecond at 168 MHz. Instructions, not cycles: on a Cortex-M4 most take one, loads and taken branches two or three.
. tests/gate/verdict.sh
tick_cycles=168000
percent=60
unit_percent=4 # of a unit of looking at what hides targets (firmware/target/occlusion.h)

count() { # ELF [ICOUNT]
    exec timeout 100 qemu-system-arm -M mps2-an386 -display none -monitor none -serial none ${2:--icount shift=10,sleep=off} \
        -semihosting-config enable=on,target=native -kernel "$1" </dev/null 2>&1
}
# Ends with 1 if a scene is missing or costs too much. Those without a limit are shown only.
within() { # COUNTS
    printf '%s\n' "$1" | awk -v cycles=$tick_cycles -v percent=$percent -v unit=$unit_percent '
        BEGIN { split("crowd wide narrow ring radii burst jumps hard rect rect-radii rect-above rect-jumps rect-hard rect-rest pan pan-hard pan-rect pan-rect-hard hidden hidden-hard hidden-rect look-unit", name, " "); for (i in name) wanted[name[i]] = 1 }
        $1 != "tick" { print "# " $0; wrong = 1; next }
        {
            part = 100 * $3 / cycles
            most = $2 == "look-unit" ? unit : percent
            printf "MEASURED tick, %-13s %7d instructions, %3d %% of a millisecond at 168 MHz%s\n", $2, $3, part,
                ($2 in wanted) ? "; allowed: " most " %" : ""
            if (($2 in wanted) && (part > most || $3 < 1000)) wrong = 1
            delete wanted[$2]
        }
        END { for (i in wanted) { print "# " i ": not counted"; wrong = 1 } exit wrong }'
}
counts=$(count build/mcu/tick/tick.elf)
within "$counts"
verdict "a control tick with 256 targets takes at most $percent % of a millisecond at 168 MHz" $?

# Planted: an aim that costs too much, an emulator that does not count, an image that says nothing, one scene less.
dir=$(mktemp -d)
count build/mcu/tick/planted.elf >"$dir/planted" &
tries=0
while [ $tries -lt 600 ] && ! grep -q '^tick ' "$dir/planted"; do sleep 0.1; tries=$((tries + 1)); done
kill $! 2>/dev/null
wait $! 2>/dev/null
planted=$(head -n 1 "$dir/planted")
rm -r "$dir"
case $planted in
'tick crowd '*) within "$(printf '%s\n' "$counts" | sed "s/^tick crowd .*/$planted/")" >/dev/null ;;
*) echo "$planted"; (exit 9) ;;
esac
caught 'an aim that is worked out eight times a tick' $?
within "$(count build/mcu/tick/tick.elf ' ')" >/dev/null
caught 'an emulator that does not count' $?
within '' >/dev/null
caught 'no count at all' $?
within "$(printf '%s\n' "$counts" | grep -v ' ring ')" >/dev/null
caught 'a scene that is left out' $?
exit $status
