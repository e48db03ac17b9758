#!/bin/sh
# Usage: names.sh FILE...   Every file of tests/ that these name exists. Prints the others; ends with 1 if there is one.
# X in a name stands for any word, and what is built from a source is called like it.
named=$(grep -HoE 'tests/[a-z0-9_]+/[A-Za-z0-9_/]+\.(c|h|sh|awk|ini|elf|mk)([^a-z]|$)' "$@" | sort -u)
[ -n "$named" ] || { echo 'names: no file of tests/ is named'; exit 1; }
missing=0
for entry in $named; do
    file=$(echo "${entry#*:}" | sed 's/[^a-z]$//')
    case $file in
    *X_*) continue ;;
    *.elf) file=${file%.elf}.c ;;
    esac
    [ -e "$file" ] || { echo "$entry does not exist"; missing=1; }
done
exit $missing
