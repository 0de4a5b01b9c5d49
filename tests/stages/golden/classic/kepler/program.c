/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[4] = m;
    const lagc_real mu = p->mu;
    prepared[5] = mu;
    prepared[0] = m * mu;
    prepared[1] = 1.0 / m;
    prepared[2] = m * 0.5;
    prepared[3] = 1.0 / mu;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    /* der(x) */
    xdot[0] = x[2];
    /* der(y) */
    xdot[1] = x[3];
    const lagc_real x_ = x[0];
    const lagc_real y_ = x[1];
    const lagc_real t0 = x_ * x_ + y_ * y_;
    const lagc_real t1 = p->prepared[0] / (t0 * sqrt(t0));
    const lagc_real prepared1 = p->prepared[1];
    /* der(der(x)) */
    xdot[2] = -(x_ * t1 * prepared1);
    /* der(der(y)) */
    xdot[3] = -(prepared1 * (y_ * t1));
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
    const lagc_real x_ = x[0];
    const lagc_real y_ = x[1];
    const lagc_real t0 = x_ * x_ + y_ * y_;
    const lagc_real t1 = p->prepared[0] / (t0 * sqrt(t0));
    r[0] = -(x_ * t1);
    r[1] = -(y_ * t1);
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[2];
    const lagc_real der_y = x[3];
    const lagc_real t0 = (der_x * der_x + der_y * der_y) * p->prepared[2];
    /* kinetic energy */
    e[0] = t0;
    const lagc_real x_ = x[0];
    const lagc_real y_ = x[1];
    const lagc_real t1 = p->prepared[0] / sqrt(x_ * x_ + y_ * y_);
    /* potential energy */
    e[1] = -t1;
    /* energy of the balance */
    e[2] = t0 - t1;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* E */
    y[0] = e[0] + e[1];
    const lagc_real x_ = x[0];
    const lagc_real der_y = x[3];
    const lagc_real y_ = x[1];
    const lagc_real der_x = x[2];
    const lagc_real t0 = x_ * der_y - y_ * der_x;
    /* L */
    y[1] = t0 * p->m;
    const lagc_real t1 = t0 * p->prepared[3];
    const lagc_real t2 = sqrt(x_ * x_ + y_ * y_);
    /* ex */
    y[2] = der_y * t1 - x_ / t2;
    /* ey */
    y[3] = -(y_ / t2 + der_x * t1);
    (void)(t);
    (void)(a);
    (void)(lam);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    const lagc_real e_ = p->e;
    const lagc_real t0 = p->a * (1.0 - e_);
    /* x */
    x[0] = t0;
    /* y */
    x[1] = 0.0;
    /* der(x) */
    x[2] = 0.0;
    /* der(y) */
    x[3] = sqrt(p->mu * (1.0 + e_) / t0);
}

/* divisors that may come near zero */
static void lagc_fn_poles(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real x_ = x[0];
    const lagc_real y_ = x[1];
    e[0] = x_ * x_ + y_ * y_;
    (void)(p);
    (void)(t);
}

/* bounds of these in a box */
static void lagc_fn_pole_bounds(const lagc_params *p, const lagc_real *box, lagc_real *e)
{
    const lagc_real box1 = box[1];
    const lagc_real box6 = box[6];
    const lagc_real t0 = lagc_max(0.0, lagc_max(box1, -box6));
    const lagc_real box2 = box[2];
    const lagc_real box7 = box[7];
    const lagc_real t1 = lagc_max(0.0, lagc_max(box2, -box7));
    e[0] = t0 * t0 + t1 * t1;
    const lagc_real t2 = lagc_max(-box1, box6);
    const lagc_real t3 = lagc_max(-box2, box7);
    e[1] = t2 * t2 + t3 * t3;
    (void)(p);
}
