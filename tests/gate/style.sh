#!/bin/sh
# Layout and length of every C file, what headers state and name, and violations planted to see that the gate catches them.
. tests/gate/verdict.sh
files=$(git ls-files --cached --others --exclude-standard '*.c' '*.h')
# Other versions lay out a few lines otherwise, so only 14 judges. Its exit status tells; what is off is shown by its first lines.
judge=$(clang-format --version | sed 's/.*version \([0-9]*\).*/\1/')
if [ "$judge" = 14 ]; then
    clang-format --dry-run -Werror $files 2>&1 | head -n 20
    clang-format --dry-run -Werror $files 2>/dev/null
    verdict 'layout (make format mends it)' $?
else
    echo "SKIP layout: clang-format 14 judges it, this is $judge"
fi
# Tables of vectors are data, however long.
awk -f tests/gate/check/lengths.awk $(printf '%s\n' $files | grep -v '^tests/vectors/')
verdict 'length of files, functions and lines' $?
awk -f tests/gate/check/headers.awk firmware/sphere/*.h firmware/aim/*.h
verdict 'the functions of sphere/ and aim/ state cost, accuracy and source' $?
sh tests/gate/check/shown.sh $(git ls-files --cached --others --exclude-standard 'hal/*.h' 'boards/linux/*.h')
verdict 'the headers of hal/ and of the program name their tests' $?
sh tests/gate/check/names.sh $(git ls-files --cached --others --exclude-standard '*.md' '*.h' '*.c' | grep -v '^tests/vectors/')
verdict 'the files that comments and pages name exist' $?
sh tests/gate/check/named-tests.sh tests/README.md
verdict 'the tests of failing devices that tests/README.md names exist' $?

dir=$(mktemp -d)
cp .clang-format "$dir"
printf 'int   f( void );\n' >"$dir/x.c"
(cd "$dir" && clang-format --dry-run -Werror x.c 2>/dev/null)
caught 'a wrong layout' $?
{ echo 'static void f(void) {'; seq -f '    g(%g);' 60; echo '}'; } >"$dir/x.c"
awk -f tests/gate/check/lengths.awk "$dir/x.c" >/dev/null
caught 'a long function' $?
seq 501 >"$dir/x.c"
awk -f tests/gate/check/lengths.awk "$dir/x.c" >/dev/null
caught 'a long file' $?
printf '/// Turns. Cost: none. Source: none.\nint turn(int a,\n         int b);\n' >"$dir/x.h"
awk -f tests/gate/check/headers.awk "$dir/x.h" >/dev/null
caught 'a function that does not state its accuracy' $?
echo 'Shown: tests/unit/test_hull.c, tests/unit/test_planted.c.' >"$dir/x.h"
sh tests/gate/check/names.sh "$dir/x.h" >/dev/null
caught 'a test that does not exist' $?
echo '/// Turns.' >"$dir/x.h"
sh tests/gate/check/shown.sh "$dir/x.h" >/dev/null
caught 'a header without a test' $?
echo 'As `hal/linux/linux_planted.h` says.' >"$dir/x.md"
sh tests/gate/check/names.sh "$dir/x.md" >/dev/null
caught 'a header that does not exist' $?
sed 's/`a_held_up_thread`/`a_planted_thread`/' tests/README.md >"$dir/x.md"
sh tests/gate/check/named-tests.sh "$dir/x.md" >/dev/null
caught 'a test of a failing device that does not exist' $?
rm -r "$dir"
exit $status
