# For tests that wait for something to happen. Sourced, not run.

# until_true SECONDS COMMAND...: waits until the command succeeds; fails when the time is over.
until_true() {
    left=$(($1 * 10))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$left" -gt 0 ] || return 1
        left=$((left - 1))
        sleep 0.1
    done
}
