# What is plugged in, for flash.sh and debug.sh. Sourced, not run.
# SYS_USB, MOUNTS: where the kernel tells; the tests put something else there.
: "${SYS_USB:=/sys/bus/usb/devices}" "${MOUNTS:=/proc/mounts}"

# One line a USB device: VENDOR:PRODUCT NAME
usb_devices() {
    for device in "$SYS_USB"/*; do
        [ -r "$device/idVendor" ] && [ -r "$device/idProduct" ] || continue
        echo "$(cat "$device/idVendor"):$(cat "$device/idProduct") $(cat "$device/product" 2>/dev/null)"
    done
}

# A debug probe: sets probe (a name for people) and interface (openocd's file for it). Fails if there is none.
find_probe() {
    line=$(usb_devices | grep -iE '^0483:(3744|3748|374b|374d|374e|374f|3752|3753|3754) ' | head -n 1)
    if [ -n "$line" ]; then
        probe="an ST-Link" interface=interface/stlink.cfg
        return 0
    fi
    line=$(usb_devices | grep -iE '^(2e8a:000c|0d28:0204) |CMSIS-DAP' | head -n 1)
    if [ -n "$line" ]; then
        probe="a CMSIS-DAP probe" interface=interface/cmsis-dap.cfg
        return 0
    fi
    return 1
}

installed() { command -v "$1" >/dev/null 2>&1; }
