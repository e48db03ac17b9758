# How a detector's boxes fit people. Usage: awk -v fps=10 [-v score_min=1] -f film.awk PEOPLE TARGETS.jsonl
# PEOPLE: hand labels, `frame u v` a line; or, with score_min, a person detector's boxes as in pedestrians.csv.
# Prints `found of persons, boxes without one`.
function low(a, b) { return a < b ? a : b }
function high(a, b) { return a > b ? a : b }
function list(name,  at) {
    at = index($0, "\"" name "\": [") + length(name) + 5
    return substr($0, at, index(substr($0, at), "]") - 1)
}
FNR == 1 { file++ }
file == 1 && score_min == "" && /^[0-9]/ { n[$1]++; u[$1, n[$1]] = $2; v[$1, n[$1]] = $3; frames[$1] = 1 }
file == 1 && score_min != "" && FNR > 1 {
    split($0, c, ",")
    frame = int(c[1] * fps / 1000 + 0.5)
    # The background has to be learned first; such a detector's boxes are wider and higher than the person.
    if (frame >= fps && c[6] + 0 >= score_min + 0) {
        n[frame]++
        frames[frame] = 1
        left[frame, n[frame]] = c[2] + 0.15 * c[4]
        right[frame, n[frame]] = c[2] + 0.85 * c[4]
        top[frame, n[frame]] = c[3] + 0.08 * c[5]
        bottom[frame, n[frame]] = c[3] + 0.92 * c[5]
    }
}
file == 2 && /"box"/ {
    match($0, /"t_us": [0-9]+/)
    frame = int(substr($0, RSTART + 8, RLENGTH - 8) * fps / 1e6 + 0.5)
    if (frame in frames) {
        m[frame]++
        split(list("box"), b, ", ")
        for (k = 1; k <= 4; k++) box[frame, m[frame], k] = b[k]
    }
}
END {
    for (frame in frames) for (i = 1; i <= n[frame]; i++) {
        persons++
        best = 0
        for (j = 1; j <= m[frame]; j++) {
            if (score_min == "") {
                x = u[frame, i]; y = v[frame, i]
                common = x >= box[frame, j, 1] && x <= box[frame, j, 3] && y >= box[frame, j, 2] && y <= box[frame, j, 4]
            } else {
                wide = low(right[frame, i], box[frame, j, 3]) - high(left[frame, i], box[frame, j, 1])
                tall = low(bottom[frame, i], box[frame, j, 4]) - high(top[frame, i], box[frame, j, 2])
                common = wide > 0 && tall > 0 ? wide * tall / (right[frame, i] - left[frame, i]) / (bottom[frame, i] - top[frame, i]) : 0
            }
            if (common > 0) hit[frame, j] = 1
            best = high(best, common)
        }
        found += best >= 0.5
        if (best < 0.5 && show) print "missed", frame, u[frame, i], v[frame, i]
    }
    for (frame in frames) for (j = 1; j <= m[frame]; j++) none += !((frame, j) in hit)
    print found + 0, persons + 0, none + 0
}
