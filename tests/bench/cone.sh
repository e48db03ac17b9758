#!/bin/sh
# Usage: cone.sh PROGRAM FOLDER   Counts instructions under callgrind, then measures and prints; the output is kept as
# FOLDER/cone.txt. About ten minutes.
set -eu
program=$1 folder=$2
rm -rf "$folder/callgrind" "$folder/counts.txt"
mkdir -p "$folder/callgrind"
: >"$folder/counts.txt"
# A count does not mind what else runs, so there is a part for each processor. What is worth a run follows from the
# sizes before.
parts=$(nproc 2>/dev/null || echo 1)
for size in 0 1 2 3 4 5; do
    echo "Counting instructions, size $((size + 1)) of 6" >&2
    started=
    part=0
    while [ "$part" -lt "$parts" ]; do
        valgrind --tool=callgrind --instr-atstart=no --collect-atstart=no --callgrind-out-file="$folder/callgrind/part$part" \
            "$program" count "$size" "$folder/counts.txt" "$part" "$parts" >"$folder/callgrind/log$part" 2>&1 &
        started="$started $!"
        part=$((part + 1))
    done
    for id in $started; do
        wait "$id" || { tail -n 5 "$folder"/callgrind/log* >&2; exit 1; }
    done
    # A dump a figure: "desc: Trigger: Client Request: count SET SIZE METHOD POINTS", then "summary: INSTRUCTIONS".
    find "$folder/callgrind" -name 'part*' -exec awk '
        /^desc: Trigger: Client Request: count/ { key = $6 " " $7 " " $8 " " $9 }
        /^summary:/ { if (key != "") print key, $2; key = "" }' {} + >>"$folder/counts.txt"
    rm -f "$folder"/callgrind/*
done
"$program" table "$folder/counts.txt" 6 300 >"$folder/cone.txt" || { tail -n 1 "$folder/cone.txt" >&2; exit 1; }
cat "$folder/cone.txt"
