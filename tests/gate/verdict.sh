# For the gates: `verdict NAME STATUS` prints the line that the runner counts. Sourced, not run.
verdict() {
    if [ "$2" -eq 0 ]; then
        echo "ok $1"
    else
        echo "FAIL $1"
        status=1
    fi
}
# A planted violation must be caught: STATUS is that of the gate, which has to be 1.
caught() {
    if [ "$2" -eq 1 ]; then
        echo "ok $1 is caught"
    else
        echo "FAIL $1 is not caught"
        status=1
    fi
}
status=0
