/* -- conditions in which one unknown is left: where its residual changes its sign, however far away -- */

#define LAGC_RUNGS 12 /* looked at on either side of 0, up and down from the size of an unknown */
#define LAGC_HALVINGS 60 /* of an interval */

/* An unknown, a condition in which it is, and a value of it with the residual and its derivative there. */
typedef struct {
    int condition, unknown;
    double value, residual, slope;
} lagc_place;

/* The same where y has the unknown at another value. */
static lagc_place lagc_placed(const lagc_params *p, double t, double *y, double value, lagc_place at,
                              lagc_start_work *w)
{
    int k = lagc_row_begin(at.condition);
    y[at.unknown] = at.value = value;
    lagc_meet(p, t, y, w->c, w->J, w->sizes);
    while (lagc_column[k] != at.unknown)
        k++;
    at.residual = w->c[at.condition];
    at.slope = w->J[k];
    return at;
}

/* Number k of a ladder that is 0 at 0, +-size at +-(RUNGS + 1), and ever wider away from there. */
static double lagc_rung(int k, double size)
{
    const int steps = (k < 0 ? -k : k) - LAGC_RUNGS - 1;
    int n = steps * ((steps < 0 ? -steps : steps) + 1) / 2;
    double factor = k > 0 ? 1.0 : -1.0;
    for (; n > 0; n--)
        factor *= 2.0;
    for (; n < 0; n++)
        factor *= 0.5;
    return k == 0 ? 0.0 : size * factor;
}

/* Whether the residuals have opposite signs. */
static int lagc_opposite(lagc_place a, lagc_place b)
{
    return (a.residual < 0.0 && 0.0 <= b.residual) || (b.residual <= 0.0 && 0.0 < a.residual);
}

/* Whether the residual falls, in its absolute value, from a towards b. */
static int lagc_falls(lagc_place a, lagc_place b)
{
    return a.residual * (b.value - a.value) * a.slope < 0.0;
}

/* Whether residuals of the same sign may change it twice between: they fall from both sides, or from one
 * to where they are larger. */
static int lagc_hides(lagc_place a, lagc_place b)
{
    const double one = fabs(a.residual), other = fabs(b.residual);
    return lagc_falls(a, b) ? lagc_falls(b, a) || other > one : lagc_falls(b, a) && one > other;
}

/* Move y to where the residual changes its sign between a and b; 0 where it jumps there. */
static int lagc_halved(const lagc_params *p, double t, double *y, lagc_place a, lagc_place b,
                       lagc_start_work *w)
{
    const double one = fabs(a.residual), other = fabs(b.residual);
    int n;
    for (n = 0; n < LAGC_HALVINGS; n++) {
        const lagc_place middle = lagc_placed(p, t, y, 0.5 * (a.value + b.value), a, w);
        if (lagc_opposite(a, middle))
            b = middle;
        else
            a = middle;
    }
    if (fabs(a.residual) < fabs(b.residual))
        b = a;
    y[b.unknown] = b.value;
    return fabs(b.residual) <= (one < other ? one : other);
}

/* Move y to where the condition holds between a and b, if it is found to. */
static int lagc_root(const lagc_params *p, double t, double *y, lagc_place a, lagc_place b,
                     lagc_start_work *w)
{
    int n;
    for (n = 0; n < LAGC_HALVINGS; n++) {
        lagc_place middle;
        if (lagc_opposite(a, b))
            return lagc_halved(p, t, y, a, b, w);
        if (!lagc_hides(a, b))
            return 0;
        middle = lagc_placed(p, t, y, 0.5 * (a.value + b.value), a, w);
        if (lagc_opposite(a, middle))
            return lagc_halved(p, t, y, a, middle, w) || lagc_halved(p, t, y, middle, b, w);
        if (lagc_hides(a, middle))
            b = middle;
        else
            a = middle;
    }
    return 0;
}

/* Move unknown j in y to where condition i holds, found upwards and downwards by turns. */
static void lagc_meet_alone(const lagc_params *p, double t, double *y, int i, int j, lagc_start_work *w)
{
    const double home = y[j];
    const double size = home != 0.0 ? fabs(home) : w->weights[j];
    const int middle = home == 0.0 ? 0 : (home > 0.0 ? LAGC_RUNGS + 1 : -LAGC_RUNGS - 1);
    const lagc_place begin = {i, j, home, 0.0, 0.0};
    lagc_place ends[2];
    int k, side;
    ends[0] = ends[1] = lagc_placed(p, t, y, home, begin, w);
    lagc_judge(y, w->J, w->sizes, w);
    if (lagc_ratio(w->c[i], w->scales[i]) <= LAGC_ACCEPTED)
        return;
    for (k = 1; k < 3 * LAGC_RUNGS + 3; k++)
        for (side = 0; side < 2; side++) {
            const int rung = side ? middle - k : middle + k;
            if (rung <= 2 * LAGC_RUNGS + 1 && -rung <= 2 * LAGC_RUNGS + 1) {
                const lagc_place there = lagc_placed(p, t, y, lagc_rung(rung, size), ends[side], w);
                if (lagc_root(p, t, y, ends[side], there, w))
                    return;
                ends[side] = there;
            }
        }
    y[j] = home;
}

/* w->settled: the guess, where unknowns that nobody stated meet, one after the other, the conditions of
 * positions in which no other is left. */
static void lagc_settle(const lagc_params *p, double t, lagc_start_work *w)
{
    int changed = 1, i, k, r;
    lagc_copy(w->settled, w->home);
    for (i = 0; i < LAGC_NU; i++)
        w->marks[i] = w->used[i] && w->levels[i] == LAGC_UNSTATED;
    while (changed) {
        changed = 0;
        for (r = 0; r < w->positions; r++) {
            int count = 0, alone = -1;
            i = w->rows[r];
            for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
                if (w->marks[lagc_column[k]]) {
                    alone = lagc_column[k];
                    count++;
                }
            if (count == 1) {
                w->marks[alone] = 0;
                changed = 1;
                lagc_meet_alone(p, t, w->settled, i, alone, w);
            }
        }
    }
}
