# GPIO lines on a bank of gpio-sim.
. tests/vm/guest/check.sh
load -a gpio-sim
mount -t configfs config /sys/kernel/config 2>/dev/null
"$VM_PROGRAMS/linux_gpio"
verdict gpio$VM_SUFFIX.linux_gpio_ended_well $?
# The driver's file for libgpiod 2.x, whichever version is installed.
if [ -z "$VM_SUFFIX" ]; then
    "$VM_PROGRAMS/linux_gpio_2" >/tmp/gpio2 2>&1
    status=$?
    sed 's/ linux_gpio\./ linux_gpio_2./' /tmp/gpio2
    verdict gpio.linux_gpio_2_ended_well $status
fi
# No chip of the distribution's kernel gives PWM on this machine; tests/contract/linux_pwm.c has files that stand for one.
[ -n "$VM_SUFFIX" ] || [ -e /sys/class/pwm/pwmchip0 ] || echo 'SKIP vm.gpio.pwm_by_sysfs: this kernel has no PWM chip here'
