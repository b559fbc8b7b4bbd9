/* A linear system by FMI 2.0, for model exchange and co-simulation: x' = A x + B u, y = C x + D u.
 *
 * The matrices stand in tables.h. Whatever needs no compiler but this file and that one:
 *     cc -O2 -shared -fPIC -DFMI2_OVERRIDE_FUNCTION_PREFIX fmi2.c -o <model identifier>.so
 * for binaries/linux64 (.dll for win64, .dylib for darwin64). Linked statically, every function begins with the
 * model's identifier. A co-simulation step is exact for inputs that are linear over it.
 */
#include <stdlib.h>
#include <string.h>

#include "tables.h"

/* Types of the standard's header, of which this file is independent. */

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#ifdef FMI2_OVERRIDE_FUNCTION_PREFIX
#define NAMED(name) name
#else
#define JOINED(prefix, name) prefix##_##name
#define EXPANDED(prefix, name) JOINED(prefix, name)
#define NAMED(name) EXPANDED(MODEL_IDENTIFIER, name)
#endif
#if defined(_WIN32)
#define FMI(type, name) __declspec(dllexport) type NAMED(name)
#elif defined(__GNUC__)
#define FMI(type, name) __attribute__((visibility("default"))) type NAMED(name)
#else
#define FMI(type, name) type NAMED(name)
#endif

/* Value references, one kind after another. */
enum {
    STATE = INPUTS,
    DERIVATIVE = STATE + STATES,
    OUTPUT = DERIVATIVE + STATES,
    CONSTANT = OUTPUT + OUTPUTS,
    VARIABLES = CONSTANT + CONSTANTS
};

/* States, then the inputs and their slopes, which a step carries along. */
enum { CARRIED = STATES + 2 * INPUTS };

typedef struct {
    double x[STATES], u[INPUTS], slope[INPUTS], time;
    int started;
} State;

typedef struct {
    State now;
    double step, transition[CARRIED][CARRIED], term[CARRIED][CARRIED], scaled[CARRIED][CARRIED];
    fmi2CallbackFunctions callbacks;
    char *name;
} Instance;

static fmi2Status refused(const Instance *m, fmi2String message)
{
    if (m->callbacks.logger)
        m->callbacks.logger(m->callbacks.componentEnvironment, m->name, fmi2Error, "logStatusError", message);
    return fmi2Error;
}

static double product(const double *row, const double *x, int n)
{
    double sum = 0.0;
    int i;
    for (i = 0; i < n; i++) sum += row[i] * x[i];
    return sum;
}

static double derivative(const Instance *m, int i)
{
    return product(A[i], m->now.x, STATES) + product(B[i], m->now.u, INPUTS);
}

/* At rest on the first inputs. */
static void rest(Instance *m)
{
    int i;
    for (i = 0; i < STATES; i++) m->now.x[i] = product(REST[i], m->now.u, INPUTS);
}

static void multiply(double to[CARRIED][CARRIED], double left[CARRIED][CARRIED], double right[CARRIED][CARRIED])
{
    int i, j, k;
    memset(to, 0, sizeof(double) * CARRIED * CARRIED);
    for (i = 0; i < CARRIED; i++)
        for (k = 0; k < CARRIED; k++)
            for (j = 0; j < CARRIED; j++) to[i][j] += left[i][k] * right[k][j];
}

/* exp(h [A B 0; 0 0 1; 0 0 0]) by its Taylor series at a fraction of h, squared up again: what x, u and the slope of u
 * become over a step. */
static void advance_by(Instance *m, double h)
{
    double norm = 0.0, share = h;
    int i, j, k, squarings = 0;
    if (m->step == h) return;
    for (i = 0; i < STATES; i++) {
        double sum = 0.0;
        for (j = 0; j < STATES; j++) sum += A[i][j] < 0.0 ? -A[i][j] : A[i][j];
        for (j = 0; j < INPUTS; j++) sum += B[i][j] < 0.0 ? -B[i][j] : B[i][j];
        if (sum > norm) norm = sum;
    }
    while ((norm + 1.0) * share > 0.5) share *= 0.5, squarings++;
    memset(m->scaled, 0, sizeof m->scaled);
    for (i = 0; i < STATES; i++) {
        for (j = 0; j < STATES; j++) m->scaled[i][j] = share * A[i][j];
        for (j = 0; j < INPUTS; j++) m->scaled[i][STATES + j] = share * B[i][j];
    }
    for (i = 0; i < INPUTS; i++) m->scaled[STATES + i][STATES + INPUTS + i] = share;
    /* Horner's rule: 1 + X/1 (1 + X/2 (1 + ...)); X^17/17! is below rounding. */
    memset(m->transition, 0, sizeof m->transition);
    for (i = 0; i < CARRIED; i++) m->transition[i][i] = 1.0;
    for (k = 16; k > 0; k--) {
        multiply(m->term, m->scaled, m->transition);
        for (i = 0; i < CARRIED; i++)
            for (j = 0; j < CARRIED; j++) m->transition[i][j] = (i == j) + m->term[i][j] / k;
    }
    for (; squarings > 0; squarings--) {
        multiply(m->term, m->transition, m->transition);
        memcpy(m->transition, m->term, sizeof m->term);
    }
    m->step = h;
}

/* Common to both kinds. */

FMI(const char *, fmi2GetTypesPlatform)(void) { return "default"; }

FMI(const char *, fmi2GetVersion)(void) { return "2.0"; }

FMI(fmi2Status, fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

FMI(fmi2Component, fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                    const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    Instance *m = calloc(1, sizeof(Instance));
    (void)type, (void)resources, (void)visible, (void)logging;
    if (!m) return NULL;
    if (callbacks) m->callbacks = *callbacks;
    m->name = calloc(strlen(name) + 1, 1);
    if (m->name) strcpy(m->name, name);
    if (!m->name || strcmp(guid, GUID) != 0) {
        refused(m, "the guid of modelDescription.xml is not the one that these sources were written with");
        free(m->name);
        free(m);
        return NULL;
    }
    return m;
}

FMI(void, fmi2FreeInstance)(fmi2Component c)
{
    Instance *m = c;
    if (!m) return;
    free(m->name);
    free(m);
}

FMI(fmi2Status, fmi2SetupExperiment)(fmi2Component c, fmi2Boolean given, fmi2Real tolerance, fmi2Real start,
                                     fmi2Boolean ends, fmi2Real stop)
{
    (void)given, (void)tolerance, (void)ends, (void)stop;
    ((Instance *)c)->now.time = start;
    return fmi2OK;
}

FMI(fmi2Status, fmi2EnterInitializationMode)(fmi2Component c)
{
    rest(c);
    return fmi2OK;
}

FMI(fmi2Status, fmi2ExitInitializationMode)(fmi2Component c)
{
    ((Instance *)c)->now.started = 1;
    return fmi2OK;
}

FMI(fmi2Status, fmi2Terminate)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI(fmi2Status, fmi2Reset)(fmi2Component c)
{
    memset(&((Instance *)c)->now, 0, sizeof(State));
    return fmi2OK;
}

FMI(fmi2Status, fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    const Instance *m = c;
    size_t i;
    for (i = 0; i < n; i++) {
        int k = (int)vr[i];
        if (vr[i] >= VARIABLES) return refused(m, "no real variable has this value reference");
        if (k >= CONSTANT) value[i] = PARAMETER[k - CONSTANT];
        else if (k >= OUTPUT)
            value[i] = product(C[k - OUTPUT], m->now.x, STATES) + product(D[k - OUTPUT], m->now.u, INPUTS);
        else if (k >= DERIVATIVE) value[i] = derivative(m, k - DERIVATIVE);
        else if (k >= STATE) value[i] = m->now.x[k - STATE];
        else value[i] = m->now.u[k];
    }
    return fmi2OK;
}

FMI(fmi2Status, fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    Instance *m = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (vr[i] >= INPUTS) return refused(m, "only inputs can be set: the parameters are in the matrices");
        m->now.u[vr[i]] = value[i];
    }
    if (!m->now.started) rest(m);
    return fmi2OK;
}

/* There are no variables of other types. */
#define NONE(name, type)                                                                                               \
    FMI(fmi2Status, name)(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[])                      \
    {                                                                                                                  \
        (void)vr, (void)value;                                                                                         \
        return n ? refused(c, "all variables are real") : fmi2OK;                                                      \
    }
NONE(fmi2GetInteger, fmi2Integer)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetString, const fmi2String)

FMI(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return refused(c, "no memory for a state");
    memcpy(*state, &((Instance *)c)->now, sizeof(State));
    return fmi2OK;
}

FMI(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    memcpy(&((Instance *)c)->now, state, sizeof(State));
    return fmi2OK;
}

FMI(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

FMI(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(State);
    return fmi2OK;
}

FMI(fmi2Status, fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    if (size < sizeof(State)) return refused(c, "too few bytes for a state");
    memcpy(bytes, state, sizeof(State));
    return fmi2OK;
}

FMI(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    if (size != sizeof(State)) return refused(c, "no state of this model");
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return refused(c, "no memory for a state");
    memcpy(*state, bytes, sizeof(State));
    return fmi2OK;
}

/* What the unknowns change by as the knowns do: by the matrices themselves. */
FMI(fmi2Status, fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[], size_t unknowns,
                                              const fmi2ValueReference known[], size_t knowns, const fmi2Real change[],
                                              fmi2Real found[])
{
    size_t i, j;
    for (i = 0; i < unknowns; i++) {
        int of = (int)unknown[i], output = of >= OUTPUT;
        if (of < DERIVATIVE || of >= CONSTANT) return refused(c, "unknowns are derivatives and outputs");
        found[i] = 0.0;
        for (j = 0; j < knowns; j++) {
            int by = (int)known[j];
            if (by >= DERIVATIVE) return refused(c, "knowns are inputs and states");
            if (by >= STATE) found[i] += change[j] * (output ? C[of - OUTPUT] : A[of - DERIVATIVE])[by - STATE];
            else found[i] += change[j] * (output ? D[of - OUTPUT] : B[of - DERIVATIVE])[by];
        }
    }
    return fmi2OK;
}

/* Model exchange: there are no events. */

FMI(fmi2Status, fmi2EnterEventMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI(fmi2Status, fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info)
{
    (void)c;
    memset(info, 0, sizeof *info);
    return fmi2OK;
}

FMI(fmi2Status, fmi2EnterContinuousTimeMode)(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

FMI(fmi2Status, fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean final, fmi2Boolean *event, fmi2Boolean *end)
{
    (void)c, (void)final;
    *event = *end = 0;
    return fmi2OK;
}

FMI(fmi2Status, fmi2SetTime)(fmi2Component c, fmi2Real time)
{
    ((Instance *)c)->now.time = time;
    return fmi2OK;
}

static fmi2Status counted(fmi2Component c, size_t n)
{
    return n == STATES ? fmi2OK : refused(c, "wrong number of states");
}

FMI(fmi2Status, fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t n)
{
    if (counted(c, n) != fmi2OK) return fmi2Error;
    memcpy(((Instance *)c)->now.x, x, n * sizeof *x);
    return fmi2OK;
}

FMI(fmi2Status, fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t n)
{
    int i;
    if (counted(c, n) != fmi2OK) return fmi2Error;
    for (i = 0; i < STATES; i++) derivatives[i] = derivative(c, i);
    return fmi2OK;
}

FMI(fmi2Status, fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t n)
{
    (void)indicators;
    return n ? refused(c, "there are no event indicators") : fmi2OK;
}

FMI(fmi2Status, fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t n)
{
    if (counted(c, n) != fmi2OK) return fmi2Error;
    memcpy(x, ((Instance *)c)->now.x, n * sizeof *x);
    return fmi2OK;
}

FMI(fmi2Status, fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t n)
{
    if (counted(c, n) != fmi2OK) return fmi2Error;
    memcpy(nominals, NOMINAL, sizeof NOMINAL);
    return fmi2OK;
}

/* Co-simulation. */

FMI(fmi2Status, fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                             const fmi2Integer order[], const fmi2Real value[])
{
    Instance *m = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (vr[i] >= INPUTS || order[i] != 1) return refused(m, "inputs have first derivatives only");
        m->now.slope[vr[i]] = value[i];
    }
    return fmi2OK;
}

FMI(fmi2Status, fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], fmi2Real value[])
{
    (void)vr, (void)order, (void)value;
    return n ? refused(c, "outputs give no derivatives") : fmi2OK;
}

FMI(fmi2Status, fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean kept)
{
    Instance *m = c;
    double carried[CARRIED];
    int i;
    (void)kept;
    if (!(h > 0.0 && h < 1e9)) return refused(m, "a step must be > 0 s");
    advance_by(m, h);
    memcpy(carried, m->now.x, sizeof m->now.x);
    memcpy(carried + STATES, m->now.u, sizeof m->now.u);
    memcpy(carried + STATES + INPUTS, m->now.slope, sizeof m->now.slope);
    for (i = 0; i < STATES; i++) m->now.x[i] = product(m->transition[i], carried, CARRIED);
    /* A slope holds for one step, so that inputs whose master gives none are held. */
    for (i = 0; i < INPUTS; i++) m->now.u[i] += h * m->now.slope[i];
    memset(m->now.slope, 0, sizeof m->now.slope);
    m->now.time = time + h;
    for (i = 0; i < STATES; i++)
        if (m->now.x[i] - m->now.x[i] != 0.0) return refused(m, "the states are not finite; are the inputs?");
    return fmi2OK;
}

FMI(fmi2Status, fmi2CancelStep)(fmi2Component c) { return refused(c, "steps are never pending"); }

FMI(fmi2Status, fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = ((Instance *)c)->now.time;
    return fmi2OK;
}

/* Steps are never pending. */
#define NO_STATUS(name, type)                                                                                          \
    FMI(fmi2Status, name)(fmi2Component c, const fmi2StatusKind kind, type *value)                                     \
    {                                                                                                                  \
        (void)c, (void)kind, (void)value;                                                                              \
        return fmi2Discard;                                                                                            \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetBooleanStatus, fmi2Boolean)
NO_STATUS(fmi2GetStringStatus, fmi2String)
