#!/bin/sh
# The geometry and the controller give the same numbers on every processor and with every compiler: each module's digest
# (tests/mcu/digest/), on the host by gcc, clang and under the sanitizers, and under QEMU by gcc and clang.
. tests/gate/verdict.sh
dir=$(mktemp -d)
trap 'rm -r "$dir"' EXIT

# The lines that count, from a program's output; at least one a test of the program, or there is nothing to compare.
digests() { # OUTPUT
    awk '/^# digest / { n++; print } /^ok / { ok++ } END { exit !(n > 0 && n == ok) }' "$1"
}
same() { # WANTED OUTPUT
    digests "$2" >"$dir/got" || { echo '  not every test gave a digest'; return 1; }
    diff "$1" "$dir/got"
}

for source in tests/mcu/digest/*.c; do
    program=$(basename "$source" .c)
    build/gcc/tests/mcu/digest/$program >"$dir/out"
    digests "$dir/out" >"$dir/$program"
    verdict "digest $program with gcc on the host" $?
    for host in clang san; do
        build/$host/tests/mcu/digest/$program >"$dir/out" 2>&1
        same "$dir/$program" "$dir/out"
        verdict "digest $program with $host on the host: the same bits" $?
    done
    for core in cortex-m0plus:mps2-an385 cortex-m4:mps2-an386 cortex-m7:mps2-an500; do
        for compiler in '' clang-; do
            sh tests/mcu/mps2/run.sh "${core#*:}" "build/$compiler${core%:*}/mps2/tests/mcu/digest/$program.elf" >"$dir/out"
            same "$dir/$program" "$dir/out"
            verdict "digest $program for $compiler${core%:*}: the same bits" $?
        done
    done
    cat "$dir/$program"
done

# ---------------------------------------------------------------- is every module among them?
# The linker drops the functions that nobody calls: a module is reached if an image has one of its functions.
functions() { arm-none-eabi-nm --defined-only "$@" | awk '$2 == "T" { print $3 }'; }
unreached() { # FUNCTIONS-REACHED LAYER...   names the modules that are not
    reached=$1
    shift
    for layer in "$@"; do
        for module in firmware/"$layer"/*.c; do
            [ -e "$module" ] || continue
            functions "build/cortex-m4/${module%.c}.o" | grep -qxFf - "$reached" || echo "  no program of tests/mcu/digest/ reaches $module"
        done
    done | sort | awk '{ print; n++ } END { exit n > 0 }'
}
for source in tests/mcu/digest/*.c; do
    functions "build/cortex-m4/mps2/${source%.c}.elf"
done >"$dir/reached"
unreached "$dir/reached" fixed solid sphere regular scene target aim motion
verdict 'the digests reach every module' $?
grep -v '^min_norm_' "$dir/reached" >"$dir/less"
unreached "$dir/less" fixed solid sphere regular scene target aim motion >"$dir/said"
[ "$(cat "$dir/said")" = '  no program of tests/mcu/digest/ reaches firmware/sphere/min_norm.c' ]
verdict 'a module without a digest is named' $?

# ---------------------------------------------------------------- what must be noticed
sed 's/\(motion.limiter .*\)\(.\)$/\18/; s/88$/89/' "$dir/motion" >"$dir/out"
seq -f 'ok %g' "$(wc -l <"$dir/out")" >>"$dir/out"
same "$dir/motion" "$dir/out" >"$dir/said"
[ "$(grep -c '^>' "$dir/said")" = 1 ] && grep -q '^> # digest motion/limiter' "$dir/said"
verdict 'a digest of other bits is named' $?
same "$dir/motion" /dev/null >/dev/null
caught 'an image that says nothing' $?
exit $status
