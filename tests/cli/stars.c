/// `boresight aim` on the sky: every constellation figure against a search over all pairs and
/// triples in long double, all stars, and the northern half.
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STARS_MOST = 6000, FIGURES_MOST = 100, NAME_BYTES = 8 };

struct vector {
    long double x, y, z;
};

struct star {
    char ra[24], dec[24]; ///< as the catalogue writes them
    char figures[64];
    struct vector at;
};

static struct star stars[STARS_MOST];
static int star_count;

static const long double deg_per_rad = 57.295779513082320876798L;

static long double dot(struct vector a, struct vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct vector cross(struct vector a, struct vector b) {
    return (struct vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static struct vector minus(struct vector a, struct vector b) {
    return (struct vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static long double angle(struct vector a, struct vector b) {
    const struct vector c = cross(a, b);
    return atan2l(sqrtl(dot(c, c)), dot(a, b));
}

static bool load_catalogue(void) {
    FILE *const file = fopen("tests/data/stars.csv", "r");
    char line[256];
    if (file == NULL || fgets(line, sizeof line, file) == NULL) {
        return false;
    }
    while (fgets(line, sizeof line, file) != NULL && star_count < STARS_MOST) {
        // hip,constellation,figure_of,magnitude,ra_deg,dec_deg
        struct star *const star = &stars[star_count++];
        char *at = line, *columns[6];
        for (int i = 0; i < 6; i++) {
            columns[i] = strsep(&at, ",\r\n");
            if (columns[i] == NULL) {
                return false;
            }
        }
        snprintf(star->figures, sizeof star->figures, " %s ", columns[2]);
        snprintf(star->ra, sizeof star->ra, "%s", columns[4]);
        snprintf(star->dec, sizeof star->dec, "%s", columns[5]);
        const long double a = strtold(star->ra, NULL) / deg_per_rad;
        const long double d = strtold(star->dec, NULL) / deg_per_rad;
        star->at = (struct vector){cosl(d) * cosl(a), cosl(d) * sinl(a), sinl(d)};
    }
    fclose(file);
    return true;
}

// ---------------------------------------------------------------- the program's answer

struct answer {
    bool feasible;
    long double half_angle_deg;
    struct vector ahead;
    int indices[4], index_count; ///< support or witness
    int status;
};

/// What follows "NAME": in the text.
static const char *member(const char *text, const char *name) {
    char key[40];
    snprintf(key, sizeof key, "\"%s\": ", name);
    const char *const at = strstr(text, key);
    return at == NULL ? NULL : at + strlen(key);
}

static void read_indices(const char *at, struct answer *out) {
    out->index_count = 0;
    while (at != NULL && *at != ']' && out->index_count < 4) {
        char *end;
        out->indices[out->index_count++] = (int)strtol(at + 1, &end, 10);
        at = end;
    }
}

/// Runs the program on the chosen stars.
static struct answer aim(const struct star *const *chosen, int count) {
    struct answer answer = {.status = -1};
    char path[64], command[128], text[4096] = "";
    snprintf(path, sizeof path, "build/stars-%ld.txt", (long)getpid());
    FILE *const file = fopen(path, "w");
    if (!CHECK(file != NULL)) {
        return answer;
    }
    for (int i = 0; i < count; i++) {
        fprintf(file, "%s %s\n", chosen[i]->ra, chosen[i]->dec);
    }
    fclose(file);
    snprintf(command, sizeof command, "build/boresight aim --json --input radec %s", path);
    FILE *const pipe = popen(command, "r");
    if (CHECK(pipe != NULL)) {
        CHECK(fgets(text, sizeof text, pipe) != NULL);
        answer.status = pclose(pipe) >> 8;
    }
    remove(path);
    const char *const feasible = member(text, "feasible");
    answer.feasible = feasible != NULL && strncmp(feasible, "true", 4) == 0;
    if (answer.feasible && CHECK(member(text, "half_angle_deg") != NULL)) {
        answer.half_angle_deg = strtold(member(text, "half_angle_deg"), NULL);
        CHECK(sscanf(member(text, "ahead_q30"), "[%Lf, %Lf, %Lf]", &answer.ahead.x, &answer.ahead.y,
                     &answer.ahead.z) == 3);
    }
    read_indices(member(text, answer.feasible ? "support" : "witness"), &answer);
    return answer;
}

// ---------------------------------------------------------------- the search

static long double largest_angle(struct vector axis, const struct star *const *chosen, int count) {
    long double largest = 0;
    for (int i = 0; i < count; i++) {
        largest = fmaxl(largest, angle(axis, chosen[i]->at));
    }
    return largest;
}

/// The smaller of best and the cone around axis.
static long double better(long double best, struct vector axis, const struct star *const *chosen,
                          int count) {
    if (dot(axis, axis) < 1e-30L) {
        return best;
    }
    return fminl(best, largest_angle(axis, chosen, count));
}

/// The half-angle of the narrowest cone: its axis is one star, or in the middle of two, or equally
/// far from three.
static long double search(const struct star *const *chosen, int count) {
    long double best = 4;
    for (int i = 0; i < count; i++) {
        const struct vector a = chosen[i]->at;
        best = better(best, a, chosen, count);
        for (int j = 0; j < i; j++) {
            const struct vector b = chosen[j]->at;
            const struct vector middle = {a.x + b.x, a.y + b.y, a.z + b.z};
            best = better(best, middle, chosen, count);
            for (int k = 0; k < j; k++) {
                const struct vector c = chosen[k]->at;
                const struct vector axis = cross(minus(a, b), minus(a, c));
                const struct vector other = {-axis.x, -axis.y, -axis.z};
                best = better(best, axis, chosen, count);
                best = better(best, other, chosen, count);
            }
        }
    }
    return best;
}

/// The answer is feasible, its cone holds the stars, and is within 5 nrad of the narrowest one.
static bool check_cone(const struct answer *answer, long double narrowest,
                       const struct star *const *chosen, int count, long double *worst) {
    const long double printed = answer->half_angle_deg / deg_per_rad;
    const long double seen = largest_angle(answer->ahead, chosen, count);
    *worst = fmaxl(*worst, printed - narrowest);
    return CHECK(answer->feasible) && CHECK_EQ(answer->status, 0) && CHECK(printed >= seen) &&
           CHECK(printed - seen < 5e-14L) && CHECK(printed - narrowest < 5e-9L);
}

// ---------------------------------------------------------------- tests

static char figures[FIGURES_MOST][NAME_BYTES];
static int figure_count;

static void collect_figures(void) {
    for (int i = 0; i < star_count; i++) {
        char names[64], *at = names;
        strcpy(names, stars[i].figures);
        for (char *name = strsep(&at, " "); name != NULL; name = strsep(&at, " ")) {
            bool known = name[0] == '\0';
            for (int j = 0; j < figure_count; j++) {
                known = known || strcmp(figures[j], name) == 0;
            }
            if (!known && figure_count < FIGURES_MOST) {
                snprintf(figures[figure_count++], NAME_BYTES, "%.7s", name);
            }
        }
    }
}

static int choose_figure(const char *name, const struct star **chosen) {
    char word[NAME_BYTES + 2];
    int count = 0;
    snprintf(word, sizeof word, " %s ", name);
    for (int i = 0; i < star_count; i++) {
        if (strstr(stars[i].figures, word) != NULL) {
            chosen[count++] = &stars[i];
        }
    }
    return count;
}

static const struct star *chosen[STARS_MOST];

static void every_constellation_figure(void) {
    collect_figures();
    long double worst = 0;
    int largest = 0;
    for (int i = 0; i < figure_count && check_clean(); i++) {
        const int count = choose_figure(figures[i], chosen);
        const struct answer answer = aim(chosen, count);
        if (!check_cone(&answer, search(chosen, count), chosen, count, &worst)) {
            printf("  %s\n", figures[i]);
        }
        largest = count > largest ? count : largest;
    }
    check_note("figures", figure_count);
    check_note("stars in the largest", largest);
    check_note("widest excess over the search, 1e-12 rad", (int64_t)(worst * 1e12L));
    CHECK(figure_count >= 80 && largest > 20);
}

static long double det(struct vector a, struct vector b, struct vector c) {
    return dot(a, cross(b, c));
}

static void no_direction_sees_all_stars(void) {
    for (int i = 0; i < star_count; i++) {
        chosen[i] = &stars[i];
    }
    const struct answer answer = aim(chosen, star_count);
    CHECK(!answer.feasible);
    CHECK_EQ(answer.status, 3);
    if (!CHECK_EQ(answer.index_count, 4)) {
        return;
    }
    // The zero vector is strictly inside the tetrahedron: its four weights, which are determinants,
    // have one sign. Long double errs by 1e-18, so the signs are sure.
    struct vector v[4];
    for (int i = 0; i < 4; i++) {
        if (!CHECK(answer.indices[i] >= 0 && answer.indices[i] < star_count)) {
            return;
        }
        v[i] = stars[answer.indices[i]].at;
    }
    const long double weights[4] = {det(v[1], v[2], v[3]), -det(v[0], v[2], v[3]),
                                    det(v[0], v[1], v[3]), -det(v[0], v[1], v[2])};
    for (int i = 0; i < 4; i++) {
        CHECK(fabsl(weights[i]) > 1e-15L && (weights[i] > 0) == (weights[0] > 0));
    }
}

static void the_northern_half(void) {
    int count = 0;
    for (int i = 0; i < star_count; i++) {
        if (strtold(stars[i].dec, NULL) > 0) {
            chosen[count++] = &stars[i];
        }
    }
    const struct answer answer = aim(chosen, count);
    // The narrowest cone of the support alone is a lower bound for that of all.
    const struct star *support[4];
    for (int i = 0; i < answer.index_count; i++) {
        if (!CHECK(answer.indices[i] >= 0 && answer.indices[i] < count)) {
            return;
        }
        support[i] = chosen[answer.indices[i]];
    }
    long double worst = 0;
    check_cone(&answer, search(support, answer.index_count), chosen, count, &worst);
    check_note("northern stars", count);
    check_note("half-angle, millionths of a degree", (int64_t)(answer.half_angle_deg * 1000000));
    check_note("excess over the bound, 1e-12 rad", (int64_t)(worst * 1e12L));
    CHECK(answer.half_angle_deg > 89 && answer.half_angle_deg < 90);
}

static void the_catalogue(void) {
    CHECK(load_catalogue());
    CHECK_EQ(star_count, 5044);
}

int main(void) {
    TEST(the_catalogue);
    TEST(every_constellation_figure);
    TEST(no_direction_sees_all_stars);
    TEST(the_northern_half);
    return check_finish();
}
