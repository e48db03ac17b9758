#!/bin/sh
# Usage: budget.sh ELF   What an image needs of its board, against the budgets that the board's board.ld sets. Ends with 1 if it is too much.
elf=$1
[ -s "$elf" ] || { echo "budget: no image $elf"; exit 1; }
stack=$(tests/gate/check/callgraph.sh "$elf" quiet)
status=$?
arm-none-eabi-nm "$elf" | awk -v stack="$(printf '%s\n' "$stack" | sed -n 's/^stack: \([0-9]*\) bytes.*/\1/p')" '
    function hex(text,  i, value) {
        value = 0
        for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
        return value
    }
    function row(name, used, budget) {
        printf "%-34s %8d %8d %5.1f %%\n", name, used, budget, (budget > 0 ? 100 * used / budget : 0)
        if (used == 0 || used > budget) over = 1
    }
    { at[$3] = hex($1) }
    END {
        reserve = at["stack_top"] - at["stack_bottom"]
        printf "%-34s %8s %8s\n", "bytes", "used", "budget"
        row("flash", at["flash_used_bytes"], at["flash_budget_bytes"])
        row("RAM, stack reserve included", at["ram_used_bytes"], at["ram_budget_bytes"])
        row("worst-case stack, half the reserve", stack, reserve / 2)
        exit over
    }' || status=1
[ $status -eq 0 ] || printf '%s\n' "$stack"
exit $status
