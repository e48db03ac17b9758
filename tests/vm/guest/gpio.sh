# GPIO lines on a bank of gpio-sim.
. tests/vm/guest/check.sh
load -a gpio-sim
mount -t configfs config /sys/kernel/config
"$VM_TESTS/gcc/tests/vm/linux_gpio"
verdict gpio.linux_gpio_ended_well $?
