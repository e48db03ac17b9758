#!/bin/sh
# Usage: run.sh LOG COMMAND...   Runs one test program, keeps what it printed in LOG, shows its failures.
# A program that dies, or that ends without a single verdict, gets a FAIL line of its own, so that no test
# can vanish. Lines `MEASURED ...` are shown. Always exits 0: the summary decides.
log=$1
shift
mkdir -p "$(dirname "$log")"
start=$(date +%s)
"$@" >"$log" 2>&1
status=$?
name=${log#build/check/}
name=${name%.log}
if [ "$status" -ne 0 ] && ! grep -q '^FAIL ' "$log"; then
    echo "FAIL $name ended with exit status $status" >>"$log"
elif ! grep -qE '^(ok|FAIL|SKIP) ' "$log"; then
    echo "FAIL $name printed no verdict" >>"$log"
fi
seconds=$(($(date +%s) - start))
passed=$(grep -c '^ok ' "$log")
failed=$(grep -c '^FAIL ' "$log")
printf '%-52s %4d passed %4d failed %4d s\n' "$name" "$passed" "$failed" "$seconds"
grep '^MEASURED ' "$log" | sed 's/^/    /'
if [ "$failed" -ne 0 ]; then
    grep -vE '^(ok|#|MEASURED) ' "$log" | tail -n 40 | sed 's/^/    /'
fi
exit 0
