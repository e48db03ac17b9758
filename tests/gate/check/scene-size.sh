#!/bin/sh
# Usage: scene-size.sh FOLDER   What a scene takes of a board: FOLDER/scene/boresight.elf beside FOLDER/boresight.elf. Ends with 1 if it is
# too much, or there is nothing to compare.
[ -s "$1/boresight.elf" ] && [ -s "$1/scene/boresight.elf" ] || { echo "scene-size: no images in $1"; exit 1; }
tests/gate/check/budget.sh "$1/scene/boresight.elf" || exit 1
{
    arm-none-eabi-nm "$1/boresight.elf" | sed 's/^/plain /'
    arm-none-eabi-nm "$1/scene/boresight.elf" | sed 's/^/scene /'
} | awk '
    function hex(text,  i, value) {
        value = 0
        for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
        return value
    }
    { at[$1 " " $4] = hex($2) }
    END {
        tree = at["scene scene_block_end"] - at["scene scene_block"]
        flash = at["scene flash_used_bytes"] - at["plain flash_used_bytes"] - tree
        ram = at["scene ram_used_bytes"] - at["plain ram_used_bytes"]
        printf "%-34s %8d\n%-34s %8d\n%-34s %8d\n", "of these, the tree in flash", tree, "its code", flash, "RAM for it", ram
        exit !(tree > 0 && flash > 0 && ram > 0)
    }'
