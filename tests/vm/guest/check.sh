# For the groups: `. tests/vm/guest/check.sh`.
. tests/until_true.sh

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
