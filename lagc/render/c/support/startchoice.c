/* -- the choice of the stated values that move -- */

#define LAGC_MOST_SETS 128.0 /* sets of columns whose linear prediction is looked at */
#define LAGC_EXCHANGES 10    /* of columns, where there are more sets */
#define LAGC_WIDE 0.1        /* weights: moves up to it are trusted to be linear */
#define LAGC_BENT 0.05       /* of what is missed: curvature up to which the first prediction is taken */
#define LAGC_UNMOVED 1e-22   /* squared, in weights */

/* Whether there is a start with what is free now, from the guess, beside it, or where one was found. */
static int lagc_tries(const lagc_params *p, double t, lagc_start_work *w)
{
    w->work++;
    return lagc_find(p, t, 0, 1, w) || lagc_find(p, t, LAGC_BESIDE, LAGC_BESIDE + 1, w) ||
           (w->other != 0 && w->other != LAGC_BESIDE && lagc_find(p, t, w->other, w->other + 1, w));
}

/* Let the n values move or hold them, a quaternion as a whole. */
static void lagc_let(const int *values, int n, int loose, lagc_start_work *w)
{
    int k, i;
    for (k = 0; k < n; k++) {
        w->loose[values[k]] = loose;
        for (i = values[k] + 1; i < LAGC_NU && w->part[i]; i++)
            w->loose[i] = loose;
    }
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

/* How many of the first n of w->values have moved, and the sum of the squares of their ways. */
static double lagc_moved(int n, double *total, const lagc_start_work *w)
{
    double count = 0.0;
    int k;
    *total = 0.0;
    for (k = 0; k < n; k++) {
        const double move = lagc_move(w->values[k], w);
        if (move > LAGC_UNMOVED) {
            count += 1.0;
            *total += move;
        }
    }
    return count;
}

/* The value that column j is of: the first part of a quaternion. */
static int lagc_owner(int j, const lagc_start_work *w)
{
    while (w->part[j])
        j--;
    return j;
}

static double lagc_largest(const double *values, int n)
{
    double largest = 0.0;
    int k;
    for (k = 0; k < n; k++)
        if (fabs(values[k]) > largest)
            largest = fabs(values[k]);
    return largest;
}

/* How many values move where the k picked columns do, and the sum of the squares of the moves. */
static double lagc_cost(const int *picked, const double *ways, int k, double slack, double *total,
                        lagc_start_work *w)
{
    const double least = slack * lagc_largest(ways, k);
    double count = 0.0;
    int i;
    *total = 0.0;
    for (i = 0; i < k; i++)
        w->marks[lagc_owner(w->stated[picked[i]], w)] = 0;
    for (i = 0; i < k; i++)
        if (fabs(ways[i]) > least) {
            const int owner = lagc_owner(w->stated[picked[i]], w);
            if (!w->marks[owner])
                count += 1.0;
            w->marks[owner] = 1;
            *total += ways[i] * ways[i];
        }
    return count;
}

/* The next set of k of n in w->picked; 0 behind the last. */
static int lagc_next(int k, int n, lagc_start_work *w)
{
    int last = k - 1;
    while (last >= 0 && w->picked[last] == n - k + last)
        last--;
    if (last < 0)
        return 0;
    w->picked[last]++;
    for (last++; last < k; last++)
        w->picked[last] = w->picked[last - 1] + 1;
    return 1;
}

/* How much the conditions bend from y to `to`, as a part of what is missed at y. */
static double lagc_bend(const lagc_params *p, double t, const double *y, const double *to,
                        lagc_start_work *w)
{
    double missed = 0.0, bent = 0.0;
    int r, k;
    lagc_meet(p, t, y, w->c, w->J, w->sizes);
    lagc_judge(y, w->J, w->sizes, w);
    for (r = 0; r < w->ended; r++) {
        const int i = w->rows[r];
        double value = w->c[i], size;
        for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
            value += w->J[k] * (to[lagc_column[k]] - y[lagc_column[k]]);
        size = lagc_ratio(w->c[i], w->scales[i]);
        if (size > missed)
            missed = size;
        size = lagc_ratio(value, w->scales[i]);
        if (size > bent)
            bent = size;
    }
    return missed > 0.0 ? bent / missed : 0.0;
}

/* Keep w->picked with w->ways among the few sets that move fewest values and least; how many these are. */
static int lagc_rank(int k, int found, double slack, lagc_start_work *w)
{
    double total;
    const double count = lagc_cost(w->picked, w->ways, k, slack, &total, w);
    int at = found, i, j;
    while (at > 0 && (count < w->set_count[at - 1] ||
                      (count == w->set_count[at - 1] && total < w->set_total[at - 1])))
        at--;
    if (at == LAGC_PREDICTED)
        return found;
    if (found < LAGC_PREDICTED)
        found++;
    for (i = found - 1; i > at; i--) {
        w->set_count[i] = w->set_count[i - 1];
        w->set_total[i] = w->set_total[i - 1];
        for (j = 0; j < k; j++) {
            w->set_picked[i * LAGC_NU + j] = w->set_picked[(i - 1) * LAGC_NU + j];
            w->set_ways[i * LAGC_NU + j] = w->set_ways[(i - 1) * LAGC_NU + j];
        }
    }
    w->set_count[at] = count;
    w->set_total[at] = total;
    for (j = 0; j < k; j++) {
        w->set_picked[at * LAGC_NU + j] = w->picked[j];
        w->set_ways[at * LAGC_NU + j] = w->ways[j];
    }
    return found;
}

/* w->picked and w->ways: the basis of k of n columns, and its moves. */
static void lagc_pick(int n, int k, lagc_start_work *w)
{
    int r;
    for (r = 0; r < k; r++) {
        w->picked[r] = w->basis[r];
        w->ways[r] = w->rests[w->solved[r] * (n + 1) + n];
    }
}

/* Improve the basis of k of n columns by exchanges of one column for another, while that helps and asks
 * for no wide move, which the conditions would not be linear for; whether any did. */
static int lagc_exchange(int n, int k, double slack, lagc_start_work *w)
{
    const double widest = lagc_largest(w->ways, k);
    const double bound = widest > LAGC_WIDE ? widest : LAGC_WIDE;
    double count, total;
    int times, i, j, r, helped = 0;
    count = lagc_cost(w->basis, w->ways, k, slack, &total, w);
    for (times = 0; times < LAGC_EXCHANGES; times++) {
        int out = -1, into = -1;
        for (j = 0; j < n; j++) {
            int inside = 0;
            for (r = 0; r < k; r++)
                inside = inside || w->basis[r] == j;
            for (i = 0; i < k && !inside; i++) {
                const double *row = w->rests + w->solved[i] * (n + 1);
                const int before = w->basis[i];
                double way, now_count, now_total;
                if (!(fabs(row[j]) > 0.01))
                    continue;
                way = row[n] / row[j];
                for (r = 0; r < k; r++)
                    w->step[r] = r != i ? w->ways[r] - w->rests[w->solved[r] * (n + 1) + j] * way : way;
                if (!(lagc_largest(w->step, k) <= bound))
                    continue;
                w->basis[i] = j;
                now_count = lagc_cost(w->basis, w->step, k, slack, &now_total, w);
                w->basis[i] = before;
                if (now_count < count || (now_count == count && now_total < total)) {
                    count = now_count;
                    total = now_total;
                    out = i;
                    into = j;
                }
            }
        }
        if (out < 0)
            break;
        lagc_pivot(w->rests, w->left, n + 1, w->solved[out], into);
        w->basis[out] = into;
        helped = 1;
        lagc_pick(n, k, w);
    }
    return helped;
}

static double lagc_subsets(int n, int count)
{
    double total = 1.0;
    int k;
    for (k = 0; k < count; k++)
        total = total * (n - k) / (k + 1);
    return total;
}

/* Sets of k of the n columns that can meet the conditions, as far as they are linear: the few that move
 * fewest values and least. */
static int lagc_candidates(int n, int k, double slack, lagc_start_work *w)
{
    int found = 0, i;
    if (lagc_subsets(n, k) > LAGC_MOST_SETS) {
        lagc_pick(n, k, w);
        found = lagc_rank(k, found, slack, w);
        if (lagc_exchange(n, k, slack, w))
            found = lagc_rank(k, found, slack, w);
        return found;
    }
    for (i = 0; i < k; i++)
        w->picked[i] = i;
    do {
        if (lagc_ways(n, k, w))
            found = lagc_rank(k, found, slack, w);
    } while (lagc_next(k, n, w));
    return found;
}

/* Free those of the n values of w->values that the conditions, linear between the start and the point
 * where the m columns w->stated are as given, ask to move; whether that led to a start. */
static int lagc_predicted(const lagc_params *p, double t, int n, int m, lagc_start_work *w)
{
    double bend, slack, count = HUGE_VAL, total = HUGE_VAL;
    int i, k, rank, sets, set, chosen = 0;
    lagc_copy(w->now, w->kept);
    for (i = 0; i < m; i++)
        w->now[w->stated[i]] = w->home[w->stated[i]];
    bend = lagc_bend(p, t, w->now, w->kept, w);
    slack = bend < 0.1 ? bend : 0.1;
    slack = slack > LAGC_NEGLIGIBLE ? slack : LAGC_NEGLIGIBLE;
    for (i = 0; i < LAGC_NU; i++)
        w->best[i] = 0.5 * (w->kept[i] + w->now[i]);
    rank = lagc_table(p, t, w->kept, w->now, m, w);
    k = lagc_table(p, t, w->best, w->now, m, w);
    if (rank < k) /* rows that follow from others where they hold, not elsewhere */
        k = lagc_table(p, t, w->kept, w->now, m, w);
    w->rank = k;
    sets = lagc_candidates(m, k, slack, w);
    lagc_copy(w->held, w->kept);
    for (set = 0; set < sets; set++) {
        const double *ways = w->set_ways + set * LAGC_NU;
        const double least = slack * lagc_largest(ways, k);
        int pass, sure = 1;
        for (pass = 0; pass < 2; pass++) { /* what the prediction moves, else the whole basis */
            int picked = 0, led;
            for (i = 0; i < k; i++)
                if (pass || fabs(ways[i]) > least)
                    w->picked[picked++] = lagc_owner(w->stated[w->set_picked[set * LAGC_NU + i]], w);
            if (!pass && picked == k)
                continue;
            lagc_let(w->picked, picked, 1, w);
            led = lagc_tries(p, t, w);
            lagc_let(w->picked, picked, 0, w);
            if (led) {
                double now_total;
                const double now_count = lagc_moved(n, &now_total, w);
                if (now_count < count || (now_count == count && now_total < total)) {
                    for (i = 0; i < picked; i++)
                        w->best_picked[i] = w->picked[i];
                    chosen = picked;
                    lagc_copy(w->held, w->y);
                    count = now_count;
                    total = now_total;
                }
                break;
            }
            sure = 0;
        }
        if (sure && bend <= LAGC_BENT)
            break;
    }
    lagc_let(w->best_picked, chosen, 1, w);
    lagc_copy(w->y, w->held);
    return count < HUGE_VAL;
}
