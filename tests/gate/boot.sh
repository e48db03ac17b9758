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

# What it set its devices to, as the emulator's models have it: read through the monitor when it has said all.
registers() { # ADDRESS...
    {
        tries=0
        while [ $tries -lt 200 ] && ! grep -q 'will not arm' "$dir/registers" 2>/dev/null; do sleep 0.1; tries=$((tries + 1)); done
        for address in "$@"; do echo "xp /1wx $address"; done
        echo quit
    } | timeout 60 qemu-system-arm -M netduinoplus2 -nographic -monitor stdio -serial "file:$dir/registers" -kernel "$elf" 2>"$dir/registers.err" |
        tr -d '\r' | sed -n 's/^0*\([0-9a-f]\{8\}\): \(0x[0-9a-f]*\)$/\1 \2/p' >"$dir/values"
}
# RM0090 30.3.4, 18.4: USART_BRR is clock / baud; a timer counts (PSC + 1) clocks a step and ARR + 1 steps a period.
registers 0x40011008 0x40000428 0x4000042c 0x40000434
brr=$(awk '$1 == "40011008" { print $2 }' "$dir/values")
echo "# USART1 BRR $brr"
[ -n "$brr" ] && [ $((brr)) -gt 0 ] && [ $((16000000 / (brr) * 200)) -gt $((115200 * 198)) ] && [ $((16000000 / (brr) * 200)) -lt $((115200 * 202)) ]
verdict 'on 16 MHz the console has its 115200 baud, within 1 %' $?
psc=$(awk '$1 == "40000428" { print $2 }' "$dir/values") arr=$(awk '$1 == "4000042c" { print $2 }' "$dir/values")
echo "# TIM3 PSC $psc ARR $arr"
[ -n "$psc" ] && [ -n "$arr" ] && [ $(((psc + 1) * (arr + 1))) -eq 320000 ]
verdict 'and the servos their period of 20 ms' $?
[ "$(awk '$1 == "40000434" { print $2 }' "$dir/values")" = 0x00000000 ]
verdict 'but no pulses' $?

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
