# For the groups: `. tests/vm/guest/check.sh`.

# verdict NAME CONDITION-STATUS [FILE...]: prints the line that the runner counts; on failure the files, too.
verdict() {
    if [ "$2" -eq 0 ]; then
        echo "ok vm.$1"
        return
    fi
    name=$1
    shift 2
    for file in "$@"; do sed "s|^|  ${file##*/}: |" "$file" | tail -n 20; done
    echo "FAIL vm.$name"
}

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
