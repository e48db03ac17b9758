#!/bin/sh
# docs/levine.md is what this build counts and draws: some rows of each table are made again, and all pictures from the tables; `make bench-levine` mends it.
. tests/gate/verdict.sh
levine=tests/bench/levine
dir=$(mktemp -d)

# rows DOC: each row of $dir/few is in the table of that name; none of the tables without a row.
rows() {
    awk '
        FNR == 1 { file++ }
        file == 1 && /^<!-- .* -->$/ { table = $2 }
        file == 1 && /^\|/ { held[table, $0] = 1 }
        file == 2 && /^@table / { table = $2; tables++ }
        file == 2 && /^\|/ { rows++; if (!((table, $0) in held)) { print "not in docs/levine.md, table " table ": " $0; wrong = 1 } }
        END { exit wrong || tables < 10 || rows < 60 }
    ' "$1" "$dir/few"
}
# prose DOC TEXT: every line of the text that holds no number of a run is in the page, in this order.
prose() {
    awk '
        FNR == 1 { file++ }
        file == 1 { page[++lines] = $0; next }
        /\{[a-z_0-9]+\}/ { next }
        { for (at++; at <= lines && page[at] != $0; at++) { } if (at > lines) { print "not in docs/levine.md: " $0; exit 1 } }
    ' "$1" "$2"
}
# pictures DOC: what the tables of the page draw is in docs/pictures, and no other picture of that name.
pictures() {
    rm -rf "$dir/pictures" && mkdir "$dir/pictures" &&
        awk -v dir="$dir/pictures" -f $levine/axis.awk -f $levine/plot.awk $levine/plots.txt "$1" "$dir/sweep" || return 1
    for picture in docs/pictures/levine-*.svg "$dir"/pictures/*.svg; do
        cmp -s "$dir/pictures/${picture##*/}" "docs/pictures/${picture##*/}" || { echo "differs: ${picture##*/}"; return 1; }
    done
}
# axes AWK: the scalings against those worked out by hand from the rule of the page. LOWEST HIGHEST ANGLE, log or linear, the ticks.
axes() {
    cat >"$dir/axes.awk" <<'END'
{
    wanted = $4
    axis_choose($1, $2, $3)
    got = axis_log ? "log" : "linear"
    for (i = 1; i <= axis_ticks; i++) { got = got " " axis_tick[i] }
    for (i = 5; i <= NF; i++) { wanted = wanted " " $i }
    if (got != wanted) { print "axis " $1 " to " $2 ": " got ", not " wanted; wrong = 1 }
}
END { exit wrong }
END
    awk -f "$1" -f "$dir/axes.awk" <<'END'
1 19.9 0 linear 0 5 10 15 20
1 20 0 log 1 2 5 10 20
25 3200 0 log 20 50 100 200 500 1000 2000 5000
3 500 0 log 2 5 10 20 50 100 200 500
3 700 0 log 1 10 100 1000
1 15366 0 log 1 10 100 1000 10000 100000
4 60000000 0 log 1 100 10000 1000000 100000000
0 999 0 linear 0 200 400 600 800 1000
0.71 0.99 0 linear 0.7 0.8 0.9 1
80 95 0 linear 80 85 90 95
40 95 0 linear 0 20 40 60 80 100
0 359 1 linear 0 90 180 270 360
END
}
for part in hull sphere trials dimensions hidden large retrieval; do
    build/bench-levine $part few >>"$dir/few" || echo "| $part failed |" >>"$dir/few"
done
build/bench-levine sweep >"$dir/sweep"
rows docs/levine.md
verdict 'a part of the tables of docs/levine.md' $?
prose docs/levine.md $levine/levine.md.in
verdict 'the text of docs/levine.md' $?
pictures docs/levine.md
verdict 'the pictures of docs/levine.md' $?
axes $levine/axis.awk
verdict 'the scaling of the axes' $?

sed 's/^| city | yaw | 192 | \(.*\) |$/| city | yaw | 192 | \11 |/' docs/levine.md >"$dir/page"
rows "$dir/page" >"$dir/out"
caught 'a row of another count' $?
sed 's/^| ellipse | 1600 | 500 | 17/| ellipse | 1600 | 500 | 18/' docs/levine.md >"$dir/page"
pictures "$dir/page" >"$dir/out"
caught 'a picture of another count' $?
sed 's/^# Levine/# Levin/' docs/levine.md >"$dir/page"
prose "$dir/page" $levine/levine.md.in >"$dir/out"
caught 'a page of another text' $?
sed 's/highest >= 20/highest >= 25/' $levine/axis.awk >"$dir/axis.awk"
axes "$dir/axis.awk" >"$dir/out"
caught 'another rule for the axes' $?
rm -r "$dir"
exit $status
