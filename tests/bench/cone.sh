#!/bin/sh
# Usage: cone.sh PROGRAM FOLDER   Counts instructions under callgrind, then measures and prints; the output is kept as
# FOLDER/cone.txt.
set -eu
program=$1 folder=$2
rm -rf "$folder"
mkdir -p "$folder"
echo 'Counting instructions (about a minute)' >&2
valgrind --tool=callgrind --collect-atstart=no --callgrind-out-file="$folder/callgrind" "$program" count >"$folder/callgrind.log" 2>&1
# A dump a figure: "desc: Trigger: Client Request: count SET SIZE METHOD POINTS", then "summary: INSTRUCTIONS".
awk '/^desc: Trigger: Client Request: count/ { key = $6 " " $7 " " $8 " " $9 } /^summary:/ { print key, $2 }' \
    "$folder"/callgrind.* >"$folder/counts.txt"
rm "$folder"/callgrind.*
echo 'Measuring (about two minutes)' >&2
"$program" table "$folder/counts.txt" | tee "$folder/cone.txt"
