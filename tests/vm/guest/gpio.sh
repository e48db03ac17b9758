# GPIO lines on a bank of gpio-sim.
. tests/vm/guest/check.sh
load -a gpio-sim
mount -t configfs config /sys/kernel/config 2>/dev/null
"$VM_PROGRAMS/linux_gpio"
verdict gpio$VM_SUFFIX.linux_gpio_ended_well $?
