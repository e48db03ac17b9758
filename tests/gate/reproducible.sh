#!/bin/sh
# The same sources give the same bytes in another folder; and the comparison notices when they don't.
. tests/gate/verdict.sh
boards="stm32f405:elf,bin,hex pico:elf,bin,hex,uf2"
here=$PWD
id=$(sed -n 's/^const char build_id\[\] = "\(.*\)";/\1/p' build/build_id.c)
dir=$(mktemp -d)
copy=$dir/a/folder/with/a/longer/name
mkdir -p "$copy/build/gcc"
git ls-files --cached --others --exclude-standard Makefile boards firmware hal host-sim/rigs 'host-sim/*.mk' 'tests/*.mk' |
    while read -r file; do [ ! -e "$file" ] || cp --parents "$file" "$copy"; done
cp build/boresight "$copy/build/boresight" # the program that writes the rig as C is not what is tested

files() { for b in $boards; do echo "${b#*:}" | tr , '\n' | sed "s#^#build/boards/${b%:*}/boresight.#"; done; }
build() { # MAKE-ARGUMENTS...
    # shellcheck disable=SC2046
    env -u MAKEFLAGS -u MAKELEVEL make -C "$copy" -s -o build/boresight build_id="$id" "$@" $(files) >"$dir/log" 2>&1 || cat "$dir/log"
}
same() { # BOARD
    for file in $(files | grep "/$1/"); do
        cmp "$here/$file" "$copy/$file" || return 1
    done
}
build
for board in $boards; do
    same "${board%:*}"
    verdict "${board%:*}: the same image, built in another folder" $?
    rm "$copy/build/boards/${board%:*}/obj/firmware/app/pump.o" "$copy/build/boards/${board%:*}"/boresight.*
done
build board_flags="$(make -s --no-print-directory print-board-flags | sed 's/ -ffile-prefix-map=[^ ]*//')"
for board in $boards; do
    same "${board%:*}" >/dev/null 2>&1
    caught "${board%:*}: a folder that gets into the image" $?
done
rm -r "$dir"
exit $status
