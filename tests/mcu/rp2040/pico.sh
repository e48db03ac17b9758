#!/bin/sh
# The image of the Raspberry Pi Pico, from its UF2 file, in the emulator rp2040js; its pulses on the simulator's servos.
# SKIPped by name where the emulator can't be had.
. tests/gate/verdict.sh
board=build/boards/pico
tools=build/rp2040js
lock=tests/mcu/rp2040/package-lock.json
skip() { echo "SKIP rp2040: $1"; exit 0; }

command -v node >/dev/null 2>&1 || skip 'no node'
node -e 'process.exit(Number(process.versions.node.split(".")[0]) >= 18 ? 0 : 1)' || skip 'node is older than 18'
if ! cmp -s "$lock" "$tools/installed.json"; then
    command -v npm >/dev/null 2>&1 || skip 'no npm'
    mkdir -p "$tools"
    cp tests/mcu/rp2040/package.json "$lock" "$tools"
    (cd "$tools" && npm ci --ignore-scripts --no-audit --no-fund) >"$tools/npm.log" 2>&1 || skip "the emulator could not be installed ($tools/npm.log)"
    cp "$lock" "$tools/installed.json"
fi

dir=$(mktemp -d)
trap 'rm -r "$dir"' EXIT
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
node tests/mcu/rp2040/run.mjs "$board/boresight.uf2" "$id" "$dir/trace" || status=1
build/gcc/tests/mcu/rp2040/plant "$dir/trace" || status=1

# What must not pass: a pulse that the servos would not see, and an image that the ROM would not start.
awk '$1 != "edge" || $3 != 1' "$dir/trace" >"$dir/silent"
build/gcc/tests/mcu/rp2040/plant "$dir/silent" | sed 's/^FAIL/caught/' >"$dir/said"
grep -q '^caught' "$dir/said"
verdict 'rp2040: a servo without pulses is noticed' $?
{ head -c 5 "$board/boresight.bin"; printf 'x'; tail -c +7 "$board/boresight.bin"; } >"$dir/x.bin"
"$board/uf2-writer" "$dir/x.bin" "$dir/x.uf2" 2>/dev/null
caught 'rp2040: a second stage with a wrong sum, by the UF2 writer' $?
exit $status
