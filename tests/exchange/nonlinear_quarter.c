/* A quarter car with an asymmetric damper, bump stops and a wheel that leaves the road, as another program would export
 * it: FMI 2.0 for model exchange and co-simulation, and FMI 3.0 for co-simulation, each told by its own description.
 * What the standards ask for beyond this, the test adds as functions that do nothing.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"
#include "fmi3FunctionTypes.h"

#define EXPORT(name) name
enum { ROAD, KS, BUMP, REBOUND, GAP, FAULT, X, DX = X + 4, ACC = DX + 4, TRAVEL, LOAD, VARIABLES };
enum { NO_LICENCE = 1, CRASH, NOT_A_NUMBER, EXITS };

static const double MS = 317.5, MU = 45.4, KT = 192e3, STOP = 2e5, GRAVITY = 9.81, SUBSTEP = 5e-4;

typedef struct {
    double v[VARIABLES], time;
    fmi2CallbackFunctions callbacks;
    fmi3LogMessageCallback log;
} Car;

static void evaluate(Car *car)
{
    double *v = car->v, *x = v + X, *dx = v + DX;
    double travel = x[0] - x[1], rate = x[2] - x[3], beyond = fabs(travel) - 1e-3 * v[GAP];
    double force = 1e3 * v[KS] * travel + (rate < 0.0 ? v[BUMP] : v[REBOUND]) * rate;
    if (beyond > 0.0) force += (travel > 0.0 ? STOP : -STOP) * beyond;
    v[LOAD] = fmax(KT * (v[ROAD] - x[1]), -(MS + MU) * GRAVITY);
    dx[0] = x[2], dx[1] = x[3], dx[2] = -force / MS, dx[3] = (force + v[LOAD]) / MU;
    v[ACC] = v[FAULT] == NOT_A_NUMBER && car->time > 0.5 ? NAN : dx[2];
    v[TRAVEL] = 1e3 * travel;
}

static void integrate(Car *car, double h)
{
    const double share[] = {0.5, 0.5, 1.0}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    int i, k, n, steps = (int)ceil(h / SUBSTEP - 1e-9);
    for (n = 0; n < steps; n++) {
        double start[4], sum[4] = {0.0};
        memcpy(start, car->v + X, sizeof start);
        for (k = 0; k < 4; k++) {
            evaluate(car);
            for (i = 0; i < 4; i++) sum[i] += weight[k] * car->v[DX + i];
            if (k < 3)
                for (i = 0; i < 4; i++) car->v[X + i] = start[i] + share[k] * h / steps * car->v[DX + i];
        }
        for (i = 0; i < 4; i++) car->v[X + i] = start[i] + h / steps * sum[i];
    }
    car->time += h;
    if (car->v[FAULT] == CRASH && car->time > 0.5) abort();
    if (car->v[FAULT] == EXITS && car->time > 0.5) exit(7);
}

static Car *made(void)
{
    Car *car = calloc(1, sizeof(Car));
    car->v[KS] = 18.553, car->v[BUMP] = car->v[REBOUND] = 1516.5, car->v[GAP] = 1e3;
    return car;
}

static int get(Car *car, const unsigned int vr[], size_t n, double value[])
{
    size_t i;
    evaluate(car);
    for (i = 0; i < n; i++) value[i] = car->v[vr[i]];
    return 0;
}

static int set(Car *car, const unsigned int vr[], size_t n, const double value[])
{
    size_t i;
    for (i = 0; i < n; i++) car->v[vr[i]] = value[i];
    return 0;
}

/* FMI 2.0 */

fmi2Component EXPORT(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                      const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Car *car = made();
    car->callbacks = *callbacks;
    return car;
}

void EXPORT(fmi2FreeInstance)(fmi2Component c) { free(c); }

fmi2Status EXPORT(fmi2ExitInitializationMode)(fmi2Component c)
{
    Car *car = c;
    if (car->v[FAULT] != NO_LICENCE) return fmi2OK;
    car->callbacks.logger(car->callbacks.componentEnvironment, "car", fmi2Error, "error", "all licences are taken");
    return fmi2Error;
}

fmi2Status EXPORT(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    return (fmi2Status)get(c, vr, n, value);
}

fmi2Status EXPORT(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    return (fmi2Status)set(c, vr, n, value);
}

fmi2Status EXPORT(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean kept)
{
    integrate(c, h);
    return fmi2OK;
}

fmi2Status EXPORT(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

fmi2Status EXPORT(fmi2SetTime)(fmi2Component c, fmi2Real time)
{
    ((Car *)c)->time = time;
    return fmi2OK;
}

fmi2Status EXPORT(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t n)
{
    memcpy(((Car *)c)->v + X, x, n * sizeof *x);
    return fmi2OK;
}

fmi2Status EXPORT(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t n)
{
    memcpy(x, ((Car *)c)->v + X, n * sizeof *x);
    return fmi2OK;
}

fmi2Status EXPORT(fmi2GetDerivatives)(fmi2Component c, fmi2Real dx[], size_t n)
{
    evaluate(c);
    memcpy(dx, ((Car *)c)->v + DX, n * sizeof *dx);
    return fmi2OK;
}

fmi2Status EXPORT(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t n)
{
    while (n--) nominals[n] = 0.01;
    return fmi2OK;
}

/* FMI 3.0 */

fmi3Instance EXPORT(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                                 fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                                 fmi3Boolean early, const fmi3ValueReference required[], size_t n,
                                                 fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                                 fmi3IntermediateUpdateCallback update)
{
    Car *car = made();
    car->log = log;
    return car;
}

void EXPORT(fmi3FreeInstance)(fmi3Instance c) { free(c); }

fmi3Status EXPORT(fmi3GetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t m)
{
    return (fmi3Status)get(c, vr, n, value);
}

fmi3Status EXPORT(fmi3SetFloat64)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[],
                                  size_t m)
{
    return (fmi3Status)set(c, vr, n, value);
}

fmi3Status EXPORT(fmi3DoStep)(fmi3Instance c, fmi3Float64 time, fmi3Float64 h, fmi3Boolean kept, fmi3Boolean *event,
                              fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *last)
{
    integrate(c, h);
    *event = *end = *early = fmi3False;
    *last = time + h;
    return fmi3OK;
}
