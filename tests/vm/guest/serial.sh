. tests/vm/guest/check.sh
load -a xhci-pci usbserial ftdi_sio slcan can_raw
until_true 30 test -e /dev/ttyUSB1
ls -l /dev/ttyUSB*
dmesg | grep -i -e ftdi -e usb | tail -30
for d in /sys/class/tty/ttyUSB*; do readlink -f $d/device; done
slcan_attach -h 2>&1 | head
slcand -h 2>&1 | head -30
