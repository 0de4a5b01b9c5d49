/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[3] = m;
    prepared[0] = 1.0 / m;
    prepared[1] = m * 0.5;
    const lagc_real k = p->k;
    prepared[4] = k;
    prepared[2] = k * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real der_x = x[1];
    /* der(x) */
    xdot[0] = der_x;
    const lagc_real u = p->u;
    lagc_real sc0[2]; lagc_sine_cosine(t * p->w, sc0);
    const lagc_real t0 = sc0[1] * p->F0;
    const lagc_real c_ = p->c;
    /* der(der(x)) */
    xdot[1] = (u + (t0 - der_x * c_ - x[0] * p->k)) * p->prepared[0];
    xdot[2] = der_x * (u + t0) - c_ * (der_x * der_x);
    health[0] = 1.0;
    health[1] = 0.0;
    (void)(lam);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_x = x[1];
    qdot[0] = der_x;
    M[0] = p->m;
    lagc_real sc0[2]; lagc_sine_cosine(t * p->w, sc0);
    r[0] = p->u + (sc0[1] * p->F0 - der_x * p->c - x[0] * p->k);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[1];
    const lagc_real t0 = der_x * der_x * p->prepared[1];
    /* kinetic energy */
    e[0] = t0;
    const lagc_real x_ = x[0];
    const lagc_real t1 = x_ * x_ * p->prepared[2];
    /* potential energy */
    e[1] = t1;
    /* energy of the balance */
    e[2] = t0 + t1;
    (void)(t);
}

/* rate of that energy */
static void lagc_fn_power(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *e)
{
    const lagc_real der_x = x[1];
    lagc_real sc0[2]; lagc_sine_cosine(t * p->w, sc0);
    e[0] = der_x * (p->u + sc0[1] * p->F0 - der_x * p->c);
    (void)(a);
    (void)(lam);
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
    /* x */
    x[0] = 0.0;
    /* der(x) */
    x[1] = 0.0;
    x[2] = 0.0;
    (void)(p);
}
