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
    prepared[2] = 1.0 / t2;
    const lagc_real t3 = 1.0 / m;
    prepared[3] = t3;
    const lagc_real field_g = p->field_g;
    prepared[14] = field_g;
    const lagc_real t4 = m * field_g;
    prepared[5] = t4;
    prepared[4] = t3 * t4;
    prepared[6] = t4 * t4;
    prepared[7] = 1.0 / t1;
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
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real t1 = sc0[1];
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t2 = sc1[1];
    const lagc_real spin = x[5];
    lagc_real sc2[2]; lagc_sine_cosine(spin, sc2);
    const lagc_real t3 = sc2[1];
    const lagc_real t4 = sc2[0];
    const lagc_real t5 = sc1[0];
    const lagc_real t6 = t1 * t1;
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t7 = t0 * prepared0;
    const lagc_real t8 = t0 * t2;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t9 = t8 * t4;
    const lagc_real t10 = t3 * t8;
    const lagc_real t11 = t6 * prepared1 + t0 * t7;
    const lagc_real t12 = 1.0 / t11;
    const lagc_real t13 = t9 - t3 * t5 - t9;
    const lagc_real t14 = t10 + t4 * t5 - t10;
    const lagc_real r_ = p->r;
    const lagc_real t15 = t0 * r_;
    const lagc_real t16 = t7 * t12;
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t17 = t15 * prepared2;
    const lagc_real t18 = prepared0 - t7 * t16;
    const lagc_real t19 = r_ * (t8 + t6 * (t3 * t14 + t4 * t13));
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t20 = 1.0 / t18;
    const lagc_real t21 = (t3 * t13 - t4 * t14) * (r_ * t1);
    const lagc_real t22 = t19 * t12;
    const lagc_real t23 = 1.0 / (prepared3 + t15 * t17);
    const lagc_real t24 = t21 * prepared2;
    const lagc_real t25 = r_ * t2;
    const lagc_real t26 = t7 * t22 - t25;
    const lagc_real t27 = t0 * t5;
    const lagc_real t28 = t1 * t25;
    const lagc_real t29 = t15 * t24;
    const lagc_real t30 = t26 * t20;
    const lagc_real t31 = prepared2 * t28;
    const lagc_real t32 = r_ * t27;
    const lagc_real t33 = t29 * t23;
    const lagc_real der_yaw = x[9];
    /* der(yaw) */
    xdot[3] = der_yaw;
    const lagc_real t34 = der_yaw * t0;
    const lagc_real t35 = t15 * t31;
    const lagc_real t36 = t12 * t32;
    const lagc_real t37 = t26 * t30 + (t19 * t22 + (prepared3 + t21 * t24));
    const lagc_real der_lean = x[10];
    /* der(lean) */
    xdot[4] = der_lean;
    const lagc_real t38 = der_lean * t1;
    const lagc_real der_spin = x[11];
    /* der(spin) */
    xdot[5] = der_spin;
    const lagc_real t39 = der_spin + t34;
    const lagc_real t40 = t23 * t35;
    const lagc_real t41 = r_ * t5;
    const lagc_real t42 = t29 * t33 - t37;
    const lagc_real t43 = t7 * t36 - t41;
    const lagc_real t44 = 1.0 / t42;
    const lagc_real t45 = der_lean * der_lean;
    const lagc_real t46 = t20 * t43;
    const lagc_real t47 = (t34 + der_spin * 2.0) * (t1 * (der_yaw * prepared1));
    const lagc_real t48 = t38 * (der_lean * r_);
    const lagc_real t49 = t29 * t40 - t21 * t31 - t19 * t36 - t26 * t46;
    const lagc_real t50 = r_ * (der_yaw * (t38 * (t2 * 2.0) - t5 * t39) - t27 * t45);
    const lagc_real t51 = (t39 + t39) * (prepared1 * t38);
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t52 = t44 * t49;
    const lagc_real t53 = t43 * t46 + (t32 * t36 + (prepared3 + t28 * t31));
    const lagc_real t54 = t38 * (der_yaw * prepared0);
    const lagc_real t55 = prepared4 - t48 - t17 * t47;
    const lagc_real t56 = r_ * (t8 * t45 + der_yaw * (t2 * t39 + t38 * (t5 * 2.0)));
    const lagc_real t57 = t16 * t51 - t54;
    const lagc_real t58 = t35 * t40 - t53 - t49 * t52;
    const lagc_real t59 = 1.0 / t58;
    const lagc_real t60 = t50 - t24 * t47 - t22 * t51 - t33 * t55 - t30 * t57;
    const lagc_real t61 = t59 * (t56 - t47 * t31 - t51 * t36 - t55 * t40 - t57 * t46 - t60 * t52);
    const lagc_real t62 = t44 * t60 - t52 * t61;
    const lagc_real t63 = t20 * t57 - t46 * t61 - t30 * t62;
    /* der(der(spin)) */
    xdot[11] = t63;
    const lagc_real t64 = prepared3 * t62;
    const lagc_real t65 = prepared3 * t61;
    const lagc_real t66 = t33 * t62 + (t23 * t55 + t40 * t61);
    /* touch, rolling_disc.lag:29 */
    lam[0] = t66;
    const lagc_real t67 = t22 * t62 + (t36 * t61 - t12 * t51) - t16 * t63;
    /* der(der(yaw)) */
    xdot[9] = t67;
    const lagc_real t68 = prepared3 * t66 - prepared4;
    /* der(der(z)) */
    xdot[8] = t68;
    const lagc_real t69 = t17 * t66 + (prepared2 * t47 - t31 * t61 - t24 * t62);
    /* der(der(lean)) */
    xdot[10] = t69;
    const lagc_real m = p->m;
    const lagc_real t70 = t64 * m;
    const lagc_real t71 = t65 * m;
    const lagc_real t72 = prepared0 * t63;
    const lagc_real t73 = t70 - t62;
    const lagc_real t74 = t71 - t61;
    const lagc_real t75 = t68 * m;
    const lagc_real t76 = t11 * t67;
    const lagc_real t77 = prepared1 * t69;
    const lagc_real t78 = t66 - p->prepared[5] - t75;
    const lagc_real t79 = t19 * t62 + (t32 * t61 - t51) - t7 * t63 - t76;
    const lagc_real t80 = t25 * t62 + (t41 * t61 - t54) - t72 - t7 * t67;
    const lagc_real t81 = t15 * t66 + (t47 - t28 * t61 - t21 * t62) - t77;
    const lagc_real t82 = t15 * t69 + (t48 + t68);
    const lagc_real t83 = t19 * t67 + (t25 * t63 + (t50 + t64)) - t21 * t69;
    const lagc_real t84 = t32 * t67 + (t41 * t63 + (t56 + t65)) - t28 * t69;
    const lagc_real t85 = t23 * (t48 * t48) + 1e-300 - t44 * (t50 * t50) - t59 * (t56 * t56);
    const lagc_real t86 = t70 * (prepared3 * t70) + (t71 * (prepared3 * t71) + t85);
    const lagc_real t87 = t78 * (prepared3 * t78) + (t73 * (prepared3 * t73) + t74 * (prepared3 * t74));
    const lagc_real t88 = t81 * (prepared2 * t81) + t82 * (t23 * t82) - (t83 * (t44 * t83) + t84 * (t59 * t84));
    const lagc_real t89 = prepared3 * (t75 * t75 + p->prepared[6]) + (t20 * (t54 * t54 + t72 * t72) + t86);
    const lagc_real t90 = t89 + (t12 * (t51 * t51 + t76 * t76) + prepared2 * (t47 * t47 + t77 * t77));
    health[1] = (t87 + (t79 * (t12 * t79) + t80 * (t20 * t80)) + t88) / t90;
    health[0] = lagc_min(lagc_min(t18 * p->prepared[7], -(t42 / t37)), -(t58 / t53));
    /* der(der(x)) */
    xdot[6] = -t64;
    /* der(der(y)) */
    xdot[7] = -t65;
    /* roll[1], rolling_disc.lag:30 */
    lam[1] = -t62;
    /* roll[2], rolling_disc.lag:30 */
    lam[2] = -t61;
    /* der(x) */
    xdot[0] = x[6];
    /* der(y) */
    xdot[1] = x[7];
    /* der(z) */
    xdot[2] = x[8];
    (void)(t);
}

/* mass matrix, forces and constraint rows */
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
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = t0 * t0;
    const lagc_real prepared1 = p->prepared[1];
    M[14] = prepared1;
    const lagc_real t2 = sc0[0];
    const lagc_real prepared0 = p->prepared[0];
    M[20] = prepared0;
    const lagc_real t3 = t2 * prepared0;
    M[18] = t3;
    M[9] = t1 * prepared1 + t2 * t3;
    r[2] = -p->prepared[5];
    const lagc_real spin = x[5];
    lagc_real sc1[2]; lagc_sine_cosine(spin, sc1);
    const lagc_real t4 = sc1[1];
    const lagc_real t5 = sc1[0];
    const lagc_real t6 = der_yaw * t0;
    const lagc_real t7 = der_lean * t4 - t5 * t6;
    const lagc_real t8 = der_yaw * t2;
    const lagc_real t9 = der_spin + t8;
    const lagc_real t10 = der_spin * t4;
    const lagc_real t11 = der_lean * t2;
    const lagc_real t12 = der_spin * t5;
    const lagc_real t13 = der_lean * t10 - der_yaw * (t4 * t11 + t0 * t12);
    const lagc_real t14 = t7 * t9 + t13;
    const lagc_real t15 = der_lean * t5 + t4 * t6;
    const lagc_real t16 = der_lean * t12 + der_yaw * (t0 * t10 - t5 * t11);
    const lagc_real t17 = t9 * t15 + t16;
    const lagc_real t18 = der_yaw * prepared0;
    r[3] = -(t0 * (prepared1 * (t4 * t14 + t5 * t17) + t11 * t18));
    r[4] = -(prepared1 * (t5 * t14 - t4 * t17));
    const lagc_real t19 = der_lean * t0;
    r[5] = -(t18 * t19);
    G[2] = 1.0;
    G[6] = 1.0;
    G[13] = 1.0;
    const lagc_real r_ = p->r;
    const lagc_real t20 = t2 * r_;
    G[4] = t20;
    const lagc_real yaw = x[3];
    lagc_real sc2[2]; lagc_sine_cosine(yaw, sc2);
    const lagc_real t21 = sc2[1];
    const lagc_real t22 = t2 * t21;
    const lagc_real t23 = t4 * t22;
    const lagc_real t24 = sc2[0];
    const lagc_real t25 = t5 * t24;
    const lagc_real t26 = t25 - t23;
    const lagc_real t27 = t23 + t26;
    const lagc_real t28 = t5 * t21;
    const lagc_real t29 = t2 * t28;
    const lagc_real t30 = t4 * t24;
    const lagc_real t31 = t29 + t30;
    const lagc_real t32 = t29 - t31;
    G[9] = -(r_ * (t22 + t1 * (t4 * t27 + t5 * t32)));
    G[10] = r_ * (t0 * (t4 * t32 - t5 * t27));
    const lagc_real t33 = r_ * t21;
    G[11] = -t33;
    G[15] = -(t20 * t24);
    G[16] = t0 * t33;
    G[17] = -(r_ * t24);
    gamma[0] = -(r_ * (der_lean * t19));
    const lagc_real t34 = t4 * t19;
    const lagc_real t35 = t5 * t19;
    const lagc_real t36 = der_yaw + der_spin * t2;
    const lagc_real t37 = t9 * t24;
    const lagc_real t38 = t9 * t21;
    const lagc_real t39 = t7 * (t21 * (t35 + t4 * t36) - t9 * t25) + (t6 * (t19 * t21 - t37) - t16 * t31);
    const lagc_real t40 = t15 * (der_yaw * t28 + der_spin * t30 - (t21 * (t34 - t2 * t12) - t8 * t30));
    const lagc_real t41 = t0 * (t40 + (t13 * t26 + (t39 - t11 * t38))) - t11 * (t7 * t31 + t0 * t38 + t15 * t26);
    const lagc_real t42 = t4 * t15;
    const lagc_real t43 = t5 * t7;
    const lagc_real t44 = t2 * t9 + t0 * (t42 - t43);
    const lagc_real t45 = t0 * (der_lean * (der_spin + t8 * 2.0) - t12 * t15 + t4 * t13) - t11 * t42;
    const lagc_real t46 = t19 * t44 + t2 * (t45 - (t0 * (t7 * t10 - t5 * t16) - t11 * t43));
    const lagc_real t47 = t8 * t44;
    gamma[1] = r_ * t41 + r_ * (t21 * t46 - t24 * t47);
    const lagc_real t48 = t28 + t2 * t30;
    const lagc_real t49 = t4 * t21 - t2 * t25;
    const lagc_real t50 = t16 * t49 + t7 * (der_yaw * t30 + der_spin * t28 + (t8 * t28 + t24 * (t35 + t2 * t10)));
    const lagc_real t51 = t15 * (t24 * (t34 - t5 * t36) + t4 * t38) + (t13 * t48 - t50);
    const lagc_real t52 = t0 * (t51 - (t6 * (t38 + t19 * t24) - t11 * t37));
    gamma[2] = -(r_ * (t52 - t11 * (t7 * t49 - t0 * t37 + t15 * t48)) - r_ * (t24 * t46 + t21 * t47));
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
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = t0 * t0;
    const lagc_real prepared1 = p->prepared[1];
    w[4] = prepared1;
    const lagc_real t2 = sc0[0];
    const lagc_real prepared0 = p->prepared[0];
    w[6] = prepared0;
    const lagc_real t3 = t2 * prepared0;
    w[5] = t3;
    w[3] = t1 * prepared1 + t2 * t3;
    w[7] = 1.0;
    w[9] = 1.0;
    w[13] = 1.0;
    const lagc_real r_ = p->r;
    const lagc_real t4 = t2 * r_;
    w[8] = t4;
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t5 = sc1[1];
    const lagc_real t6 = t2 * t5;
    const lagc_real spin = x[5];
    lagc_real sc2[2]; lagc_sine_cosine(spin, sc2);
    const lagc_real t7 = sc2[1];
    const lagc_real t8 = t6 * t7;
    const lagc_real t9 = sc1[0];
    const lagc_real t10 = sc2[0];
    const lagc_real t11 = t8 + (t9 * t10 - t8);
    const lagc_real t12 = t6 * t10;
    const lagc_real t13 = t12 - (t12 + t7 * t9);
    w[10] = -(r_ * (t6 + t1 * (t7 * t11 + t10 * t13)));
    w[11] = r_ * (t0 * (t7 * t13 - t10 * t11));
    const lagc_real t14 = r_ * t5;
    w[12] = -t14;
    w[14] = -(t4 * t9);
    w[15] = t0 * t14;
    w[16] = -(r_ * t9);
    (void)(t);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real w9 = w[9];
    const lagc_real t0 = 1.0 / w[0];
    w[31] = t0;
    const lagc_real t1 = w9 * t0;
    w[17] = t1;
    const lagc_real w13 = w[13];
    const lagc_real t2 = 1.0 / w[1];
    w[32] = t2;
    const lagc_real t3 = w13 * t2;
    w[18] = t3;
    const lagc_real w7 = w[7];
    const lagc_real t4 = 1.0 / w[2];
    w[33] = t4;
    const lagc_real t5 = w7 * t4;
    w[19] = t5;
    const lagc_real w5 = w[5];
    const lagc_real t6 = 1.0 / w[3];
    w[34] = t6;
    const lagc_real t7 = w5 * t6;
    w[20] = t7;
    const lagc_real w10 = w[10];
    const lagc_real t8 = w10 * t6;
    w[21] = t8;
    const lagc_real w14 = w[14];
    const lagc_real t9 = w14 * t6;
    w[22] = t9;
    const lagc_real t10 = w[12] - w5 * t8;
    const lagc_real w6 = w[6];
    const lagc_real t11 = w6 - w5 * t7;
    const lagc_real t12 = 1.0 / t11;
    w[36] = t12;
    const lagc_real t13 = t10 * t12;
    w[23] = t13;
    const lagc_real t14 = w[16] - w5 * t9;
    const lagc_real t15 = t14 * t12;
    w[24] = t15;
    const lagc_real w8 = w[8];
    const lagc_real t16 = 1.0 / w[4];
    w[35] = t16;
    const lagc_real t17 = w8 * t16;
    w[25] = t17;
    const lagc_real w11 = w[11];
    const lagc_real t18 = w11 * t16;
    w[26] = t18;
    const lagc_real w15 = w[15];
    const lagc_real t19 = w15 * t16;
    w[27] = t19;
    const lagc_real t20 = w8 * t18;
    const lagc_real t21 = 1.0 / (w7 * t5 + w8 * t17);
    const lagc_real t22 = t20 * t21;
    w[28] = t22;
    const lagc_real t23 = w8 * t19;
    const lagc_real t24 = t23 * t21;
    w[29] = t24;
    const lagc_real t25 = t20 * t24 - (w10 * t9 + t10 * t15 + w11 * t19);
    const lagc_real t26 = w9 * t1 + w10 * t8 + t10 * t13 + w11 * t18;
    const lagc_real t27 = t20 * t22 - t26;
    const lagc_real t28 = 1.0 / t27;
    w[38] = t28;
    const lagc_real t29 = t25 * t28;
    w[30] = t29;
    w[37] = -t21;
    const lagc_real t30 = w13 * t3 + w14 * t9 + t14 * t15 + w15 * t19;
    const lagc_real t31 = t23 * t24 - t30 - t25 * t29;
    w[39] = 1.0 / t31;
    health[0] = lagc_min(lagc_min(t11 / w6, -(t27 / t26)), -(t31 / t30));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r0 = r[0];
    const lagc_real w17 = w[17];
    const lagc_real r3 = r[3];
    const lagc_real w21 = w[21];
    const lagc_real w23 = w[23];
    const lagc_real w20 = w[20];
    const lagc_real t0 = r[5] - r3 * w20;
    const lagc_real r4 = r[4];
    const lagc_real w26 = w[26];
    const lagc_real w28 = w[28];
    const lagc_real r2 = r[2];
    const lagc_real w19 = w[19];
    const lagc_real w25 = w[25];
    const lagc_real t1 = r[6] - r2 * w19 - r4 * w25;
    const lagc_real t2 = r[7] - r0 * w17 - r3 * w21 - w23 * t0 - r4 * w26 - w28 * t1;
    const lagc_real w30 = w[30];
    const lagc_real r1 = r[1];
    const lagc_real w18 = w[18];
    const lagc_real w22 = w[22];
    const lagc_real w24 = w[24];
    const lagc_real w27 = w[27];
    const lagc_real w29 = w[29];
    const lagc_real t3 = w[39] * (r[8] - r1 * w18 - r3 * w22 - w24 * t0 - r4 * w27 - w29 * t1 - w30 * t2);
    const lagc_real t4 = w[38] * t2 - w30 * t3;
    s[0] = r0 * w[31] - w17 * t4;
    s[1] = r1 * w[32] - w18 * t3;
    const lagc_real t5 = w[37] * t1 - w29 * t3 - w28 * t4;
    s[2] = r2 * w[33] - w19 * t5;
    const lagc_real t6 = w[36] * t0 - w24 * t3 - w23 * t4;
    s[5] = t6;
    s[3] = r3 * w[34] - w22 * t3 - w21 * t4 - w20 * t6;
    s[4] = r4 * w[35] - w27 * t3 - w26 * t4 - w25 * t5;
    s[6] = -t5;
    s[7] = -t4;
    s[8] = -t3;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real w9 = w[9];
    const lagc_real t1 = s[7];
    const lagc_real t2 = w9 * t1 + (r[0] - w[0] * t0);
    const lagc_real w17 = w[17];
    const lagc_real w10 = w[10];
    const lagc_real t3 = s[3];
    const lagc_real w11 = w[11];
    const lagc_real t4 = s[4];
    const lagc_real w12 = w[12];
    const lagc_real t5 = s[5];
    const lagc_real w21 = w[21];
    const lagc_real w14 = w[14];
    const lagc_real t6 = s[8];
    const lagc_real w5 = w[5];
    const lagc_real t7 = w14 * t6 + (w10 * t1 + (r[3] - w[3] * t3 - w5 * t5));
    const lagc_real w23 = w[23];
    const lagc_real w16 = w[16];
    const lagc_real w20 = w[20];
    const lagc_real t8 = w16 * t6 + (w12 * t1 + (r[5] - w5 * t3 - w[6] * t5)) - w20 * t7;
    const lagc_real w26 = w[26];
    const lagc_real w15 = w[15];
    const lagc_real w8 = w[8];
    const lagc_real t9 = s[6];
    const lagc_real t10 = w15 * t6 + (w11 * t1 + (w8 * t9 + (r[4] - w[4] * t4)));
    const lagc_real t11 = r[7] - w9 * t0 - w10 * t3 - w11 * t4 - w12 * t5 - w17 * t2 - w21 * t7 - w23 * t8;
    const lagc_real w28 = w[28];
    const lagc_real w7 = w[7];
    const lagc_real t12 = s[2];
    const lagc_real w19 = w[19];
    const lagc_real t13 = w7 * t9 + (r[2] - w[2] * t12);
    const lagc_real w25 = w[25];
    const lagc_real t14 = r[6] - w7 * t12 - w8 * t4 - w19 * t13 - w25 * t10;
    const lagc_real t15 = t11 - w26 * t10 - w28 * t14;
    const lagc_real w30 = w[30];
    const lagc_real w13 = w[13];
    const lagc_real t16 = s[1];
    const lagc_real w18 = w[18];
    const lagc_real t17 = w13 * t6 + (r[1] - w[1] * t16);
    const lagc_real w22 = w[22];
    const lagc_real w24 = w[24];
    const lagc_real w27 = w[27];
    const lagc_real t18 = r[8] - w13 * t16 - w14 * t3 - w15 * t4 - w16 * t5 - w18 * t17 - w22 * t7 - w24 * t8;
    const lagc_real w29 = w[29];
    const lagc_real t19 = w[39] * (t18 - w27 * t10 - w29 * t14 - w30 * t15);
    const lagc_real t20 = w[38] * t15 - w30 * t19;
    const lagc_real t21 = w[37] * t14 - w29 * t19 - w28 * t20;
    const lagc_real t22 = w[36] * t8 - w24 * t19 - w23 * t20;
    const lagc_real t23 = t0 + (w[31] * t2 - w17 * t20);
    const lagc_real t24 = t16 + (w[32] * t17 - w18 * t19);
    const lagc_real t25 = t12 + (w[33] * t13 - w19 * t21);
    const lagc_real t26 = t3 + (w[34] * t7 - w22 * t19 - w21 * t20 - w20 * t22);
    const lagc_real t27 = t4 + (w[35] * t10 - w27 * t19 - w26 * t20 - w25 * t21);
    const lagc_real t28 = t5 + t22;
    const lagc_real t29 = -(t21 - t9);
    const lagc_real t30 = -(t20 - t1);
    const lagc_real t31 = -(t19 - t6);
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

/* rates of the constraint rows */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real r_ = p->r;
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real der_lean = x[10];
    /* touch, rolling_disc.lag:29 */
    psi[0] = x[8] + r_ * (t0 * der_lean);
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real t2 = x[11] + t0 * x[9];
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = der_lean * sc0[1];
    /* roll[1], rolling_disc.lag:30 */
    psi[1] = x[6] - r_ * (t1 * t2 + t3 * t4);
    /* roll[2], rolling_disc.lag:30 */
    psi[2] = x[7] + r_ * (t1 * t4 - t2 * t3);
    (void)(t);
}

/* size of the terms of each constraint row */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real r_ = p->r;
    const lagc_real t1 = t0 * r_;
    s[0] = fabs(t1) + fabs(x[2]) * 2.0 + 1e-300;
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t2 = sc1[1];
    const lagc_real der_spin = x[11];
    const lagc_real t3 = r_ * der_spin;
    const lagc_real spin = x[5];
    lagc_real sc2[2]; lagc_sine_cosine(spin, sc2);
    const lagc_real t4 = sc2[1];
    const lagc_real t5 = sc0[0];
    const lagc_real t6 = t2 * t5;
    const lagc_real t7 = sc2[0];
    const lagc_real t8 = t6 * t7;
    const lagc_real t9 = sc1[0];
    const lagc_real t10 = t8 + t4 * t9;
    const lagc_real t11 = t8 - t10;
    const lagc_real t12 = t4 * t6;
    const lagc_real t13 = t7 * t9 - t12;
    const lagc_real t14 = t12 + t13;
    const lagc_real der_lean = x[10];
    const lagc_real t15 = t1 * der_lean;
    const lagc_real der_yaw = x[9];
    const lagc_real t16 = r_ * der_yaw;
    const lagc_real t17 = der_spin + t5 * der_yaw;
    const lagc_real t18 = t0 * der_yaw;
    const lagc_real t19 = t7 * der_lean + t4 * t18;
    const lagc_real t20 = t4 * der_lean - t7 * t18;
    const lagc_real t21 = r_ * (t5 * t17 + t0 * (t4 * t19 - t7 * t20));
    const lagc_real t22 = t0 * t17;
    const lagc_real t23 = fabs(t1 * (t10 * t20 + t2 * t22 + t13 * t19)) + (1e-300 + 2.0 * fabs(x[6]));
    const lagc_real t24 = fabs((t6 + (t4 * t14 + t7 * t11) * (t0 * t0)) * t16) + (fabs(t6 * t21) + t23);
    const lagc_real t25 = fabs(t2 * t3) + (fabs((t4 * t11 - t7 * t14) * t15) + t24);
    const lagc_real t26 = t5 * t9;
    const lagc_real t27 = fabs(t1 * (t20 * (t2 * t4 - t7 * t26) - t9 * t22 + t19 * (t2 * t7 + t4 * t26)));
    const lagc_real t28 = fabs(t16 * t26) + (t27 + (fabs(t21 * t26) + (1e-300 + 2.0 * fabs(x[7]))));
    const lagc_real t29 = fabs(t3 * t9) + (fabs(t2 * t15) + t28);
    const lagc_real t30 = lagc_max(t25, t29) * 1e-06;
    s[1] = lagc_max(t25, t30);
    s[2] = lagc_max(t29, t30);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = fabs(sc0[1]);
    const lagc_real t1 = fabs(x[10]);
    s[0] = t0 * (t1 * t1) * p->prepared[8];
    const lagc_real t2 = fabs(x[9]);
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t3 = fabs(sc1[1]);
    const lagc_real t4 = t1 * t3;
    const lagc_real prepared9 = p->prepared[9];
    const lagc_real t5 = t0 * prepared9;
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = fabs(sc0[0]);
    const lagc_real spin = x[5];
    lagc_real sc2[2]; lagc_sine_cosine(spin, sc2);
    const lagc_real t8 = fabs(sc2[1]);
    const lagc_real t9 = fabs(sc1[0]);
    const lagc_real t10 = fabs(sc2[0]);
    const lagc_real t11 = t9 * t10;
    const lagc_real t12 = t3 * t7;
    const lagc_real t13 = t8 * t12;
    const lagc_real t14 = t11 + t13 * 2.0;
    const lagc_real t15 = t8 * t9;
    const lagc_real t16 = t10 * t12;
    const lagc_real t17 = t15 + 2.0 * t16;
    const lagc_real t18 = t8 * t14 + t10 * t17;
    const lagc_real t19 = t1 * t8;
    const lagc_real t20 = t0 * t2;
    const lagc_real t21 = t10 * t20;
    const lagc_real t22 = t19 + t21;
    const lagc_real t23 = t10 * t22;
    const lagc_real t24 = t1 * t10;
    const lagc_real t25 = t8 * t20;
    const lagc_real t26 = t24 + t25;
    const lagc_real t27 = t8 * t26;
    const lagc_real t28 = t23 + t27;
    const lagc_real t29 = fabs(x[11]);
    const lagc_real t30 = t2 * t7;
    const lagc_real t31 = t29 + t30;
    const lagc_real t32 = t9 * t31;
    const lagc_real t33 = t8 * t22 + t10 * t26;
    const lagc_real t34 = t7 * (t1 * t18 + t9 * t28) + t0 * (t32 + t29 * (t10 * t14 + t8 * t17)) + t3 * t33;
    const lagc_real t35 = prepared9 * t9;
    const lagc_real t36 = t6 + t30 * t35;
    const lagc_real t37 = t0 * t8;
    const lagc_real t38 = t1 * t14;
    const lagc_real t39 = t0 * t10;
    const lagc_real t40 = t3 * t29;
    const lagc_real t41 = t2 + t7 * t29;
    const lagc_real t42 = t10 * t41 + t1 * t37;
    const lagc_real t43 = t3 * t42 + t8 * t32;
    const lagc_real t44 = t36 * t37 + prepared9 * (t7 * (t38 + t39 * t40) + t0 * t43);
    const lagc_real t45 = t1 * t17;
    const lagc_real t46 = t8 * t41 + t1 * t39;
    const lagc_real t47 = t3 * t46 + t10 * t32;
    const lagc_real t48 = t36 * t39 + prepared9 * (t7 * (t45 + t37 * t40) + t0 * t47);
    const lagc_real t49 = t7 * t36 + t5 * (t9 * t20 + t1 * t12);
    const lagc_real t50 = t7 * t31;
    const lagc_real t51 = t50 + t0 * t28;
    const lagc_real t52 = t3 * t31;
    const lagc_real t53 = t5 * t7;
    const lagc_real t54 = t51 + t0 * (t27 + (t20 + t23)) + t7 * t30;
    const lagc_real t55 = t15 + t16;
    const lagc_real t56 = t11 + t13;
    const lagc_real t57 = t22 * t55 + t0 * t52 + t26 * t56;
    const lagc_real t58 = prepared9 * (t0 * (t3 * t54 + t18 * t30 + t18 * t29) + t7 * (t57 + t12 * t28));
    const lagc_real t59 = t49 + t5 * (t8 * (t38 + t9 * t26 + t17 * t20) + t10 * (t45 + (t9 * t22 + t14 * t20)));
    const lagc_real t60 = t2 * t51;
    const lagc_real t61 = t25 * t29 + t24 * t31;
    const lagc_real t62 = t21 * t29 + t19 * t31;
    const lagc_real t63 = t0 * (t1 * (t29 + 2.0 * t30) + t29 * t33 + t10 * t61 + t8 * t62) + t28 * (t1 * t7);
    const lagc_real t64 = t50 + t0 * t20;
    const lagc_real t65 = t26 * t43 + (t56 * t62 + (t20 * t32 + (t22 * t47 + (t55 * t61 + t4 * t64)))) + t4 * t51;
    const lagc_real t66 = t29 * t59 + prepared9 * (t7 * (t1 * t57 + t9 * t60 + t3 * t63) + t0 * t65);
    const lagc_real t67 = t2 * (t6 + (t0 * (prepared9 * t34 + t8 * t44 + t10 * t48) + t7 * (t49 + t35 * t51)));
    s[1] = t67 + (t1 * (2.0 * (t52 * t53) + (t8 * t48 + (t10 * t44 + t58))) + t66);
    const lagc_real t68 = t1 * t9;
    const lagc_real t69 = t5 * t68;
    const lagc_real t70 = t3 * t10;
    const lagc_real t71 = t7 * t9;
    const lagc_real t72 = t8 * t71;
    const lagc_real t73 = t70 + 2.0 * t72;
    const lagc_real t74 = t3 * t8;
    const lagc_real t75 = t10 * t71;
    const lagc_real t76 = t74 + 2.0 * t75;
    const lagc_real t77 = t8 * t73 + t10 * t76;
    const lagc_real t78 = t7 * (t1 * t77 + t3 * t28) + t0 * (t52 + t29 * (t10 * t73 + t8 * t76)) + t9 * t33;
    const lagc_real t79 = t3 * prepared9;
    const lagc_real t80 = t69 + t30 * t79;
    const lagc_real t81 = t1 * t73;
    const lagc_real t82 = t9 * t29;
    const lagc_real t83 = t9 * t42 + t8 * t52;
    const lagc_real t84 = t37 * t80 + prepared9 * (t7 * (t81 + t39 * t82) + t0 * t83);
    const lagc_real t85 = t1 * t76;
    const lagc_real t86 = t9 * t46 + t10 * t52;
    const lagc_real t87 = t39 * t80 + prepared9 * (t7 * (t85 + t37 * t82) + t0 * t86);
    const lagc_real t88 = t7 * t80 + t5 * (t3 * t20 + t1 * t71);
    const lagc_real t89 = t74 + t75;
    const lagc_real t90 = t70 + t72;
    const lagc_real t91 = t22 * t89 + t0 * t32 + t26 * t90;
    const lagc_real t92 = prepared9 * (t0 * (t9 * t54 + t30 * t77 + t29 * t77) + t7 * (t91 + t28 * t71));
    const lagc_real t93 = t88 + t5 * (t8 * (t81 + t3 * t26 + t20 * t76) + t10 * (t85 + (t3 * t22 + t20 * t73)));
    const lagc_real t94 = t26 * t83 + (t62 * t90 + (t20 * t52 + (t22 * t86 + (t61 * t89 + t64 * t68))));
    const lagc_real t95 = t29 * t93 + prepared9 * (t7 * (t3 * t60 + t9 * t63 + t1 * t91) + t0 * (t94 + t51 * t68));
    const lagc_real t96 = t2 * (t69 + (t0 * (prepared9 * t78 + t8 * t84 + t10 * t87) + t7 * (t88 + t51 * t79)));
    s[2] = t96 + (t1 * (2.0 * (t32 * t53) + (t8 * t87 + (t10 * t84 + t92))) + t95);
    (void)(t);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = fabs(sc0[0]);
    const lagc_real prepared9 = p->prepared[9];
    s[0] = 1.0 + t0 * prepared9;
    const lagc_real yaw = x[3];
    lagc_real sc1[2]; lagc_sine_cosine(yaw, sc1);
    const lagc_real t1 = fabs(sc1[1]);
    const lagc_real t2 = t0 * t1;
    const lagc_real t3 = fabs(sc0[1]);
    const lagc_real spin = x[5];
    lagc_real sc2[2]; lagc_sine_cosine(spin, sc2);
    const lagc_real t4 = fabs(sc2[1]);
    const lagc_real t5 = fabs(sc1[0]);
    const lagc_real t6 = fabs(sc2[0]);
    const lagc_real t7 = t4 * t5 + t2 * t6 * 2.0;
    const lagc_real t8 = t5 * t6 + 2.0 * (t2 * t4);
    s[1] = 1.0 + prepared9 * (t2 + (t1 + t3 * (t4 * t7 + (t6 * t8 + t3 * (t4 * t8 + t6 * t7)))));
    const lagc_real t9 = t0 * t5;
    const lagc_real t10 = t1 * t4 + 2.0 * (t6 * t9);
    const lagc_real t11 = t1 * t6 + 2.0 * (t4 * t9);
    const lagc_real t12 = prepared9 * (t9 + (t5 + t3 * (t4 * t10 + (t6 * t11 + t3 * (t4 * t11 + t6 * t10)))));
    s[2] = 1.0 + t12;
    (void)(t);
}

/* reach of each constraint row */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real t0 = c[1] + 1e-300;
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t1 = sc0[0];
    const lagc_real r_ = p->r;
    const lagc_real t2 = t1 * r_;
    const lagc_real t3 = fabs(t2);
    s[0] = t0 + c[0] * t3;
    const lagc_real size3 = c[3];
    const lagc_real spin = x[5];
    lagc_real sc1[2]; lagc_sine_cosine(spin, sc1);
    const lagc_real t4 = sc1[1];
    const lagc_real yaw = x[3];
    lagc_real sc2[2]; lagc_sine_cosine(yaw, sc2);
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = t1 * t5;
    const lagc_real t7 = sc1[0];
    const lagc_real t8 = t6 * t7;
    const lagc_real t9 = sc2[0];
    const lagc_real t10 = t8 - (t8 + t4 * t9);
    const lagc_real t11 = t4 * t6;
    const lagc_real t12 = t11 + (t7 * t9 - t11);
    const lagc_real t13 = sc0[1];
    const lagc_real t14 = r_ * t13;
    const lagc_real t15 = fabs(r_ * t5) + fabs(r_ * (t6 + (t4 * t12 + t7 * t10) * (t13 * t13)));
    const lagc_real size2 = c[2];
    const lagc_real t16 = 1e-300 + size2;
    const lagc_real t17 = size3 * (fabs((t4 * t10 - t7 * t12) * t14) + t15) + t16;
    const lagc_real t18 = t16 + size3 * (fabs(t5 * t14) + (fabs(r_ * t9) + fabs(t2 * t9)));
    const lagc_real t19 = lagc_max(t17, t18) * 1e-06;
    s[1] = lagc_max(t17, t19);
    s[2] = lagc_max(t18, t19);
    const lagc_real t20 = lagc_max(lagc_max(0.0, size2 / t0), size3);
    s[3] = t3 * size3 + (size2 + (fabs(x[2] * t20) + (1e-300 + fabs(t14 * t20))));
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
    const lagc_real t8 = x[2] * p->prepared[5];
    /* potential energy */
    e[1] = t8;
    /* energy of the balance */
    e[2] = t0 + (t8 + (t1 + (t2 + (t4 + (t6 + t7)))));
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real der_yaw = x[9];
    const lagc_real lean = x[4];
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
    const lagc_real t0 = x[11] + der_yaw * sc0[0];
    const lagc_real der_x = x[6];
    const lagc_real der_y = x[7];
    const lagc_real der_z = x[8];
    const lagc_real der_lean = x[10];
    const lagc_real t1 = der_yaw * sc0[1];
    const lagc_real t2 = (der_x * der_x + (der_y * der_y + der_z * der_z)) * p->prepared[10];
    const lagc_real t3 = t0 * t0 * p->prepared[1] + (t2 + (der_lean * der_lean + t1 * t1) * p->prepared[11]);
    /* E */
    y[0] = x[2] * p->prepared[5] + t3;
    (void)(t);
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
    lagc_real sc0[2]; lagc_sine_cosine(lean, sc0);
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
    const lagc_real spin = x[5];
    lagc_real sc1[2]; lagc_sine_cosine(spin, sc1);
    const lagc_real t5 = sc1[1];
    const lagc_real t6 = sc1[0];
    const lagc_real der_yaw = x[9];
    const lagc_real t7 = t0 * der_yaw;
    const lagc_real t8 = der_lean * t5 - t6 * t7;
    const lagc_real yaw = x[3];
    lagc_real sc2[2]; lagc_sine_cosine(yaw, sc2);
    const lagc_real t9 = sc2[0];
    const lagc_real t10 = sc2[1];
    const lagc_real t11 = t2 * t10;
    const lagc_real t12 = t6 * t11;
    const lagc_real t13 = t5 * t9 + t12;
    const lagc_real t14 = x[11] + t2 * der_yaw;
    const lagc_real t15 = t0 * t14;
    const lagc_real t16 = der_lean * t6 + t5 * t7;
    const lagc_real t17 = t5 * t11;
    const lagc_real t18 = t6 * t9 - t17;
    const lagc_real t19 = t8 * t13 + t10 * t15 + t16 * t18;
    const lagc_real t20 = t1 * t19;
    const lagc_real t21 = t2 * t14;
    const lagc_real t22 = t5 * t16 - t6 * t8;
    const lagc_real t23 = t0 * t22;
    const lagc_real t24 = t21 + t23;
    const lagc_real t25 = t3 * (t10 * t24);
    c[2] = der_x - t20 - t25;
    const lagc_real t26 = t2 * t9;
    const lagc_real t27 = t8 * (t5 * t10 - t6 * t26) - t9 * t15 + t16 * (t6 * t10 + t5 * t26);
    const lagc_real t28 = t1 * t27;
    const lagc_real der_y = x[7];
    const lagc_real t29 = t3 * t9;
    const lagc_real t30 = t24 * t29;
    c[3] = t28 + (der_y - t30);
    J[0] = 1.0;
    J[3] = 1.0;
    J[8] = 1.0;
    J[15] = 1.0;
    J[2] = t1 * der_lean;
    const lagc_real t31 = t1 * (t6 * t16) + t1 * (t5 * t8);
    const lagc_real t32 = r_ * t9;
    const lagc_real t33 = t2 * t22;
    const lagc_real t34 = t0 * (t33 - t15) - t2 * t24;
    J[5] = -(t10 * t31 + t32 * t34);
    const lagc_real t35 = t0 * (t23 - t24 - t21 - der_yaw);
    const lagc_real t36 = t15 + t33;
    const lagc_real t37 = t17 + t18;
    const lagc_real t38 = t12 - t13;
    const lagc_real t39 = t5 * t37 + t6 * t38;
    J[6] = r_ * (t10 * t35 + t2 * (t19 + (t10 * t36 + t7 * t39)));
    const lagc_real t40 = t6 * (der_lean * t38 - (t8 * t9 + t7 * t37));
    J[7] = -(t1 * (t5 * (t9 * t16 + der_lean * t37 + t7 * t38) + t40));
    J[9] = -(r_ * (t11 + t39 * (t0 * t0)));
    J[10] = t1 * (t5 * t38 - t6 * t37);
    const lagc_real t41 = r_ * t10;
    J[11] = -t41;
    J[12] = t34 * t41 - t9 * t31;
    J[13] = r_ * (t9 * t35 - t2 * (t27 - t9 * t36));
    J[14] = 0.0;
    J[16] = -t29;
    J[17] = t1 * t10;
    J[18] = -t32;
    sizes[0] = fabs(z) + fabs(t1);
    sizes[1] = fabs(der_z) + fabs(t4);
    sizes[2] = fabs(der_x) + fabs(t20) + fabs(t25);
    sizes[3] = fabs(t28) + (fabs(der_y) + fabs(t30));
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
