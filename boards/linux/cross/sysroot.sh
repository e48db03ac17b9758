#!/bin/sh
# Usage: sysroot.sh TARGET   Prints the folder with the C library and the libraries of the program (headers and all) for another
# processor: aarch64-linux-gnu, arm-linux-gnueabihf. Fetches it first (27 MB to download, 90 MB kept), from the distribution's
# packages; nothing is installed. It is kept in BORESIGHT_CROSS_CACHE, else ~/.cache/boresight-cross. Exit status 3, after one
# line on stderr: the packages can't be had here.
set -u
. "$(dirname "$0")/apt.sh"
cannot() {
    echo "$1" >&2
    exit 3
}
case ${1:-} in
aarch64-linux-gnu) architecture=arm64 ;;
arm-linux-gnueabihf) architecture=armhf ;;
*)
    echo "sysroot: '${1:-}' is neither aarch64-linux-gnu nor arm-linux-gnueabihf: name the other system's files with SYSROOT=FOLDER" >&2
    exit 2
    ;;
esac
command -v dpkg >/dev/null && command -v apt-get >/dev/null || cannot 'no dpkg and apt here: name a copy of the other system with SYSROOT=FOLDER'
# Another release, or other contents by this script, are another folder.
made=$cross_cache/$architecture-$(. /etc/os-release && echo "${VERSION_CODENAME:-$ID}")-$(cksum <"$0" | cut -d' ' -f1)
if [ -e "$made/ready" ]; then
    echo "$made"
    exit 0
fi

# libgmp and libmpfr are the tests'.
needed='libc6-dev linux-libc-dev libjansson-dev libusb-1.0-0-dev libgpiod-dev libjpeg62-turbo-dev libapriltag-dev libcairo2-dev libgmp-dev libmpfr-dev'
work=$cross_cache/making.$$
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/fetched" || exit 1
echo "fetching the libraries of the program for $architecture" >&2
apt_update $architecture >"$work/log" 2>&1
# The headers' packages alone, without what they depend on (the whole of X11), and what the libraries need at run time.
# shellcheck disable=SC2086
run_time=$(apt_for $architecture apt-cache depends $needed 2>>"$work/log" | awk '$1 == "Depends:" && $2 ~ /^lib/ && $2 !~ /-(dev|bin)$/ { print $2 }' | sort -u)
# shellcheck disable=SC2086
all=$(apt_for $architecture apt-get install -s --no-install-recommends $run_time 2>>"$work/log" | awk '$1 == "Inst" && $2 ~ /^(lib|zlib)/ { print $2 }')
[ -n "$all" ] || cannot "apt has no lists of packages for $architecture: $(tail -n 1 "$work/log")"
# shellcheck disable=SC2086
(cd "$work/fetched" && apt_fetch $architecture $needed $all) >>"$work/log" 2>&1 ||
    cannot "the libraries for $architecture can't be downloaded: $(tail -n 1 "$work/log")"
for package in "$work"/fetched/*.deb; do
    dpkg -x "$package" "$work" || exit 1
done
rm -rf "$work/fetched" "$work/usr/share" "$work/usr/bin"
# Links from the root name this machine's files: from here on they name the other's.
find "$work" -type l -lname '/*' | while read -r link; do
    ln -sfr "$work$(readlink "$link")" "$link"
done
touch "$work/ready"
mv -T "$work" "$made" 2>/dev/null || [ -e "$made/ready" ] || exit 1
trap - EXIT
rm -rf "$work"
echo "$made"
