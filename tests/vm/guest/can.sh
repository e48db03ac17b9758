# SocketCAN: a virtual bus, and three emulated cards, the first two on one bus.
. tests/vm/guest/check.sh
load -a vcan can_raw kvaser_pci
ip link add dev vcan0 type vcan && ip link set vcan0 up
until_true 60 test -e /sys/class/net/can2
for link in can0 can1; do ip link set $link down; done
ip link set can0 up type can bitrate 1000000 restart-ms 250
ip link set can1 up type can bitrate 1000000
# On the processor that serves the interrupts, so that what has begun to arrive has arrived when the test goes on.
taskset 1 "$VM_PROGRAMS/linux_can"
verdict can$VM_SUFFIX.linux_can_ended_well $?
ip link del vcan0
