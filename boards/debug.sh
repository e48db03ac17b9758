#!/bin/sh
# Usage: debug.sh ELF TARGET.cfg   gdb on the board that is connected, through openocd. Exit status 4 if something is missing.
. "${0%/*}/probe.sh"
elf=$1
target=$2
for gdb in gdb-multiarch arm-none-eabi-gdb; do
    installed $gdb && break
    gdb=
done
if [ -z "$gdb" ]; then
    echo 'debug: no gdb for ARM is installed: apt install gdb-multiarch' >&2
    exit 4
fi
if ! installed openocd; then
    echo 'debug: openocd is not installed: apt install openocd' >&2
    exit 4
fi
if ! find_probe; then
    echo 'debug: connect a debug probe (ST-Link or CMSIS-DAP): SWDIO, SWCLK, GND and the 3.3 V reference' >&2
    exit 4
fi
echo "debug: $gdb through openocd, because $probe is connected; its messages are in build/openocd.log"
exec $gdb -q "$elf" \
    -ex "target extended-remote | openocd -f $interface -f $target -c 'gdb_port pipe; log_output build/openocd.log'" \
    -ex 'monitor reset halt' -ex 'thbreak main' -ex 'continue'
