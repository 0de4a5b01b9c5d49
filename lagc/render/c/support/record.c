/* -- trajectories -- */

/* The stages of the last step once more: those of an attempt that failed have taken their place. */
static int lagc_repeat(lagc_state *s, double t, const double *x, lagc_work *w)
{
    const int last = s->method == LAGC_DOPRI5 ? 6 : 12;
    int status = lagc_rhs_(&s->p, s->t_old, s->x_old, s->k[0], w->lam, w);
    s->rate = LAGC_NOWHERE;
    s->rhs += last + 1;
    if (!LAGC_FAILED(status))
        status = last == 6 ? lagc_dopri5_stages(&s->p, s->t_old, s->x_old, s->h_old, s, w)
                           : lagc_dop853_stages(&s->p, s->t_old, s->x_old, s->h_old, s, w);
    if (!LAGC_FAILED(status))
        status = lagc_rhs_(&s->p, t, x, s->k[last], w->lam, w);
    return status;
}

/* The coefficients of dense output of the last step, with its parameters and its end, whatever the
 * caller has changed since. */
static int lagc_interpolate(lagc_state *s, lagc_work *w)
{
    const double t = s->called ? s->t_seen : s->t;
    const double *x = s->called ? s->x_seen : s->x;
    int status = LAGC_OK;
    if (s->dense == LAGC_NOWHERE)
        status = lagc_repeat(s, t, x, w);
    if (LAGC_FAILED(status))
        return status;
    if (s->method == LAGC_DOPRI5)
        return lagc_dopri5_dense(&s->p, s->t_old, s->x_old, x, s->h_old, s, w);
    s->rhs += 3;
    return lagc_dop853_dense(&s->p, s->t_old, s->x_old, x, s->h_old, s, w);
}

static int lagc_dense_(lagc_state *s, double t, const lagc_options *o, double *x, lagc_work *w)
{
    int i, status;
    if (t == s->t || s->h_old == 0.0) {
        for (i = 0; i < LAGC_NX; i++)
            x[i] = s->x[i];
        return LAGC_OK;
    }
    if (s->dense != LAGC_READY) {
        status = lagc_interpolate(s, w);
        if (LAGC_FAILED(status))
            return lagc_stop(s, status, w);
        s->dense = LAGC_READY;
    }
    if (s->method == LAGC_DOPRI5)
        lagc_dopri5_at((t - s->t_old) / s->h_old, s, x);
    else
        lagc_dop853_at((t - s->t_old) / s->h_old, s, x);
#if LAGC_NC || LAGC_NQUAT
    if (o->project) {
        double position, velocity;
        status = lagc_project(&s->p, t, x, s->sizes, &position, &velocity, w);
        if (LAGC_FAILED(status))
            return lagc_stop(s, status, w);
    }
#else
    (void)o;
#endif
    return LAGC_OK;
}

/* Whether t is a time of the last step, but for rounding. */
static int lagc_within(const lagc_state *s, double t)
{
    const double part = (t - s->t_old) / s->h_old;
    return t == s->t || (part >= -1e-9 && part <= 1.0 + 1e-9);
}

lagc_status lagc_dense(const lagc_params *p, lagc_state *s, double t, const lagc_options *o,
                       double *x, lagc_work *w)
{
    int status;
    (void)p;
    if (!lagc_within(s, t)) {
        s->culprit = LAGC_BAD_TIME;
        return LAGC_INVALID;
    }
    lagc_enter(s, w);
    status = lagc_dense_(s, t, o, x, w);
    if (status == LAGC_OK && lagc_not_finite(x, LAGC_NX) >= 0) {
        s->culprit = lagc_not_finite(x, LAGC_NX);
        status = LAGC_NOT_FINITE;
    }
#if LAGC_NC
    s->lost = w->lost;
#endif
    return (lagc_status)status;
}

lagc_status lagc_step(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o,
                      lagc_work *w)
{
    const int status = lagc_demand(p, s, t1, o);
    if (status != LAGC_OK)
        return (lagc_status)status;
    lagc_enter(s, w);
    return lagc_leave(s, lagc_step_(p, s, t1, o, w), w);
}

lagc_status lagc_advance(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o,
                         lagc_work *w)
{
    int status = lagc_demand(p, s, t1, o);
    if (status != LAGC_OK)
        return (lagc_status)status;
    lagc_enter(s, w);
    while (status == LAGC_OK && s->t != t1)
        status = lagc_step_(p, s, t1, o, w);
    return lagc_leave(s, status, w);
}

/* Whether times are in order from s->t on: asked once, of a grid of which nothing is done. */
static int lagc_in_order(const lagc_state *s, const double *times, size_t n, double direction)
{
    double before = s->t;
    size_t k;
    for (k = 0; k < n; k++) {
        if (!((times[k] - before) * direction >= 0.0))
            return 0;
        before = times[k];
    }
    return 1;
}

lagc_status lagc_record(const lagc_params *p, lagc_state *s, const lagc_options *o,
                        const double *times, size_t n, double *states, size_t *done, long budget,
                        lagc_work *w)
{
    const double t1 = n > 0 ? times[n - 1] : s->t;
    const double direction = t1 >= s->t ? 1.0 : -1.0;
    int status = lagc_demand(p, s, t1, o);
    long count = 0;
    if (status != LAGC_OK)
        return (lagc_status)status;
    if (budget < 0 || *done > n || (*done == 0 && !lagc_in_order(s, times, n, direction))) {
        s->culprit = budget < 0 ? LAGC_BAD_BUDGET : LAGC_BAD_TIME;
        return LAGC_INVALID;
    }
    lagc_enter(s, w);
    while (status == LAGC_OK) {
        while (status == LAGC_OK && *done < n && (times[*done] - s->t) * direction <= 0.0) {
            status = lagc_dense_(s, times[*done], o, states + *done * LAGC_NX, w);
            if (status == LAGC_OK)
                *done += 1;
        }
        if (status != LAGC_OK || *done == n)
            break;
        if (budget > 0 && count == budget)
            status = LAGC_INTERRUPTED;
        else
            status = lagc_step_(p, s, t1, o, w);
        count++;
    }
    return lagc_leave(s, status, w);
}
