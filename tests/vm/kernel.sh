#!/bin/sh
# Usage: kernel.sh ARCHITECTURE   Prints the folder that holds the virtual machine's kernel (amd64, arm64) and its modules;
# makes it first. For arm64 also what the machine has instead of the host's programs: busybox and candump.
# Everything comes from the distribution's packages, nothing is installed on the host. The folder is kept between
# builds (BORESIGHT_VM_CACHE, else ~/.cache/boresight-vm), one a kernel version. Exit status 3, after one line on stderr:
# the packages can't be had here.
set -u
cache=${BORESIGHT_VM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/boresight-vm}
cannot() {
    echo "$1" >&2
    exit 3
}
architecture=$1
. boards/linux/cross/apt.sh
apt_knows "$architecture" "linux-image-$architecture" || apt_update "$architecture" >/dev/null 2>&1
image=$(apt_for "$architecture" apt-cache depends "linux-image-$architecture" 2>/dev/null | awk '/Depends: linux-image-/ { print $2; exit }')
[ -n "$image" ] || cannot "no package linux-image-$architecture in the lists of apt"
version=${image#linux-image-}
source=linux-source-$(echo "$version" | cut -d. -f1,2)
# What is built here changes with this script, too.
made=$cache/$version-$(cksum <"$0" | cut -d' ' -f1)
if [ -e "$made/ready" ]; then
    echo "$made"
    exit 0
fi

headers=/usr/src/linux-headers-$version
more=$source
case $architecture in
amd64) [ -d "$headers" ] || cannot "no $headers (package linux-headers-$version)" ;;
*) more='busybox-static can-utils' ;;
esac
work=$cache/making.$$
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/modules" "$work/fetched"
# shellcheck disable=SC2086
(cd "$work/fetched" && apt_fetch "$architecture" $image $more) >"$work/log" 2>&1 ||
    cannot "the packages $image $more can't be downloaded"
dpkg -x "$work/fetched/$image"_*.deb "$work/kernel" || exit 1

finish() {
    depmod -b "$work/kernel" "$version" || exit 1
    echo "$version" >"$work/version"
    rm -rf "$work/fetched" "$work/drivers" "$work/modules" "$work/kernel/boot" "$work/kernel/usr" "$work/kernel/irq"
    touch "$work/ready"
    mv -T "$work" "$made" 2>/dev/null || [ -e "$made/ready" ] || exit 1
    trap - EXIT
    rm -rf "$work"
    echo "$made"
    exit 0
}
if [ "$architecture" != amd64 ]; then
    mv "$work/kernel/boot/vmlinuz-$version" "$work/vmlinux" # which is not compressed
    for package in $more; do
        dpkg -x "$work/fetched/$package"_*.deb "$work/userland" || exit 1
    done
    finish
fi

# The kernel without its compressed wrapping, which an emulated processor unpacks slowly.
packed=$work/kernel/boot/vmlinuz-$version
for at in $(LC_ALL=C grep -abo -F "$(printf '\3757zXZ')" "$packed" | cut -d: -f1); do
    tail -c "+$((at + 1))" "$packed" | xz -dc --single-stream >"$work/vmlinux" 2>/dev/null
    [ "$(head -c 4 "$work/vmlinux" | tail -c 3)" = ELF ] && break
done
[ -s "$work/vmlinux" ] || cannot "no kernel found in $packed"

# gpio-sim, irq_sim and the driver of the PCA9685 are not built for the distribution's kernels, so they are built from its source.
# irq_to_desc is not exported to modules; irq_data_to_desc(irq_get_irq_data()) is the same.
dpkg-deb --fsys-tarfile "$work/fetched/$source"_*.deb | tar -xO "./usr/src/$source.tar.xz" |
    tar -xJ -C "$work" --strip-components 1 "$source/drivers/gpio/gpio-sim.c" "$source/drivers/gpio/gpiolib.h" \
        "$source/drivers/pwm/pwm-pca9685.c" "$source/kernel/irq/irq_sim.c" || exit 1
cp "$work/drivers/gpio/gpio-sim.c" "$work/drivers/gpio/gpiolib.h" "$work/drivers/pwm/pwm-pca9685.c" "$work/kernel/irq/irq_sim.c" "$work/modules/"
sed -i 's/irq_to_desc(irqnum)/irq_data_to_desc(irq_get_irq_data(irqnum))/
    s/#include <linux\/irq.h>/&\n#include <linux\/irqdesc.h>\n#include <linux\/module.h>/' "$work/modules/irq_sim.c"
echo 'MODULE_LICENSE("GPL");' >>"$work/modules/irq_sim.c"
echo 'obj-m := irq_sim.o gpio-sim.o pwm-pca9685.o' >"$work/modules/Makefile"
env -u MAKEFLAGS -u MAKELEVEL make -s -C "$headers" "M=$work/modules" modules >>"$work/log" 2>&1 || {
    tail -n 5 "$work/log" >&2
    cannot 'gpio-sim, irq_sim and pwm-pca9685 can not be built'
}
tree=$work/kernel/lib/modules/$version
mkdir -p "$tree/extra"
cp "$work"/modules/*.ko "$tree/extra/"
strip -g "$tree"/extra/*.ko
finish
