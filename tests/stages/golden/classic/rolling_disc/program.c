/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real r_ = p->r;
    prepared[13] = r_;
    const lagc_real m = p->m;
    prepared[12] = m;
    const lagc_real t0 = r_ * (m * r_);
    const lagc_real t1 = t0 * 0.5;
    prepared[0] = t1;
    const lagc_real t2 = t0 * 0.25;
    prepared[1] = t2;
    prepared[2] = 1.0 / t1;
    prepared[3] = 1.0 / t2;
    const lagc_real t3 = 1.0 / m;
    prepared[4] = t3;
    const lagc_real field_g = p->field_g;
    prepared[14] = field_g;
    const lagc_real t4 = m * field_g;
    prepared[6] = t4;
    prepared[5] = t3 * t4;
    prepared[7] = t4 * t4;
    const lagc_real t5 = fabs(r_);
    prepared[9] = t5;
    prepared[8] = t5 * 3.0;
    prepared[10] = m * 0.5;
    prepared[11] = t0 * 0.125;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[0];
    const lagc_real t2 = sc0[2];
    const lagc_real t3 = sc0[3];
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t4 = t1 * prepared0;
    health[11] = t4;
    const lagc_real t5 = t0 * p->prepared[1];
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t6 = prepared2 * t4;
    const lagc_real t7 = t1 * t4 + t0 * t5;
    health[12] = t7;
    const lagc_real t8 = t7 - t4 * t6;
    const lagc_real r_ = p->r;
    const lagc_real t9 = r_ * t2;
    health[8] = t9;
    const lagc_real t10 = 1.0 / t8;
    health[17] = t10;
    const lagc_real t11 = t0 * r_;
    const lagc_real t12 = r_ * t1;
    health[2] = t12;
    const lagc_real t13 = prepared2 * t9;
    const lagc_real t14 = t2 * t12;
    health[3] = t14;
    const lagc_real t15 = t11 * t3;
    health[9] = t15;
    const lagc_real t16 = t4 * t13 - t14;
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t17 = prepared3 * t15;
    const lagc_real t18 = t10 * t16;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t19 = r_ * t3;
    health[6] = t19;
    const lagc_real t20 = t19 * prepared2;
    const lagc_real t21 = t3 * t12;
    health[4] = t21;
    const lagc_real t22 = t11 * t2;
    health[7] = t22;
    const lagc_real t23 = 1.0 / (t16 * t18 + (t15 * t17 + (prepared4 + t9 * t13)));
    health[18] = t23;
    const lagc_real t24 = t20 * t4 - t21;
    const lagc_real t25 = t22 * prepared3;
    const lagc_real t26 = t24 * t10;
    const lagc_real t27 = t22 * t17 - t19 * t13 - t24 * t18;
    const lagc_real t28 = t27 * t23;
    const lagc_real der_spin = x[11];
    /* der(spin) */
    xdot[5] = der_spin;
    const lagc_real t29 = t24 * t26 + (t22 * t25 + (prepared4 + t19 * t20));
    const lagc_real t30 = t11 * 2.0;
    const lagc_real der_yaw = x[9];
    /* der(yaw) */
    xdot[3] = der_yaw;
    const lagc_real t31 = der_yaw * t2;
    const lagc_real der_lean = x[10];
    /* der(lean) */
    xdot[4] = der_lean;
    const lagc_real t32 = der_yaw * t1;
    const lagc_real t33 = t27 * t28 - t29;
    const lagc_real t34 = der_yaw * t3;
    const lagc_real t35 = 1.0 / t33;
    health[19] = t35;
    const lagc_real t36 = t12 * t17;
    const lagc_real t37 = t12 * (der_yaw + der_spin * t1) + t11 * (der_spin * t0);
    const lagc_real t38 = t0 * (prepared0 * (der_yaw * der_lean));
    health[10] = t38;
    const lagc_real t39 = (t32 + der_spin * 2.0) * (der_yaw * t5);
    health[16] = t39;
    const lagc_real t40 = t12 * prepared3;
    const lagc_real t41 = (t32 + (t32 + (der_spin + der_spin))) * (der_lean * t5);
    health[15] = t41;
    const lagc_real t42 = t12 * t25 - t28 * t36;
    const lagc_real t43 = t23 * t36;
    const lagc_real t44 = t38 * t6 - t41;
    const lagc_real t45 = der_lean * (t30 * t31 + der_lean * t21) + t34 * t37;
    health[14] = t45;
    const lagc_real t46 = t35 * t42;
    const lagc_real t47 = prepared4 + t12 * t40;
    const lagc_real t48 = der_lean * (t34 * t30 - der_lean * t14) - t37 * t31;
    health[13] = t48;
    const lagc_real t49 = t45 - (t38 * t13 + t39 * t17) - t44 * t18;
    const lagc_real t50 = t11 * (der_lean * der_lean);
    health[5] = t50;
    const lagc_real t51 = t36 * t43 - t47 - t42 * t46;
    const lagc_real prepared5 = p->prepared[5];
    const lagc_real t52 = 1.0 / t51;
    health[20] = t52;
    const lagc_real t53 = t49 * t28 + (t48 + (t39 * t25 - t38 * t20) - t44 * t26);
    const lagc_real t54 = (prepared5 - t50 - t39 * t40 - t49 * t43 - t53 * t46) * t52;
    health[21] = t54;
    const lagc_real t55 = t53 * t35 - t46 * t54;
    health[22] = t55;
    const lagc_real t56 = t28 * t55 - (t49 * t23 + t43 * t54);
    health[23] = t56;
    const lagc_real t57 = t44 * t10 - t26 * t55 - t18 * t56;
    /* der(der(yaw)) */
    xdot[9] = t57;
    health[25] = t57;
    const lagc_real t58 = prepared4 * t55;
    health[27] = t58;
    const lagc_real t59 = prepared4 * t56;
    health[28] = t59;
    const lagc_real t60 = prepared5 + prepared4 * t54;
    health[29] = t60;
    const lagc_real t61 = t25 * t55 + (t39 * prepared3 - t40 * t54) - t17 * t56;
    /* der(der(lean)) */
    xdot[10] = t61;
    health[24] = t61;
    const lagc_real t62 = t13 * t56 + (t20 * t55 - t38 * prepared2) - t6 * t57;
    /* der(der(spin)) */
    xdot[11] = t62;
    health[26] = t62;
    health[0] = lagc_min(lagc_min(t8 / t7, -(t33 / t29)), -(t51 / t47));
    /* der(der(x)) */
    xdot[6] = -t58;
    /* der(der(y)) */
    xdot[7] = -t59;
    /* der(der(z)) */
    xdot[8] = -t60;
    /* touch, rolling_disc.lag:29 */
    lam[0] = -t54;
    /* roll[1], rolling_disc.lag:30 */
    lam[1] = -t55;
    /* roll[2], rolling_disc.lag:30 */
    lam[2] = -t56;
    health[1] = 0.0;
    /* der(x) */
    xdot[0] = x[6];
    /* der(y) */
    xdot[1] = x[7];
    /* der(z) */
    xdot[2] = x[8];
    (void)(t);
}

/* what a solution leaves of its right-hand side */
static void lagc_fn_watch(const lagc_params *p, lagc_real *health)
{
    const lagc_real health23 = health[23];
    const lagc_real health8 = health[8];
    const lagc_real health3 = health[3];
    const lagc_real health29 = health[29];
    const lagc_real m = p->m;
    const lagc_real t0 = health29 * m;
    const lagc_real health21 = health[21];
    const lagc_real health28 = health[28];
    const lagc_real t1 = m * health28;
    const lagc_real health27 = health[27];
    const lagc_real t2 = m * health27;
    const lagc_real health22 = health[22];
    const lagc_real health6 = health[6];
    const lagc_real health26 = health[26];
    const lagc_real t3 = health26 * p->prepared[0];
    const lagc_real health11 = health[11];
    const lagc_real health25 = health[25];
    const lagc_real health10 = health[10];
    const lagc_real health4 = health[4];
    const lagc_real t4 = health25 * health[12];
    const lagc_real health15 = health[15];
    const lagc_real health7 = health[7];
    const lagc_real health24 = health[24];
    const lagc_real health9 = health[9];
    const lagc_real health14 = health[14];
    const lagc_real health13 = health[13];
    const lagc_real health2 = health[2];
    const lagc_real health5 = health[5];
    const lagc_real t5 = t0 - (p->prepared[6] + health21);
    const lagc_real t6 = t1 - health23;
    const lagc_real t7 = t2 - health22;
    const lagc_real t8 = health24 * p->prepared[1];
    const lagc_real health16 = health[16];
    const lagc_real t9 = health29 - health5 - health24 * health2;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t10 = health22 * health6 - t3 + (health23 * health8 - health10 - health11 * health25);
    const lagc_real t11 = health22 * health4 - health26 * health11 + (health23 * health3 - health15 - t4);
    const lagc_real t12 = health8 * health26 + health25 * health3 + (health28 + health14 - health24 * health9);
    const lagc_real t13 = health6 * health26 + health7 * health24 + (health25 * health4 + (health27 + health13));
    const lagc_real health20 = health[20];
    const lagc_real health18 = health[18];
    const lagc_real health19 = health[19];
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real health17 = health[17];
    const lagc_real t14 = health22 * health7 + health16 - health23 * health9 - (t8 + health21 * health2);
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t15 = t5 * (t5 * prepared4) + t6 * (prepared4 * t6);
    const lagc_real t16 = health13 * (health19 * health13) + health5 * (health20 * health5);
    const lagc_real t17 = t15 + (t7 * (prepared4 * t7) - t9 * (health20 * t9));
    const lagc_real t18 = health14 * (health18 * health14) + 1e-300 - t16;
    const lagc_real t19 = health17 * (health15 * health15 + t4 * t4) + prepared3 * (health16 * health16 + t8 * t8);
    const lagc_real t20 = prepared4 * (t0 * t0 + p->prepared[7]) + prepared2 * (health10 * health10 + t3 * t3);
    const lagc_real t21 = t14 * (t14 * prepared3) + (t12 * (health18 * t12) - t13 * (health19 * t13));
    const lagc_real t22 = t1 * (prepared4 * t1) + t2 * (prepared4 * t2) + t18 + (t20 + t19);
    health[1] = (t21 + (t17 + (t10 * (t10 * prepared2) + t11 * (health17 * t11)))) / t22;
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    qdot[0] = x[6];
    qdot[1] = x[7];
    qdot[2] = x[8];
    const lagc_real der_yaw = x[9];
    qdot[3] = der_yaw;
    const lagc_real der_lean = x[10];
    qdot[4] = der_lean;
    const lagc_real der_spin = x[11];
    qdot[5] = der_spin;
    const lagc_real m = p->m;
    M[0] = m;
    M[2] = m;
    M[5] = m;
    M[1] = 0.0;
    M[3] = 0.0;
    M[4] = 0.0;
    M[6] = 0.0;
    M[7] = 0.0;
    M[8] = 0.0;
    M[10] = 0.0;
    M[11] = 0.0;
    M[12] = 0.0;
    M[13] = 0.0;
    M[15] = 0.0;
    M[16] = 0.0;
    M[17] = 0.0;
    M[19] = 0.0;
    r[0] = 0.0;
    r[1] = 0.0;
    G[0] = 0.0;
    G[1] = 0.0;
    G[3] = 0.0;
    G[5] = 0.0;
    G[7] = 0.0;
    G[8] = 0.0;
    G[12] = 0.0;
    G[14] = 0.0;
    const lagc_real lean = x[4];
    const lagc_real spin = x[5];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, spin, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real prepared0 = p->prepared[0];
    M[20] = prepared0;
    const lagc_real t1 = t0 * prepared0;
    M[18] = t1;
    const lagc_real t2 = sc0[1];
    const lagc_real prepared1 = p->prepared[1];
    M[14] = prepared1;
    M[9] = t0 * t1 + t2 * t2 * prepared1;
    r[2] = -p->prepared[6];
    const lagc_real t3 = der_lean * t0;
    const lagc_real t4 = sc0[2];
    const lagc_real t5 = der_lean * t4;
    const lagc_real t6 = der_yaw * t2;
    const lagc_real t7 = sc0[3];
    const lagc_real t8 = der_spin + der_yaw * t0;
    const lagc_real t9 = der_spin * t2;
    const lagc_real t10 = (t5 + t6 * t7) * t8 + (der_spin * t5 + der_yaw * (t7 * t9 - t3 * t4));
    const lagc_real t11 = der_lean * t7;
    const lagc_real t12 = t8 * (t11 - t4 * t6) + (der_spin * t11 - der_yaw * (t3 * t7 + t4 * t9));
    r[3] = -(t2 * (prepared0 * (der_yaw * t3) + prepared1 * (t4 * t10 + t7 * t12)));
    r[4] = -(prepared1 * (t4 * t12 - t7 * t10));
    r[5] = -(prepared0 * (der_lean * t6));
    G[2] = 1.0;
    G[6] = 1.0;
    G[13] = 1.0;
    const lagc_real r_ = p->r;
    const lagc_real t13 = t0 * r_;
    G[4] = t13;
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t14 = sc1[1];
    const lagc_real t15 = t13 * t14;
    G[9] = -t15;
    const lagc_real t16 = sc1[0];
    const lagc_real t17 = t2 * r_;
    G[10] = -(t16 * t17);
    G[11] = -(r_ * t14);
    const lagc_real t18 = t13 * t16;
    G[15] = -t18;
    G[16] = t14 * t17;
    G[17] = -(r_ * t16);
    gamma[0] = -(t17 * (der_lean * der_lean));
    const lagc_real t19 = der_lean * t14;
    const lagc_real t20 = t19 - t9 * t16;
    const lagc_real t21 = der_lean * t16;
    const lagc_real t22 = der_lean * t13;
    const lagc_real t23 = der_yaw + der_spin * t0;
    const lagc_real t24 = t2 * (r_ * t23 + der_spin * t13);
    const lagc_real t25 = der_yaw * t23;
    const lagc_real t26 = t17 * (der_yaw * t20 - t3 * (der_spin * t14)) - (t21 + t9 * t14) * t22;
    gamma[1] = t26 + (t19 * t24 - t18 * t25);
    const lagc_real t27 = t20 * t22 + t17 * (der_yaw * t21 + der_spin * (t6 * t14 - t3 * t16));
    gamma[2] = t15 * t25 + t21 * t24 + t27;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real m = p->m;
    w[0] = m;
    w[1] = m;
    w[2] = m;
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real prepared0 = p->prepared[0];
    w[6] = prepared0;
    const lagc_real t1 = t0 * prepared0;
    w[5] = t1;
    const lagc_real t2 = sc0[1];
    const lagc_real prepared1 = p->prepared[1];
    w[4] = prepared1;
    w[3] = t0 * t1 + t2 * t2 * prepared1;
    w[7] = 1.0;
    w[9] = 1.0;
    w[13] = 1.0;
    const lagc_real r_ = p->r;
    w[8] = t0 * r_;
    const lagc_real t3 = r_ * sc0[3];
    w[10] = -(t0 * t3);
    const lagc_real t4 = r_ * sc0[2];
    w[11] = -(t2 * t4);
    w[12] = -t3;
    w[14] = -(t0 * t4);
    w[15] = t2 * t3;
    w[16] = -t4;
    (void)(t);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real t0 = 1.0 / w[2];
    w[17] = t0;
    w[31] = t0;
    const lagc_real t1 = 1.0 / w[1];
    w[18] = t1;
    w[32] = t1;
    const lagc_real t2 = 1.0 / w[0];
    w[19] = t2;
    w[33] = t2;
    const lagc_real w5 = w[5];
    const lagc_real t3 = 1.0 / w[6];
    w[34] = t3;
    const lagc_real t4 = w5 * t3;
    w[20] = t4;
    const lagc_real w12 = w[12];
    const lagc_real t5 = w12 * t3;
    w[21] = t5;
    const lagc_real w16 = w[16];
    const lagc_real t6 = w16 * t3;
    w[22] = t6;
    const lagc_real t7 = w[10] - w5 * t5;
    const lagc_real w3 = w[3];
    const lagc_real t8 = w3 - w5 * t4;
    const lagc_real t9 = 1.0 / t8;
    w[35] = t9;
    const lagc_real t10 = t7 * t9;
    w[23] = t10;
    const lagc_real t11 = w[14] - w5 * t6;
    const lagc_real t12 = t11 * t9;
    w[24] = t12;
    const lagc_real w8 = w[8];
    const lagc_real t13 = 1.0 / w[4];
    w[36] = t13;
    const lagc_real t14 = w8 * t13;
    w[25] = t14;
    const lagc_real w11 = w[11];
    const lagc_real t15 = w11 * t13;
    w[26] = t15;
    const lagc_real w15 = w[15];
    const lagc_real t16 = w15 * t13;
    w[27] = t16;
    const lagc_real t17 = w8 * t16;
    const lagc_real t18 = 1.0 / (t1 + w16 * t6 + t11 * t12 + w15 * t16);
    const lagc_real t19 = t17 * t18;
    w[28] = t19;
    const lagc_real t20 = w12 * t6 + t7 * t12 + w11 * t16;
    const lagc_real t21 = t20 * t18;
    w[29] = t21;
    const lagc_real t22 = t17 * t21 - w8 * t15;
    const lagc_real t23 = t2 + w12 * t5 + t7 * t10 + w11 * t15;
    const lagc_real t24 = t20 * t21 - t23;
    const lagc_real t25 = 1.0 / t24;
    w[38] = t25;
    const lagc_real t26 = t22 * t25;
    w[30] = t26;
    w[37] = -t18;
    const lagc_real t27 = t0 + w8 * t14;
    const lagc_real t28 = t17 * t19 - t27 - t22 * t26;
    w[39] = 1.0 / t28;
    health[0] = lagc_min(lagc_min(t8 / w3, -(t24 / t23)), -(t28 / t27));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r0 = r[0];
    const lagc_real w19 = w[19];
    const lagc_real r5 = r[5];
    const lagc_real w21 = w[21];
    const lagc_real w23 = w[23];
    const lagc_real w20 = w[20];
    const lagc_real t0 = r[3] - r5 * w20;
    const lagc_real r4 = r[4];
    const lagc_real w26 = w[26];
    const lagc_real w29 = w[29];
    const lagc_real r1 = r[1];
    const lagc_real w18 = w[18];
    const lagc_real w22 = w[22];
    const lagc_real w24 = w[24];
    const lagc_real w27 = w[27];
    const lagc_real t1 = r[8] - r1 * w18 - r5 * w22 - w24 * t0 - r4 * w27;
    const lagc_real t2 = r[7] - r0 * w19 - r5 * w21 - w23 * t0 - r4 * w26 - w29 * t1;
    const lagc_real w30 = w[30];
    const lagc_real r2 = r[2];
    const lagc_real w17 = w[17];
    const lagc_real w25 = w[25];
    const lagc_real w28 = w[28];
    const lagc_real t3 = w[39] * (r[6] - r2 * w17 - r4 * w25 - w28 * t1 - w30 * t2);
    const lagc_real t4 = w[38] * t2 - w30 * t3;
    s[0] = r0 * w[33] - w19 * t4;
    const lagc_real t5 = w[37] * t1 - w28 * t3 - w29 * t4;
    s[1] = r1 * w[32] - w18 * t5;
    s[2] = r2 * w[31] - w17 * t3;
    const lagc_real t6 = w[35] * t0 - w23 * t4 - w24 * t5;
    s[3] = t6;
    s[4] = r4 * w[36] - w25 * t3 - w26 * t4 - w27 * t5;
    s[5] = r5 * w[34] - w21 * t4 - w22 * t5 - w20 * t6;
    s[6] = -t3;
    s[7] = -t4;
    s[8] = -t5;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real t1 = s[7];
    const lagc_real t2 = t1 + (r[0] - t0 * w[0]);
    const lagc_real w19 = w[19];
    const lagc_real t3 = s[3];
    const lagc_real w10 = w[10];
    const lagc_real t4 = s[4];
    const lagc_real w11 = w[11];
    const lagc_real t5 = s[5];
    const lagc_real w12 = w[12];
    const lagc_real w21 = w[21];
    const lagc_real t6 = s[8];
    const lagc_real w16 = w[16];
    const lagc_real w5 = w[5];
    const lagc_real t7 = t6 * w16 + (t1 * w12 + (r[5] - t3 * w5 - t5 * w[6]));
    const lagc_real w23 = w[23];
    const lagc_real w14 = w[14];
    const lagc_real w20 = w[20];
    const lagc_real t8 = t6 * w14 + (t1 * w10 + (r[3] - t3 * w[3] - t5 * w5)) - w20 * t7;
    const lagc_real w26 = w[26];
    const lagc_real w15 = w[15];
    const lagc_real t9 = s[6];
    const lagc_real w8 = w[8];
    const lagc_real t10 = t6 * w15 + (t1 * w11 + (t9 * w8 + (r[4] - t4 * w[4])));
    const lagc_real w29 = w[29];
    const lagc_real t11 = s[1];
    const lagc_real w18 = w[18];
    const lagc_real t12 = t6 + (r[1] - t11 * w[1]);
    const lagc_real w22 = w[22];
    const lagc_real w24 = w[24];
    const lagc_real w27 = w[27];
    const lagc_real t13 = r[8] - t11 - t3 * w14 - t4 * w15 - t5 * w16 - w18 * t12 - w22 * t7 - w24 * t8;
    const lagc_real t14 = t13 - w27 * t10;
    const lagc_real t15 = r[7] - t0 - t3 * w10 - t4 * w11 - t5 * w12 - w19 * t2 - w21 * t7 - w23 * t8 - w26 * t10;
    const lagc_real t16 = t15 - w29 * t14;
    const lagc_real w30 = w[30];
    const lagc_real t17 = s[2];
    const lagc_real w17 = w[17];
    const lagc_real t18 = t9 + (r[2] - t17 * w[2]);
    const lagc_real w25 = w[25];
    const lagc_real w28 = w[28];
    const lagc_real t19 = w[39] * (r[6] - t17 - t4 * w8 - w17 * t18 - w25 * t10 - w28 * t14 - w30 * t16);
    const lagc_real t20 = w[38] * t16 - w30 * t19;
    const lagc_real t21 = w[37] * t14 - w28 * t19 - w29 * t20;
    const lagc_real t22 = w[35] * t8 - w23 * t20 - w24 * t21;
    const lagc_real t23 = t0 + (w[33] * t2 - w19 * t20);
    const lagc_real t24 = t11 + (w[32] * t12 - w18 * t21);
    const lagc_real t25 = t17 + (w[31] * t18 - w17 * t19);
    const lagc_real t26 = t3 + t22;
    const lagc_real t27 = t4 + (w[36] * t10 - w25 * t19 - w26 * t20 - w27 * t21);
    const lagc_real t28 = t5 + (w[34] * t7 - w21 * t20 - w22 * t21 - w20 * t22);
    const lagc_real t29 = -(t19 - t9);
    const lagc_real t30 = -(t20 - t1);
    const lagc_real t31 = -(t21 - t6);
    s[0] = t23;
    s[1] = t24;
    s[2] = t25;
    s[3] = t26;
    s[4] = t27;
    s[5] = t28;
    s[6] = t29;
    s[7] = t30;
    s[8] = t31;
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    lagc_real sc0[2]; lagc_sine_cosine(x[4], sc0);
    /* touch, rolling_disc.lag:29 */
    phi[0] = x[2] - sc0[1] * p->r;
    (void)(t);
}

/* rates of the constraint equations */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real r_ = p->r;
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real der_lean = x[10];
    /* touch, rolling_disc.lag:29 */
    psi[0] = x[8] + r_ * (t0 * der_lean);
    const lagc_real t1 = sc0[1];
    const lagc_real t2 = sc0[2];
    const lagc_real t3 = sc0[3];
    const lagc_real der_spin = x[11];
    const lagc_real t4 = t1 * der_spin;
    const lagc_real t5 = t0 * (x[9] + t0 * der_spin);
    /* roll[1], rolling_disc.lag:30 */
    psi[1] = x[6] - r_ * (t1 * (der_lean * t2 + t3 * t4) + t3 * t5);
    /* roll[2], rolling_disc.lag:30 */
    psi[2] = x[7] + r_ * (t1 * (der_lean * t3 - t2 * t4) - t2 * t5);
    (void)(t);
}

/* size of the terms of each constraint equation */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real r_ = p->r;
    const lagc_real t1 = t0 * r_;
    s[0] = fabs(t1) + fabs(x[2]) * 2.0 + 1e-300;
    const lagc_real der_spin = x[11];
    const lagc_real t2 = sc0[3];
    const lagc_real t3 = der_spin * t2;
    const lagc_real der_lean = x[10];
    const lagc_real t4 = sc0[2];
    const lagc_real t5 = der_lean * t4;
    const lagc_real der_yaw = x[9];
    const lagc_real t6 = sc0[0];
    const lagc_real t7 = r_ * t6;
    const lagc_real t8 = t2 * t7;
    const lagc_real t9 = der_yaw + der_spin * t6;
    const lagc_real t10 = fabs(t8 * t9) + (fabs(t1 * (t5 + t0 * t3)) + (1e-300 + 2.0 * fabs(x[6])));
    const lagc_real t11 = fabs(r_ * t3) + (fabs(t1 * t5) + (fabs(der_yaw * t8) + t10));
    const lagc_real t12 = der_spin * t4;
    const lagc_real t13 = t2 * der_lean;
    const lagc_real t14 = t4 * t7;
    const lagc_real t15 = fabs(t1 * (t13 - t0 * t12)) + (fabs(t9 * t14) + (1e-300 + 2.0 * fabs(x[7])));
    const lagc_real t16 = fabs(r_ * t12) + (fabs(t1 * t13) + (fabs(der_yaw * t14) + t15));
    const lagc_real t17 = lagc_max(t11, t16) * 1e-06;
    s[1] = lagc_max(t11, t17);
    s[2] = lagc_max(t16, t17);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = fabs(sc0[1]);
    const lagc_real t1 = fabs(x[10]);
    const lagc_real prepared8 = p->prepared[8];
    s[0] = t0 * (t1 * t1) * prepared8;
    const lagc_real t2 = fabs(sc0[3]);
    const lagc_real t3 = t1 * t2;
    const lagc_real t4 = fabs(x[9]);
    const lagc_real t5 = fabs(x[11]);
    const lagc_real t6 = fabs(sc0[0]);
    const lagc_real t7 = t5 * t6;
    const lagc_real t8 = prepared8 * (t4 + t7 * 2.0);
    const lagc_real t9 = t3 * t7;
    const lagc_real t10 = t3 * t4;
    const lagc_real t11 = t0 * t5;
    const lagc_real t12 = fabs(sc0[2]);
    const lagc_real t13 = t4 * t12;
    const lagc_real t14 = t11 * t13;
    const lagc_real prepared9 = p->prepared[9];
    const lagc_real t15 = t1 * t12;
    const lagc_real t16 = t4 + t7;
    const lagc_real t17 = prepared8 * t6;
    const lagc_real t18 = t0 * (t3 * t8 + (2.0 * t9 + (2.0 * t10 + 2.0 * t14) + (t9 + (t10 + t14))) * prepared9);
    s[1] = t18 + (t1 * (t15 + t2 * t11) + t13 * t16) * t17;
    const lagc_real t19 = t7 * t15;
    const lagc_real t20 = t4 * t15;
    const lagc_real t21 = t2 * t4;
    const lagc_real t22 = t11 * t21;
    const lagc_real t23 = t8 * t15 + prepared9 * (2.0 * t19 + (2.0 * t20 + 2.0 * t22) + (t19 + (t20 + t22)));
    s[2] = t0 * t23 + t17 * (t16 * t21 + t1 * (t3 + t11 * t12));
    (void)(t);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = fabs(sc0[0]);
    const lagc_real prepared9 = p->prepared[9];
    s[0] = 1.0 + t0 * prepared9;
    const lagc_real t1 = fabs(sc0[1]);
    const lagc_real t2 = fabs(sc0[2]);
    const lagc_real t3 = fabs(sc0[3]);
    const lagc_real t4 = t0 * (1.0 + t0);
    s[1] = 1.0 + prepared9 * (t1 * (t2 + t1 * t3) + t3 * t4);
    s[2] = 1.0 + prepared9 * (t2 * t4 + t1 * (t3 + t1 * t2));
    (void)(t);
}

/* reach of each constraint equation */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size0 = c[0];
    s[4] = size0;
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real r_ = p->r;
    const lagc_real t0 = sc0[0] * r_;
    const lagc_real t1 = fabs(t0);
    const lagc_real size1 = c[1];
    const lagc_real t2 = r_ * sc0[1];
    const lagc_real t3 = lagc_max(size1, fabs(t2));
    s[0] = size0 * t1 + (t3 + 1e-300);
    const lagc_real size3 = c[3];
    s[7] = size3;
    const lagc_real t4 = sc0[2];
    const lagc_real t5 = sc0[3];
    const lagc_real size2 = c[2];
    s[6] = size2;
    const lagc_real t6 = 1e-300 + size2;
    const lagc_real t7 = size3 * (fabs(t2 * t4) + (fabs(t0 * t5) + fabs(r_ * t5))) + t6;
    const lagc_real t8 = t6 + size3 * (fabs(t2 * t5) + (fabs(t0 * t4) + fabs(r_ * t4)));
    const lagc_real t9 = lagc_max(t7, t8) * 1e-06;
    s[1] = lagc_max(t7, t9);
    s[2] = lagc_max(t8, t9);
    const lagc_real t10 = lagc_max(size1, t3);
    s[5] = t10;
    const lagc_real t11 = lagc_max(lagc_max(0.0, size2 / (1e-300 + t10)), size3);
    s[3] = t1 * size3 + (size2 + (fabs(x[2] * t11) + (1e-300 + fabs(t2 * t11))));
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_x = x[6];
    const lagc_real prepared10 = p->prepared[10];
    const lagc_real t0 = der_x * der_x * prepared10;
    const lagc_real der_y = x[7];
    const lagc_real t1 = prepared10 * (der_y * der_y);
    const lagc_real der_z = x[8];
    const lagc_real t2 = prepared10 * (der_z * der_z);
    const lagc_real der_yaw = x[9];
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t3 = x[11] + der_yaw * sc0[0];
    const lagc_real t4 = t3 * t3 * p->prepared[1];
    const lagc_real prepared11 = p->prepared[11];
    const lagc_real t5 = der_yaw * sc0[1];
    const lagc_real t6 = prepared11 * (t5 * t5);
    const lagc_real der_lean = x[10];
    const lagc_real t7 = prepared11 * (der_lean * der_lean);
    /* kinetic energy */
    e[0] = t0 + t1 + t2 + t4 + t6 + t7;
    const lagc_real t8 = x[2] * p->prepared[6];
    /* potential energy */
    e[1] = t8;
    /* energy of the balance */
    e[2] = t0 + (t8 + (t1 + (t2 + (t4 + (t6 + t7)))));
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
    x[0] = 0.0;
    /* y */
    x[1] = 0.0;
    /* yaw */
    x[3] = 0.0;
    /* spin */
    x[5] = 0.0;
    /* der(y) */
    x[7] = 0.0;
    /* der(z) */
    x[8] = 0.0;
    /* der(lean) */
    x[10] = 0.0;
    const lagc_real r_ = p->r;
    const lagc_real lean0 = p->lean0;
    /* lean */
    x[4] = lean0;
    lagc_real sc0[2]; lagc_sine_cosine(lean0, sc0);
    /* z */
    x[2] = r_ * sc0[1];
    const lagc_real spin1 = p->spin1;
    /* der(spin) */
    x[11] = spin1;
    const lagc_real yaw1 = p->yaw1;
    /* der(yaw) */
    x[9] = yaw1;
    /* der(x) */
    x[6] = r_ * (spin1 + yaw1 * sc0[0]);
}

/* conditions of a consistent start */
static void lagc_fn_conditions(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *c, lagc_real *J, lagc_real *sizes)
{
    const lagc_real z = x[2];
    const lagc_real lean = x[4];
    const lagc_real yaw = x[3];
    lagc_real sc0[4]; lagc_sine_cosine_two(lean, yaw, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real r_ = p->r;
    const lagc_real t1 = t0 * r_;
    c[0] = z - t1;
    const lagc_real der_z = x[8];
    const lagc_real der_lean = x[10];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = r_ * t2;
    J[1] = t3;
    J[4] = t3;
    const lagc_real t4 = der_lean * t3;
    c[1] = der_z + t4;
    const lagc_real der_x = x[6];
    const lagc_real t5 = sc0[2];
    const lagc_real t6 = sc0[3];
    const lagc_real der_spin = x[11];
    const lagc_real t7 = t0 * der_spin;
    const lagc_real t8 = der_lean * t5 + t6 * t7;
    const lagc_real t9 = t1 * t8;
    const lagc_real t10 = x[9] + t2 * der_spin;
    const lagc_real t11 = t3 * t10;
    const lagc_real t12 = t6 * t11;
    c[2] = der_x - t9 - t12;
    const lagc_real t13 = der_lean * t6 - t5 * t7;
    const lagc_real t14 = t1 * t13;
    const lagc_real der_y = x[7];
    const lagc_real t15 = t5 * t11;
    c[3] = t14 + (der_y - t15);
    J[0] = 1.0;
    J[3] = 1.0;
    J[7] = 1.0;
    J[13] = 1.0;
    const lagc_real t16 = t1 * der_lean;
    J[2] = t16;
    const lagc_real t17 = t11 + t1 * t7;
    J[5] = t5 * t17 - t6 * t16;
    const lagc_real t18 = t1 * t6;
    J[15] = t18;
    const lagc_real t19 = t0 * (r_ * t10 + t3 * der_spin);
    J[6] = t2 * (r_ * t8 + der_spin * t18) - t6 * t19;
    J[8] = -(t3 * t6);
    const lagc_real t20 = t1 * t5;
    J[9] = -t20;
    J[10] = -(r_ * t6);
    J[11] = -(t5 * t16 + t6 * t17);
    J[12] = -(t2 * (r_ * t13 - der_spin * t20) + t5 * t19);
    J[14] = -(t3 * t5);
    J[16] = -(r_ * t5);
    sizes[0] = fabs(z) + fabs(t1);
    sizes[1] = fabs(der_z) + fabs(t4);
    sizes[2] = fabs(der_x) + fabs(t9) + fabs(t12);
    sizes[3] = fabs(der_y) + fabs(t15) + fabs(t14);
    (void)(t);
}

/* stated rates, sizes of parameters */
static void lagc_fn_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)
{
    largest[2] = 0.0;
    largest[0] = lagc_max(0.0, fabs(p->r));
    largest[1] = lagc_max(0.0, fabs(p->lean0));
    largest[3] = lagc_max(lagc_max(0.0, fabs(p->yaw1)), fabs(p->spin1));
    (void)(s);
}
