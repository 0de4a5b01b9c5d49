/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real der_theta1 = x[2];
    /* der(theta1) */
    xdot[0] = der_theta1;
    const lagc_real der_theta2 = x[3];
    /* der(theta2) */
    xdot[1] = der_theta2;
    const lagc_real l2 = p->l2;
    const lagc_real m2 = p->m2;
    const lagc_real t0 = m2 * l2;
    const lagc_real t1 = l2 * t0;
    const lagc_real t2 = p->m1 + m2;
    const lagc_real l1 = p->l1;
    const lagc_real t3 = t2 * (l1 * l1);
    const lagc_real t4 = t1 * t3;
    const lagc_real theta1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(theta1, sc0);
    const lagc_real t5 = sc0[0];
    const lagc_real theta2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(theta2, sc1);
    const lagc_real t6 = sc1[0];
    const lagc_real t7 = sc0[1];
    const lagc_real t8 = sc1[1];
    const lagc_real t9 = t0 * (l1 * (t5 * t6 + t7 * t8));
    const lagc_real t10 = t4 - t9 * t9;
    const lagc_real t11 = 1.0 / t10;
    const lagc_real t12 = t7 * t6 - t5 * t8;
    const lagc_real field_g = p->field_g;
    const lagc_real t13 = l1 * (t0 * (t12 * (der_theta2 * der_theta2)) - t2 * (field_g * t5));
    const lagc_real t14 = t0 * (t12 * (der_theta1 * (l1 * der_theta1)) + field_g * t6);
    /* der(der(theta1)) */
    xdot[2] = t11 * (t1 * t13 + t9 * t14);
    /* der(der(theta2)) */
    xdot[3] = -(t11 * (t3 * t14 + t9 * t13));
    health[0] = t10 / t4;
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint rows */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_theta1 = x[2];
    qdot[0] = der_theta1;
    const lagc_real der_theta2 = x[3];
    qdot[1] = der_theta2;
    const lagc_real m2 = p->m2;
    const lagc_real t0 = p->m1 + m2;
    const lagc_real l1 = p->l1;
    M[0] = t0 * (l1 * l1);
    const lagc_real l2 = p->l2;
    const lagc_real t1 = m2 * l2;
    const lagc_real theta1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(theta1, sc0);
    const lagc_real t2 = sc0[0];
    const lagc_real theta2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(theta2, sc1);
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = sc0[1];
    const lagc_real t5 = sc1[1];
    M[1] = t1 * (l1 * (t2 * t3 + t4 * t5));
    M[2] = l2 * t1;
    const lagc_real t6 = t4 * t3 - t2 * t5;
    const lagc_real field_g = p->field_g;
    r[0] = l1 * (t1 * (t6 * (der_theta2 * der_theta2)) - t0 * (field_g * t2));
    r[1] = -(t1 * (t6 * (der_theta1 * (l1 * der_theta1)) + field_g * t3));
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real l1 = p->l1;
    const lagc_real t0 = l1 * x[2];
    const lagc_real m1 = p->m1;
    const lagc_real m2 = p->m2;
    const lagc_real theta1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(theta1, sc0);
    const lagc_real t1 = sc0[1];
    const lagc_real der_theta2 = x[3];
    const lagc_real l2 = p->l2;
    const lagc_real theta2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(theta2, sc1);
    const lagc_real t2 = l2 * sc1[1];
    const lagc_real t3 = t1 * t0 + der_theta2 * t2;
    const lagc_real t4 = sc0[0] * t0 + sc1[0] * (l2 * der_theta2);
    const lagc_real t5 = t0 * (m1 * t0) * 0.5 + 0.5 * (m2 * (t3 * t3 + t4 * t4));
    /* kinetic energy */
    e[0] = t5;
    const lagc_real t6 = l1 * t1;
    const lagc_real t7 = p->field_g * (m1 * t6 + m2 * (t6 + t2));
    /* potential energy */
    e[1] = -t7;
    /* energy of the balance */
    e[2] = t5 - t7;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real der_theta1 = x[2];
    const lagc_real l1 = p->l1;
    const lagc_real t0 = l1 * der_theta1;
    const lagc_real field_g = p->field_g;
    const lagc_real theta1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(theta1, sc0);
    const lagc_real t1 = sc0[1];
    const lagc_real t2 = field_g * t1;
    const lagc_real theta2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(theta2, sc1);
    const lagc_real t3 = sc1[1];
    const lagc_real l2 = p->l2;
    const lagc_real der_theta2 = x[3];
    const lagc_real t4 = l2 * der_theta2;
    const lagc_real t5 = l1 * (der_theta1 * ((sc0[0] * sc1[0] + t1 * t3) * t4 + t0 * 0.5) - t2);
    const lagc_real t6 = p->m2 * (t5 + l2 * (der_theta2 * t4 * 0.5 - field_g * t3));
    /* E */
    y[0] = (der_theta1 * t0 * 0.5 - t2) * (p->m1 * l1) + t6;
    (void)(t);
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
