#include "cortexm/cortexm.h"
#include "cortexm/cortexm_start.h"
int main(void) {
    for (;;)
        cortexm_wait_for_interrupt();
}
