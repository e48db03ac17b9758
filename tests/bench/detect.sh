#!/bin/sh
# Usage: detect.sh BUILD   Instructions of each detector on a frame of 640x480 (callgrind), and how many such frames a
# core gets through that does 10^9 instructions a second.
dir=$1/bench
mkdir -p "$dir"
count() { # NAME FUNCTION
    BENCH=1 valgrind --tool=callgrind --callgrind-out-file="$dir/$1.callgrind" --toggle-collect="$2" \
        "$dir/../gcc/tests/property/$3" >"$dir/$1.log" 2>"$dir/$1.err"
    # A function has a number, and its name only where the number comes first.
    awk -v name="$1" -v function_name="$2" '
        /^c?fn=/ && $2 == function_name { number = $1; sub(/^c?fn=/, "", number) }
        /^cfn=/ { called = $1; sub(/^cfn=/, "", called) }
        /^calls=/ && called == number { sub(/^calls=/, "", $1); calls += $1 }
        /^(summary|totals):/ { total = $2 }
        END {
            if (calls == 0) { print name ": nothing measured"; exit 1 }
            printf "%-8s %4d frames, %11.0f instructions a frame, %5.1f frames for 10^9 of them\n", name, calls, total / calls, 1e9 * calls / total
        }' "$dir/$1.callgrind"
}
count tags tags_find tag_frames
count markers markers_find marker_frames
count motion motion_find motion_frames
