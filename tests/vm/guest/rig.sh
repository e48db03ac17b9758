# `boresight run` with a Maestro, an emergency stop, a limit switch and an enable line; `boresight probe`.
. tests/vm/guest/check.sh
load -a vhci-hcd gpio-sim
mount -t configfs config /sys/kernel/config 2>/dev/null
boresight=$VM_TESTS/gcc/boresight
work=$(mktemp -d)
bank=/sys/kernel/config/gpio-sim/rig
mkdir -p $bank/bank0 && echo 8 >$bank/bank0/num_lines && echo rig-lines >$bank/bank0/label && echo 1 >$bank/live
pins=/sys/devices/platform/$(cat $bank/dev_name)/$(cat $bank/bank0/chip_name)
pull() { echo "$2" >"$pins/sim_gpio$1/pull"; }
level() { cat "$pins/sim_gpio$1/value"; }
is() { [ "$(level "$1")" = "$2" ]; }

sed 's/^device = fake/device = maestro/' host-sim/rigs/hobby.ini >"$work/rig.ini"
sed -i '/^\[tilt\]/,/^\[/ s/^channel = 1/channel = 1\nswitch_max = rig-lines:3:low/' "$work/rig.ini"
printf 'estop = rig-lines:1\nenable = rig-lines:2\n\n[controller]\ntick_us = 10000\n' >>"$work/rig.ini"
printf '{"id": 1, "dir": [0.5, 1, 0.2]}\n' >"$work/targets.jsonl"

start() { # ARGUMENT...
    : >"$work/run.json" >"$work/run.err" # or what waits for words may find the last run's
    watched "$boresight" run "$work/rig.ini" --json --seconds 300 --targets "$work/targets.jsonl" "$@" >"$work/run.json" 2>"$work/run.err" &
    runner=$!
}
says() { [ "$(grep -c "$1" "$work/run.err")" -ge "${2:-1}" ]; }
plug() {
    "$VM_TESTS/gcc/tests/vm/plug_maestro" "$work/maestro" &
    maestro=$!
}
unplug() {
    kill -TERM $maestro
    wait $maestro
}
# Pulses of hobby.ini: 11.111 us a degree around 1500 us, in quarter microseconds.
pulse_for() { awk -v deg="$1" 'BEGIN { printf "%d", (1500 + deg * 1333.333333 / 120) * 4 + 0.5 }'; }
gives() { # PAN_DEG TILT_DEG
    read -r pan tilt _ <"$work/maestro" && [ $((pan - $(pulse_for "$1"))) -ge -1 ] && [ $((pan - $(pulse_for "$1"))) -le 1 ] &&
        [ $((tilt - $(pulse_for "$2"))) -ge -1 ] && [ $((tilt - $(pulse_for "$2"))) -le 1 ]
}

# The resistors are on the outside here: a request for a pull would move the simulated pin.
pull 1 pull-down # the emergency stop is closed
pull 3 pull-up
start --arm
wait $runner
[ $? -eq 4 ] && says 'Maestro: no such USB device; '
verdict rig.no_maestro_is_status_4 $? "$work/run.err"
is 2 0
verdict rig.nothing_is_enabled_without_it $?
plug
plugged() { grep -qs 1ffb /sys/bus/usb/devices/*/idVendor; } # the list is made anew each time
until_true 60 plugged
sleep 0.5
"$boresight" probe >"$work/probe"
grep -q '^usb .* device = maestro:00031415 ' "$work/probe" && grep -q "^gpio .*'rig-lines', lines 0 to 7" "$work/probe"
verdict rig.probe_lists_what_is_there $? "$work/probe"
start --arm --stay
until_true 60 says 'run: tracking'
is 2 1
verdict rig.enable_line_is_active_while_powered $? "$work/run.err"
# atan2(0.5, 1) and asin(0.2 / |(0.5, 1, 0.2)|)
until_true 60 gives 26.5651 10.1421
verdict rig.maestro_gets_the_pulses_of_the_aim $? "$work/maestro" "$work/run.err"

pull 1 pull-up # pressed: or its wire is broken
until_true 60 says 'run: stopped' && says 'emergency stop is pressed'
verdict rig.emergency_stop_stops $? "$work/run.err"
kill -USR1 $runner
sleep 0.5
! says 'run: tracking' 2
verdict rig.nothing_arms_while_it_is_pressed $? "$work/run.err"
pull 1 pull-down
until_true 60 says 'emergency stop is released'
sleep 0.3
! says 'run: tracking' 2
verdict rig.its_release_does_not_arm $? "$work/run.err"
kill -USR1 $runner
until_true 60 says 'run: tracking' 2
verdict rig.a_person_arms_again $? "$work/run.err"

pull 3 pull-down
until_true 60 says 'tilt switch_max is pressed' && until_true 60 says 'run: stopped' 2
verdict rig.limit_switch_stops $? "$work/run.err"
pull 3 pull-up
kill -USR1 $runner
until_true 60 says 'run: tracking' 3

unplug
until_true 60 says 'Maestro 1ffb:0089: the device has left'
verdict rig.tells_that_the_maestro_has_left $? "$work/run.err"
plug
until_true 60 says 'all devices are there again'
verdict rig.opens_it_again $? "$work/run.err"
kill -USR1 $runner
until_true 60 says 'run: tracking' 4 && until_true 60 gives 26.5651 10.1421
verdict rig.goes_on_where_it_was $? "$work/maestro" "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ]
verdict rig.ends_well $? "$work/run.err"
grep -q '"pan_servo_us": 179[0-9.]*, "pan_servo_deg": 26.5[0-9]*, "tilt_servo_us": [0-9.]*, "tilt_servo_deg": 10.1' "$work/run.json"
verdict rig.reads_back_where_the_servos_are $? "$work/run.json"
until_true 60 is 2 0
verdict rig.enable_line_is_let_go $?

start --arm
until_true 60 says 'run: tracking'
pull 1 pull-up
wait $runner
[ $? -eq 5 ]
verdict rig.emergency_stop_is_status_5 $? "$work/run.err"

# ---------------------------------------------------------------- servo and stepper on plain lines; a chip that leaves
pull 1 pull-down
awk '/^\[/ { section = $1 } section == "[pan]" && /^device/ { print "device = gpio:rig-lines"; next }
    section == "[pan]" && /^channel/ { print "channel = 4"; next }
    section == "[tilt]" && /^drive/ { print "drive = step"; next }
    section == "[tilt]" && /^device/ { print "device = gpio:rig-lines"; next }
    section == "[tilt]" && /^channel/ { print "channel = 5\ndirection_channel = 6\nsteps_per_deg = 20"; next }
    section == "[tilt]" && /^switch|^calibration/ { next }
    { print }' "$work/rig.ini" >"$work/lines.ini" && mv "$work/lines.ini" "$work/rig.ini"
"$boresight" config check "$work/rig.ini" >"$work/check"
verdict rig.plain_lines_in_a_rig_file $? "$work/rig.ini" "$work/check"
start --arm --stay
until_true 30 says 'run: tracking'
verdict rig.runs_on_plain_lines $? "$work/run.err"
ever_high() { for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do is "$1" 1 && return 0; done; return 1; }
until_true 30 ever_high 4
verdict rig.servo_pulses_come_out $?
echo 0 >$bank/live
until_true 30 says 'the chip has gone'
verdict rig.tells_that_the_chip_has_left $? "$work/run.err"
echo 1 >$bank/live
pins=/sys/devices/platform/$(cat $bank/dev_name)/$(cat $bank/bank0/chip_name)
pull 1 pull-down
until_true 30 says 'all devices are there again'
verdict rig.opens_the_chip_again $? "$work/run.err"
until_true 30 says 'emergency stop is released'
kill -USR1 $runner
until_true 30 says 'run: tracking' 2
verdict rig.goes_on_after_the_chip_came_back $? "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ]
verdict rig.ends_well_on_plain_lines $? "$work/run.err"
for name in edge_late_us_p50 edge_late_us_p99 edge_late_us_max; do
    value=$(sed -n "s/.*\"$name\": \([0-9.]*\).*/\1/p" "$work/run.json")
    echo "# edges in the emulator: $name $value"
    [ -n "$value" ]
    verdict rig.prints_$name $? "$work/run.json"
done

unplug
echo 0 >$bank/live
rmdir $bank/bank0 $bank

# ---------------------------------------------------------------- servos on a PCA9685, the kernel's driver of it on i2c-stub's registers
sed 's/^device = fake/device = pwmchip0/' host-sim/rigs/hobby.ini >"$work/rig.ini"
printf '\n[controller]\ntick_us = 10000\n' >>"$work/rig.ini"
start --arm
wait $runner
[ $? -eq 4 ] && says 'pwmchip0: no such PWM chip; is the overlay loaded '
verdict rig.no_pwm_chip_is_status_4 $? "$work/run.err"
load i2c-stub chip_addr=0x40
load -a i2c-dev pwm-pca9685
i2c=$(echo /sys/bus/i2c/devices/i2c-*)
i2c=${i2c##*-}
driver=/sys/bus/i2c/drivers/pca9685-pwm
# As after power-on: asleep, outputs off, 200 Hz.
register() { i2cget -y -f "$i2c" 0x40 "$1"; }
i2cset -y -f "$i2c" 0x40 0x00 0x11
i2cset -y -f "$i2c" 0x40 0xfe 0x1e
for off_high in 0x09 0x0d; do i2cset -y -f "$i2c" 0x40 $off_high 0x10; done
echo pca9685 0x40 >"/sys/bus/i2c/devices/i2c-$i2c/new_device"
"$boresight" probe >"$work/probe"
grep -q '^pwm .* device = pwmchip0 .*pca9685-pwm, channels 0 to 15$' "$work/probe"
verdict rig.probe_lists_the_pca9685 $? "$work/probe"

# Counts (of 4880 ns) that an output is high; 0: off. By the registers ON_L, ON_H, OFF_L, OFF_H.
counts_of() { # FIRST-REGISTER
    echo $(($(register $(($1 + 3))) & 16 ? 0 : (($(register $(($1 + 3))) << 8) + $(register $(($1 + 2))) - \
        ($(register $(($1 + 1))) << 8) - $(register "$1")) & 4095))
}
wanted_counts() { awk -v deg="$1" 'BEGIN { printf "%d", (1500000 + deg * 1333333.333 / 120) / 4880 + 0.5 }'; }
chip_gives() { [ "$(counts_of 6)" -eq "$1" ] && [ "$(counts_of 10)" -eq "$2" ]; }
start --arm --stay
until_true 60 says 'run: tracking'
until_true 60 chip_gives "$(wanted_counts 26.5651)" "$(wanted_counts 10.1421)"
verdict rig.pca9685_gets_the_pulses_of_the_aim $? "$work/run.err"
[ "$(register 0xfe)" = 0x79 ] # 4096 * 122 * 40 ns = 19.99 ms
verdict rig.pca9685_has_the_period_of_servos $?
[ "$(counts_of 14)" -eq 0 ]
verdict rig.pca9685_other_outputs_are_silent $?
echo "$i2c-0040" >$driver/unbind
until_true 60 says 'pwmchip0 output [01]: the chip has gone; was its driver unloaded?'
verdict rig.tells_that_the_pwm_chip_has_gone $? "$work/run.err"
chip_gives 0 0
verdict rig.its_servos_are_let_go $?
echo "$i2c-0040" >$driver/bind
until_true 60 says 'all devices are there again'
verdict rig.opens_the_pwm_chip_again $? "$work/run.err"
kill -USR1 $runner
until_true 60 says 'run: tracking' 2 && until_true 60 chip_gives "$(wanted_counts 26.5651)" "$(wanted_counts 10.1421)"
verdict rig.goes_on_with_the_pwm_chip $? "$work/run.err"
kill -INT $runner
wait $runner
[ $? -eq 0 ]
verdict rig.ends_well_with_the_pwm_chip $? "$work/run.err"
chip_gives 0 0
verdict rig.pwm_outputs_are_off_in_the_end $?
start --arm
until_true 60 says 'run: tracking'
echo "$i2c-0040" >$driver/unbind
wait $runner
[ $? -eq 4 ] && says 'the chip has gone'
verdict rig.a_lost_pwm_chip_is_status_4 $? "$work/run.err"
loop_only_waits rig
