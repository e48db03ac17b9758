#!/bin/sh
# The layer rules, and violations planted to see that the gate catches them.
. tests/gate/verdict.sh
awk -f tests/gate/check/layers.awk $(find firmware hal -name '*.[ch]')
verdict layers $?

plant() { # NAME FILE LINE
    dir=$(mktemp -d)
    mkdir -p "$dir/$(dirname "$2")"
    printf '%s\n' "$3" >"$dir/$2"
    (cd "$dir" && awk -f "$OLDPWD/tests/gate/check/layers.awk" "$2") >/dev/null
    caught "$1" $?
    rm -r "$dir"
}
plant 'an upward include' firmware/sphere/x.c '#include "control/controller.h"'
plant 'the HAL below app/' firmware/control/x.c '#include "hal/can.h"'
plant 'libc in firmware/' firmware/fixed/x.c '#include <stdlib.h>'
plant 'a path with ..' firmware/fixed/x.h '#include "../app/pump.h"'
plant 'the controller in a HAL' hal/linux/x.c '#include "control/controller.h"'
plant 'a drive codec in the HAL headers' hal/include/hal/x.h '#include "drive/rmd.h"'
awk -f tests/gate/check/layers.awk </dev/null >/dev/null
caught 'a layer check of nothing' $?
exit $status
