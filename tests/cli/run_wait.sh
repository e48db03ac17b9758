#!/bin/sh
# `boresight run --stay` waits for devices that are not there when it starts, or when it reads another rig file: each reason is told
# once, nothing moves before all is there, and what was asked for meanwhile does not start it later. In real time; every step waits
# for what the rig says itself.
. tests/cli/support/check.sh

drives=build/gcc/tests/cli/support/pty_drives
rig=$dir/rig.ini
sed "s/^watchdog_ms.*/watchdog_ms = 0/; s/^silence_ms.*/silence_ms = 2000/" host-sim/rigs/studio.ini >"$dir/sim.ini"
on() { sed "s|^bus = fake|bus = slcan:$1|" "$dir/sim.ini" >"$rig"; } # LINK: the rig with its drives there
says() { [ "$(grep -c -- "$1" "$dir/err")" -eq "${2:-1}" ]; }
start() { # ARGUMENT...
    : >"$dir/err" # of the one before
    "$boresight" run "$rig" --json --seconds 3000 "$@" </dev/null >"$dir/out" 2>"$dir/err" &
    runner=$!
}
ended() {
    wait $runner
    status=$?
}
absent="link: no such file or device; is it plugged in? "
printf '{"t_us": 0, "id": 1, "dir": [0.5, 1, 0.2]}\n' >"$dir/targets"

# ---------------------------------------------------------------- at the start
on "$dir/link"
start --stay --targets "$dir/targets" --log "$dir/log"
until_true 30 says 'run: waiting until it can be opened$' && says "^$rig: $dir/$absent"
verdict 'a device that is missing at the start is told of' $?
sleep 2 # it is tried twice a second
[ "$(wc -l <"$dir/err")" -eq 2 ] && kill -0 $runner
verdict 'once' $?
: >"$dir/link"
until_true 30 says 'link: not a serial port; '
verdict 'another reason is told, too' $?
kill -USR1 $runner
printf 'nonsense\n' >"$rig"
kill -HUP $runner
until_true 30 says "$rig is not used: the rig stays as it was\$" && says "^$rig:1: "
verdict 'a file that cannot be read changes nothing' $?
on "$dir/other"
kill -HUP $runner
until_true 30 says "^$rig: $dir/other: no such file or device; " && says 'waiting until it can be opened$' 2
verdict 'another file is used, and waited for' $?
$drives "$dir/sim.ini" "$dir/other" 2>"$dir/drives.err" &
server=$!
until_true 30 says 'run: all devices are there$' && until_true 30 says 'run: ready$' && sleep 1 && says 'run: settling$' 0
verdict 'all is there: it homes, and an arm command from before is none' $?
kill -USR1 $runner
until_true 30 says 'run: tracking$'
verdict 'armed, it follows' $?
grep -q '"text": "all devices are there"' "$dir/log" && grep -q '"event": "device".*not a serial port' "$dir/log"
verdict 'the log has it all' $?
kill -INT $runner
ended
[ "$status" -eq 0 ] && says 'waiting' 2
verdict 'and ends well' $?
kill $server
wait $server

# ---------------------------------------------------------------- an end of the wait
on "$dir/link"
rm -f "$dir/link"
for signal in INT TERM; do
    start --stay --arm
    until_true 30 says 'waiting until'
    kill -$signal $runner
    ended
    [ "$status" -eq 4 ] && [ ! -s "$dir/out" ]
    verdict "SIG$signal ends the wait with status 4" $?
done
run run "$rig" --stay --seconds 1 </dev/null
[ "$status" -eq 4 ] && [ ! -s "$dir/out" ] && [ "$(wc -l <"$dir/err")" -eq 2 ]
verdict 'so does the time that it was given' $?

# ---------------------------------------------------------------- after a reload
cp host-sim/rigs/hobby.ini "$rig"
start --stay --arm --targets "$dir/targets"
until_true 30 says 'run: tracking$'
sed 's/^estop.*//; s/^\[safety\]/&\nestop = nowhere:1/' "$rig" >"$rig.new" && mv "$rig.new" "$rig"
kill -HUP $runner
until_true 30 says '/dev/nowhere: no such file or device; ' && until_true 30 says 'waiting until'
verdict 'a rig file that names what is missing is waited for' $?
cp host-sim/rigs/hobby.ini "$rig"
kill -HUP $runner
until_true 30 says 'is read again$' && until_true 30 says 'run: tracking$' 2 && says 'all devices are there' 0
verdict 'until the file is another again' $?
kill -INT $runner
ended
[ "$status" -eq 0 ]
verdict 'which ends well, too' $?
finish
