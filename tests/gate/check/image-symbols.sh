#!/bin/sh
# Usage: image-symbols.sh ELF   A finished image has no allocator, no floating point (helpers or instructions) and no libc. Prints each
# breach; ends with 1.
elf=$1
[ -s "$elf" ] || { echo "symbols: no image $elf"; exit 1; }
{ arm-none-eabi-nm "$elf" && arm-none-eabi-objdump -d --no-show-raw-insn "$elf"; } | awk '
    NF == 3 && $2 ~ /^[A-Za-z]$/ {
        seen++
        if ($3 ~ /^_?(malloc|calloc|realloc|free|aligned_alloc|_?sbrk)(_r)?$/) complain("allocator: " $3)
        if ($3 ~ /^__aeabi_(c?[fd](add|sub|rsub|mul|div|neg|cmp|rcmp|2)|u?[il]2[fd]|h2[fd]|d2h)/ ||
            $3 ~ /^__(add|sub|mul|div|neg|eq|ne|lt|le|gt|ge|cmp|unord)[sdt]f[23]$/ ||
            $3 ~ /^__(fix|fixuns|float|floatun|floatuns|extend|trunc)[sdt]/) complain("floating point: " $3)
        if ($3 ~ /^_?(v?s?n?printf|puts|exit|abort|__libc.*)$/) complain("libc: " $3)
    }
    /^[0-9a-f]+ <.*>:$/ { name = $2 }
    /^ *[0-9a-f]+:\t/ { instructions++ }
    /^ *[0-9a-f]+:\tv[a-z]/ { if (!(name in told)) complain("floating-point instruction in " name); told[name] = 1 }
    function complain(what) { print "symbols: " what; breaches++ }
    END { if (seen == 0 || instructions == 0) { print "symbols: the image is empty"; exit 1 } exit breaches > 0 }'
