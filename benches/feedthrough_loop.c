/* The plain C loop that steps a ring of three units that hand on what they get, with the texts or without: our own of
   `feedthrough.c` or the Feedthrough of the FMI project's reference units. Functions and references come from outside, so
   that the loop calls as a master has to. Used by `src/feedthrough.rs`. */
#include <stdlib.h>
#include <string.h>

enum { TEXT = 128 };

typedef struct {
    int (*set_real)(void *, const unsigned *, size_t, const double *);
    int (*get_real)(void *, const unsigned *, size_t, double *);
    int (*set_integer)(void *, const unsigned *, size_t, const int *);
    int (*set_boolean)(void *, const unsigned *, size_t, const int *);
    int (*get_integer)(void *, const unsigned *, size_t, int *);
    int (*get_boolean)(void *, const unsigned *, size_t, int *);
    int (*step)(void *, double, double, int);
    int (*set_string)(void *, const unsigned *, size_t, const char *const *);
    int (*get_string)(void *, const unsigned *, size_t, const char **);
    void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int);
    int (*setup)(void *, int, double, double, int, double);
    int (*enter)(void *);
    int (*leave)(void *);
    void (*free)(void *);
} Calls;

typedef struct {
    unsigned real_in[2], real_out[2], integer_in[1], integer_out[1], boolean_in[1], boolean_out[1], text_in[1],
        text_out[1];
} References;

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void quiet(void *e, const char *n, int s, const char *c, const char *m, ...) {
    (void)e; (void)n; (void)s; (void)c; (void)m;
}
static const Callbacks CALLBACKS = {quiet, calloc, free, 0, 0};

/* The loop's own copy of a text, as the standard asks for: the unit may free its own at the next call. */
static inline void keep(char own[TEXT], const char *text) {
    if (strcmp(own, text)) strcpy(own, text);
}

/* Answers the first real of the third unit, and its text in `last`; -1e9 if anything failed. */
__attribute__((visibility("default")))
double ring_loop(const Calls *f, const References *at, const char *guid, double rate, long steps, int texts, char last[TEXT]) {
    void *units[3];
    double reals[3][2], size = 1 / rate;
    int integers[3][1], booleans[3][1];
    char own[3][TEXT] = {{0}};
    const char *text[1];
    for (int i = 0; i < 3; i++) {
        units[i] = f->instantiate("unit", 1, guid, "", &CALLBACKS, 0, 0);
        if (!units[i]) return -1e9;
        f->setup(units[i], 0, 0, 0, 1, (double)steps / rate);
        f->enter(units[i]);
        f->get_real(units[i], at->real_out, 2, reals[i]);
        f->get_integer(units[i], at->integer_out, 1, integers[i]);
        f->get_boolean(units[i], at->boolean_out, 1, booleans[i]);
        f->get_string(units[i], at->text_out, 1, text);
        keep(own[i], text[0]);
        f->leave(units[i]);
    }
    for (long k = 0; k < steps; k++) {
        for (int i = 0; i < 3; i++) {
            int from = (i + 2) % 3;
            double u[2] = {reals[from][0], reals[from][1]};
            int n[1] = {integers[from][0]}, b[1] = {booleans[from][0]};
            const char *given[1] = {own[from]};
            if (f->set_real(units[i], at->real_in, 2, u) > 1) return -1e9;
            if (f->set_integer(units[i], at->integer_in, 1, n) > 1) return -1e9;
            if (f->set_boolean(units[i], at->boolean_in, 1, b) > 1) return -1e9;
            if (texts && f->set_string(units[i], at->text_in, 1, given) > 1) return -1e9;
            if (f->step(units[i], (double)k / rate, size, 1) > 1) return -1e9;
            if (f->get_real(units[i], at->real_out, 2, reals[i]) > 1) return -1e9;
            if (f->get_integer(units[i], at->integer_out, 1, integers[i]) > 1) return -1e9;
            if (f->get_boolean(units[i], at->boolean_out, 1, booleans[i]) > 1) return -1e9;
            if (!texts) continue;
            if (f->get_string(units[i], at->text_out, 1, text) > 1) return -1e9;
            keep(own[i], text[0]);
        }
    }
    strcpy(last, own[2]);
    double first = reals[2][0];
    for (int i = 0; i < 3; i++) f->free(units[i]);
    return first;
}
