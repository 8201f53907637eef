/* A small FMI 2.0 co-simulation unit: RK4 with held inputs. `model.h` brings variables and equations (unit_c.py writes it).

   With OLD it behaves as units of code generators of ten years ago do: one instance in static memory; values that are set before
   fmi2SetupExperiment are forgotten; a start time is not listened to; a reset leaves the clock where it is; steps have a size of
   their own, and as many are made as it takes to come by the end.

   With LATE, the name of an output, it behaves as some units do that were made for libcosim: values that are set before initialization
   mode are forgotten, and that output is computed in a step only. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef void *Component;
typedef unsigned int Reference;
typedef int Status; /* 0 ok, 3 error */
typedef int Boolean;
typedef const char *String;

#include "model.h"

typedef struct {
    double v[NV], x[NX];
    int stepping;
    double time; /* OLD only */
} Unit;

#ifdef OLD
static Unit the_one;
static int alive;
#endif

static void derived(Unit *unit) {
#ifdef LATE
    if (unit->stepping) return;
#endif
    if (!unit->stepping) begin(unit->v, unit->x);
    outputs(unit->v, unit->x);
#ifdef LATE
    unit->v[LATE] = 0;
#endif
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
Status fmi2SetDebugLogging(Component c, Boolean on, size_t n, const String names[]) { return 0; }

Component fmi2Instantiate(String name, int type, String guid, String resources, const void *callbacks, Boolean visible, Boolean log) {
    if (type != 1 || strcmp(guid, GUID) != 0) return NULL;
#ifdef OLD
    if (alive++) return NULL;
    Unit *unit = memset(&the_one, 0, sizeof the_one);
#else
    Unit *unit = calloc(1, sizeof(Unit));
#endif
    if (unit) memcpy(unit->v, START, sizeof START);
    return unit;
}
void fmi2FreeInstance(Component c) {
#ifdef OLD
    alive--;
#else
    free(c);
#endif
}
Status fmi2SetupExperiment(Component c, Boolean a, double tolerance, double start, Boolean b, double stop) {
#ifdef OLD
    memcpy(((Unit *)c)->v, START, sizeof START);
#endif
    return 0;
}
Status fmi2EnterInitializationMode(Component c) {
#ifdef LATE
    memcpy(((Unit *)c)->v, START, sizeof START);
#endif
    return 0;
}
Status fmi2ExitInitializationMode(Component c) {
    Unit *unit = c;
    derived(unit);
    unit->stepping = 1;
    return 0;
}
Status fmi2Terminate(Component c) { return 0; }
Status fmi2Reset(Component c) {
    Unit *unit = c;
    const double time = unit->time;
    memset(unit, 0, sizeof *unit);
    memcpy(unit->v, START, sizeof START);
    unit->time = time; /* 0 but for OLD */
    return 0;
}

Status fmi2GetReal(Component c, const Reference r[], size_t n, double value[]) {
    Unit *unit = c;
    derived(unit);
    for (size_t k = 0; k < n; k++) {
        if (r[k] >= NV) return 3;
        value[k] = unit->v[r[k]];
    }
    return 0;
}
Status fmi2SetReal(Component c, const Reference r[], size_t n, const double value[]) {
    Unit *unit = c;
    for (size_t k = 0; k < n; k++) {
        if (r[k] >= NV) return 3;
        unit->v[r[k]] = value[k];
    }
    return 0;
}

Status fmi2DoStep(Component c, double at, double size, Boolean never_back) {
    Unit *unit = c;
#ifdef OLD
    const double h = STEP;
    const int parts = (int)ceil((at + size - unit->time) / STEP);
    if (parts > 0) unit->time += parts * STEP;
#else
    const int parts = (int)fmax(1.0, ceil(size / STEP - 1e-6));
    const double h = size / parts;
#endif
    double k1[NX], k2[NX], k3[NX], k4[NX], y[NX], *x = unit->x;
    for (int part = 0; part < parts; part++) {
        derivatives(unit->v, x, k1);
        for (int k = 0; k < NX; k++) y[k] = x[k] + 0.5 * h * k1[k];
        derivatives(unit->v, y, k2);
        for (int k = 0; k < NX; k++) y[k] = x[k] + 0.5 * h * k2[k];
        derivatives(unit->v, y, k3);
        for (int k = 0; k < NX; k++) y[k] = x[k] + h * k3[k];
        derivatives(unit->v, y, k4);
        for (int k = 0; k < NX; k++) x[k] += h / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
    }
    outputs(unit->v, x);
    for (int k = 0; k < NX; k++)
        if (!isfinite(x[k])) return 3;
    return 0;
}

Status fmi2GetFMUstate(Component c, void **state) {
    if (!*state) *state = malloc(sizeof(Unit));
    if (!*state) return 3;
    memcpy(*state, c, sizeof(Unit));
    return 0;
}
Status fmi2SetFMUstate(Component c, void *state) {
    memcpy(c, state, sizeof(Unit));
    return 0;
}
Status fmi2FreeFMUstate(Component c, void **state) {
    free(*state);
    *state = NULL;
    return 0;
}

/* What this unit has nothing of. */
Status fmi2GetInteger(Component c, const Reference r[], size_t n, int value[]) { return n ? 3 : 0; }
Status fmi2GetBoolean(Component c, const Reference r[], size_t n, Boolean value[]) { return n ? 3 : 0; }
Status fmi2GetString(Component c, const Reference r[], size_t n, String value[]) { return n ? 3 : 0; }
Status fmi2SetInteger(Component c, const Reference r[], size_t n, const int value[]) { return n ? 3 : 0; }
Status fmi2SetBoolean(Component c, const Reference r[], size_t n, const Boolean value[]) { return n ? 3 : 0; }
Status fmi2SetString(Component c, const Reference r[], size_t n, const String value[]) { return n ? 3 : 0; }
Status fmi2SerializedFMUstateSize(Component c, void *state, size_t *size) { return 3; }
Status fmi2SerializeFMUstate(Component c, void *state, char bytes[], size_t size) { return 3; }
Status fmi2DeSerializeFMUstate(Component c, const char bytes[], size_t size, void **state) { return 3; }
Status fmi2GetDirectionalDerivative(Component c, const Reference u[], size_t nu, const Reference k[], size_t nk, const double dv[],
                                    double dz[]) {
    return 3;
}
Status fmi2SetRealInputDerivatives(Component c, const Reference r[], size_t n, const int order[], const double value[]) { return 3; }
Status fmi2GetRealOutputDerivatives(Component c, const Reference r[], size_t n, const int order[], double value[]) { return 3; }
Status fmi2CancelStep(Component c) { return 3; }
Status fmi2GetStatus(Component c, int kind, Status *value) { return 2; }
Status fmi2GetRealStatus(Component c, int kind, double *value) { return 2; }
Status fmi2GetIntegerStatus(Component c, int kind, int *value) { return 2; }
Status fmi2GetBooleanStatus(Component c, int kind, Boolean *value) { return 2; }
Status fmi2GetStringStatus(Component c, int kind, String *value) { return 2; }
