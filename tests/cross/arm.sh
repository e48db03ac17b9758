#!/bin/sh
# Usage: arm.sh TARGET   The program for ARM Linux (`make CROSS=TARGET-`), under QEMU's emulation of its processor: it builds, every module gives
# the same digest as here, and whole closed loops the same trace, plant and all. Where the compiler, the emulator or the libraries can't be had,
# it is skipped by name.
. tests/gate/verdict.sh
target=$1
skip() {
    echo "SKIP arm.$target: $1"
    exit 0
}
case $target in
aarch64-*) emulator=qemu-aarch64 ;;
arm-*) emulator=qemu-arm ;;
esac
for tool in "$target-gcc" $emulator; do
    command -v "$tool" >/dev/null 2>&1 || skip "no $tool here (.ci/need cross)"
done
dir=$(mktemp -d)
trap 'rm -r "$dir"' EXIT
sysroot=$(sh boards/linux/cross/sysroot.sh "$target" 2>"$dir/why") || skip "$(tail -n 1 "$dir/why")"

out=build/$target
programs=$out/gcc/tests/property/u128
for source in tests/mcu/digest/*.c; do
    programs="$programs $out/gcc/${source%.c}"
done
# shellcheck disable=SC2086
${MAKE:-make} --no-print-directory "CROSS=$target-" "SYSROOT=$sysroot" "$out/boresight" $programs >"$dir/log" 2>&1
built=$?
[ $built -eq 0 ] || tail -n 30 "$dir/log"
verdict "$target: the program builds" $built
[ $built -eq 0 ] || exit 1
emulate() { $emulator -L "$sysroot" "$@"; }

# What `--version` tells of a program for that machine, with every library.
case $target in aarch64-*) bits=64 ;; *) bits=32 ;; esac
emulate "$out/boresight" --version >"$dir/version"
awk -v bits=$bits '$1 == "pointer_bits" { good = $2 == bits } /^libraries/ && !/no lib/ && !/no cairo/ { all = 1 } END { exit !(good && all) }' "$dir/version"
verdict "$target: it has $bits bits and all libraries" $?

# ---------------------------------------------------------------- the same bits
same() { # NAME HERE THERE
    cmp -s "$2" "$3" && [ -s "$2" ]
    same_status=$?
    [ $same_status -eq 0 ] || diff "$2" "$3" | head -n 10
    verdict "$target: $1: the same bits" $same_status
}
digests() { grep '^# digest '; }
for source in tests/mcu/digest/*.c; do
    program=gcc/${source%.c}
    "build/$program" | digests >"$dir/here"
    emulate "$out/$program" | digests >"$dir/there"
    same "digest $(basename "$source" .c)" "$dir/here" "$dir/there"
done
traces() { awk '$1 == "steps" || $1 == "trace_hash" { print }'; }
for scenario in camera:1 flight:3 hobby:12 moving:3 objects:3 obstacle:8 pedestrians:8 stars:3; do
    seconds=${scenario#*:} scenario=${scenario%:*}
    build/boresight sim host-sim/scenarios/$scenario.ini --quiet --seconds "$seconds" 2>/dev/null | traces >"$dir/here"
    emulate "$out/boresight" sim host-sim/scenarios/$scenario.ini --quiet --seconds "$seconds" 2>/dev/null | traces >"$dir/there"
    same "$scenario.ini, closed loop" "$dir/here" "$dir/there"
done
# Another seed: another trace, or the hash would be of nothing.
emulate "$out/boresight" sim host-sim/scenarios/moving.ini --quiet --seconds 3 --seed 99 2>/dev/null | traces >"$dir/there"
build/boresight sim host-sim/scenarios/moving.ini --quiet --seconds 3 2>/dev/null | traces >"$dir/here"
! cmp -s "$dir/here" "$dir/there"
verdict "$target: another seed gives another trace" $?

# ---------------------------------------------------------------- tests that run there as they are
in_emulator() { # COMMAND...: its verdicts, with the name of the target
    "$@" >"$dir/out" 2>&1 || grep -q '^FAIL' "$dir/out" || echo "FAIL $1 ended badly" >>"$dir/out"
    grep -qE '^(ok|FAIL|SKIP) ' "$dir/out" || echo "FAIL $1 says nothing" >>"$dir/out"
    sed -E "s/^(ok|FAIL|SKIP) /&$target: /" "$dir/out"
    ! grep -q '^FAIL' "$dir/out" || status=1
}
printf '#!/bin/sh\nexec %s -L "%s" "%s" "$@"\n' $emulator "$sysroot" "$PWD/$out/boresight" >"$out/emulated"
chmod +x "$out/emulated"
# (regular and solid expect digits that a long double of 53 bits has not.)
for script in aim pan plan rig_c step voronoi $([ $bits = 32 ] || echo regular solid); do
    in_emulator env "BORESIGHT=$out/emulated" sh tests/cli/$script.sh
done
in_emulator emulate "$out/gcc/tests/property/u128"
exit $status
