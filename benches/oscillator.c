/* An FMI 2.0 unit that costs what a small real one does, and the plain C loop that steps a ring of three of them. A
   forced van der Pol oscillator, x'' = mu (1 - x^2) x' - x + u/10, mu between 0.95 and 1.05, by four steps of Runge and
   Kutta a communication step; two reals, an integer and a Boolean go in and out; every call checks its instance, its
   mode and its references. Used by `src/real.rs`. */
#include <stdlib.h>

enum { INSTANTIATED, INITIALISING, STEPPING };
typedef struct {
    int mode;
    double force, damping, x, v; /* references 0 to 3 */
    int offset, crossings;       /* references 0 and 1 */
    int reversed, positive;      /* references 0 and 1 */
    int counted;
} Unit;
#define API __attribute__((visibility("default"), noinline))
#define OK 0
#define ERROR 3

static void start(Unit *u) { *u = (Unit){.mode = INSTANTIATED, .damping = 1, .x = 2, .positive = 1}; }

API void *fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *c, int v, int l) {
    (void)n; (void)t; (void)g; (void)r; (void)c; (void)v; (void)l;
    Unit *u = malloc(sizeof(Unit));
    if (u) start(u);
    return u;
}
API void fmi2FreeInstance(void *c) { free(c); }
API int fmi2SetupExperiment(void *c, int a, double b, double d, int e, double f) {
    (void)a; (void)b; (void)d; (void)e; (void)f;
    return c ? OK : ERROR;
}
API int fmi2EnterInitializationMode(void *c) {
    Unit *u = c;
    if (!u || u->mode != INSTANTIATED) return ERROR;
    u->mode = INITIALISING;
    return OK;
}
API int fmi2ExitInitializationMode(void *c) {
    Unit *u = c;
    if (!u || u->mode != INITIALISING) return ERROR;
    u->mode = STEPPING;
    return OK;
}
API int fmi2Terminate(void *c) { return c ? OK : ERROR; }
API int fmi2Reset(void *c) {
    if (!c) return ERROR;
    start(c);
    return OK;
}
API int fmi2GetReal(void *c, const unsigned *refs, size_t n, double *values) {
    Unit *u = c;
    if (!u || u->mode == INSTANTIATED || (n && !(refs && values))) return ERROR;
    for (size_t i = 0; i < n; i++) {
        switch (refs[i]) {
        case 0: values[i] = u->force; break;
        case 1: values[i] = u->damping; break;
        case 2: values[i] = u->x; break;
        case 3: values[i] = u->v; break;
        default: return ERROR;
        }
    }
    return OK;
}
API int fmi2SetReal(void *c, const unsigned *refs, size_t n, const double *values) {
    Unit *u = c;
    if (!u || (n && !(refs && values))) return ERROR;
    for (size_t i = 0; i < n; i++) {
        switch (refs[i]) {
        case 0: u->force = values[i]; break;
        case 1: u->damping = values[i]; break;
        default: return ERROR;
        }
    }
    return OK;
}
#define WHOLE(Get, Set, into, from)                                                     \
    API int Get(void *c, const unsigned *refs, size_t n, int *values) {                 \
        Unit *u = c;                                                                    \
        if (!u || u->mode == INSTANTIATED || (n && !(refs && values))) return ERROR;    \
        for (size_t i = 0; i < n; i++) {                                                \
            switch (refs[i]) {                                                          \
            case 0: values[i] = u->into; break;                                         \
            case 1: values[i] = u->from; break;                                         \
            default: return ERROR;                                                      \
            }                                                                           \
        }                                                                               \
        return OK;                                                                      \
    }                                                                                   \
    API int Set(void *c, const unsigned *refs, size_t n, const int *values) {           \
        Unit *u = c;                                                                    \
        if (!u || (n && !(refs && values))) return ERROR;                               \
        for (size_t i = 0; i < n; i++) {                                                \
            if (refs[i] != 0) return ERROR;                                             \
            u->into = values[i];                                                        \
        }                                                                               \
        return OK;                                                                      \
    }
WHOLE(fmi2GetInteger, fmi2SetInteger, offset, crossings)
WHOLE(fmi2GetBoolean, fmi2SetBoolean, reversed, positive)

static double slope(double x, double v, double force, double damping) {
    return damping * (1 - x * x) * v - x + force;
}
API int fmi2DoStep(void *c, double from, double size, int no_return) {
    Unit *u = c;
    (void)from; (void)no_return;
    if (!u || u->mode != STEPPING || !(size > 0)) return ERROR;
    double x = u->x, v = u->v, h = size / 4;
    double force = 0.1 * (u->reversed ? -u->force : u->force);
    double damping = 1 + 0.1 * u->damping / (1 + u->damping * u->damping);
    for (int i = 0; i < 4; i++) {
        double x1 = v, v1 = slope(x, v, force, damping);
        double x2 = v + h / 2 * v1, v2 = slope(x + h / 2 * x1, x2, force, damping);
        double x3 = v + h / 2 * v2, v3 = slope(x + h / 2 * x2, x3, force, damping);
        double x4 = v + h * v3, v4 = slope(x + h * x3, x4, force, damping);
        x += h / 6 * (x1 + 2 * x2 + 2 * x3 + x4);
        v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
    if ((x > 0) != u->positive) u->counted++;
    u->positive = x > 0;
    /* Kept small: the ring adds one unit's count to the next one's. */
    u->crossings = (u->counted + u->offset) % 1000;
    u->x = x;
    u->v = v;
    return OK;
}
API const char *fmi2GetTypesPlatform(void) { return "default"; }
API const char *fmi2GetVersion(void) { return "2.0"; }

typedef int SetReal(void *, const unsigned *, size_t, const double *);
typedef int GetReal(void *, const unsigned *, size_t, double *);
typedef int SetWhole(void *, const unsigned *, size_t, const int *);
typedef int GetWhole(void *, const unsigned *, size_t, int *);
typedef int Step(void *, double, double, int);
typedef struct {
    SetReal *set_real;
    GetReal *get_real;
    SetWhole *set_integer, *set_boolean;
    GetWhole *get_integer, *get_boolean;
    Step *step;
} Calls;

/* Function pointers from outside, so that the loop calls as a master has to. Answers the last x of the third unit. */
API double ring_loop(const Calls *f, double size, long steps) {
    static const unsigned in[2] = {0, 1}, out[2] = {2, 3}, whole_out[1] = {1};
    void *units[3];
    double reals[3][2];
    int integers[3][1], booleans[3][1];
    for (int i = 0; i < 3; i++) {
        units[i] = fmi2Instantiate("", 1, "", "", 0, 0, 0);
        if (!units[i]) return -1e9;
        fmi2EnterInitializationMode(units[i]);
        f->get_real(units[i], out, 2, reals[i]);
        f->get_integer(units[i], whole_out, 1, integers[i]);
        f->get_boolean(units[i], whole_out, 1, booleans[i]);
        fmi2ExitInitializationMode(units[i]);
    }
    for (long k = 0; k < steps; k++) {
        for (int i = 0; i < 3; i++) {
            int from = (i + 2) % 3;
            double u[2] = {reals[from][0], reals[from][1]};
            int n[1] = {integers[from][0]}, b[1] = {booleans[from][0]};
            if (f->set_real(units[i], in, 2, u) > 1) return -1e9;
            if (f->set_integer(units[i], in, 1, n) > 1) return -1e9;
            if (f->set_boolean(units[i], in, 1, b) > 1) return -1e9;
            if (f->step(units[i], (double)k * size, size, 1) > 1) return -1e9;
            if (f->get_real(units[i], out, 2, reals[i]) > 1) return -1e9;
            if (f->get_integer(units[i], whole_out, 1, integers[i]) > 1) return -1e9;
            if (f->get_boolean(units[i], whole_out, 1, booleans[i]) > 1) return -1e9;
        }
    }
    double last = reals[2][0];
    for (int i = 0; i < 3; i++) fmi2FreeInstance(units[i]);
    return last;
}
