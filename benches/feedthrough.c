/* An FMI 2.0 unit that hands on what it gets, in all four types, and costs what the Feedthrough of the FMI project's
   reference units does: after anything was set, and again for each variable that is read, it works all outputs out,
   two fields of 128 bytes among them. `feedthrough_loop.c` steps it beside our master. Used by `src/feedthrough.rs`.

   Instances lie at multiples of 128 bytes: elsewhere the processor takes up to half as long again for the copies of
   texts, and the comparison would be one of where the two sides' instances happen to lie. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { INSTANTIATED = 1, INITIALISING = 2, STEPPING = 4, TEXT = 128 };
typedef struct {
    char t_in[TEXT], t_out[TEXT];
    /* No variable carries these: bytes and the short and long numbers of FMI 3.0, there for what they cost. */
    char bytes_in[TEXT], bytes_out[TEXT];
    size_t length_in, length_out;
    float floats_in[2], floats_out[2];
    signed char i8_in, i8_out;
    unsigned char u8_in, u8_out;
    short i16_in, i16_out;
    unsigned short u16_in, u16_out;
    unsigned u32_in, u32_out;
    long long i64_in, i64_out;
    unsigned long long u64_in, u64_out;
    int e_in, e_out;
    double now, stop, own, in[2], out[2]; /* references 0 and 1, 2 and 3 */
    long steps;
    int mode, stepped, changed, n_in, n_out, b_in, b_out;
} Unit;
#define API __attribute__((visibility("default"), noinline))
#define OK 0
#define ERROR 3
#define ALLOWED(u, modes) (u && (u->mode & (modes)))

static void start(Unit *u) {
    memset(u, 0, sizeof *u);
    u->mode = INSTANTIATED;
    strcpy(u->t_in, "a text on its way");
    strcpy(u->t_out, u->t_in);
    u->length_in = 3;
}

/* Until the first step outputs are as at the start, so that the ring has no loop there. */
static __attribute__((noinline)) void work_out(Unit *u) {
    u->changed = 0;
    if (!u->stepped) return;
    u->out[0] = 0.5 * u->in[0] + u->now;
    u->out[1] = 0.5 * u->in[1] + u->in[0];
    u->n_out = (u->n_in + 1) % 1000;
    u->b_out = !u->b_in;
    strncpy(u->t_out, u->t_in, TEXT);
    u->floats_out[0] = u->floats_in[0];
    u->floats_out[1] = u->floats_in[1];
    u->i8_out = u->i8_in;
    u->u8_out = u->u8_in;
    u->i16_out = u->i16_in;
    u->u16_out = u->u16_in;
    u->u32_out = u->u32_in;
    u->i64_out = u->i64_in;
    u->u64_out = u->u64_in;
    u->e_out = u->e_in;
    u->length_out = u->length_in;
    memcpy(u->bytes_out, u->bytes_in, u->length_in);
}

API void *fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *c, int v, int l) {
    (void)n; (void)t; (void)g; (void)r; (void)c; (void)v; (void)l;
    Unit *u = aligned_alloc(128, (sizeof(Unit) + 127) / 128 * 128);
    if (u) start(u);
    return u;
}
API void fmi2FreeInstance(void *c) { free(c); }
API int fmi2SetupExperiment(void *c, int a, double b, double from, int ends, double stop) {
    Unit *u = c;
    (void)a; (void)b;
    if (!ALLOWED(u, INSTANTIATED)) return ERROR;
    u->now = from;
    u->stop = ends ? stop : INFINITY;
    return OK;
}
#define CHANGE(Name, from, to)              \
    API int Name(void *c) {                 \
        Unit *u = c;                        \
        if (!ALLOWED(u, from)) return ERROR; \
        u->mode = to;                       \
        return OK;                          \
    }
CHANGE(fmi2EnterInitializationMode, INSTANTIATED, INITIALISING)
CHANGE(fmi2ExitInitializationMode, INITIALISING, STEPPING)
API int fmi2Terminate(void *c) { return c ? OK : ERROR; }
API int fmi2Reset(void *c) {
    if (!c) return ERROR;
    start(c);
    return OK;
}

/* Each variable by a call of its own, which looks at all that it was given, as generated units do. */
#define GET(Name, Type, CASES)                                                                          \
    static __attribute__((noinline)) int Name##_one(Unit *u, unsigned ref, Type *values, size_t n, size_t *at) { \
        if (!u || !values || !at || *at >= n) return ERROR;                                             \
        work_out(u);                                                                                    \
        switch (ref) { CASES default: return ERROR; }                                                   \
        ++*at;                                                                                          \
        return OK;                                                                                      \
    }                                                                                                   \
    API int Name(void *c, const unsigned *refs, size_t n, Type *values) {                               \
        Unit *u = c;                                                                                    \
        int status = OK;                                                                                \
        if (!ALLOWED(u, INITIALISING | STEPPING) || (n && !(refs && values))) return ERROR;             \
        if (u->changed) work_out(u);                                                                    \
        for (size_t i = 0, at = 0; i < n && status == OK; i++) status = Name##_one(u, refs[i], values, n, &at); \
        return status;                                                                                  \
    }
#define SET(Name, Type, CASES)                                                                          \
    static __attribute__((noinline)) int Name##_one(Unit *u, unsigned ref, Type const *values, size_t n, size_t *at) { \
        if (!u || !values || !at || *at >= n) return ERROR;                                             \
        switch (ref) { CASES default: return ERROR; }                                                   \
        ++*at;                                                                                          \
        u->changed = 1;                                                                                 \
        return OK;                                                                                      \
    }                                                                                                   \
    API int Name(void *c, const unsigned *refs, size_t n, Type const *values) {                         \
        Unit *u = c;                                                                                    \
        int status = OK;                                                                                \
        if (!ALLOWED(u, INSTANTIATED | INITIALISING | STEPPING) || (n && !(refs && values))) return ERROR; \
        for (size_t i = 0, at = 0; i < n && status == OK; i++) status = Name##_one(u, refs[i], values, n, &at); \
        return status;                                                                                  \
    }
#define READ(reference, field) case reference: values[*at] = u->field; break;
#define WRITE(reference, field) case reference: u->field = values[*at]; break;
GET(fmi2GetReal, double, READ(0, in[0]) READ(1, in[1]) READ(2, out[0]) READ(3, out[1]))
SET(fmi2SetReal, double, WRITE(0, in[0]) WRITE(1, in[1]))
GET(fmi2GetInteger, int, READ(0, n_in) READ(1, n_out))
SET(fmi2SetInteger, int, WRITE(0, n_in))
GET(fmi2GetBoolean, int, READ(0, b_in) READ(1, b_out))
SET(fmi2SetBoolean, int, WRITE(0, b_in))
GET(fmi2GetString, const char *, READ(0, t_in) READ(1, t_out))
SET(fmi2SetString, const char *, case 0: if (strlen(values[*at]) >= TEXT) return ERROR; strcpy(u->t_in, values[*at]); break;)

static __attribute__((noinline)) int near(double a, double b) {
    double apart = fabs(a - b), one = fabs(a), other = fabs(b);
    return apart <= 1e-5 || apart <= 1e-5 * (one < other ? other : one);
}

API int fmi2DoStep(void *c, double from, double size, int no_return) {
    Unit *u = c;
    (void)no_return;
    if (!ALLOWED(u, STEPPING) || !near(from, u->now) || size <= 0) return ERROR;
    double to = from + size;
    if (to > u->stop && !near(to, u->stop)) return ERROR;
    /* Steps of its own, of which there is nothing to do. */
    while (u->own + 0.1 < to || near(u->own + 0.1, to)) u->own = 0.1 * ++u->steps;
    u->now = to;
    u->stepped = 1;
    /* Texts change now and then. */
    if (u->n_in % 100 == 0) u->t_in[0] = u->t_in[0] == 'z' ? 'a' : u->t_in[0] + 1;
    return OK;
}
API const char *fmi2GetTypesPlatform(void) { return "default"; }
API const char *fmi2GetVersion(void) { return "2.0"; }
