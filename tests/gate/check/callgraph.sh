#!/bin/sh
# Usage: callgraph.sh ELF [quiet]   The call graph of a Cortex-M image: worst-case stack, interrupts included, against half of what the
# linker script reserves; no recursion; no indirect call but through the HAL's tables; no 64-bit division in a handler.
# Prints the deepest chains and each breach; ends with 1 if there was one.
elf=$1
list=1
[ "${2:-}" = quiet ] && list=0
[ -s "$elf" ] || { echo "callgraph: no image $elf"; exit 1; }
tool=arm-none-eabi
dir=$(mktemp -d)
trap 'rm -r "$dir"' EXIT
$tool-objdump -d --no-show-raw-insn "$elf" >"$dir/code" || exit 1
# Words of a section: objdump -s prints four a line, in the order of the bytes.
words() { # LETTER SECTION
    $tool-objdump -s -j "$2" "$elf" 2>/dev/null | awk -v letter="$1" '
        function hex(text,  i, value) {
            value = 0
            for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
            return value
        }
        /^ [0-9a-f]+ / {
            data = substr($0, length($1) + 3, 35)
            n = split(data, word, " ")
            for (i = 1; i <= n; i++) if (length(word[i]) == 8)
                printf "%s %x %s%s%s%s\n", letter, hex($1) + 4 * (i - 1), substr(word[i], 7, 2), substr(word[i], 5, 2),
                    substr(word[i], 3, 2), substr(word[i], 1, 2)
        }'
}
{
    $tool-nm -S "$elf" | awk 'NF == 4 { print "S", $1, $2, $3, $4 } NF == 3 { print "S", $1, 0, $2, $3 }'
    words V .vectors
    words W .rodata
    words W .data
    for header in hal/include/hal/*.h; do
        awk '/^struct hal_[a-z]+_ops \{/ { class = $2; sub(/^hal_/, "", class); sub(/_ops$/, "", class); n = 0 }
            class != "" && /\(\*[a-z_0-9]+\)/ { verb = $0; sub(/^.*\(\*/, "", verb); sub(/\).*$/, "", verb); print "O", class, n++, verb }
            /^};/ { class = "" }' "$header"
    done
    # Where each indirect call stands in the source, inlined or not.
    awk -F '\t' '/^ *[0-9a-f]+:\t/ { op = $2; gsub(/ /, "", op); args = $3; sub(/[ \t;@].*$/, "", args)
        if ((op == "blx" && args ~ /^(r|ip|sl|fp|lr)/) || (op == "bx" && args != "lr")) { at = $1; gsub(/[ :]/, "", at); print "0x" at } }' \
        "$dir/code" >"$dir/sites"
    if [ -s "$dir/sites" ]; then
        $tool-addr2line -a -f -i -e "$elf" @"$dir/sites" |
            awk '/^0x[0-9a-f]+$/ { at = substr($1, 3); wanted = 1; next } wanted { print "I", at, $1; wanted = 0 }'
    fi
    cat "$dir/code"
} | awk -v list=$list -f tests/gate/check/callgraph.awk
