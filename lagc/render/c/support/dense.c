/* -- the mass matrix, dense -- */

/* M = L L^T, packed by rows; M + weight G^T G where weight > 0.  0 where it is singular. */
static int lagc_cholesky(lagc_work *w)
{
    int i, j, k;
    double value, whole;
    for (i = 0; i < LAGC_NV; i++) {
        const int start = i * (i + 1) / 2;
        for (j = 0; j <= i; j++) {
            const int other = j * (j + 1) / 2;
            value = w->M[start + j];
#if LAGC_NC
            for (k = 0; w->weight > 0.0 && k < LAGC_NC; k++)
                value += w->weight * w->G[k * LAGC_NV + i] * w->G[k * LAGC_NV + j];
#endif
            whole = value;
            for (k = 0; k < j; k++)
                value -= w->low[start + k] * w->low[other + k];
            if (j < i) {
                w->low[start + j] = value / w->low[other + j];
            } else if (value > 1e-13 * whole) {
                w->low[start + j] = sqrt(value);
            } else {
                w->culprit = i;
                return 0;
            }
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
