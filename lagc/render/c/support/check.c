/* -- what a call demands -- */

/* The option that makes no sense, or -1. */
static int lagc_bad_option(const lagc_options *o)
{
    if (o->method != LAGC_DOP853 && o->method != LAGC_DOPRI5)
        return LAGC_BAD_METHOD;
    if (o->max_steps < 0)
        return LAGC_BAD_MAX_STEPS;
    if (!(o->rtol >= 0.0 && o->rtol < 1.0) || (o->step == 0.0 && o->atol == 0.0 && o->rtol < 1e-15))
        return LAGC_BAD_RTOL;
    if (!(o->atol >= 0.0 && o->atol < HUGE_VAL))
        return LAGC_BAD_ATOL;
    if (!(o->step >= 0.0 && o->step < HUGE_VAL))
        return LAGC_BAD_STEP;
    if (!(o->first_step >= 0.0 && o->first_step < HUGE_VAL))
        return LAGC_BAD_FIRST_STEP;
    return o->max_step >= 0.0 && o->max_step < HUGE_VAL ? -1 : LAGC_BAD_MAX_STEP;
}

#if LAGC_COMPLETE
/* The parameter that is not finite or out of its bounds, or the value made of some that is, or -1. */
static int lagc_bad_parameter(const lagc_params *p)
{
#if LAGC_NBOUNDED
    static const int bounded[] = {LAGC_BOUNDED};
    static const double bounds[][2] = {LAGC_BOUNDS};
#endif
#if LAGC_NLIMITS
    static const double limits[][2] = {LAGC_LIMITS};
    double derived[sizeof limits / sizeof *limits];
#endif
    const double *values = (const double *)p; /* they are all doubles */
    size_t k;
    for (k = 0; k < sizeof *p / sizeof *values; k++)
        if (!(fabs(values[k]) < HUGE_VAL))
            return LAGC_BAD_PARAMETER + (int)k;
#if LAGC_NBOUNDED
    for (k = 0; k < sizeof bounded / sizeof *bounded; k++)
        if (!(values[bounded[k]] >= bounds[k][0] && values[bounded[k]] <= bounds[k][1]))
            return LAGC_BAD_PARAMETER + bounded[k];
#endif
#if LAGC_NLIMITS
    lagc_fn_limits(p, derived);
    for (k = 0; k < sizeof limits / sizeof *limits; k++)
        if (!(derived[k] >= limits[k][0] && derived[k] <= limits[k][1]))
            return LAGC_BAD_PARAMETER + (int)(sizeof *p / sizeof *values + k);
#endif
    return -1;
}

lagc_status lagc_check(const lagc_params *p, const lagc_options *o, int *culprit)
{
    int found = o ? lagc_bad_option(o) : -1;
    if (found < 0 && p)
        found = lagc_bad_parameter(p);
    if (culprit)
        *culprit = found;
    return found < 0 ? LAGC_OK : LAGC_INVALID;
}

const char *lagc_status_text(int status)
{
    static const char *const texts[] = {LAGC_STATUS_TEXTS};
    return status >= 0 && status <= LAGC_INVALID ? texts[status] : "no status";
}

#endif
/* What a call that goes to t1 demands: OK; else INVALID or NOT_FINITE, and who is to blame. */
static int lagc_demand(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o)
{
    int culprit = lagc_bad_option(o);
    if (culprit < 0 && !(fabs(t1) < HUGE_VAL && fabs(s->t) < HUGE_VAL))
        culprit = LAGC_BAD_TIME;
#if LAGC_COMPLETE
    if (culprit < 0)
        culprit = lagc_bad_parameter(p);
#else
    (void)p;
#endif
    if (culprit >= 0) {
        s->culprit = culprit;
        return LAGC_INVALID;
    }
    s->culprit = lagc_not_finite(s->x, LAGC_NX);
    return s->culprit < 0 ? LAGC_OK : LAGC_NOT_FINITE;
}
