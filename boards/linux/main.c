#include <stdio.h>

extern const char build_id[];

int main(void) {
    printf("boresight %s\n", build_id);
    return 0;
}
