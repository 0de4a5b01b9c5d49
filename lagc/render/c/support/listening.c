/* -- what of the error of a step that was rejected is rounding -- */

/* What is left of rounding that made a step good after a step as long as any so far, and what is so
 * little of it that it is forgotten. */
#define LAGC_FADING 0.9
#define LAGC_FORGOTTEN 0.03

/* Of its size, an error with which a state is not told at all. */
#define LAGC_LOST 1e-4

/* Time, state x[] and parameters changed by four units of their last place, another way for each turn;
 * the time. */
static double lagc_shaken(const lagc_params *p, const lagc_state *s, double *x, lagc_params *other)
{
    const double way[2] = {1.0 + 8.881784197001252e-16, 1.0 - 8.881784197001252e-16};
    const long turn = 2 * s->rejected + 3;
    const size_t count = sizeof(lagc_params) / sizeof(double);
    double *values = (double *)other; /* it holds nothing else */
    size_t j;
    int i, n = LAGC_NQ + LAGC_NV;
    *other = *p;
    for (i = 0; i < LAGC_NX; i++)
        x[i] = s->x[i];
    for (i = 0; i < n; i++)
        x[i] *= way[((i + 1) * turn >> 1) & 1];
    for (j = 0; j < count; j++)
        values[j] *= way[((n + (long)j + 1) * turn >> 1) & 1];
    return s->t * way[turn >> 1 & 1];
}

/* Raise s->noise to how far rates are apart. */
static void lagc_hear(const double *one, const double *other, lagc_state *s)
{
    int i;
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++)
        if (fabs(one[i] - other[i]) > s->noise[i])
            s->noise[i] = fabs(one[i] - other[i]);
}

/* Raise s->noise to what rounding may change in the rates s->k[0]: to what changes when all is shaken. */
static void lagc_listen(const lagc_params *p, lagc_state *s, lagc_work *w)
{
    double x[LAGC_NX];
    lagc_params other;
    const double t = lagc_shaken(p, s, x, &other);
    s->rhs++;
    if (!LAGC_FAILED(lagc_rhs_(&other, t, x, w->xdot, w->lam, w)))
        lagc_hear(w->xdot, s->k[0], s);
}

/* The same in all rates along the step over h that was tried: what is rounding now and then need not be
 * so at the start, and what changes there moves the state along the step. */
static void lagc_listen_along(const lagc_params *p, lagc_state *s, double h, int method, lagc_work *w)
{
    const int last = method == LAGC_DOPRI5 ? 6 : 12;
    double x[LAGC_NX];
    lagc_params other;
    const double t = lagc_shaken(p, s, x, &other);
    int i, k, status;
    for (i = 0; i < LAGC_NX; i++)
        w->kept[last][i] = s->y[i];
    for (k = 0; k < last; k++)
        for (i = 0; i < LAGC_NX; i++)
            w->kept[k][i] = s->k[k][i];
    s->rhs += last;
    status = lagc_rhs_(&other, t, x, s->k[0], w->lam, w);
    if (!LAGC_FAILED(status))
        status = method == LAGC_DOPRI5 ? lagc_dopri5_stages(&other, t, x, h, s, w)
                                       : lagc_dop853_stages(&other, t, x, h, s, w);
    if (!LAGC_FAILED(status))
        for (k = 0; k < last; k++)
            lagc_hear(s->k[k], w->kept[k], s);
    for (k = 0; k < last; k++)
        for (i = 0; i < LAGC_NX; i++)
            s->k[k][i] = w->kept[k][i];
    for (i = 0; i < LAGC_NX; i++)
        s->y[i] = w->kept[last][i];
}

#if LAGC_NH
/* The norm of an error with such parts; see lagc_dop853_error. */
static double lagc_parts_norm(double h, double (*parts)[LAGC_NX], const lagc_work *w)
{
    const int n = LAGC_NQ + LAGC_NV;
    double sums[2], e, total;
    int i, k;
    for (k = 0; k < 2; k++) {
        sums[k] = 0.0;
        for (i = 0; i < n; i++) {
            e = parts[k][i] / w->weights[i];
            sums[k] += e * e;
        }
    }
    total = sums[0] + 0.01 * sums[1];
    if (total == 0.0)
        return 0.0;
    return fabs(h) * sums[0] * sqrt(1.0 / (n * total));
}

/* Whether rows are all but dependent within the way of the step over h that was tried, or a thousandth of
 * the way that the coordinates have to where they are zero.  Coordinates of a kind that have moved by no
 * more than what projection leaves are rounding: w->play. */
static int lagc_all_but_dependent(const lagc_params *p, const lagc_state *s, double h, lagc_work *w)
{
    double moved[LAGC_KINDS], left[LAGC_KINDS];
    int i, k;
    if (!lagc_nudge(p, s->t, s->x, s->sizes, w))
        return 0;
    for (k = 0; k < LAGC_KINDS; k++) {
        moved[k] = 0.0;
        left[k] = 0.0;
    }
    for (i = 0; i < LAGC_NQ; i++) {
        k = lagc_kinds[i];
        if (fabs(s->y[i] - s->x[i]) > moved[k])
            moved[k] = fabs(s->y[i] - s->x[i]);
        if (fabs(w->nudged[i] - s->x[i]) > left[k])
            left[k] = fabs(w->nudged[i] - s->x[i]);
    }
    for (i = 0; i < LAGC_NQ; i++)
        if (left[lagc_kinds[i]] > w->reached[lagc_kinds[i]])
            w->play[i] = left[lagc_kinds[i]] / fabs(h);
    for (k = 0; k < LAGC_KINDS; k++) {
        const double reach = k == 0 && w->reached[k] > 1.0 ? 1.0 : w->reached[k];
        if (left[k] > reach)
            continue;
        if (left[k] * moved[k] > 3e-15 * reach * reach || left[k] > 1e-12 * reach)
            return 1;
    }
    return 0;
}

/* There, a step of DOP853 to t, rejected because of `error`, once more from a state moved by what
 * projection leaves.  Where the error changes by it, it tells of rounding: near postures where rows
 * are all but dependent their multipliers are little else, and no step would be small enough.  Then
 * only what projection does not take from the error counts. */
static double lagc_second_look(const lagc_params *p, lagc_state *s, double t, double h, double error,
                               lagc_work *w)
{
    double change;
    int i, k, status;
    lagc_dop853_parts(s, w);
    for (k = 0; k < 2; k++)
        for (i = 0; i < LAGC_NX; i++)
            w->other[k][i] = w->parts[k][i];
    s->rhs += 11;
    status = lagc_dop853_stages(p, s->t, w->nudged, h, s, w);
    if (LAGC_FAILED(status))
        return error;
    lagc_dop853_parts(s, w);
    for (k = 0; k < 2; k++)
        for (i = 0; i < LAGC_NX; i++)
            w->other[k][i] -= w->parts[k][i];
    change = lagc_parts_norm(h, w->other, w);
    if (!(change > 0.1 * lagc_parts_norm(h, w->parts, w)))
        return error;
    s->rhs += 11;
    (void)lagc_dop853_stages(p, s->t, s->x, h, s, w); /* the step as it was */
    lagc_dop853_parts(s, w);
    if (!lagc_tangents(p, t, s->y, w))
        return error;
    return lagc_parts_norm(h, w->parts, w);
}
#endif

/* Before a step: what is left of the rounding that was heard, after the step before. */
static void lagc_forget(lagc_state *s, lagc_work *w)
{
    const double left = s->longest > 0.0 ? 1.0 - (1.0 - LAGC_FADING) * fabs(s->h_old) / s->longest : 0.0;
    int i;
    s->recalled *= left;
    if (s->recalled < LAGC_FORGOTTEN)
        s->recalled = 0.0;
    for (i = 0; i < LAGC_NX; i++) {
        s->noise[i] = s->recalled > 0.0 ? left * s->noise[i] : 0.0;
        w->play[i] = 0.0;
    }
}

/* That of the step over h, with the rounding that was heard. */
static double lagc_error(const lagc_state *s, const lagc_options *o, double h, lagc_work *w)
{
    lagc_weights(s, o, h, w);
    return o->method == LAGC_DOPRI5 ? lagc_dopri5_error(h, s, w) : lagc_dop853_error(h, s, w);
}

/* An error that rejects a step another time, or after steps that went by this, less what rounding
 * contributes: as it is told at the start, and, where that tells too little, along the step. */
static double lagc_reconsider(const lagc_params *p, lagc_state *s, double t, double h,
                              const lagc_options *o, double error, int rejected, lagc_work *w)
{
    const double before = error;
#if LAGC_NH
    if (lagc_all_but_dependent(p, s, h, w))
        return o->method != LAGC_DOPRI5 && o->project ? lagc_second_look(p, s, t, h, error, w) : error;
#else
    (void)t;
#endif
    if (s->recalled == 0.0) {
        lagc_listen(p, s, w);
        error = lagc_error(s, o, h, w);
    }
    if (error > 1.0 && (s->recalled > 0.0 || (rejected > 1 && error * o->rtol > LAGC_LOST) ||
                        (rejected > 2 && !(rejected & (rejected - 1))))) {
        lagc_listen_along(p, s, h, o->method, w);
        error = lagc_error(s, o, h, w);
    }
    if (error <= 1.0 || error < 0.5 * before)
        s->recalled = 1.0;
    return error;
}
