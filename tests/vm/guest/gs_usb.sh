# gs_usb by libusb, on emulated adapters in the kernel's virtual host controller, and against the kernel's own driver.
. tests/vm/guest/check.sh
load -a vhci-hcd can_raw gs_usb
# One processor for the kernel's driver, as in usb.sh.
echo 0 >/sys/devices/system/cpu/cpu1/online
"$VM_PROGRAMS/linux_gs_usb"
verdict gs_usb$VM_SUFFIX.linux_gs_usb_ended_well $?
