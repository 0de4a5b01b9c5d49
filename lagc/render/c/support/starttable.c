/* -- the conditions made linear: what they ask of stated values -- */

#define LAGC_NEGLIGIBLE 1e-9 /* of the largest slope of a row: a pivot that counts as zero */

/* Solve row i of m for column k of n, and take it from the others. */
static void lagc_pivot(double *rows, int m, int n, int i, int k)
{
    double *pivot = rows + i * n;
    const double scale = pivot[k];
    int r, j;
    for (j = 0; j < n; j++)
        pivot[j] = pivot[j] / scale;
    for (r = 0; r < m; r++) {
        double *row = rows + r * n;
        const double part = row[k];
        if (r != i && part != 0.0)
            for (j = 0; j < n; j++)
                row[j] = row[j] - part * pivot[j];
    }
}

/* Gauss-Jordan with complete pivoting on the m rows of w->rests, n columns and the right-hand side:
 * how many were solved, w->solved, for the columns w->basis. */
static int lagc_solved(int m, int n, lagc_start_work *w)
{
    int count = 0, i, k;
    for (i = 0; i < m; i++)
        w->chosen[i] = 0;
    for (;;) {
        int at = -1, column = -1;
        double largest = LAGC_NEGLIGIBLE;
        for (i = 0; i < m; i++)
            if (!w->chosen[i])
                for (k = 0; k < n; k++)
                    if (fabs(w->rests[i * (n + 1) + k]) > largest) {
                        at = i;
                        column = k;
                        largest = fabs(w->rests[i * (n + 1) + k]);
                    }
        if (at < 0)
            return count;
        lagc_pivot(w->rests, m, n + 1, at, column);
        w->chosen[at] = 1;
        w->solved[count] = at;
        w->basis[count++] = column;
    }
}

/* In w->rests the conditions T d = r, linear with the slopes `at` a point, in the moves d (in weights) of
 * the n values w->stated from `beside`: what is free eliminated, and Gauss-Jordan on the columns of the
 * basis; how many these are. */
static int lagc_table(const lagc_params *p, double t, const double *at, const double *beside, int n,
                      lagc_start_work *w)
{
    int first = 0, width, m = 0, i, j, k, r;
    for (i = 0; i < LAGC_NU; i++)
        w->places[i] = -1;
    for (i = 0; i < LAGC_NU; i++)
        if (w->loose[i] && w->used[i])
            w->places[i] = first++;
    for (k = 0; k < n; k++)
        w->places[w->stated[k]] = first + k;
    width = first + n + 1;
    lagc_meet(p, t, beside, w->c, w->J, w->sizes);
    lagc_meet(p, t, at, w->trial_c, w->J, w->sizes);
    for (r = 0; r < w->ended; r++) {
        double *row = w->rests + m * width;
        double largest = 0.0;
        i = w->rows[r];
        for (j = 0; j < width; j++)
            row[j] = 0.0;
        for (k = lagc_row_begin(i); k < lagc_ends[i]; k++)
            if (w->places[lagc_column[k]] >= 0) {
                const double value = w->J[k] * w->weights[lagc_column[k]];
                row[w->places[lagc_column[k]]] = value;
                if (!(fabs(value) <= largest))
                    largest = fabs(value);
            }
        if (0.0 < largest && largest < HUGE_VAL) {
            row[width - 1] = -w->c[i];
            for (j = 0; j < width; j++)
                row[j] = row[j] / largest;
            w->chosen[m++] = 0;
        }
    }
    w->work++;
    for (k = 0; k < first; k++) {
        int best = -1;
        double largest = LAGC_NEGLIGIBLE;
        for (r = 0; r < m; r++)
            if (!w->chosen[r] && fabs(w->rests[r * width + k]) > largest) {
                best = r;
                largest = fabs(w->rests[r * width + k]);
            }
        if (best < 0)
            continue;
        w->chosen[best] = 1;
        for (r = 0; r < m; r++) {
            double *row = w->rests + r * width;
            const double *pivot = w->rests + best * width;
            if (!w->chosen[r] && row[k] != 0.0) {
                const double part = row[k] / pivot[k];
                for (j = k; j < width; j++)
                    row[j] -= part * pivot[j];
            }
        }
    }
    i = 0;
    for (r = 0; r < m; r++)
        if (!w->chosen[r]) {
            for (j = 0; j <= n; j++)
                w->rests[i * (n + 1) + j] = w->rests[r * width + first + j];
            i++;
        }
    w->left = i;
    return lagc_solved(i, n, w);
}

/* w->ways: the moves of the k picked of n columns alone that satisfy all rows; 0 where there are none. */
static int lagc_ways(int n, int k, lagc_start_work *w)
{
    int i, j, r;
    for (r = 0; r < k; r++) {
        const double *row = w->rests + w->solved[r] * (n + 1);
        for (i = 0; i < k; i++)
            w->matrix[r * (k + 1) + i] = row[w->picked[i]];
        w->matrix[r * (k + 1) + k] = row[n];
    }
    for (i = 0; i < k; i++) {
        int best = -1;
        double largest = LAGC_NEGLIGIBLE;
        for (r = i; r < k; r++)
            if (fabs(w->matrix[r * (k + 1) + i]) > largest) {
                best = r;
                largest = fabs(w->matrix[r * (k + 1) + i]);
            }
        if (best < 0)
            return 0;
        for (j = 0; j <= k; j++) {
            const double other = w->matrix[i * (k + 1) + j];
            w->matrix[i * (k + 1) + j] = w->matrix[best * (k + 1) + j];
            w->matrix[best * (k + 1) + j] = other;
        }
        lagc_pivot(w->matrix, k, k + 1, i, i);
    }
    for (r = 0; r < k; r++)
        w->ways[r] = w->matrix[r * (k + 1) + k];
    return 1;
}
