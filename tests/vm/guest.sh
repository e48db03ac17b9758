# Runs in the virtual machine as its first process: loads what a test group needs, runs the groups named on the kernel's
# command line (vm.groups=a,b), one after the other, then powers off. Verdicts go to a serial port of their own
# (vm.results=ttyS1), what else is said to the console.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin:/media/userland/usr/bin HOME=/tmp LC_ALL=C VM_TESTS=/mnt/build
cd /mnt
results=/dev/$(sed 's/.*vm.results=\([^ ]*\).*/\1/' /proc/cmdline)
exec </dev/null >"$results" 2>&1
stty -F "$results" raw
read -r uptime _ </proc/uptime
echo "# booted $(uname -r) in $uptime s"
ip link set lo up

# load MODULE [PARAMETER...], load -a MODULE...
modules() { modprobe -S "$(uname -r)" -d /media/kernel "$@"; }
[ ! -d /libraries ] || modules() { modprobe "$@"; } # busybox's, at /lib/modules
load() { modules "$@" || echo "# can't load $*"; }

for group in $(sed 's/.*vm.groups=\([^ ]*\).*/\1/; y/,/ /' /proc/cmdline); do
    read -r start _ </proc/uptime
    # GROUP-san: its C programs as the sanitizers watch them.
    case $group in
    *-san) VM_SUFFIX=-san VM_PROGRAMS=$VM_TESTS/san/tests/vm ;;
    *) VM_SUFFIX= VM_PROGRAMS=$VM_TESTS/gcc/tests/vm ;;
    esac
    # shellcheck disable=SC1090
    (. "tests/vm/guest/${group%-san}.sh")
    read -r end _ </proc/uptime
    awk -v group="$group" -v start="$start" -v end="$end" 'BEGIN { printf "# group %s: %.1f s\n", group, end - start }'
done
echo '# done'
sync
# The device isa-debug-exit ends the machine with exit status 2 * 32 + 1, which no failure of the emulator has.
[ "$(uname -m)" = x86_64 ] && [ -c /dev/port ] && printf '\040' | dd of=/dev/port bs=1 seek=244 conv=notrunc 2>/dev/null
poweroff -f
