/* -- states put back onto their constraints -- */

#if LAGC_NC
/* Scaled residuals: what is taken for rounding, and what is left as it is (more than that, left at each
 * step, adds up, as it has one sign for long). */
#define LAGC_LEFT_OVER 1e-15
#define LAGC_UNTOUCHED 1e-16

/* Factors of [M G^T; G 0] at (t, x). */
static int lagc_assemble_(const lagc_params *p, double t, const double *x, lagc_work *w)
{
#if LAGC_STRAIGHT
    if (!w->lost) {
        double health[2];
        lagc_fn_assemble(p, t, x, w->entries);
        lagc_fn_factor(w->entries, health);
        if (health[0] >= LAGC_LEAST_PIVOT && health[1] <= LAGC_LARGEST_RESIDUAL) {
            w->dense = 0;
            return LAGC_OK;
        }
    }
#endif
    w->dense = 1;
    return lagc_factor_dense(p, t, x, w);
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_solve_(const double *r, double *s, lagc_work *w)
{
    int i;
#if LAGC_STRAIGHT
    if (!w->dense) {
        lagc_fn_solve(w->entries, r, s);
        return;
    }
#endif
    for (i = 0; i < LAGC_NV; i++)
        s[i] = r[i];
    (void)lagc_solve_fallback(w, r + LAGC_NV, s, s + LAGC_NV);
}

/* w->scales: what residuals are judged by, then rates; `sizes` are those of the trajectory. */
static void lagc_measure(const lagc_params *p, double t, const double *x, const double *sizes,
                         lagc_work *w)
{
    double own[LAGC_KINDS], reaches[LAGC_NC + LAGC_NH];
    int i;
    for (i = 0; i < LAGC_KINDS; i++)
        own[i] = i == 0 && sizes[i] > 1.0 ? 1.0 : sizes[i];
    lagc_fn_scales(p, t, x, w->scales);
    lagc_fn_reaches(p, t, x, own, reaches);
    for (i = 0; i < LAGC_NC; i++)
        w->scales[i] += LAGC_RESTING * reaches[i];
    for (i = 0; i < LAGC_NH; i++)
        w->rates[i] = reaches[LAGC_NC + i];
    for (i = LAGC_NH; i < LAGC_NC; i++)
        w->rates[i] = w->scales[i];
}

/* The largest of |value| / scale; infinity where one is not a number. */
static double lagc_residual(const double *values, int n, const double *scales)
{
    int i;
    double worst = 0.0;
    for (i = 0; i < n; i++) {
        const double size = fabs(values[i]) / scales[i];
        if (!(size <= worst))
            worst = size == size ? size : HUGE_VAL;
    }
    return worst;
}

/* The row with the largest scaled residual. */
static int lagc_worst(const double *values, int n, const double *scales)
{
    int i, row = 0;
    double worst = 0.0;
    for (i = 0; i < n; i++) {
        const double size = fabs(values[i]) / scales[i];
        if (!(size <= worst)) {
            row = i;
            worst = size;
        }
    }
    return row;
}
#endif

#if LAGC_NH
/* Take from the parts of the error of a state near x what lies along the constraints in their speeds,
 * in the metric of the mass matrix: projection takes it from the state.  0 where it cannot be told. */
static int lagc_tangents(const lagc_params *p, double t, const double *x, lagc_work *w)
{
    const int lost = w->lost, culprit = w->culprit;
    int redundant[LAGC_NC];
    int i, j, k, status;
    double *r = w->right, *s = w->left, total;
    for (i = 0; i < LAGC_NC; i++)
        redundant[i] = w->redundant[i];
    lagc_system_(p, t, x, w);
    status = lagc_assemble_(p, t, x, w);
    for (j = 0; j < LAGC_NV; j++)
        r[j] = 0.0;
    for (k = 0; k < 2 && !LAGC_FAILED(status); k++) {
        double *e = w->parts[k] + LAGC_NQ;
        for (i = 0; i < LAGC_NC; i++) {
            total = 0.0;
            for (j = 0; j < LAGC_NV; j++)
                total += w->G[i * LAGC_NV + j] * e[j];
            r[LAGC_NV + i] = -total;
        }
        lagc_solve_(r, s, w);
        for (j = 0; j < LAGC_NV; j++)
            e[j] += s[j];
    }
    w->lost = lost;
    w->culprit = culprit;
    for (i = 0; i < LAGC_NC; i++)
        w->redundant[i] = redundant[i];
    return !LAGC_FAILED(status);
}

/* w->nudged: a state beside x, off its constraints by what projection leaves, in the direction that costs
 * most in the metric of the mass matrix, with speeds that fit.  0 where that cannot be told. */
static int lagc_nudge(const lagc_params *p, double t, const double *x, const double *sizes,
                      lagc_work *w)
{
    double *r = w->right, *s = w->left;
    const int status = lagc_assemble_(p, t, x, w);
    int i;
    if (LAGC_FAILED(status))
        return 0;
    lagc_measure(p, t, x, sizes, w);
    for (i = 0; i < LAGC_NV; i++)
        r[i] = 0.0;
    for (i = 0; i < LAGC_NC; i++)
        r[LAGC_NV + i] = (i % 2 ? -LAGC_LEFT_OVER : LAGC_LEFT_OVER) * w->scales[i];
    lagc_solve_(r, s, w);
    for (i = 0; i < LAGC_NX; i++)
        w->nudged[i] = x[i];
#if LAGC_HAS_DISPLACE
    lagc_fn_displace(p, t, x, s, w->dq);
    for (i = 0; i < LAGC_NQ; i++)
        w->nudged[i] += w->dq[i];
#else
    for (i = 0; i < LAGC_NQ; i++)
        w->nudged[i] += s[i];
#endif
    lagc_fn_velocity(p, t, w->nudged, w->rows);
    for (i = 0; i < LAGC_NC; i++)
        r[LAGC_NV + i] = -w->rows[i];
    lagc_solve_(r, s, w);
    for (i = 0; i < LAGC_NV; i++)
        w->nudged[LAGC_NQ + i] += s[i];
    return 1;
}
#endif

/* Move x onto the constraints by the shortest way in the metric of the mass matrix: positions by
 * simplified Newton iterations, M d = G^T mu, G d = -phi, dq = N d; then speeds, M dv = G^T mu,
 * G dv = -psi.  Gives the scaled residuals that remain. */
static int lagc_project(const lagc_params *p, double t, double *x, const double *sizes,
                        double *position, double *velocity, lagc_work *w)
{
#if LAGC_NC
    double *y = w->moved, *r = w->right, *s = w->left, *rows = w->rows;
    double size;
    int i, n, status, assembled = 0;
#endif
    *position = 0.0;
    *velocity = 0.0;
#if LAGC_NQUAT
    lagc_normalise(x);
#endif
#if LAGC_NC
    for (i = 0; i < LAGC_NV + LAGC_NC; i++)
        r[i] = 0.0;
    lagc_measure(p, t, x, sizes, w);
#if LAGC_NH
    lagc_fn_position(p, t, x, rows);
    *position = lagc_residual(rows, LAGC_NH, w->scales);
    for (n = 0; n < 8 && !(*position <= (n ? LAGC_LEFT_OVER : LAGC_UNTOUCHED)); n++) {
        if (!assembled) {
            status = lagc_assemble_(p, t, x, w);
            if (LAGC_FAILED(status))
                return status;
            assembled = 1;
        }
        for (i = 0; i < LAGC_NH; i++)
            r[LAGC_NV + i] = -rows[i];
        lagc_solve_(r, s, w);
        for (i = 0; i < LAGC_NX; i++)
            y[i] = x[i];
#if LAGC_HAS_DISPLACE
        lagc_fn_displace(p, t, x, s, w->dq);
        for (i = 0; i < LAGC_NQ; i++)
            y[i] += w->dq[i];
#else
        for (i = 0; i < LAGC_NQ; i++)
            y[i] += s[i];
#endif
#if LAGC_NQUAT
        lagc_normalise(y);
#endif
        lagc_fn_position(p, t, y, rows);
        size = lagc_residual(rows, LAGC_NH, w->scales);
        if (!(size < *position))
            break;
        for (i = 0; i < LAGC_NQ; i++)
            x[i] = y[i];
        *position = size;
    }
    if (*position > 1e-6) {
        w->culprit = lagc_worst(rows, LAGC_NH, w->scales);
        return LAGC_INCONSISTENT;
    }
#endif
    lagc_fn_velocity(p, t, x, rows);
    *velocity = lagc_residual(rows, LAGC_NC, w->rates);
    for (n = 0; n < 8 && !(*velocity <= (n ? LAGC_LEFT_OVER : LAGC_UNTOUCHED)); n++) {
        if (!assembled) {
            status = lagc_assemble_(p, t, x, w);
            if (LAGC_FAILED(status))
                return status;
            assembled = 1;
        }
        for (i = 0; i < LAGC_NC; i++)
            r[LAGC_NV + i] = -rows[i];
        lagc_solve_(r, s, w);
        for (i = 0; i < LAGC_NX; i++)
            y[i] = x[i];
        for (i = 0; i < LAGC_NV; i++)
            y[LAGC_NQ + i] += s[i];
        lagc_fn_velocity(p, t, y, rows);
        size = lagc_residual(rows, LAGC_NC, w->rates);
        if (!(size < *velocity))
            break;
        for (i = LAGC_NQ; i < LAGC_NQ + LAGC_NV; i++)
            x[i] = y[i];
        *velocity = size;
    }
    if (*velocity > 1e-6) {
        w->culprit = lagc_worst(rows, LAGC_NC, w->rates);
        return LAGC_INCONSISTENT;
    }
#else
    (void)p;
    (void)t;
    (void)sizes;
    (void)w;
#endif
    return LAGC_OK;
}
