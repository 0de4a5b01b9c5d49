/* The functions of FMI 3.0, Model Exchange and Co-Simulation, for one model. */
#include "lagc_instance.h"

#define INSTANCE Instance *i = (Instance *)instance
#define REQUIRE(modes) \
    if (!(i->c.mode & (modes))) \
        return say(i, fmi3Error, "%s: not allowed in this mode", __func__)

/* -- The life of an instance -- */

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    INSTANCE;
    i->is_loud = on;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
    fmi3Boolean loud, fmi3InstanceEnvironment e, fmi3LogMessageCallback log)
{
    return instantiate(token, loud, e, log);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, fmi3Boolean visible,
    fmi3Boolean loud, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference r[], size_t n,
    fmi3InstanceEnvironment e, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    Instance *i = instantiate(token, loud, e, log);
    if (i) {
        i->is_co = 1;
        i->uses_events = events;
        i->may_return_early = early;
        i->update = update;
    }
    return i;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String a, fmi3String b, fmi3String c, fmi3Boolean d, fmi3Boolean f,
    fmi3InstanceEnvironment e, fmi3LogMessageCallback g, fmi3ClockUpdateCallback h, fmi3LockPreemptionCallback k,
    fmi3UnlockPreemptionCallback l)
{
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

fmi3Status fmi3Reset(fmi3Instance instance) { INSTANCE; reset(i); return fmi3OK; }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean defined, fmi3Float64 tolerance,
    fmi3Float64 begin, fmi3Boolean stops, fmi3Float64 stop)
{
    INSTANCE;
    REQUIRE(INSTANTIATED);
    if (defined && tolerance > 0.0) {
        i->c.tolerance = tolerance;
        i->c.o.rtol = tolerance < 1e-14 ? 1e-14 : tolerance;
    }
    i->c.t = begin;
    i->c.mode = INITIALIZATION;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    INSTANCE;
    fmi3Status status;
    REQUIRE(INITIALIZATION);
    status = evaluate(i);
    i->c.mode = i->is_co && !i->uses_events ? STEP : EVENT;
    return status;
}

#define TRANSITION(name, from, to) \
    fmi3Status name(fmi3Instance instance) { INSTANCE; REQUIRE(from); i->c.mode = to; return fmi3OK; }
TRANSITION(fmi3EnterEventMode, EVENT | CONTINUOUS | STEP, EVENT)
TRANSITION(fmi3EnterStepMode, EVENT, STEP)
TRANSITION(fmi3EnterContinuousTimeMode, EVENT, CONTINUOUS)
TRANSITION(fmi3Terminate, EVENT | CONTINUOUS | STEP, TERMINATED)

/* -- Variables -- */

static fmi3Status get_value(Instance *i, unsigned at, double *value)
{
    double z[K(NFREE) + 1];
    if (at >= VR_X) { /* states too: the initial ones are computed */
        const fmi3Status status = evaluate(i);
        if (status != fmi3OK)
            return status;
    }
    if (at == 0)
        *value = i->c.t;
    else if (at < VR_X)
        *value = ((const double *)&i->c.p)[at - VR_P];
    else if (at < VR_D)
        *value = i->c.x[at - VR_X];
    else if (at < VR_Y)
        *value = i->dx[at - VR_D];
    else if (at < VR_Z) {
        const fmi3Status status = evaluate_outputs(i);
        *value = i->y[at - VR_Y];
        return status;
    } else if (at < VR_END) {
        const fmi3Status status = indicators(i, z);
        *value = z[at - VR_Z];
        return status;
    } else
        return say(i, fmi3Error, "there is no value reference %u", at);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t m)
{
    INSTANCE;
    size_t k;
    fmi3Status status = fmi3OK;
    for (k = 0; k < n && status == fmi3OK; k++)
        status = get_value(i, r[k], &v[k]);
    return status;
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference r[], size_t n, fmi3Boolean v[], size_t m)
{
    INSTANCE;
    size_t k;
    fmi3Status status = fmi3OK;
    for (k = 0; k < n && status == fmi3OK; k++) {
        double value = 0.0;
        status = get_value(i, r[k], &value);
        v[k] = value != 0.0;
    }
    return status;
}

/* A parameter changes what bind() has computed; before the motion begins, it changes the initial state too. */
static fmi3Status set_parameter(Instance *i, unsigned k, double value)
{
    Store *c = &i->c;
    double *to = (double *)&c->p + k;
    const int is_input = k >= NPARAMETERS;
    REQUIRE(INSTANTIATED | INITIALIZATION | EVENT | STEP | (is_input ? CONTINUOUS : 0));
    if (*to == value)
        return fmi3OK;
    *to = value;
    if (!is_input)
        c->is_bound = 0;
    if (c->mode & (INSTANTIATED | INITIALIZATION))
        c->is_started = 0;
    i->is_evaluated = 0;
    return fmi3OK;
}

/* Some importers set all start values.  That of the description states nothing, unless another one was set. */
static fmi3Status set_start(Instance *i, unsigned k, double value)
{
    Store *c = &i->c;
    REQUIRE(INSTANTIATED | INITIALIZATION);
    if (!c->is_given[k] && value == start_values[k])
        return fmi3OK;
    c->given[k] = value;
    c->is_given[k] = 1;
    c->is_started = i->is_evaluated = 0;
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t m)
{
    INSTANCE;
    size_t k;
    fmi3Status status = fmi3OK;
    for (k = 0; k < n && status == fmi3OK; k++)
        if (r[k] >= VR_P && r[k] < VR_X)
            status = set_parameter(i, r[k] - VR_P, v[k]);
        else if (r[k] >= VR_X && r[k] < VR_X + NS)
            status = set_start(i, r[k] - VR_X, v[k]);
        else
            status = say(i, fmi3Error, "value reference %u cannot be set", (unsigned)r[k]);
    return status;
}

#define NO_GET(T) \
    fmi3Status fmi3Get##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, fmi3##T v[], size_t m) \
    { return n ? say((Instance *)i, fmi3Error, "no variable of type " #T) : fmi3OK; }
#define NO_SET(T) \
    fmi3Status fmi3Set##T(fmi3Instance i, const fmi3ValueReference r[], size_t n, const fmi3##T v[], size_t m) \
    { return n ? say((Instance *)i, fmi3Error, "no variable of type " #T " to set") : fmi3OK; }
#define NO_TYPE(T) NO_GET(T) NO_SET(T)
NO_TYPE(Float32) NO_TYPE(Int8) NO_TYPE(UInt8) NO_TYPE(Int16) NO_TYPE(UInt16) NO_TYPE(Int32) NO_TYPE(UInt32)
NO_TYPE(Int64) NO_TYPE(UInt64) NO_TYPE(String) NO_SET(Boolean)

/* -- The state of the FMU -- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *to)
{
    INSTANCE;
    if (!*to && !(*to = malloc(sizeof i->c)))
        return say(i, fmi3Error, "no memory");
    memcpy(*to, &i->c, sizeof i->c);
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState from)
{
    INSTANCE;
    memcpy(&i->c, from, sizeof i->c);
    i->is_evaluated = 0;
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *s)
{
    free(*s);
    *s = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState s, size_t *n)
{
    *n = sizeof TOKEN + sizeof(Store);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState s, fmi3Byte to[], size_t n)
{
    INSTANCE;
    if (n < sizeof TOKEN + sizeof(Store))
        return say(i, fmi3Error, "too few bytes for a state");
    memcpy(to, TOKEN, sizeof TOKEN);
    memcpy(to + sizeof TOKEN, s, sizeof(Store));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte from[], size_t n, fmi3FMUState *s)
{
    INSTANCE;
    if (n != sizeof TOKEN + sizeof(Store) || memcmp(from, TOKEN, sizeof TOKEN) != 0)
        return say(i, fmi3Error, "these bytes are no state of this FMU");
    if (!*s && !(*s = malloc(sizeof(Store))))
        return say(i, fmi3Error, "no memory");
    memcpy(*s, from + sizeof TOKEN, sizeof(Store));
    return fmi3OK;
}

/* -- Derivatives -- */

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference u[], size_t nu,
    const fmi3ValueReference v[], size_t nv, const fmi3Float64 seed[], size_t ns, fmi3Float64 out[], size_t no)
{
    INSTANCE;
#if HAS_DIRECTIONAL
    double d[DIRECTION] = {0}, dx[NS], dy[K(NY) + 1];
    size_t k;
    fmi3Status status;
    REQUIRE(INITIALIZATION | EVENT | CONTINUOUS | STEP | TERMINATED);
    for (k = 0; k < nv; k++)
        if (v[k] >= VR_X && v[k] < VR_X + NS)
            d[AT_STATE + v[k] - VR_X] += seed[k];
        else if (v[k] >= VR_P && v[k] < VR_X)
            d[AT_PARAMETER + v[k] - VR_P] += seed[k];
        else
            return say(i, fmi3Error, "no derivative by value reference %u", (unsigned)v[k]);
    status = change_along(i, d, dx, dy);
    for (k = 0; k < nu && status == fmi3OK; k++)
        if (u[k] >= VR_X && u[k] < VR_X + NS)
            out[k] = d[AT_STATE + u[k] - VR_X]; /* a state that is the derivative of another one */
        else if (u[k] >= VR_D && u[k] < VR_Y)
            out[k] = dx[u[k] - VR_D];
        else if (u[k] >= VR_Y && u[k] < VR_Z)
            out[k] = dy[u[k] - VR_Y];
        else
            status = say(i, fmi3Error, "no derivative of value reference %u", (unsigned)u[k]);
    return status;
#else
    return say(i, fmi3Error, "no directional derivatives");
#endif
}

/* -- Model Exchange -- */

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *ends,
    fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next)
{
    INSTANCE;
    Store *c = &i->c;
    double before[K(NX)];
    int terminates = 0;
    fmi3Status status;
    *again = *ends = *nominals = *values = *defined = 0;
    REQUIRE(EVENT);
    status = evaluate(i);
    if (status != fmi3OK)
        return status;
    memcpy(before, c->x, sizeof before);
    if (!i->is_co) /* the error of a root finder: some 1e-14 of the time, with room for simple ones */
        status = pass_event(i, 1e-10 * (fabs(c->t) + fabs(c->t - c->s.t_old)), &terminates);
    else if (memcmp(&c->p, &c->s.p, K(NP) * sizeof(double)) != 0)
        status = pass_event(i, 0.0, &terminates); /* doStep has handled all but what was set since */
    *ends = terminates;
    *values = memcmp(before, c->x, NS * sizeof *before) != 0;
    c->s.t_old = c->t;
    if (!i->is_co && status == fmi3OK) {
        *next = M(next_event)(&c->p, &c->s, &i->w);
        *defined = *next < HUGE_VAL;
    }
    return status;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean last, fmi3Boolean *enter, fmi3Boolean *ends)
{
    INSTANCE;
    *enter = *ends = 0;
    REQUIRE(CONTINUOUS);
    *enter = has_drifted(i); /* the event projects */
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 t)
{
    INSTANCE;
    REQUIRE(EVENT | CONTINUOUS);
    if (i->c.t != t)
        i->is_evaluated = 0;
    i->c.t = t;
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 x[], size_t n)
{
    INSTANCE;
    REQUIRE(CONTINUOUS);
    if (n != NS)
        return say(i, fmi3Error, "%d states, not %d", (int)n, (int)NS);
    if (memcmp(i->c.x, x, n * sizeof *x) != 0)
        i->is_evaluated = 0;
    memcpy(i->c.x, x, n * sizeof *x);
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 x[], size_t n)
{
    INSTANCE;
    const fmi3Status status = evaluate(i);
    memcpy(x, i->c.x, n * sizeof *x);
    return status;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 d[], size_t n)
{
    INSTANCE;
    const fmi3Status status = evaluate(i);
    memcpy(d, i->dx, n * sizeof *d);
    return status;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 z[], size_t n)
{
    INSTANCE;
    return indicators(i, z);
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 v[], size_t n)
{
    memcpy(v, nominals_of_states, n * sizeof *v);
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance j, size_t *n) { *n = K(NFREE); return fmi3OK; }
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance j, size_t *n) { *n = NS; return fmi3OK; }
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance j) { return fmi3OK; }

/* -- Co-Simulation -- */

/* Step by step, with a call of the importer after each one; INTERRUPTED after an event. */
static M(status) step_with_updates(Instance *i, double t1, int *early)
{
    M(status) status = K(OK);
    while (i->c.s.t < t1 && good(status) && !*early) {
        fmi3Boolean wanted = 0;
        fmi3Float64 until = t1;
#if NRELATIONS > 0
        const long events = i->c.s.changes;
        status = integrate(i, t1, 1);
        if (good(status) && i->c.s.changes > events && i->uses_events)
            status = K(INTERRUPTED);
#else
        status = integrate(i, t1, 1);
#endif
        if (good(status) || status == K(INTERRUPTED))
            i->update(i->environment, i->c.t, 0, 1, 1, i->may_return_early, &wanted, &until);
        *early = wanted && i->may_return_early && i->c.s.t < t1;
    }
    return status;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from, fmi3Float64 length, fmi3Boolean nosave,
    fmi3Boolean *event_needed, fmi3Boolean *ends, fmi3Boolean *early, fmi3Float64 *reached)
{
    INSTANCE;
    Store *c = &i->c;
    const double t1 = from + length;
    int returns = 0;
    M(status) status;
    *event_needed = *ends = *early = 0;
    *reached = c->s.t;
    REQUIRE(STEP);
    if (fabs(from - c->s.t) > 1e-9 * (fabs(from) + fabs(length)) || !(length > 0.0))
        return say(i, fmi3Error, "doStep from %.17g by %.17g, but the FMU is at %.17g", from, length, c->s.t);
    bind(i);
#if NRELATIONS > 0
    c->o.report = i->uses_events && i->may_return_early;
#endif
    status = i->update ? step_with_updates(i, t1, &returns) : integrate(i, t1, 0);
    *reached = c->s.t;
    *event_needed = status == K(INTERRUPTED); /* it is handled: an impact, a clause `when`, a relation */
    *ends = status == K(TERMINATED);
    *early = returns || (c->s.t < t1 && (*event_needed || *ends));
    if (good(status) || *event_needed || *ends)
        return fmi3OK;
    return fail(i, fmi3Error, status, c->s.culprit, "doStep");
}

/* -- Not provided, as the description says -- */

#define LACKS(name, arguments) \
    fmi3Status name arguments { return say((const Instance *)i, fmi3Error, #name " is not provided"); }
#define REFERENCES fmi3Instance i, const fmi3ValueReference r[], size_t n
LACKS(fmi3EnterConfigurationMode, (fmi3Instance i))
LACKS(fmi3ExitConfigurationMode, (fmi3Instance i))
LACKS(fmi3GetBinary, (REFERENCES, size_t s[], fmi3Binary v[], size_t m))
LACKS(fmi3SetBinary, (REFERENCES, const size_t s[], const fmi3Binary v[], size_t m))
LACKS(fmi3GetClock, (REFERENCES, fmi3Clock v[]))
LACKS(fmi3SetClock, (REFERENCES, const fmi3Clock v[]))
LACKS(fmi3GetNumberOfVariableDependencies, (fmi3Instance i, fmi3ValueReference r, size_t *n))
LACKS(fmi3GetVariableDependencies, (fmi3Instance i, fmi3ValueReference r, size_t a[], fmi3ValueReference b[],
    size_t c[], fmi3DependencyKind d[], size_t n))
LACKS(fmi3GetAdjointDerivative, (REFERENCES, const fmi3ValueReference k[], size_t a, const fmi3Float64 s[], size_t b,
    fmi3Float64 v[], size_t c))
LACKS(fmi3GetOutputDerivatives, (REFERENCES, const fmi3Int32 o[], fmi3Float64 v[], size_t m))
LACKS(fmi3ActivateModelPartition, (fmi3Instance i, fmi3ValueReference r, fmi3Float64 t))
LACKS(fmi3GetIntervalDecimal, (REFERENCES, fmi3Float64 v[], fmi3IntervalQualifier q[]))
LACKS(fmi3GetIntervalFraction, (REFERENCES, fmi3UInt64 a[], fmi3UInt64 b[], fmi3IntervalQualifier q[]))
LACKS(fmi3GetShiftDecimal, (REFERENCES, fmi3Float64 v[]))
LACKS(fmi3GetShiftFraction, (REFERENCES, fmi3UInt64 a[], fmi3UInt64 b[]))
LACKS(fmi3SetIntervalDecimal, (REFERENCES, const fmi3Float64 v[]))
LACKS(fmi3SetIntervalFraction, (REFERENCES, const fmi3UInt64 a[], const fmi3UInt64 b[]))
LACKS(fmi3SetShiftDecimal, (REFERENCES, const fmi3Float64 v[]))
LACKS(fmi3SetShiftFraction, (REFERENCES, const fmi3UInt64 a[], const fmi3UInt64 b[]))
