/* -- the way to a start -- */

#define LAGC_CLOSE 1e-13    /* at which one is left as it is */
#define LAGC_EXACT 1e-15    /* at which the iteration ends */
#define LAGC_SHORTEST (1.0 / 16384.0) /* part of a step that is tried at last */
#define LAGC_OVERSHOT 2.0   /* of what was missed: a step that misses more is too long, whatever part it is */
#define LAGC_TINIEST 1e-30  /* part of a step, of such a one */
#define LAGC_BESIDE 2       /* the spread that leaves a singular guess well behind */
#define LAGC_NEAR 8.0       /* weights from the guess: one farther off is taken if none is nearer */
#define LAGC_ALIKE 1.01     /* what attempts from near the guess miss: they ended at the same place */
#define LAGC_SPREADS 8

/* How far from the guess attempt k begins, in widths. */
static double lagc_spread_of(int k)
{
    static const double spreads[LAGC_SPREADS] = {0.0, 0.01, 0.1, 0.5, 1.0, 1.0, 2.0, 2.0};
    return spreads[k];
}

/* w->columns: what is free of the unknowns from..to-1. */
static void lagc_loosen(int from, int to, lagc_start_work *w)
{
    int i;
    w->count = 0;
    for (i = 0; i < LAGC_NU; i++)
        w->places[i] = -1;
    for (i = from; i < to; i++)
        if (w->loose[i]) {
            w->places[i] = w->count;
            w->columns[w->count++] = i;
        }
}

/* Take no derivative for rounding. */
static void lagc_unblur(lagc_start_work *w)
{
    int k;
    for (k = 0; k < LAGC_NJ; k++)
        w->blurred[k] = 0;
}

/* w->matrix: the derivatives of w->rows[first..end-1] by w->columns, each times its weight, 0 where it is
 * rounding. */
static void lagc_fill(int first, int end, lagc_start_work *w)
{
    int j, k;
    for (k = first; k < end; k++) {
        double *row = w->matrix + (k - first) * w->count;
        const int i = w->rows[k];
        for (j = 0; j < w->count; j++)
            row[j] = 0.0;
        for (j = lagc_row_begin(i); j < lagc_ends[i]; j++)
            if (w->places[lagc_column[j]] >= 0 && !w->blurred[j])
                row[w->places[lagc_column[j]]] = w->J[j] * lagc_weight(w, lagc_column[j]);
    }
}

/* The part of w->step that turns no angle by more than a radian. */
static double lagc_longest(const lagc_start_work *w)
{
    double factor = 1.0;
    int k;
    for (k = 0; k < w->count; k++) {
        const double turn = fabs(w->step[k]) * lagc_weight(w, w->columns[k]);
        if (lagc_angle[w->columns[k]] && turn * factor > 1.0)
            factor = 1.0 / turn;
    }
    return factor;
}

/* Gauss-Newton of least norm on w->rows[first..end-1] in w->columns, with steps that are halved until
 * they help. */
static void lagc_improve(const lagc_params *p, double t, double *y, int first, int end,
                         lagc_start_work *w)
{
    double norm, left = 1.0, longest = 1.0;
    int n, k;
    if (first == end || w->count == 0)
        return;
    lagc_meet(p, t, y, w->c, w->J, w->sizes);
    lagc_judge(y, w->J, w->sizes, w);
    norm = lagc_norm(w->c, first, end, w);
    if (norm <= LAGC_CLOSE)
        return;
    lagc_unblur(w);
    if (w->columns[0] >= LAGC_NQ) /* speeds alone: what is rounding of positions stays so */
        lagc_blur(p, t, y, w->weights, w);
    for (n = 0; n < 60 && LAGC_EXACT < norm && norm < HUGE_VAL; n++) {
        double size = norm;
        int pass, found = 0;
        if (n > 0 && n % 8 == 0) { /* what is missed halves, or it is no use */
            if (longest == 1.0 && !(left < 0.5))
                break;
            left = 1.0;
        }
        for (pass = 0; pass < 2 && !found; pass++) {
            double factor, least;
            lagc_fill(first, end, w);
            for (k = first; k < end; k++)
                w->right[k - first] = -w->c[w->rows[k]];
            w->work++;
            if (!lagc_least_norm(w, end - first, w->count, pass ? 1e-5 : 1e-11))
                break;
            longest = lagc_longest(w);
            least = norm <= LAGC_CLOSE ? 0.6 * longest : LAGC_SHORTEST * longest;
            factor = 1.0; /* whole turns are gone where all is linear */
            size = HUGE_VAL;
            while (least > 0.0 && factor >= (size < LAGC_OVERSHOT * norm ? least : LAGC_TINIEST)) {
                lagc_copy(w->trial, y);
                for (k = 0; k < w->count; k++)
                    w->trial[w->columns[k]] += factor * w->step[k] * lagc_weight(w, w->columns[k]);
                lagc_meet(p, t, w->trial, w->trial_c, w->trial_J, w->trial_sizes);
                size = lagc_norm(w->trial_c, first, end, w);
                found = size < norm * (1.0 - (factor <= longest ? 0.1 * factor : 0.999));
                if (found)
                    break;
                factor = factor <= longest ? 0.5 * factor : longest;
            }
        }
        if (!found)
            break;
        left *= size / norm;
        lagc_copy(y, w->trial);
        for (k = 0; k < LAGC_NE; k++) {
            w->c[k] = w->trial_c[k];
            w->sizes[k] = w->trial_sizes[k];
        }
        for (k = 0; k < LAGC_NJ; k++)
            w->J[k] = w->trial_J[k];
        lagc_judge(y, w->J, w->sizes, w);
        norm = lagc_norm(w->c, first, end, w);
    }
}

/* Positions first, then speeds; all together where that is not enough. */
static void lagc_attempt(const lagc_params *p, double t, double *y, lagc_start_work *w)
{
    lagc_loosen(0, LAGC_NQ, w);
    lagc_improve(p, t, y, 0, w->positions, w);
    if (!(lagc_farthest(p, t, y, w->positions, w) <= LAGC_ACCEPTED))
        return;
    lagc_loosen(LAGC_NQ, LAGC_NU, w);
    lagc_improve(p, t, y, w->positions, w->ended, w);
    if (lagc_farthest(p, t, y, w->ended, w) <= LAGC_ACCEPTED)
        return;
    lagc_loosen(0, LAGC_NU, w);
    lagc_improve(p, t, y, 0, w->ended, w);
}

#if LAGC_NPOSITION
/* Whether what is alone in a condition has moved to meet it. */
static int lagc_met_alone(const lagc_params *p, double t, lagc_start_work *w)
{
    int i;
    if (!w->is_settled)
        lagc_settle(p, t, w);
    w->is_settled = 1;
    for (i = 0; i < LAGC_NU; i++)
        if (w->settled[i] != w->home[i])
            return 1;
    return 0;
}
#endif

/* Beginning k: the guess, with what is free moved by up to a share of its width, for a guess may be
 * singular.  In the second, and in every other where nothing stated moves, what is alone in a condition
 * meets it instead. */
static void lagc_spread(const lagc_params *p, double t, double *y, int k, int stated,
                        lagc_start_work *w)
{
    unsigned long state = 12345UL + (unsigned long)k;
    int i;
    lagc_copy(y, w->home);
#if LAGC_NPOSITION
    if ((k == 1 || (k % 2 == 1 && !stated)) && lagc_met_alone(p, t, w))
        lagc_copy(y, w->settled);
#else
    (void)stated;
    (void)p;
    (void)t;
#endif
    if (k == 0)
        return;
    for (i = 0; i < LAGC_NU; i++) {
        state = (1103515245UL * state + 12345UL) % 2147483648UL;
        if (w->loose[i] && w->used[i] && y[i] == w->home[i])
            y[i] += lagc_spread_of(k) * w->widths[i] * ((double)state / 1073741824.0 - 1.0);
    }
#if LAGC_NQUAT
    lagc_normalise(y);
#endif
}

/* From the guess, in weights. */
static double lagc_distance(const double *y, const lagc_start_work *w)
{
    double total = 0.0;
    int i;
    for (i = 0; i < LAGC_NU; i++) {
        const double way = (y[i] - w->home[i]) / lagc_weight(w, i);
        total += way * way;
    }
    return sqrt(total);
}

/* A start between y and the guess, as near to the guess as steps of least norm lead: of the positions
 * alone, where speeds from their guess fit. */
static void lagc_nearer(const lagc_params *p, double t, double *y, lagc_start_work *w)
{
    int end = w->positions, to = LAGC_NQ, i, k, n;
    double far, near;
    for (i = 0; i < LAGC_NU; i++)
        w->turned[i] = i < LAGC_NQ ? y[i] : w->home[i];
    lagc_attempt(p, t, w->turned, w);
    if (lagc_farthest(p, t, w->turned, w->ended, w) <= LAGC_ACCEPTED) {
        lagc_copy(y, w->turned);
    } else {
        end = w->ended;
        to = LAGC_NU;
    }
    far = lagc_distance(y, w);
    for (n = 0; n < 20; n++) {
        lagc_loosen(0, to, w);
        if (w->count == 0 || end == 0)
            return;
        lagc_meet(p, t, y, w->c, w->J, w->sizes);
        lagc_unblur(w);
        lagc_fill(0, end, w);
        for (i = 0; i < end; i++) {
            double value = -w->c[w->rows[i]];
            for (k = 0; k < w->count; k++) {
                const int j = w->columns[k];
                value += w->matrix[i * w->count + k] * ((y[j] - w->home[j]) / lagc_weight(w, j));
            }
            w->right[i] = value;
        }
        w->work++;
        if (!lagc_least_norm(w, end, w->count, 1e-11))
            return;
        lagc_copy(w->turned, w->home);
        for (k = 0; k < w->count; k++)
            w->turned[w->columns[k]] += w->step[k] * lagc_weight(w, w->columns[k]);
        lagc_attempt(p, t, w->turned, w);
        near = lagc_distance(w->turned, w);
        if (!(near < far && lagc_farthest(p, t, w->turned, w->ended, w) <= LAGC_ACCEPTED))
            return;
        lagc_copy(y, w->turned);
        far = near;
    }
}

/* y with angles less than half a turn from their guess, where that is a start too. */
static void lagc_unwind(const lagc_params *p, double t, double *y, lagc_start_work *w)
{
    const double turn = 6.283185307179586;
    int i, wound = 0;
    lagc_copy(w->turned, y);
    for (i = 0; i < LAGC_NU; i++)
        if (lagc_angle[i]) {
            const double turns = floor((y[i] - w->home[i]) / turn + 0.5);
            if (turns != 0.0) {
                w->turned[i] = y[i] - turn * turns;
                wound = 1;
            }
        }
    if (!wound)
        return;
    lagc_attempt(p, t, w->turned, w);
    if (lagc_farthest(p, t, w->turned, w->ended, w) <= LAGC_ACCEPTED)
        lagc_copy(y, w->turned);
}

/* How far what nobody stated is from the guess, in weights. */
static double lagc_strayed(const double *y, const lagc_start_work *w)
{
    double total = 0.0;
    int i;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == LAGC_UNSTATED && w->used[i]) {
            const double way = (y[i] - w->home[i]) / w->weights[i];
            total += way * way;
        }
    return sqrt(total);
}

/* Whether a condition is missed that nothing free occurs in. */
static int lagc_hopeless(const lagc_params *p, double t, lagc_start_work *w)
{
    int i, k;
    lagc_meet(p, t, w->home, w->c, w->J, w->sizes);
    lagc_judge(w->home, w->J, w->sizes, w);
    for (i = 0; i < w->ended; i++) {
        int any = 0;
        for (k = lagc_row_begin(w->rows[i]); k < lagc_ends[w->rows[i]]; k++)
            any = any || w->loose[lagc_column[k]];
        if (!any && !(lagc_ratio(w->c[w->rows[i]], w->scales[w->rows[i]]) <= LAGC_ACCEPTED))
            return 1;
    }
    return 0;
}

/* Whether, beside y, the conditions ask for more than what is free can give, but not more than what is
 * stated could. */
static int lagc_lacking(const lagc_params *p, double t, const double *y, lagc_start_work *w)
{
    int i, n = 0;
    for (i = 0; i < LAGC_NU; i++)
        if (w->used[i] && !w->loose[i] && w->levels[i] < LAGC_FIXED)
            w->stated[n++] = i;
    return lagc_table(p, t, y, y, n, w) > 0;
}

/* Look for a start from the spreads begin..end-1, what is free moving; w->y is the best found: the first
 * that is near, else the nearest. */
static int lagc_find(const lagc_params *p, double t, int begin, int end, lagc_start_work *w)
{
    double least = HUGE_VAL, nearest = HUGE_VAL, most = 0.0;
    int i, k, pass, any = 0, stated = 0;
    lagc_copy(w->y, w->home);
    if (lagc_hopeless(p, t, w))
        return 0;
    lagc_copy(w->best, w->home);
    for (i = 0; i < LAGC_NU; i++) {
        any = any || w->loose[i];
        stated = stated || (w->loose[i] && w->levels[i] > LAGC_UNSTATED);
    }
    for (k = begin; k < end; k++) {
        for (pass = 0; pass <= stated; pass++) {
            double size;
            lagc_spread(p, t, w->now, k, stated, w);
            w->ease = pass ? 1.0 : LAGC_SLIGHT;
            lagc_attempt(p, t, w->now, w);
            w->ease = LAGC_SLIGHT;
            size = lagc_farthest(p, t, w->now, w->ended, w);
            if (size <= LAGC_ACCEPTED) {
                double far;
                lagc_unwind(p, t, w->now, w);
                if (k > 0 || pass)
                    lagc_nearer(p, t, w->now, w);
                far = lagc_strayed(w->now, w);
                if (far < nearest) {
                    lagc_copy(w->best, w->now);
                    least = 0.0;
                    nearest = far;
                    w->first = k;
                }
                break;
            }
            if (size < least) {
                lagc_copy(w->best, w->now);
                least = size;
            }
            if (size > most)
                most = size;
        }
        if (nearest <= LAGC_NEAR || !any)
            break;
        if (k != LAGC_BESIDE || k + 1 == end || nearest < HUGE_VAL)
            continue;
#if LAGC_NPOSITION
        if (lagc_met_alone(p, t, w))
            continue;
#endif
        if ((most <= LAGC_ALIKE * least && LAGC_ALIKE * least < HUGE_VAL) ||
            lagc_lacking(p, t, w->best, w))
            break;
    }
    lagc_copy(w->y, w->best);
    return nearest < HUGE_VAL;
}
