#!/bin/sh
# Usage: run.sh MACHINE IMAGE...   Runs test images under QEMU; their verdicts are its output. An image that ends badly,
# hangs, or says nothing gets a FAIL line. MPS2_SECONDS: the longest that one may take.
machine=$1
shift
[ $# -gt 0 ] || { echo "FAIL $machine: no images"; exit 1; }
out=$(mktemp)
for image in "$@"; do
    name=$(basename "$image" .elf)
    echo "# $name"
    timeout "${MPS2_SECONDS:-120}" qemu-system-arm -M "$machine" -display none -monitor none -serial none \
        -semihosting-config enable=on,target=native -kernel "$image" </dev/null >"$out" 2>&1
    status=$?
    cat "$out"
    if [ $status -ne 0 ] && ! grep -q '^FAIL ' "$out"; then
        echo "FAIL $name on $machine ended with exit status $status"
    elif ! grep -qE '^(ok|FAIL) ' "$out"; then
        echo "FAIL $name on $machine printed no verdict"
    fi
done
rm "$out"
