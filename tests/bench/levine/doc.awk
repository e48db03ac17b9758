# docs/levine.md from its text and the runs: awk -f doc.awk THESIS RESULTS... TEXT
# In the text `<!-- NAME -->` before a table's header names it: its rows come from `@table NAME` of the results. {NAME} is `@value NAME`.
function number(v) { return v == int(v) && v < 1e15 ? sprintf("%d", v) : sprintf(v < 10 && v > -10 ? "%.2f" : v < 1000 ? "%.1f" : "%.0f", v) }
function trimmed(text) { sub(/^ +/, "", text); sub(/ +$/, "", text); return text }
function compare(line, f, range, v, verdict) {
    split(line, f, "|")
    v = value[trimmed(f[5])]
    if (v == "") { missing(trimmed(f[5])) }
    split(trimmed(f[4]), range, " ")
    verdict = range[1] == "-" ? "" : v + 0 >= range[1] + 0 && v + 0 <= range[2] + 0 ? "same" : "**differs**"
    printf "| %s | %s | %s | %s | %s |\n", trimmed(f[1]), trimmed(f[2]), trimmed(f[3]), number(v), verdict
}
function missing(name) { print "levine: no " name " in the results" > "/dev/stderr"; failed = 1; exit 1 }
function filled(text, name) {
    while (match(text, /\{[a-z_0-9]+\}/)) {
        name = substr(text, RSTART + 1, RLENGTH - 2)
        if (!(name in value)) { missing(name) }
        text = substr(text, 1, RSTART - 1) number(value[name]) substr(text, RSTART + RLENGTH)
    }
    return text
}
FNR == 1 { file++ }
file == 1 { if (!/^#/ && NF > 0) { thesis[++figures] = $0 } next }
/^@table / { table = $2; next }
/^@value / { value[$2] = $3; next }
/^@sweep / { next }
FILENAME !~ /\.in$/ { rows[table] = rows[table] $0 "\n"; next }
FNR == 1 { print "<!-- Written by `make bench-levine` from tests/bench/levine/levine.md.in: don't edit. -->" }
/^<!-- .* -->$/ { name = $2 }
{ print filled($0) }
/^\|---/ {
    if (name == "thesis") { for (i = 1; i <= figures; i++) { compare(thesis[i]) } }
    else if (rows[name] == "") { missing("table " name) }
    else { printf "%s", rows[name] }
}
END { exit failed }
