#!/bin/sh
# Usage: named-tests.sh FILE   Every test that the table of failing devices in tests/README.md names exists. Prints the others; ends
# with 1 if there is one.
named=$(awk '/^## When devices fail/ { on = 1; next } /^## / { on = 0 } on && /^\|/' "$1" | grep -oE '`[a-z_0-9.]+`' | tr -d '`' | sed 's/.*\.//' | sort -u)
[ -n "$named" ] || { echo 'named-tests: no test is named'; exit 1; }
missing=0
for name in $named; do
    grep -rqF -e "$name" tests/contract tests/vm tests/cli || { echo "$name: no such test"; missing=1; }
done
exit $missing
