#!/bin/sh
# `make flash` and `make debug` as far as they go without a board: what is connected and what is installed decides. The tools are
# stand-ins that print their arguments.
. tests/gate/verdict.sh
dir=$(mktemp -d)
mkdir "$dir/usb" "$dir/tools" "$dir/none"
: >"$dir/mounts"
# The scripts see only these commands.
for tool in cat grep head awk sh; do ln -s "$(command -v $tool)" "$dir/tools/$tool"; done
ways='openocd=target/x.cfg st-flash=0x08000000 dfu-util=0483:df11,0x08000000 stm32flash=0x08000000 uf2=RPI-RP2'

install() { for tool in "$@"; do printf '#!/bin/sh\necho "ran %s $*"\n' "$tool" >"$dir/tools/$tool"; chmod +x "$dir/tools/$tool"; done; }
remove() { for tool in "$@"; do rm -f "$dir/tools/$tool"; done; }
plug() { mkdir -p "$dir/usb/1-1"; echo "${1%:*}" >"$dir/usb/1-1/idVendor"; echo "${1#*:}" >"$dir/usb/1-1/idProduct"; echo "$2" >"$dir/usb/1-1/product"; }
unplug() { rm -rf "$dir/usb/1-1"; }
# NAME STATUS PATTERN COMMAND...
expect() {
    name=$1 wanted=$2 pattern=$3
    shift 3
    said=$(PATH="$dir/tools" SYS_USB="$dir/usb" MOUNTS="$dir/mounts" "$@" 2>&1)
    [ $? -eq "$wanted" ] && printf '%s\n' "$said" | grep -qE "$pattern"
    result=$?
    [ $result -eq 0 ] || printf '%s\n' "$said"
    verdict "$name" $result
}
flash() { expect "$1" "$2" "$3" env ${port:+PORT="$port"} sh boards/flash.sh x image $ways; }
ln -s "$(command -v env)" "$dir/tools/env"

flash 'nothing connected: says what to connect' 4 'no x is connected'
flash 'nothing connected: names the boot loader' 4 '0483:df11'
plug 0483:374b 'STM32 STLink'
flash 'a probe without a tool: says what to install' 4 'openocd is not installed: apt install openocd'
install st-flash
flash 'the next tool for the same probe' 0 'ran st-flash --reset write image.bin 0x08000000'
install openocd
flash 'the best tool for the probe' 0 'ran openocd -f interface/stlink.cfg -f target/x.cfg -c program image.elf'
flash 'and why' 0 'with openocd, because an ST-Link is connected'
plug 2e8a:000c 'Debug Probe (CMSIS-DAP)'
flash 'another probe' 0 'ran openocd -f interface/cmsis-dap.cfg'
remove openocd
flash 'st-flash is for ST-Links only' 4 'a CMSIS-DAP probe is connected, but openocd is not installed'
plug 0483:df11 'STM32  BOOTLOADER'
install dfu-util openocd
flash 'the boot loader on USB' 0 'ran dfu-util -a 0 -d 0483:df11 -s 0x08000000:leave -D image.bin'
unplug
install stm32flash
port=/dev/ttyUSB9
flash 'a serial port, when it is named' 0 'ran stm32flash -w image.bin -v -g 0x08000000 /dev/ttyUSB9'
port=
flash 'but never unasked' 4 'PORT='
mkdir "$dir/RPI-RP2"
echo "/dev/sdx1 $dir/RPI-RP2 vfat rw 0 0" >"$dir/mounts"
install cp
flash 'a drive without the mark of a boot loader' 4 'no x is connected'
: >"$dir/RPI-RP2/INFO_UF2.TXT"
flash 'a mounted drive' 0 "ran cp image.uf2 $dir/RPI-RP2/"
expect 'a way that is none' 2 'unknown way' sh boards/flash.sh x image floppy=1

debug() { expect "$1" "$2" "$3" sh boards/debug.sh x.elf target/x.cfg; }
remove openocd
debug 'debug without gdb' 4 'apt install gdb-multiarch'
install gdb-multiarch
debug 'debug without openocd' 4 'apt install openocd'
install openocd
debug 'debug without a probe' 4 'connect a debug probe'
plug 0483:3748 'STM32 STLink'
debug 'debug' 0 'ran gdb-multiarch -q x.elf -ex target extended-remote . openocd -f interface/stlink.cfg -f target/x.cfg'
(expect 'an expectation' 0 'ran gdb' true) | grep -q '^FAIL'
verdict 'an expectation that is not met is a failure' $?
for target in firmware flash debug; do
    said=$(make -s --no-print-directory $target BOARD=toaster 2>&1)
    [ $? -eq 2 ] && printf '%s\n' "$said" | grep -q '^Which board? BOARD=NAME, one of: .*stm32f405'
    verdict "make $target of a board that is none says which there are" $?
done
said=$(make -s --no-print-directory firmware BOARD=stm32f405 RIG="$dir/none.ini" 2>&1)
[ $? -eq 2 ] && printf '%s\n' "$said" | grep -qx "RIG=$dir/none.ini: no such file"
verdict 'make firmware of a rig that is none says so' $?
rm -r "$dir"
exit $status
