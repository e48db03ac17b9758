# The program as it is built for a Raspberry Pi (64 bits), on Debian's kernel for its processor: the closed loop on SocketCAN, a camera
# and lines that `probe` finds. busybox for all else.
. tests/vm/guest/check.sh
load -a vcan can_raw
boresight=$VM_TESTS/aarch64-linux-gnu/boresight
work=$(mktemp -d)
[ "$(uname -m)" = aarch64 ] && "$boresight" --version >"$work/version" && ! grep -q 'no lib' "$work/version"
verdict pi.runs_with_all_libraries $? "$work/version"
# fact FILE NAME: a value of the one JSON object. near A B TOLERANCE
fact() { sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$1"; }
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; exit !(a != "" && b != "" && d <= t && -d <= t) }'; }

# ---------------------------------------------------------------- what is there
ip link add dev vcan0 type vcan && ip link set vcan0 up
load vivid n_devs=1 node_types=0x1
camera_there() { [ -c /dev/video0 ]; }
until_true 60 camera_there
"$boresight" probe >"$work/probe" 2>&1
for device in can:vcan0 /dev/video0 gpiochip0; do
    grep -q "$device" "$work/probe"
    verdict "pi.probe_finds_$device" $? "$work/probe"
done

# ---------------------------------------------------------------- the closed loop
# Slow ticks and long patience: the emulated machine has no real time.
{
    sed 's/^bus = fake/bus = can:vcan0/; s/^silence_ms.*/silence_ms = 2000/; s/^watchdog_ms.*/watchdog_ms = 0/
        s/^heading_deg.*/heading_deg = 0/' host-sim/rigs/studio.ini
    printf '\n[controller]\ntick_us = 10000\n'
} >"$work/rig.ini"
printf '[scenario]\nname = served\nrig = rig.ini\nseconds = 1\ntick_us = 10000\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
cat >"$work/targets.jsonl" <<'END'
{"t_us": 0, "id": 1, "dir": [0.5, 0.8, 0.2]}
{"t_us": 0, "id": 2, "dir": [0.1, 0.9, 0.1]}
{"t_us": 0, "id": 3, "dir": [0.3, 0.8, 0.15]}
END
sed 's/.*\[\(.*\)\].*/\1/; s/,//g' "$work/targets.jsonl" >"$work/points"
record vcan0
serve
"$boresight" run "$work/rig.ini" --json --stay --arm --targets "$work/targets.jsonl" --state 0.5 >"$work/run.json" 2>"$work/run.err" &
runner=$!
"$boresight" aim --json "$work/points" >"$work/aim.json"
pan=$(fact "$work/aim.json" pan_deg) tilt=$(fact "$work/aim.json" tilt_deg)
# The last line of --state: where the axes are.
there() {
    tail -n 1 "$work/run.json" >"$work/state"
    near "$(fact "$work/state" pan_deg)" "$pan" 0.05 && near "$(fact "$work/state" tilt_deg)" "$tilt" 0.05
}
until_true 60 there
verdict pi.closed_loop_aims $? "$work/aim.json" "$work/state" "$work/run.err"
kill -INT $runner
wait $runner
verdict pi.closed_loop_ends_well $? "$work/run.err"
end_serve
verdict pi.drives_end_well $? "$work/serve.err"
end_record
near "$(fact "$work/serve.json" pan_deg)" "$pan" 0.1 && [ "$(fact "$work/serve.json" violations)" = 0 ]
verdict pi.drives_are_where_they_were_sent $? "$work/serve.json"
seen() { grep -c " $1" "$work/candump"; }
[ "$(seen '14[12]#')" -eq "$(fact "$work/serve.json" frames_in)" ] && [ "$(seen '24[12]#')" -eq "$(fact "$work/serve.json" frames_out)" ]
verdict pi.candump_saw_every_frame $? "$work/serve.json"
tail -n 1 "$work/run.json" >"$work/results"
for name in late_us_p50 late_us_p99 late_us_max missed_ticks; do
    value=$(fact "$work/results" $name)
    echo "MEASURED vm.pi: $name $value in the emulator"
    [ -n "$value" ]
    verdict "pi.prints_$name" $? "$work/results"
done
