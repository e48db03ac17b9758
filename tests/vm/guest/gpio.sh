# GPIO lines on a bank of gpio-sim; PWM outputs of a PCA9685.
. tests/vm/guest/check.sh
load -a gpio-sim
mount -t configfs config /sys/kernel/config 2>/dev/null
"$VM_PROGRAMS/linux_gpio"
verdict gpio$VM_SUFFIX.linux_gpio_ended_well $?
# The driver's file for libgpiod 2.x, with that library; where 2.x is the installed one, it was the first.
if [ -n "$VM_SUFFIX" ] || grep -q 'HAVE_GPIOD 2' "$VM_TESTS/features.h"; then
    :
elif [ -x "$VM_PROGRAMS/linux_gpio_2" ]; then
    "$VM_PROGRAMS/linux_gpio_2" >/tmp/gpio2 2>&1
    status=$?
    sed 's/ linux_gpio\./ linux_gpio_2./' /tmp/gpio2
    verdict gpio.linux_gpio_2_ended_well $status
else
    echo "SKIP gpio.linux_gpio_2: Debian's libgpiod 2.x can not be had here (sh tests/vm/packages.sh trixie libgpiod-dev)"
fi
# PWM: the kernel's driver of the PCA9685 on the registers of i2c-stub.
rmmod gpio-sim 2>/dev/null
load i2c-stub chip_addr=0x40
load -a i2c-dev pwm-pca9685
"$VM_PROGRAMS/linux_pwm"
verdict gpio$VM_SUFFIX.linux_pwm_ended_well $?
