# Which layer may include which. Usage: awk -f layers.awk FILE...   (paths from the top of the tree)
# Prints `FILE:LINE: what` for each breach and ends with 1 if there was one.
BEGIN {
    # firmware/: each may include itself and what stands before it.
    count = split("fixed settings solid sphere regular scene target aim motion drive link control app", order, " ")
    for (i = 1; i <= count; i++) rank[order[i]] = i
    standard = " assert.h limits.h stdalign.h stdbool.h stddef.h stdint.h stdnoreturn.h "
}
function complain(what) { printf "%s:%d: %s\n", FILENAME, FNR, what; breaches++ }
function layer_of(path,  part) { split(path, part, "/"); return part[1] }
FNR == 1 {
    files++
    n = split(FILENAME, place, "/")
    # `top` is firmware, hal or another top folder; `here` the layer inside firmware/.
    top = place[1]; here = place[2]
}
/^[ \t]*#[ \t]*include/ {
    line = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*/, "", line)
    name = line
    gsub(/[<>"].*$/, "", name)
    system_header = (substr(line, 1, 1) == "<")
    name = substr(line, 2)
    sub(/[>"].*$/, "", name)
    if (name ~ /\.\./) complain("a path with .. leaves its layer: " name)
    if (top == "firmware") {
        if (system_header) {
            if (index(standard, " " name " ") == 0) complain("firmware/ is freestanding: <" name "> is not")
        } else if (layer_of(name) == "hal") {
            if (here != "app") complain("only firmware/app/ may include the HAL: " name)
        } else if (!(layer_of(name) in rank)) {
            complain("no layer of firmware/: " name)
        } else if (rank[layer_of(name)] > rank[here]) {
            complain(here "/ may not include upward: " name)
        }
    } else if (top == "hal" && here == "include") {
        if (system_header) {
            if (index(standard, " " name " ") == 0) complain("hal/include/ is freestanding: <" name "> is not")
        } else if (layer_of(name) != "hal" && layer_of(name) != "fixed" && name != "drive/can_frame.h") {
            complain("hal/include/ may include fixed/ and the value types of drive/ only: " name)
        }
    } else if (top == "hal" && here != "linux" && here != "include") {
        if (system_header && index(standard, " " name " ") == 0)
            complain("hal/ for microcontrollers is freestanding: <" name "> is not")
    }
    if (top == "hal" && !system_header && name ~ /^(control|app|aim|motion|target|scene|sphere|regular|solid|link|settings)\//)
        complain("hal/ may not know the controller: " name)
}
END {
    if (files == 0) { print "layers: no files"; exit 1 }
    exit breaches > 0
}
