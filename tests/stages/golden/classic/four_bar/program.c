/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real l3 = p->l3;
    prepared[37] = l3;
    const lagc_real rho = p->rho;
    prepared[39] = rho;
    const lagc_real t0 = l3 * rho;
    prepared[15] = t0;
    const lagc_real l4 = p->l4;
    prepared[38] = l4;
    const lagc_real t1 = l4 * l4;
    const lagc_real t2 = t0 * t1;
    prepared[3] = t2;
    prepared[0] = 0.5 * t2;
    const lagc_real t3 = rho * l4;
    prepared[13] = t3;
    const lagc_real t4 = t1 * t3;
    const lagc_real t5 = t4 * 0.3333333333333333;
    prepared[1] = t5;
    prepared[2] = 1.0 / t5;
    const lagc_real l2 = p->l2;
    prepared[36] = l2;
    const lagc_real t6 = rho * l2;
    const lagc_real t7 = t1 * t6;
    prepared[9] = t7;
    prepared[4] = 0.5 * t7;
    const lagc_real t8 = l3 * l3;
    const lagc_real t9 = t0 * t8;
    const lagc_real t10 = 0.3333333333333333 * t9;
    const lagc_real t11 = t8 * t3;
    prepared[5] = t5 + (t10 + t11);
    const lagc_real t12 = t6 * t8;
    const lagc_real t13 = l3 * l4;
    const lagc_real t14 = t6 * t13;
    prepared[6] = 0.5 * t12 + t14;
    const lagc_real t15 = l2 * t6;
    const lagc_real t16 = l2 * t15;
    prepared[7] = 0.3333333333333333 * t16 + (t11 + (t5 + t10));
    const lagc_real t17 = l4 * t15;
    prepared[8] = t17;
    const lagc_real t18 = l3 * t15;
    prepared[10] = t18;
    prepared[11] = t12 + t14 * 2.0;
    prepared[12] = 0.5 * t0;
    const lagc_real t19 = rho * (l2 * l2);
    prepared[14] = t19 * 0.25;
    const lagc_real t20 = l4 * t3;
    prepared[16] = 0.5 * t20;
    const lagc_real t21 = l3 * t0;
    const lagc_real t22 = 0.08333333333333333 * (l3 * t21);
    const lagc_real t23 = l4 * t20;
    const lagc_real t24 = 0.08333333333333333 * t23;
    prepared[22] = t24;
    prepared[17] = t22 + (0.08333333333333333 * (l2 * t19) + t24);
    prepared[18] = 0.5 * t21;
    prepared[19] = t21 * 0.25;
    prepared[20] = t22 + t24;
    prepared[21] = t23 * 0.25;
    prepared[23] = 0.5 * (l3 * t20);
    prepared[24] = 0.5 * (l2 * t20);
    const lagc_real l1 = p->l1;
    prepared[35] = l1;
    prepared[25] = fabs(l1);
    const lagc_real t25 = fabs(l2);
    prepared[30] = t25;
    prepared[26] = t25 + 2.0 * t25;
    const lagc_real t26 = fabs(l3);
    const lagc_real t27 = 2.0 * t26;
    prepared[29] = t27;
    prepared[27] = t26 + t27;
    const lagc_real t28 = fabs(l4);
    prepared[28] = t28 + 2.0 * t28;
    prepared[31] = t28 * 3.0;
    prepared[32] = t4 * 0.16666666666666666;
    prepared[33] = 0.5 * t18 + (t16 * 0.16666666666666666 + 0.5 * t17);
    prepared[34] = t9 * 0.16666666666666666 + 0.5 * (t0 * t13);
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real q3 = x[2];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q3, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[3];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[2];
    const lagc_real q1 = x[0];
    lagc_real sc1[2]; lagc_sine_cosine(q1, sc1);
    const lagc_real t4 = sc1[1];
    const lagc_real t5 = sc1[0];
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t6 = prepared0 * t0 + p->prepared[1];
    health[10] = t6;
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t7 = t6 * prepared2;
    const lagc_real t8 = t0 * p->prepared[3];
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t9 = prepared4 * t1;
    const lagc_real t10 = t8 + p->prepared[5];
    health[9] = t10;
    const lagc_real t11 = t0 * t9;
    const lagc_real t12 = t2 * t3;
    const lagc_real t13 = t10 - t6 * t7;
    const lagc_real t14 = prepared4 * t12;
    const lagc_real prepared6 = p->prepared[6];
    const lagc_real t15 = 1.0 / t13;
    health[18] = t15;
    const lagc_real t16 = t1 * t4 - t3 * t5;
    const lagc_real t17 = t3 * t4 + t1 * t5;
    const lagc_real t18 = t6 + t11 - t14;
    health[15] = t18;
    const lagc_real prepared9 = p->prepared[9];
    const lagc_real t19 = t11 + prepared6 * t1 + (t10 - t14);
    health[14] = t19;
    const lagc_real t20 = t18 * prepared2;
    const lagc_real t21 = t19 - t18 * t7;
    const lagc_real l4 = p->l4;
    const lagc_real t22 = l4 * (t0 * t16 - t2 * t17);
    health[2] = t22;
    const lagc_real t23 = t21 * t15;
    const lagc_real t24 = t8 + (p->prepared[10] + (p->prepared[7] + p->prepared[8])) - t12 * prepared9;
    const lagc_real t25 = t1 * (t0 * prepared9 + p->prepared[11]) + t24;
    health[13] = t25;
    const lagc_real l3 = p->l3;
    const lagc_real t26 = t16 * l3;
    const lagc_real t27 = prepared2 * t22;
    const lagc_real t28 = t26 + t22;
    health[6] = t28;
    const lagc_real t29 = t25 - t18 * t20 - t21 * t23;
    const lagc_real l2 = p->l2;
    const lagc_real t30 = t4 * l2;
    const lagc_real t31 = t28 - t6 * t27;
    const lagc_real t32 = 1.0 / t29;
    health[19] = t32;
    const lagc_real t33 = t15 * t31;
    const lagc_real t34 = t30 + t28;
    health[7] = t34;
    const lagc_real t35 = (t2 * t16 + t0 * t17) * l4;
    health[3] = t35;
    const lagc_real t36 = prepared2 * t35;
    const lagc_real t37 = t17 * l3;
    const lagc_real der_q1 = x[3];
    /* der(q1) */
    xdot[0] = der_q1;
    const lagc_real der_q2 = x[4];
    /* der(q2) */
    xdot[1] = der_q2;
    const lagc_real t38 = der_q1 + der_q2;
    const lagc_real t39 = t34 - t18 * t27 - t21 * t33;
    const lagc_real t40 = t35 + t37;
    health[4] = t40;
    const lagc_real der_q3 = x[5];
    /* der(q3) */
    xdot[2] = der_q3;
    const lagc_real t41 = der_q3 + t38;
    const lagc_real t42 = der_q1 * der_q1;
    const lagc_real t43 = t32 * t39;
    const lagc_real t44 = t5 * l2;
    const lagc_real t45 = t6 * t36 - t40;
    const lagc_real t46 = t41 * t41;
    const lagc_real t47 = t2 * prepared0;
    const lagc_real t48 = t3 * t42;
    const lagc_real t49 = t0 * prepared4;
    const lagc_real t50 = t38 * t38;
    const lagc_real t51 = t44 + t40;
    health[5] = t51;
    const lagc_real t52 = t15 * t45;
    const lagc_real t53 = t2 * t9;
    const lagc_real t54 = t42 * t53;
    const lagc_real t55 = t48 * t49 + t47 * t50;
    const lagc_real t56 = 1.0 / (t39 * t43 + (t22 * t27 + t31 * t33));
    health[20] = t56;
    const lagc_real t57 = t18 * t36 - t51 - t21 * t52;
    const lagc_real t58 = t54 + t55;
    health[8] = t58;
    const lagc_real t59 = t46 * t47 - t48 * prepared6 - t54 - t55;
    health[16] = t59;
    const lagc_real t60 = t32 * t57;
    const lagc_real t61 = t35 * t27 - t45 * t33 - t57 * t43;
    const lagc_real t62 = t59 + (t46 * t53 + t3 * (prepared6 * t50 + t46 * t49));
    health[17] = t62;
    const lagc_real t63 = t59 + t58 * t7;
    const lagc_real t64 = t61 * t56;
    const lagc_real t65 = t46 * t35 + (t42 * t44 + t50 * t37);
    health[12] = t65;
    const lagc_real t66 = t57 * t60 + (t35 * t36 + t45 * t52);
    const lagc_real t67 = t62 + t58 * t20 - t63 * t23;
    const lagc_real t68 = t46 * t22 + (t42 * t30 + t50 * t26);
    health[11] = t68;
    const lagc_real t69 = t61 * t64 - t66;
    const lagc_real t70 = 1.0 / t69;
    health[21] = t70;
    const lagc_real t71 = t65 + t58 * t27 - t63 * t33 - t67 * t43;
    const lagc_real t72 = (t71 * t64 + (t68 - t58 * t36 - t63 * t52 - t67 * t60)) * t70;
    health[22] = t72;
    const lagc_real t73 = t64 * t72 - t71 * t56;
    health[23] = t73;
    const lagc_real t74 = t67 * t32 - t60 * t72 - t43 * t73;
    /* der(der(q1)) */
    xdot[3] = t74;
    health[24] = t74;
    const lagc_real t75 = t63 * t15 - t52 * t72 - t33 * t73 - t23 * t74;
    /* der(der(q2)) */
    xdot[4] = t75;
    health[25] = t75;
    const lagc_real t76 = t36 * t72 - t58 * prepared2 - t27 * t73 - t20 * t74 - t7 * t75;
    /* der(der(q3)) */
    xdot[5] = t76;
    health[26] = t76;
    health[0] = lagc_min(lagc_min(t13 / t10, t29 / t25), -(t69 / t66));
    /* ring[1], four_bar.lag:32 */
    lam[0] = -t72;
    /* ring[2], four_bar.lag:32 */
    lam[1] = -t73;
    health[1] = 0.0;
    (void)(t);
}

/* what a solution leaves of its right-hand side */
static void lagc_fn_watch(const lagc_params *p, lagc_real *health)
{
    const lagc_real health3 = health[3];
    const lagc_real health22 = health[22];
    const lagc_real health26 = health[26];
    const lagc_real t0 = health26 * p->prepared[1];
    const lagc_real health10 = health[10];
    const lagc_real health25 = health[25];
    const lagc_real health4 = health[4];
    const lagc_real health24 = health[24];
    const lagc_real health14 = health[14];
    const lagc_real t1 = health25 * health[9];
    const lagc_real health5 = health[5];
    const lagc_real t2 = health24 * health[13];
    const lagc_real health7 = health[7];
    const lagc_real health6 = health[6];
    const lagc_real health2 = health[2];
    const lagc_real health15 = health[15];
    const lagc_real health23 = health[23];
    const lagc_real health8 = health[8];
    const lagc_real health16 = health[16];
    const lagc_real health17 = health[17];
    const lagc_real health12 = health[12];
    const lagc_real health11 = health[11];
    const lagc_real t3 = health12 - health24 * health7 - (health25 * health6 + health26 * health2);
    const lagc_real t4 = health3 * health26 + health11 + (health25 * health4 + health24 * health5);
    const lagc_real health20 = health[20];
    const lagc_real t5 = health3 * health22 - health8 - (t0 + health10 * health25);
    const lagc_real t6 = t5 - (health15 * health24 + health2 * health23);
    const lagc_real t7 = health22 * health4 + health16 - (health24 * health14 + t1);
    const lagc_real t8 = t7 - (health26 * health10 + health23 * health6);
    const lagc_real t9 = health22 * health5 + health17 - (t2 + health25 * health14);
    const lagc_real t10 = t9 - (health26 * health15 + health23 * health7);
    const lagc_real health21 = health[21];
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real health18 = health[18];
    const lagc_real health19 = health[19];
    const lagc_real t11 = health12 * (health20 * health12) + 1e-300 - health11 * (health21 * health11);
    const lagc_real t12 = t10 * (health19 * t10) + (t3 * (health20 * t3) - t4 * (health21 * t4));
    const lagc_real t13 = prepared2 * (health8 * health8 + t0 * t0) + health18 * (health16 * health16 + t1 * t1);
    const lagc_real t14 = t13 + (health19 * (health17 * health17 + t2 * t2) + t11);
    health[1] = (t6 * (t6 * prepared2) + t8 * (health18 * t8) + t12) / t14;
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_q1 = x[3];
    qdot[0] = der_q1;
    const lagc_real der_q2 = x[4];
    qdot[1] = der_q2;
    const lagc_real der_q3 = x[5];
    qdot[2] = der_q3;
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[3];
    const lagc_real t4 = t0 * t1 + t2 * t3;
    const lagc_real l3 = p->l3;
    const lagc_real t5 = t4 * l3;
    const lagc_real l2 = p->l2;
    const lagc_real t6 = t2 * l2;
    const lagc_real t7 = t6 + t5 * 0.5;
    const lagc_real prepared12 = p->prepared[12];
    const lagc_real t8 = t0 * t3 - t1 * t2;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t9 = sc1[0];
    const lagc_real t10 = sc1[1];
    const lagc_real t11 = t8 * t9 + t4 * t10;
    const lagc_real l4 = p->l4;
    const lagc_real t12 = t11 * l4;
    const lagc_real t13 = t5 + 0.5 * t12;
    const lagc_real t14 = t6 + t13;
    const lagc_real prepared13 = p->prepared[13];
    const lagc_real t15 = t14 * prepared13;
    const lagc_real t16 = l3 * t8;
    const lagc_real t17 = t0 * l2;
    const lagc_real t18 = t17 + 0.5 * t16;
    const lagc_real t19 = t8 * t10 - t4 * t9;
    const lagc_real t20 = l4 * t19;
    G[5] = t20;
    const lagc_real t21 = 0.5 * t20;
    const lagc_real t22 = t16 + (t17 + t21);
    const lagc_real t23 = prepared13 * t22;
    const lagc_real prepared14 = p->prepared[14];
    const lagc_real t24 = t2 * prepared14;
    const lagc_real prepared15 = p->prepared[15];
    const lagc_real t25 = t0 * prepared14;
    const lagc_real prepared16 = p->prepared[16];
    const lagc_real t26 = t17 * (t23 + (t25 + t18 * prepared15)) + (t19 * t22 + t11 * t14) * prepared16;
    const lagc_real t27 = t16 * (prepared12 * t18 + t23) + (t6 * (t24 + (t15 + t7 * prepared15)) + t26);
    M[0] = t5 * (t7 * prepared12 + t15) + t27 + p->prepared[17];
    const lagc_real prepared18 = p->prepared[18];
    const lagc_real t28 = t16 + t21;
    const lagc_real t29 = prepared13 * t28;
    const lagc_real t30 = t13 * prepared13;
    const lagc_real prepared19 = p->prepared[19];
    const lagc_real t31 = t16 * (t29 + t8 * prepared19) + prepared16 * (t19 * t28 + t11 * t13);
    const lagc_real t32 = t5 * (t30 + t4 * prepared19) + t31 + p->prepared[20];
    M[2] = t32;
    M[1] = t17 * (t8 * prepared18 + t29) + t6 * (t4 * prepared18 + t30) + t32;
    const lagc_real t33 = (t11 * t11 + t19 * t19) * p->prepared[21] + p->prepared[22];
    M[5] = t33;
    const lagc_real t34 = t33 + (t8 * t19 + t4 * t11) * p->prepared[23];
    M[4] = t34;
    M[3] = t34 + (t0 * t19 + t2 * t11) * p->prepared[24];
    const lagc_real t35 = der_q1 * der_q1;
    const lagc_real t36 = t17 * t35;
    const lagc_real t37 = der_q1 + der_q2;
    const lagc_real t38 = t37 * t37;
    const lagc_real t39 = t16 * t38;
    const lagc_real t40 = t36 + t39;
    const lagc_real t41 = der_q3 + t37;
    const lagc_real t42 = l4 * (t41 * t41);
    const lagc_real t43 = t19 * t42;
    const lagc_real t44 = t40 + 0.5 * t43;
    const lagc_real t45 = prepared13 * t44;
    const lagc_real t46 = t36 + 0.5 * t39;
    const lagc_real t47 = t6 * t35;
    const lagc_real t48 = t5 * t38;
    const lagc_real t49 = t47 + t48;
    const lagc_real t50 = t11 * t42;
    const lagc_real t51 = t49 + 0.5 * t50;
    const lagc_real t52 = prepared13 * t51;
    const lagc_real t53 = t47 + 0.5 * t48;
    const lagc_real t54 = prepared16 * (t11 * t44 - t19 * t51);
    const lagc_real t55 = t5 * (t45 + prepared12 * t46) - t16 * (t52 + prepared12 * t53) + t54;
    const lagc_real t56 = t17 * (t52 + (prepared15 * t53 + t24 * t35));
    r[0] = -(t55 + (t6 * (t25 * t35 + (t45 + prepared15 * t46)) - t56));
    r[1] = -t55;
    r[2] = -t54;
    const lagc_real t57 = t5 + t12;
    G[0] = -(t6 + t57);
    G[1] = -t57;
    G[2] = -t12;
    const lagc_real t58 = t16 + t20;
    G[4] = t58;
    G[3] = t17 + t58;
    gamma[0] = t40 + t43;
    gamma[1] = t49 + t50;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real q3 = x[2];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q3, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = t0 * p->prepared[3];
    const lagc_real t2 = sc0[3];
    const lagc_real prepared9 = p->prepared[9];
    const lagc_real t3 = sc0[2];
    const lagc_real t4 = sc0[0];
    const lagc_real t5 = t3 * t4;
    const lagc_real t6 = t2 * (t0 * prepared9 + p->prepared[11]) - prepared9 * t5;
    w[0] = t1 + p->prepared[7] + p->prepared[8] + p->prepared[10] + t6;
    const lagc_real t7 = t1 + p->prepared[5];
    w[2] = t7;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t8 = t0 * t2 * prepared4;
    const lagc_real t9 = t5 * prepared4;
    w[1] = t7 + t8 - t9 + t2 * p->prepared[6];
    const lagc_real prepared1 = p->prepared[1];
    w[5] = prepared1;
    const lagc_real t10 = t0 * p->prepared[0] + prepared1;
    w[4] = t10;
    w[3] = t10 + (t8 - t9);
    const lagc_real q1 = x[0];
    lagc_real sc1[2]; lagc_sine_cosine(q1, sc1);
    const lagc_real t11 = sc1[0];
    const lagc_real l2 = p->l2;
    const lagc_real t12 = sc1[1];
    const lagc_real t13 = t3 * t12 + t2 * t11;
    const lagc_real l3 = p->l3;
    const lagc_real t14 = t2 * t12 - t3 * t11;
    const lagc_real l4 = p->l4;
    const lagc_real t15 = (t4 * t14 + t0 * t13) * l4;
    const lagc_real t16 = t13 * l3 + t15;
    w[6] = -(t11 * l2 + t16);
    w[7] = -t16;
    w[8] = -t15;
    const lagc_real t17 = l4 * (t0 * t14 - t4 * t13);
    w[11] = t17;
    const lagc_real t18 = l3 * t14 + t17;
    w[10] = t18;
    w[9] = l2 * t12 + t18;
    (void)(t);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real w3 = w[3];
    const lagc_real t0 = 1.0 / w[5];
    w[22] = t0;
    const lagc_real t1 = w3 * t0;
    w[12] = t1;
    const lagc_real w4 = w[4];
    const lagc_real t2 = w4 * t0;
    w[13] = t2;
    const lagc_real w8 = w[8];
    const lagc_real t3 = w8 * t0;
    w[14] = t3;
    const lagc_real w11 = w[11];
    const lagc_real t4 = w11 * t0;
    w[15] = t4;
    const lagc_real t5 = w[1] - w3 * t2;
    const lagc_real w2 = w[2];
    const lagc_real t6 = w2 - w4 * t2;
    const lagc_real t7 = 1.0 / t6;
    w[23] = t7;
    const lagc_real t8 = t5 * t7;
    w[16] = t8;
    const lagc_real t9 = w[7] - w4 * t3;
    const lagc_real t10 = t9 * t7;
    w[17] = t10;
    const lagc_real t11 = w[10] - w4 * t4;
    const lagc_real t12 = t11 * t7;
    w[18] = t12;
    const lagc_real t13 = w[6] - w3 * t3 - t5 * t10;
    const lagc_real w0 = w[0];
    const lagc_real t14 = w0 - w3 * t1 - t5 * t8;
    const lagc_real t15 = 1.0 / t14;
    w[24] = t15;
    const lagc_real t16 = t13 * t15;
    w[19] = t16;
    const lagc_real t17 = w[9] - w3 * t4 - t5 * t12;
    const lagc_real t18 = t17 * t15;
    w[20] = t18;
    const lagc_real t19 = w8 * t4 + t9 * t12 + t13 * t18;
    const lagc_real t20 = 1.0 / (w11 * t4 + t11 * t12 + t17 * t18);
    const lagc_real t21 = t19 * t20;
    w[21] = t21;
    w[25] = -t20;
    const lagc_real t22 = w8 * t3 + t9 * t10 + t13 * t16;
    const lagc_real t23 = t19 * t21 - t22;
    w[26] = 1.0 / t23;
    health[0] = lagc_min(lagc_min(t6 / w2, t14 / w0), -(t23 / t22));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r2 = r[2];
    const lagc_real w12 = w[12];
    const lagc_real w16 = w[16];
    const lagc_real w13 = w[13];
    const lagc_real t0 = r[1] - r2 * w13;
    const lagc_real t1 = r[0] - r2 * w12 - w16 * t0;
    const lagc_real w19 = w[19];
    const lagc_real w14 = w[14];
    const lagc_real w17 = w[17];
    const lagc_real w21 = w[21];
    const lagc_real w15 = w[15];
    const lagc_real w18 = w[18];
    const lagc_real w20 = w[20];
    const lagc_real t2 = r[4] - r2 * w15 - w18 * t0 - w20 * t1;
    const lagc_real t3 = w[26] * (r[3] - r2 * w14 - w17 * t0 - w19 * t1 - w21 * t2);
    const lagc_real t4 = w[25] * t2 - w21 * t3;
    const lagc_real t5 = w[24] * t1 - w19 * t3 - w20 * t4;
    s[0] = t5;
    const lagc_real t6 = w[23] * t0 - w17 * t3 - w18 * t4 - w16 * t5;
    s[1] = t6;
    s[2] = r2 * w[22] - w14 * t3 - w15 * t4 - w12 * t5 - w13 * t6;
    s[3] = -t3;
    s[4] = -t4;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real t1 = s[4];
    const lagc_real w9 = w[9];
    const lagc_real t2 = s[3];
    const lagc_real w6 = w[6];
    const lagc_real t3 = s[1];
    const lagc_real w1 = w[1];
    const lagc_real t4 = s[2];
    const lagc_real w3 = w[3];
    const lagc_real w12 = w[12];
    const lagc_real w11 = w[11];
    const lagc_real w8 = w[8];
    const lagc_real w4 = w[4];
    const lagc_real t5 = t1 * w11 + (t2 * w8 + (r[2] - t0 * w3 - t3 * w4 - t4 * w[5]));
    const lagc_real w16 = w[16];
    const lagc_real w10 = w[10];
    const lagc_real w7 = w[7];
    const lagc_real w13 = w[13];
    const lagc_real t6 = t1 * w10 + (t2 * w7 + (r[1] - t0 * w1 - t3 * w[2] - t4 * w4)) - w13 * t5;
    const lagc_real t7 = t1 * w9 + (t2 * w6 + (r[0] - t0 * w[0] - t3 * w1 - t4 * w3)) - w12 * t5 - w16 * t6;
    const lagc_real w19 = w[19];
    const lagc_real w14 = w[14];
    const lagc_real w17 = w[17];
    const lagc_real w21 = w[21];
    const lagc_real w15 = w[15];
    const lagc_real w18 = w[18];
    const lagc_real w20 = w[20];
    const lagc_real t8 = r[4] - t0 * w9 - t3 * w10 - t4 * w11 - w15 * t5 - w18 * t6 - w20 * t7;
    const lagc_real t9 = w[26] * (r[3] - t0 * w6 - t3 * w7 - t4 * w8 - w14 * t5 - w17 * t6 - w19 * t7 - w21 * t8);
    const lagc_real t10 = w[25] * t8 - w21 * t9;
    const lagc_real t11 = w[24] * t7 - w19 * t9 - w20 * t10;
    const lagc_real t12 = w[23] * t6 - w17 * t9 - w18 * t10 - w16 * t11;
    const lagc_real t13 = t0 + t11;
    const lagc_real t14 = t3 + t12;
    const lagc_real t15 = t4 + (w[22] * t5 - w14 * t9 - w15 * t10 - w12 * t11 - w13 * t12);
    const lagc_real t16 = -(t9 - t2);
    const lagc_real t17 = -(t10 - t1);
    s[0] = t13;
    s[1] = t14;
    s[2] = t15;
    s[3] = t16;
    s[4] = t17;
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[3];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[2];
    const lagc_real t4 = t0 * t1 - t2 * t3;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t5 = sc1[1];
    const lagc_real t6 = t0 * t3 + t1 * t2;
    const lagc_real t7 = sc1[0];
    const lagc_real l4 = p->l4;
    const lagc_real l2 = p->l2;
    const lagc_real l3 = p->l3;
    /* ring[1], four_bar.lag:32 */
    phi[0] = (t4 * t5 - t6 * t7) * l4 + (t0 * l2 + t4 * l3) + p->l1;
    /* ring[2], four_bar.lag:32 */
    phi[1] = t2 * l2 + t6 * l3 + l4 * (t4 * t7 + t5 * t6);
    (void)(t);
}

/* rates of the constraint equations */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[2];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[3];
    const lagc_real t4 = t0 * t1 + t2 * t3;
    const lagc_real der_q1 = x[3];
    const lagc_real t5 = der_q1 + x[4];
    const lagc_real t6 = t5 * p->l3;
    const lagc_real t7 = der_q1 * p->l2;
    const lagc_real t8 = t0 * t3 - t1 * t2;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t9 = sc1[0];
    const lagc_real t10 = sc1[1];
    const lagc_real t11 = (t5 + x[5]) * p->l4;
    /* ring[1], four_bar.lag:32 */
    psi[0] = -(t4 * t6 + (t2 * t7 + (t8 * t9 + t4 * t10) * t11));
    /* ring[2], four_bar.lag:32 */
    psi[1] = t6 * t8 + (t0 * t7 + t11 * (t8 * t10 - t4 * t9));
    (void)(t);
}

/* size of the terms of each constraint equation */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l2 = p->l2;
    const lagc_real t1 = sc0[3];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc0[2];
    const lagc_real t4 = t0 * t1 - t2 * t3;
    const lagc_real l3 = p->l3;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t5 = sc1[1];
    const lagc_real t6 = t0 * t3 + t1 * t2;
    const lagc_real t7 = sc1[0];
    const lagc_real l4 = p->l4;
    const lagc_real t8 = fabs(t0 * l2) + (fabs(t4 * l3) + (fabs((t4 * t5 - t6 * t7) * l4) + 1e-300));
    const lagc_real t9 = t8 + p->prepared[25];
    s[0] = t9;
    const lagc_real t10 = fabs(l4 * (t4 * t7 + t5 * t6)) + (fabs(l3 * t6) + (1e-300 + fabs(l2 * t2)));
    s[1] = lagc_max(t10, lagc_max(t9, t10) * 1e-06);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = fabs(sc0[1]);
    const lagc_real t1 = fabs(x[3]);
    const lagc_real t2 = t1 * t1 * p->prepared[26];
    const lagc_real t3 = fabs(sc0[3]);
    const lagc_real t4 = fabs(sc0[0]);
    const lagc_real t5 = fabs(sc0[2]);
    const lagc_real t6 = t0 * t3 + t4 * t5;
    const lagc_real t7 = t1 + fabs(x[4]);
    const lagc_real t8 = t7 * t7 * p->prepared[27];
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t9 = fabs(sc1[1]);
    const lagc_real t10 = t0 * t5 + t3 * t4;
    const lagc_real t11 = fabs(sc1[0]);
    const lagc_real t12 = t7 + fabs(x[5]);
    const lagc_real t13 = t12 * t12 * p->prepared[28];
    s[0] = t0 * t2 + t6 * t8 + (t6 * t9 + t10 * t11) * t13;
    s[1] = t2 * t4 + t8 * t10 + t13 * (t6 * t11 + t9 * t10);
    (void)(t);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = fabs(sc0[1]);
    const lagc_real t1 = fabs(sc0[2]);
    const lagc_real t2 = fabs(sc0[0]);
    const lagc_real t3 = fabs(sc0[3]);
    const lagc_real t4 = t0 * t1 + t2 * t3;
    const lagc_real prepared29 = p->prepared[29];
    const lagc_real prepared30 = p->prepared[30];
    const lagc_real t5 = t0 * t3 + t1 * t2;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t6 = fabs(sc1[0]);
    const lagc_real t7 = fabs(sc1[1]);
    const lagc_real prepared31 = p->prepared[31];
    s[0] = t4 * prepared29 + (t2 * prepared30 + (t5 * t6 + t4 * t7) * prepared31);
    s[1] = prepared29 * t5 + (t0 * prepared30 + prepared31 * (t5 * t7 + t4 * t6));
    (void)(t);
}

/* reach of each constraint equation */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size0 = c[0];
    s[4] = size0;
    const lagc_real q2 = x[1];
    const lagc_real q1 = x[0];
    lagc_real sc0[4]; lagc_sine_cosine_two(q2, q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = sc0[3];
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t2 = sc1[0];
    const lagc_real l4 = p->l4;
    const lagc_real t3 = t2 * l4;
    const lagc_real t4 = sc0[2];
    const lagc_real t5 = sc1[1];
    const lagc_real l3 = p->l3;
    const lagc_real t6 = l4 * t5 + l3;
    const lagc_real t7 = t1 * t3 + t4 * t6;
    const lagc_real t8 = sc0[0];
    const lagc_real t9 = t1 * t6 - t3 * t4;
    const lagc_real t10 = t0 * t3 + t6 * t8;
    const lagc_real l2 = p->l2;
    const lagc_real t11 = l2 - t3 * t8 + t0 * t6;
    const lagc_real t12 = t0 * t1 - t4 * t8;
    const lagc_real t13 = t1 * t8 + t0 * t4;
    const lagc_real t14 = t2 * t12 + t5 * t13;
    const lagc_real t15 = l4 * t14;
    const lagc_real t16 = fabs(t15);
    const lagc_real t17 = size0 * (fabs(t0 * t7 + t8 * t9) + (fabs(t1 * t10 + t4 * t11) + t16)) + 1e-300;
    s[0] = t17;
    const lagc_real t18 = t5 * t12 - t2 * t13;
    const lagc_real t19 = l4 * t18;
    const lagc_real t20 = fabs(t19);
    const lagc_real t21 = 1e-300 + size0 * (fabs(t0 * t9 - t7 * t8) + (t20 + fabs(t1 * t11 - t4 * t10)));
    s[1] = lagc_max(t21, lagc_max(t17, t21) * 1e-06);
    const lagc_real size1 = c[1];
    s[5] = size1;
    const lagc_real t22 = l3 * t13;
    const lagc_real t23 = t15 + t22;
    const lagc_real t24 = t4 * l2;
    const lagc_real t25 = lagc_max(0.0, size1);
    const lagc_real t26 = t1 * l2;
    const lagc_real t27 = l3 * t12;
    const lagc_real t28 = l4 * t25;
    const lagc_real t29 = fabs(t25 * p->l1) + (fabs(t25 * t26) + (fabs(t25 * t27) + (1e-300 + fabs(t18 * t28))));
    const lagc_real t30 = size1 * (fabs(t23) + (t16 + fabs(t23 + t24))) + t29;
    s[2] = t30;
    const lagc_real t31 = t19 + t27;
    const lagc_real t32 = fabs(t24 * t25) + (fabs(t22 * t25) + (1e-300 + fabs(t14 * t28)));
    const lagc_real t33 = size1 * (fabs(t31) + (t20 + fabs(t26 + t31))) + t32;
    s[3] = lagc_max(t33, 1e-06 * lagc_max(t30, t33));
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real der_q1 = x[3];
    const lagc_real t0 = der_q1 + x[4];
    const lagc_real t1 = x[5] + t0;
    const lagc_real q2 = x[1];
    const lagc_real q3 = x[2];
    lagc_real sc0[4]; lagc_sine_cosine_two(q2, q3, sc0);
    const lagc_real t2 = t1 * sc0[3];
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t3 = der_q1 * p->prepared[33] + sc0[1] * (t0 * p->prepared[6] + t2 * prepared4);
    const lagc_real t4 = der_q1 * (t3 - prepared4 * (t1 * (sc0[0] * sc0[2])));
    const lagc_real t5 = t1 * t1 * p->prepared[32] + (t4 + t0 * (t0 * p->prepared[34] + t2 * p->prepared[0]));
    /* kinetic energy */
    e[0] = t5;
    /* energy of the balance */
    e[2] = t5;
    /* potential energy */
    e[1] = 0.0;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    /* Hx */
    y[0] = lam[0];
    /* Hy */
    y[1] = lam[1];
    /* a1 */
    y[2] = a[0];
    /* a2 */
    y[3] = a[1];
    /* a3 */
    y[4] = a[2];
    /* E */
    y[5] = e[0];
    (void)(p);
    (void)(t);
    (void)(x);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* q1 */
    x[0] = 2.1;
    /* q2 */
    x[1] = 0.6655470375077588;
    /* q3 */
    x[2] = 2.527408138024188;
    /* der(q1) */
    x[3] = 0.2;
    /* der(q2) */
    x[4] = -0.17963733938852067;
    /* der(q3) */
    x[5] = 0.1309060540601612;
    (void)(p);
}

/* conditions of a consistent start */
static void lagc_fn_conditions(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *c, lagc_real *J, lagc_real *sizes)
{
    const lagc_real q1 = x[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[4]; lagc_sine_cosine_two(q1, q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l2 = p->l2;
    const lagc_real t1 = t0 * l2;
    const lagc_real t2 = sc0[3];
    const lagc_real t3 = sc0[0];
    const lagc_real t4 = sc0[2];
    const lagc_real t5 = t0 * t2 - t3 * t4;
    const lagc_real l3 = p->l3;
    const lagc_real t6 = t5 * l3;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t7 = sc1[1];
    const lagc_real t8 = t0 * t4 + t2 * t3;
    const lagc_real t9 = sc1[0];
    const lagc_real t10 = t5 * t7 - t8 * t9;
    const lagc_real l4 = p->l4;
    const lagc_real t11 = t10 * l4;
    J[5] = t11;
    J[17] = t11;
    c[0] = t1 + p->l1 + t6 + t11;
    const lagc_real t12 = l2 * t3;
    const lagc_real t13 = l3 * t8;
    const lagc_real t14 = t5 * t9 + t7 * t8;
    const lagc_real t15 = l4 * t14;
    c[1] = t12 + t13 + t15;
    const lagc_real der_q1 = x[3];
    const lagc_real t16 = der_q1 + x[4];
    const lagc_real t17 = l3 * t16;
    const lagc_real t18 = t8 * t17;
    const lagc_real t19 = l2 * der_q1;
    const lagc_real t20 = t3 * t19;
    const lagc_real t21 = l4 * (t16 + x[5]);
    const lagc_real t22 = t14 * t21;
    c[2] = -(t18 + (t20 + t22));
    const lagc_real t23 = t5 * t17;
    const lagc_real t24 = t0 * t19;
    const lagc_real t25 = t10 * t21;
    c[3] = t23 + (t24 + t25);
    const lagc_real t26 = t9 * l4;
    const lagc_real t27 = l3 + t7 * l4;
    const lagc_real t28 = t2 * t26 + t4 * t27;
    const lagc_real t29 = l2 - t4 * t26 + t2 * t27;
    J[0] = -(t0 * t28 + t3 * t29);
    const lagc_real t30 = t0 * t26 + t3 * t27;
    const lagc_real t31 = t0 * t27 - t3 * t26;
    J[1] = -(t2 * t30 + t4 * t31);
    const lagc_real t32 = -t15;
    J[2] = t32;
    J[11] = t32;
    J[3] = t0 * t29 - t3 * t28;
    J[4] = t2 * t31 - t4 * t30;
    const lagc_real t33 = t9 * t21;
    const lagc_real t34 = t17 + t7 * t21;
    const lagc_real t35 = t4 * t33 - (t19 + t2 * t34);
    const lagc_real t36 = t4 * t34 + t2 * t33;
    J[6] = t0 * t35 + t3 * t36;
    const lagc_real t37 = t3 * t33 - t0 * t34;
    const lagc_real t38 = t3 * t34 + t0 * t33;
    J[7] = t2 * t37 + t4 * t38;
    J[8] = -t25;
    const lagc_real t39 = t13 + t15;
    J[9] = -(t12 + t39);
    J[10] = -t39;
    J[12] = t3 * t35 - t0 * t36;
    J[13] = t4 * t37 - t2 * t38;
    J[14] = -t22;
    const lagc_real t40 = t6 + t11;
    J[16] = t40;
    J[15] = t1 + t40;
    sizes[0] = fabs(t1) + (fabs(t6) + fabs(t11)) + p->prepared[25];
    sizes[1] = fabs(t12) + fabs(t13) + fabs(t15);
    sizes[2] = fabs(t20) + (fabs(t22) + fabs(t18));
    sizes[3] = fabs(t24) + (fabs(t25) + fabs(t23));
    (void)(t);
}

/* stated rates, sizes of parameters */
static void lagc_fn_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)
{
    largest[0] = 0.0;
    largest[1] = 0.0;
    (void)(p);
    (void)(s);
}

/* derived values that have bounds */
static void lagc_fn_limits(const lagc_params *p, lagc_real *b)
{
    const lagc_real l2 = p->l2;
    const lagc_real rho = p->rho;
    const lagc_real t0 = l2 * rho;
    b[0] = t0;
    const lagc_real t1 = t0 * (l2 * l2) * 0.08333333333333333;
    b[1] = t1;
    b[2] = t1;
    const lagc_real l3 = p->l3;
    const lagc_real t2 = l3 * rho;
    b[3] = t2;
    const lagc_real t3 = 0.08333333333333333 * (t2 * (l3 * l3));
    b[4] = t3;
    b[5] = t3;
    const lagc_real l4 = p->l4;
    const lagc_real t4 = l4 * rho;
    b[6] = t4;
    const lagc_real t5 = 0.08333333333333333 * (t4 * (l4 * l4));
    b[7] = t5;
    b[8] = t5;
}
