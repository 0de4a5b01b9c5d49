/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real r_ = p->r;
    prepared[13] = r_;
    const lagc_real l = p->l;
    prepared[14] = l;
    const lagc_real m2 = p->m2;
    prepared[15] = m2;
    const lagc_real t0 = l * m2;
    prepared[0] = r_ * t0 * 0.5;
    const lagc_real t1 = l * t0;
    const lagc_real t2 = t1 * 0.3333333333333333;
    prepared[5] = t2;
    prepared[1] = 1.0 / t2;
    const lagc_real J1 = p->J1;
    prepared[17] = J1;
    const lagc_real t3 = m2 * (r_ * r_);
    const lagc_real t4 = J1 + t3;
    prepared[2] = t4;
    const lagc_real m3 = p->m3;
    prepared[16] = m3;
    prepared[3] = 1.0 / m3;
    prepared[4] = 1.0 / t4;
    const lagc_real t5 = fabs(r_);
    prepared[8] = t5;
    prepared[6] = t5 + 2.0 * t5;
    const lagc_real t6 = fabs(l);
    prepared[9] = t6;
    prepared[7] = t6 + 2.0 * t6;
    prepared[10] = t1 * 0.16666666666666666;
    prepared[11] = 0.5 * m3;
    prepared[12] = 0.5 * t3 + 0.5 * J1;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[3];
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t4 = prepared0 * (t1 * t2 - t0 * t3);
    health[6] = t4;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t5 = t4 * prepared1;
    const lagc_real t6 = p->prepared[2] - t4 * t5;
    const lagc_real l = p->l;
    const lagc_real t7 = t3 * l;
    health[4] = t7;
    const lagc_real t8 = 1.0 / t6;
    health[11] = t8;
    const lagc_real t9 = prepared1 * t7;
    const lagc_real r_ = p->r;
    const lagc_real t10 = t0 * r_;
    health[2] = t10;
    const lagc_real t11 = t10 + t4 * t9;
    const lagc_real t12 = t8 * t11;
    const lagc_real t13 = t1 * l;
    health[5] = t13;
    const lagc_real t14 = prepared1 * t13;
    const lagc_real t15 = t2 * r_;
    health[3] = t15;
    const lagc_real t16 = 1.0 / (t7 * t9 + t11 * t12);
    health[12] = t16;
    const lagc_real t17 = t4 * t14 - t15;
    const lagc_real der_phi = x[3];
    /* der(phi) */
    xdot[0] = der_phi;
    const lagc_real t18 = der_phi * der_phi;
    const lagc_real t19 = (t0 * t1 + t2 * t3) * prepared0;
    const lagc_real t20 = t8 * t17;
    const lagc_real t21 = t13 * t9 + t17 * t12;
    const lagc_real t22 = t18 * t19;
    health[10] = t22;
    const lagc_real der_psi = x[4];
    /* der(psi) */
    xdot[1] = der_psi;
    const lagc_real t23 = der_psi * der_psi;
    const lagc_real t24 = t21 * t16;
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t25 = t19 * t23;
    health[9] = t25;
    const lagc_real t26 = t17 * t20 + (t13 * t14 + prepared3);
    const lagc_real t27 = t22 * t5 - t25;
    const lagc_real t28 = t18 * t15 - t23 * t13;
    health[8] = t28;
    const lagc_real t29 = t21 * t24 - t26;
    const lagc_real t30 = t23 * t7 + t18 * t10;
    health[7] = t30;
    const lagc_real t31 = 1.0 / t29;
    health[13] = t31;
    const lagc_real t32 = t28 - t22 * t9 - t27 * t12;
    const lagc_real t33 = (t30 - t22 * t14 - t27 * t20 - t32 * t24) * t31;
    health[14] = t33;
    const lagc_real t34 = t32 * t16 + t24 * t33;
    /* pin[2], slider_crank.lag:25 */
    lam[1] = t34;
    health[15] = t34;
    const lagc_real t35 = t12 * t34 + (t27 * t8 - t20 * t33);
    /* der(der(phi)) */
    xdot[3] = t35;
    health[16] = t35;
    const lagc_real t36 = t14 * t33 - t22 * prepared1 - t9 * t34 - t5 * t35;
    /* der(der(psi)) */
    xdot[4] = t36;
    health[17] = t36;
    const lagc_real t37 = prepared3 * t33;
    /* der(der(s)) */
    xdot[5] = t37;
    health[18] = t37;
    health[0] = lagc_min(t6 * p->prepared[4], -(t29 / t26));
    /* pin[1], slider_crank.lag:25 */
    lam[0] = -t33;
    health[1] = 0.0;
    /* der(s) */
    xdot[2] = x[5];
    (void)(t);
}

/* what a solution leaves of its right-hand side */
static void lagc_fn_watch(const lagc_params *p, lagc_real *health)
{
    const lagc_real health14 = health[14];
    const lagc_real health5 = health[5];
    const lagc_real health15 = health[15];
    const lagc_real health2 = health[2];
    const lagc_real health17 = health[17];
    const lagc_real health4 = health[4];
    const lagc_real health18 = health[18];
    const lagc_real t0 = health18 * p->m3;
    const lagc_real t1 = health17 * p->prepared[5];
    const lagc_real health6 = health[6];
    const lagc_real health16 = health[16];
    const lagc_real health10 = health[10];
    const lagc_real health3 = health[3];
    const lagc_real t2 = health16 * p->prepared[2];
    const lagc_real health9 = health[9];
    const lagc_real health8 = health[8];
    const lagc_real t3 = health14 - t0;
    const lagc_real t4 = health17 * health4 + health8 - health16 * health2;
    const lagc_real health7 = health[7];
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t5 = health14 * health5 - health10 - health4 * health15 - (t1 + health6 * health16);
    const lagc_real t6 = health14 * health3 - health17 * health6 + (health15 * health2 - health9 - t2);
    const lagc_real health12 = health[12];
    const lagc_real t7 = health18 + health7 + (health5 * health17 + health16 * health3);
    const lagc_real health13 = health[13];
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real health11 = health[11];
    const lagc_real t8 = t0 * (t0 * prepared3) - health7 * (health13 * health7);
    const lagc_real t9 = t6 * (health11 * t6) + (t3 * (t3 * prepared3) + t4 * (health12 * t4));
    const lagc_real t10 = prepared1 * (health10 * health10 + t1 * t1) + (health8 * (health12 * health8) + 1e-300);
    const lagc_real t11 = t10 + (health11 * (health9 * health9 + t2 * t2) + t8);
    health[1] = (t5 * (t5 * prepared1) - t7 * (health13 * t7) + t9) / t11;
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_phi = x[3];
    qdot[0] = der_phi;
    const lagc_real der_psi = x[4];
    qdot[1] = der_psi;
    qdot[2] = x[5];
    M[0] = p->prepared[2];
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[1];
    const lagc_real t3 = sc0[3];
    const lagc_real prepared0 = p->prepared[0];
    M[1] = (t0 * t1 - t2 * t3) * prepared0;
    M[2] = p->prepared[5];
    M[3] = 0.0;
    M[4] = 0.0;
    r[2] = 0.0;
    G[5] = 0.0;
    M[5] = p->m3;
    const lagc_real t4 = der_psi * der_psi;
    const lagc_real t5 = prepared0 * (t1 * t2 + t0 * t3);
    r[0] = -(t4 * t5);
    const lagc_real t6 = der_phi * der_phi;
    r[1] = -(t5 * t6);
    const lagc_real r_ = p->r;
    const lagc_real t7 = t0 * r_;
    G[0] = -t7;
    const lagc_real l = p->l;
    const lagc_real t8 = t1 * l;
    G[1] = -t8;
    G[2] = -1.0;
    const lagc_real t9 = t2 * r_;
    G[3] = t9;
    const lagc_real t10 = t3 * l;
    G[4] = -t10;
    gamma[0] = t4 * t10 + t6 * t9;
    gamma[1] = t6 * t7 - t4 * t8;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    w[0] = p->prepared[2];
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[1];
    const lagc_real t3 = sc0[3];
    w[1] = (t0 * t1 - t2 * t3) * p->prepared[0];
    w[2] = p->prepared[5];
    w[3] = p->m3;
    const lagc_real r_ = p->r;
    w[4] = -(t0 * r_);
    const lagc_real l = p->l;
    w[5] = -(t1 * l);
    w[6] = -1.0;
    w[7] = t2 * r_;
    w[8] = -(t3 * l);
    (void)(t);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real t0 = 1.0 / w[3];
    w[16] = t0;
    w[9] = -t0;
    const lagc_real w1 = w[1];
    const lagc_real t1 = 1.0 / w[2];
    w[17] = t1;
    const lagc_real t2 = w1 * t1;
    w[10] = t2;
    const lagc_real w5 = w[5];
    const lagc_real t3 = w5 * t1;
    w[11] = t3;
    const lagc_real w8 = w[8];
    const lagc_real t4 = w8 * t1;
    w[12] = t4;
    const lagc_real t5 = w[4] - w1 * t3;
    const lagc_real w0 = w[0];
    const lagc_real t6 = w0 - w1 * t2;
    const lagc_real t7 = 1.0 / t6;
    w[18] = t7;
    const lagc_real t8 = t5 * t7;
    w[13] = t8;
    const lagc_real t9 = w[7] - w1 * t4;
    const lagc_real t10 = t9 * t7;
    w[14] = t10;
    const lagc_real t11 = w5 * t4 + t5 * t10;
    const lagc_real t12 = 1.0 / (w8 * t4 + t9 * t10);
    const lagc_real t13 = t11 * t12;
    w[15] = t13;
    w[19] = -t12;
    const lagc_real t14 = t0 + w5 * t3 + t5 * t8;
    const lagc_real t15 = t11 * t13 - t14;
    w[20] = 1.0 / t15;
    health[0] = lagc_min(t6 / w0, -(t15 / t14));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r1 = r[1];
    const lagc_real w10 = w[10];
    const lagc_real t0 = r[0] - r1 * w10;
    const lagc_real w13 = w[13];
    const lagc_real r2 = r[2];
    const lagc_real w9 = w[9];
    const lagc_real w11 = w[11];
    const lagc_real w15 = w[15];
    const lagc_real w12 = w[12];
    const lagc_real w14 = w[14];
    const lagc_real t1 = r[4] - r1 * w12 - w14 * t0;
    const lagc_real t2 = w[20] * (r[3] - r2 * w9 - r1 * w11 - w13 * t0 - w15 * t1);
    const lagc_real t3 = w[19] * t1 - w15 * t2;
    const lagc_real t4 = w[18] * t0 - w13 * t2 - w14 * t3;
    s[0] = t4;
    s[1] = r1 * w[17] - w11 * t2 - w12 * t3 - w10 * t4;
    s[2] = r2 * w[16] - w9 * t2;
    s[3] = -t2;
    s[4] = -t3;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real t1 = s[4];
    const lagc_real w7 = w[7];
    const lagc_real t2 = s[3];
    const lagc_real w4 = w[4];
    const lagc_real t3 = s[1];
    const lagc_real w1 = w[1];
    const lagc_real w10 = w[10];
    const lagc_real w8 = w[8];
    const lagc_real w5 = w[5];
    const lagc_real t4 = t1 * w8 + (t2 * w5 + (r[1] - t0 * w1 - t3 * w[2]));
    const lagc_real t5 = t1 * w7 + (t2 * w4 + (r[0] - t0 * w[0] - t3 * w1)) - w10 * t4;
    const lagc_real w13 = w[13];
    const lagc_real t6 = s[2];
    const lagc_real w9 = w[9];
    const lagc_real t7 = r[2] - t6 * w[3] - t2;
    const lagc_real w11 = w[11];
    const lagc_real w15 = w[15];
    const lagc_real w12 = w[12];
    const lagc_real w14 = w[14];
    const lagc_real t8 = r[4] - t0 * w7 - t3 * w8 - w12 * t4 - w14 * t5;
    const lagc_real t9 = w[20] * (t6 + (r[3] - t0 * w4 - t3 * w5) - w9 * t7 - w11 * t4 - w13 * t5 - w15 * t8);
    const lagc_real t10 = w[19] * t8 - w15 * t9;
    const lagc_real t11 = w[18] * t5 - w13 * t9 - w14 * t10;
    const lagc_real t12 = t0 + t11;
    const lagc_real t13 = t3 + (w[17] * t4 - w11 * t9 - w12 * t10 - w10 * t11);
    const lagc_real t14 = t6 + (w[16] * t7 - w9 * t9);
    const lagc_real t15 = -(t9 - t2);
    const lagc_real t16 = -(t10 - t1);
    s[0] = t12;
    s[1] = t13;
    s[2] = t14;
    s[3] = t15;
    s[4] = t16;
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real r_ = p->r;
    const lagc_real l = p->l;
    /* pin[1], slider_crank.lag:25 */
    phi[0] = sc0[1] * r_ + sc0[3] * l - x[2];
    /* pin[2], slider_crank.lag:25 */
    phi[1] = r_ * sc0[0] - l * sc0[2];
    (void)(t);
}

/* rates of the constraint equations */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real psi_ = x[1];
    const lagc_real phi_ = x[0];
    lagc_real sc0[4]; lagc_sine_cosine_two(psi_, phi_, sc0);
    const lagc_real t0 = x[4] * p->l;
    const lagc_real t1 = x[3] * p->r;
    /* pin[1], slider_crank.lag:25 */
    psi[0] = -(x[5] + (sc0[0] * t0 + sc0[2] * t1));
    /* pin[2], slider_crank.lag:25 */
    psi[1] = t1 * sc0[3] - t0 * sc0[1];
    (void)(t);
}

/* size of the terms of each constraint equation */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real r_ = p->r;
    const lagc_real l = p->l;
    const lagc_real t0 = fabs(sc0[1] * r_) + fabs(sc0[3] * l) + fabs(x[2]) * 2.0 + 1e-300;
    const lagc_real t1 = fabs(l * sc0[2]) + (1e-300 + fabs(r_ * sc0[0]));
    const lagc_real t2 = lagc_max(t0, t1) * 1e-06;
    s[0] = lagc_max(t0, t2);
    s[1] = lagc_max(t1, t2);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real t0 = fabs(x[3]);
    const lagc_real t1 = t0 * t0 * p->prepared[6];
    const lagc_real t2 = fabs(x[4]);
    const lagc_real t3 = t2 * t2 * p->prepared[7];
    s[0] = fabs(sc0[1]) * t1 + fabs(sc0[3]) * t3;
    s[1] = t1 * fabs(sc0[0]) + t3 * fabs(sc0[2]);
    (void)(t);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real prepared8 = p->prepared[8];
    const lagc_real prepared9 = p->prepared[9];
    s[0] = 1.0 + (fabs(sc0[0]) * prepared8 + fabs(sc0[2]) * prepared9);
    s[1] = prepared8 * fabs(sc0[1]) + prepared9 * fabs(sc0[3]);
    (void)(t);
}

/* reach of each constraint equation */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size0 = c[0];
    s[4] = size0;
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real r_ = p->r;
    const lagc_real t0 = sc0[0] * r_;
    const lagc_real l = p->l;
    const lagc_real t1 = sc0[2] * l;
    const lagc_real t2 = fabs(t0) + fabs(t1);
    const lagc_real size1 = c[1];
    const lagc_real t3 = r_ * sc0[1];
    const lagc_real t4 = l * sc0[3];
    const lagc_real t5 = fabs(t3) + fabs(t4);
    const lagc_real t6 = lagc_max(size1, t5);
    const lagc_real t7 = size0 * t2 + (t6 + 1e-300);
    const lagc_real t8 = 1e-300 + size0 * t5;
    const lagc_real t9 = lagc_max(t7, t8) * 1e-06;
    s[0] = lagc_max(t7, t9);
    s[1] = lagc_max(t8, t9);
    const lagc_real size2 = c[2];
    s[6] = size2;
    const lagc_real size3 = c[3];
    s[7] = size3;
    const lagc_real t10 = lagc_max(size1, t6);
    s[5] = t10;
    const lagc_real t11 = lagc_max(lagc_max(0.0, size2), size3 / (1e-300 + t10));
    const lagc_real t12 = t2 * size2 + (size3 + (fabs(t3 * t11) + (fabs(t4 * t11) + (1e-300 + fabs(t11 * x[2])))));
    const lagc_real t13 = t5 * size2 + (fabs(t0 * t11) + (1e-300 + fabs(t1 * t11)));
    const lagc_real t14 = 1e-06 * lagc_max(t12, t13);
    s[2] = lagc_max(t12, t14);
    s[3] = lagc_max(t13, t14);
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_psi = x[4];
    const lagc_real der_s = x[5];
    const lagc_real der_phi = x[3];
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real t0 = p->prepared[0] * (der_psi * (sc0[0] * sc0[2] - sc0[1] * sc0[3]));
    const lagc_real t1 = der_s * der_s * p->prepared[11] + der_phi * (der_phi * p->prepared[12] + t0);
    const lagc_real t2 = der_psi * der_psi * p->prepared[10] + t1;
    /* kinetic energy */
    e[0] = t2;
    /* energy of the balance */
    e[2] = t2;
    /* potential energy */
    e[1] = 0.0;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* Px */
    y[0] = lam[0];
    /* Py */
    y[1] = lam[1];
    /* E */
    y[2] = e[0];
    (void)(p);
    (void)(t);
    (void)(x);
    (void)(a);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* phi */
    x[0] = 0.0;
    /* psi */
    x[1] = 0.0;
    /* der(s) */
    x[5] = 0.0;
    const lagc_real r_ = p->r;
    const lagc_real l = p->l;
    /* s */
    x[2] = r_ + l;
    /* der(phi) */
    x[3] = 50.0;
    /* der(psi) */
    x[4] = r_ / l * 50.0;
}

/* conditions of a consistent start */
static void lagc_fn_conditions(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *c, lagc_real *J, lagc_real *sizes)
{
    const lagc_real phi_ = x[0];
    const lagc_real psi_ = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(phi_, psi_, sc0);
    const lagc_real r_ = p->r;
    const lagc_real t0 = sc0[1] * r_;
    J[3] = t0;
    J[12] = t0;
    const lagc_real l = p->l;
    const lagc_real t1 = sc0[3] * l;
    const lagc_real s_ = x[2];
    c[0] = t0 + t1 - s_;
    const lagc_real t2 = r_ * sc0[0];
    const lagc_real t3 = l * sc0[2];
    c[1] = t2 - t3;
    const lagc_real der_s = x[5];
    const lagc_real der_psi = x[4];
    const lagc_real t4 = t3 * der_psi;
    J[11] = t4;
    const lagc_real der_phi = x[3];
    const lagc_real t5 = t2 * der_phi;
    c[2] = -(der_s + (t4 + t5));
    const lagc_real t6 = t0 * der_phi;
    const lagc_real t7 = t1 * der_psi;
    c[3] = t6 - t7;
    const lagc_real t8 = -t2;
    J[0] = t8;
    J[7] = t8;
    const lagc_real t9 = -t3;
    J[1] = t9;
    J[8] = t9;
    const lagc_real t10 = -1.0;
    J[2] = t10;
    J[9] = t10;
    const lagc_real t11 = -t1;
    J[4] = t11;
    J[13] = t11;
    J[5] = -t6;
    J[6] = -t7;
    J[10] = -t5;
    sizes[0] = fabs(t0) + fabs(t1) + fabs(s_);
    sizes[1] = fabs(t2) + fabs(t3);
    sizes[2] = fabs(t5) + (fabs(der_s) + fabs(t4));
    sizes[3] = fabs(t6) + fabs(t7);
    (void)(t);
}

/* stated rates, sizes of parameters */
static void lagc_fn_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)
{
    largest[0] = 0.0;
    largest[2] = 0.0;
    largest[3] = 0.0;
    largest[1] = lagc_max(lagc_max(0.0, fabs(p->r)), fabs(p->l));
    (void)(s);
}
