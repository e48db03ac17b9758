#!/bin/sh
# The instructions of a narrowest cone of ten points (tests/mcu/tick/ten.c), without a floating-point unit: on x86-64, counted by
# callgrind if it is there, at most 3,000; and on a Cortex-M4 and M0+, counted in QEMU.
. tests/gate/verdict.sh

count() { # MACHINE ELF [ICOUNT]
    timeout 100 qemu-system-arm -M "$1" -display none -monitor none -serial none ${3:--icount shift=10,sleep=off} \
        -semihosting-config enable=on,target=native -kernel "$2" </dev/null 2>&1
}
within() { # PROCESSOR LIMIT COUNTS
    printf '%s\n' "$3" | awk -v processor="$1" -v limit="$2" '
        $1 != "cone" { print "# " $0; wrong = 1; next }
        { counted++; printf "MEASURED cone of %d points, %s: %d instructions; allowed: %d\n", $2, processor, $3, limit }
        $3 > limit || $3 < 500 { wrong = 1 }
        END { exit wrong || counted != 1 }'
}

m4=$(count mps2-an386 build/cortex-m4/mps2/tests/mcu/tick/ten.elf)
within 'Cortex-M4' 4000 "$m4"
verdict 'ten points on a Cortex-M4' $?
within 'Cortex-M0+' 23000 "$(count mps2-an385 build/cortex-m0plus/mps2/tests/mcu/tick/ten.elf)"
verdict 'ten points on a Cortex-M0+' $?

if command -v valgrind >/dev/null 2>&1; then
    dir=$(mktemp -d)
    valgrind --tool=callgrind --toggle-collect=cone_narrowest --callgrind-out-file="$dir/out" build/gcc/tests/mcu/tick/ten >"$dir/said" 2>&1
    x86=$(awk '/^solved/ { sets = $2 } /Collected/ { sum = $NF } END { if (sets && sum) printf "cone 10 %d\n", sum / sets }' "$dir/said")
    within 'x86-64' 3000 "$x86"
    verdict 'ten points on x86-64' $?
    rm -r "$dir"
else
    echo 'SKIP ten points on x86-64: no valgrind to count with'
fi

within 'planted' 6000 'cone 10 6001' >/dev/null
caught 'a cone that costs too much' $?
within 'planted' 6000 "$(count mps2-an386 build/cortex-m4/mps2/tests/mcu/tick/ten.elf ' ')" >/dev/null
caught 'an emulator that does not count' $?
within 'planted' 6000 '' >/dev/null
caught 'no count at all' $?
exit $status
