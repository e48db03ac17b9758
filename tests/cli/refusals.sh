#!/bin/sh
# Every kind of device that a rig file can name, missing, busy, forbidden, or something else: `run` and `calibrate` print one line
# that names the device, the reason and the remedy, end with status 4, and nothing has moved: the adapter of the drives that are well
# saw no frame. tests/vm/guest/refusals.sh has what needs a kernel with such devices.
. tests/cli/support/check.sh
witness_program=build/gcc/tests/cli/support/pty_witness
# Somebody else has to get at program and files, wherever the repository is.
place=$(mktemp -d "${TMPDIR:-/tmp}/refusals.XXXXXX") || exit 1
chmod 755 "$place"
cp "$boresight" "$place/boresight" && chmod 755 "$place/boresight"
rig=$place/rig.ini
tty=$place/tty
busy=$place/busy
witnesses=
trap 'kill $witnesses 2>/dev/null; rm -rf "$dir" "$place"' EXIT
for line in tty busy spare; do
    "$witness_program" "$place/$line" "$dir/$line.seen" &
    witnesses="$witnesses $!"
    until_true 30 [ -e "$place/$line" ]
done
exec 9<"$busy" && flock -n 9 # as any program that cares holds its port
mkdir "$place/folder"
: >"$place/file"
: >"$place/forbidden" && chmod 000 "$place/forbidden"

# Root may open everything, so what is forbidden is tried as somebody else; who is nobody special has no need to be.
as_nobody=
[ "$(id -u)" -ne 0 ] || as_nobody='setpriv --reuid 65534 --regid 65534 --clear-groups'

# make_rig WHERE TEXT: the studio with its drives on the witness, and the device in question.
make_rig() {
    awk -v where="$1" -v text="$2" -v tty="$tty" '
        /^\[/ { section = $0 }
        /^bus = / { print "bus = " (where == "bus" && section == "[tilt]" ? text : "slcan:" tty); next }
        /^device = / && where == "device" { print "device = " text; next }
        { print }
        $0 == "[camera]" && where == "camera" { print "device = " text "\ndetect = markers" }
        $0 == "[safety]" && where == "estop" { print "estop = " text }
        END { if (where == "board") print "\n[controller]\nboard = serial:" text }' host-sim/rigs/studio.ini >"$rig"
    chmod 644 "$rig"
}

frames() { tr '\r' '\n' <"$dir/tty.seen" | grep -c '^[tTrR]'; }

# refused_device NAME WHERE TEXT LINE: LINE is all that is said.
refused_device() {
    make_rig "$2" "$3"
    for command in 'run --arm --seconds 1' 'calibrate --dry-run'; do
        [ "$2 ${command%% *}" != 'board calibrate' ] || continue # it has no use for a board
        # shellcheck disable=SC2086
        set -- "$1" "$2" "$3" "$4" ${command%% *} "$rig" ${command#* }
        (
            shift 4
            # shellcheck disable=SC2086
            exec $user "$place/boresight" "$@"
        ) </dev/null >"$dir/out" 2>"$dir/err"
        status=$?
        ends "$1: ${command%% *}" 4 "$rig: $4"
    done
}

list='`boresight probe` lists what is there'
ports='is it plugged in? `ls /dev/tty[AU]*` shows what is there'
chips='`boresight probe` lists the GPIO chips'
cameras='is it plugged in? `boresight probe` lists the cameras'
closed="no permission; its mode is 000 and no group is let in: a udev rule or chmod has to change that"
other='in use by another program; end that one first (`fuser -v` on the file shows it)'

user=
refused_device 'no such CAN interface' bus can:nosuch0 "nosuch0: no such interface; is the adapter plugged in? $list"
refused_device 'an interface that is not CAN' bus can:lo 'lo: not a CAN interface; `boresight probe` lists them'
refused_device 'no such serial port' bus "slcan:$place/nothing" "$place/nothing: no such file or device; $ports"
refused_device 'a serial port that is a device of another kind' bus slcan:/dev/null '/dev/null: not a serial port; name a device like /dev/ttyACM0'
refused_device 'a serial port that is a file' bus "slcan:$place/file" "$place/file: not a serial port; name a device like /dev/ttyACM0"
refused_device 'a serial port that is a folder' bus "slcan:$place/folder" "$place/folder: not a device of that kind; $ports"
refused_device 'a serial port in use' bus "slcan:$busy" "$busy: $other"
refused_device 'a bit rate that slcan has not' bus "slcan:$place/spare@12345" \
    "$place/spare: slcan has no bit rate of 12345; use 125000, 250000, 500000 or 1000000"
if "$boresight" --version | grep -q 'no libusb'; then
    echo 'SKIP refusals of USB devices: built without libusb'
else
    refused_device 'no CAN adapter' bus gs_usb "CAN adapter: no such USB device; is it plugged in? $list"
    refused_device 'no CAN adapter of that number' bus gs_usb:000F "CAN adapter 000F: no such USB device; is it plugged in? $list"
    refused_device 'no Maestro' device maestro "Maestro: no such USB device; is it plugged in? $list"
    refused_device 'no Maestro of that number' device maestro:00099 "Maestro 00099: no such USB device; is it plugged in? $list"
fi
refused_device 'no PWM chip' device pwmchip77 \
    'pwmchip77: no such PWM chip; is the overlay loaded (pwm-2chan, i2c-pwm-pca9685a)? `boresight probe` lists the chips'
if "$boresight" --version | grep -q 'no libgpiod'; then
    echo 'SKIP refusals of GPIO lines: built without libgpiod'
else
    for where in device estop; do
        chip=gpio: line=
        [ $where = device ] || chip= line=:3
        refused_device "no such GPIO chip ($where)" $where "${chip}gpiochip77$line" "/dev/gpiochip77: no such file or device; $chips"
        refused_device "no GPIO chip ($where)" $where "$chip/dev/null$line" "/dev/null: not a device of that kind; $chips"
        refused_device "a folder for a GPIO chip ($where)" $where "$chip$place/folder$line" "$place/folder: not a device of that kind; $chips"
    done
fi
refused_device 'no such camera' camera /dev/video77 "/dev/video77: no such file or device; $cameras"
refused_device 'no camera of that name' camera 'Nobody 3000' "Nobody 3000: no camera of that name; $cameras"
refused_device 'no camera' camera /dev/null '/dev/null: it gives no frames; `boresight probe` lists the cameras'
refused_device 'a folder for a camera' camera "$place/folder" "$place/folder: not a device of that kind; $cameras"
refused_device 'no such port of a board' board "$place/nothing" "board = serial:$place/nothing: no such file or device; $ports"
refused_device 'a board in use' board "$busy" "board = serial:$busy: $other"

user=$as_nobody
if $user true 2>/dev/null; then
    refused_device 'a forbidden serial port' bus "slcan:$place/forbidden" "$place/forbidden: $closed"
    refused_device 'a forbidden camera' camera "$place/forbidden" "$place/forbidden: $closed"
    refused_device 'a forbidden port of a board' board "$place/forbidden" "board = serial:$place/forbidden: $closed"
    if "$boresight" --version | grep -q 'libgpiod [0-9]'; then
        refused_device 'a forbidden GPIO chip' estop "$place/forbidden:3" "$place/forbidden: $closed"
    fi
    if [ "$(id -u)" -eq 0 ]; then
        chgrp dialout "$place/forbidden" && chmod 060 "$place/forbidden"
        refused_device 'a serial port of a group' bus "slcan:$place/forbidden" \
            "$place/forbidden: no permission; join group dialout (sudo usermod -aG dialout \$USER) and log in again"
    fi
else
    echo 'SKIP forbidden devices: this user can be nobody else'
fi
user=

# The witness works, and saw all that there was.
status=0
cp "$dir/tty.seen" "$dir/out"
: >"$dir/err"
tr '\r' '\n' <"$dir/tty.seen" | grep -q '^O$'
verdict 'the adapter of the drives that are well was opened' $?
[ "$(frames)" -eq 0 ]
verdict 'and saw no frame' $?

# Drives that don't answer are missing, too; they are asked, and nobody tells them to move (commands A1 to A9 of their protocol).
make_rig none none
for command in run calibrate; do
    case $command in
    run) run run "$rig" --arm --seconds 2 ;;
    *) run calibrate "$rig" --dry-run ;;
    esac
    [ "$status" -eq 4 ] && [ "$(wc -l <"$dir/err")" -ge 2 ] && ! grep -v '^boresight [a-z]*: without real-time\|does not answer' "$dir/err"
    verdict "silent drives end $command with status 4" $?
    for id in 1 2; do
        grep -qxF "boresight $command: slcan:$tty: drive $id does not answer; is it powered, its id and the bit rate right, the bus terminated?" \
            "$dir/err" && [ "$(grep -c "drive $id " "$dir/err")" -eq 1 ]
        verdict "drive $id is named once ($command)" $?
    done
done
[ "$(frames)" -gt 0 ] && ! tr '\r' '\n' <"$dir/tty.seen" | grep -q '^t14[12]8A'
verdict 'silent drives are asked and not moved' $?

# ---------------------------------------------------------------- the log
run run host-sim/rigs/studio.ini --seconds 1 --log "$place/no/log"
ends 'a log in no folder' 2 "$place/no/log: No such file or directory; create its folder first"
run run host-sim/rigs/studio.ini --seconds 1 --log "$place/folder"
ends 'a log that is a folder' 2 "$place/folder: Is a directory; name another file"
if [ ! -e /run/systemd/journal/socket ]; then
    run run host-sim/rigs/studio.ini --seconds 1 --log journal
    ends 'no journal' 2 "/run/systemd/journal/socket: No such file or directory; is systemd's journal running? --log FILE writes to a file"
fi
run run host-sim/rigs/studio.ini --seconds 1 --log /dev/full --json
[ "$status" -eq 0 ] && ! grep -q '"log_dropped": 0,' "$dir/out" &&
    [ "$(grep -cF '/dev/full: No space left on device; the rig goes on, log_dropped counts what is lost' "$dir/err")" -eq 1 ]
verdict 'a full disk is told of once and stops nothing' $?

# ---------------------------------------------------------------- who reads leaves; what is closed stays closed
"$boresight" run host-sim/rigs/studio.ini --seconds 2 --state 0.05 2>"$dir/err" | head -n 1 >"$dir/out"
status=0
grep -q "can't write the results: Broken pipe" "$dir/err" && grep -q '"mode"' "$dir/out"
verdict 'a reader of the results who leaves does not end the rig' $?
# A device must not become standard output: what is printed would go to the drives.
: >"$dir/tty.seen"
(exec "$boresight" run "$rig" --seconds 1 >&- 2>&-)
status=$?
[ "$status" -eq 1 ] && ! tr '\r' '\n' <"$dir/tty.seen" | grep -q 'boresight\|late_us'
verdict 'closed outputs are no device' $?

# ---------------------------------------------------------------- a board's rig is not calibrated here
make_rig board "$busy"
refuse 'calibrate refuses a rig that a board drives' 'drives the rig: only what this program drives itself can be measured' \
    calibrate "$rig" --dry-run
finish
