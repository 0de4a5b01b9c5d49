/* An instance of an FMU: a model, its state, and what an importer has set.  FMI 3.0 and 2.0 share it.
 *
 * The text is the same for every model.  lagc_model.h, which is generated, has what differs: M(name) and K(NAME)
 * spell names of the model's code. */
#ifndef LAGC_INSTANCE_H
#define LAGC_INSTANCE_H

#include "lagc_model.h"
#include "fmi3Functions.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NS = K(NQ) + K(NV) }; /* continuous states: the first of x */
enum { /* first value reference of each kind of variable; 0 is the time */
    VR_P = 1,                /* parameters, then inputs */
    VR_X = VR_P + K(NP),     /* states, then discrete variables */
    VR_D = VR_X + K(NX),     /* derivatives of the states */
    VR_Y = VR_D + NS,        /* outputs */
    VR_Z = VR_Y + K(NY),     /* event indicators */
    VR_END = VR_Z + K(NFREE)
};
enum { INSTANTIATED = 1, INITIALIZATION = 2, EVENT = 4, CONTINUOUS = 8, STEP = 16, TERMINATED = 32 };

typedef struct { /* what a copy of the state of the FMU holds: plain data, no pointers */
    M(params) p;
    M(options) o;
    M(state) s;
    double x[K(NX)];            /* at the time t of the importer; s.t is that of the last event or step */
    double t;
    double given[NS];           /* start values that were set */
    unsigned char is_given[NS];
    int is_bound, is_started, mode;
    double tolerance;           /* of the importer's integrator */
} Store;

typedef struct {
    Store c;
    M(work) w;
    M(start_work) start;
    int is_evaluated, has_outputs; /* dx and lam are those of c, y is */
    double dx[K(NX)], y[K(NY) + 1], lam[K(NC) + 1];
    int is_co, uses_events, may_return_early, is_loud;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
    fmi3IntermediateUpdateCallback update;
} Instance;

static fmi3Status say(const Instance *i, fmi3Status status, const char *format, ...)
{
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (i->log && (i->is_loud || status >= fmi3Error))
        i->log(i->environment, status, status >= fmi3Error ? "logStatusError" : "logStatusWarning", text);
    return status;
}

/* The name of entry k of an array: "params", "x" or "lambda". */
static const char *name_of(const char *record, int k)
{
    const M(member) *m;
    for (m = M(members)(); m->name; m++)
        if (strcmp(m->record, record) == 0 && k-- == 0)
            return m->name;
    return "the model";
}

/* What the culprit of a status refers to; see the enumeration of statuses in the header of the model. */
static const char *culprit_name(M(status) status, int k)
{
    if (status == K(INVALID))
        return k >= K(BAD_PARAMETER) ? name_of("params", k - K(BAD_PARAMETER)) : "an option, the time or a bound";
    if (k < 0)
        return "the model";
    return status == K(SINGULAR_MASS) ? name_of("x", K(NQ) + k) : name_of(status == K(NOT_FINITE) ? "x" : "lambda", k);
}

static fmi3Status fail(const Instance *i, fmi3Status as, M(status) status, int culprit, const char *where)
{
    return say(i, as, "%s at t = %.17g: %s (%s)", where, i->c.t, M(status_text)(status), culprit_name(status, culprit));
}

static int good(M(status) status) { return status == K(OK) || status == K(REDUNDANT); }

static void reset(Instance *i)
{
    memset(&i->c, 0, sizeof i->c);
    memset(&i->w, 0, sizeof i->w);
    i->c.p = M(default_params)();
    i->c.o = M(default_options)();
    i->c.tolerance = 1e-6;
    i->c.mode = INSTANTIATED;
    i->is_evaluated = 0;
}

static Instance *instantiate(const char *token, int is_loud, fmi3InstanceEnvironment e, fmi3LogMessageCallback log)
{
    Instance *i;
    if (!token || strcmp(token, TOKEN) != 0) {
        if (log)
            log(e, fmi3Error, "logStatusError", "the instantiation token is not that of this FMU");
        return NULL;
    }
    i = (Instance *)calloc(1, sizeof *i);
    if (i) {
        i->environment = e;
        i->log = log;
        i->is_loud = is_loud;
        reset(i);
    }
    return i;
}

static void bind(Instance *i)
{
    if (!i->c.is_bound)
        M(bind)(&i->c.p);
    i->c.is_bound = 1;
}

/* Let what is due at the importer's time and state happen.  A root finder may stop so much before a root. */
static fmi3Status pass_event(Instance *i, double time_error, int *ends)
{
    Store *c = &i->c;
    M(status) status;
    bind(i);
    status = M(event)(&c->p, &c->s, c->t, c->x, time_error, i->is_co ? 0.0 : c->tolerance, &i->w);
    i->is_evaluated = 0;
    *ends = status == K(TERMINATED);
    return good(status) || *ends ? fmi3OK : fail(i, fmi3Error, status, c->s.culprit, "event");
}

/* Find the initial state from parameters, start values that were set, and the equations of the model. */
static fmi3Status start(Instance *i)
{
    Store *c = &i->c;
    M(status) status;
    int levels[sizeof start_levels / sizeof *start_levels], k, culprit = -1, ends;
    bind(i);
    status = M(check)(&c->p, &c->o, &culprit);
    if (!good(status))
        return fail(i, fmi3Error, status, culprit, "parameters");
    M(start)(&c->p, c->x);
    memcpy(levels, start_levels, sizeof levels);
    for (k = 0; k < NS; k++)
        if (c->is_given[k]) {
            c->x[k] = c->given[k];
            levels[k] = K(FIXED);
        }
    status = M(consistent)(&c->p, c->t, c->x, levels, &i->start);
    if (!good(status))
        return fail(i, fmi3Error, status, i->start.culprit, "initial values");
    M(begin)(&c->s, c->t, c->x);
    c->is_started = 1;
    return pass_event(i, 0.0, &ends); /* contacts act, and the modes are found */
}

/* Have rates and multipliers at the importer's time and state, in the modes that the last event left. */
static fmi3Status evaluate(Instance *i)
{
    Store *c = &i->c;
    M(status) status;
    if (!c->is_started) {
        const fmi3Status begun = start(i);
        if (begun != fmi3OK)
            return begun;
    }
    bind(i);
    if (i->is_evaluated)
        return fmi3OK;
    M(hold_modes)(&c->s, &i->w);
    status = M(rhs)(&c->p, c->t, c->x, i->dx, i->lam, &i->w);
    if (!good(status))
        return fail(i, fmi3Discard, status, i->w.culprit, "evaluation");
    i->is_evaluated = 1;
    i->has_outputs = 0;
    return fmi3OK;
}

static fmi3Status evaluate_outputs(Instance *i)
{
    M(status) status;
    const fmi3Status ready = evaluate(i);
    if (ready != fmi3OK || i->has_outputs)
        return ready;
    M(hold_modes)(&i->c.s, &i->w);
    status = M(outputs)(&i->c.p, i->c.t, i->c.x, i->y, &i->w);
    i->has_outputs = good(status);
    return good(status) ? fmi3OK : fail(i, fmi3Discard, status, i->w.culprit, "outputs");
}

static fmi3Status indicators(Instance *i, double *z)
{
    M(status) status;
    const fmi3Status ready = evaluate(i);
    if (ready != fmi3OK)
        return ready;
    status = M(indicators)(&i->c.p, &i->c.s, i->c.t, i->c.x, z, &i->w);
    return good(status) ? fmi3OK : fail(i, fmi3Discard, status, i->w.culprit, "event indicators");
}

/* Whether the importer's integrator has drifted from the constraints by a tenth of its tolerance. */
static int has_drifted(Instance *i)
{
    Store *c = &i->c;
    double x[K(NX)];
    int k;
    memcpy(x, c->x, sizeof x);
    if (good(M(project_state)(&c->p, &c->s, c->t, x, &i->w)))
        for (k = 0; k < NS; k++)
            if (fabs(x[k] - c->x[k]) > 0.1 * c->tolerance * c->s.sizes[scaling_groups[k]])
                return 1;
    return 0;
}

/* One call of the integrator towards t1, at most to it. */
static M(status) integrate(Instance *i, double t1, int one_step)
{
    Store *c = &i->c;
    const M(status) status = one_step ? M(step)(&c->p, &c->s, t1, &c->o, &i->w) : M(advance)(&c->p, &c->s, t1, &c->o, &i->w);
    c->t = c->s.t;
    memcpy(c->x, c->s.x, sizeof c->x);
    i->is_evaluated = 0;
    return status;
}

#if HAS_DIRECTIONAL
/* Solve M s1 - G^T s2 = r1, G s1 = r2 at the importer's state. */
static int solve_motion(Instance *i, double *r, double *s)
{
#if HAS_SOLVE
    if (!good(M(assemble)(&i->c.p, i->c.t, i->c.x, &i->w)))
        return 0;
    M(solve)(r, s, &i->w);
#else /* Gauss elimination without pivots: a mass matrix is positive definite */
    enum { N = K(NV) };
    double A[N * N];
    int j, k, m;
    M(mass_matrix)(&i->c.p, i->c.t, i->c.x, A, &i->w);
    memcpy(s, r, N * sizeof *s);
    for (k = 0; k < N; k++) {
        if (!(A[k * N + k] > 0.0))
            return 0;
        for (j = k + 1; j < N; j++) {
            const double factor = A[j * N + k] / A[k * N + k];
            for (m = k; m < N; m++)
                A[j * N + m] -= factor * A[k * N + m];
            s[j] -= factor * s[k];
        }
    }
    for (k = N - 1; k >= 0; k--) {
        for (m = k + 1; m < N; m++)
            s[k] -= A[k * N + m] * s[m];
        s[k] /= A[k * N + k];
    }
#endif
    return 1;
}

enum { /* places in a direction, see along() of the model */
    AT_STATE = 1, AT_MOTION = AT_STATE + NS, AT_PARAMETER = AT_MOTION + K(NV) + K(NC), DIRECTION = AT_PARAMETER + K(NP)
};

/* Changes of rates and outputs along a direction d of states and parameters: da and dlam from
 * M da - G^T dlam = d(force - M a), G da = -d(G a - gamma). */
static fmi3Status change_along(Instance *i, double *d, double *dx, double *dy)
{
    Store *c = &i->c;
    double change[K(D_END)], r[K(NV) + K(NC)];
    int k;
    const fmi3Status ready = evaluate(i);
    if (ready != fmi3OK)
        return ready;
    M(along)(&c->p, c->t, c->x, i->dx + K(NQ), i->lam, d, change);
    for (k = 0; k < K(NV); k++)
        r[k] = change[K(D_FORCE) + k] - change[K(D_INERTIA) + k];
    for (k = 0; k < K(NC); k++)
        r[K(NV) + k] = -change[K(D_ROW) + k];
    if (!solve_motion(i, r, d + AT_MOTION))
        return say(i, fmi3Discard, "the equations cannot be solved for directional derivatives");
    M(along)(&c->p, c->t, c->x, i->dx + K(NQ), i->lam, d, change);
    memcpy(dx, change + K(D_QDOT), K(NQ) * sizeof *dx);
    memcpy(dx + K(NQ), d + AT_MOTION, K(NV) * sizeof *dx);
    memcpy(dy, change + K(D_OUTPUT), K(NY) * sizeof *dy);
    return fmi3OK;
}
#endif

#endif /* LAGC_INSTANCE_H */
