#!/bin/sh
# Usage: shown.sh HEADER...   Each names the tests that show what it says (names.sh sees that they exist). Those for one driver only
# (_private.h) and tables of registers promise nothing. Prints the others; ends with 1 if there is one.
missing=0
looked=0
for header in "$@"; do
    case $header in *_private.h | *_registers.h) continue ;; esac
    looked=$((looked + 1))
    grep -q '^///.*tests/' "$header" || { echo "$header names no test"; missing=1; }
done
[ $looked -gt 0 ] || { echo 'shown: no headers'; exit 1; }
exit $missing
