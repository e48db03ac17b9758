#!/bin/sh
# `boresight run` beside what may take long: its loop opens nothing and waits for nobody, not for a rig file that is read
# again, not for a log that is rotated, not for a terminal that takes nothing. In real time; every step waits for what the
# rig says itself.
. tests/cli/support/check.sh

rig=$dir/rig.ini
cp host-sim/rigs/hobby.ini "$rig"
says() { [ "$(grep -c -- "$1" "$dir/err")" -ge "${2:-1}" ]; }
logged() { grep -q -- "\"text\": \"$1" "$2"; }
# The sanitizers want to be the first library themselves.
watch=$PWD/build/gcc/tests/vm/preload/watch_loop.so
case $boresight in build/san/*) watch= ;; esac
start() { # ARGUMENT...
    : >"$dir/out" >"$dir/err" # or what waits for words may find the last run's
    WATCH_LOOP=$dir/loop LD_PRELOAD=$watch "$boresight" run "$rig" --json --arm --seconds 3000 "$@" >"$dir/out" 2>"$dir/err" &
    runner=$!
}
end() {
    kill -INT $runner
    wait $runner
    status=$?
}

# ---------------------------------------------------------------- a log that is rotated; a rig file that is read again
start --log "$dir/log"
until_true 30 logged settling "$dir/log"
verdict 'the log is written while it runs' $?
mv "$dir/log" "$dir/log.1"
kill -HUP $runner
until_true 30 says 'is read again$' && until_true 30 logged "$rig is read again" "$dir/log" && ! logged "$rig is read again" "$dir/log.1"
verdict 'a log that was renamed goes on in a new file, without a signal of its own' $?
# Signals that come while it is read, or all is built anew, are not lost.
for _ in 1 2 3 4 5 6; do kill -HUP $runner; done
printf '# changed\n' >>"$rig"
kill -HUP $runner
until_true 30 says 'is read again$' 2
verdict 'many at once' $?
sed 's/^estop.*//; s/^\[safety\]/&\nestop = nowhere:1/' "$rig" >"$rig.new"
mv "$rig.new" "$rig"
kill -HUP $runner
wait $runner
status=$?
[ "$status" -eq 4 ] && says '/dev/nowhere: no such file or device; ' && [ ! -s "$dir/out" ]
verdict 'devices that are missing after a reload end it' $?
if [ -n "$watch" ]; then
    grep -q '^loop' "$dir/loop" && ! grep -v '^loop' "$dir/loop"
    verdict 'the loop opened nothing' $?
fi

# ---------------------------------------------------------------- a terminal that takes nothing
# stderr is a pipe that nobody reads for a while, and bad targets fill it: the states go on.
cp host-sim/rigs/hobby.ini "$rig"
mkfifo "$dir/terminal"
exec 3<>"$dir/terminal"
awk 'BEGIN { for (i = 0; i < 4000; i++) printf "{\"id\": %d, \"nonsense that is not a target at all, told at length\": 1}\n", i }' >"$dir/bad"
"$boresight" run "$rig" --json --arm --seconds 3000 --state 0.1 --targets "$dir/bad" --log "$dir/log2" >"$dir/out" 2>"$dir/terminal" &
runner=$!
states() { [ "$(grep -c '"t_s"' "$dir/out")" -ge "$1" ]; }
until_true 30 states 10 && kill -HUP $runner && until_true 30 logged "$rig is read again" "$dir/log2" && until_true 30 states 30
verdict 'a terminal that takes nothing holds nothing up' $?
kill -INT $runner
timeout 60 cat <"$dir/terminal" >"$dir/err" 3>&- &
reader=$!
wait $runner
status=$?
exec 3>&-
wait $reader
[ "$status" -eq 0 ] && grep -q "^$dir/bad:1: " "$dir/err" && grep -q ' more lines are lost: nobody took them$' "$dir/err"
verdict 'what it took is told at the end, and how much is lost' $?
finish
