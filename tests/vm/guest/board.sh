# `boresight run` with a flashed board at the end of a USB serial adapter's cable. The board is the STM32F405's real image in its emulator, which
# runs on the host (run.sh): an emulator inside an emulated machine would be too slow.
. tests/vm/guest/check.sh
load -a xhci-pci usbserial ftdi_sio
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
cp host-sim/rigs/studio.ini "$work/rig.ini"
printf '\n[controller]\nboard = serial:/dev/ttyUSB0\n' >>"$work/rig.ini"
fact() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$work/run.json"; }
told() { grep -q "$1" "$work/run.err"; }
until_true 60 test -e /dev/ttyUSB0
usb=$(readlink -f /sys/class/tty/ttyUSB0/device/../..)

# In real time, on a machine that may be busy: a pause of half a second stops the board, as it should. So up to three tries, and what
# fails in all of them while the machine paused is skipped, by name.
tries() { # NAME FUNCTION
    for _ in 1 2 3; do
        "$VM_TESTS/gcc/tests/vm/watch_pauses" 100 >"$work/pauses" &
        watch=$!
        "$2"
        result=$?
        kill $watch
        wait $watch
        [ $result -ne 0 ] || break
    done
    if [ $result -ne 0 ] && [ -s "$work/pauses" ]; then
        echo "SKIP vm.board.$1: $(cat "$work/pauses")"
    else
        verdict "board.$1" $result "$work/run.err" "$work/run.json"
    fi
}
# The mean direction of two targets, each a unit vector; the mount looks south.
printf '{"id": 77, "xyz": [1, -6, 1.5]}\n{"id": 99, "xyz": [3, -6, 0.5]}\n' >"$work/two.jsonl"
looks_between() {
    awk -v pan="$(fact pan_deg)" -v tilt="$(fact tilt_deg)" 'BEGIN {
        a = sqrt(1 + 36 + 2.25); b = sqrt(9 + 36 + 0.25); deg = 57.29577951
        x = 1 / a + 3 / b; y = -6 / a - 6 / b; z = 1.5 / a + 0.5 / b
        p = atan2(x, y) * deg - 180; t = atan2(z, sqrt(x * x + y * y)) * deg
        exit !(pan - p < 0.05 && p - pan < 0.05 && tilt - t < 0.05 && t - tilt < 0.05) }'
}
drive() {
    "$boresight" run "$work/rig.ini" --arm --seconds 5 --json --targets "$work/two.jsonl" >"$work/run.json" 2>"$work/run.err"
    [ $? -eq 0 ] && [ "$(fact lines_damaged)" = 0 ] && [ "$(fact lines_stale)" = 0 ] && [ "$(fact clock_answers)" -gt 10 ] && looks_between
}
tries run_drives_the_image drive
pull_out() {
    : >"$work/run.err"
    : >"$work/run.json" >"$work/run.err" # or what waits for words may find the last run's
    "$boresight" run "$work/rig.ini" --arm --json --targets "$work/two.jsonl" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
    until_true 20 told tracking
    echo 0 >"$usb/authorized"
    wait $runner
    status=$?
    sed 's/^/# /' "$work/run.err"
    "$boresight" run "$work/rig.ini" >"$work/none" 2>"$work/none.err"
    [ $? -eq 4 ] && grep -q 'ttyUSB0: no such file or device; is it plugged in?' "$work/none.err" || status=1
    echo 1 >"$usb/authorized"
    until_true 60 test -e /dev/ttyUSB0
    [ $status -eq 4 ] && told 'tracking' && told 'ttyUSB0: the device has left; plug it in again'
}
tries a_line_that_is_pulled_out_is_status_4 pull_out
tries drives_it_again_when_it_is_back drive
tracks() { [ "$(grep -c 'run: tracking' "$work/run.err")" -ge "$1" ]; }
stands_by() { [ "$(grep -c 'run: stopped' "$work/run.err")" -eq 2 ]; }
stay() {
    : >"$work/run.json" >"$work/run.err"
    "$boresight" run "$work/rig.ini" --arm --stay --json --targets "$work/two.jsonl" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
    until_true 20 tracks 1
    echo 0 >"$usb/authorized"
    until_true 20 told 'ttyUSB0: the device has left; plug it in again'
    echo 1 >"$usb/authorized"
    until_true 60 told 'the board is there again' && until_true 20 stands_by && kill -USR1 $runner && until_true 20 tracks 2
    status=$?
    kill -INT $runner
    wait $runner && [ "$status" -eq 0 ] && [ "$(fact board_returns)" = 1 ] && looks_between
}
tries is_armed_again_with_stay stay
for name in status_gap_ms_max clock_error_ms lines_taken; do echo "# board behind a USB serial adapter: $name $(fact $name)"; done
