/// Commands of the administrator, in tests inside the virtual machine.
#ifndef VM_SUPPORT_SHELL_H
#define VM_SUPPORT_SHELL_H

/// Runs a command line; a check fails if it does.
void shell(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
