#!/bin/sh
# What `make install` puts beside the program works: the service is one that systemd takes, the device rules are whole and know every
# adapter that the drivers know, the rig files are valid; and `make uninstall` leaves nothing behind.
. tests/cli/support/check.sh
make_it() { # TARGET
    env -u MAKEFLAGS -u MAKELEVEL make --no-print-directory "$1" DESTDIR="$dir/root" PREFIX=/opt/rig >"$dir/out" 2>"$dir/err"
    status=$?
}
make_it install
(cd "$dir/root" 2>/dev/null && find . -type f | sort) >"$dir/files"
cat >"$dir/wanted" <<'END'
./opt/rig/bin/boresight
./opt/rig/lib/systemd/system/boresight.service
./opt/rig/lib/udev/rules.d/70-boresight.rules
./opt/rig/share/boresight/80-can.network
./opt/rig/share/boresight/rigs/hobby.ini
./opt/rig/share/boresight/rigs/rmd.ini
END
[ "$status" -eq 0 ] && diff "$dir/wanted" "$dir/files"
verdict 'everything is installed' $?
root=$dir/root/opt/rig
run config check "$root/share/boresight/rigs/rmd.ini"
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
verdict 'the rig file for CAN servos is valid' $?
run config check "$root/share/boresight/rigs/hobby.ini"
[ "$status" -eq 0 ] && [ ! -s "$dir/err" ]
verdict 'the rig file for hobby servos is valid' $?
"$root/bin/boresight" --version >"$dir/out" 2>"$dir/err"
status=$?
verdict 'the installed program runs' $status

# ---------------------------------------------------------------- the service
# verified FILE: without a word from systemd, which otherwise only warns.
verified() {
    mkdir -p "$dir/unit" && sed "s|^ExecStart=[^ ]*|ExecStart=$PWD/$root/bin/boresight|" "$1" >"$dir/unit/boresight.service"
    systemd-analyze verify --man=no "$dir/unit/boresight.service" >"$dir/out" 2>"$dir/err" && [ ! -s "$dir/err" ]
}
service=$root/lib/systemd/system/boresight.service
grep -q '^ExecStart=/opt/rig/bin/boresight run /etc/boresight/rig.ini ' "$service" && ! grep -q '@' "$service"
verdict 'the service names the installed program' $?
if command -v systemd-analyze >/dev/null; then
    verified "$service"
    verdict 'systemd takes the service' $?
    sed 's/^RestartSec/RestartSeconds/' "$service" >"$dir/wrong.service"
    ! verified "$dir/wrong.service"
    verdict 'a wrong key in it is caught' $?
else
    echo 'SKIP systemd takes the service: no systemd-analyze here'
fi
# Every option of the program in it.
for word in $(sed -n 's/^ExecStart=[^ ]* run [^ ]* //p' "$service"); do
    case $word in --*) "$boresight" help run | grep -q -e "^  $word[ ,]" || echo "$word" ;; esac
done >"$dir/unknown"
[ ! -s "$dir/unknown" ]
verdict 'its options exist' $?

# ---------------------------------------------------------------- the device rules (udev itself tries them in the virtual machine)
# off FILE: lines that are not KEY==, KEY!=, KEY= or KEY+= with a quoted value, separated by commas.
off() {
    sed '/^#/d; /^$/d' "$1" | grep -vnE \
        '^(SUBSYSTEM|ACTION|KERNEL|ENV\{[A-Z]+\}|ATTR\{[A-Za-z]+\})(==|!=)"[^"]*"(, ((SUBSYSTEM|ACTION|KERNEL|ENV\{[A-Z]+\}|ATTR\{[A-Za-z]+\})(==|!=)"[^"]*"|(GROUP|MODE)="[^"]*"|RUN\+="[^"]*"))*$'
}
rules=$root/lib/udev/rules.d/70-boresight.rules
[ "$(grep -c '^SUBSYSTEM' "$rules")" -ge 7 ] && ! off "$rules"
verdict 'the device rules are whole' $?
sed 's/GROUP="plugdev", /GROUP=plugdev, /' "$rules" >"$dir/wrong.rules"
off "$dir/wrong.rules" >"$dir/out"
verdict 'a wrong rule is caught' $?
# unknown FILE: adapters of the drivers without a rule.
unknown() {
    sed -n '/adapters\[\] = {/,/};/p' hal/linux/linux_gs_usb.c | grep -oE '0x[0-9A-F]{4}, 0x[0-9A-F]{4}' | tr 'A-F' 'a-f' |
        sed 's/0x//g; s/,//' | while read -r vendor product; do
        grep -q "idVendor}==\"$vendor\", ATTR{idProduct}==\"$product\", GROUP=\"plugdev\", MODE=\"0660\"" "$1" || echo "$vendor:$product"
    done
    grep -q '"1ffb", GROUP="plugdev", MODE="0660"' "$1" || echo Maestro
}
unknown "$rules" >"$dir/out"
[ ! -s "$dir/out" ]
verdict 'every adapter has a rule' $?
sed 's/"16d0"/"16d1"/' "$rules" >"$dir/wrong.rules"
unknown "$dir/wrong.rules" >"$dir/out"
grep -qx 16d0:10b8 "$dir/out"
verdict 'a missing rule is caught' $?

make_it uninstall
[ "$status" -eq 0 ] && [ -z "$(find "$dir/root" -type f)" ]
verdict 'uninstall leaves nothing behind' $?
finish
