#!/bin/sh
# Images that fail, each in its way: none may pass.
. tests/gate/verdict.sh
out=$(mktemp)
planted() { # NAME CORE MACHINE IMAGE PATTERN
    MPS2_SECONDS=5 sh tests/mcu/mps2/run.sh "$3" "build/$2/mps2/tests/mcu/mps2/plant/$4.elf" >"$out"
    grep -q '^FAIL ' "$out" && grep -q "$5" "$out"
    verdict "$1 on $2 is caught" $?
}
for core in cortex-m0plus:mps2-an385 cortex-m4:mps2-an386; do
    c=${core%:*} m=${core#*:}
    planted 'a failed check' "$c" "$m" wrong '2 \* 2 is 4, not 5'
    planted 'a call into nowhere' "$c" "$m" astray 'the processor faulted at'
    planted 'a stack that overflows' "$c" "$m" deep 'the stack overflowed'
    planted 'an image without a verdict' "$c" "$m" silent 'printed no verdict'
done
planted 'an image that hangs' cortex-m4 mps2-an386 hang 'exit status 124'
planted 'a word at an odd address' cortex-m0plus mps2-an385 misaligned 'the processor faulted at'
sh tests/mcu/mps2/run.sh mps2-an386 >/dev/null
caught 'a run of no images' $?
rm "$out"
exit $status
