# USB by libusb: an emulated Maestro in the kernel's virtual host controller.
. tests/vm/guest/check.sh
load vhci-hcd
"$VM_PROGRAMS/linux_usb"
verdict usb$VM_SUFFIX.linux_usb_ended_well $?
load -a can_raw gs_usb
"$VM_PROGRAMS/gs_usb"
verdict usb$VM_SUFFIX.gs_usb_ended_well $?
if [ -z "$VM_SUFFIX" ]; then
    "$VM_PROGRAMS/linux_gs_usb"
    verdict usb.linux_gs_usb_ended_well $?
else
    echo "SKIP vm.usb$VM_SUFFIX.linux_gs_usb: with the sanitizers the emulated machine is too slow for its adapter's replies"
fi
