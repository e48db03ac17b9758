#!/bin/sh
# Draws the figures of docs/geometry.md and docs/regular.md from what `boresight` prints: `make figures`. Usage: draw.sh FOLDER
# tests/gate/figures.sh checks that the ones here are what this build of the program draws.
boresight=${BORESIGHT:-build/boresight}
out=$1
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

# svg TITLE: results as text of `aim --project` on stdin to a picture of 360 x 240, the middle where the camera looks. The cone's
# circle has the plot's radius; of a rectangle, the field of view tells the sides.
svg() {
    awk -v title="$1" -v radius="${2:-100}" '
        function put(x1, y1, x2, y2, class) {
            printf "<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", class, 180 + x1, 120 - y1, 180 + x2, 120 - y2
        }
        function tangent(degrees) { degrees *= 0.017453292519943295; return sin(degrees) / cos(degrees) }
        BEGIN {
            print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 360 240\" width=\"360\" height=\"240\">"
            print "<title>" title "</title>"
            print "<style>line{stroke:#456;stroke-width:1.2}.ray{stroke-dasharray:5 3}circle.cone,rect.frame{fill:none;stroke:#c40;stroke-width:1.2}"
            print "circle.point{fill:#456}circle.support{fill:#c40}.axis{stroke:#999;stroke-width:.8}rect.paper{fill:#fff}</style>"
            print "<rect class=\"paper\" width=\"360\" height=\"240\"/>"
        }
        $1 == "support" { for (i = 2; i <= NF; i++) holds[$i] = 1 }
        $1 == "half_angle_deg" { half = $2 }
        $1 == "hfov_deg" { hfov = $2 }
        $1 == "vfov_deg" { vfov = $2 }
        $1 == "scale" { scale = $2 }
        $1 == "image" || $1 == "segments" { list = $1; next }
        list == "segments" && $4 == "to" { put($2, $3, $5, $6, "edge") }
        list == "segments" && $4 == "direction" { put($2, $3, $2 + 400 * $5, $3 + 400 * $6, "ray") }
        list == "image" && $2 != "none:" { x[$1] = $2; y[$1] = $3; count++ }
        END {
            put(-4, 0, 4, 0, "axis")
            put(0, -4, 0, 4, "axis")
            for (i = 0; i < count; i++)
                printf "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"/>\n", i in holds ? "support" : "point", 180 + x[i], 120 - y[i]
            if (hfov != "") {
                w = tangent(hfov / 2) * scale
                h = tangent(vfov / 2) * scale
                printf "<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n", 180 - w, 120 - h, 2 * w, 2 * h
            } else {
                printf "<circle class=\"cone\" cx=\"180\" cy=\"120\" r=\"%.1f\"/>\n", radius
            }
            print "</svg>"
        }'
}

# A house, seen from a corner near the ground: corners, ridge, edges.
cat >"$dir/house" <<'END_OF'
-3 8 -1
5 11 -1
2 19 -1
-6 16 -1
-3 8 4
5 11 4
2 19 4
-6 16 4
-4.5 12 7
3.5 15 7
END_OF
awk '{ p[NR - 1] = $0 }
    END { n = split("0 1 1 2 2 3 3 0 4 5 5 6 6 7 7 4 0 4 1 5 2 6 3 7 4 8 7 8 5 9 6 9 8 9", e, " "); for (i = 1; i < n; i += 2) print p[e[i]], p[e[i + 1]] }' \
    "$dir/house" >"$dir/house.edges"
aim() { "$boresight" aim --project --plot-radius 100 "$@"; }
aim --segments "$dir/house.edges" "$dir/house" | svg 'The narrowest cone of a house: three corners hold it' >"$out/cone.svg" || exit 1
aim --segments "$dir/house.edges" --bounds box "$dir/house" | svg 'The same house, aimed at by the box round it' >"$out/box.svg" || exit 1
aim --segments "$dir/house.edges" --frame rect --aspect 3:2 "$dir/house" | svg 'The smallest 3:2 picture of the house, without roll' >"$out/rect.svg" || exit 1

# Rails that pass under the viewer: what lies behind has no image, but the rest of each rail has, as a ray.
printf '%s\n' '-1 4 -1.5' '1 4 -1.5' '-1 40 -1.5' '1 40 -1.5' '0 30 4' >"$dir/rails"
printf '%s\n' '-1 40 -1.5 -1 -20 -1.5' '1 40 -1.5 1 -20 -1.5' >"$dir/rails.edges"
for y in 4 6 9 14 22 40; do echo "-1.4 $y -1.5 1.4 $y -1.5"; done >>"$dir/rails.edges"
"$boresight" aim --project --plot-radius 80 --segments "$dir/rails.edges" "$dir/rails" |
    svg 'Rails that pass the viewer: a segment with an end behind is a ray' 80 >"$out/rails.svg"

# The farthest-point diagram of ten points round ahead, seen from outside along the axis of their cone: of all that is nearer than a
# quarter turn to the axis, the sites, the edges of the diagram, and the circle, whose centre is on an edge or at a vertex.
awk 'BEGIN { split("0.1 0.5 -0.55 0.15 0.6 0.05 -0.2 -0.6 0.35 -0.45 -0.35 0.45 0.45 0.4 -0.6 -0.25 0.05 0.1 0.62 -0.2", p, " ")
    for (i = 1; i < 20; i += 2) print p[i], 1, p[i + 1] }' >"$dir/sites"
{ "$boresight" aim "$dir/sites" && "$boresight" voronoi "$dir/sites" && sed 's/^/site /' "$dir/sites"; } | awk '
    function put(x, y, z,  s) { # sets X, Y, and F: how far in front
        s = 100 / sqrt(x * x + y * y + z * z)
        X = 180 + s * (x * right[1] + y * right[2] + z * right[3])
        Y = 120 - s * (x * up[1] + y * up[2] + z * up[3])
        F = s * (x * ahead[1] + y * ahead[2] + z * ahead[3])
    }
    BEGIN { sites = edges = 0 }
    function axis(a,  i) { for (i = 1; i <= 3; i++) a[i] = $(i + 1) / 1073741824 }
    function arc(v, w,  i, c, all, a, b, path, drawn) {
        c = (vx[v] * vx[w] + vy[v] * vy[w] + vz[v] * vz[w]) / 1152921504606846976
        all = c * c < 1 ? atan2(sqrt(1 - c * c), c) : 0
        for (i = 0; i <= 60; i++) {
            a = sin(all * (60 - i) / 60)
            b = sin(all * i / 60)
            put(vx[v] * a + vx[w] * b, vy[v] * a + vy[w] * b, vz[v] * a + vz[w] * b)
            if (F > 0) { path = path sprintf("%s%.1f %.1f", drawn ? "L" : "M", X, Y); drawn = 1 } else drawn = 0
        }
        if (path != "") printf "<path class=\"edge\" d=\"%s\"/>\n", path
    }
    $1 == "ahead_q30" { axis(ahead) }
    $1 == "right_q30" { axis(right) }
    $1 == "up_q30" { axis(up) }
    $1 == "half_angle_deg" { half = $2 * 0.017453292519943295 }
    $1 == "support" { for (i = 2; i <= NF; i++) holds[$i] = 1 }
    $1 == "vertex" { vx[$2] = $3; vy[$2] = $4; vz[$2] = $5 }
    $1 == "edge" { from[edges] = $(NF - 1); to[edges++] = $NF }
    $1 == "site" { x[sites] = $2; y[sites] = $3; z[sites++] = $4 }
    END {
        print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 360 240\" width=\"360\" height=\"240\">"
        print "<title>A farthest-point diagram: the centre of the smallest circle is on it</title>"
        print "<style>.paper{fill:#fff}.sphere{fill:none;stroke:#999;stroke-width:.8}.edge{fill:none;stroke:#68a;stroke-width:1.2}.cone{fill:none;stroke:#c40;stroke-width:1.2}.point{fill:#456}.support,.middle{fill:#c40}</style>"
        print "<rect class=\"paper\" width=\"360\" height=\"240\"/>\n<circle class=\"sphere\" cx=\"180\" cy=\"120\" r=\"100\"/>"
        for (i = 0; i < edges; i++) arc(from[i], to[i])
        printf "<circle class=\"cone\" cx=\"180\" cy=\"120\" r=\"%.1f\"/>\n<circle class=\"middle\" cx=\"180\" cy=\"120\" r=\"2\"/>\n", 100 * sin(half)
        for (i = 0; i < sites; i++) { put(x[i], y[i], z[i]); printf "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"/>\n", i in holds ? "support" : "point", X, Y }
        print "</svg>"
    }' >"$out/voronoi.svg" || exit 1

# From a place on the line through two corners of the house, and from one that is free of that.
aim --viewpoint 21,17,14 --segments "$dir/house.edges" "$dir/house" | svg 'From the line through two corners one hides the other' >"$out/lineup.svg" || exit 1
aim --viewpoint -3.13,20.54,27.55 --segments "$dir/house.edges" "$dir/house" | svg 'From a mount that the planner proposed' >"$out/apart.svg" || exit 1

# Five points: what is forbidden in a parallel projection, and the best direction as `regular` prints it, seen by a mount 300 times
# as far away as they are; and the sphere through a mount near them.
printf '%s\n' '0 0 0' '10 0 0' '0 20 0' '3 2 15' '10 12 4' >"$dir/points"
along() { # PROBLEM
    "$boresight" regular "$1" optimize "$dir/points" |
        awk '$1 == "direction" { s = ($4 < 0 ? -5000 : 5000) / sqrt($2 * $2 + $3 * $3 + $4 * $4); printf "%.3f %.3f %.3f\n", $2 * s, $3 * s, $4 * s }' >"$dir/mount"
}
sphere() { # NAME OPTION...
    name=$1
    shift
    "$boresight" plan --mounts "$dir/mount" --picture "$out/$name.svg" "$@" "$dir/points" >/dev/null || exit 1
}
along points3-line
sphere sphere-points --lines
along points3-plane
sphere sphere-circles
echo '21.52 -14.8 44.28' >"$dir/mount"
sphere sphere-near

# The circle of directions of points in the plane: a forbidden direction and its opposite for each pair, the best direction and its gap.
printf '%s\n' '0 0' '1 3' '4 1' '5 5' '2 6' >"$dir/plane"
{ "$boresight" regular points2-line optimize "$dir/plane" && cat "$dir/plane"; } | awk '
    function ray(angle, from, to, class) {
        printf "<line class=\"%s\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", class, 200 + from * cos(angle), 120 - from * sin(angle), 200 + to * cos(angle), 120 - to * sin(angle)
    }
    function gap(middle) {
        printf "<path class=\"gap\" d=\"M200 120L%.1f %.1fA100 100 0 0 0 %.1f %.1fZ\"/>\n", 200 + 100 * cos(middle - tolerance), 120 - 100 * sin(middle - tolerance), 200 + 100 * cos(middle + tolerance), 120 - 100 * sin(middle + tolerance)
    }
    $1 == "direction" { best = atan2($3, $2); next }
    $1 == "tolerance_rad" { tolerance = $2; next }
    NF == 2 && $1 + 0 == $1 { x[count] = $1; y[count++] = $2 }
    END {
        pi = atan2(0, -1)
        print "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 400 240\" width=\"400\" height=\"240\">"
        print "<title>Forbidden directions in the plane, and the widest gap</title>"
        print "<style>.paper{fill:#fff}circle{fill:none;stroke:#456}.point{fill:#2a7;stroke:none}.gap{fill:#c40;fill-opacity:.15;stroke:#c40}.best{stroke:#c40;stroke-width:1.5}.forbidden{stroke:#68a;stroke-width:.8}</style>"
        print "<rect class=\"paper\" width=\"400\" height=\"240\"/>"
        gap(best)
        gap(best + pi)
        for (i = 0; i < count; i++) for (j = 0; j < i; j++) {
            angle = atan2(y[i] - y[j], x[i] - x[j])
            ray(angle, -100, 100, "forbidden")
        }
        ray(best, -100, 100, "best")
        print "<circle cx=\"200\" cy=\"120\" r=\"100\"/>"
        for (i = 0; i < count; i++) printf "<circle class=\"point\" cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\"/>\n", 200 + 7 * (x[i] - 2.5), 120 - 7 * (y[i] - 3)
        print "</svg>"
    }' >"$out/gap.svg" || exit 1
