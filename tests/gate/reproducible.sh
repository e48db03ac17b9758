#!/bin/sh
# The same sources give the same bytes in another folder; and the comparison notices when they don't.
. tests/gate/verdict.sh
board=stm32f405
here=$PWD
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
dir=$(mktemp -d)
copy=$dir/a/folder/with/a/longer/name
mkdir -p "$copy/build/gcc"
git ls-files --cached --others --exclude-standard Makefile boards firmware hal host-sim/rigs 'host-sim/*.mk' 'tests/*.mk' |
    while read -r file; do [ ! -e "$file" ] || cp --parents "$file" "$copy"; done
cp build/boresight "$copy/build/boresight" # the program that writes the rig as C is not what is tested

build() { # MAKE-ARGUMENTS...
    env -u MAKEFLAGS -u MAKELEVEL make -C "$copy" -s -o build/boresight build_id="$id" "$@" \
        build/boards/$board/boresight.elf build/boards/$board/boresight.bin build/boards/$board/boresight.hex >"$dir/log" 2>&1 ||
        cat "$dir/log"
}
same() {
    for kind in elf bin hex; do
        cmp "$here/build/boards/$board/boresight.$kind" "$copy/build/boards/$board/boresight.$kind" || return 1
    done
}
build
same
verdict "$board: the same image, built in another folder" $?
rm "$copy"/build/boards/$board/obj/firmware/app/pump.o "$copy"/build/boards/$board/boresight.*
build board_flags="$(make -s --no-print-directory print-board-flags | sed 's/ -ffile-prefix-map=[^ ]*//')"
same >/dev/null 2>&1
caught 'a folder that gets into the image' $?
rm -r "$dir"
exit $status
