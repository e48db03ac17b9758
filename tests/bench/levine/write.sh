#!/bin/sh
# Writes levine.md and its pictures from the runs. Usage: write.sh RESULTS DOCS
results=$1
docs=$2
here=$(dirname "$0")
parts=
for part in hull sphere trials dimensions hidden large retrieval; do parts="$parts $results/$part.txt"; done
new=$(mktemp) || exit 1
trap 'rm -f "$new"' EXIT
awk -f "$here/doc.awk" "$here/thesis.txt" $parts "$here/levine.md.in" >"$new" &&
    cat "$new" >"$docs/levine.md" &&
    awk -v dir="$docs/pictures" -f "$here/axis.awk" -f "$here/plot.awk" "$here/plots.txt" "$docs/levine.md" "$results/sweep.txt"
