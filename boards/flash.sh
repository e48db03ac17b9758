#!/bin/sh
# Usage: flash.sh BOARD IMAGE WAY...   Writes IMAGE.elf, .bin or .uf2 to the board in the first way that works: what it needs must be
# connected and its tool installed. Says which and why. The ways are those of board.mk (boards/README.md). Exit status: the tool's; 4 if
# nothing is connected or no tool is there.
. "${0%/*}/probe.sh"
board=$1
image=$2
shift 2

missing=
use() { # TOOL WHY COMMAND...
    tool=$1
    why=$2
    shift 2
    if installed "$tool"; then
        echo "flash: with $tool, because $why"
        echo "flash: $*"
        exec "$@"
    fi
    missing="$missing
flash: $why, but $tool is not installed: apt install ${package:-$tool}"
}

for way in "$@"; do
    tool=${way%%=*}
    value=${way#*=}
    package=$tool
    case $tool in
    openocd)
        find_probe && use openocd "$probe is connected" \
            openocd -f "$interface" -f "$value" -c "program $image.elf verify reset exit"
        ;;
    st-flash)
        package=stlink-tools
        find_probe && [ "$interface" = interface/stlink.cfg ] && use st-flash "$probe is connected" \
            st-flash --reset write "$image.bin" "$value"
        ;;
    dfu-util)
        usb_devices | grep -qi "^${value%,*} " && use dfu-util "the board's own boot loader is connected by USB (${value%,*})" \
            dfu-util -a 0 -d "${value%,*}" -s "${value#*,}:leave" -D "$image.bin"
        ;;
    stm32flash)
        [ -n "${PORT:-}" ] && use stm32flash "PORT=$PORT names a serial port" \
            stm32flash -w "$image.bin" -v -g "$value" "$PORT"
        ;;
    uf2)
        drive=$(awk -v label="$value" '{ n = split($2, part, "/") } part[n] == label { print $2 }' "$MOUNTS" | head -n 1)
        [ -n "$drive" ] && [ -e "$drive/INFO_UF2.TXT" ] && use cp "the board's drive $value is mounted at $drive" \
            cp "$image.uf2" "$drive/"
        ;;
    *)
        echo "flash: $board: unknown way '$way' in board.mk" >&2
        exit 2
        ;;
    esac
done

if [ -n "$missing" ]; then
    echo "${missing#?}" >&2
    exit 4
fi
echo "flash: no $board is connected. Connect one of these, then try again:" >&2
for way in "$@"; do
    value=${way#*=}
    case $way in
    openocd=*) echo '  - a debug probe (ST-Link or CMSIS-DAP): SWDIO, SWCLK, GND and the 3.3 V reference' ;;
    st-flash=*) ;;
    dfu-util=*) echo "  - its USB plug, after a reset with BOOT0 high: it then shows up as ${value%,*}" ;;
    stm32flash=*) echo '  - its first serial port, after a reset with BOOT0 high, with PORT=/dev/ttyUSB0 (or whatever it is) after make' ;;
    uf2=*) echo "  - its USB plug, with the BOOT button held: a drive $value appears; mount it" ;;
    esac
done >&2
exit 4
