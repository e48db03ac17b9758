# Checks that its input is one JSON object on one line, and prints every value as PATH=VALUE, a line each:
# `support[0]=4`, `image[2].x=0.5`; strings keep their quotes, `[]` and `{}` stand for empty ones.
# Exit status 1 and a line on stderr otherwise. Usage: awk -f json.awk <FILE
function fail(what) {
    if (!failed) print "json: " what " at column " at > "/dev/stderr"
    failed = 1
    exit 1
}
function blanks() { while (substr(text, at, 1) == " ") at++ }
function take(c) {
    blanks()
    if (substr(text, at, 1) != c) fail("no " c)
    at++
}
function peek() { blanks(); return substr(text, at, 1) }
# The token at the cursor that matches pattern, which starts with ^.
function token(pattern, what,    rest) {
    blanks()
    rest = substr(text, at)
    if (!match(rest, pattern)) fail(what)
    at += RLENGTH
    return substr(rest, 1, RLENGTH)
}
function string(    hex) {
    hex = "[0-9a-fA-F]"
    return token("^\"([^\"\\\\]|\\\\[\"\\\\/bfnrt]|\\\\u" hex hex hex hex ")*\"", "no string")
}
function object(path,    name, first) {
    take("{")
    if (peek() == "}") { take("}"); print path "={}"; return }
    for (first = 1; first || peek() == ","; first = 0) {
        if (!first) take(",")
        name = string()
        if ((path, name) in seen) fail("a double " name)
        seen[path, name] = 1
        take(":")
        value(path (path == "" ? "" : ".") substr(name, 2, length(name) - 2))
    }
    take("}")
}
function array(path,    count) {
    take("[")
    if (peek() == "]") { take("]"); print path "=[]"; return }
    for (count = 0; count == 0 || peek() == ","; count++) {
        if (count > 0) take(",")
        value(path "[" count "]")
    }
    take("]")
}
function value(path,    c) {
    c = peek()
    if (c == "{") object(path)
    else if (c == "[") array(path)
    else if (c == "\"") print path "=" string()
    else if (c ~ /[tfn]/) print path "=" token("^(true|false|null)", "no word")
    else print path "=" token("^-?(0|[1-9][0-9]*)(\\.[0-9]+)?([eE][-+]?[0-9]+)?", "no number")
}
NR == 1 { text = $0 }
END {
    if (failed) exit 1
    at = 1
    if (NR != 1) fail(NR " lines")
    object("")
    blanks()
    if (at <= length(text)) fail("more behind the object")
}
