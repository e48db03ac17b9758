/// To be nobody for a while: without root's rights, in no group but its own.
#ifndef VM_SUPPORT_NOBODY_H
#define VM_SUPPORT_NOBODY_H

void nobody_begin(void);
/// root again.
void nobody_end(void);

#endif
