# Every function that a header declares states its cost, its accuracy and its source: in its own comment, or for all of
# them in the one at the file's top. Usage: awk -f headers.awk HEADER...
function complain(what) { printf "%s:%d: %s\n", FILENAME, FNR, what; breaches++ }
function states(word) { return index(tolower(comment), word) > 0 || index(tolower(top), word) > 0 }
FNR == 1 { top = comment = ""; at_top = 1; inside = 0 }
/^\/\/\// { comment = comment " " $0; if (at_top) top = top " " $0; next }
{ at_top = 0 }
inside { if (/^}/ || (/;$/ && !body)) inside = body = 0; next }
/^$/ { comment = "" }
/^(static inline )?[a-z][a-z0-9_ ]*[ *][a-z0-9_]+\(/ && !/^typedef/ {
    functions++
    name = $0
    sub(/\(.*/, "", name)
    sub(/.*[ *]/, "", name)
    missing = ""
    if (!states("cost")) missing = missing " cost"
    if (!states("accuracy")) missing = missing " accuracy"
    if (!states("source")) missing = missing " source"
    if (missing != "") complain(name " does not state its" missing)
    body = /^static inline/
    inside = !/;$/
}
/^(struct|enum) [a-z0-9_]+ \{/ { comment = "" }
END { if (functions == 0) { print "headers: no functions"; exit 1 } exit breaches > 0 }
