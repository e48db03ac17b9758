#!/bin/sh
# Usage: run.sh LOG COMMAND...   Runs one test program, keeps what it printed in LOG, shows its failures.
# A program that dies, hangs for TEST_SECONDS, or ends without a single verdict, gets a FAIL line of its own, so that no test
# can vanish. Lines `MEASURED ...` are shown. Always exits 0: the summary decides.
# TRIES=N: a program that runs in real time, which a machine that pauses can make fail. It gets up to N tries; each one that failed is
# shown, kept (LOG.1, ...) and counted in the line.
log=$1
shift
mkdir -p "$(dirname "$log")"
name=${log#build/check/}
name=${name%.log}
show_failures() { grep -vE '^(ok|#|MEASURED) ' "$1" | tail -n 40 | sed 's/^/    /'; }
try=1
while :; do
    start=$(date +%s)
    timeout -k 10 "${TEST_SECONDS:-1200}" "$@" >"$log" 2>&1
    status=$?
    if [ "$status" -eq 124 ] || [ "$status" -eq 137 ]; then
        echo "FAIL $name did not end in ${TEST_SECONDS:-1200} s" >>"$log"
    elif [ "$status" -ne 0 ] && ! grep -q '^FAIL ' "$log"; then
        echo "FAIL $name ended with exit status $status" >>"$log"
    elif ! grep -qE '^(ok|FAIL|SKIP) ' "$log"; then
        echo "FAIL $name printed no verdict" >>"$log"
    fi
    seconds=$(($(date +%s) - start))
    passed=$(grep -c '^ok ' "$log")
    failed=$(grep -c '^FAIL ' "$log")
    [ "$failed" -ne 0 ] && [ "$try" -lt "${TRIES:-1}" ] || break
    echo "$name failed in real time; try $try of $TRIES:"
    show_failures "$log"
    mv "$log" "$log.$try"
    try=$((try + 1))
done
again=
[ "$try" -eq 1 ] || again="  try $try"
printf '%-52s %4d passed %4d failed %4d s%s\n' "$name" "$passed" "$failed" "$seconds" "$again"
grep '^MEASURED ' "$log" | sed 's/^/    /'
[ "$failed" -eq 0 ] || show_failures "$log"
exit 0
