#include "bench/levine/levine.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

void levine_table(const char *name) {
    printf("@table %s\n", name);
}

void levine_value(const char *name, double value) {
    printf("@value %s %.12g\n", name, value);
}

void levine_number(double value) {
    const double size = fabs(value);
    if (!isfinite(value)) {
        printf(" -");
    } else if (size >= 1e7) {
        printf(" %.2e", value);
    } else {
        printf(" %.*f", size >= 99.95 || value == floor(value) ? 0 : (size >= 9.995 ? 1 : 2),
               value);
    }
}

void levine_cell(double value) {
    levine_number(value);
    printf(" |");
}

/// Of 1, 2, 5 times a power of ten the smallest that is enough.
static double round_step(double least) {
    const double power = pow(10, floor(log10(least)));
    return least <= power       ? power
           : least <= 2 * power ? 2 * power
           : least <= 5 * power ? 5 * power
                                : 10 * power;
}

void levine_bins(const double *values, uint32_t count) {
    double low = values[0], high = values[0];
    for (uint32_t i = 1; i < count; i++) {
        low = fmin(low, values[i]);
        high = fmax(high, values[i]);
    }
    const double width = high > low ? round_step((high - low) / 19) : 1;
    const double first = floor(low / width) * width;
    uint32_t bins[21] = {0}, last = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t bin = (uint32_t)((values[i] - first) / width);
        bins[bin]++;
        last = bin > last ? bin : last;
    }
    printf(" %g | %g |", first, width);
    for (uint32_t bin = 0; bin <= last; bin++) {
        printf(" %u", bins[bin]);
    }
    printf(" |");
}

double levine_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(bool few);
    } parts[] = {{"hull", levine_hull},     {"sphere", levine_sphere},
                 {"trials", levine_trials}, {"dimensions", levine_dimensions},
                 {"hidden", levine_hidden}, {"sweep", levine_sweep},
                 {"large", levine_large},   {"retrieval", levine_retrieval}};
    const bool few = argc > 2 && strcmp(argv[2], "few") == 0;
    for (size_t i = 0; argc > 1 && i < sizeof parts / sizeof *parts; i++) {
        if (strcmp(argv[1], parts[i].name) == 0) {
            parts[i].run(few);
            return check_clean() ? 0 : 1;
        }
    }
    fprintf(stderr, "usage: levine PART [few]\n");
    return 2;
}
