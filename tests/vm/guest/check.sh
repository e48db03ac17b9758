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

# watched PROGRAM ARGUMENT...: as it is, and $work/loop names what its loop opens and waits for (preload/watch_loop.c); in the
# place of this shell: give it an `&`, or brackets. loop_only_waits GROUP: nothing, in none of them.
watched() { exec env WATCH_LOOP="$work/loop" LD_PRELOAD="$VM_TESTS/gcc/tests/vm/preload/watch_loop.so" "$@"; }
loop_only_waits() {
    grep -q '^loop' "$work/loop" && ! grep -qv '^loop' "$work/loop"
    verdict "$1.its_loop_opens_nothing" $? "$work/loop"
}

# serve: the drives of $work/served.ini, simulated, on vcan0, beside what follows; end_serve: no more.
serve() {
    "$boresight" sim "$work/served.ini" --serve can:vcan0 --json >"$work/serve.json" 2>"$work/serve.err" &
    server=$!
}
end_serve() {
    kill -INT $server
    wait $server
}

# record INTERFACE: candump writes what is on it to $work/candump, from when this returns, however slow the
# machine; end_record: until all of it is there.
record() {
    timeout 600 candump -L -r 16777216 "$1" >"$work/candump" &
    witness=$!
    until_true 60 listens "$1"
}
listens() { grep -q " $1 .*raw" /proc/net/can/rcvlist_all; }
end_record() {
    kill $witness
    wait $witness
}

# arms_until SECONDS COMMAND...: a drive that was away may still have to answer, so the person arms until the command succeeds, which
# gets so long each time.
arms_until() {
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do
        kill -USR1 $runner
        until_true "$@" && return 0
    done
    return 1
}
