#!/bin/sh
# The layouts of the controller's structures (host-sim/replay/layout.h) are what both compilers make of them.
. tests/gate/verdict.sh
dir=$(mktemp -d)
flags='-std=c11 -Ifirmware -Ihal/include -fsyntax-only'
host() { gcc $flags "$1" 2>&1; }
arm() { arm-none-eabi-gcc $flags -ffreestanding -mcpu=cortex-m4 -mthumb -mfloat-abi=soft "$1" 2>&1; }
for kind in host arm; do
    build/gcc/tests/mcu/layout $kind >"$dir/$kind.c"
    $kind "$dir/$kind.c" >"$dir/said" && [ "$(grep -c '^_Static_assert' "$dir/$kind.c")" -gt 80 ]
    result=$?
    head -n 5 "$dir/said"
    verdict "layouts on $kind (host-sim/replay/layout.c lists the fields)" $result
done
arm "$dir/host.c" >/dev/null
caught 'the layout of another processor' $?
# A field that the description does not know makes the size wrong.
sed 's/\(sizeof(struct controller_config) == \)[0-9]*U/\14U/' "$dir/arm.c" >"$dir/more.c"
arm "$dir/more.c" >/dev/null
caught 'a wrong size' $?
rm -r "$dir"
exit $status
