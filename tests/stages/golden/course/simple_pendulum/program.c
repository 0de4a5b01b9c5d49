/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real field_g = p->field_g;
    prepared[6] = field_g;
    const lagc_real m = p->m;
    prepared[4] = m;
    const lagc_real l = p->l;
    prepared[5] = l;
    const lagc_real t0 = m * l;
    const lagc_real t1 = field_g * t0;
    prepared[2] = t1;
    const lagc_real t2 = l * t0;
    prepared[1] = t2;
    prepared[0] = t1 * (1.0 / t2);
    prepared[3] = t2 * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    /* der(theta) */
    xdot[0] = x[1];
    lagc_real sc0[2]; lagc_sine_cosine(x[0], sc0);
    /* der(der(theta)) */
    xdot[1] = -(sc0[0] * p->prepared[0]);
    health[0] = 1.0;
    health[1] = 0.0;
    (void)t; (void)lam;
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    qdot[0] = x[1];
    M[0] = p->prepared[1];
    lagc_real sc0[2]; lagc_sine_cosine(x[0], sc0);
    r[0] = -(sc0[0] * p->prepared[2]);
    (void)t; (void)G; (void)gamma;
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_theta = x[1];
    const lagc_real t0 = der_theta * der_theta * p->prepared[3];
    /* kinetic energy */
    e[0] = t0;
    lagc_real sc0[2]; lagc_sine_cosine(x[0], sc0);
    const lagc_real t1 = sc0[1] * p->prepared[2];
    /* potential energy */
    e[1] = -t1;
    /* energy of the balance */
    e[2] = t0 - t1;
    (void)t;
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* E */
    y[0] = e[0] + e[1];
    (void)p; (void)t; (void)x; (void)a; (void)lam;
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* theta */
    x[0] = 1.0471975511965976;
    /* der(theta) */
    x[1] = 0.0;
    (void)p;
}
