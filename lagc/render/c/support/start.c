/* -- a consistent start -- */

/* Whether a value of this part is stated at a level. */
static int lagc_has(int level, const lagc_start_work *w)
{
    int i;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == level && w->used[i])
            return 1;
    return 0;
}

/* Level after level is let go until there is a start; then as much as possible is held again. */
static int lagc_ladder(const lagc_params *p, double t, lagc_start_work *w)
{
    int i, level, n = 0;
    if (lagc_find(p, t, 0, LAGC_SPREADS, w))
        return 1;
    for (level = LAGC_DECLARED; level < LAGC_FIXED; level++) {
        for (i = 0; i < LAGC_NU; i++)
            if (w->levels[i] == level && w->used[i])
                w->loose[i] = 1;
        if (lagc_has(level, w) && lagc_find(p, t, 0, LAGC_SPREADS, w))
            break;
    }
    if (level == LAGC_FIXED)
        return 0;
    w->other = w->first;
    for (; level > LAGC_UNSTATED; level--)
        if (lagc_has(level, w))
            lagc_choose(p, t, level, w);
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] > LAGC_UNSTATED && !w->part[i])
            w->values[n++] = i;
    lagc_hold_little(p, t, n, w);
    return 1;
}

/* w->group: a number for each row, the same for rows that share an unknown that may move. */
static void lagc_group(lagc_start_work *w)
{
    int changed = 1, i, k, r;
    for (i = 0; i < LAGC_NU; i++)
        w->picked[i] = i;
    for (r = 0; r < LAGC_NE; r++)
        w->group[r] = -1;
    while (changed) {
        changed = 0;
        for (r = 0; r < LAGC_NE; r++) {
            int least = LAGC_NU;
            i = w->all[r];
            for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
                if (w->levels[lagc_column[k]] < LAGC_FIXED && w->picked[lagc_column[k]] < least)
                    least = w->picked[lagc_column[k]];
            for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
                if (w->levels[lagc_column[k]] < LAGC_FIXED)
                    w->picked[lagc_column[k]] = least;
            changed = changed || w->group[r] != least;
            w->group[r] = least;
        }
    }
}

/* Each part of the conditions that shares no unknown with the others by itself. */
static int lagc_by_parts(const lagc_params *p, double t, lagc_start_work *w)
{
    int part, i, r;
    lagc_copy(w->reached, w->y);
    lagc_copy(w->answer, w->home);
    for (i = 0; i < LAGC_NU; i++)
        w->let[i] = w->loose[i];
    lagc_group(w);
    for (part = 0; part <= LAGC_NU; part++) {
        int n = 0, met;
        for (r = 0; r < LAGC_NE; r++)
            if (w->group[r] == part)
                w->order[n++] = w->all[r];
        if (n == 0)
            continue;
        lagc_confine(n, w);
        for (i = 0; i < LAGC_NU; i++)
            w->loose[i] = w->let[i] && w->used[i];
        lagc_copy(w->y, w->reached);
        met = lagc_farthest(p, t, w->reached, w->ended, w) <= LAGC_CLOSE &&
              lagc_strayed(w->reached, w) <= LAGC_NEAR;
        if (!met && !lagc_ladder(p, t, w))
            return 0;
        for (i = 0; i < LAGC_NU; i++)
            if (w->used[i] && w->levels[i] < LAGC_FIXED) {
                w->answer[i] = w->y[i];
                w->let[i] = w->loose[i];
            }
    }
    lagc_copy(w->y, w->answer);
    for (i = 0; i < LAGC_NU; i++)
        w->loose[i] = w->let[i];
    return 1;
}

#define LAGC_TRACE 1e-6 /* of its size: a move that may be none; where rows are quadratic, rounding leaves its root */

/* Leave as guessed what went next to no way, if what is left meets the conditions as near by: steps leave traces
 * in unknowns that they need not move. */
static void lagc_calm(const lagc_params *p, double t, lagc_start_work *w)
{
    int i, same = 0;
    for (i = 0; i < LAGC_NE; i++)
        w->order[i] = w->all[i];
    lagc_confine(LAGC_NE, w);
    lagc_copy(w->answer, w->y);
    for (i = 0; i < LAGC_NU; i++) {
        const double way = fabs(w->y[i] - w->home[i]);
        w->let[i] = w->loose[i];
        if (w->loose[i] && w->used[i] && 0.0 < way && way <= LAGC_TRACE * w->weights[i]) {
            w->answer[i] = w->home[i];
            w->loose[i] = 0;
            same = 1;
        }
    }
    if (same) {
        lagc_attempt(p, t, w->answer, w);
        same = lagc_farthest(p, t, w->answer, w->ended, w) <= LAGC_CLOSE;
        for (i = 0; i < LAGC_NU; i++)
            same = same && fabs(w->answer[i] - w->y[i]) <= LAGC_TRACE * w->weights[i];
        if (same)
            lagc_copy(w->y, w->answer);
    }
    for (i = 0; i < LAGC_NU; i++)
        w->loose[i] = w->let[i];
}

lagc_status lagc_consistent(const lagc_params *p, double t, double *x, const int *levels,
                            lagc_start_work *w)
{
    double rates[LAGC_NU], largest[LAGC_NU];
    int i;
    w->culprit = fabs(t) < HUGE_VAL ? lagc_bad_parameter(p) : LAGC_BAD_TIME;
    for (i = 0; levels && w->culprit < 0 && i < LAGC_NU; i++)
        if (levels[i] < LAGC_UNSTATED || levels[i] > LAGC_FIXED)
            w->culprit = LAGC_BAD_LEVEL;
    if (w->culprit >= 0)
        return LAGC_INVALID;
    for (i = 0; i < LAGC_NU; i++)
        rates[i] = largest[i] = 0.0;
#if LAGC_NCOND
    lagc_fn_measures(p, rates, largest);
#endif
    lagc_arrange(levels, w);
    for (i = 0; i < LAGC_NU; i++)
        w->home[i] = i < LAGC_NQ + LAGC_NV ? x[i] : rates[i - LAGC_NQ - LAGC_NV];
#if LAGC_NQUAT
    lagc_normalise(w->home);
#endif
    for (i = 0; i < LAGC_NU; i++)
        if (!(fabs(w->home[i]) < HUGE_VAL)) {
            w->culprit = i;
            return LAGC_NOT_FINITE;
        }
#if LAGC_NQUAT
    for (i = 0; i < LAGC_NQUAT; i++) {
        const double *e = w->home + lagc_quaternion[i];
        if (e[0] == 0.0 && e[1] == 0.0 && e[2] == 0.0 && e[3] == 0.0) {
            w->culprit = LAGC_NCOND + i;
            return LAGC_INCONSISTENT;
        }
    }
#endif
    w->ease = LAGC_SLIGHT;
    w->first = w->other = w->work = 0;
    lagc_weigh(p, t, largest, w);
    if (!(lagc_find(p, t, 0, 1, w) && lagc_strayed(w->y, w) <= LAGC_NEAR) && !lagc_by_parts(p, t, w)) {
        (void)lagc_farthest(p, t, w->y, w->ended, w);
        return LAGC_INCONSISTENT;
    }
    lagc_calm(p, t, w);
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++)
        x[i] = w->y[i];
    return LAGC_OK;
}
