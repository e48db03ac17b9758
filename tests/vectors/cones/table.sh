#!/bin/sh
# Usage: sh tests/vectors/cones/table.sh > tests/vectors/cones/table.h
# Puts the cases of up to 101 points beside this script into a C table for the boards that have no files.
# tests/property/cone_cases.c fails when the table and the files differ.
export LC_ALL=C
cd "$(dirname "$0")" || exit 1
cat <<'END'
// Made by table.sh from the .txt files beside it; don't edit.
// clang-format off
#ifndef VECTORS_CONES_TABLE_H
#define VECTORS_CONES_TABLE_H

#include "fixed/vec3.h"

#include <stdint.h>

/// A set of directions and its narrowest cone.
struct cone_vector {
    const char *name;
    uint16_t first, count;       // of cone_vector_points
    struct vec3 axis_q30;        // the exact axis, rounded; zero: infeasible
    uint64_t half_angle_turn64;  // the exact half-angle, rounded down; 2^64 units a turn
};

END
count=101
for file in *.txt; do
    [ "$(grep -vc '^#' "$file")" -le "$count" ] && echo "$file"
done | sort >"${TMPDIR:-/tmp}/cones.$$"
trap 'rm -f "${TMPDIR:-/tmp}/cones.$$"' EXIT
echo 'static const struct vec3 cone_vector_points[] = {'
while read -r file; do
    echo "    // ${file%.txt}"
    awk '!/^#/ { printf "    {%s, %s, %s},\n", $1, $2, $3 }' "$file"
done <"${TMPDIR:-/tmp}/cones.$$"
echo '};'
echo
echo 'static const struct cone_vector cone_vectors[] = {'
first=0
while read -r file; do
    awk -v name="${file%.txt}" -v first="$first" '
        $1 == "#" && $2 == "axis" { for (i = 0; i < 3; i++) axis[i] = sprintf("%.0f", $(i + 3) * 1073741824) }
        $1 == "#" && $2 == "half_angle_turn64" { turn = $3 }
        !/^#/ { count++ }
        END {
            printf "    {\"%s\", %d, %d,\n     {%d, %d, %d}, UINT64_C(%s)},\n",
                name, first, count, axis[0], axis[1], axis[2], turn == "" ? "0" : turn
        }' "$file"
    first=$((first + $(grep -vc '^#' "$file")))
done <"${TMPDIR:-/tmp}/cones.$$"
cat <<'END'
};

#define CONE_VECTOR_COUNT      (sizeof cone_vectors / sizeof *cone_vectors)
#define CONE_VECTOR_POINTS_MAX 101

#endif
END
