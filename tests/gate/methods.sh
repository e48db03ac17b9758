#!/bin/sh
# No method of the narrowest cone leans on another: each links with what all share and its own objects alone. And a
# planted method that does.
. tests/gate/verdict.sh
objects=build/gcc/firmware
shared='site site_axis certify cone_settle cone_answer witness min_norm'
dir=$(mktemp -d)

links() { # FUNCTION MODULE...   of firmware/sphere/, or a path of an object
    printf 'int %s(void);\nint main(void) { return %s(); }\n' "$1" "$1" >"$dir/main.c"
    shift
    list=
    for module in $shared "$@"; do
        case $module in
        */*) list="$list $module" ;;
        *) list="$list $objects/sphere/$module.o" ;;
        esac
    done
    gcc "$dir/main.c" $list $objects/fixed/*.o -o "$dir/main" 2>"$dir/said"
}

while read -r name function own; do
    links "$function" $own
    linked=$?
    [ $linked -eq 0 ] || grep 'undefined' "$dir/said" | head -n 3
    verdict "method $name links without the others" $linked
done <<'END'
pivot cone_narrowest cone cone_filter feasible
shrink shrink_narrowest shrink hull hull_order hull_filter
voronoi voronoi_circle voronoi_circle voronoi_mesh voronoi_insert voronoi_merge hull hull_order hull_filter
pyramid pyramid_narrowest pyramid
END

printf 'int pyramid_narrowest(void);\nint planted(void);\nint planted(void) { return pyramid_narrowest(); }\n' >"$dir/planted.c"
gcc -c "$dir/planted.c" -o "$dir/planted.o"
links planted "$dir/planted.o"
caught 'a method that calls another' $?
links planted "$dir/planted.o" pyramid
verdict 'the planted method links with what it calls' $?
rm -r "$dir"
exit $status
