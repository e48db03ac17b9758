/// `make bench-cone`. Run twice: under callgrind, where only instructions are counted (`cone
/// count`, each figure a dump of callgrind's), and then natively, with those counts (`cone table
/// COUNTS`), where times and all else is measured and printed.
#include "bench/methods.h"
#include "bench/sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <valgrind/callgrind.h>

#define SIZES 6
/// Larger sets aren't counted under callgrind.
#define COUNTED_SIZES 5

static struct vec3 points[BENCH_MOST_POINTS];
static double counts[BENCH_SETS][SIZES][BENCH_METHODS]; // instructions a point; 0: not counted

static uint32_t size_of(enum bench_set set, int size) {
    const uint32_t squares[SIZES] = {16, 100, 1024, 10000, 99856, 1000000};
    const uint32_t tens[SIZES] = {10, 100, 1000, 10000, 100000, 1000000};
    return set == BENCH_SURFACE ? squares[size] : tens[size];
}

/// Different sets a size: a million points in all at most.
static uint32_t trials_of(enum bench_set set, uint32_t n) {
    const uint32_t most = BENCH_MOST_POINTS / n;
    return set == BENCH_SURFACE ? 1U : most > 300U ? 300U : most;
}

static uint32_t trials_by(const struct bench_method *method, uint32_t trials) {
    return method->most_trials != 0U && method->most_trials < trials ? method->most_trials : trials;
}

static bool is_run(const struct bench_method *method, enum bench_set set, uint32_t n) {
    const bool on_hull = set == BENCH_CIRCLE || set == BENCH_HALF_CIRCLE ||
                         set == BENCH_EXACT_CIRCLE || set == BENCH_SPIRAL; // its last turn
    return (method->most_points == 0U || n <= method->most_points) &&
           !(on_hull && method->most_on_hull != 0U && n > method->most_on_hull) &&
           !(method->needs_feasible && set == BENCH_SPHERE);
}

static void fill(enum bench_set set, uint32_t n, uint32_t trials) {
    for (uint32_t t = 0; t < trials; t++) {
        bench_fill(set, n, t, points + (size_t)t * n);
    }
}

// ---------------------------------------------------------------- instructions

static void count(int set, int size, int m, uint32_t trials) {
    const struct bench_method *const method = &bench_methods[m];
    const uint32_t n = size_of((enum bench_set)set, size);
    char name[64];
    CALLGRIND_ZERO_STATS;
    for (uint32_t t = 0; t < trials; t++) {
        const struct vec3 *const of_trial = points + (size_t)t * n;
        struct bench_run run = {0};
        if (method->prepare != NULL) {
            method->prepare(of_trial, n);
        }
        CALLGRIND_TOGGLE_COLLECT;
        method->run(of_trial, n, &run);
        CALLGRIND_TOGGLE_COLLECT;
    }
    snprintf(name, sizeof name, "count %d %d %d %u", set, size, m, trials * n);
    CALLGRIND_DUMP_STATS_AT(name);
}

static void count_all(void) {
    for (int set = 0; set < BENCH_SETS; set++) {
        for (int size = 0; size < COUNTED_SIZES; size++) {
            const uint32_t n = size_of((enum bench_set)set, size);
            uint32_t trials = trials_of((enum bench_set)set, n);
            trials = n > 10000U ? 1U : n > 1000U ? 3U : trials > 30U ? 30U : trials;
            fill((enum bench_set)set, n, trials);
            for (int m = 0; m < BENCH_METHODS; m++) {
                if (is_run(&bench_methods[m], (enum bench_set)set, n)) {
                    count(set, size, m, trials_by(&bench_methods[m], trials));
                }
            }
        }
    }
}

/// Lines "set size method points instructions".
static bool read_counts(const char *path) {
    FILE *const file = fopen(path, "r");
    int set, size, m;
    double of_points, instructions;
    if (file == NULL) {
        return false;
    }
    while (fscanf(file, "%d %d %d %lf %lf", &set, &size, &m, &of_points, &instructions) == 5) {
        counts[set][size][m] = instructions / of_points;
    }
    fclose(file);
    return true;
}

// ---------------------------------------------------------------- one set and size

struct figures {
    double reads, ns, iterations, scratch; // means; reads and nanoseconds a point
    double h, h2, h_log_h;                 // moments of the hull's size
    double two;                            // share with a support of two
    double faces;                          // tested a point
};

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/// Runs a method over all trials; of several rounds the fastest counts.
static struct figures measure(const struct bench_method *method, uint32_t n, uint32_t trials) {
    struct figures sum = {0};
    const int rounds = n <= 10000U ? 5 : 2;
    for (uint32_t t = 0; t < trials; t++) {
        const struct vec3 *const of_trial = points + (size_t)t * n;
        struct bench_run run = {0};
        double fastest = INFINITY;
        for (int round = 0; round < rounds; round++) {
            run = (struct bench_run){0};
            if (method->prepare != NULL && round == 0) {
                method->prepare(of_trial, n);
            }
            const double start = now_ns();
            method->run(of_trial, n, &run);
            const double ns = now_ns() - start;
            fastest = ns < fastest ? ns : fastest;
        }
        const double h = run.hull_size;
        sum.reads += (double)run.point_reads / n / trials;
        sum.ns += fastest / n / trials;
        sum.iterations += (double)run.iterations / trials;
        sum.faces += (double)run.face_tests / n / trials;
        sum.scratch += (double)run.scratch_bytes / trials;
        sum.h += h / trials;
        sum.h2 += h * h / trials;
        sum.h_log_h += h > 0.0 ? h * log(h) / trials : 0.0;
        sum.two += (run.support_count == 2U ? 1.0 : 0.0) / trials;
    }
    return sum;
}

// ---------------------------------------------------------------- aiming without us

static double largest_angle(const struct vec3 *set, uint32_t n, const double axis[3]) {
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double least = 1.0;
    for (uint32_t i = 0; i < n; i++) {
        const double dot =
            (axis[0] * set[i].x + axis[1] * set[i].y + axis[2] * set[i].z) / length * 0x1p-30;
        least = dot < least ? dot : least;
    }
    return acos(least < -1.0 ? -1.0 : least) * (180.0 / M_PI);
}

/// How much wider than the narrowest cone, in percent of its half-angle: mean and worst.
struct loss {
    double centroid, centroid_worst, box, box_worst;
};

static struct loss losses(uint32_t n, uint32_t trials) {
    struct loss loss = {0};
    for (uint32_t t = 0; t < trials; t++) {
        const struct vec3 *const set = points + (size_t)t * n;
        double centroid[3] = {0}, low[3], high[3], box[3], best[3];
        for (uint32_t i = 0; i < n; i++) {
            const double p[3] = {set[i].x, set[i].y, set[i].z};
            for (int k = 0; k < 3; k++) {
                centroid[k] += p[k] * 0x1p-30;
                low[k] = i == 0 || p[k] < low[k] ? p[k] : low[k];
                high[k] = i == 0 || p[k] > high[k] ? p[k] : high[k];
            }
        }
        for (int k = 0; k < 3; k++) {
            box[k] = (low[k] + high[k]) * 0x1p-31;
        }
        struct bench_run run = {0};
        bench_methods[BENCH_PIVOT].run(set, n, &run);
        best[0] = run.axis_q30.x;
        best[1] = run.axis_q30.y;
        best[2] = run.axis_q30.z;
        const double optimum = largest_angle(set, n, best);
        const double by_centroid = (largest_angle(set, n, centroid) / optimum - 1.0) * 100.0;
        const double by_box = (largest_angle(set, n, box) / optimum - 1.0) * 100.0;
        loss.centroid += by_centroid / trials;
        loss.centroid_worst = fmax(loss.centroid_worst, by_centroid);
        loss.box += by_box / trials;
        loss.box_worst = fmax(loss.box_worst, by_box);
    }
    return loss;
}

// ---------------------------------------------------------------- the table

static struct figures figures[BENCH_SETS][SIZES][BENCH_METHODS];
static struct loss aims[BENCH_SETS][SIZES];

static void measure_all(void) {
    for (int set = 0; set < BENCH_SETS; set++) {
        for (int size = 0; size < SIZES; size++) {
            const uint32_t n = size_of((enum bench_set)set, size);
            const uint32_t trials = trials_of((enum bench_set)set, n);
            fill((enum bench_set)set, n, trials);
            for (int m = 0; m < BENCH_METHODS; m++) {
                if (is_run(&bench_methods[m], (enum bench_set)set, n)) {
                    figures[set][size][m] =
                        measure(&bench_methods[m], n, trials_by(&bench_methods[m], trials));
                }
            }
            if (set != BENCH_SPHERE) {
                aims[set][size] = losses(n, trials);
            }
        }
    }
}

static void print_figure(double value, const char *format, int width) {
    char text[32];
    snprintf(text, sizeof text, format, value);
    printf(" %*s", width, value > 0.0 ? text : "-");
}

static void print_cones(void) {
    printf("The narrowest cone. Reads, instructions (x86-64, -O2) and nanoseconds are a point; "
           "'/bare' is beside one "
           "pass of dot\nproducts over the same points; aims are the mean and worst widening "
           "beyond the narrowest "
           "cone, percent.\n\n"
           "%-17s %8s |%7s%7s |%8s%7s%7s%8s%7s |%8s%7s%7s%8s%8s |%9s %5s %6s |%15s%15s\n",
           "set", "n", "reads", "warm", "instr.", "bare", "/bare", "CGAL", "/CGAL", "ns", "bare",
           "/bare", "CGAL", "/CGAL", "scratch", "two", "EH it.", "centroid aim", "box-centre aim");
    for (int set = 0; set < BENCH_SETS; set++) {
        for (int size = 0; size < SIZES; size++) {
            const struct figures *const f = figures[set][size];
            const double *const c = counts[set][size];
            const struct loss *const aim = &aims[set][size];
            printf("%-17s %8u |", bench_set_names[set], size_of((enum bench_set)set, size));
            print_figure(f[BENCH_PIVOT].reads, "%.3f", 6);
            print_figure(f[BENCH_PIVOT_WARM].reads, "%.3f", 6);
            printf(" |");
            print_figure(c[BENCH_PIVOT], "%.1f", 7);
            print_figure(c[BENCH_BARE], "%.1f", 6);
            print_figure(c[BENCH_PIVOT] / c[BENCH_BARE], "%.2f", 6);
            print_figure(c[BENCH_CGAL_SPHERE], "%.0f", 7);
            print_figure(c[BENCH_CGAL_SPHERE] / c[BENCH_PIVOT], "%.1f", 6);
            printf(" |");
            print_figure(f[BENCH_PIVOT].ns, "%.2f", 7);
            print_figure(f[BENCH_BARE].ns, "%.2f", 6);
            print_figure(f[BENCH_PIVOT].ns / f[BENCH_BARE].ns, "%.2f", 6);
            print_figure(f[BENCH_CGAL_SPHERE].ns, "%.1f", 7);
            print_figure(f[BENCH_CGAL_SPHERE].ns / f[BENCH_PIVOT].ns, "%.1f", 7);
            printf(" |");
            print_figure(f[BENCH_PIVOT].scratch, "%.0f", 8);
            print_figure(100.0 * f[BENCH_PIVOT].two, "%.0f%%", 5);
            print_figure(f[BENCH_GROWING].iterations, "%.1f", 6);
            printf(" |");
            print_figure(aim->centroid, "%.1f", 7);
            print_figure(aim->centroid_worst, "%.1f", 6);
            print_figure(aim->box, "%.1f", 7);
            print_figure(aim->box_worst, "%.1f", 6);
            printf("\n");
        }
        printf("\n");
    }
}

/// Exponent of n in the instructions of a method, by least squares over the three largest counted
/// sizes; NAN if there are fewer.
static double growth(int set, int m) {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    int sizes = 0;
    for (int size = COUNTED_SIZES - 1; size >= 0 && sizes < 3; size--) {
        if (counts[set][size][m] > 0.0) {
            const double n = size_of((enum bench_set)set, size);
            const double x = log(n), y = log(counts[set][size][m] * n);
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
            sizes++;
        }
    }
    return sizes < 3 ? NAN : (3.0 * sxy - sx * sy) / (3.0 * sxx - sx * sx);
}

static void print_methods(void) {
    printf("All methods: instructions a point; growth is the exponent of n in all instructions, "
           "over the three "
           "largest sizes;\nrounds, of loops that read all that is left, and faces tested a point, "
           "are at the "
           "largest size. '-': not run, or none.\n\n"
           "%-17s %-15s |%9s%9s%9s%9s%9s |%8s%9s%7s\n",
           "set", "method", "10", "100", "1000", "10000", "100000", "growth", "rounds", "faces");
    for (int set = 0; set < BENCH_SETS; set++) {
        for (int m = 0; m < BENCH_METHODS; m++) {
            if (!is_run(&bench_methods[m], (enum bench_set)set, 1)) {
                continue;
            }
            printf("%-17s %-15s |", bench_set_names[set], bench_methods[m].name);
            double rounds = 0.0, faces = 0.0;
            for (int size = 0; size < COUNTED_SIZES; size++) {
                print_figure(counts[set][size][m], counts[set][size][m] < 100.0 ? "%.1f" : "%.0f",
                             8);
                rounds = fmax(rounds, figures[set][size][m].iterations);
                if (figures[set][size][m].faces > 0.0) {
                    faces = figures[set][size][m].faces;
                }
            }
            const double exponent = growth(set, m);
            printf(" |");
            print_figure(isnan(exponent) ? 0.0 : exponent, "%.2f", 7);
            print_figure(rounds, "%.1f", 8);
            print_figure(faces, "%.1f", 6);
            printf("\n");
        }
        printf("\n");
    }
}

/// Exponent of n in a moment of the hull's size, over 1,000 to 100,000 points.
static double moment_growth(int set, double (*moment)(const struct figures *)) {
    const double low = moment(&figures[set][2][BENCH_HULL]);
    const double high = moment(&figures[set][4][BENCH_HULL]);
    return log(high / low) /
           log((double)size_of((enum bench_set)set, 4) / size_of((enum bench_set)set, 2));
}

static double mean_of(const struct figures *f) {
    return f->h;
}
static double square_of(const struct figures *f) {
    return f->h2;
}
static double h_log_h_of(const struct figures *f) {
    return f->h_log_h;
}
static double variance_of(const struct figures *f) {
    return f->h2 - f->h * f->h;
}

static void print_hulls(void) {
    printf("The hull: moments of its size h, which decide what algorithms B and C cost (Anderson "
           "1985, equations 12 "
           "to 17).\n(12) E[h] = O(n^p), p < 1; (13) E[h log h] = O(n^q), q < 1; (14) p = 1/3 for "
           "a uniform disc; "
           "(15) E[h] = O(log^1/2 n)\nfor a planar normal; (16) E[h^2] = Var(h) + E[h]^2; (17) p "
           "<= 1/2. Growth: "
           "exponents of n from 1,000 to 100,000.\n\n"
           "%-17s %8s %6s |%9s%10s%12s%12s%9s |%9s%9s%9s%9s%7s\n",
           "set", "n", "sets", "E[h]", "Var(h)", "E[h^2]", "E[h log h]", "Var/E[h]", "ns/point",
           "buckets", "sorted", "CGAL", "/CGAL");
    for (int set = 0; set < BENCH_SPHERE; set++) {
        for (int size = 0; size < SIZES; size++) {
            const uint32_t n = size_of((enum bench_set)set, size);
            const struct figures *const f = &figures[set][size][BENCH_HULL];
            printf("%-17s %8u %6u |", bench_set_names[set], n, trials_of((enum bench_set)set, n));
            print_figure(f->h, "%.2f", 8);
            print_figure(variance_of(f), "%.3f", 9);
            print_figure(f->h2, "%.0f", 11);
            print_figure(f->h_log_h, "%.1f", 11);
            print_figure(variance_of(f) / f->h, "%.2f", 8);
            printf(" |");
            print_figure(f->ns, "%.1f", 8);
            print_figure(figures[set][size][BENCH_HULL_BUCKETS].ns, "%.1f", 8);
            print_figure(figures[set][size][BENCH_HULL_SORTED].ns, "%.1f", 8);
            print_figure(figures[set][size][BENCH_CGAL_HULL].ns, "%.1f", 8);
            print_figure(f->ns / figures[set][size][BENCH_CGAL_HULL].ns, "%.2f", 6);
            printf("\n");
        }
        printf("%-33s |", "  growth");
        print_figure(moment_growth(set, mean_of), "%.3f", 8);
        print_figure(moment_growth(set, variance_of), "%.3f", 9);
        print_figure(moment_growth(set, square_of), "%.3f", 11);
        print_figure(moment_growth(set, h_log_h_of), "%.3f", 11);
        printf("\n\n");
    }
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "count") == 0) {
        count_all();
        return 0;
    }
    if (argc != 3 || strcmp(argv[1], "table") != 0 || !read_counts(argv[2])) {
        fprintf(stderr, "usage: %s count | table COUNTS\n", argv[0]);
        return 2;
    }
    measure_all();
    print_cones();
    print_methods();
    print_hulls();
    return 0;
}
