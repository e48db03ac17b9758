#!/bin/sh
# Usage: packages.sh SUITE ARCHITECTURE PACKAGE...   Prints the folder that holds these packages of Debian's release SUITE,
# unpacked; fetches them first, from where this machine's own packages come. Nothing is installed: the lists are private, and
# so the release and the architecture may be others than the machine's. The folder is kept between builds (kernel.sh tells
# where). Exit status 3, after one line on stderr: they can't be had here.
set -u
cache=${BORESIGHT_VM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/boresight-vm}
suite=$1 architecture=$2
shift 2
cannot() {
    echo "$1" >&2
    exit 3
}
made=$cache/packages-$suite-$architecture-$(echo "$*" | cksum | cut -d' ' -f1)
if [ -e "$made/ready" ]; then
    echo "$made"
    exit 0
fi
# shellcheck disable=SC2016
from=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null | awk '$1 == "Debian" { print $2; exit }')
[ -n "$from" ] || cannot "no source of Debian's packages in the lists of apt"
keys=/usr/share/keyrings/debian-archive-keyring.gpg
[ -e "$keys" ] || cannot "no $keys to tell Debian's packages from others"

work=$cache/making-packages.$$
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/apt/lists/partial" "$work/apt/archives/partial" "$work/apt/parts" "$work/fetched"
echo "deb [signed-by=$keys] $from $suite main" >"$work/apt/sources.list"
apt() {
    (cd "$work/fetched" && apt-get -q -o APT::Architecture="$architecture" -o APT::Architectures::="$architecture" -o APT::Sandbox::User= \
        -o Dir::Etc::SourceList="$work/apt/sources.list" -o Dir::Etc::SourceParts="$work/apt/parts" -o Dir::State="$work/apt" \
        -o Dir::State::Status=/dev/null -o Dir::Cache="$work/apt" -o Acquire::Languages=none "$@") >>"$work/log" 2>&1
}
apt update || cannot "the list of Debian's packages of $suite for $architecture can't be had"
apt download "$@" || cannot "the packages $* of $suite for $architecture can't be downloaded"
for package in "$work"/fetched/*.deb; do
    dpkg -x "$package" "$work" || exit 1
done
rm -rf "$work/fetched" "$work/apt"
touch "$work/ready"
mv -T "$work" "$made" 2>/dev/null || [ -e "$made/ready" ] || exit 1
trap - EXIT
rm -rf "$work"
echo "$made"
