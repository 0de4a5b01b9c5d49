/* The functions of FMI 2.0 over those of FMI 3.0, which are hidden here. */
#define FMI3_Export
#ifdef FMI2_FUNCTION_PREFIX
#define FMI3_FUNCTION_PREFIX FMI2_FUNCTION_PREFIX
#endif
#include "lagc_fmi3.c"
#include "fmi2Functions.h"

typedef struct {
    Instance *i;
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[128];
    double begin, tolerance;
    int is_defined;
} Component;

#define I (((Component *)c)->i)
#define COMPONENT fmi2Component c

static fmi2Status of(fmi3Status status)
{
    return status == fmi3OK ? fmi2OK : status == fmi3Discard ? fmi2Discard : status == fmi3Warning ? fmi2Warning : fmi2Error;
}

static void log_line(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text)
{
    const Component *c = (const Component *)e;
    if (c->log)
        c->log(c->environment, c->name, of(status), category, "%s", text);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String where,
    const fmi2CallbackFunctions *f, fmi2Boolean visible, fmi2Boolean loud)
{
    Component *c = (Component *)calloc(1, sizeof *c);
    if (!c)
        return NULL;
    c->log = f ? f->logger : NULL;
    c->environment = f ? f->componentEnvironment : NULL;
    strncpy(c->name, name ? name : "", sizeof c->name - 1);
    c->i = instantiate(guid, loud != 0, c, log_line);
    if (!c->i) {
        free(c);
        return NULL;
    }
    c->i->is_co = type == fmi2CoSimulation;
    return c;
}

void fmi2FreeInstance(COMPONENT)
{
    if (c)
        free(I);
    free(c);
}

fmi2Status fmi2SetupExperiment(COMPONENT, fmi2Boolean defined, fmi2Real tolerance, fmi2Real begin, fmi2Boolean stops, fmi2Real stop)
{
    Component *own = (Component *)c;
    own->is_defined = defined != 0;
    own->tolerance = tolerance;
    own->begin = begin;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(COMPONENT)
{
    const Component *own = (const Component *)c;
    return of(fmi3EnterInitializationMode(I, own->is_defined != 0, own->tolerance, own->begin, 0, 0));
}

#define SAME(name, parameters, call) fmi2Status name parameters { return of(call); }
SAME(fmi2SetDebugLogging, (COMPONENT, fmi2Boolean on, size_t n, const fmi2String k[]), fmi3SetDebugLogging(I, on != 0, n, k))
SAME(fmi2ExitInitializationMode, (COMPONENT), fmi3ExitInitializationMode(I))
SAME(fmi2Terminate, (COMPONENT), fmi3Terminate(I))
SAME(fmi2Reset, (COMPONENT), fmi3Reset(I))
SAME(fmi2GetReal, (COMPONENT, const fmi2ValueReference r[], size_t n, fmi2Real v[]), fmi3GetFloat64(I, r, n, v, n))
SAME(fmi2SetReal, (COMPONENT, const fmi2ValueReference r[], size_t n, const fmi2Real v[]), fmi3SetFloat64(I, r, n, v, n))
SAME(fmi2GetFMUstate, (COMPONENT, fmi2FMUstate *s), fmi3GetFMUState(I, s))
SAME(fmi2SetFMUstate, (COMPONENT, fmi2FMUstate s), fmi3SetFMUState(I, s))
SAME(fmi2FreeFMUstate, (COMPONENT, fmi2FMUstate *s), fmi3FreeFMUState(I, s))
SAME(fmi2SerializedFMUstateSize, (COMPONENT, fmi2FMUstate s, size_t *n), fmi3SerializedFMUStateSize(I, s, n))
SAME(fmi2SerializeFMUstate, (COMPONENT, fmi2FMUstate s, fmi2Byte b[], size_t n), fmi3SerializeFMUState(I, s, (fmi3Byte *)b, n))
SAME(fmi2DeSerializeFMUstate, (COMPONENT, const fmi2Byte b[], size_t n, fmi2FMUstate *s),
    fmi3DeserializeFMUState(I, (const fmi3Byte *)b, n, s))
SAME(fmi2GetDirectionalDerivative, (COMPONENT, const fmi2ValueReference u[], size_t n, const fmi2ValueReference k[],
    size_t m, const fmi2Real d[], fmi2Real v[]), fmi3GetDirectionalDerivative(I, u, n, k, m, d, m, v, n))
SAME(fmi2EnterEventMode, (COMPONENT), fmi3EnterEventMode(I))
SAME(fmi2EnterContinuousTimeMode, (COMPONENT), fmi3EnterContinuousTimeMode(I))
SAME(fmi2SetTime, (COMPONENT, fmi2Real t), fmi3SetTime(I, t))
SAME(fmi2SetContinuousStates, (COMPONENT, const fmi2Real x[], size_t n), fmi3SetContinuousStates(I, x, n))
SAME(fmi2GetDerivatives, (COMPONENT, fmi2Real d[], size_t n), fmi3GetContinuousStateDerivatives(I, d, n))
SAME(fmi2GetEventIndicators, (COMPONENT, fmi2Real z[], size_t n), fmi3GetEventIndicators(I, z, n))
SAME(fmi2GetContinuousStates, (COMPONENT, fmi2Real x[], size_t n), fmi3GetContinuousStates(I, x, n))
SAME(fmi2GetNominalsOfContinuousStates, (COMPONENT, fmi2Real x[], size_t n), fmi3GetNominalsOfContinuousStates(I, x, n))

fmi2Status fmi2GetBoolean(COMPONENT, const fmi2ValueReference r[], size_t n, fmi2Boolean v[])
{
    size_t k;
    fmi3Status status = fmi3OK;
    for (k = 0; k < n && status == fmi3OK; k++) {
        fmi3Boolean value = 0;
        status = fmi3GetBoolean(I, &r[k], 1, &value, 1);
        v[k] = value;
    }
    return of(status);
}

fmi2Status fmi2NewDiscreteStates(COMPONENT, fmi2EventInfo *e)
{
    fmi3Boolean again, ends, nominals, values, defined;
    const fmi3Status status = fmi3UpdateDiscreteStates(I, &again, &ends, &nominals, &values, &defined, &e->nextEventTime);
    e->newDiscreteStatesNeeded = again;
    e->terminateSimulation = ends;
    e->nominalsOfContinuousStatesChanged = nominals;
    e->valuesOfContinuousStatesChanged = values;
    e->nextEventTimeDefined = defined;
    return of(status);
}

fmi2Status fmi2CompletedIntegratorStep(COMPONENT, fmi2Boolean last, fmi2Boolean *enter, fmi2Boolean *end)
{
    fmi3Boolean wanted, ends;
    const fmi3Status status = fmi3CompletedIntegratorStep(I, last != 0, &wanted, &ends);
    *enter = wanted;
    *end = ends;
    return of(status);
}

/* Where a clause of the model ends the run, FMI 2.0 has fmi2Discard and the status fmi2Terminated. */
fmi2Status fmi2DoStep(COMPONENT, fmi2Real from, fmi2Real length, fmi2Boolean nosave)
{
    fmi3Boolean event, ends, early;
    fmi3Float64 reached;
    const fmi3Status status = fmi3DoStep(I, from, length, nosave != 0, &event, &ends, &early, &reached);
    if (status != fmi3OK || !ends)
        return of(status);
    I->c.mode = TERMINATED;
    return fmi2Discard;
}

fmi2Status fmi2GetRealStatus(COMPONENT, const fmi2StatusKind k, fmi2Real *v)
{
    *v = I->c.s.t;
    return k == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(COMPONENT, const fmi2StatusKind k, fmi2Boolean *v)
{
    *v = I->c.mode == TERMINATED;
    return k == fmi2Terminated ? fmi2OK : fmi2Discard;
}

#define ABSENT(name, ...) fmi2Status name(COMPONENT, __VA_ARGS__) { return fmi2Discard; }
ABSENT(fmi2GetStatus, const fmi2StatusKind k, fmi2Status *v)
ABSENT(fmi2GetIntegerStatus, const fmi2StatusKind k, fmi2Integer *v)
ABSENT(fmi2GetStringStatus, const fmi2StatusKind k, fmi2String *v)
#define REFERENCES2 COMPONENT, const fmi2ValueReference r[], size_t n
#define LACKS2(name, arguments) \
    fmi2Status name arguments { return n ? of(say(I, fmi3Error, #name " is not provided")) : fmi2OK; }
LACKS2(fmi2GetInteger, (REFERENCES2, fmi2Integer v[]))
LACKS2(fmi2SetInteger, (REFERENCES2, const fmi2Integer v[]))
LACKS2(fmi2SetBoolean, (REFERENCES2, const fmi2Boolean v[]))
LACKS2(fmi2GetString, (REFERENCES2, fmi2String v[]))
LACKS2(fmi2SetString, (REFERENCES2, const fmi2String v[]))
LACKS2(fmi2SetRealInputDerivatives, (REFERENCES2, const fmi2Integer o[], const fmi2Real v[]))
LACKS2(fmi2GetRealOutputDerivatives, (REFERENCES2, const fmi2Integer o[], fmi2Real v[]))
fmi2Status fmi2CancelStep(COMPONENT) { return of(say(I, fmi3Error, "fmi2CancelStep is not provided")); }
