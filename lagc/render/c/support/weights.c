/* -- what counts as an error of one step, and how long the first may be -- */

/* The sizes that kinds take from rest over the longest step so far, as they set out in this one: where a
 * motion begins with a kink, no step is short enough to be exact by what it reaches itself. */
static void lagc_departing(const lagc_state *s, const lagc_options *o, double h, const lagc_work *w,
                           double *sizes)
{
    int i;
    for (i = 0; i < LAGC_KINDS; i++)
        sizes[i] = 0.0;
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++) {
        const double way = fabs(s->y[i] - s->x[i]) * (w->longest / fabs(h));
        if (way > sizes[lagc_kinds[i]])
            sizes[lagc_kinds[i]] = way;
    }
    for (i = 0; i < LAGC_KINDS; i++)
        if (s->sizes[i] > o->rtol * sizes[i]) /* it moves already */
            sizes[i] = 0.0;
}

/* w->reached, those of the trajectory with its new state s->y, and what errors of a step over h are
 * measured in; s->noise is the rounding of rates, where it is known.  An angle that winds does not make
 * others less telling. */
static void lagc_weights(const lagc_state *s, const lagc_options *o, double h, lagc_work *w)
{
    double departing[LAGC_KINDS];
    int i;
    for (i = 0; i < LAGC_KINDS; i++) {
        w->reached[i] = s->sizes[i];
        departing[i] = 0.0;
    }
    lagc_enlarge(s->y, w->reached);
    if (w->longest > 0.0)
        lagc_departing(s, o, h, w, departing);
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++) {
        const int kind = lagc_kinds[i];
        double size = departing[kind] > w->reached[kind] ? departing[kind] : w->reached[kind], weight;
        if (kind == 0 && size > 1.0)
            size = fabs(s->y[i]) > 1.0 ? fabs(s->y[i]) : 1.0;
        weight = o->atol + o->rtol * size + 10.0 * fabs(h) * (s->noise[i] + w->play[i]);
        w->weights[i] = weight > LAGC_TINY ? weight : LAGC_TINY;
    }
}

/* The shortest of the times in which the kinds change by their own size, as their rates and the
 * changes of these over a small step tell; a part of it, by the order of the method.  Kinds that begin
 * at rest get the size to which it takes them: a force that jumps there is no error of any size. */
static double lagc_first_step(const lagc_params *p, lagc_state *s, double t1, double direction,
                              const lagc_options *o, lagc_work *w)
{
    const double order = o->method == LAGC_DOPRI5 ? 5.0 : 8.0;
    const double largest = o->max_step > 0.0 ? o->max_step : fabs(t1 - s->t);
    double rates[LAGC_KINDS], bends[LAGC_KINDS];
    double h = 0.01 * largest, tolerance = 1.0, best;
    int k, status;
    for (k = 0; k < LAGC_KINDS; k++) {
        rates[k] = 0.0;
        bends[k] = 0.0;
    }
    lagc_enlarge(s->k[0], rates);
    for (k = 0; k < LAGC_KINDS; k++) {
        if (s->sizes[k] > 0.0 && o->rtol + o->atol / s->sizes[k] < tolerance)
            tolerance = o->rtol + o->atol / s->sizes[k];
        if (s->sizes[k] > 0.0 && 0.01 * s->sizes[k] < h * rates[k])
            h = 0.01 * s->sizes[k] / rates[k];
    }
    for (k = 0; k < LAGC_NX; k++)
        s->y[k] = s->x[k] + h * direction * s->k[0][k];
    status = lagc_rhs_(p, s->t + h * direction, s->y, s->k[1], w->lam, w);
    s->rhs++;
    if (LAGC_FAILED(status) || h == 0.0)
        return h;
    for (k = 0; k < LAGC_NX; k++)
        s->y[k] = (s->k[1][k] - s->k[0][k]) / h;
    lagc_enlarge(s->y, bends);
    best = largest;
    for (k = 0; k < LAGC_KINDS; k++) {
        double way;
        if (!(bends[k] > 0.0))
            continue;
        way = sqrt(s->sizes[k] / bends[k]);
        if (s->sizes[k] < way * rates[k])
            way = s->sizes[k] / rates[k];
        if (rates[k] > way * bends[k])
            way = rates[k] / bends[k];
        if (way > 0.0 && way < best)
            best = way;
    }
    h = best * pow(0.01 * tolerance, 1.0 / order);
    if (h > largest)
        h = largest;
    for (k = 0; k < LAGC_KINDS; k++)
        if (s->sizes[k] == 0.0)
            s->sizes[k] = h * rates[k];
    return h;
}
