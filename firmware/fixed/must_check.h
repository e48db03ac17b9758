/// A function whose result tells an error: the compiler warns (and so fails the build) when it is
/// dropped.
#ifndef FIXED_MUST_CHECK_H
#define FIXED_MUST_CHECK_H

#define MUST_CHECK __attribute__((warn_unused_result))

#endif
