# The call graph of an image, from its disassembly. See callgraph.sh, which gathers the input:
#   S ADDRESS SIZE KIND NAME     symbols (hexadecimal, without 0x)
#   W ADDRESS VALUE              words of constant and initialised data, and of the vector table (section V instead of W)
#   O CLASS INDEX VERB           operations of the HAL classes, in the order of their tables
#   I ADDRESS NAME               for each indirect call the innermost (inlined) function that it stands in
#   and the disassembly itself.
# list=1 prints the deepest chains.
function hex(text,  i, value) {
    value = 0
    text = tolower(text)
    for (i = 1; i <= length(text); i++) value = value * 16 + index("0123456789abcdef", substr(text, i, 1)) - 1
    return value
}
function complain(what) { print "callgraph: " what; breaches++ }
function even(value) { return value - value % 2 }

$1 == "S" {
    at = even(hex($2))
    if ($4 ~ /^[tTwW]$/) is_function[at] = 1
    symbol[$5] = hex($2)
    if ($5 ~ /_ops$/) { ops[$5] = hex($2); ops_bytes[$5] = hex($3) }
    next
}
$1 == "W" || $1 == "V" {
    word[hex($2)] = hex($3)
    if ($1 == "V") vector_at[vectors++] = hex($2)
    else word_at[words++] = hex($2)
    next
}
$1 == "O" { verb[$2, $3] = $4; verbs[$2] = $3 + 1; next }
$1 == "I" { inside[hex($2)] = $3; next }

# A function begins: `08000188 <name>:`
/^[0-9a-f]+ <.*>:$/ {
    end_function()
    current = hex($1)
    name[current] = substr($2, 2, length($2) - 3)
    order[functions++] = current
    split("", constant)
    returns = ""
    next
}
# Addresses of eight digits have no blank in front.
/^ *[0-9a-f]+:\t/ {
    instructions++
    line = $0
    sub(/[@;].*$/, "", line)
    parts = split(line, part, "\t")
    address = part[1]; gsub(/[ :]/, "", address); address = hex(address)
    op = part[2]; gsub(/ /, "", op)
    args = parts >= 3 ? part[3] : ""
    sub(/[ \t]+$/, "", args)
    if (op == ".word") { literal_at[literals++] = address; word[address] = hex(substr(args, 3)); next }
    if (op ~ /^\./ || op == "nop" || op == "nop.w") next
    if (op == "movs" && args == "r0, r0") next # two zero bytes: what the linker fills up with between sections
    last_op = op; last_args = args
    frame_of(op, args, $0)
    constant_of(op, args, $0)
    branch_of(op, args)
}
function end_function() {
    # Hand-written code may run on into the next label.
    if (current != "" && last_op != "" && !(last_op ~ /^(b|b\.n|b\.w|bx|bl|udf)$/ || last_args ~ /pc}?$/ || last_args ~ /^pc,/ ||
        last_op ~ /^tb[bh]$/)) falls[current] = functions
    last_op = ""
}
# What a register holds, as far as frames need it that are beyond the reach of one instruction: `ldr r4, =-1704; add sp, r4`, and back
# with `movs r3, #213; lsls r3, #3; add sp, r3`. "v VALUE", "l ADDRESS OF VALUE", or nothing.
function constant_of(op, args, whole,  reg, value, at) {
    if (args !~ /^r[0-9]+,/) return
    reg = args; sub(/,.*$/, "", reg)
    value = args; sub(/^.*#/, "", value)
    if (op == "movs" && args ~ /^r[0-9]+, #[0-9]+$/) constant[reg] = "v " value
    else if (op == "lsls" && args == reg ", " reg ", #" value && constant[reg] ~ /^v/) constant[reg] = "v " substr(constant[reg], 3) * 2 ^ value
    else if (op ~ /^ldr/ && whole ~ /\[pc, #/) {
        at = whole; sub(/^.*\(/, "", at); sub(/[ )].*$/, "", at)
        constant[reg] = "l " hex(at)
    } else constant[reg] = ""
}
# Bytes of stack that an instruction takes. What it gives back does not count: the sum over all ways is never too small.
function frame_of(op, args, whole,  list, n, reg) {
    if (op ~ /^push/ || (op ~ /^stmdb/ && args ~ /^sp!/)) {
        list = args; sub(/^[^{]*{/, "", list)
        n = split(list, x, ",")
        if (list ~ /-/) complain(name[current] ": a register range: " whole)
        frame[current] += 4 * n
    } else if (args ~ /\[sp, #-[0-9]+\]!/) {
        n = args; sub(/^.*\[sp, #-/, "", n); sub(/\].*$/, "", n)
        frame[current] += n
    } else if (op ~ /^vpush/) complain(name[current] ": a floating-point register is pushed")
    else if (op ~ /^subw?(\.w)?$/ && args ~ /^sp, (sp, )?#/) {
        n = args; sub(/^.*#/, "", n)
        frame[current] += n
    } else if (op ~ /^add/ && args ~ /^sp, (sp, )?r[0-9]+$/) {
        reg = args; sub(/^.*, /, "", reg)
        later[laters++] = current " " constant[reg]
    } else if (op ~ /^(sub|mov)/ && args ~ /^sp, (sp, )?(r[0-9]+|ip|sl|fp|lr)$/ && !(op ~ /^mov/ && args ~ /^sp, r7$/))
        complain(name[current] ": a stack of unknown size: " whole)
}
function branch_of(op, args,  target) {
    if (args ~ /<.*>$/ && op ~ /^(b|bl|blx|cb)/) {
        target = args; sub(/ <.*$/, "", target); sub(/^.*[ ,]/, "", target)
        target = hex(target)
        if (target != current) edge_to(current, target)
        else if (op ~ /^bl/) complain("recursion: " name[current]) # a plain branch to one's own start is a loop
    } else if (op == "pop" && args ~ /^{r[0-7]}$/) {
        returns = substr(args, 2, 2) # a Cortex-M0+ can't pop into lr: pop {r3}; add sp, #8; bx r3
    } else if (op == "bx" && args == returns) {
        returns = ""
    } else if (name[current] == "boot2") {
        return # an RP2040's: in front of the image, which it starts
    } else if ((op == "blx" && args ~ /^(r|ip|sl|fp|lr)/) || (op == "bx" && args != "lr")) {
        indirect[indirects++] = address
        indirect_in[address] = current
    }
}
function edge_to(from, to) { if (!((from, to) in edge)) { edge[from, to] = 1; edges[from] = edges[from] " " to } }

# The function that an address lies in.
function owner(at,  i, low, high) {
    low = 0; high = functions - 1
    while (low < high) { i = int((low + high + 1) / 2); if (order[i] <= at) low = i; else high = i - 1 }
    return order[low]
}
# What a call by way of hal_CLASS_VERB may reach: that operation of every table of the class.
function resolve(site,  wrapper, cut, class, what, i, table, found) {
    wrapper = inside[site]
    if (wrapper !~ /^hal_[a-z]+_[a-z0-9_]+$/) {
        complain(name[indirect_in[site]] ": an indirect call outside the wrappers of hal/include/hal (in " wrapper ")")
        return
    }
    cut = substr(wrapper, 5)
    class = cut; sub(/_.*$/, "", class)
    what = substr(cut, length(class) + 2)
    for (i = 0; i < verbs[class]; i++) if (verb[class, i] == what) break
    if (i >= verbs[class]) { complain(wrapper ": no such operation"); return }
    for (table in ops) if (table ~ ("(^|_)" class "_ops$")) {
        edge_to(indirect_in[site], even(word[ops[table] + 4 * i]))
        found = 1
    }
    # A board without such a device says so in its board.ld: board_has_no_can = 1;
    if (!found && !(("board_has_no_" class) in symbol)) complain(wrapper ": no table *_" class "_ops in the image")
}
# Function pointers may stand in those tables and among the vectors only. An RP2040's boot2, which only the boot ROM calls, lies at 2^28: that
# number plus 1 is a number.
function check_pointers(  i, at, value) {
    for (table in ops) for (i = 0; i < ops_bytes[table]; i += 4) known[ops[table] + i] = 1
    for (i = 0; i < words; i++) check_pointer(word_at[i], "data")
    for (i = 0; i < literals; i++) check_pointer(literal_at[i], name[owner(literal_at[i])])
}
function check_pointer(at, where,  value) {
    value = word[at]
    if (value % 2 == 1 && ((value - 1) in is_function) && !(at in known) && name[value - 1] != "boot2")
        complain("the address of " name[value - 1] " is taken in " where ", outside the tables of operations")
}
# Deepest stack from a function on; complains about recursion.
function depth(f,  list, n, i, deepest, d) {
    if (f in deep) return deep[f]
    if (open[f]) { complain("recursion: " name[f]); return 0 }
    open[f] = 1
    deepest = 0
    n = split(edges[f], list, " ")
    for (i = 1; i <= n; i++) {
        d = depth(list[i])
        if (d > deepest) { deepest = d; next_of[f] = list[i] }
    }
    open[f] = 0
    return deep[f] = frame[f] + deepest
}
function chain(f, title) {
    if (!list) return
    print title
    for (; f != ""; f = next_of[f]) printf "%8d  %s\n", frame[f], name[f]
}
function find_division(f, from,  list, n, i) {
    if ((f, from) in walked) return
    walked[f, from] = 1
    if (name[f] ~ /^(__aeabi_u?ldivmod|__u?divmoddi4|__u?(div|mod)di3)$/) complain("a 64-bit division from the handler " name[from])
    n = split(edges[f], list, " ")
    for (i = 1; i <= n; i++) find_division(list[i], from)
}
END {
    end_function()
    if (functions == 0 || instructions == 0 || vectors == 0 || !("stack_top" in symbol)) { print "callgraph: no image"; exit 1 }
    # Branches into the middle of another function count as calls of it; into one's own, as nothing.
    for (i = 0; i < functions; i++) {
        n = split(edges[order[i]], list_of, " ")
        edges[order[i]] = ""
        for (k = 1; k <= n; k++) {
            target = owner(list_of[k])
            if (target != order[i]) edges[order[i]] = edges[order[i]] " " target
        }
    }
    for (f in falls) if (falls[f] < functions) edges[f] = edges[f] " " order[falls[f]]
    for (i = 0; i < laters; i++) {
        split(later[i], x, " ")
        value = x[2] == "l" ? word[x[3]] : x[3]
        if (value == "") complain(name[x[1]] ": a stack of unknown size")
        else if (value >= 2147483648) frame[x[1]] += 4294967296 - value
    }
    for (i = 0; i < indirects; i++) resolve(indirect[i])
    check_pointers()

    reset = even(word[vector_at[1]])
    program = depth(reset)
    chain(reset, "the program, bytes of stack each:")
    for (i = 2; i < vectors; i++) {
        handler = even(word[vector_at[i]])
        if (handler == 0 || handler in seen) continue
        seen[handler] = 1
        find_division(handler, handler)
        handlers += depth(handler) + 36 # eight registers, and up to four bytes to align them
        chain(handler, "handler " name[handler] ":")
    }
    total = program + handlers
    reserve = symbol["stack_top"] - symbol["stack_bottom"]
    printf "stack: %d bytes: program %d, handlers nested %d; half of the reserve is %d\n", total, program, handlers, reserve / 2
    if (total > reserve / 2) complain("the stack takes more than half of the reserve")
    exit breaches > 0
}
