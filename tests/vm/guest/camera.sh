# Cameras: the kernel's vivid, and a USB camera emulated below uvcvideo.
. tests/vm/guest/check.sh
load vivid n_devs=1 node_types=0x1
load -a vhci-hcd uvcvideo
"$VM_TESTS/gcc/tests/vm/linux_camera"
verdict camera.linux_camera_ended_well $?
