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

/* Of the values of a level, which all move in the start w->y, let as few move as possible, and as little:
 * those that linear prediction names, else by trying. */
static void lagc_choose(const lagc_params *p, double t, int level, lagc_start_work *w)
{
    int i, k, n = 0, m = 0;
    for (i = 0; i < LAGC_NU; i++)
        if (w->levels[i] == level && w->used[i]) {
            w->stated[m++] = i;
            if (!w->part[i]) {
                w->moves[n] = lagc_move(i, w);
                w->values[n++] = i;
            }
        }
    lagc_copy(w->kept, w->y);
    for (k = 0; k < n; k++)
        lagc_let(w->values + k, 1, 0, w);
    if (!lagc_predicted(p, t, n, m, w))
        lagc_search(p, t, n, w);
    if (!(lagc_strayed(w->y, w) <= LAGC_NEAR))
        (void)lagc_find(p, t, 0, LAGC_SPREADS, w);
}
