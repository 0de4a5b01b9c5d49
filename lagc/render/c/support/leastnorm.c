/* -- the shortest solution of a linear system -- */

static double lagc_inner(const double *a, const double *b, int n)
{
    double total = 0.0;
    int j;
    for (j = 0; j < n; j++)
        total += a[j] * b[j];
    return total;
}

/* Take from a vector its part along a unit vector. */
static void lagc_clear(double *vector, const double *direction, int n)
{
    const double part = lagc_inner(vector, direction, n);
    int j;
    if (part != 0.0)
        for (j = 0; j < n; j++)
            vector[j] -= part * direction[j];
}

static void lagc_shorten(double *vector, int n)
{
    const double length = sqrt(lagc_inner(vector, vector, n));
    int j;
    for (j = 0; j < n; j++)
        vector[j] = vector[j] / length;
}

/* w->step[n], the shortest solution of the m rows of w->matrix (which are lost) with the right-hand
 * sides w->right; 0 where a number is not finite.  Rows that depend on the ones before (to
 * `dependent` of their length) are left out, the longest remaining row first: a modified
 * Gram-Schmidt factorisation, each row orthogonalised twice. */
static int lagc_least_norm(lagc_start_work *w, int m, int n, double dependent)
{
    int i, j, k, given = 0, chosen = 0;
    for (j = 0; j < n; j++)
        w->step[j] = 0.0;
    for (i = 0; i < m; i++) {
        const double *row = w->matrix + i * n;
        double *scaled = w->matrix + given * n, *rest = w->rests + given * n;
        double largest = 0.0, length;
        for (j = 0; j < n; j++)
            if (!(fabs(row[j]) <= largest))
                largest = fabs(row[j]);
        if (!(largest < HUGE_VAL && fabs(w->right[i]) < HUGE_VAL))
            return 0;
        if (largest == 0.0)
            continue;
        for (j = 0; j < n; j++)
            scaled[j] = row[j] / largest;
        length = sqrt(lagc_inner(scaled, scaled, n));
        for (j = 0; j < n; j++) {
            scaled[j] = scaled[j] / length;
            rest[j] = scaled[j];
        }
        w->right[given] = w->right[i] / largest / length;
        w->chosen[given] = 0;
        given++;
    }
    for (k = 0; k < given; k++) {
        int best = -1;
        double longest = dependent * dependent, factor;
        double *direction;
        for (i = 0; i < given; i++)
            if (!w->chosen[i]) {
                const double square = lagc_inner(w->rests + i * n, w->rests + i * n, n);
                if (square > longest) {
                    best = i;
                    longest = square;
                }
            }
        if (best < 0)
            break;
        direction = w->rests + best * n;
        lagc_shorten(direction, n);
        for (j = 1; j <= chosen; j++)
            for (i = 0; i < given; i++)
                if (w->chosen[i] == j)
                    lagc_clear(direction, w->rests + i * n, n);
        lagc_shorten(direction, n);
        chosen++;
        w->chosen[best] = chosen;
        factor = (w->right[best] - lagc_inner(w->matrix + best * n, w->step, n)) /
                 lagc_inner(w->matrix + best * n, direction, n);
        for (j = 0; j < n; j++)
            w->step[j] += factor * direction[j];
        for (i = 0; i < given; i++)
            if (!w->chosen[i])
                lagc_clear(w->rests + i * n, direction, n);
    }
    return 1;
}
