#!/bin/sh
# The program without its optional libraries: it builds, says so, refuses by name what needs them, and its tests skip by
# name. What is built stays in build/none, so that only what changed is built again.
. tests/gate/verdict.sh
out=build/none
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
program=$out/boresight

tests=$out/gcc/tests
env -u MAKEFLAGS -u MAKELEVEL make -j2 -s B=$out gcc_flags=-O0 libusb=0 jpeg=0 apriltag=0 cairo=0 gpiod=0 \
    $program $tests/contract/linux_luma $tests/property/tag_frames $tests/scenario/test_camera_feed >"$dir/log" 2>&1
built=$?
[ $built -eq 0 ] || cat "$dir/log"
verdict 'it builds without any of them' $built
"$program" --version | grep -q '^libraries *no libgpiod, no libusb, no libjpeg-turbo, no libapriltag, no cairo$'
verdict '--version lists what is missing' $?
# And of this build what is there: every library whose header is.
for pair in gpiod.h:libgpiod libusb-1.0/libusb.h:libusb jpeglib.h:libjpeg-turbo apriltag/apriltag.h:libapriltag cairo/cairo.h:cairo; do
    if [ -e "/usr/include/${pair%:*}" ] || [ -e "/usr/local/include/${pair%:*}" ]; then
        build/boresight --version | grep '^libraries' | grep -q "[ ,]${pair#*:}" && ! build/boresight --version | grep -q "no ${pair#*:}"
    else
        build/boresight --version | grep -q "no ${pair#*:}"
    fi
    verdict "--version tells of ${pair#*:}" $?
done

refuses() { # NAME STATUS TEXT ARGUMENT...: one line with that text on stderr, and that exit status
    name=$1 wanted=$2 text=$3
    shift 3
    "$program" "$@" >"$dir/out" 2>"$dir/err" </dev/null
    [ $? -eq "$wanted" ] && [ "$(wc -l <"$dir/err")" -eq 1 ] && [ ! -s "$dir/out" ] && grep -q "this program was built without $text[;:] install .* and build it again" "$dir/err" || {
        cat "$dir/err"
        false
    }
    verdict "$name is refused in one line" $?
}
rig() { sed "$1" "host-sim/rigs/$2.ini" >"$dir/rig.ini"; }
rig 's/^bus = fake/bus = gs_usb/' camera
refuses 'a gs_usb adapter' 4 libusb run "$dir/rig.ini"
rig 's/^device = fake/device = maestro/' hobby
refuses 'a Maestro' 4 libusb run "$dir/rig.ini"
rig 's/^device = fake/device = gpio:gpiochip0/' hobby
refuses 'a servo on a line' 4 libgpiod run "$dir/rig.ini"
rig 's/^\[safety\]/&\nestop = gpiochip0:3/' hobby
refuses 'an emergency stop' 4 libgpiod run "$dir/rig.ini"
rig 's/^detect.*/detect = tags/' camera
refuses 'detect = tags' 2 libapriltag config check "$dir/rig.ini"
"$program" probe >/dev/null 2>"$dir/err"
grep -q 'GPIO chips are not looked for: built without libgpiod; install libgpiod-dev and build it again$' "$dir/err" &&
    grep -q 'USB is not looked at: built without libusb; install libusb-1.0-0-dev and build it again$' "$dir/err"
verdict 'probe says what it does not look for' $?

$tests/contract/linux_luma >"$dir/log" && grep -q '^SKIP linux_luma.jpeg: built without libjpeg-turbo$' "$dir/log" &&
    $tests/property/tag_frames >"$dir/log" && grep -q '^SKIP tag_frames: this program was built without libapriltag: install' "$dir/log"
verdict 'tests of what is missing are skipped by name' $?
$tests/scenario/test_camera_feed >"$dir/log" && grep -q '^# without libjpeg-turbo' "$dir/log" || {
    cat "$dir/log"
    false
}
verdict 'without libjpeg-turbo a camera is asked for pixels' $?
for test in camera detect picture; do
    BORESIGHT=$program sh tests/cli/$test.sh >"$dir/log" 2>&1
    ! grep -q '^FAIL' "$dir/log" && grep -q '^ok' "$dir/log" || {
        grep -A5 -B20 '^FAIL' "$dir/log" | tail -n 40
        false
    }
    verdict "tests/cli/$test.sh holds" $?
done
exit $status
