#!/bin/sh
# Usage: run.sh GROUP...   Runs groups of tests (tests/vm/guest/GROUP.sh) in a virtual machine with a real kernel and prints
# their verdicts. Where there is no emulator or no kernel, every group is skipped by name.
set -u
skip_all() {
    for group in $groups; do echo "SKIP vm.$group: $1"; done
    exit 0
}
groups=$*
# The group `pi` runs alone, in a machine with the processor of a Raspberry Pi.
case $groups in
pi) architecture=arm64 tools='qemu-system-aarch64 cpio modprobe aarch64-linux-gnu-gcc' ;;
*) architecture=amd64 tools='qemu-system-x86_64 busybox cpio modprobe candump gpioset i2cget' ;;
esac
for tool in $tools; do
    PATH=$PATH:/sbin:/usr/sbin command -v "$tool" >/dev/null 2>&1 || skip_all "no $tool here (.ci/need vm)"
done
why=$(mktemp)
kernel=$(sh tests/vm/kernel.sh $architecture 2>"$why") || {
    [ $? -eq 3 ] || { cat "$why"; echo "FAIL vm.kernel"; exit 1; }
    skip_all "$(cat "$why")"
}
rm -f "$why"
out=build/vm/$(echo "$groups" | tr " " "+")
mkdir -p "$out"
sh tests/vm/initramfs.sh "$kernel" "$out/initramfs.cpio" || { echo "FAIL vm.initramfs"; exit 1; }

share() { echo "-fsdev local,id=$1,path=$2,security_model=none,readonly=on,multidevs=remap -device virtio-9p-pci,fsdev=$1,mount_tag=$1"; }
emulate() { # PROGRAM CONSOLE OPTION...
    program=$1 console=$2
    shift 2
    # shellcheck disable=SC2046
    timeout -k 5 "${VM_TIMEOUT:-900}" "$program" -accel "${VM_ACCEL:-tcg}" -smp 2 -m 768 -nodefaults -no-user-config -display none \
        -no-reboot -rtc base=utc -monitor none -serial "file:$out/console.log" -kernel "$kernel/vmlinux" -initrd "$out/initramfs.cpio" \
        -append "console=$console quiet panic=-1 nokaslr mitigations=off vm.groups=$(echo "$groups" | tr ' ' ',')" \
        $(share host "$root") $(share repository "$PWD") $(share kernel "$kernel") "$@" 2>"$out/qemu.log"
}
# The results come over a serial port of their own, apart from what the kernel says.
case $architecture in
amd64)
    # Two USB serial adapters, each at the other's end of a cable (a socket of this machine's with itself). In the group `board`
    # there is a board instead, emulated here: its real image, and the simulator's gimbal on its CAN bus.
    cable="-chardev socket,id=tty0,path=$out/cable,server=on,wait=off -chardev socket,id=tty1,path=$out/cable
        -device usb-serial,chardev=tty0,always-plugged=on -device usb-serial,chardev=tty1,always-plugged=on"
    if [ "$groups" = board ]; then
        elf=build/boards/stm32f405/boresight.elf
        { [ -e $elf ] && [ -e build/boresight-mcu ]; } || skip_all 'no image or no emulator of it here (.ci/need check)'
        cp host-sim/rigs/studio.ini "$out/rig.ini"
        printf '[scenario]\nname = Line\nrig = rig.ini\nseconds = 3000\narm = no\n' >"$out/idle.ini"
        rm -f "$out/board"
        build/boresight-mcu sim "$out/idle.ini" --speed 1 --quiet --json --mcu $elf --mcu-serial "$out/board" >"$out/board.json" 2>"$out/board.err" &
        board=$!
        trap 'kill $board 2>/dev/null' EXIT
        . tests/until_true.sh
        until_true 30 test -e "$out/board" || { cat "$out/board.err"; echo "FAIL vm.board.emulator"; exit 1; }
        cable="-chardev serial,id=tty0,path=$out/board -device usb-serial,chardev=tty0,always-plugged=on"
    fi
    # Two CAN cards on one bus and one alone. no_timer_check: on a busy host the kernel sees no tick in time at its boot, and panics.
    root=/ well=65
    # shellcheck disable=SC2086
    emulate qemu-system-x86_64 'ttyS0 tsc=unstable no_timer_check vm.results=ttyS1' -machine q35 -cpu max \
        -serial "file:$out/results.log" -device isa-debug-exit,iobase=0xf4,iosize=0x1 \
        -device qemu-xhci $cable \
        -object can-bus,id=bus0 -device kvaser_pci,canbus=bus0 -device kvaser_pci,canbus=bus0 \
        -object can-bus,id=bus1 -device kvaser_pci,canbus=bus1
    ;;
arm64)
    # The processor of a Raspberry Pi 4, on QEMU's own board.
    root=$(sh boards/linux/cross/sysroot.sh aarch64-linux-gnu 2>"$out/why") || skip_all "$(tail -n 1 "$out/why")"
    well=0
    env -u MAKEFLAGS -u MAKELEVEL make -s -j2 CROSS=aarch64-linux-gnu- "SYSROOT=$root" build/aarch64-linux-gnu/boresight >"$out/build.log" 2>&1 || {
        tail -n 20 "$out/build.log"
        echo "FAIL vm.pi.builds"
        exit 1
    }
    emulate qemu-system-aarch64 'ttyAMA0 vm.results=ttyS0 vm.libraries' -machine virt -cpu cortex-a72 \
        -chardev "file,id=results,path=$out/results.log" -device pci-serial,chardev=results
    ;;
esac
status=$?
tr -d '\r' <"$out/results.log"
if [ $status -ne $well ] || ! grep -q '^# done' "$out/results.log"; then
    tail -n 20 "$out/qemu.log" "$out/console.log"
    echo "FAIL vm.machine ended with status $status"
    exit 1
fi
! grep -q '^FAIL ' "$out/results.log"
