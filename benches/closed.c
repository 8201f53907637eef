/* The closed loop of plant, camera and controller stepped by a plain C loop: the limit for our master on our own units.
   Used by `src/real.rs`, which knows the references and the signal of z desired. */
#include <dlfcn.h>
#include <stdlib.h>

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;
typedef struct {
    void *c;
    int (*reset)(void *), (*enter)(void *), (*leave)(void *);
    int (*setup)(void *, int, double, double, int, double);
    int (*set)(void *, const unsigned *, size_t, const double *), (*get)(void *, const unsigned *, size_t, double *);
    int (*set_whole)(void *, const unsigned *, size_t, const int *), (*get_whole)(void *, const unsigned *, size_t, int *);
    int (*step)(void *, double, double, int);
} Unit;
/* References of what is connected, in the order in which it is passed on. */
typedef struct {
    unsigned plant_start[2], plant_out[4], plant_in, camera_in[4], camera_out[4], camera_frame;
    unsigned controller_in[5], controller_frame, controller_out;
} References;

#define API __attribute__((visibility("default")))

static void silent(void *e, const char *n, int s, const char *c, const char *m, ...) {
    (void)e; (void)n; (void)s; (void)c; (void)m;
}
static Callbacks callbacks = {silent, calloc, free, 0, 0};
static Unit units[3];

/* Opens a unit's library as number 0 (plant), 1 (camera) or 2 (controller); answers whether that went well. */
API int closed_open(int number, const char *library, const char *guid, const char *resources) {
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!handle) return 0;
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    Unit *u = &units[number];
    *(void **)&instantiate = dlsym(handle, "fmi2Instantiate");
    *(void **)&u->reset = dlsym(handle, "fmi2Reset");
    *(void **)&u->setup = dlsym(handle, "fmi2SetupExperiment");
    *(void **)&u->enter = dlsym(handle, "fmi2EnterInitializationMode");
    *(void **)&u->leave = dlsym(handle, "fmi2ExitInitializationMode");
    *(void **)&u->set = dlsym(handle, "fmi2SetReal");
    *(void **)&u->get = dlsym(handle, "fmi2GetReal");
    *(void **)&u->set_whole = dlsym(handle, "fmi2SetInteger");
    *(void **)&u->get_whole = dlsym(handle, "fmi2GetInteger");
    *(void **)&u->step = dlsym(handle, "fmi2DoStep");
    if (!instantiate) return 0;
    u->c = instantiate("unit", 1, guid, resources, &callbacks, 0, 0);
    return u->c != 0;
}

#define TRY(call) do { if ((call) > 1) return -1; } while (0)

/* From the start to the end of `steps` points, `rate` a second; `z` holds z desired at the start and at each point.
   Leaves q1, q2, dq1, dq2 and the torque in `last`; answers 0 if all went well. */
API int closed_run(const References *r, const double *start, double rate, long steps, const double *z, double *last) {
    Unit *plant = &units[0], *camera = &units[1], *controller = &units[2];
    double pose[4], seen[5], torque;
    int frame;
    for (int i = 0; i < 3; i++) TRY(units[i].reset(units[i].c));
    TRY(plant->set(plant->c, r->plant_start, 2, start));
    for (int i = 0; i < 3; i++) {
        TRY(units[i].setup(units[i].c, 0, 0, 0, 1, (double)steps / rate));
        TRY(units[i].enter(units[i].c));
    }
    TRY(plant->get(plant->c, r->plant_out, 4, pose));
    TRY(camera->set(camera->c, r->camera_in, 4, pose));
    TRY(camera->get(camera->c, r->camera_out, 4, seen));
    TRY(camera->get_whole(camera->c, &r->camera_frame, 1, &frame));
    seen[4] = z[0];
    TRY(controller->set(controller->c, r->controller_in, 5, seen));
    TRY(controller->set_whole(controller->c, &r->controller_frame, 1, &frame));
    TRY(controller->get(controller->c, &r->controller_out, 1, &torque));
    TRY(plant->set(plant->c, &r->plant_in, 1, &torque));
    for (int i = 0; i < 3; i++) TRY(units[i].leave(units[i].c));
    for (long k = 0; k < steps; k++) {
        double begin = (double)k / rate, size = 1 / rate;
        TRY(plant->set(plant->c, &r->plant_in, 1, &torque));
        TRY(plant->step(plant->c, begin, size, 1));
        TRY(plant->get(plant->c, r->plant_out, 4, pose));
        TRY(camera->set(camera->c, r->camera_in, 4, pose));
        TRY(camera->step(camera->c, begin, size, 1));
        TRY(camera->get(camera->c, r->camera_out, 4, seen));
        TRY(camera->get_whole(camera->c, &r->camera_frame, 1, &frame));
        seen[4] = z[k + 1];
        TRY(controller->set(controller->c, r->controller_in, 5, seen));
        TRY(controller->set_whole(controller->c, &r->controller_frame, 1, &frame));
        TRY(controller->step(controller->c, begin, size, 1));
        TRY(controller->get(controller->c, &r->controller_out, 1, &torque));
    }
    for (int i = 0; i < 4; i++) last[i] = pose[i];
    last[4] = torque;
    return 0;
}
