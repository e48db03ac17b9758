#!/bin/sh
# Results of `voronoi`: fields, forms, exit statuses. tests/property/voronoi_exact.c has the geometry.
. tests/cli/support/check.sh

# Four sites around the viewpoint: the corners of a tetrahedron, each twice as far as it need be.
printf 'a 2 2 2\nb 2 -2 -2\nc -2 2 -2\nd -2 -2 2\na2 1 1 1\n' >"$dir/points.txt"
run voronoi --named --closest --json "$dir/points.txt"
has 'voronoi --closest --json' 0 'sites[0]=0' 'sites[3]=3' \
    'vertices[0].at_q30[0]=619925131' 'vertices[0].at_q30[1]=619925131' 'vertices[0].at_q30[2]=-619925131' \
    'vertices[0].sites[0]=0' 'vertices[0].sites[2]=2' 'vertices[3].sites[0]=1' \
    'edges[0].sites[0]=0' 'edges[0].sites[1]=1' 'edges[0].vertices[0]=0' 'edges[0].vertices[1]=1' \
    'edges[5].sites[0]=2' 'edges[5].sites[1]=3'
facts
sed 's/=.*//; s/\[.*//' "$dir/facts" | uniq | tr '\n' ' ' >"$dir/names"
printf 'sites vertices edges ' | cmp -s - "$dir/names"
verdict 'voronoi --json: all fields and no others' $?
cp "$dir/out" "$dir/seen"
run voronoi --named --closest --construction merge --json "$dir/points.txt"
cmp -s "$dir/out" "$dir/seen"
verdict 'both constructions print the same' $?

# Lemma 1: the farthest-point diagram is the closest-point diagram of the opposite points.
run voronoi --json --named "$dir/points.txt"
cp "$dir/out" "$dir/seen"
awk '{ print -$2, -$3, -$4 }' "$dir/points.txt" | { run voronoi --closest --json; cp "$dir/out" "$dir/opposite"; }
cmp -s "$dir/opposite" "$dir/seen"
verdict 'Lemma 1 on the command line' $?

run voronoi --named "$dir/points.txt"
cat >"$dir/wanted" <<'END'
sites             0 (a) 1 (b) 2 (c) 3 (d)
vertices          4
edges             6
vertex 0          -619925131 -619925131 619925131  sites 0 1 2
vertex 1          -619925131 619925131 -619925131  sites 0 1 3
vertex 2          619925131 -619925131 -619925131  sites 0 2 3
vertex 3          619925131 619925131 619925131  sites 1 2 3
edge 0            sites 0 1  vertices 0 1
edge 1            sites 0 2  vertices 0 2
edge 2            sites 0 3  vertices 1 2
edge 3            sites 1 2  vertices 0 3
edge 4            sites 1 3  vertices 1 3
edge 5            sites 2 3  vertices 2 3
END
cmp -s "$dir/out" "$dir/wanted"
verdict 'voronoi as text: the same facts' $?

printf '1 0 0\n-1 0 0\n' >"$dir/points.txt"
run voronoi --json "$dir/points.txt"
printf '{"sites": [0, 1], "vertices": [], "edges": [{"sites": [0, 1], "vertices": []}]}\n' | cmp -s - "$dir/out"
verdict 'two sites: a whole great circle' $?
run voronoi "$dir/points.txt"
grep -q '^edge 0            sites 0 1  a whole great circle$' "$dir/out"
verdict 'two sites as text' $?
run voronoi --json <"$dir/none"
printf '{"sites": [], "vertices": [], "edges": []}\n' | cmp -s - "$dir/out" && [ "$status" -eq 0 ]
verdict 'no points: an empty diagram' $?
printf '1 0 0\n0 0 0\n' >"$dir/points.txt"
run voronoi "$dir/points.txt"
ends 'a point at the viewpoint' 2 "$dir/points.txt:2: the point is at the viewpoint: it has no direction"
run voronoi --construction magic <"$dir/none"
ends 'an unknown construction' 2 "boresight voronoi: --construction 'magic': choose one of insert, merge"

finish
