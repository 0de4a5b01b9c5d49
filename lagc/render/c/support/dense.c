/* -- the mass matrix, dense -- */

/* An entry of M; of M + weight G^T G where weight > 0. */
static double lagc_mass_entry(const lagc_work *w, int i, int j)
{
    double value = w->M[i * (i + 1) / 2 + j];
#if LAGC_NC
    int k;
    for (k = 0; w->weight > 0.0 && k < LAGC_NC; k++)
        value += w->weight * w->G[k * LAGC_NV + i] * w->G[k * LAGC_NV + j];
#endif
    return value;
}

/* M = L L^T, packed by rows, column after column; 0 where M is singular. */
static int lagc_cholesky(lagc_work *w)
{
    double *column = w->column;
    int i, j, k;
    for (i = 0; i < LAGC_NV; i++)
        for (j = 0; j <= i; j++)
            w->low[i * (i + 1) / 2 + j] = lagc_mass_entry(w, i, j);
    for (k = 0; k < LAGC_NV; k++) {
        double *pivot = w->low + k * (k + 1) / 2 + k;
        if (!(*pivot > 1e-13 * lagc_mass_entry(w, k, k))) {
            w->culprit = k;
            return 0;
        }
        *pivot = sqrt(*pivot);
        for (i = k + 1; i < LAGC_NV; i++) {
            double *row = w->low + i * (i + 1) / 2;
            double factor;
            row[k] = row[k] / *pivot;
            factor = row[k];
            column[i] = factor;
            for (j = k + 1; j <= i; j++)
                row[j] -= factor * column[j];
        }
    }
    return 1;
}

/* z = L^-1 z */
static void lagc_lower(const lagc_work *w, double *z)
{
    int i, k;
    for (i = 0; i < LAGC_NV; i++) {
        const int start = i * (i + 1) / 2;
        double value = z[i];
        for (k = 0; k < i; k++)
            value -= w->low[start + k] * z[k];
        z[i] = value / w->low[start + i];
    }
}

/* z = L^-T z */
static void lagc_upper(const lagc_work *w, double *z)
{
    int i, k;
    for (i = LAGC_NV - 1; i >= 0; i--) {
        const int start = i * (i + 1) / 2;
        const double value = z[i] / w->low[start + i];
        z[i] = value;
        for (k = 0; k < i; k++)
            z[k] -= w->low[start + k] * value;
    }
}
