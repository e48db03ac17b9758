# Devices that are there and can't be used, of every kind that a rig file can name: `run` prints one line that names the device, the
# reason and the remedy, ends with status 4, and the drives on a bus that is well hear nothing meanwhile. tests/cli/refusals.sh has
# what any machine can show, and `calibrate`, which opens devices the same way.
. tests/vm/guest/check.sh
load -a vcan can_raw kvaser_pci vhci-hcd gs_usb uvcvideo gpio-sim
load i2c-stub chip_addr=0x40
load -a i2c-dev pwm-pca9685
mount -t configfs config /sys/kernel/config 2>/dev/null
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
chmod 755 "$work"
nobody='setpriv --reuid 65534 --regid 65534 --clear-groups'

# ---------------------------------------------------------------- what is plugged in
ip link add dev vcan0 type vcan && ip link set vcan0 up
ip link add dev vcan1 type vcan
bank=/sys/kernel/config/gpio-sim/rig
mkdir -p $bank/bank0 && echo 8 >$bank/bank0/num_lines && echo rig-lines >$bank/bank0/label && echo 1 >$bank/live
gpio=$(cat $bank/bank0/chip_name)
pins=/sys/devices/platform/$(cat $bank/dev_name)/$gpio
i2c=$(echo /sys/bus/i2c/devices/i2c-*)
i2c=${i2c##*-}
echo pca9685 0x40 >"/sys/bus/i2c/devices/i2c-$i2c/new_device"
echo 'lamp 10 5' >"$work/wish"
"$VM_TESTS/gcc/tests/vm/plug_camera" "$work/camera" "$work/wish" &
"$VM_TESTS/gcc/tests/vm/plug_candles" &
"$VM_TESTS/gcc/tests/vm/plug_maestro" "$work/maestro" &
there() { grep -qsx "$1" /sys/bus/usb/devices/*/idVendor; }
adapters() { set -- /sys/bus/usb/drivers/gs_usb/*/net/*; [ -e "$1" ] && [ $# -eq 2 ]; }
until_true 60 adapters && until_true 60 there 1ffb && until_true 60 [ -e /dev/video0 ] && until_true 60 [ -e /sys/class/net/can2 ]
verdict refusals.all_is_plugged_in $?
sleep 0.5
usb_file() { # IDVENDOR: the file of the first device of that vendor
    for folder in /sys/bus/usb/devices/*; do
        [ "$(cat "$folder/idVendor" 2>/dev/null)" != "$1" ] || break
    done
    printf '/dev/bus/usb/%03d/%03d\n' "$(cat "$folder/busnum")" "$(cat "$folder/devnum")"
}
for folder in /sys/class/net/can*; do # of the cards, not of the adapters
    case $(readlink -f "$folder/device/driver") in *kvaser*) card=${folder##*/} && break ;; esac
done

# ---------------------------------------------------------------- refusals
# make_rig WHERE TEXT: the studio with its drives on vcan0, and the device in question.
make_rig() {
    awk -v where="$1" -v text="$2" '
        /^\[/ { section = $0 }
        /^bus = / { print "bus = " (where == "bus" && section == "[tilt]" ? text : "can:vcan0"); next }
        /^device = / && where == "device" { print "device = " text; next }
        /^channel = / && where == "channel" { print "channel = " text; next }
        /^device = / && where == "channel" { print "device = pwmchip0"; next }
        /^id = 2/ && where == "id" { print "id = " text; next }
        /^heading_deg/ { print "heading_deg = 0"; next }
        /^silence_ms/ { print "silence_ms = 2000"; next }
        /^watchdog_ms/ { print "watchdog_ms = 0"; next }
        { print }
        $0 == "[camera]" && where == "camera" { print "device = " text "\ndetect = markers" }
        $0 == "[safety]" && where == "estop" { print "estop = " text }
        END { print "\n[controller]\ntick_us = 10000" }' host-sim/rigs/studio.ini >"$work/rig.ini"
    [ "$1" != uvc ] || sed -i "s|^drive = pwm|drive = uvc|; s|^device = fake|device = $2|; s/^channel = 2//; s/^pulse_us.*/zoom_units = 1, 2, 3, 4, 5, 6, 7, 8, 9/" "$work/rig.ini"
}
refused() { # NAME WHERE TEXT LINE: as $user
    make_rig "$2" "$3"
    # shellcheck disable=SC2086
    $user "$boresight" run --arm --seconds 1 "$work/rig.ini" >"$work/out" 2>"$work/err"
    status=$?
    printf '%s: %s\n' "$work/rig.ini" "$4" >"$work/wanted"
    [ $status -eq 4 ] && [ ! -s "$work/out" ] && cmp -s "$work/err" "$work/wanted"
    verdict "refusals.$1" $? "$work/wanted" "$work/err"
}
record vcan0

user=
refused a_bus_that_is_down bus can:vcan1 'vcan1: the interface is down; sudo ip link set vcan1 up'
ip link set "$card" down
refused a_card_without_a_bit_rate bus "can:$card" "$card: the interface is down; sudo ip link set $card up type can bitrate 1000000"
ip link set "$card" type can bitrate 500000
refused a_card_that_is_down bus "can:$card" "$card: the interface is down; sudo ip link set $card up"
refused a_channel_that_an_adapter_has_not bus gs_usb:0001/3 'CAN adapter 0001: no channel 3, it has 1; choose another one in the rig file'
refused a_bit_rate_that_an_adapter_has_not bus gs_usb:0001@999 "CAN adapter 0001: can't do 999 bit/s; 1000000, 500000 and 250000 are usual"
refused a_line_that_a_chip_has_not estop rig-lines:8 'rig-lines:8: the chip has no such line; `boresight probe` tells how many it has'
gpioset --mode=signal "$gpio" 3=1 &
holder=$!
held() { gpioinfo "$gpio" | grep -q 'line *3:.*gpioset'; }
until_true 30 held
busy_line="in use by 'gpioset'; end that program, or take the overlay that claims it out of the device tree"
refused a_line_in_use estop rig-lines:3 "rig-lines:3: $busy_line"
make_rig none none
sed 's/^device = fake/device = gpio:rig-lines/; s/^channel = 2/channel = 3/' "$work/rig.ini" >"$work/lines.ini"
"$boresight" run "$work/lines.ini" --seconds 1 >"$work/out" 2>"$work/err"
[ $? -eq 4 ] && [ "$(cat "$work/err")" = "$work/lines.ini: rig-lines:3: $busy_line" ]
verdict refusals.a_servo_line_in_use $? "$work/err"
kill $holder
wait $holder
refused an_output_that_a_chip_has_not channel 17 'pwmchip0: has 16 outputs, 0 to 15; choose another channel'
refused what_a_camera_sends_beside_frames camera /dev/video1 '/dev/video1: it gives no frames; `boresight probe` lists the cameras'

# What another one of us holds.
sed "/^\[pan\]/,/^\[tilt\]/ s/^device = fake/device = maestro/; /^\[tilt\]/,/^\[camera\]/ s/^device = fake/device = pwmchip0/
    s/^channel = 1/channel = 2/; s|^\[camera\]|[camera]\ndevice = /dev/video0\ndetect = markers\nrate_hz = 5|" host-sim/rigs/hobby.ini >"$work/held.ini"
printf '\n[controller]\ntick_us = 20000\n' >>"$work/held.ini"
"$boresight" run "$work/held.ini" --stay >/dev/null 2>"$work/held.err" &
holder=$!
until_true 60 grep -q 'run: ready' "$work/held.err"
make_rig none none
sed 's/^bus = .*/bus = gs_usb:0001/; s/^tick_us.*/tick_us = 20000/' "$work/rig.ini" >"$work/bus.ini"
"$boresight" run "$work/bus.ini" --stay >/dev/null 2>"$work/bus.err" &
bus_holder=$!
taken() { ! adapters; } # by libusb from the kernel's driver
until_true 60 taken
once='in use by another program; end that one first'
refused a_maestro_in_use device maestro:00031415 "Maestro 00031415: $once"
refused an_output_in_use channel 2 "pwmchip0 output 2: $once (\`fuser -v\` on the file shows it)"
refused an_adapter_in_use bus gs_usb:0001 "CAN adapter 0001: $once"
# On a machine so slow that the camera gives no frame for three seconds, its holder lets go of it and opens it anew.
refused a_camera_in_use camera /dev/video0 "/dev/video0: $once (\`fuser -v\` on the file shows it)" >"$work/verdicts"
spoiled=
if grep -q '^FAIL' "$work/verdicts" && grep -q 'it is opened anew' "$work/held.err"; then
    echo 'SKIP vm.refusals.a_camera_in_use: the machine was too slow for frames'
    spoiled=1
else
    cat "$work/verdicts"
fi
kill -INT $holder $bus_holder
wait $holder
[ $? -eq 0 ]
verdict refusals.who_held_them_was_not_disturbed $? "$work/held.err"
wait $bus_holder

# What this user may not use.
user=$nobody
closed() { echo "no permission; its mode is $1 and no group is let in: a udev rule or chmod has to change that"; }
udev='no permission; install the udev rules of docs/rig.md, or run as root, and plug it in again'
chmod 600 /dev/gpiochip* /dev/video*
chmod 600 "$(usb_file 1ffb)" "$(usb_file 1d50)"
refused a_forbidden_maestro device maestro "Maestro 1ffb:0089: $udev"
refused a_forbidden_adapter bus gs_usb "CAN adapter 1d50:606f: $udev"
refused a_forbidden_output channel 5 "pwmchip0 output 5: $(closed 200)"
refused a_forbidden_camera camera /dev/video0 "/dev/video0: $(closed 600)"
refused a_camera_of_a_name_that_is_forbidden camera 'Boresight test camera' "/dev/video0: $(closed 600)"
first=$(echo /dev/gpiochip*)
refused a_forbidden_line estop rig-lines:2 "${first%% *}: $(closed 600)"
refused a_forbidden_line_by_its_chip estop "$gpio:2" "/dev/$gpio: $(closed 600)"
$nobody "$boresight" probe >"$work/probe" 2>&1
[ "$(grep -c "^gpio .*; first: its mode is 600 and no group is let in" "$work/probe")" -ge 1 ] &&
    grep -q '^pwm .*; first: its mode is 200 and no group is let in' "$work/probe" &&
    grep -q '^camera .*; first: its mode is 600 and no group is let in' "$work/probe" &&
    grep -q '^usb  *Maestro.*; first: let this user open it' "$work/probe" && grep -q '^usb  *gs_usb.*; first: let this user open it' "$work/probe"
verdict refusals.probe_tells_who_may_not_what_to_do $? "$work/probe"
chgrp video /dev/video0 && chmod 660 /dev/video0
refused a_camera_of_a_group camera /dev/video0 '/dev/video0: no permission; join group video (sudo usermod -aG video $USER) and log in again'
user=

end_record
[ -n "$spoiled" ] || [ ! -s "$work/candump" ]
verdict refusals.nothing_was_sent_meanwhile $? "$work/candump"

# One drive answers, the other one is not there: it is named, and the first one does not move (commands A1 to A9).
printf '[scenario]\nname = served\nrig = served-rig.ini\nseconds = 1\ntick_us = 10000\n\n[targets]\nfile = none.jsonl\n' >"$work/served.ini"
: >"$work/none.jsonl"
make_rig none none
sed 's/^bus = .*/bus = fake/' "$work/rig.ini" >"$work/served-rig.ini"
serve
record vcan0
make_rig id 5
"$boresight" run "$work/rig.ini" --arm --seconds 60 >/dev/null 2>"$work/err"
[ $? -eq 4 ] && [ "$(cat "$work/err")" = \
    'boresight run: can:vcan0: drive 5 does not answer; is it powered, its id and the bit rate right, the bus terminated?' ]
verdict refusals.the_drive_that_is_not_there_is_named $? "$work/err"
end_record
grep -q ' 241#' "$work/candump" && grep -q ' 145#' "$work/candump" && ! grep -q ' 14.#A' "$work/candump"
verdict refusals.the_drive_that_answers_does_not_move $?

# ---------------------------------------------------------------- a rig file of nothing but what `probe` prints, and names that stay
mkdir -p /dev/v4l/by-path && ln -s ../../video0 /dev/v4l/by-path/platform-usb-0:4:1.0-video-index0
"$boresight" probe >"$work/probe" 2>"$work/err"
probed() { sed -n "/^$1 .*$2/s/.* \($3 = [^ ]*\) .*/\1/p" "$work/probe" | head -n 1; } # KIND ABOUT KEY
[ "$(probed camera . device)" = 'device = /dev/v4l/by-path/platform-usb-0:4:1.0-video-index0' ]
verdict refusals.probe_prefers_names_that_stay $? "$work/probe"
{
    printf '[pan]\ndrive = pwm\n%s\nchannel = 0\nlimit_min_deg = -50\nlimit_max_deg = 50\nspeed_max_dps = 20\naccel_max_dps2 = 40\n' "$(probed usb Maestro device)"
    printf '[tilt]\ndrive = rmd\n%s\nid = 2\nlimit_min_deg = -30\nlimit_max_deg = 60\nspeed_max_dps = 10\naccel_max_dps2 = 20\n' "$(probed can vcan0 bus)"
    printf '[zoom]\ndrive = pwm\n%s\nchannel = 3\nfocal_mm = 3, 30\npulse_us = 1000, 2000\n' "$(probed pwm pca9685 device)"
    printf '[camera]\n%s\ndetect = markers\nrate_hz = 5\nwidth_px = 160\nheight_px = 120\n' "$(probed camera . device)"
    printf '[safety]\n%s\nsilence_ms = 2000\nwatchdog_ms = 0\n\n[controller]\ntick_us = 20000\n' "$(probed gpio rig-lines estop | sed 's/LINE/1/')"
} >"$work/rig.ini"
# homes NAME RIG WORDS: homed, with frames of its camera, and said no more than WORDS; as $user
homes() {
    : >"$work/out" >"$work/err" # or what waits for words may find the last run's
    # shellcheck disable=SC2086
    $user "$boresight" run "$2" --stay --state 0.5 --json >"$work/out" 2>"$work/err" &
    runner=$!
    case $3 in *pressed*) # the line's `up` has moved the simulated pin itself: now the button is closed
        until_true 60 grep -q 'emergency stop is pressed' "$work/err"
        echo pull-down >"$pins/sim_gpio1/pull"
        until_true 60 grep -q 'emergency stop is released' "$work/err" ;;
    esac
    until_true 60 grep -q 'run: ready' "$work/err" && until_true 60 grep -q '"camera_frames": [1-9]' "$work/out"
    came=$?
    kill -INT $runner
    wait $runner
    case $? in 0 | 5) [ $came -eq 0 ] && ! grep -qvE "run: (ready|starting|without .*|.*it is opened anew)\$|$3" "$work/err" ;; *) false ;; esac
    verdict "refusals.$1" $? "$2" "$work/err" "$work/out"
}
homes a_rig_of_what_probe_prints "$work/rig.ini" 'emergency stop is (pressed|released)'
end_serve

# ---------------------------------------------------------------- who is in the groups of docs/rig.md, by the installed rules as udev takes them
udevd=/lib/systemd/systemd-udevd
if [ ! -x $udevd ]; then
    echo 'SKIP vm.refusals.members_of_the_groups_may_use_them: no udev here'
    exit
fi
cp /etc/group "$work/group"
for group in gpio plugdev; do grep -q "^$group:" "$work/group" || echo "$group:x:$((7000 + $(wc -l <"$work/group"))):" >>"$work/group"; done
mount --bind "$work/group" /etc/group
rm -r /dev/v4l
mkdir -p /run/udev/rules.d && cp boards/linux/package/70-boresight.rules /run/udev/rules.d/
chgrp 0 /dev/video0
chmod 600 /dev/video0
$udevd --daemon >"$work/udev" 2>&1
udevadm trigger --action=add /dev/video0 "/dev/$gpio" /sys/class/pwm/pwmchip0 "$(usb_file 1ffb)" "$(usb_file 1d50)" >>"$work/udev" 2>&1
udevadm settle --timeout=120 >>"$work/udev" 2>&1
belongs() { # FILE GROUP
    [ "$(stat -L -c %G "$1")" = "$2" ] && case $(stat -L -c %A "$1") in ?????w*) true ;; *) false ;; esac
}
belongs "$(usb_file 1ffb)" plugdev && belongs "$(usb_file 1d50)" plugdev && belongs "/dev/$gpio" gpio && belongs /sys/class/pwm/pwmchip0/export gpio
verdict refusals.rules_give_devices_to_their_groups $? "$work/udev"
# No root, and outputs that nobody has had before: on a machine as slow as this one their files get their group later than the
# driver waits for, and --stay looks again.
sed -i "s/^channel = 2/channel = 9/; s/^settle_ms.*/&\nestop = $gpio:1/" "$work/held.ini"
user='setpriv --reuid 65534 --regid 65534 --groups gpio,plugdev,video'
homes members_of_the_groups_may_use_them "$work/held.ini" 'pwmchip0 output [0-9]: no permission|run: waiting until|run: all devices are there'
