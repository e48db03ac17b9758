#!/bin/sh
# Runs where libunicorn is missing: names what is left out, and checks that the program says so, too.
. tests/gate/verdict.sh
for test in tests/mcu/cpu/*.c tests/mcu/cpu/*.sh; do
    echo "SKIP $test: libunicorn is not installed"
done
message=$(build/boresight sim host-sim/scenarios/hobby.ini --mcu none.elf 2>&1 >/dev/null)
[ $? -eq 4 ]
verdict 'sim --mcu without the emulator is a missing device' $?
case $message in *"make emulator"*) true ;; *) false ;; esac
verdict 'and says how to build it' $?
exit $status
