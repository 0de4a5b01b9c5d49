/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real l2 = p->l2;
    prepared[14] = l2;
    const lagc_real m2 = p->m2;
    prepared[12] = m2;
    const lagc_real t0 = l2 * m2;
    const lagc_real t1 = l2 * t0;
    prepared[3] = t1;
    const lagc_real m1 = p->m1;
    prepared[11] = m1;
    const lagc_real t2 = m2 + m1;
    const lagc_real l1 = p->l1;
    prepared[13] = l1;
    const lagc_real t3 = t2 * (l1 * l1);
    prepared[5] = t3;
    const lagc_real t4 = t1 * t3;
    prepared[0] = t4;
    prepared[1] = t0 * l1;
    const lagc_real field_g = p->field_g;
    prepared[15] = field_g;
    prepared[2] = t2 * (l1 * field_g);
    prepared[4] = t0 * field_g;
    prepared[6] = 1.0 / t4;
    const lagc_real t5 = m1 * l1;
    prepared[7] = l1 * t5 * 0.5;
    prepared[8] = m2 * 0.5;
    prepared[9] = field_g * t5;
    prepared[10] = m2 * field_g;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real der_theta1 = x[2];
    /* der(theta1) */
    xdot[0] = der_theta1;
    const lagc_real der_theta2 = x[3];
    /* der(theta2) */
    xdot[1] = der_theta2;
    const lagc_real theta1 = x[0];
    const lagc_real theta2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(theta1, theta2, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[1];
    const lagc_real t3 = sc0[3];
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t4 = (t0 * t1 + t2 * t3) * prepared1;
    const lagc_real t5 = p->prepared[0] - t4 * t4;
    const lagc_real t6 = 1.0 / t5;
    const lagc_real t7 = t1 * t2 - t0 * t3;
    const lagc_real t8 = prepared1 * (t7 * (der_theta2 * der_theta2)) - t0 * p->prepared[2];
    const lagc_real t9 = t1 * p->prepared[4] + prepared1 * (t7 * (der_theta1 * der_theta1));
    /* der(der(theta1)) */
    xdot[2] = t6 * (t8 * p->prepared[3] + t4 * t9);
    /* der(der(theta2)) */
    xdot[3] = -(t6 * (t9 * p->prepared[5] + t4 * t8));
    health[0] = t5 * p->prepared[6];
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_theta1 = x[2];
    qdot[0] = der_theta1;
    const lagc_real der_theta2 = x[3];
    qdot[1] = der_theta2;
    M[0] = p->prepared[5];
    const lagc_real theta1 = x[0];
    const lagc_real theta2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(theta1, theta2, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[1];
    const lagc_real t3 = sc0[3];
    const lagc_real prepared1 = p->prepared[1];
    M[1] = (t0 * t1 + t2 * t3) * prepared1;
    M[2] = p->prepared[3];
    const lagc_real t4 = t1 * t2 - t0 * t3;
    r[0] = prepared1 * (t4 * (der_theta2 * der_theta2)) - t0 * p->prepared[2];
    r[1] = -(t1 * p->prepared[4] + prepared1 * (t4 * (der_theta1 * der_theta1)));
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_theta1 = x[2];
    const lagc_real theta1 = x[0];
    const lagc_real theta2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(theta1, theta2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l1 = p->l1;
    const lagc_real t1 = t0 * l1;
    const lagc_real der_theta2 = x[3];
    const lagc_real l2 = p->l2;
    const lagc_real t2 = sc0[3] * l2;
    const lagc_real t3 = der_theta1 * t1 + der_theta2 * t2;
    const lagc_real t4 = l1 * (der_theta1 * sc0[0]) + l2 * (der_theta2 * sc0[2]);
    const lagc_real t5 = der_theta1 * der_theta1 * p->prepared[7] + (t3 * t3 + t4 * t4) * p->prepared[8];
    /* kinetic energy */
    e[0] = t5;
    const lagc_real t6 = t0 * p->prepared[9] + (t1 + t2) * p->prepared[10];
    /* potential energy */
    e[1] = -t6;
    /* energy of the balance */
    e[2] = t5 - t6;
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
    /* theta1 */
    x[0] = 1.5707963267948966;
    /* theta2 */
    x[1] = 1.5707963267948966;
    /* der(theta1) */
    x[2] = 0.0;
    /* der(theta2) */
    x[3] = 0.0;
    (void)(p);
}
