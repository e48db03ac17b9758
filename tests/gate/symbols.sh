#!/bin/sh
# firmware/ for Cortex-M0+ and M4, and on the host: no allocator, no floating point, nothing of a libc. And violations
# planted to see that the gate catches them.
. tests/gate/verdict.sh
check=tests/gate/check/symbols.sh
for core in cortex-m0plus cortex-m4; do
    $check arm-none-eabi-nm $(find build/$core/firmware -name '*.o')
    verdict "firmware for $core leans on nothing" $?
done
$check nm $(find build/gcc/firmware -name '*.o')
verdict 'firmware on the host leans on nothing' $?

dir=$(mktemp -d)
plant() { # NAME CODE
    printf '%s\n' "$2" >"$dir/x.c"
    arm-none-eabi-gcc -mcpu=cortex-m0plus -mthumb -mfloat-abi=soft -O2 -ffreestanding -c "$dir/x.c" -o "$dir/x.o" || {
        verdict "$1: the planted code compiles" 1
        return
    }
    $check arm-none-eabi-nm "$dir/x.o" >/dev/null
    caught "$1" $?
}
plant 'malloc' '#include <stddef.h>
void *malloc(size_t size); void *f(void); void *f(void) { return malloc(8); }'
plant 'soft float' 'double f(double a, double b); double f(double a, double b) { return a * b; }'
plant 'single precision' 'float f(int a); float f(int a) { return (float)a; }'
plant 'a libc function' 'int printf(const char *, ...); void f(void); void f(void) { printf("x"); }'
printf 'float f(float a); float f(float a) { return a + 1; }\n' >"$dir/y.c"
gcc -mgeneral-regs-only -c "$dir/y.c" -o "$dir/y.o" 2>/dev/null
caught 'a float in firmware/ on the host' $?
$check nm >/dev/null
caught 'a symbol check of nothing' $?
rm -r "$dir"
exit $status
