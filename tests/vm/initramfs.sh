#!/bin/sh
# Usage: initramfs.sh KERNEL-FOLDER OUT   A file system in memory with busybox, init and what it needs to mount the rest.
set -eu
kernel=$1
version=$(cat "$kernel/version")
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root/bin" "$root/modules" "$root/proc" "$root/sys" "$root/dev" "$root/root"
busybox=$kernel/userland/bin/busybox
[ -e "$busybox" ] || busybox=/bin/busybox
cp "$busybox" "$root/bin/busybox"
cp tests/vm/init "$root/init"
chmod +x "$root/init"
/sbin/modprobe -S "$version" -d "$kernel/kernel" -a --show-depends virtio_pci 9p 9pnet_virtio |
    while read -r what file _; do
        [ "$what" = insmod ] || continue
        name=${file##*/}
        [ -e "$root/modules/$name" ] && continue
        cp "$file" "$root/modules/$name"
        echo "$name" >>"$root/modules/order"
    done
(cd "$root" && find . | cpio --quiet -o -H newc -R 0:0) >"$2"
