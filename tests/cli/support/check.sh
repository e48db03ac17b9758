# For the tests of the command line: `. tests/cli/support/check.sh` from the repository's root.
# BORESIGHT names the program; what a test writes stays in $dir, which goes at the end.
boresight=${BORESIGHT:-build/boresight}
mkdir -p build
dir=$(mktemp -d build/cli.XXXXXX) || exit 1
trap 'rm -rf "$dir"' EXIT
. tests/until_true.sh
failures=0
: >"$dir/none"

# run ARGUMENT...: runs the program on this function's stdin; $status, $dir/out and $dir/err tell.
run() {
    "$boresight" "$@" >"$dir/out" 2>"$dir/err"
    status=$?
}

# verdict NAME CONDITION-STATUS: prints the line that the runner counts; on failure what was seen.
verdict() {
    if [ "$2" -eq 0 ]; then
        echo "ok $1"
        return
    fi
    failures=$((failures + 1))
    echo "  exit status $status"
    sed 's/^/  stdout: /' "$dir/out" | head -n 20
    sed 's/^/  stderr: /' "$dir/err" | head -n 20
    echo "FAIL $1"
}

# ends NAME STATUS [STDERR]: the last run ended so, said exactly that on stderr (nothing without
# STDERR), and printed no result if it is a failure.
ends() {
    said=$(cat "$dir/err")
    good=0
    [ "$status" -eq "$2" ] || good=1
    [ "$said" = "${3:-}" ] || good=1
    case $2 in
    0 | 3) ;;
    *) [ ! -s "$dir/out" ] || good=1 ;;
    esac
    verdict "$1" $good
}

# refused NAME TEXT: the last run ended with status 2, no results, and one line with this text.
refused() {
    [ "$status" -eq 2 ] && [ ! -s "$dir/out" ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && grep -qF -e "$2" "$dir/err"
    verdict "$1" $?
}

# refuse NAME TEXT ARGUMENT...: runs the program, which does so.
refuse() {
    refusal=$1
    text=$2
    shift 2
    run "$@"
    refused "$refusal" "$text"
}

# facts: the last run's JSON, a PATH=VALUE line each, in $dir/facts; fails if it is no JSON.
facts() {
    awk -f tests/cli/support/json.awk <"$dir/out" >"$dir/facts" 2>>"$dir/err"
}

# has NAME STATUS PATH=VALUE...: the last run ended so with JSON that has these values.
has() {
    name=$1
    good=0
    [ "$status" -eq "$2" ] || good=1
    [ ! -s "$dir/err" ] || good=1
    facts || good=1
    shift 2
    for fact in "$@"; do
        if ! grep -qxF -e "$fact" "$dir/facts"; then
            echo "  not in the results: $fact"
            good=1
        fi
    done
    verdict "$name" $good
}

# fact PATH: one value of the last `facts`.
fact() {
    awk -v path="$1=" 'index($0, path) == 1 { print substr($0, length(path) + 1) }' "$dir/facts"
}

# finish: the exit status of the script.
finish() {
    [ "$failures" -eq 0 ]
    exit
}
