/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[10] = m;
    const lagc_real a_ = p->a;
    prepared[12] = a_;
    const lagc_real t0 = m * a_;
    prepared[0] = t0;
    const lagc_real I_ = p->I_;
    prepared[11] = I_;
    const lagc_real t1 = a_ * t0;
    const lagc_real t2 = I_ + t1;
    prepared[7] = t2;
    const lagc_real t3 = 1.0 / t2;
    prepared[4] = t3;
    const lagc_real t4 = t0 * t3;
    prepared[1] = t4;
    const lagc_real t5 = m - t0 * t4;
    const lagc_real t6 = 1.0 / t5;
    prepared[2] = t6;
    prepared[3] = 1.0 / t6;
    prepared[5] = 1.0 / m;
    prepared[6] = t5 / m;
    prepared[8] = t1 * 0.5 + I_ * 0.5;
    prepared[9] = m * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real theta = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(theta, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[0];
    const lagc_real u = x[3];
    const lagc_real w_ = x[5];
    /* der(theta) */
    xdot[2] = w_;
    const lagc_real t2 = u * w_;
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t3 = prepared0 * t2;
    health[3] = t3;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real m = p->m;
    const lagc_real t4 = m * t2;
    health[2] = t4;
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t5 = (t3 * prepared1 - t4) * prepared2;
    const lagc_real t6 = t5 * p->prepared[3];
    health[5] = t6;
    const lagc_real s_ = x[4];
    const lagc_real t7 = t5 - prepared2 * t6;
    /* der(s) */
    xdot[4] = t7;
    health[6] = t7;
    const lagc_real t8 = w_ * (s_ * m + w_ * prepared0);
    health[4] = t8;
    const lagc_real t9 = t3 * p->prepared[4] + prepared1 * t7;
    health[7] = t9;
    /* der(x) */
    xdot[0] = u * t0 - s_ * t1;
    /* der(y) */
    xdot[1] = u * t1 + t0 * s_;
    const lagc_real t10 = t8 * p->prepared[5];
    /* der(u) */
    xdot[3] = t10;
    health[8] = t10;
    /* der(w) */
    xdot[5] = -t9;
    /* edge, chaplygin_sleigh_speeds.lag:23 */
    lam[0] = -t6;
    health[1] = 0.0;
    health[0] = p->prepared[6];
    (void)(t);
}

/* what a solution leaves of its right-hand side */
static void lagc_fn_watch(const lagc_params *p, lagc_real *health)
{
    const lagc_real health7 = health[7];
    const lagc_real t0 = health7 * p->prepared[7];
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real m = p->m;
    const lagc_real health6 = health[6];
    const lagc_real t1 = m * health6;
    const lagc_real t2 = health[8] * m;
    const lagc_real health3 = health[3];
    const lagc_real health2 = health[2];
    const lagc_real health4 = health[4];
    const lagc_real t3 = health4 - t2;
    const lagc_real t4 = t0 - health3 - health6 * prepared0;
    const lagc_real t5 = health7 * prepared0 - t1 - (health2 + health[5]);
    const lagc_real prepared5 = p->prepared[5];
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t6 = t3 * (t3 * prepared5) + p->prepared[3] * (health6 * health6);
    const lagc_real t7 = prepared4 * (health3 * health3 + t0 * t0) + prepared2 * (health2 * health2 + t1 * t1);
    const lagc_real t8 = prepared5 * (health4 * health4 + t2 * t2) + 1e-300 + t7;
    health[1] = (t6 + (t4 * (t4 * prepared4) + t5 * (t5 * prepared2))) / t8;
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real u = x[3];
    const lagc_real theta = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(theta, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real s_ = x[4];
    const lagc_real t1 = sc0[0];
    qdot[0] = u * t0 - s_ * t1;
    qdot[1] = u * t1 + t0 * s_;
    const lagc_real w_ = x[5];
    qdot[2] = w_;
    const lagc_real m = p->m;
    M[0] = m;
    M[2] = m;
    M[1] = 0.0;
    M[3] = 0.0;
    G[0] = 0.0;
    G[2] = 0.0;
    gamma[0] = 0.0;
    const lagc_real prepared0 = p->prepared[0];
    M[4] = prepared0;
    M[5] = p->prepared[7];
    r[0] = w_ * (s_ * m + w_ * prepared0);
    const lagc_real t2 = u * w_;
    r[1] = -(m * t2);
    r[2] = -(prepared0 * t2);
    G[1] = 1.0;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real m = p->m;
    w[0] = m;
    w[1] = m;
    w[2] = p->prepared[0];
    w[3] = p->prepared[7];
    w[4] = 1.0;
    (void)(t);
    (void)(x);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real w2 = w[2];
    const lagc_real t0 = 1.0 / w[3];
    w[8] = t0;
    const lagc_real t1 = w2 * t0;
    w[5] = t1;
    const lagc_real w1 = w[1];
    const lagc_real t2 = w1 - w2 * t1;
    const lagc_real t3 = 1.0 / t2;
    w[6] = t3;
    w[9] = t3;
    w[7] = 1.0 / w[0];
    w[10] = -(1.0 / t3);
    health[0] = t2 / w1;
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    s[0] = r[0] * w[7];
    const lagc_real r2 = r[2];
    const lagc_real w5 = w[5];
    const lagc_real t0 = r[1] - r2 * w5;
    const lagc_real w6 = w[6];
    const lagc_real t1 = w[10] * (r[3] - w6 * t0);
    const lagc_real t2 = w[9] * t0 - w6 * t1;
    s[1] = t2;
    s[2] = r2 * w[8] - w5 * t2;
    s[3] = -t1;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real t1 = s[1];
    const lagc_real t2 = s[3];
    const lagc_real t3 = s[2];
    const lagc_real w2 = w[2];
    const lagc_real w5 = w[5];
    const lagc_real t4 = r[2] - t1 * w2 - t3 * w[3];
    const lagc_real t5 = t2 + (r[1] - t1 * w[1] - t3 * w2) - w5 * t4;
    const lagc_real w6 = w[6];
    const lagc_real t6 = w[10] * (r[3] - t1 - w6 * t5);
    const lagc_real t7 = w[9] * t5 - w6 * t6;
    const lagc_real t8 = t0 + w[7] * (r[0] - t0 * w[0]);
    const lagc_real t9 = t1 + t7;
    const lagc_real t10 = t3 + (w[8] * t4 - w5 * t7);
    const lagc_real t11 = -(t6 - t2);
    s[0] = t8;
    s[1] = t9;
    s[2] = t10;
    s[3] = t11;
}

/* dq = N(t,q) d */
static void lagc_fn_displace(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *d, lagc_real *dq)
{
    const lagc_real d0 = d[0];
    const lagc_real theta = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(theta, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real d1 = d[1];
    const lagc_real t1 = sc0[0];
    dq[0] = d0 * t0 - d1 * t1;
    dq[1] = d0 * t1 + t0 * d1;
    dq[2] = d[2];
    (void)(p);
    (void)(t);
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    (void)(p);
    (void)(t);
    (void)(x);
    (void)(phi);
}

/* rates of the constraint equations */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    /* edge, chaplygin_sleigh_speeds.lag:23 */
    psi[0] = x[4];
    (void)(p);
    (void)(t);
}

/* size of the terms of each constraint equation */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    s[0] = fabs(x[4]) * 2.0 + 1e-300;
    (void)(p);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    s[0] = 0.0;
    (void)(p);
    (void)(t);
    (void)(x);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    s[0] = 1.0;
    (void)(p);
    (void)(t);
    (void)(x);
}

/* reach of each constraint equation */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size2 = c[2];
    s[3] = size2;
    s[0] = size2 + 1e-300;
    s[1] = c[0];
    s[2] = c[1];
    s[4] = c[3];
    (void)(p);
    (void)(t);
    (void)(x);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real w_ = x[5];
    const lagc_real s_ = x[4];
    const lagc_real u = x[3];
    const lagc_real t0 = w_ * (w_ * p->prepared[8] + s_ * p->prepared[0]) + (s_ * s_ + u * u) * p->prepared[9];
    /* kinetic energy */
    e[0] = t0;
    /* energy of the balance */
    e[2] = t0;
    /* potential energy */
    e[1] = 0.0;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* side */
    y[0] = lam[0];
    /* E */
    y[1] = e[0];
    (void)(p);
    (void)(t);
    (void)(x);
    (void)(a);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* x */
    x[0] = 0.0;
    /* y */
    x[1] = 0.0;
    /* theta */
    x[2] = 0.0;
    /* s */
    x[4] = 0.0;
    /* u */
    x[3] = 0.3;
    /* w */
    x[5] = 3.0;
    (void)(p);
}

/* conditions of a consistent start */
static void lagc_fn_conditions(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *c, lagc_real *J, lagc_real *sizes)
{
    const lagc_real s_ = x[4];
    c[0] = s_;
    const lagc_real u = x[3];
    const lagc_real theta = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(theta, sc0);
    const lagc_real t0 = sc0[1];
    J[2] = t0;
    const lagc_real t1 = u * t0;
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = s_ * t2;
    c[1] = t1 - t3;
    const lagc_real w_ = x[5];
    c[2] = w_;
    J[0] = 1.0;
    J[5] = 1.0;
    J[1] = -(u * t2 + s_ * t0);
    J[3] = -t2;
    const lagc_real t4 = -1.0;
    J[4] = t4;
    J[6] = t4;
    sizes[0] = fabs(s_);
    sizes[1] = fabs(t1) + fabs(t3);
    sizes[2] = fabs(w_);
    (void)(p);
    (void)(t);
}

/* stated rates, sizes of parameters */
static void lagc_fn_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)
{
    s[0] = 0.3;
    s[1] = 3.0;
    largest[1] = 0.0;
    largest[2] = 0.0;
    largest[3] = 0.0;
    largest[0] = lagc_max(0.0, fabs(p->a));
}
