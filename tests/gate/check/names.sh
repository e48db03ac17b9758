#!/bin/sh
# Usage: names.sh FILE...   Every file of this repository that these name exists. Prints the others; ends with 1 if there is one.
# X in a name stands for any word; what is built from a source is called like it; hal/x.h is how sources include it.
named=$(grep -HoE '(^|[^A-Za-z0-9_./-])(boards|docs|firmware|hal|host-sim|tests)/[A-Za-z0-9_/-]+\.(md\.in|md|c|h|sh|awk|ini|elf|mk|svg)([^a-z]|$)' "$@" | tr -d ' `"<(' | sort -u)
[ -n "$named" ] || { echo 'names: no file is named'; exit 1; }
missing=0
for entry in $named; do
    file=$(echo "${entry#*:}" | sed 's/^[^a-z]*//; s/[^a-z]*$//')
    case $file in
    *X_* | */X.*) continue ;;
    tests/*.elf) file=${file%.elf}.c ;;
    hal/*/*) ;;
    hal/*.h) file=hal/include/$file ;;
    esac
    [ -e "$file" ] || { echo "$entry does not exist"; missing=1; }
done
exit $missing
