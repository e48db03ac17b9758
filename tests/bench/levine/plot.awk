# Draws the pictures of docs/levine.md: awk -v dir=OUT -f axis.awk -f plot.awk plots.txt DOC SWEEPS. plots.txt explains its lines. What is drawn comes from the tables
# of the page itself, but for the degree-by-degree ones.
function trimmed(text) { sub(/^ +/, "", text); sub(/ +$/, "", text); return text }
function is_number(text) { return text ~ /^-?[0-9]/ }
# ---------------------------------------------------------------- reading
FNR == 1 { file++ }
file == 1 { if (!/^#/ && NF > 0) { plan[++plans] = $0 } next }
/^<!-- .* -->$/ { table = $2; heading = 0; next }
/^\|---/ { heading = 1; next }
/^\|/ && heading {
    n = split($0, part, "|")
    rows[table]++
    for (i = 2; i < n; i++) { cell[table, rows[table], i - 1] = trimmed(part[i]) }
    next
}
/^@sweep / {
    n = split(substr($0, 8), part, ";")
    for (i = 4; i <= n; i++) { swept[part[1], part[2], part[3] + 0, i - 3] = part[i] }
    next
}
{ heading = 0 }
# ---------------------------------------------------------------- what is drawn
function new_panel(title) { panels++; panel_title[panels] = title; series_count[panels] = 0; panel_kind[panels] = "lines" }
function new_series(name) {
    series_count[panels]++
    series_name[panels, series_count[panels]] = name
    points[panels, series_count[panels]] = 0
}
function add_point(x, y, s, k) {
    if (!is_number(x) || !is_number(y)) { return }
    s = series_count[panels]
    k = ++points[panels, s]
    px[panels, s, k] = x + 0
    py[panels, s, k] = y + 0
}
function read_lines(table, x, y, keys, key, name_of, n, i, r, parts) { # a line for each kind
    n = split(keys, parts, ",")
    for (i = 1; i <= n; i++) {
        name_of = key = trimmed(parts[i])
        sub(/.*=/, "", name_of)
        sub(/=.*/, "", key)
        new_series(name_of)
        for (r = 1; r <= rows[table]; r++) {
            if (matches(table, r, key)) { add_point(cell[table, r, x], cell[table, r, y]) }
        }
    }
}
function matches(table, r, key, parts, n) { # A+B: the first two cells
    n = split(key, parts, "+")
    return cell[table, r, 1] == parts[1] && (n < 2 || cell[table, r, 2] == parts[2])
}
function read_parts(table, x, y, key, names, n, i, r, parts, inner) { # a line for each number of a cell
    n = split(names, parts, ",")
    for (i = 1; i <= n; i++) {
        new_series(trimmed(parts[i]))
        for (r = 1; r <= rows[table]; r++) {
            if (cell[table, r, 1] == key) {
                split(cell[table, r, y], inner, "/")
                add_point(cell[table, r, x], trimmed(inner[i]))
            }
        }
    }
}
function read_columns(table, x, columns, key, names, n, i, r, parts, titles) { # a line for each column
    n = split(columns, parts, ",")
    split(names, titles, ",")
    for (i = 1; i <= n; i++) {
        new_series(trimmed(titles[i]))
        for (r = 1; r <= rows[table]; r++) {
            if (key == "*" || cell[table, r, 1] == key) { add_point(cell[table, r, x], cell[table, r, parts[i]]) }
        }
    }
}
function read_scenes(table, x, y, r, last) { # the lattices as a line, each other scene by itself
    new_series("cubes")
    for (r = 1; r <= rows[table]; r++) {
        if (cell[table, r, 2] ~ /^(both|[0-9]+)$/) {
            if (cell[table, r, 1] !~ /^[0-9]+ cubes$/) { new_series(cell[table, r, 1]) }
            add_point(cell[table, r, x], cell[table, r, y])
        }
    }
}
function read_bins(table, key, column, first, width, r, n, i, parts) {
    panel_kind[panels] = "bars"
    new_series("")
    for (r = 1; r <= rows[table]; r++) {
        if (cell[table, r, 1] == key) {
            if (first == "row") { first = cell[table, r, 2]; width = cell[table, r, 3] }
            n = split(cell[table, r, column], parts, " ")
            for (i = 1; i <= n; i++) { add_point(first + (i - 1) * width, parts[i]) }
            bar_width[panels] = width
        }
    }
}
function read_sweep(scene, turn, columns, names, n, i, d, parts, titles) {
    panel_kind[panels] = "sweep"
    n = split(columns, parts, ",")
    split(names, titles, ",")
    for (i = 1; i <= n; i++) {
        new_series(trimmed(titles[i]))
        for (d = 0; d < 360; d++) { add_point(d, swept[scene, turn, d, parts[i] + 0] "") }
    }
}
# ---------------------------------------------------------------- drawing
function say(text) { printf "%s\n", text > out }
function line(x1, y1, x2, y2, class) { say(sprintf("<path class=\"%s\" d=\"M%.1f %.1fL%.1f %.1f\"/>", class, x1, y1, x2, y2)) }
function text_at(x, y, class, text) { say(sprintf("<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">%s</text>", class, x, y, text)) }
function bounds(p, which, s, k, v) { # of one panel, or of all if p is 0: the lowest and highest x or y
    for (panel = p ? p : 1; panel <= (p ? p : panels); panel++) {
        for (s = 1; s <= series_count[panel]; s++) {
            for (k = 1; k <= points[panel, s]; k++) {
                v = which == "x" ? px[panel, s, k] : py[panel, s, k]
                if (!any || v < lowest) { lowest = v }
                if (!any || v > highest) { highest = v }
                any = 1
            }
        }
    }
}
function x_axis(p, i) {
    any = 0
    bounds(panel_kind[p] == "bars" ? p : shared ? 0 : p, "x")
    if (panel_kind[p] == "bars") { highest += bar_width[p] }
    axis_choose(panel_kind[p] == "bars" && lowest > 0 && highest >= 20 * lowest ? 0 : lowest, highest, panel_kind[p] == "sweep")
    for (i = 1; i <= axis_ticks; i++) {
        line(left + axis_at(axis_tick[i]) * width, top, left + axis_at(axis_tick[i]) * width, top + height, "g")
        text_at(left + axis_at(axis_tick[i]) * width, top + height + 11, "m", axis_label(axis_tick[i]))
    }
    x_log = axis_log; x_low = axis_low; x_high = axis_high
}
function x_of(v) { return left + width * (x_log ? log(v / x_low) / log(x_high / x_low) : (v - x_low) / (x_high - x_low)) }
function y_of(v) { return top + height * (1 - axis_at(v)) }
function y_axis(p, i) {
    any = 0
    bounds(shared && panel_kind[p] != "bars" ? 0 : p, "y")
    axis_choose(panel_kind[p] == "bars" ? 0 : lowest, highest, 0)
    for (i = 1; i <= axis_ticks; i++) {
        line(left, y_of(axis_tick[i]), left + width, y_of(axis_tick[i]), "g")
        text_at(left - 3, y_of(axis_tick[i]) + 3, "e", axis_label(axis_tick[i]))
    }
}
function draw_series(p, s, k, path, x, y, lx, ly) {
    for (k = 1; k <= points[p, s]; k++) {
        x = x_of(px[p, s, k])
        y = y_of(py[p, s, k])
        if (panel_kind[p] == "bars") {
            path = path sprintf("M%.1f %.1fV%.1fH%.1fV%.1fz", x, y_of(0), y, x_of(px[p, s, k] + bar_width[p]), y_of(0))
        } else if (panel_kind[p] == "sweep") { # whole pixels, each from the last
            x = int(x + 0.5)
            y = int(y + 0.5)
            path = path (k == 1 ? "M" x " " y "l" : (x - lx) (y < ly ? "" : " ") (y - ly) " ")
            lx = x
            ly = y
        } else {
            path = path sprintf("%s%.1f %.1f", k == 1 ? "M" : "L", x, y)
            say(sprintf("<circle class=\"d%d\" cx=\"%.1f\" cy=\"%.1f\" r=\"1.8\"/>", s, x, y))
        }
    }
    sub(/ $/, "", path)
    if (path != "") { say("<path class=\"" (panel_kind[p] == "bars" ? "b" : "s" s) "\" d=\"" path "\"/>") }
}
function draw_panel(p, s) {
    left = 42 + ((p - 1) % columns) * cell_width
    top = 42 + int((p - 1) / columns) * cell_height
    text_at(left + width / 2, top - 5, "m t", panel_title[p] (same_series() ? "" : names_of(p)))
    x_axis(p)
    y_axis(p)
    line(left, top + height, left + width, top + height, "a")
    line(left, top, left, top + height, "a")
    for (s = 1; s <= series_count[p]; s++) { draw_series(p, s) }
}
function same_series(p, s) { # Have all panels the same lines? Then one legend will do.
    for (p = 2; p <= panels; p++) {
        if (series_count[p] != series_count[1]) { return 0 }
        for (s = 1; s <= series_count[p]; s++) { if (series_name[p, s] != series_name[1, s]) { return 0 } }
    }
    return 1
}
function names_of(p, s, text) {
    for (s = 1; s <= series_count[p] && panel_kind[p] != "bars"; s++) {
        text = text (s == 1 ? ": " : ", ") "<tspan class=\"d" s "\">" series_name[p, s] "</tspan>"
    }
    return text
}
function draw_figure(s, x) {
    width = wide ? 360 : 170
    height = wide ? 130 : 110
    cell_width = width + 54
    cell_height = height + 42
    out = dir "/" name ".svg"
    x = columns * cell_width + 4
    say("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " x " " 30 + cell_height * int((panels + columns - 1) / columns) "\">")
    say("<title>" title "</title><style>text{font:9px sans-serif;fill:#333}.m{text-anchor:middle}.e{text-anchor:end}.t{font-weight:bold}path{fill:none;stroke-width:1.2}")
    say(".a{stroke:#333;stroke-width:.8}.g{stroke:#ddd;stroke-width:.6}.b{fill:#9ab;stroke:#456;stroke-width:.5}.s1{stroke:#06c}.s2{stroke:#c40}.s3{stroke:#080}.s4{stroke:#a0a}")
    say(".d1{fill:#06c}.d2{fill:#c40}.d3{fill:#080}.d4{fill:#a0a}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>")
    text_at(8, 14, "t", title)
    x = 8 + 5.6 * length(title) + 20
    for (s = 1; s <= series_count[1] && same_series(); s++) {
        if (series_name[1, s] != "") {
            line(x, 11, x + 14, 11, "s" s)
            text_at(x + 18, 14, "", series_name[1, s])
            x += 30 + 5.5 * length(series_name[1, s])
        }
    }
    for (s = 1; s <= panels; s++) { draw_panel(s) }
    say("</svg>")
    close(out)
    panels = 0
}
END {
    for (i = 1; i <= plans; i++) {
        fields = split(plan[i], f, ";")
        for (k = 1; k <= fields; k++) { f[k] = trimmed(f[k]) }
        word = f[1]
        sub(/ .*/, "", word)
        rest = trimmed(substr(f[1], length(word) + 1))
        if (word == "figure") {
            if (panels) { draw_figure() }
            name = rest; title = f[2]; columns = f[3] + 0; shared = f[4] == "shared"; wide = f[4] == "wide"
            continue
        }
        new_panel(rest)
        if (word == "lines") { read_lines(f[2], f[3] + 0, f[4] + 0, f[5]) }
        else if (word == "parts") { read_parts(f[2], f[3] + 0, f[4] + 0, f[5], f[6]) }
        else if (word == "columns") { read_columns(f[2], f[3] + 0, f[4], f[5], f[6]) }
        else if (word == "scenes") { read_scenes(f[2], f[3] + 0, f[4] + 0) }
        else if (word == "bins") { read_bins(f[2], f[3], f[4] + 0, f[5], f[6] + 0) }
        else if (word == "sweep") { read_sweep(f[2], f[3], f[4], f[5]) }
        else { print "plots.txt: what is " word "?" > "/dev/stderr"; exit 1 }
        total = 0
        for (k = 1; k <= series_count[panels]; k++) { total += points[panels, k] }
        if (!total) { print "plots.txt: nothing to draw: " plan[i] > "/dev/stderr"; exit 1 }
    }
    draw_figure()
}
