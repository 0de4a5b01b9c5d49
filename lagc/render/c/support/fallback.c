/* -- [M G^T; G 0] whatever the rank of G --
 * L^-1 G^T = Q F diag(lengths) by modified Gram-Schmidt with pivoting, each vector cleaned twice;
 * rows order[rank..] depend on the others.  b holds Q by rows. */

/* Take the part of `vector` along q away; its size. */
static double lagc_remove(double *vector, const double *q)
{
    int i;
    double part = 0.0;
    for (i = 0; i < LAGC_NV; i++)
        part += vector[i] * q[i];
    for (i = 0; i < LAGC_NV; i++)
        vector[i] -= part * q[i];
    return part;
}

static double lagc_square(const double *vector)
{
    int i;
    double value = 0.0;
    for (i = 0; i < LAGC_NV; i++)
        value += vector[i] * vector[i];
    return value;
}

/* Row i of G as a unit vector in the metric of M, and its length. */
static void lagc_row(lagc_work *w, int i)
{
    double *row = w->b + i * LAGC_NV;
    double length;
    int j;
    for (j = 0; j < LAGC_NV; j++)
        row[j] = w->G[i * LAGC_NV + j];
    lagc_lower(w, row);
    length = sqrt(lagc_square(row));
    if (length > 0.0)
        length = length / w->slight[i];
    w->lengths[i] = length;
    for (j = 0; length > 0.0 && j < LAGC_NV; j++)
        row[j] = row[j] / length;
}

/* The next vector is the first row that is long enough, not the longest, so that it is always the
 * same rows that are said to depend on those before.  Rows are passed by whose gamma is made of much
 * larger terms for their length than that of others: near where a gradient vanishes, those that tell
 * the same are better. */
static void lagc_orthogonalise(lagc_work *w, double dependent)
{
    int i, j, k;
    for (i = 0; i < LAGC_NC; i++) {
        lagc_row(w, i);
        w->order[i] = i;
    }
    for (k = 0; k < LAGC_NC; k++) {
        int best = -1;
        double longest = 0.0, steadiest = HUGE_VAL, length;
        double *q;
        for (j = k; j < LAGC_NC; j++) {
            const double value = lagc_square(w->b + w->order[j] * LAGC_NV);
            w->free[w->order[j]] = value;
            if (value > longest)
                longest = value;
        }
        if (!(longest > dependent * dependent)) {
            w->rank = k;
            return;
        }
        for (j = k; j < LAGC_NC; j++) {
            i = w->order[j];
            if (w->free[i] >= 0.1 * longest && w->sizes[i] / w->lengths[i] < steadiest)
                steadiest = w->sizes[i] / w->lengths[i];
        }
        for (j = k; j < LAGC_NC; j++) {
            i = w->order[j];
            if (w->free[i] < 0.1 * longest || w->sizes[i] / w->lengths[i] > 100.0 * steadiest)
                continue;
            if (best < 0 || i < w->order[best])
                best = j;
        }
        i = w->order[best];
        w->order[best] = w->order[k];
        w->order[k] = i;
        q = w->b + i * LAGC_NV;
        for (j = 0; j < k; j++)
            w->f[j * LAGC_NC + i] += lagc_remove(q, w->b + w->order[j] * LAGC_NV);
        length = sqrt(lagc_square(q));
        w->f[k * LAGC_NC + i] = length;
        for (j = 0; j < LAGC_NV; j++)
            q[j] = q[j] / length;
        for (j = k + 1; j < LAGC_NC; j++)
            w->f[k * LAGC_NC + w->order[j]] = lagc_remove(w->b + w->order[j] * LAGC_NV, q);
    }
    w->rank = LAGC_NC;
}

/* From M and G in w.  Rows count as dependent below a share of 1e-5 that is their own: where two
 * branches of a mechanism cross, rounding rounds the corner between them within about 1e-8, and the
 * motion goes straight through only if the row is left out before.  Once rows are known to be
 * dependent (`lost`) the limit is higher, and so it is beside the constraints (`miss`), where rows
 * that depend on others on them have a share of that size of their own.  A row whose gradient all
 * but vanishes has a direction that says little: it counts for less than one (`slight`).  Where M
 * alone is singular or very uneven, M + weight G^T G takes its place: the same solution, as G a is
 * given. */
static int lagc_factor_fallback(const lagc_params *p, double t, const double *x, lagc_work *w)
{
    int i;
    double trace = 0.0, squares = 0.0;
    double least = w->lost ? 1e-4 : 1e-5;
    if (30.0 * w->miss > least)
        least = 30.0 * w->miss < 0.1 ? 30.0 * w->miss : 0.1;
    w->weight = 0.0;
    for (i = 0; i < LAGC_NC; i++)
        w->sizes[i] = 0.0;
    if (!w->lost && lagc_cholesky(w)) {
        lagc_orthogonalise(w, least);
        if (w->rank == LAGC_NC)
            return LAGC_OK;
    }
    for (i = 0; i < LAGC_NV; i++)
        trace += w->M[i * (i + 1) / 2 + i];
    for (i = 0; i < LAGC_NC * LAGC_NV; i++)
        squares += w->G[i] * w->G[i];
    if (squares > 0.0)
        w->weight = trace > 0.0 ? trace / squares : 1.0 / squares;
    if (!lagc_cholesky(w))
        return LAGC_SINGULAR_MASS;
    lagc_fn_gamma_sizes(p, t, x, w->sizes);
    lagc_orthogonalise(w, least);
    if (w->rank == LAGC_NC)
        return LAGC_OK;
    w->culprit = w->order[w->rank];
    return LAGC_REDUNDANT;
}

/* c = diag(1/lengths) F^-1 c over the independent rows */
static void lagc_triangle(const lagc_work *w, double *c)
{
    int j, k;
    for (k = w->rank - 1; k >= 0; k--) {
        double value = c[k];
        for (j = k + 1; j < w->rank; j++)
            value -= w->f[k * LAGC_NC + w->order[j]] * c[j];
        c[k] = value / w->f[k * LAGC_NC + w->order[k]];
    }
    for (k = 0; k < w->rank; k++)
        c[k] = c[k] / w->lengths[w->order[k]];
}

/* The shortest lam whose forces are those of c; free ones y minimise |c - T y|^2 + |y|^2. */
static void lagc_multipliers(lagc_work *w, double *c, double *lam)
{
    const int rank = w->rank, count = LAGC_NC - rank;
    int e, f, k;
    double *y = w->free, *normal = w->normal;
    lagc_triangle(w, c);
    for (k = 0; k < rank; k++)
        lam[w->order[k]] = c[k];
    for (f = 0; f < count; f++) {
        const int i = w->order[rank + f];
        double *column = w->table + f * LAGC_NC;
        for (k = 0; k < rank; k++)
            column[k] = w->f[k * LAGC_NC + i] * w->lengths[i];
        lagc_triangle(w, column);
    }
    for (f = 0; f < count; f++) {
        const double *column = w->table + f * LAGC_NC;
        double value;
        for (e = 0; e <= f; e++) {
            const double *other = w->table + e * LAGC_NC;
            value = e == f ? 1.0 : 0.0;
            for (k = 0; k < rank; k++)
                value += column[k] * other[k];
            for (k = 0; k < e; k++)
                value -= normal[f * LAGC_NC + k] * normal[e * LAGC_NC + k];
            normal[f * LAGC_NC + e] = e < f ? value / normal[e * LAGC_NC + e] : sqrt(value);
        }
        value = 0.0;
        for (k = 0; k < rank; k++)
            value += column[k] * c[k];
        for (k = 0; k < f; k++)
            value -= normal[f * LAGC_NC + k] * y[k];
        y[f] = value / normal[f * LAGC_NC + f];
    }
    for (f = count - 1; f >= 0; f--) {
        const double *column = w->table + f * LAGC_NC;
        double value = y[f];
        for (k = f + 1; k < count; k++)
            value -= normal[k * LAGC_NC + f] * y[k];
        y[f] = value / normal[f * LAGC_NC + f];
        lam[w->order[rank + f]] = y[f];
        for (k = 0; k < rank; k++)
            lam[w->order[k]] -= column[k] * y[f];
    }
}

/* M z - G^T lam = r1, G z = r2; z holds r1 at first.  A row that depends on others contradicts them
 * where it misses r2 by more than a share of what r2 is made of: of the accelerations, and of the
 * terms of gamma, which are all that is left where its gradient vanishes. */
static int lagc_solve_fallback(lagc_work *w, const double *r2, double *z, double *lam)
{
    const int rank = w->rank;
    int i, j, k, status = rank == LAGC_NC ? LAGC_OK : LAGC_REDUNDANT;
    double value, size = 0.0, longest = 0.0, worst = 1e-3;
    double *c = w->found;
    for (i = 0; w->weight > 0.0 && i < LAGC_NC; i++) {
        const double factor = w->weight * r2[i];
        for (j = 0; j < LAGC_NV; j++)
            z[j] += factor * w->G[i * LAGC_NV + j];
    }
    lagc_lower(w, z);
    for (j = 0; j < LAGC_NV; j++)
        size += z[j] * z[j];
    for (k = 0; k < rank; k++) {
        i = w->order[k];
        value = r2[i] / w->lengths[i];
        for (j = 0; j < k; j++)
            value -= w->f[j * LAGC_NC + i] * c[j];
        c[k] = value / w->f[k * LAGC_NC + i];
        size += c[k] * c[k];
        if (w->lengths[i] > longest)
            longest = w->lengths[i];
    }
    size = longest * sqrt(size);
    for (k = rank; k < LAGC_NC; k++) {
        double share;
        i = w->order[k];
        value = 0.0;
        for (j = 0; j < rank; j++)
            value += w->f[j * LAGC_NC + i] * c[j];
        value = r2[i] - w->lengths[i] * value;
        share = fabs(value) / (fabs(r2[i]) + size + w->sizes[i] + 1e-300);
        if (share > worst) {
            status = LAGC_INCONSISTENT;
            w->culprit = i;
            worst = share;
        }
    }
    for (k = 0; k < rank; k++) {
        const double *q = w->b + w->order[k] * LAGC_NV;
        value = c[k];
        for (j = 0; j < LAGC_NV; j++)
            value -= q[j] * z[j];
        c[k] = value;
    }
    for (k = 0; k < rank; k++) {
        const double *q = w->b + w->order[k] * LAGC_NV;
        for (j = 0; j < LAGC_NV; j++)
            z[j] += q[j] * c[k];
    }
    lagc_upper(w, z);
    lagc_multipliers(w, c, lam);
    return status;
}
