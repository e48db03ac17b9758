# USB by libusb: an emulated Maestro in the kernel's virtual host controller.
. tests/vm/guest/check.sh
load vhci-hcd
"$VM_PROGRAMS/linux_usb"
verdict usb$VM_SUFFIX.linux_usb_ended_well $?
load -a can_raw gs_usb
# What the kernel's driver gets from two processors overtakes itself in the queue that each has: an emulated bus is served by any of them, a
# real one by the processor of its interrupt.
echo 0 >/sys/devices/system/cpu/cpu1/online
"$VM_PROGRAMS/gs_usb"
verdict usb$VM_SUFFIX.gs_usb_ended_well $?
echo 1 >/sys/devices/system/cpu/cpu1/online
