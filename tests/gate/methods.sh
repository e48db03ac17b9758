#!/bin/sh
# No method of the narrowest cone leans on another: each links with what all share and its own objects alone. The subsets of the
# pivot solver (min_norm) are in what all share only because the answer's form and the proofs of the debug build refer to them:
# the others solve sets with a min_norm that traps. And planted methods that do lean.
. tests/gate/verdict.sh
objects=build/gcc/firmware
shared='site site_axis certify cone_settle cone_answer witness'
dir=$(mktemp -d)

# A program in $dir/main.c with the shared objects and these.
link() { # MODULE...   of firmware/sphere/, or a path of an object
    list=
    for module in $shared "$@"; do
        case $module in
        */*) list="$list $module" ;;
        *) list="$list $objects/sphere/$module.o" ;;
        esac
    done
    gcc -std=c11 -Ifirmware "$dir/main.c" $list $objects/fixed/*.o -o "$dir/main" 2>"$dir/said"
}
links() { # FUNCTION MODULE...
    printf 'int %s(void);\nint main(void) { return %s(); }\n' "$1" "$1" >"$dir/main.c"
    shift
    link "$@"
}

nm "$objects/sphere/min_norm.o" | awk '$2 == "T" { print "void " $3 "(void); void " $3 "(void) { __builtin_trap(); }" }' >"$dir/trap.c"
[ "$(wc -l <"$dir/trap.c")" -ge 6 ]
verdict 'min_norm has functions to trap in' $?
gcc -c "$dir/trap.c" -o "$dir/trap.o"

# Ends with 0 if the method, on its own and with that trap, gets a narrowest cone, and a witness where there is none.
solves() { # HEADER CALL MODULE...
    cat >"$dir/main.c" <<END
#include "$1"
#include "sphere/cone.h"
static unsigned long long workspace[4096];
static enum cone_status solve(const struct vec3 *points, unsigned count, struct cone_result *result) {
    $2
}
int main(void) {
    const struct vec3 points[] = {{1, 1, 3}, {-1, 1, 3}, {0, 0, 1}, {-1, -1, 3}, {1, -1, 3}, {0, 1, 4}, {5, 2, -40}};
    struct cone_result result;
    const enum cone_status feasible = solve(points, 6, &result);
    const struct vec3 axis = result.axis_q30;
    return !(feasible == CONE_OK && axis.z == 1 << 30 && solve(points, 7, &result) == CONE_INFEASIBLE);
}
END
    shift 2
    link "$dir/trap.o" "$@" && "$dir/main"
}

diagram='struct voronoi_circle_result r; const struct voronoi_circle_options how = {.hull = HULL, .merge = MERGE};
    const enum cone_status status = voronoi_circle(points, count, &how, workspace, sizeof workspace, &r);
    *result = r.cone; return status;'
while read -r name function header result own; do
    if [ "$name" = pivot ]; then
        links "$function" min_norm $own
    else
        links "$function" "$dir/trap.o" $own
    fi
    linked=$?
    [ $linked -eq 0 ] || grep 'undefined' "$dir/said" | head -n 3
    verdict "method $name links without the others" $linked
    case $name in
    pivot) continue ;;
    voronoi*) call=$(echo "$diagram" | sed "s/HULL/$(case $name in *-hull*) echo 1 ;; *) echo 0 ;; esac)/; s/MERGE/$(case $name in *-merge*) echo 1 ;; *) echo 0 ;; esac)/") ;;
    *) call="struct $result r; const enum cone_status status = $function(points, count, workspace, sizeof workspace, &r);
    *result = r.cone; return status;" ;;
    esac
    solves "$header" "$call" $own
    verdict "method $name solves without the pivot solver's subsets" $?
done <<'END'
pivot cone_narrowest sphere/cone.h - cone cone_search cone_few cone_blocks cone_filter feasible
shrink shrink_narrowest sphere/shrink.h shrink_result shrink hull hull_order hull_filter
voronoi voronoi_circle sphere/voronoi_circle.h - voronoi_circle voronoi_mesh voronoi_insert voronoi_merge hull hull_order hull_filter
voronoi-merge voronoi_circle sphere/voronoi_circle.h - voronoi_circle voronoi_mesh voronoi_insert voronoi_merge hull hull_order hull_filter
voronoi-hull voronoi_circle sphere/voronoi_circle.h - voronoi_circle voronoi_mesh voronoi_insert voronoi_merge hull hull_order hull_filter
pyramid pyramid_narrowest sphere/pyramid.h pyramid_result pyramid
END

printf 'int pyramid_narrowest(void);\nint planted(void);\nint planted(void) { return pyramid_narrowest(); }\n' >"$dir/planted.c"
gcc -c "$dir/planted.c" -o "$dir/planted.o"
links planted "$dir/trap.o" "$dir/planted.o"
caught 'a method that calls another' $?
links planted "$dir/trap.o" "$dir/planted.o" pyramid
verdict 'the planted method links with what it calls' $?
(solves sphere/pyramid.h 'void min_norm_start(void);
    struct pyramid_result r;
    (void)result, min_norm_start();
    return pyramid_narrowest(points, count, workspace, sizeof workspace, &r);' pyramid) 2>/dev/null
trapped=$?
[ $trapped -gt 128 ]
verdict 'a method that uses the pivot solver is caught' $?
rm -r "$dir"
exit $status
