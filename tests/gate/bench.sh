#!/bin/sh
# `make bench-cone` still runs: small sets, without the other programs and without callgrind. Every method is in the table, right
# (the program compares their answers), and stops where its cost says so.
. tests/gate/verdict.sh
dir=$(mktemp -d)
: >"$dir/counts"
build/bench-cone-alone table "$dir/counts" 2 4 >"$dir/out" 2>/dev/null
verdict 'the benchmark runs to its end, and its methods agree' $?
rows() { # SET METHOD
    grep "^$1  *1[06]*0*  *$2 *|" "$dir/out" | grep -cv stops
}
missing=0
for set in 'uniform cap 20' 'truncated cone' 'planar normal' 'fixed silhouette' 'on a circle' 'half a circle' 'exact circle' \
    near-hemisphere spiral 'surface (1982)'; do
    for method in 'bare pass' pivot 'pivot, warm' 'growing circle' 'algorithm C' 'algorithm A' 'A by merging' 'algorithm B' \
        'pyramid (1982)' hull 'hull, buckets' 'hull, sorted' 'centroid aim' 'box-centre aim'; do
        [ "$(rows "$set" "$method")" -eq 2 ] || { echo "$set, $method: no row"; missing=1; }
    done
    grep -q "^$set *| .* yes\|^$set *| .* no" "$dir/out" || { echo "$set: no equations"; missing=1; }
done
verdict 'all methods on all families' $missing
grep -q '^[0-9]* of [0-9]* reached$' "$dir/out"
verdict 'verdicts on what is to be reached' $?
# 10 points of method 5 (algorithm A) on set 0 took 10^10 instructions: ten times as many points would take more than is allowed.
echo '0 0 5 10 1e10' >"$dir/counts"
build/bench-cone-alone table "$dir/counts" 2 4 >"$dir/out" 2>/dev/null
[ "$(grep -c stops "$dir/out")" -eq 1 ] && grep -q '^uniform cap 20 *100 algorithm A *| stops: about 1e+11 instructions$' "$dir/out"
verdict 'a method stops before what takes too long, and says so' $?
rm -r "$dir"
exit $status
