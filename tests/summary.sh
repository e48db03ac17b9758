#!/bin/sh
# Usage: summary.sh LOG...   Adds up the verdicts of all logs; the last line is `N passed, N failed`.
[ $# -gt 0 ] || { echo 'no tests ran'; echo '0 passed, 1 failed'; exit 1; }
skipped=$(cat "$@" | grep '^SKIP ')
[ -z "$skipped" ] || printf '%s\n' "$skipped"
failures=$(cat "$@" | grep '^FAIL ')
[ -z "$failures" ] || printf '%s\n' "$failures"
passed=$(cat "$@" | grep -c '^ok ')
failed=$(cat "$@" | grep -c '^FAIL ')
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
