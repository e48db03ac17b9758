#!/bin/sh
# Flash of each folder of firmware/ for both cores, and RAM of the large objects.
printf '%-12s %14s %14s\n' 'flash, bytes' cortex-m0plus cortex-m4
for folder in $(ls firmware); do
    [ -n "$(find build/cortex-m4/firmware/"$folder" -name '*.o' 2>/dev/null)" ] || continue
    for core in cortex-m0plus cortex-m4; do
        arm-none-eabi-size build/$core/firmware/"$folder"/*.o | awk 'NR > 1 { n += $1 + $2 } END { printf "%d ", n }'
    done | awk -v folder="$folder" '{ printf "%-12s %14d %14d\n", folder, $1, $2 }'
done | awk '{ print; a += $2; b += $3 } END { printf "%-12s %14d %14d\n", "all", a, b }'
echo
printf '%-24s %12s\n' 'RAM, bytes' cortex-m
for object in 'struct controller' 'struct pump'; do
    printf '%-24s %12d\n' "$object" "$(tests/gate/check/ram.sh "$object")"
done
