# Serial lines of the kernel's own: two USB adapters and a cable between them.
. tests/vm/guest/check.sh
load -a xhci-pci usbserial ftdi_sio slcan can_raw
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
until_true 60 test -e /dev/ttyUSB1

# ---------------------------------------------------------------- slcan: ours at one end, the kernel's at the other
slcand -F ttyUSB1 slcan0 >"$work/slcand" 2>&1 &
slcand=$!
has_link() { [ -e /sys/class/net/slcan0 ]; }
until_true 60 has_link && ip link set slcan0 txqueuelen 1000 up
verdict serial.the_kernel_makes_an_interface_of_it $? "$work/slcand"
"$VM_PROGRAMS/linux_slcan" /dev/ttyUSB0 slcan0
verdict serial.linux_slcan_ended_well $?

# ---------------------------------------------------------------- `boresight run` across it
# Slow ticks and long patience: the emulated machine has no real time.
{
    sed 's/^bus = fake/bus = slcan:\/dev\/ttyUSB0/; s/^silence_ms.*/silence_ms = 2000\nfollow_error_ms = 10000/
        s/^watchdog_ms.*/watchdog_ms = 0/; s/^heading_deg.*/heading_deg = 0/' host-sim/rigs/studio.ini
    printf '\n[controller]\ntick_us = 5000\n'
} >"$work/rig.ini"
printf '[scenario]\nname = served\nrig = rig.ini\nseconds = 1\ntick_us = 5000\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
mkfifo "$work/targets"
exec 9<>"$work/targets"
aim() { # PAN_DEG TILT_DEG
    awk -v p="$1" -v t="$2" 'BEGIN { r = atan2(0, -1) / 180
        printf "{\"id\": 1, \"dir\": [%.6f, %.6f, %.6f]}\n", sin(p * r) * cos(t * r), cos(p * r) * cos(t * r), sin(t * r) }' >&9
}
says() { [ "$(grep -c "$1" "$work/run.err")" -ge "${2:-1}" ]; }
# fact FILE NAME: the last one.
fact() { sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$1" | tail -n 1; }
# The drives' own place, as the simulator knows it.
looks_at() { # PAN_DEG TILT_DEG
    tail -n 1 "$work/truth" | awk -F '"pan_deg": |, "tilt_deg": ' -v p="$1" -v t="$2" 'END { x = $2 - p; y = $3 - t; exit !(NF == 3 && x * x + y * y < 0.0025) }'
}
usb=$(readlink -f /sys/class/tty/ttyUSB0/device/../..)
record slcan0
"$boresight" sim "$work/served.ini" --serve can:slcan0 --state 0.2 --json >"$work/truth" 2>"$work/serve.err" &
server=$!
until_true 60 test -s "$work/truth" # it listens
aim 20 10
"$boresight" run "$work/rig.ini" --json --arm --stay --targets "$work/targets" >"$work/run.json" 2>"$work/run.err" &
runner=$!
until_true 60 looks_at 20 10
verdict serial.run_aims_over_slcan $? "$work/run.err" "$work/truth"
aim -15 5
echo 0 >"$usb/authorized"
until_true 60 says '/dev/ttyUSB0: the device has left; plug it in again'
verdict serial.tells_that_the_adapter_has_left $? "$work/run.err"
aim -25 -5
echo 1 >"$usb/authorized"
arms() {
    kill -USR1 $runner
    sleep 1
    looks_at -25 -5
}
until_true 60 says 'all devices are there again' && until_true 20 arms
verdict serial.aims_when_it_is_back $? "$work/run.err" "$work/truth"
kill -INT $runner
wait $runner
[ $? -eq 0 ]
verdict serial.run_ends_well $? "$work/run.err" "$work/run.json"
kill -INT $server
wait $server
# All that the kernel got from our text is a request of that protocol, and as many as the drives got.
end_record
[ "$(grep -c ' 14[12]#' "$work/candump")" -eq "$(fact "$work/truth" frames_in)" ] &&
    ! grep -vqE ' (14[12]#(A4|92|9A|B3|42|80|81|77)[0-9A-F]{14}|24[12]#[0-9A-F]{16})$' "$work/candump"
verdict serial.candump_saw_every_frame_whole $? "$work/truth"
kill $slcand
wait $slcand
