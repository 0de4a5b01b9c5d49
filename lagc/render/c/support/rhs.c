/* -- the right-hand side, watched -- */

/* Pivot ratio of a straight solve that is good enough; with constraints the square of the share
 * below which rows count as dependent. */
#if LAGC_NC
#define LAGC_LEAST_PIVOT 1e-10
#else
#define LAGC_LEAST_PIVOT 1e-13
#endif

/* Squares of a residual of a straight solve beyond rounding, to be refined; and beyond trust. */
#define LAGC_ROUNDING 1e-28
#define LAGC_LARGEST_RESIDUAL 1e-20

#define LAGC_FAILED(status) ((status) != LAGC_OK && (status) != LAGC_REDUNDANT)

static void lagc_system_(const lagc_params *p, double t, const double *x, lagc_work *w)
{
#if LAGC_NC
    lagc_fn_system(p, t, x, w->qdot, w->M, w->force, w->G, w->gamma);
#else
    double G[1], gamma[1];
    lagc_fn_system(p, t, x, w->qdot, w->M, w->force, G, gamma);
#endif
}

/* The index of the first value that is infinite or not a number; -1. */
static int lagc_not_finite(const double *values, int n)
{
    int i;
    double total = 0.0;
    for (i = 0; i < n; i++)
        total += values[i];
    if (total - total == 0.0)
        return -1;
    for (i = 0; i < n; i++)
        if (!(values[i] - values[i] == 0.0))
            return i;
    return -1;
}

#if LAGC_NC
/* How far x is from the constraints, scaled; and, for each row, the change of its residual over the
 * size of the coordinates (angles: and 1) relative to the size of its terms, at most 1. */
static void lagc_trust(const lagc_params *p, double t, const double *x, lagc_work *w)
{
    double own[LAGC_KINDS], reaches[LAGC_NC + LAGC_NH];
    int i;
    for (i = 0; i < LAGC_KINDS; i++)
        own[i] = 0.0;
    lagc_enlarge(x, own);
    own[0] += 1.0;
    w->miss = 0.0;
    lagc_fn_scales(p, t, x, w->found);
    lagc_fn_reaches(p, t, x, own, reaches);
#if LAGC_NH
    lagc_fn_position(p, t, x, w->free);
    for (i = 0; i < LAGC_NH; i++) {
        const double miss = fabs(w->free[i]) / (w->found[i] + LAGC_RESTING * reaches[i]);
        if (!(miss <= w->miss))
            w->miss = miss;
    }
#endif
    for (i = 0; i < LAGC_NC; i++)
        w->slight[i] = reaches[i] < w->found[i] ? reaches[i] / w->found[i] : 1.0;
}
#endif

#if LAGC_NC
/* A gradient that is much shorter than others may be rounding of its terms: its direction says
 * little then. */
static void lagc_faint(const lagc_params *p, double t, const double *x, lagc_work *w)
{
    int i, j;
    double largest = 0.0, smallest = HUGE_VAL;
    for (i = 0; i < LAGC_NC; i++) {
        w->free[i] = 0.0;
        for (j = 0; j < LAGC_NV; j++)
            w->free[i] += fabs(w->G[i * LAGC_NV + j]);
        if (w->free[i] > largest)
            largest = w->free[i];
        if (w->free[i] < smallest)
            smallest = w->free[i];
    }
    if (!(smallest < 1e-6 * largest))
        return;
    lagc_fn_gradient_sizes(p, t, x, w->found);
    for (i = 0; i < LAGC_NC; i++)
        if (w->free[i] > 0.0 && w->free[i] < w->slight[i] * w->found[i])
            w->slight[i] = w->free[i] / w->found[i];
}
#endif

/* Factors of the equations at (t, x) that hold for any rank. */
static int lagc_factor_dense(const lagc_params *p, double t, const double *x, lagc_work *w)
{
    int i, status;
#if LAGC_STRAIGHT
    w->fallbacks++;
#endif
    lagc_system_(p, t, x, w);
    i = lagc_not_finite(w->qdot, LAGC_NQ);
    if (i < 0) {
        i = lagc_not_finite(w->force, LAGC_NV);
        if (i >= 0)
            i += LAGC_NQ;
    }
    if (i < 0 && lagc_not_finite(w->M, LAGC_NV * (LAGC_NV + 1) / 2) >= 0)
        i = LAGC_NQ;
#if LAGC_NC
    if (i < 0 && (lagc_not_finite(w->G, LAGC_NC * LAGC_NV) >= 0 || lagc_not_finite(w->gamma, LAGC_NC) >= 0))
        i = LAGC_NQ;
#endif
    if (i >= 0) {
        const int own = lagc_not_finite(x, LAGC_NX);
        w->culprit = own >= 0 ? own : i;
        return LAGC_NOT_FINITE;
    }
#if LAGC_NC
    lagc_trust(p, t, x, w);
    lagc_faint(p, t, x, w);
    status = lagc_factor_fallback(p, t, x, w);
    w->lost = status == LAGC_REDUNDANT;
    for (i = w->rank; w->lost && i < LAGC_NC; i++)
        w->redundant[w->order[i]] = 1;
#else
    status = lagc_cholesky(w) ? LAGC_OK : LAGC_SINGULAR_MASS;
#endif
    return status;
}

static int lagc_rhs_dense(const lagc_params *p, double t, const double *x, double *xdot, double *lam,
                          lagc_work *w)
{
    int i, status = lagc_factor_dense(p, t, x, w);
    double *a = xdot + LAGC_NQ;
    if (LAGC_FAILED(status))
        return status;
    for (i = 0; i < LAGC_NV; i++)
        a[i] = w->force[i];
#if LAGC_NC
    status = lagc_solve_fallback(w, w->gamma, a, lam);
    if (LAGC_FAILED(status))
        return status;
#else
    lagc_lower(w, a);
    lagc_upper(w, a);
    (void)lam;
#endif
    for (i = 0; i < LAGC_NQ; i++)
        xdot[i] = w->qdot[i];
#if LAGC_NZ
    LAGC_POWER(xdot + LAGC_NQ + LAGC_NV);
#endif
    i = lagc_not_finite(xdot, LAGC_NX);
    if (i >= 0) {
        w->culprit = i;
        return LAGC_NOT_FINITE;
    }
    return status;
}

#if LAGC_STRAIGHT
#if LAGC_NC
/* The same once more with one step of iterative refinement. */
static void lagc_rhs_refined(const lagc_params *p, double t, const double *x, double *xdot, double *lam,
                             lagc_work *w)
{
    double health[2];
    double *a = xdot + LAGC_NQ, *r = w->right, *s = w->left;
    int i;
    lagc_system_(p, t, x, w);
    lagc_fn_assemble(p, t, x, w->entries);
    lagc_fn_factor(w->entries, health);
    for (i = 0; i < LAGC_NV; i++)
        r[i] = w->force[i];
    for (i = 0; i < LAGC_NC; i++)
        r[LAGC_NV + i] = w->gamma[i];
    lagc_fn_solve(w->entries, r, s);
    lagc_fn_refine(w->entries, r, s);
    for (i = 0; i < LAGC_NQ; i++)
        xdot[i] = w->qdot[i];
    for (i = 0; i < LAGC_NV; i++)
        a[i] = s[i];
    for (i = 0; i < LAGC_NC; i++)
        lam[i] = s[LAGC_NV + i];
#if LAGC_NZ
    LAGC_POWER(xdot + LAGC_NQ + LAGC_NV);
#endif
}
#endif

static int lagc_rhs_(const lagc_params *p, double t, const double *x, double *xdot, double *lam,
                     lagc_work *w)
{
    double health[2];
#if LAGC_NC
    if (w->lost)
        return lagc_rhs_dense(p, t, x, xdot, lam, w);
#endif
    lagc_fn_rhs(p, t, x, xdot, lam, health);
    if (!(health[0] >= LAGC_LEAST_PIVOT && health[1] <= LAGC_LARGEST_RESIDUAL))
        return lagc_rhs_dense(p, t, x, xdot, lam, w);
#if LAGC_NC
    if (health[1] > LAGC_ROUNDING)
        lagc_rhs_refined(p, t, x, xdot, lam, w);
#endif
    if (lagc_not_finite(xdot, LAGC_NX) >= 0)
        return lagc_rhs_dense(p, t, x, xdot, lam, w); /* it tells why */
    return LAGC_OK;
}
#else
static int lagc_rhs_(const lagc_params *p, double t, const double *x, double *xdot, double *lam,
                     lagc_work *w)
{
    return lagc_rhs_dense(p, t, x, xdot, lam, w);
}
#endif
