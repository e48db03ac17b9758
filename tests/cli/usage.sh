#!/bin/sh
# The frame of the program: help, version, options, exit statuses, where messages go.
. tests/cli/support/check.sh

run </dev/null
ends 'no command' 2 "boresight: which command? 'boresight help' lists them"
run nosuch </dev/null
ends 'an unknown command' 2 "boresight: no command 'nosuch'; 'boresight help' lists them"
run ami </dev/null
ends 'a mistyped command' 2 "boresight: no command 'ami', did you mean 'aim'?; 'boresight help' lists them"
run --nosuch </dev/null
ends 'an unknown option without a command' 2 "boresight: no option '--nosuch'; 'boresight help' lists them"

for words in help --help -h; do
    run $words </dev/null
    grep -q '^usage: boresight COMMAND' "$dir/out" && grep -q '^  aim ' "$dir/out" &&
        grep -q '^  hull ' "$dir/out" && [ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
    verdict "boresight $words" $?
done
# Every command that `help` lists explains itself, in all ways to ask for it.
run help
listed=$(awk '/^commands:/ { on = 1; next } /^$/ { on = 0 }
    on && $1 !~ /^(help|--version)$/ { print $1 }' "$dir/out")
for command in $listed; do
    run help "$command" </dev/null
    cp "$dir/out" "$dir/help"
    grep -q "^usage: boresight $command " "$dir/help" && [ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
    verdict "help $command" $?
    run "$command" --help </dev/null
    cmp -s "$dir/out" "$dir/help" && [ "$status" -eq 0 ]
    verdict "$command --help is help $command" $?
    run "$command" --nosuch </dev/null
    ends "$command: an unknown option" 2 \
        "boresight $command: unknown option '--nosuch'; see 'boresight help $command'"
done
run help nosuch </dev/null
ends 'help for an unknown command' 2 "boresight help: no command 'nosuch'; 'boresight help' lists them"

run --version </dev/null
head -n 1 "$dir/out" | grep -qE '^boresight [0-9]+\.[0-9]+\.[0-9]+ [0-9a-z-]+$' &&
    grep -qE '^compiler +(gcc|clang) [0-9]' "$dir/out" && [ "$status" -eq 0 ]
verdict 'the version names number, commit and compiler' $?

printf '0 0 1\n' >"$dir/up.txt"
run aim "$dir/up.txt"
cp "$dir/out" "$dir/wanted"
ends 'a file' 0
run aim <"$dir/up.txt"
cmp -s "$dir/out" "$dir/wanted"
verdict 'no file is stdin' $?
run aim - <"$dir/up.txt"
cmp -s "$dir/out" "$dir/wanted"
verdict '- is stdin' $?
run aim -- "$dir/up.txt"
cmp -s "$dir/out" "$dir/wanted"
verdict '-- ends the options' $?
cp "$dir/up.txt" "$dir/--json"
(cd "$dir" && "$OLDPWD/$boresight" aim -- --json) >"$dir/out" 2>"$dir/err"
cmp -s "$dir/out" "$dir/wanted"
verdict 'a file whose name looks like an option' $?
run aim "$dir/up.txt" --up 0,1,0 --input=xyz --json
has 'options behind the file, apart and with =' 0 'ahead_q30[2]=1073741824' 'up_q30[1]=1073741824'
run aim --up 1,0,0 --up 0,1,0 --json "$dir/up.txt"
has 'of an option given twice the last counts' 0 'up_q30[1]=1073741824'

run aim one two </dev/null
ends 'two files' 2 "boresight aim: unexpected argument 'two'; see 'boresight help aim'"
run aim --viewpont 1,2,3 </dev/null
ends 'a mistyped option' 2 "boresight aim: unknown option '--viewpont', did you mean '--viewpoint'?; see 'boresight help aim'"
run aim -j </dev/null
ends 'a short option' 2 "boresight aim: unknown option '-j'; see 'boresight help aim'"
run aim --viewpoint </dev/null
ends 'an option without its value' 2 'boresight aim: --viewpoint needs a value: X,Y,Z'
run aim --json=yes </dev/null
ends 'a flag with a value' 2 'boresight aim: --json takes no value'
run aim --input polar </dev/null
ends 'an unknown input' 2 "boresight aim: --input 'polar': choose one of xyz, q30, radec"
run aim --input '' </dev/null
ends 'an empty value' 2 "boresight aim: --input '': choose one of xyz, q30, radec"
run aim --method magic </dev/null
ends 'a method that is not there: the error lists those that are' 2 \
    "boresight aim: --method 'magic': choose one of auto, pivot, shrink, voronoi, hull-voronoi, pyramid"
for value in 1,2 1,2,3,4 1,,3 a,b,c 1,2,nan ''; do
    run aim --viewpoint "$value" </dev/null
    ends "--viewpoint '$value'" 2 \
        "boresight aim: --viewpoint '$value': needs three decimals, X,Y,Z"
done
run aim --up 0,0,0 </dev/null
ends '--up without a direction' 2 'boresight aim: --up: the zero vector has no direction'
for input in q30 radec; do
    for command in aim hull; do
        run $command --input $input --viewpoint 1,2,3 </dev/null
        ends "$command --input $input --viewpoint" 2 \
            "boresight $command: --viewpoint goes with --input xyz only: $input holds directions"
    done
done

for command in aim hull; do
    run $command "$dir/nosuch.txt"
    ends "$command: a file that is not there" 2 "$dir/nosuch.txt: No such file or directory"
    run $command "$dir"
    ends "$command: a directory" 2 "$dir: Is a directory"
done
if [ -e /dev/full ]; then
    "$boresight" aim "$dir/up.txt" >/dev/full 2>"$dir/err"
    status=$?
    : >"$dir/out"
    ends 'a full disk' 1 "boresight: can't write the results: No space left on device"
fi
# A reader that leaves early is no failure of ours to talk about.
"$boresight" help 2>"$dir/err" | head -n 1 >/dev/null
[ ! -s "$dir/err" ]
verdict 'a closed pipe is quiet' $?

# Options of sim that mean something only with others: told before any file is looked at.
scenario=$dir/nowhere.ini
for with in '--frames x.pgm' '--targets x.jsonl' '--state 1' '--frames x.pgm --targets x.jsonl --state 0.5'; do
    # shellcheck disable=SC2086
    run sim "$scenario" $with </dev/null
    ends "sim $with" 2 'boresight sim: --frames, --targets and --state belong to --serve'
done
for with in '--mcu-faults x' '--mcu-console x' '--mcu-serial x'; do
    # shellcheck disable=SC2086
    run sim "$scenario" $with </dev/null
    ends "sim $with" 2 'boresight sim: --mcu-faults, --mcu-console and --mcu-serial belong to --mcu'
done
for with in "$scenario" '--speed 2' '--report x'; do
    # shellcheck disable=SC2086
    run sim "$scenario" --serve can:nosuch0 $with </dev/null
    ends "sim --serve with ${with##*/}" 2 'boresight sim: --serve takes one scenario, and no --speed and no --report'
done
run sim "$scenario" "$scenario" --record x </dev/null
ends 'sim --record of two' 2 'boresight sim: --record takes one scenario'
run sim </dev/null
ends 'sim of nothing' 2 'boresight sim: which scenario? give its file'
run sim "$scenario" --replay x </dev/null
ends 'sim --replay of a scenario' 2 'boresight sim: --replay takes no scenario'

finish
