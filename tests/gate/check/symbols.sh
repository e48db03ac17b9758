#!/bin/sh
# Usage: symbols.sh NM OBJECT...   Every symbol that the objects need must be defined by one of them or be one of the few
# that the compiler itself asks for: no allocator, no floating point, no libc. Prints each breach; ends with 1.
nm=$1
shift
[ $# -gt 0 ] || { echo 'symbols: no objects'; exit 1; }
# Integer helpers of libgcc and the memory functions that a compiler calls for copies; the board supplies these.
allowed='^(memcpy|memmove|memset|memcmp|__aeabi_memcpy[48]?|__aeabi_memset[48]?|__aeabi_memclr[48]?|__aeabi_memmove[48]?|__aeabi_u?idiv|__aeabi_u?idivmod|__aeabi_u?ldivmod|__aeabi_lmul|__aeabi_ll[sa][lr]|__aeabi_lasr|__aeabi_lcmp|__aeabi_ulcmp|__gnu_thumb1_case_[us][qhi]+|__clzsi2|__clzdi2|build_id)$'
"$nm" -A "$@" | awk -v allowed="$allowed" '
    { file = $1; sub(/:.*/, "", file); name = $NF; kind = $(NF - 1); seen++ }
    kind ~ /^[TtDdBbRrVWCc]$/ { defined[name] = 1 }
    kind == "U" { wanted[file " " name] = name }
    END {
        if (seen == 0) { print "symbols: the objects are empty"; exit 1 }
        for (i in wanted) if (!(wanted[i] in defined) && wanted[i] !~ allowed) {
            split(i, part, " "); print part[1] ": needs " wanted[i]; breaches++
        }
        exit breaches > 0
    }'
