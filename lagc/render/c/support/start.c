/* -- a consistent start -- */

#define LAGC_ACCEPTED 1e-9  /* scaled residual at which a start is taken, if nothing improves it */
#define LAGC_CLOSE 1e-13    /* at which one is left as it is */
#define LAGC_EXACT 1e-15    /* at which the iteration ends */
#define LAGC_SHORTEST (1.0 / 16384.0) /* part of a step that is tried at last */
#define LAGC_SLIGHT (1.0 / 1024.0) /* of the weights: the least rows are judged against; of stated values */
#define LAGC_SPREADS 8
#define LAGC_ALL LAGC_NE

static const int lagc_levels[LAGC_NU] = {LAGC_START_LEVELS};
static const int lagc_units[LAGC_NU] = {LAGC_START_UNITS};
static const int lagc_angle[LAGC_NU] = {LAGC_START_ANGLES};
static const int lagc_ends[LAGC_NE] = {LAGC_START_ENDS}; /* in J, of each condition */
static const int lagc_column[LAGC_NJ] = {LAGC_START_COLUMNS}; /* of each derivative */
#if LAGC_NQUAT
static const int lagc_first[LAGC_NQUAT] = {LAGC_QUATERNIONS};
#endif

/* How far from the guess attempt k begins, in widths. */
static double lagc_spread_of(int k)
{
    static const double spreads[LAGC_SPREADS] = {0.0, 0.01, 0.1, 0.5, 1.0, 1.0, 2.0, 2.0};
    return spreads[k];
}

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

/* Unit length for the quaternions. */
static void lagc_lengths(double *y)
{
#if LAGC_NQUAT
    int k;
    for (k = 0; k < LAGC_NQUAT; k++) {
        double *e = y + lagc_first[k];
        const double length = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
        if (length > 0.0) {
            e[0] = e[0] / length;
            e[1] = e[1] / length;
            e[2] = e[2] / length;
            e[3] = e[3] / length;
        } else {
            e[0] = 1.0;
            e[1] = e[2] = e[3] = 0.0;
        }
    }
#else
    (void)y;
#endif
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
        const double *e = y + lagc_first[k];
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

/* The size of each unknown: its own; that of others of its unit; what changes its rows by the size of
 * their terms; that of a parameter of its unit; 1.  And the size of the largest of its unit. */
static void lagc_weigh(const lagc_params *p, double t, const double *largest, lagc_start_work *w)
{
    int i, k = 0;
    lagc_meet(p, t, w->home, w->c, w->J, w->sizes);
    for (i = 0; i < LAGC_NU; i++)
        w->common[i] = w->reach[i] = 0.0;
    for (i = 0; i < LAGC_NU; i++)
        if (fabs(w->home[i]) > w->common[lagc_units[i]])
            w->common[lagc_units[i]] = fabs(w->home[i]);
    for (i = 0; i < LAGC_NE; i++)
        for (; k < lagc_ends[i]; k++) {
            const int j = lagc_column[k];
            const double slope = fabs(w->J[k]);
            if (0.0 < slope && slope < HUGE_VAL && 0.0 < w->sizes[i] && w->sizes[i] < HUGE_VAL) {
                const double way = w->sizes[i] / slope;
                if (w->reach[j] == 0.0 || way < w->reach[j])
                    w->reach[j] = way;
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
            w->weights[lagc_first[k] + i] = w->widths[lagc_first[k] + i] = 1.0;
#endif
}

/* How far unknown i moves where others could move instead. */
static double lagc_weight(const lagc_start_work *w, int i)
{
    return w->levels[i] == LAGC_UNSTATED ? w->weights[i] : w->ease * w->weights[i];
}

/* What the residual of each row is judged against. */
static void lagc_judge(const double *J, const double *sizes, lagc_start_work *w)
{
    int i, k = 0;
    for (i = 0; i < LAGC_NE; i++) {
        double total = 0.0;
        for (; k < lagc_ends[i]; k++)
            total += fabs(J[k]) * w->weights[lagc_column[k]];
        w->scales[i] = sizes[i] + LAGC_SLIGHT * total;
    }
}

static double lagc_ratio(double value, double scale)
{
    return value == 0.0 ? 0.0 : (scale > 0.0 ? fabs(value) / scale : HUGE_VAL);
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
    lagc_judge(w->J, w->sizes, w);
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

/* w->matrix: the derivatives of w->rows[first..end-1] by w->columns, each times its weight. */
static void lagc_fill(int first, int end, lagc_start_work *w)
{
    int j, k;
    for (k = first; k < end; k++) {
        double *row = w->matrix + (k - first) * w->count;
        const int i = w->rows[k];
        for (j = 0; j < w->count; j++)
            row[j] = 0.0;
        for (j = lagc_row_begin(i); j < lagc_ends[i]; j++)
            if (w->places[lagc_column[j]] >= 0)
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
    double norm;
    int n, k;
    if (first == end || w->count == 0)
        return;
    lagc_meet(p, t, y, w->c, w->J, w->sizes);
    lagc_judge(w->J, w->sizes, w);
    norm = lagc_norm(w->c, first, end, w);
    if (norm <= LAGC_CLOSE)
        return;
    for (n = 0; n < 60 && LAGC_EXACT < norm && norm < HUGE_VAL; n++) {
        int pass, found = 0;
        for (pass = 0; pass < 2 && !found; pass++) {
            double factor, least;
            lagc_fill(first, end, w);
            for (k = first; k < end; k++)
                w->right[k - first] = -w->c[w->rows[k]];
            if (!lagc_least_norm(w, end - first, w->count, pass ? 1e-5 : 1e-11))
                break;
            factor = lagc_longest(w);
            least = norm <= LAGC_CLOSE ? 0.6 * factor : LAGC_SHORTEST * factor;
            while (factor >= least) {
                lagc_copy(w->trial, y);
                for (k = 0; k < w->count; k++)
                    w->trial[w->columns[k]] += factor * w->step[k] * lagc_weight(w, w->columns[k]);
                lagc_meet(p, t, w->trial, w->trial_c, w->trial_J, w->trial_sizes);
                found = lagc_norm(w->trial_c, first, end, w) < norm * (1.0 - 0.1 * factor);
                if (found)
                    break;
                factor *= 0.5;
            }
        }
        if (!found)
            break;
        lagc_copy(y, w->trial);
        for (k = 0; k < LAGC_NE; k++) {
            w->c[k] = w->trial_c[k];
            w->sizes[k] = w->trial_sizes[k];
        }
        for (k = 0; k < LAGC_NJ; k++)
            w->J[k] = w->trial_J[k];
        lagc_judge(w->J, w->sizes, w);
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
    lagc_improve(p, t, y, w->positions, LAGC_ALL, w);
    if (lagc_farthest(p, t, y, LAGC_ALL, w) <= LAGC_ACCEPTED)
        return;
    lagc_loosen(0, LAGC_NU, w);
    lagc_improve(p, t, y, 0, LAGC_ALL, w);
}

/* The guess, with what is free moved by up to a share of its width: a guess may be singular. */
static void lagc_spread(double *y, int k, lagc_start_work *w)
{
    unsigned long state = 12345UL + (unsigned long)k;
    int i;
    lagc_copy(y, w->home);
    if (k == 0)
        return;
    for (i = 0; i < LAGC_NU; i++) {
        state = (1103515245UL * state + 12345UL) % 2147483648UL;
        if (w->loose[i] && w->used[i])
            y[i] += lagc_spread_of(k) * w->widths[i] * ((double)state / 1073741824.0 - 1.0);
    }
    lagc_lengths(y);
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
    if (lagc_farthest(p, t, w->turned, LAGC_ALL, w) <= LAGC_ACCEPTED) {
        lagc_copy(y, w->turned);
    } else {
        end = LAGC_ALL;
        to = LAGC_NU;
    }
    far = lagc_distance(y, w);
    for (n = 0; n < 20; n++) {
        lagc_loosen(0, to, w);
        if (w->count == 0 || end == 0)
            return;
        lagc_meet(p, t, y, w->c, w->J, w->sizes);
        lagc_fill(0, end, w);
        for (i = 0; i < end; i++) {
            double value = -w->c[w->rows[i]];
            for (k = 0; k < w->count; k++) {
                const int j = w->columns[k];
                value += w->matrix[i * w->count + k] * ((y[j] - w->home[j]) / lagc_weight(w, j));
            }
            w->right[i] = value;
        }
        if (!lagc_least_norm(w, end, w->count, 1e-11))
            return;
        lagc_copy(w->turned, w->home);
        for (k = 0; k < w->count; k++)
            w->turned[w->columns[k]] += w->step[k] * lagc_weight(w, w->columns[k]);
        lagc_attempt(p, t, w->turned, w);
        near = lagc_distance(w->turned, w);
        if (!(near < far && lagc_farthest(p, t, w->turned, LAGC_ALL, w) <= LAGC_ACCEPTED))
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
    if (lagc_farthest(p, t, w->turned, LAGC_ALL, w) <= LAGC_ACCEPTED)
        lagc_copy(y, w->turned);
}

/* How far what nobody stated is from the guess, in weights. */
static double lagc_strayed(const double *y, const lagc_start_work *w)
{
    double total = 0.0;
    int i;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == LAGC_UNSTATED) {
            const double way = (y[i] - w->home[i]) / w->weights[i];
            total += way * way;
        }
    return sqrt(total);
}

/* Look for a start from the spreads begin..end-1, what is free moving; w->y is the best found: the first
 * that is near, else the nearest. */
static int lagc_find(const lagc_params *p, double t, int begin, int end, lagc_start_work *w)
{
    double least = HUGE_VAL, nearest = HUGE_VAL;
    int i, k, pass, any = 0, stated = 0;
    lagc_copy(w->best, w->home);
    for (i = 0; i < LAGC_NU; i++) {
        any = any || w->loose[i];
        stated = stated || (w->loose[i] && w->levels[i] > LAGC_UNSTATED);
    }
    for (k = begin; k < end; k++) {
        for (pass = 0; pass <= stated; pass++) {
            double size;
            lagc_spread(w->now, k, w);
            w->ease = pass ? 1.0 : LAGC_SLIGHT;
            lagc_attempt(p, t, w->now, w);
            w->ease = LAGC_SLIGHT;
            size = lagc_farthest(p, t, w->now, LAGC_ALL, w);
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
        }
        if (nearest <= 8.0 || !any)
            break;
    }
    lagc_copy(w->y, w->best);
    return nearest < HUGE_VAL;
}

/* Whether there is a start with what is free now, from the guess, beside it, or where one was found. */
static int lagc_tries(const lagc_params *p, double t, lagc_start_work *w)
{
    w->trials += 1.0;
    return lagc_find(p, t, 0, 1, w) || lagc_find(p, t, 2, 3, w) ||
           (w->other != 0 && w->other != 2 && lagc_find(p, t, w->other, w->other + 1, w));
}

/* Let the value at i move or hold it, a quaternion as a whole. */
static void lagc_let(int i, int loose, lagc_start_work *w)
{
    w->loose[i] = loose;
    for (i++; i < LAGC_NU && w->part[i]; i++)
        w->loose[i] = loose;
}

/* The square of how far the value at i has moved, in proportion to its size. */
static double lagc_move(int i, const lagc_start_work *w)
{
    double total = 0.0;
    int j = i;
    while (j == i || (j < LAGC_NU && w->part[j])) {
        const double way = (w->y[j] - w->home[j]) / w->weights[j];
        total += way * way;
        j++;
    }
    return total;
}

/* Let `count` of the n values in w->values move, those that have to move least; whether there are any. */
static int lagc_fewest(const lagc_params *p, double t, int n, int count, lagc_start_work *w)
{
    double least = HUGE_VAL;
    int k, last, found = 0;
    for (k = 0; k < count; k++)
        w->picked[k] = k;
    for (;;) {
        for (k = 0; k < count; k++)
            lagc_let(w->values[w->picked[k]], 1, w);
        if (lagc_tries(p, t, w)) {
            double total = 0.0;
            for (k = 0; k < count; k++)
                total += lagc_move(w->values[w->picked[k]], w);
            if (total < least) {
                for (k = 0; k < count; k++)
                    w->best_picked[k] = w->picked[k];
                least = total;
                found = 1;
            }
        }
        for (k = 0; k < count; k++)
            lagc_let(w->values[w->picked[k]], 0, w);
        last = count - 1;
        while (last >= 0 && w->picked[last] == n - count + last)
            last--;
        if (last < 0)
            break;
        w->picked[last]++;
        for (k = last + 1; k < count; k++)
            w->picked[k] = w->picked[k - 1] + 1;
    }
    for (k = 0; found && k < count; k++)
        lagc_let(w->values[w->best_picked[k]], 1, w);
    return found;
}

/* Of the values of a level, which all move, let as few move as possible, and as little. */
static void lagc_choose(const lagc_params *p, double t, int level, lagc_start_work *w)
{
    int i, k, count, n = 0;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == level && w->used[i] && !w->part[i]) {
            w->moves[n] = lagc_move(i, w);
            w->values[n++] = i;
        }
    for (k = 0; k < n; k++)
        lagc_let(w->values[k], 0, w);
    w->trials = 0.0;
    for (count = 0; count <= n; count++) {
        double subsets = 1.0;
        for (k = 0; k < count; k++)
            subsets = subsets * (n - k) / (k + 1);
        if (w->trials + subsets > 2000.0)
            break;
        if (lagc_fewest(p, t, n, count, w))
            return;
    }
    for (k = 0; k < n; k++) { /* by how far they moved, the order of equals kept */
        const double move = w->moves[k];
        const int value = w->values[k];
        lagc_let(value, 1, w);
        for (i = k; i > 0 && w->moves[i - 1] > move; i--) {
            w->moves[i] = w->moves[i - 1];
            w->values[i] = w->values[i - 1];
        }
        w->moves[i] = move;
        w->values[i] = value;
    }
    for (k = 0; k < n; k++) {
        lagc_let(w->values[k], 0, w);
        if (!lagc_tries(p, t, w))
            lagc_let(w->values[k], 1, w);
    }
}

/* The levels, those of a quaternion as one; which unknowns occur; conditions of positions first. */
static void lagc_arrange(const int *levels, lagc_start_work *w)
{
    int i, k, n = 0, pass;
    for (i = 0; i < LAGC_NU; i++) {
        w->levels[i] = levels ? levels[i] : lagc_levels[i];
        w->part[i] = w->used[i] = 0;
    }
#if LAGC_NQUAT
    for (k = 0; k < LAGC_NQUAT; k++) {
        int *level = w->levels + lagc_first[k];
        for (i = 1; i < 4; i++)
            if (level[i] > level[0])
                level[0] = level[i];
        for (i = 1; i < 4; i++) {
            level[i] = level[0];
            w->part[lagc_first[k] + i] = 1;
        }
    }
#endif
    for (i = 0; i < LAGC_NU; i++)
        w->loose[i] = w->levels[i] == LAGC_UNSTATED;
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < LAGC_NE; i++) {
            int motion = 0;
            for (k = lagc_row_begin(i); k < lagc_ends[i]; k++) {
                w->used[lagc_column[k]] = 1;
                motion = motion || lagc_column[k] >= LAGC_NQ;
            }
            if (motion == pass)
                w->rows[n++] = i;
        }
        if (pass == 0)
            w->positions = n;
    }
}

lagc_status lagc_consistent(const lagc_params *p, double t, double *x, const int *levels,
                            lagc_start_work *w)
{
    double rates[LAGC_NU], largest[LAGC_NU];
    int i, level;
    for (i = 0; i < LAGC_NU; i++)
        rates[i] = largest[i] = 0.0;
#if LAGC_NCOND
    lagc_fn_measures(p, rates, largest);
#endif
    lagc_arrange(levels, w);
    for (i = 0; i < LAGC_NU; i++)
        w->home[i] = i < LAGC_NQ + LAGC_NV ? x[i] : rates[i - LAGC_NQ - LAGC_NV];
    lagc_lengths(w->home);
    for (i = 0; i < LAGC_NU; i++)
        if (!(fabs(w->home[i]) < HUGE_VAL)) {
            w->culprit = i;
            return LAGC_NOT_FINITE;
        }
    w->ease = LAGC_SLIGHT;
    w->first = w->other = 0;
    lagc_weigh(p, t, largest, w);
    if (!lagc_find(p, t, 0, LAGC_SPREADS, w)) {
        for (level = LAGC_DECLARED; level < LAGC_FIXED; level++) {
            int any = 0;
            for (i = 0; i < LAGC_NU; i++)
                if (w->levels[i] == level) {
                    any = 1;
                    w->loose[i] = w->used[i];
                }
            if (any && lagc_find(p, t, 0, LAGC_SPREADS, w))
                break;
        }
        if (level == LAGC_FIXED) {
            (void)lagc_farthest(p, t, w->y, LAGC_ALL, w);
            return LAGC_INCONSISTENT;
        }
        w->other = w->first;
        for (; level > LAGC_UNSTATED; level--) {
            int any = 0;
            for (i = 0; i < LAGC_NU; i++)
                any = any || w->levels[i] == level;
            if (any) {
                lagc_choose(p, t, level, w);
                (void)lagc_find(p, t, 0, LAGC_SPREADS, w);
            }
        }
    }
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++)
        x[i] = w->y[i];
    return LAGC_OK;
}
