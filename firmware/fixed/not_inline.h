/// For functions that the compiler should not copy into their callers.
#ifndef FIXED_NOT_INLINE_H
#define FIXED_NOT_INLINE_H

/// One that is rarely reached, whose registers would be saved on the common way, too; or a loop
/// that needs them all.
#define NOT_INLINE __attribute__((noinline))

/// A short one with long products, `static inline` where a processor has them. A Cortex-M0+ makes
/// them of short ones: there a copy is larger than a call, and flash is what runs out.
#ifdef __ARM_ARCH_6M__
#define INLINE_BUT_ON_M0PLUS __attribute__((noinline, unused)) static
#else
#define INLINE_BUT_ON_M0PLUS static inline
#endif

#endif
