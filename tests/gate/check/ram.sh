#!/bin/sh
# Usage: ram.sh 'struct NAME'   Bytes of such an object on a Cortex-M.
dir=$(mktemp -d)
printf '#include "app/pump.h"\n%s object;\n' "$1" >"$dir/x.c"
arm-none-eabi-gcc -std=c11 -mcpu=cortex-m0plus -mthumb -ffreestanding -fno-common -Ifirmware -Ihal/include \
    -c "$dir/x.c" -o "$dir/x.o" && printf '%d\n' "0x$(arm-none-eabi-nm -S "$dir/x.o" | awk '$4 == "object" { print $2 }')"
rm -r "$dir"
