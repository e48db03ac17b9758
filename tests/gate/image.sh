#!/bin/sh
# The images of the boards: symbols, call graph, budgets. And violations planted to see that the gates catch them.
. tests/gate/verdict.sh
check=tests/gate/check
for part in boards/*/board.mk boards/*/scene/scene.ld; do
    board=${part%/*}
    board=${board#boards/}
    elf=build/boards/$board/boresight.elf
    $check/image-symbols.sh "$elf"
    verdict "$board: no allocator, no floating point, no libc" $?
    $check/callgraph.sh "$elf" | sed 's/^/# /'
    $check/callgraph.sh "$elf" quiet
    verdict "$board: no recursion, every call known, no 64-bit division in handlers, stack within half its reserve" $?
    $check/budget.sh "$elf" | sed 's/^/# /'
    $check/budget.sh "$elf" >/dev/null
    verdict "$board: flash, RAM and stack within their budgets" $?
done

for part in boards/*/scene/scene.ld; do
    board=${part%/scene/scene.ld}
    tests/gate/check/scene-size.sh "build/$board" | sed 's/^/# /'
    tests/gate/check/scene-size.sh "build/$board" >/dev/null
    verdict "${board#boards/}: what its scene takes is told apart" $?
    tests/gate/check/scene-size.sh "build/$board/scene" >/dev/null
    caught "${board#boards/}: images that are not there" $?
done

dir=$(mktemp -d)
# Boards of the tests' own, so that the planted code need not follow the real ones: flash where an STM32 and where an RP2040 has it,
# because objdump prints these addresses differently.
own_board() { # CORE FLASH
    printf '%s\n' "MEMORY { FLASH (rx) : ORIGIN = $2, LENGTH = 1024K  RAM (rw) : ORIGIN = 0x20000000, LENGTH = 128K }" \
        'stack_bytes = 8K; flash_budget_bytes = 96K; ram_budget_bytes = 48K;' 'INCLUDE sections.ld' >"$dir/$1.ld"
}
own_board cortex-m4 0x08000000
own_board cortex-m0plus 0x10000000
# A whole small image around two functions: work, called from reset, and on_interrupt, a handler.
build() { # CORE CODE
    {
        echo '#include "hal/clock.h"'
        echo '#include <stdint.h>'
        echo 'extern char stack_top[]; void reset_handler(void); void work(void); void on_interrupt(void);'
        echo 'volatile uint64_t number = 7; extern void (*const vectors[])(void);'
        printf '%s\n' "$2"
        echo 'void reset_handler(void) { for (;;) work(); }'
        echo '__attribute__((section(".vectors"), used)) void (*const vectors[])(void) ='
        echo '    {(void (*)(void))(void *)stack_top, reset_handler, on_interrupt};'
    } >"$dir/x.c"
    arm-none-eabi-gcc -mcpu="$1" -mthumb -mfloat-abi="${3:-soft}" -O2 -g -w -ffreestanding -fno-optimize-sibling-calls -nostdlib \
        -Ihal/include -Ifirmware -Lboards -T "$dir/$1.ld" -Wl,--gc-sections,--build-id=none "$dir/x.c" -lgcc -o "$dir/x.elf"
}
# The gate must fail, and for the right reason: it says so.
plant() { # GATE NAME WHAT-IT-SAYS CODE [FLOAT-ABI]
    for core in cortex-m4 cortex-m0plus; do
        [ "${5:-soft}" = soft ] || [ $core = cortex-m4 ] || continue
        rm -f "$dir/x.elf"
        build $core "$4" "${5:-soft}" || { verdict "$2: the planted code compiles for $core" 1; continue; }
        "$check/$1.sh" "$dir/x.elf" >"$dir/said"
        result=$?
        grep -q "^[a-z]*: .*$3" "$dir/said" || { cat "$dir/said"; result=9; }
        caught "$2, $core" $result
    done
}
quiet='void on_interrupt(void) {}'
idle='void work(void) { number++; }'
for core in cortex-m4 cortex-m0plus; do
    build $core "$idle $quiet" && $check/image-symbols.sh "$dir/x.elf" && $check/callgraph.sh "$dir/x.elf" quiet >/dev/null &&
        $check/budget.sh "$dir/x.elf" >/dev/null
    verdict "an image without a violation passes, $core" $?
done
plant image-symbols 'malloc' 'allocator: malloc' "void *malloc(unsigned); __attribute__((noinline)) void *malloc(unsigned n) { return (void *)(number + n); }
    void work(void) { number += (uintptr_t)malloc(8); } $quiet"
plant image-symbols 'soft float' 'floating point: __' "volatile double d; void work(void) { d = d * 3; } $quiet"
plant image-symbols 'single precision' 'floating point: __' "volatile float f; void work(void) { f = (float)number; } $quiet"
plant image-symbols 'an FPU instruction' 'floating-point instruction in <work>' "volatile float f; void work(void) { f = f * 3; } $quiet" hard
plant callgraph 'recursion' 'recursion: f' "int f(int); __attribute__((noinline)) int f(int n) { number++; return n ? f(n - 1) + (int)number : 1; }
    void work(void) { f((int)number); } $quiet"
plant callgraph 'recursion of two' 'recursion: ' "int f(int); int g(int); __attribute__((noinline)) int g(int n) { number++; return f(n - 1) + 1; }
    __attribute__((noinline)) int f(int n) { number++; return n ? g(n) + (int)number : 1; } void work(void) { f((int)number); } $quiet"
plant callgraph 'a function pointer' 'work: an indirect call outside' "void (*volatile p)(void); void work(void) { p(); number++; } $quiet"
plant callgraph 'an operation without a table' 'no table \*_clock_ops' "void work(void) { number += hal_clock_now_us((struct hal_clock *)(uintptr_t)number); } $quiet"
plant callgraph 'an address taken elsewhere' 'the address of h is taken in work' "void h(void); __attribute__((noinline)) void h(void) { number++; }
    void (*volatile p)(void); void work(void) { p = h; } $quiet"
plant callgraph 'recursion by way of a table' 'recursion: ' "static uint32_t now(void *ctx); const struct hal_clock_ops my_clock_ops = {now};
    struct hal_clock c = {&my_clock_ops, 0}; static uint32_t now(void *ctx) { return hal_clock_now_us(&c) + (uint32_t)number; }
    void work(void) { number += hal_clock_now_us(&c); } $quiet"
plant callgraph 'a 64-bit division in a handler' 'a 64-bit division from the handler on_interrupt' "$idle void on_interrupt(void) { number = 1000000 / number; }"
plant callgraph 'and one behind a table' 'a 64-bit division from the handler on_interrupt' "$idle
    static uint32_t now(void *ctx) { (void)ctx; return (uint32_t)(1000000 / number); }
    const struct hal_clock_ops my_clock_ops = {now}; struct hal_clock c = {&my_clock_ops, 0};
    void on_interrupt(void) { number += hal_clock_now_us(&c); }"
plant callgraph 'too deep a stack' 'more than half' "void f(volatile char *); __attribute__((noinline)) void f(volatile char *p) { p[0] = 1; }
    void work(void) { volatile char big[5000]; f(big); number += big[7]; } $quiet"
plant callgraph 'a stack too deep with its handlers' 'more than half' "void f(volatile char *); __attribute__((noinline)) void f(volatile char *p) { p[0] = 1; }
    void work(void) { volatile char big[2500]; f(big); } void on_interrupt(void) { volatile char big[1700]; f(big); }"
plant callgraph 'a stack of unknown size' 'work: a stack of unknown size' "void f(volatile char *); __attribute__((noinline)) void f(volatile char *p) { p[0] = 1; }
    void work(void) { volatile char big[number]; f(big); } $quiet"
plant budget 'too much stack for the budget' 'more than half' "void f(volatile char *); __attribute__((noinline)) void f(volatile char *p) { p[0] = 1; }
    void work(void) { volatile char big[5000]; f(big); } $quiet"
build cortex-m4 "volatile char big[60000]; void work(void) { big[number] = 1; } $quiet" 2>/dev/null
caught 'too much RAM, at the link' $?
build cortex-m4 "const volatile char big[100000] = {1}; void work(void) { number += big[number]; } $quiet" 2>/dev/null
caught 'too much flash, at the link' $?
for gate in image-symbols callgraph budget; do
    "$check/$gate.sh" "$dir/none.elf" >/dev/null
    caught "$gate of no image" $?
    arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -c -x c /dev/null -o "$dir/empty.o"
    "$check/$gate.sh" "$dir/empty.o" >/dev/null 2>&1
    caught "$gate of an empty object" $?
done
rm -r "$dir"
exit $status
