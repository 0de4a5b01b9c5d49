/* -- one step after the other --
 * Step control: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential
 * Equations I, Springer 1993, sections II.4 and II.10. */

/* Where a rate, or the dense output, is to be found. */
#define LAGC_NOWHERE 0
#define LAGC_STAGES 1 /* a rate: the first of them */
#define LAGC_READY 2  /* a rate: the last of the stages */

lagc_options lagc_default_options(void)
{
    lagc_options o;
    o.method = LAGC_DOP853;
    o.project = 1;
    o.max_steps = 100000000;
    o.rtol = 1e-9;
    o.atol = 0.0;
    o.step = 0.0;
    o.first_step = 0.0;
    o.max_step = 0.0;
    return o;
}

size_t lagc_work_size(void) { return sizeof(lagc_work); }

size_t lagc_state_size(void) { return sizeof(lagc_state); }

void lagc_begin(lagc_state *s, double t, const double *x)
{
    int i;
    s->t = t;
    s->t_old = t;
    s->t_seen = t;
    for (i = 0; i < LAGC_NX; i++) {
        s->x[i] = x[i];
        s->x_old[i] = x[i];
        s->x_seen[i] = x[i];
    }
    for (i = 0; i < LAGC_KINDS; i++)
        s->sizes[i] = 0.0;
    lagc_enlarge(x, s->sizes);
    s->h_old = 0.0;
    s->h = 0.0;
    s->error_old = 1e-4;
    s->grid = t;
    s->stride = 0.0;
    s->position_drift = 0.0;
    s->velocity_drift = 0.0;
    s->on_grid = 0;
    s->steps = 0;
    s->rejected = 0;
    s->rhs = 0;
    s->entered = 0;
    s->called = 1;
    s->method = LAGC_DOP853;
    s->rate = LAGC_NOWHERE;
    s->dense = LAGC_NOWHERE;
#if LAGC_NC
    s->lost = 0;
#endif
    s->listening = 0;
    s->recalled = 0.0;
    for (i = 0; i < LAGC_NX; i++)
        s->noise[i] = 0.0;
    s->longest = 0.0;
    s->culprit = -1;
}

/* What a call finds: the workspace as this state left its own. */
static void lagc_enter(lagc_state *s, lagc_work *w)
{
    s->called = 1;
    s->entered = s->steps + s->rejected;
#if LAGC_NC
    w->lost = s->lost;
#else
    (void)w;
#endif
}

/* What a call leaves: where the last step ended. */
static lagc_status lagc_leave(lagc_state *s, int status, const lagc_work *w)
{
    int i;
    if (status != LAGC_OK && status != LAGC_INTERRUPTED)
        s->rate = LAGC_NOWHERE;
    if (!s->called) {
        s->t_seen = s->t;
        for (i = 0; i < LAGC_NX; i++)
            s->x_seen[i] = s->x[i];
    }
#if LAGC_NC
    s->lost = w->lost;
#else
    (void)w;
#endif
    return (lagc_status)status;
}

/* What the caller has changed since the last step: 0 nothing, 1 parameters, 2 the state. */
static int lagc_changed(const lagc_params *p, const lagc_state *s)
{
    const double *now = (const double *)p, *before = (const double *)&s->p; /* they are all doubles */
    size_t k;
    int i;
    if (s->h == 0.0 || s->t != s->t_seen)
        return 2;
    for (i = 0; i < LAGC_NX; i++)
        if (!(s->x[i] == s->x_seen[i]))
            return 2;
    if (s->rate == LAGC_NOWHERE)
        return 1;
    for (k = 0; k < sizeof *p / sizeof *now; k++)
        if (!(now[k] == before[k]))
            return 1;
    return 0;
}

static int lagc_stop(lagc_state *s, int status, const lagc_work *w)
{
    if (LAGC_FAILED(status) && status < LAGC_STEP_UNDERFLOW)
        s->culprit = w->culprit;
    return status;
}

/* Project the new state and evaluate there. */
static int lagc_arrive(const lagc_params *p, lagc_state *s, double t, const lagc_options *o,
                       double *rate, lagc_work *w)
{
#if LAGC_NC || LAGC_NQUAT
    if (o->project) {
        double position, velocity;
        const int status = lagc_project(p, t, s->y, w->reached, &position, &velocity, w);
        if (LAGC_FAILED(status))
            return status;
        if (position > s->position_drift)
            s->position_drift = position;
        if (velocity > s->velocity_drift)
            s->velocity_drift = velocity;
    }
#else
    (void)o;
#endif
    s->rhs++;
    return lagc_rhs_(p, t, s->y, rate, w->lam, w);
}

/* The size of the next step. */
static void lagc_adapt(lagc_state *s, int method, double size, double error, int lands, int rejected)
{
    const double most = method == LAGC_DOPRI5 ? 1.0 / 0.2 : 1.0 / 0.333;
    const double least = method == LAGC_DOPRI5 ? 1.0 / 10.0 : 1.0 / 6.0;
    double factor = pow(error, method == LAGC_DOPRI5 ? 0.17 : 0.125);
    double following;
    if (method == LAGC_DOPRI5) {
        factor /= pow(s->error_old, 0.04);
        s->error_old = error > 1e-4 ? error : 1e-4;
    }
    factor /= 0.9;
    if (factor > most)
        factor = most;
    if (factor < least)
        factor = least;
    following = size / factor;
    if (rejected && following > size)
        following = size;
    if (lands && !rejected && following < s->h)
        following = s->h; /* the step was short only to land */
    s->h = following;
}

static int lagc_step_(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o, lagc_work *w)
{
    const int method = o->method, last = method == LAGC_DOPRI5 ? 6 : 12;
    const double direction = t1 >= s->t ? 1.0 : -1.0, rest = fabs(t1 - s->t);
    const int change = s->called ? lagc_changed(p, s) : 0;
    double size, h, t_new, error = 0.0;
    int i, status, cause = LAGC_OK, rejected = 0, heard = 0, lands;
    if (s->dense == LAGC_STAGES)
        s->dense = LAGC_NOWHERE; /* other stages take their place */
    if (change) {
        if (change == 2) {
            s->stride = 0.0;
            s->recalled = 0.0;
            lagc_enlarge(s->x, s->sizes);
#if LAGC_NC
            w->lost = 0;
#if LAGC_STRAIGHT
            (void)lagc_factor_dense(p, s->t, s->x, w); /* straight factors need not show dependent rows */
            w->fallbacks--;
#endif
#endif
        }
        status = lagc_rhs_(p, s->t, s->x, s->k[0], w->lam, w);
        s->rhs++;
        if (LAGC_FAILED(status))
            return lagc_stop(s, status, w);
    } else if (s->rate == LAGC_READY) {
        const double *reached = s->k[s->method == LAGC_DOPRI5 ? 6 : 12];
        for (i = 0; i < LAGC_NX; i++)
            s->k[0][i] = reached[i];
    }
    s->rate = LAGC_STAGES;
    if (s->h == 0.0) {
        if (o->step > 0.0)
            s->h = o->step;
        else if (o->first_step > 0.0)
            s->h = o->first_step;
        else
            s->h = lagc_first_step(p, s, t1, direction, o, w);
    }
    if (o->step > 0.0 && s->stride != o->step * direction) { /* the grid begins here */
        s->stride = o->step * direction;
        s->grid = s->t;
        s->on_grid = 0;
    }
    lagc_forget(s, w);
    size = s->h;
    if (o->max_step > 0.0 && size > o->max_step)
        size = o->max_step;
    for (;;) {
        if (o->max_steps > 0 && s->steps + s->rejected - s->entered >= o->max_steps) {
            if (rejected)
                s->h = size;
            return LAGC_MAX_STEPS;
        }
        lands = size * 1.01 >= rest;
        t_new = t1;
        if (o->step > 0.0) {
            t_new = s->grid + (double)(s->on_grid + 1) * o->step * direction;
            lands = (t_new - t1) * direction >= -1e-9 * o->step;
            size = fabs(t_new - s->t);
        }
        if (lands) {
            size = rest;
            t_new = t1;
            h = t1 - s->t;
        } else {
            h = size * direction;
            if (!(o->step > 0.0))
                t_new = s->t + h;
        }
        if (!rejected && size > s->longest)
            s->longest = size;
        w->longest = rejected ? s->longest : 0.0;
        if ((rejected || !lands) && 0.1 * size <= 2.3e-16 * fabs(s->t) + 1e-40 * rest)
            return lagc_stop(s, cause != LAGC_OK ? cause : LAGC_STEP_UNDERFLOW, w);
        status = method == LAGC_DOPRI5 ? lagc_dopri5_stages(p, s->t, s->x, h, s, w)
                                       : lagc_dop853_stages(p, s->t, s->x, h, s, w);
        s->rhs += last - 1;
        error = 0.0;
        if (!LAGC_FAILED(status))
            lagc_weights(s, o, h, w);
        if (!LAGC_FAILED(status) && (method == LAGC_DOPRI5 || o->step > 0.0))
            status = lagc_arrive(p, s, t_new, o, s->k[last], w);
        if (!LAGC_FAILED(status) && !(o->step > 0.0)) {
            error = method == LAGC_DOPRI5 ? lagc_dopri5_error(h, s, w) : lagc_dop853_error(h, s, w);
            heard = error > 1.0 && (rejected || s->listening || s->recalled > 0.0);
            if (heard)
                error = lagc_reconsider(p, s, t_new, h, o, error, rejected, w);
            if (error != error) {
                status = LAGC_NOT_FINITE;
                w->culprit = lagc_not_finite(s->y, LAGC_NX);
            } else if (error <= 1.0 && method != LAGC_DOPRI5) {
                status = lagc_arrive(p, s, t_new, o, s->k[last], w);
            }
        }
        if (LAGC_FAILED(status)) {
            if (o->step > 0.0)
                return lagc_stop(s, status, w);
            cause = status;
            size *= 0.25;
        } else if (error <= 1.0) {
            break;
        } else {
            const double most = method == LAGC_DOPRI5 ? 1.0 / 0.2 : 1.0 / 0.333;
            const double factor = pow(error, method == LAGC_DOPRI5 ? 0.17 : 0.125) / 0.9;
            cause = LAGC_OK;
            size /= factor < most ? factor : most;
        }
        rejected++;
        s->rejected++;
    }
    if (o->step > 0.0) {
        s->grid = lands ? t1 : s->grid;
        s->on_grid = lands ? 0 : s->on_grid + 1;
    } else {
        s->stride = 0.0;
        lagc_adapt(s, method, size, error, lands, rejected);
    }
    if (s->called) {
        s->p = *p;
        s->called = 0;
    }
    s->method = method;
    s->steps++;
    s->t_old = s->t;
    s->h_old = h;
    s->t = t_new;
    for (i = 0; i < LAGC_NX; i++) {
        s->x_old[i] = s->x[i];
        s->x[i] = s->y[i];
    }
    lagc_enlarge(s->y, s->sizes);
    s->listening = heard;
    s->rate = LAGC_READY;
    s->dense = LAGC_STAGES;
    return LAGC_OK;
}
