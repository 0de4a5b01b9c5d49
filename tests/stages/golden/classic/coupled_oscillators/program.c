/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[2] = m;
    prepared[0] = 1.0 / m;
    prepared[1] = m * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    /* der(x1) */
    xdot[0] = x[2];
    /* der(x2) */
    xdot[1] = x[3];
    const lagc_real the_x2 = x[1];
    const lagc_real the_x1 = x[0];
    const lagc_real t0 = (the_x2 - the_x1) * p->c;
    const lagc_real k = p->k;
    const lagc_real prepared0 = p->prepared[0];
    /* der(der(x1)) */
    xdot[2] = (t0 - the_x1 * k) * prepared0;
    /* der(der(x2)) */
    xdot[3] = -(prepared0 * (t0 + the_x2 * k));
    health[0] = 1.0;
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    qdot[0] = x[2];
    qdot[1] = x[3];
    const lagc_real m = p->m;
    M[0] = m;
    M[2] = m;
    M[1] = 0.0;
    const lagc_real the_x2 = x[1];
    const lagc_real the_x1 = x[0];
    const lagc_real t0 = (the_x2 - the_x1) * p->c;
    const lagc_real k = p->k;
    r[0] = t0 - the_x1 * k;
    r[1] = -(t0 + the_x2 * k);
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x1 = x[2];
    const lagc_real der_x2 = x[3];
    const lagc_real t0 = (der_x1 * der_x1 + der_x2 * der_x2) * p->prepared[1];
    /* kinetic energy */
    e[0] = t0;
    const lagc_real the_x1 = x[0];
    const lagc_real the_x2 = x[1];
    const lagc_real t1 = the_x2 - the_x1;
    const lagc_real t2 = 0.5 * ((the_x1 * the_x1 + the_x2 * the_x2) * p->k + p->c * (t1 * t1));
    /* potential energy */
    e[1] = t2;
    /* energy of the balance */
    e[2] = t0 + t2;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* E */
    y[0] = e[0] + e[1];
    (void)(p);
    (void)(t);
    (void)(x);
    (void)(a);
    (void)(lam);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* x1 */
    x[0] = 0.1;
    /* x2 */
    x[1] = 0.0;
    /* der(x1) */
    x[2] = 0.0;
    /* der(x2) */
    x[3] = 0.0;
    (void)(p);
}
