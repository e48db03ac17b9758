#!/bin/sh
# The STM32F405 image starts in QEMU's netduinoplus2. There the clock registers always read 0, so this is a board whose crystal does not
# oscillate: it must give up waiting, stay on its internal oscillator, say so, never arm, and keep its time.
. tests/gate/verdict.sh
elf=build/boards/stm32f405/boresight.elf
dir=$(mktemp -d)

# What the image says until it has said the line wanted, or for 20 seconds at most.
boot() { # ELF WANTED OUT
    qemu-system-arm -M netduinoplus2 -nographic -monitor none -serial "file:$3" -kernel "$1" </dev/null >/dev/null 2>"$3.err" &
    qemu=$!
    tries=0
    while [ $tries -lt 200 ] && ! grep -qE "$2" "$3" 2>/dev/null; do
        kill -0 $qemu 2>/dev/null || break
        sleep 0.1
        tries=$((tries + 1))
    done
    kill $qemu 2>/dev/null
    wait $qemu 2>/dev/null
    tr -d '\r' <"$3" >"$3.text"
}
has() { # NAME PATTERN FILE
    grep -qE "$2" "$3"
    result=$?
    [ $result -eq 0 ] || sed 's/^/    /' "$3"
    verdict "$1" $result
}

boot "$elf" '^ +3 s ' "$dir/out"
sed 's/^/# /' "$dir/out.text"
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
has 'the greeting has the build id' "^boresight $id$" "$dir/out.text"
has 'it names the board' '^board: stm32f405$' "$dir/out.text"
has 'without a crystal it stays on 16 MHz and says why' '^clock: 16 MHz, the crystal does not oscillate$' "$dir/out.text"
has 'it tells why it started' '^reset: ' "$dir/out.text"
has 'it says that it will not arm, and why' '^will not arm: the crystal does not oscillate$' "$dir/out.text"
has 'it keeps off the bus and waits for its drives' '^ +3 s  starting .* can off .* held: the crystal does not oscillate$' "$dir/out.text"
[ "$(grep -c '^ *[0-9]* s ' "$dir/out.text")" -ge 3 ] &&
    [ "$(sed -n 's/^ *\([0-9]*\) s .*/\1/p' "$dir/out.text" | awk '$1 != NR { exit 1 }'; echo $?)" = 0 ]
verdict 'a status line a second, none left out' $?

# The checks read what the image says: with other words, or with none, they fail.
LC_ALL=C sed 's/will not arm/may well arm/' "$elf" >"$dir/planted.elf"
boot "$dir/planted.elf" '^ +1 s ' "$dir/planted"
(has 'planted' '^will not arm: ' "$dir/planted.text") | grep -q '^ok'
caught 'an image that says something else' $?
: >"$dir/none.elf"
boot "$dir/none.elf" '^ +1 s ' "$dir/none"
(has 'planted' '^boresight ' "$dir/none.text") | grep -q '^ok'
caught 'an image that does not start' $?
rm -r "$dir"
exit $status
