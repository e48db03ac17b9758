# USB by libusb: an emulated Maestro in the kernel's virtual host controller.
. tests/vm/guest/check.sh
load vhci-hcd
"$VM_TESTS/gcc/tests/vm/linux_usb"
verdict usb.linux_usb_ended_well $?
load -a can_raw gs_usb
"$VM_TESTS/gcc/tests/vm/gs_usb"
verdict usb.gs_usb_ended_well $?
"$VM_TESTS/gcc/tests/vm/linux_gs_usb"
verdict usb.linux_gs_usb_ended_well $?
