# SocketCAN: a virtual bus, and three emulated cards, the first two on one bus.
. tests/vm/guest/check.sh
load -a vcan can_raw kvaser_pci
ip link add dev vcan0 type vcan && ip link set vcan0 up
until_true 60 test -e /sys/class/net/can2
ip link set can0 up type can bitrate 1000000 restart-ms 250
ip link set can1 up type can bitrate 1000000
# On the processor that serves the interrupts, so that what has begun to arrive has arrived when the test goes on.
taskset 1 "$VM_TESTS/gcc/tests/vm/linux_can"
verdict can.linux_can_ended_well $?
ip link del vcan0
