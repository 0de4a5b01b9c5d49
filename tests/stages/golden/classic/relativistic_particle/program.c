/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real der_x = x[1];
    /* der(x) */
    xdot[0] = der_x;
    const lagc_real m = p->m;
    const lagc_real t0 = der_x * der_x;
    const lagc_real c_ = p->c;
    const lagc_real t1 = c_ * c_;
    health[0] = 1.0;
    const lagc_real t2 = 1.0 - t0 / t1;
    /* der(der(x)) */
    xdot[1] = -(p->k * x[0] / ((m + m * t0 / (t1 * t2)) / sqrt(t2)));
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint rows */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_x = x[1];
    qdot[0] = der_x;
    const lagc_real m = p->m;
    const lagc_real t0 = der_x * der_x;
    const lagc_real c_ = p->c;
    const lagc_real t1 = c_ * c_;
    const lagc_real t2 = 1.0 - t0 / t1;
    M[0] = (m + m * t0 / (t1 * t2)) / sqrt(t2);
    r[0] = -(p->k * x[0]);
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real m = p->m;
    const lagc_real c_ = p->c;
    const lagc_real t0 = c_ * c_;
    const lagc_real der_x = x[1];
    const lagc_real t1 = der_x * der_x;
    const lagc_real t2 = sqrt(1.0 - t1 / t0);
    const lagc_real t3 = m * (t0 * t2 + t1 / t2);
    const lagc_real t4 = m * t0;
    /* kinetic energy */
    e[0] = t3 - t4;
    const lagc_real x_ = x[0];
    const lagc_real t5 = x_ * (p->k * x_) * 0.5;
    /* potential energy */
    e[1] = t4 + t5;
    /* energy of the balance */
    e[2] = t5 + t3;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real x_ = x[0];
    const lagc_real c_ = p->c;
    const lagc_real t0 = c_ * c_;
    const lagc_real der_x = x[1];
    const lagc_real t1 = der_x * der_x;
    const lagc_real t2 = sqrt(1.0 - t1 / t0);
    /* E */
    y[0] = x_ * (p->k * x_) * 0.5 + p->m * (t0 * t2 + t1 / t2);
    (void)(t);
    (void)(a);
    (void)(lam);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* x */
    x[0] = 2.0;
    /* der(x) */
    x[1] = 0.0;
    (void)(p);
}
