/* -- the choice of the stated values that move, by trying -- */

#define LAGC_MOST_WORK 200 /* factorisations of a search that no prediction helps */

/* Let `count` of the n values in w->values move, those that have to move least; whether there are any. */
static int lagc_fewest(const lagc_params *p, double t, int n, int count, int limit,
                       lagc_start_work *w)
{
    double least = HUGE_VAL;
    int k;
    lagc_copy(w->held, w->y);
    for (k = 0; k < count; k++)
        w->picked[k] = k;
    while (w->work <= limit) {
        for (k = 0; k < count; k++)
            lagc_let(w->values + w->picked[k], 1, 1, w);
        if (lagc_tries(p, t, w)) {
            double total;
            (void)lagc_moved(n, &total, w);
            if (total < least) {
                for (k = 0; k < count; k++)
                    w->best_picked[k] = w->values[w->picked[k]];
                least = total;
                lagc_copy(w->held, w->y);
            }
        }
        for (k = 0; k < count; k++)
            lagc_let(w->values + w->picked[k], 1, 0, w);
        if (!lagc_next(count, n, w))
            break;
    }
    if (least < HUGE_VAL)
        lagc_let(w->best_picked, count, 1, w);
    lagc_copy(w->y, w->held);
    return least < HUGE_VAL;
}

/* By trying sets, the smallest first, and then to hold one value after the other; what has not been
 * tried when the work is done moves. */
static void lagc_search(const lagc_params *p, double t, int n, lagc_start_work *w)
{
    int limit = w->work + LAGC_MOST_WORK, count, i, k;
    for (count = w->rank > 0 ? 0 : 1; count <= n && w->work <= limit; count++) /* none was tried already */
        if (lagc_fewest(p, t, n, count, limit, w))
            return;
    for (k = 0; k < n; k++) { /* by how far they moved, the order of equals kept */
        const double move = w->moves[k];
        const int value = w->values[k];
        if (move > 0.0)
            lagc_let(&value, 1, 1, w);
        for (i = k; i > 0 && w->moves[i - 1] > move; i--) {
            w->moves[i] = w->moves[i - 1];
            w->values[i] = w->values[i - 1];
        }
        w->moves[i] = move;
        w->values[i] = value;
    }
    limit = w->work + LAGC_MOST_WORK;
    for (k = 0; k < n; k++)
        if (w->moves[k] > 0.0 && w->work <= limit) {
            lagc_let(w->values + k, 1, 0, w);
            if (!lagc_tries(p, t, w))
                lagc_let(w->values + k, 1, 1, w);
        }
    if (!lagc_find(p, t, 0, LAGC_SPREADS, w)) {
        lagc_let(w->values, n, 1, w);
        lagc_copy(w->y, w->kept);
    }
}

/* Whether the n values w->picked, now held, need not have moved to a start: rows that follow from others
 * where all hold, and not elsewhere, may have moved them. */
static int lagc_returned(const lagc_params *p, double t, const double *start, int n, lagc_start_work *w)
{
    int i, k;
    if (lagc_lacking(p, t, start, w))
        return 0;
    lagc_copy(w->now, start);
    for (k = 0; k < n; k++) {
        i = w->picked[k];
        do
            w->now[i] = w->home[i];
        while (++i < LAGC_NU && w->part[i]);
    }
    lagc_attempt(p, t, w->now, w);
    if (!(lagc_farthest(p, t, w->now, w->ended, w) <= LAGC_ACCEPTED))
        return 0;
    lagc_copy(w->y, w->now);
    return 1;
}

/* Whether there is a start where none of the n values w->values that were released moves: looked for from
 * beside the guess where one went far, else from where they led to. */
static int lagc_unmoved(const lagc_params *p, double t, int n, lagc_start_work *w)
{
    double most = 0.0;
    int k;
    for (k = 0; k < n; k++) {
        w->picked[k] = w->values[k];
        if (w->moves[k] > most)
            most = w->moves[k];
    }
    if (most <= LAGC_WIDE * LAGC_WIDE)
        return lagc_returned(p, t, w->kept, n, w);
    if (!lagc_find(p, t, LAGC_BESIDE + 1, LAGC_SPREADS, w))
        return 0;
    w->other = w->first;
    return 1;
}

/* Hold those of the n values w->values that hardly moved, or did not, if there is a start without. */
static void lagc_hold_little(const lagc_params *p, double t, int n, lagc_start_work *w)
{
    int pass, k;
    lagc_copy(w->held, w->y);
    for (pass = 0; pass < 2; pass++) {
        const double most = pass ? LAGC_UNMOVED : LAGC_WIDE * LAGC_WIDE;
        int little = 0;
        for (k = 0; k < n; k++)
            if (w->loose[w->values[k]] && lagc_move(w->values[k], w) <= most)
                w->picked[little++] = w->values[k];
        if (little == 0)
            continue;
        lagc_let(w->picked, little, 0, w);
        if (lagc_returned(p, t, w->held, little, w) || (pass && lagc_tries(p, t, w)))
            break;
        lagc_let(w->picked, little, 1, w);
        lagc_copy(w->y, w->held);
    }
}

/* Of the values of a level, which all move in the start w->y, let as few move as possible, and as little:
 * those that linear prediction names, else by trying. */
static void lagc_choose(const lagc_params *p, double t, int level, lagc_start_work *w)
{
    int i, n = 0, m = 0;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == level && w->used[i] && !w->part[i]) {
            w->moves[n] = lagc_move(i, w);
            w->values[n++] = i;
        }
    lagc_copy(w->kept, w->y);
    lagc_let(w->values, n, 0, w);
    if (!lagc_unmoved(p, t, n, w)) {
        for (i = 0; i < LAGC_NU; i++)
            if (w->levels[i] == level && w->used[i])
                w->stated[m++] = i;
        if (!lagc_predicted(p, t, n, m, w))
            lagc_search(p, t, n, w);
        lagc_hold_little(p, t, n, w);
    }
    if (!(lagc_strayed(w->y, w) <= LAGC_NEAR))
        (void)lagc_find(p, t, 0, LAGC_SPREADS, w);
}
