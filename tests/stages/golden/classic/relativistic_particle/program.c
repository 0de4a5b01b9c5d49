/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[4] = m;
    const lagc_real c_ = p->c;
    prepared[5] = c_;
    const lagc_real t0 = c_ * c_;
    prepared[0] = m / t0;
    prepared[1] = 1.0 / t0;
    prepared[2] = m * t0;
    const lagc_real k = p->k;
    prepared[6] = k;
    prepared[3] = k * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real der_x = x[1];
    /* der(x) */
    xdot[0] = der_x;
    const lagc_real t0 = der_x * der_x;
    health[0] = 1.0;
    const lagc_real t1 = 1.0 - t0 * p->prepared[1];
    /* der(der(x)) */
    xdot[1] = -(x[0] * p->k / ((t0 * p->prepared[0] / t1 + p->m) / sqrt(t1)));
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_x = x[1];
    qdot[0] = der_x;
    const lagc_real t0 = der_x * der_x;
    const lagc_real t1 = 1.0 - t0 * p->prepared[1];
    M[0] = (t0 * p->prepared[0] / t1 + p->m) / sqrt(t1);
    r[0] = -(x[0] * p->k);
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[1];
    const lagc_real t0 = der_x * der_x;
    const lagc_real t1 = sqrt(1.0 - t0 * p->prepared[1]);
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t2 = t1 * prepared2 + t0 * p->m / t1;
    /* kinetic energy */
    e[0] = t2 - prepared2;
    const lagc_real x_ = x[0];
    const lagc_real t3 = x_ * x_ * p->prepared[3];
    /* potential energy */
    e[1] = prepared2 + t3;
    /* energy of the balance */
    e[2] = t2 + t3;
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
    /* x */
    x[0] = 2.0;
    /* der(x) */
    x[1] = 0.0;
    (void)(p);
}

/* divisors that may come near zero */
static void lagc_fn_poles(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[1];
    e[0] = 1.0 - der_x * der_x * p->prepared[1];
    (void)(t);
}

/* bounds of these in a box */
static void lagc_fn_pole_bounds(const lagc_params *p, const lagc_real *box, lagc_real *e)
{
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real box2 = box[2];
    const lagc_real box5 = box[5];
    const lagc_real t0 = lagc_max(0.0, lagc_max(box2, -box5));
    const lagc_real t1 = prepared1 * (t0 * t0);
    const lagc_real t2 = lagc_max(-box2, box5);
    const lagc_real t3 = prepared1 * (t2 * t2);
    e[0] = 1.0 - lagc_max(t1, t3);
    e[1] = 1.0 - lagc_min(t1, t3);
}
