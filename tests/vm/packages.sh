#!/bin/sh
# Usage: packages.sh RELEASE PACKAGE...   Prints the folder that holds these packages of that release of Debian (trixie), unpacked;
# fetches them first. Nothing is installed. The folder is kept between builds. Exit status 3, after one line on stderr: they
# can't be had here.
set -u
. boards/linux/cross/apt.sh
apt_release=$1
architecture=$(dpkg --print-architecture)
shift
made=$cross_cache/$apt_release-$architecture-$(echo "$*" | cksum | cut -d' ' -f1)
if [ -e "$made/ready" ]; then
    echo "$made"
    exit 0
fi
work=$cross_cache/making.$$
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/fetched"
apt_update "$architecture" >"$work/log" 2>&1
(cd "$work/fetched" && apt_fetch "$architecture" "$@") >>"$work/log" 2>&1 || {
    echo "the packages $* of $apt_release can't be downloaded: $(tail -n 1 "$work/log")" >&2
    exit 3
}
for package in "$work"/fetched/*.deb; do
    dpkg -x "$package" "$work" || exit 1
done
rm -rf "$work/fetched"
touch "$work/ready"
mv -T "$work" "$made" 2>/dev/null || [ -e "$made/ready" ] || exit 1
trap - EXIT
rm -rf "$work"
echo "$made"
