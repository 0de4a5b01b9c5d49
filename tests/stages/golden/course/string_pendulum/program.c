/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real m = p->m;
    prepared[6] = m;
    const lagc_real t0 = 1.0 / m;
    prepared[0] = t0;
    const lagc_real field_g = p->field_g;
    prepared[8] = field_g;
    const lagc_real t1 = m * field_g;
    prepared[1] = t1;
    prepared[2] = t0 * t1;
    prepared[3] = t1 * t1;
    const lagc_real l = p->l;
    prepared[7] = l;
    prepared[4] = fabs(l);
    prepared[5] = m * 0.5;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t0 = (x_ * x_) + (z * z);
    const lagc_real t1 = sqrt(t0);
    const lagc_real der_x = x[2];
    /* der(x) */
    xdot[0] = der_x;
    const lagc_real der_z = x[3];
    /* der(z) */
    xdot[1] = der_z;
    const lagc_real t2 = (der_x * x_) + (der_z * z);
    const lagc_real t3 = x_ / t1;
    health[3] = t3;
    const lagc_real t4 = z / t1;
    health[2] = t4;
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t5 = t3 * prepared0;
    const lagc_real t6 = prepared0 * t4;
    const lagc_real t7 = ((der_x * der_x) + (der_z * der_z) - (t2 * t2 / t0)) / t1;
    health[4] = t7;
    health[0] = 1.0;
    const lagc_real t8 = 1.0 / ((t4 * t6) + (t3 * t5));
    health[5] = t8;
    const lagc_real t9 = ((t6 * p->prepared[1]) - t7) * t8;
    /* string, string_pendulum.lag:21 */
    lam[0] = t9;
    health[6] = t9;
    const lagc_real t10 = t5 * t9;
    /* der(der(x)) */
    xdot[2] = t10;
    health[7] = t10;
    const lagc_real t11 = (t6 * t9) - p->prepared[2];
    /* der(der(z)) */
    xdot[3] = t11;
    health[8] = t11;
    health[1] = 0.0;
    (void)t;
}

/* what a solution leaves of its right-hand side */
static void lagc_fn_watch(const lagc_params *p, lagc_real *health)
{
    const lagc_real health2 = health[2];
    const lagc_real health6 = health[6];
    const lagc_real health8 = health[8];
    const lagc_real m = p->m;
    const lagc_real t0 = health8 * m;
    const lagc_real health3 = health[3];
    const lagc_real health7 = health[7];
    const lagc_real t1 = m * health7;
    const lagc_real t2 = (health2 * health6) - p->prepared[1] - t0;
    const lagc_real t3 = (health6 * health3) - t1;
    const lagc_real health4 = health[4];
    const lagc_real health5 = health[5];
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t4 = (health3 * health7) + ((health2 * health8) + health4);
    const lagc_real t5 = (t1 * (prepared0 * t1)) + ((health4 * (health5 * health4)) + 1e-300);
    const lagc_real t6 = (t4 * (health5 * t4)) + ((t2 * (t2 * prepared0)) + (t3 * (prepared0 * t3)));
    health[1] = t6 / ((prepared0 * ((t0 * t0) + p->prepared[3])) + t5);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_x = x[2];
    qdot[0] = der_x;
    const lagc_real der_z = x[3];
    qdot[1] = der_z;
    const lagc_real m = p->m;
    M[0] = m;
    M[2] = m;
    M[1] = 0.0;
    r[0] = 0.0;
    r[1] = -p->prepared[1];
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t0 = (x_ * x_) + (z * z);
    const lagc_real t1 = sqrt(t0);
    G[0] = x_ / t1;
    G[1] = z / t1;
    const lagc_real t2 = (der_x * x_) + (der_z * z);
    gamma[0] = -(((der_x * der_x) + (der_z * der_z) - (t2 * t2 / t0)) / t1);
    (void)t;
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real m = p->m;
    w[0] = m;
    w[1] = m;
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t0 = sqrt((x_ * x_) + (z * z));
    w[2] = x_ / t0;
    w[3] = z / t0;
    (void)t;
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real w3 = w[3];
    health[0] = 1.0;
    const lagc_real t0 = 1.0 / w[1];
    w[6] = t0;
    const lagc_real t1 = w3 * t0;
    w[4] = t1;
    const lagc_real w2 = w[2];
    const lagc_real t2 = 1.0 / w[0];
    w[7] = t2;
    const lagc_real t3 = w2 * t2;
    w[5] = t3;
    w[8] = -(1.0 / ((w3 * t1) + (w2 * t3)));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r0 = r[0];
    const lagc_real w5 = w[5];
    const lagc_real r1 = r[1];
    const lagc_real w4 = w[4];
    const lagc_real t0 = w[8] * (r[2] - (r1 * w4) - (r0 * w5));
    s[0] = (r0 * w[7]) - (w5 * t0);
    s[1] = (r1 * w[6]) - (w4 * t0);
    s[2] = -t0;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real t1 = s[2];
    const lagc_real w2 = w[2];
    const lagc_real t2 = (t1 * w2) + (r[0] - (t0 * w[0]));
    const lagc_real w5 = w[5];
    const lagc_real t3 = s[1];
    const lagc_real w3 = w[3];
    const lagc_real w4 = w[4];
    const lagc_real t4 = (t1 * w3) + (r[1] - (t3 * w[1]));
    const lagc_real t5 = w[8] * (r[2] - (t0 * w2) - (t3 * w3) - (w4 * t4) - (w5 * t2));
    const lagc_real t6 = t0 + ((w[7] * t2) - (w5 * t5));
    const lagc_real t7 = t3 + ((w[6] * t4) - (w4 * t5));
    const lagc_real t8 = -(t5 - t1);
    s[0] = t6;
    s[1] = t7;
    s[2] = t8;
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    /* string, string_pendulum.lag:21 */
    phi[0] = sqrt((x_ * x_) + (z * z)) - p->l;
    (void)t;
}

/* rates of the constraint equations */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    /* string, string_pendulum.lag:21 */
    psi[0] = ((x_ * x[2]) + (z * x[3])) / sqrt((x_ * x_) + (z * z));
    (void)p; (void)t;
}

/* size of the terms of each constraint equation */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real x_ = x[0];
    const lagc_real t0 = x_ * x_;
    const lagc_real z = x[1];
    const lagc_real t1 = z * z;
    const lagc_real t2 = sqrt(t0 + t1);
    s[0] = fabs(t2) + (fabs(t0 / t2) + (fabs(t1 / t2) + 1e-300)) + p->prepared[4];
    (void)t;
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real t0 = fabs(x[2]);
    const lagc_real t1 = t0 * t0;
    const lagc_real t2 = fabs(x[3]);
    const lagc_real t3 = t2 * t2;
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t4 = (t0 * fabs(x_)) + (t2 * fabs(z));
    const lagc_real t5 = (x_ * x_) + (z * z);
    const lagc_real t6 = ((t1 * 4.0) + (4.0 * t3) + ((t1 * 2.0) + (t3 * 2.0))) * 0.5;
    s[0] = (t6 + (t4 * t4 / fabs(t5) * 3.0)) / fabs(sqrt(t5));
    (void)p; (void)t;
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    s[0] = ((fabs(x_) * 2.0) + (2.0 * fabs(z))) / fabs(sqrt((x_ * x_) + (z * z))) * 0.5;
    (void)p; (void)t;
}

/* reach of each constraint equation */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size1 = c[1];
    s[3] = size1;
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t0 = sqrt((x_ * x_) + (z * z));
    const lagc_real t1 = fabs(x_ / t0) + fabs(z / t0);
    s[0] = (size1 * t1) + 1e-300;
    const lagc_real size2 = c[2];
    s[4] = size2;
    const lagc_real t2 = lagc_max(0.0, size2 / (size1 + 1e-300));
    s[1] = (t1 * size2) + (fabs(t2 * p->l) + (1e-300 + fabs(t0 * t2)));
    s[2] = c[0];
    (void)t;
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[2];
    const lagc_real der_z = x[3];
    const lagc_real t0 = ((der_x * der_x) + (der_z * der_z)) * p->prepared[5];
    /* kinetic energy */
    e[0] = t0;
    const lagc_real t1 = x[1] * p->prepared[1];
    /* potential energy */
    e[1] = t1;
    /* energy of the balance */
    e[2] = t0 + t1;
    (void)t;
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* tension */
    y[0] = -lam[0];
    /* E */
    y[1] = e[0] + e[1];
    (void)p; (void)t; (void)x; (void)a;
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    const lagc_real l = p->l;
    /* x */
    x[0] = l * 0.8660254037844386;
    /* z */
    x[1] = -(l * 0.5000000000000001);
    /* der(x) */
    x[2] = 0.0;
    /* der(z) */
    x[3] = 0.0;
}

/* conditions of a consistent start */
static void lagc_fn_conditions(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *c, lagc_real *J, lagc_real *sizes)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    const lagc_real t0 = (x_ * x_) + (z * z);
    const lagc_real t1 = sqrt(t0);
    c[0] = t1 - p->l;
    const lagc_real der_x = x[2];
    const lagc_real der_z = x[3];
    const lagc_real t2 = (x_ * der_x) + (z * der_z);
    const lagc_real t3 = t2 / t1;
    c[1] = t3;
    const lagc_real t4 = x_ / t1;
    J[0] = t4;
    J[4] = t4;
    const lagc_real t5 = z / t1;
    J[1] = t5;
    J[5] = t5;
    const lagc_real t6 = t2 / t0;
    J[2] = (der_x - (x_ * t6)) / t1;
    J[3] = (der_z - (z * t6)) / t1;
    sizes[0] = fabs(t1) + p->prepared[4];
    sizes[1] = fabs(t3);
    (void)t;
}

/* stated rates, sizes of parameters */
static void lagc_fn_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)
{
    largest[1] = 0.0;
    largest[0] = lagc_max(0.0, fabs(p->l));
    (void)s;
}

/* divisors that may come near zero */
static void lagc_fn_poles(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real x_ = x[0];
    const lagc_real z = x[1];
    e[0] = (x_ * x_) + (z * z);
    (void)p; (void)t;
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
    e[0] = (t0 * t0) + (t1 * t1);
    const lagc_real t2 = lagc_max(-box1, box6);
    const lagc_real t3 = lagc_max(-box2, box7);
    e[1] = (t2 * t2) + (t3 * t3);
    (void)p;
}
