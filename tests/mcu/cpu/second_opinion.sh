#!/bin/sh
# The same program says the same on the emulated board and on another emulator's processor, QEMU's netduinoplus2: what we expect
# of exceptions is not only our reading of the manual.
. tests/gate/verdict.sh
dir=$(mktemp -d)
other() { # ELF OUT: what it says in QEMU until it says `end`, for 20 seconds at most
    : >"$2"
    qemu-system-arm -M netduinoplus2 -nographic -monitor none -serial "file:$2" -kernel "$1" </dev/null >/dev/null 2>&1 &
    qemu=$!
    tries=0
    while [ $tries -lt 200 ] && ! grep -q '^end$' "$2"; do
        sleep 0.1
        tries=$((tries + 1))
    done
    kill $qemu 2>/dev/null
    wait $qemu 2>/dev/null
}
build/gcc/tests/mcu/cpu/exceptions build/guest/exceptions.elf >"$dir/ours"
other build/guest/exceptions.elf "$dir/other"
grep -q '^end$' "$dir/other" && [ "$(grep -c ' ok$' "$dir/other")" -eq 35 ]
verdict 'QEMU says what we expect of exceptions' $?
diff "$dir/other" "$dir/ours"
verdict 'and so does the emulated board' $?
sed 's/^svc keeps the flags ok$/svc keeps the flags: 0, not a0000000/' "$dir/ours" >"$dir/planted"
diff "$dir/other" "$dir/planted" >/dev/null
caught 'a program that says something else' $?
rm -r "$dir"
exit $status
