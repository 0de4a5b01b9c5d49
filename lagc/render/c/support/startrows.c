/* -- a consistent start -- */

#define LAGC_SLIGHT (1.0 / 1024.0) /* of the weights: the least rows are judged against; of stated values */
#define LAGC_LAST (1.0 / 1125899906842624.0) /* of a position: a change of its last places */
#define LAGC_ACCEPTED 1e-9 /* scaled residual at which a start is taken, if nothing improves it */

static const int lagc_levels[LAGC_NU] = {LAGC_START_LEVELS};
static const int lagc_units[LAGC_NU] = {LAGC_START_UNITS};
static const int lagc_angle[LAGC_NU] = {LAGC_START_ANGLES};
static const int lagc_ends[LAGC_NE] = {LAGC_START_ENDS}; /* in J, of each condition */
static const int lagc_column[LAGC_NJ] = {LAGC_START_COLUMNS}; /* of each derivative */

static int lagc_row_begin(int i)
{
    return i > 0 ? lagc_ends[i - 1] : 0;
}

static void lagc_copy(double *to, const double *from)
{
    int i;
    for (i = 0; i < LAGC_NU; i++)
        to[i] = from[i];
}

/* Residuals, derivatives and sizes of the terms of all conditions. */
static void lagc_meet(const lagc_params *p, double t, const double *y, double *c, double *J,
                      double *sizes)
{
#if LAGC_NRATE || LAGC_NQUAT
    int k;
#endif
#if LAGC_NCOND
    lagc_fn_conditions(p, t, y, c, J, sizes);
#else
    (void)p;
    (void)t;
#endif
#if LAGC_NRATE
    for (k = 0; k < LAGC_NRATE; k++) {
        c[LAGC_NCOND - LAGC_NRATE + k] -= y[LAGC_NQ + LAGC_NV + k];
        sizes[LAGC_NCOND - LAGC_NRATE + k] += fabs(y[LAGC_NQ + LAGC_NV + k]);
    }
#endif
#if LAGC_NQUAT
    for (k = 0; k < LAGC_NQUAT; k++) {
        const double *e = y + lagc_quaternion[k];
        double *slopes = J + lagc_row_begin(LAGC_NCOND + k);
        c[LAGC_NCOND + k] = 0.5 * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3] - 1.0);
        sizes[LAGC_NCOND + k] = 1.0;
        slopes[0] = e[0];
        slopes[1] = e[1];
        slopes[2] = e[2];
        slopes[3] = e[3];
    }
#endif
}

/* w->blurred: 1 for each of the derivatives w->J at y that is rounding: it changes by as much as it is where
 * positions, of these `sizes`, change in their last places. */
static void lagc_blur(const lagc_params *p, double t, const double *y, const double *sizes,
                      lagc_start_work *w)
{
    int i, k;
    lagc_copy(w->trial, y);
    for (i = 0; i < LAGC_NQ; i++) {
        const double size = fabs(y[i]) > fabs(sizes[i]) ? fabs(y[i]) : fabs(sizes[i]);
        w->trial[i] += (i % 2 == 0 ? LAGC_LAST : -LAGC_LAST) * size;
    }
    lagc_meet(p, t, w->trial, w->trial_c, w->trial_J, w->trial_sizes);
    for (k = 0; k < LAGC_NJ; k++)
        w->blurred[k] = 0.0 < fabs(w->J[k]) && fabs(w->J[k]) <= fabs(w->trial_J[k] - w->J[k]);
}

/* The size of each unknown: its own; that of others of its unit; what changes a row by the size of its terms,
 * of the unknown of its unit that the row depends on most; that of a parameter of its unit; 1.  And the size
 * of the largest of its unit. */
static void lagc_weigh(const lagc_params *p, double t, const double *largest, lagc_start_work *w)
{
    int i, k;
    lagc_meet(p, t, w->home, w->c, w->J, w->sizes);
    for (i = 0; i < LAGC_NE; i++)
        w->terms[i] = w->sizes[i];
    lagc_blur(p, t, w->home, w->home, w);
    for (i = 0; i < LAGC_NU; i++)
        w->common[i] = w->reach[i] = 0.0;
    for (i = 0; i < LAGC_NU; i++)
        if (fabs(w->home[i]) > w->common[lagc_units[i]])
            w->common[lagc_units[i]] = fabs(w->home[i]);
    for (i = 0; i < LAGC_NE; i++) {
        if (!(0.0 < w->sizes[i] && w->sizes[i] < HUGE_VAL))
            continue;
        for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
            w->steepest[lagc_units[lagc_column[k]]] = 0.0;
        for (k = lagc_row_begin(i); k < lagc_ends[i]; k++) {
            double *steepest = w->steepest + lagc_units[lagc_column[k]];
            if (*steepest < fabs(w->J[k]) && fabs(w->J[k]) < HUGE_VAL && !w->blurred[k])
                *steepest = fabs(w->J[k]);
        }
        for (k = lagc_row_begin(i); k < lagc_ends[i]; k++) {
            const int j = lagc_column[k];
            const double slope = w->steepest[lagc_units[j]];
            if (slope > 0.0 && (w->reach[j] == 0.0 || w->sizes[i] / slope < w->reach[j]))
                w->reach[j] = w->sizes[i] / slope;
        }
    }
    for (i = 0; i < LAGC_NU; i++) {
        double weight = fabs(w->home[i]);
        if (w->levels[i] == LAGC_UNSTATED || weight == 0.0)
            weight = w->common[lagc_units[i]];
        if (weight == 0.0)
            weight = w->reach[i];
        if (weight == 0.0)
            weight = largest[lagc_units[i]];
        if (!(1e-290 < weight && weight < 1e290))
            weight = 1.0;
        w->widths[i] = w->common[lagc_units[i]] < 1e290 ? w->common[lagc_units[i]] : 1e290;
        if (w->widths[i] < weight)
            w->widths[i] = weight;
        if (lagc_angle[i] && w->widths[i] > 1.0)
            w->widths[i] = 1.0;
        if (lagc_angle[i] && weight > 1.0)
            weight = 1.0;
        w->weights[i] = weight;
    }
#if LAGC_NQUAT
    for (k = 0; k < LAGC_NQUAT; k++)
        for (i = 0; i < 4; i++)
            w->weights[lagc_quaternion[k] + i] = w->widths[lagc_quaternion[k] + i] = 1.0;
#endif
}

/* How far unknown i moves where others could move instead. */
static double lagc_weight(const lagc_start_work *w, int i)
{
    return w->levels[i] == LAGC_UNSTATED ? w->weights[i] : w->ease * w->weights[i];
}

/* What the residual of each row at y is judged against: its terms, and what the weights change it by, but not
 * beyond its terms at the guess, or those of unknowns that are there.  A large coefficient of what is zero so
 * far excuses nothing.  Where speeds meet, positions are known to their widths. */
static void lagc_judge(const double *y, const double *J, const double *sizes, lagc_start_work *w)
{
    int i, k = 0;
    for (i = 0; i < LAGC_NE; i++) {
        double total = 0.0, own = 0.0, there = 0.0, posture = 0.0, slight, known, most;
        for (; k < lagc_ends[i]; k++) {
            const int j = lagc_column[k];
            const double slope = fabs(J[k]);
            if (j < LAGC_NQ && lagc_column[lagc_ends[i] - 1] >= LAGC_NQ)
                posture += slope * w->widths[j];
            total += slope * w->weights[j];
            own += slope * fabs(y[j]);
            if (fabs(y[j]) >= LAGC_SLIGHT * w->weights[j])
                there += slope * fabs(y[j]);
        }
        slight = LAGC_SLIGHT * total;
        known = w->terms[i] > 0.0 ? w->terms[i] : there;
        most = known + LAGC_SLIGHT * (own + posture);
        w->scales[i] = sizes[i] + (0.0 < known && most < slight ? most : slight);
    }
}

static double lagc_ratio(double value, double scale)
{
    return value == 0.0 ? 0.0 : (0.0 < scale && scale < HUGE_VAL ? fabs(value) / scale : HUGE_VAL);
}

/* The norm of the scaled residuals of w->rows[first..end-1]; infinity where one is not a number. */
static double lagc_norm(const double *c, int first, int end, const lagc_start_work *w)
{
    double total = 0.0;
    int k;
    for (k = first; k < end; k++) {
        const double size = lagc_ratio(c[w->rows[k]], w->scales[w->rows[k]]);
        total += size * size;
    }
    return total == total ? sqrt(total) : HUGE_VAL;
}

/* The largest scaled residual of w->rows[..end-1], infinity where one is not a number. */
static double lagc_farthest(const lagc_params *p, double t, const double *y, int end,
                            lagc_start_work *w)
{
    double worst = 0.0;
    int k;
    lagc_meet(p, t, y, w->c, w->J, w->sizes);
    lagc_judge(y, w->J, w->sizes, w);
    w->culprit = -1;
    for (k = 0; k < end; k++) {
        const double size = lagc_ratio(w->c[w->rows[k]], w->scales[w->rows[k]]);
        if (!(size <= worst)) {
            worst = size == size ? size : HUGE_VAL;
            w->culprit = w->rows[k];
            if (worst == HUGE_VAL)
                break;
        }
    }
    return worst;
}

/* Look at the n conditions in w->order, those of positions first, and at the unknowns that they hold. */
static void lagc_confine(int n, lagc_start_work *w)
{
    int i, k, pass;
    for (i = 0; i < LAGC_NU; i++)
        w->used[i] = 0;
    w->ended = 0;
#if LAGC_NPOSITION
    w->is_settled = 0;
#endif
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < n; i++) {
            int motion = 0;
            for (k = lagc_row_begin(w->order[i]); k < lagc_ends[w->order[i]]; k++) {
                w->used[lagc_column[k]] = 1;
                motion = motion || lagc_column[k] >= LAGC_NQ;
            }
            if (motion == pass)
                w->rows[w->ended++] = w->order[i];
        }
        if (pass == 0)
            w->positions = w->ended;
    }
}

/* The levels, those of a quaternion as one; all conditions. */
static void lagc_arrange(const int *levels, lagc_start_work *w)
{
    int i;
#if LAGC_NQUAT
    int k;
#endif
    for (i = 0; i < LAGC_NU; i++) {
        w->levels[i] = levels ? levels[i] : lagc_levels[i];
        w->part[i] = 0;
    }
#if LAGC_NQUAT
    for (k = 0; k < LAGC_NQUAT; k++) {
        int *level = w->levels + lagc_quaternion[k];
        for (i = 1; i < 4; i++)
            if (level[i] > level[0])
                level[0] = level[i];
        for (i = 1; i < 4; i++) {
            level[i] = level[0];
            w->part[lagc_quaternion[k] + i] = 1;
        }
    }
#endif
    for (i = 0; i < LAGC_NU; i++)
        w->loose[i] = w->levels[i] == LAGC_UNSTATED;
    for (i = 0; i < LAGC_NE; i++)
        w->order[i] = i;
    lagc_confine(LAGC_NE, w);
    for (i = 0; i < LAGC_NE; i++)
        w->all[i] = w->rows[i];
}
