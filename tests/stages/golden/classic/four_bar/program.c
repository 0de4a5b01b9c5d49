/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real l3 = p->l3;
    prepared[48] = l3;
    const lagc_real l4 = p->l4;
    prepared[49] = l4;
    const lagc_real rho = p->rho;
    prepared[50] = rho;
    const lagc_real t0 = l4 * rho;
    prepared[14] = t0;
    const lagc_real t1 = l4 * t0;
    const lagc_real t2 = l3 * t1;
    prepared[0] = t2;
    const lagc_real l2 = p->l2;
    prepared[47] = l2;
    const lagc_real t3 = l2 * t1;
    prepared[1] = t3;
    const lagc_real t4 = l3 * l3;
    const lagc_real t5 = l2 * rho;
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = t0 * (l2 * l3);
    prepared[2] = t6 + t7 * 2.0;
    const lagc_real t8 = t0 * t4;
    prepared[4] = t8;
    const lagc_real t9 = l3 * rho;
    prepared[13] = t9;
    const lagc_real t10 = t4 * t9;
    const lagc_real t11 = l4 * t1;
    const lagc_real t12 = 0.3333333333333333 * t11;
    prepared[10] = t12;
    const lagc_real t13 = t10 * 0.3333333333333333 + t12;
    prepared[5] = t13;
    const lagc_real t14 = l2 * t5;
    const lagc_real t15 = l3 + (l4 + l2 * 0.3333333333333333);
    prepared[3] = t8 + (t13 + t14 * t15);
    prepared[6] = t3 * 0.5;
    prepared[7] = t7 + t6 * 0.5;
    prepared[8] = t2 * 0.5;
    prepared[9] = t8 + t13;
    prepared[11] = t14 * 0.25;
    prepared[12] = l4 * 0.5;
    prepared[15] = t9 * 0.5;
    prepared[16] = t1 * 0.5;
    prepared[17] = 1.0 / t12;
    const lagc_real t16 = l2 * l2;
    const lagc_real t17 = rho * t16;
    prepared[18] = 0.25 * t17;
    const lagc_real t18 = l3 * t9;
    const lagc_real t19 = l3 * t18;
    const lagc_real t20 = t11 * 0.08333333333333333;
    prepared[24] = t20;
    const lagc_real t21 = 0.08333333333333333 * t19 + t20;
    prepared[21] = t21;
    prepared[19] = l2 * t17 * 0.08333333333333333 + t21;
    prepared[20] = 0.25 * t18;
    prepared[22] = 0.5 * t18;
    prepared[23] = t11 * 0.25;
    const lagc_real t22 = l4 * l4;
    const lagc_real t23 = t9 * t22;
    prepared[25] = t23;
    const lagc_real t24 = l4 * t18;
    prepared[30] = t24;
    const lagc_real t25 = t0 * t22;
    const lagc_real t26 = 0.3333333333333333 * t25;
    prepared[35] = t26;
    const lagc_real t27 = 0.3333333333333333 * t19 + t26;
    prepared[31] = t27;
    prepared[26] = t24 + (t27 + t5 * (l2 * t15));
    const lagc_real t28 = t5 * t22;
    prepared[27] = t28;
    const lagc_real t29 = l2 * t18;
    const lagc_real t30 = t9 * (l2 * l4);
    prepared[28] = t29 + 2.0 * t30;
    prepared[29] = 0.5 * t28;
    prepared[32] = t30 + 0.5 * t29;
    prepared[33] = t24 + t27;
    prepared[34] = 0.5 * t23;
    const lagc_real l1 = p->l1;
    prepared[46] = l1;
    prepared[36] = fabs(l1);
    prepared[37] = fabs(l3);
    const lagc_real t31 = fabs(l4);
    prepared[38] = t31;
    prepared[39] = 2.0 * t31;
    const lagc_real t32 = fabs(l2);
    prepared[40] = t32;
    prepared[41] = 2.0 * t32;
    prepared[42] = t0 * 0.5;
    prepared[43] = t25 * 0.041666666666666664;
    prepared[44] = rho * (l2 * t16) * 0.16666666666666666;
    prepared[45] = t10 * 0.041666666666666664;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real q3 = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(q3, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[0];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc1[1];
    const lagc_real q1 = x[0];
    lagc_real sc2[2]; lagc_sine_cosine(q1, sc2);
    const lagc_real t4 = sc2[0];
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = t0 * p->prepared[0];
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t7 = t1 * t2;
    const lagc_real t8 = t3 * (t0 * prepared1 + p->prepared[2]) + (t6 + p->prepared[3] - prepared1 * t7);
    const lagc_real t9 = t3 * t0;
    const lagc_real t10 = 1.0 / t8;
    const lagc_real prepared6 = p->prepared[6];
    const lagc_real t11 = t9 * prepared6;
    const lagc_real t12 = t7 * prepared6;
    const lagc_real t13 = t4 * t3;
    const lagc_real t14 = t5 * t1;
    const lagc_real t15 = t3 * t5;
    const lagc_real t16 = t4 * t1;
    const lagc_real t17 = t11 + t3 * p->prepared[7] + (t6 + (p->prepared[4] + p->prepared[5]) - t12);
    const lagc_real der_q1 = x[3];
    /* der(q1) */
    xdot[0] = der_q1;
    const lagc_real t18 = der_q1 * der_q1;
    const lagc_real der_q2 = x[4];
    /* der(q2) */
    xdot[1] = der_q2;
    const lagc_real t19 = der_q2 * der_q2;
    const lagc_real t20 = der_q1 * der_q2;
    const lagc_real t21 = t10 * t17;
    const lagc_real t22 = t14 * t20;
    const lagc_real t23 = t13 * t20;
    const lagc_real t24 = t16 * t20;
    const lagc_real l4 = p->l4;
    const lagc_real t25 = t0 * l4;
    const lagc_real t26 = t6 + p->prepared[9];
    const lagc_real prepared10 = p->prepared[10];
    const lagc_real t27 = t0 * p->prepared[8] + prepared10;
    const lagc_real l3 = p->l3;
    const lagc_real t28 = t25 + l3;
    const lagc_real t29 = t15 - t16;
    const lagc_real t30 = t26 - t17 * t21;
    const lagc_real t31 = t13 + t14;
    const lagc_real der_q3 = x[5];
    /* der(q3) */
    xdot[2] = der_q3;
    const lagc_real t32 = der_q3 * der_q3;
    const lagc_real t33 = t27 + (t11 - t12);
    const lagc_real t34 = l4 * t2;
    const lagc_real t35 = 1.0 / t30;
    const lagc_real t36 = der_q1 * t14 + der_q2 * t13 + (der_q1 * t13 + der_q2 * t14);
    const lagc_real t37 = der_q3 * t2;
    const lagc_real t38 = der_q1 * t15 - der_q2 * t16 + (der_q2 * t15 - der_q1 * t16);
    const lagc_real t39 = 2.0 * (der_q3 * t0);
    const lagc_real t40 = t0 * t32;
    const lagc_real t41 = t13 * t18 + t22 + (t22 + t13 * t19) + (t14 * t19 + t23 + (t23 + t14 * t18));
    const lagc_real t42 = t15 * (2.0 * t20) - t16 * (t18 + t19) + (t15 * t19 - t24 + (t15 * t18 - t24));
    const lagc_real t43 = t10 * t33;
    const lagc_real t44 = t29 * t34;
    const lagc_real t45 = t36 * t37;
    const lagc_real t46 = t37 * t38;
    const lagc_real l2 = p->l2;
    const lagc_real t47 = t4 * l2;
    const lagc_real t48 = t44 + (t13 * t28 + t28 * t14);
    const lagc_real t49 = t27 - t17 * t43;
    const lagc_real t50 = t47 + t48;
    const lagc_real t51 = l2 * t5;
    const lagc_real t52 = l3 * t42;
    const lagc_real t53 = l3 * t41;
    const lagc_real t54 = t35 * t49;
    const lagc_real t55 = t50 * t10;
    const lagc_real t56 = t47 * t18;
    const lagc_real t57 = t51 * t18;
    const lagc_real t58 = t14 * t34 + t13 * t34;
    const lagc_real t59 = t18 * p->prepared[11];
    const lagc_real prepared12 = p->prepared[12];
    const lagc_real t60 = t57 + t52 * 0.5;
    const lagc_real t61 = t0 * t41 + (t46 + t31 * t40) + (t2 * (t42 + t29 * t32) + (t46 + t36 * t39));
    const lagc_real t62 = t56 + 0.5 * t53;
    const lagc_real t63 = t28 * t29 - t58;
    const lagc_real t64 = prepared10 - t33 * t43 - t49 * t54;
    const lagc_real t65 = t55 * t17 - t48;
    const lagc_real t66 = (t45 - t29 * t40 - t0 * t42 + (t2 * (t41 + t31 * t32) + (t45 - t38 * t39))) * prepared12;
    const lagc_real t67 = t66 - (t57 + t52);
    const lagc_real prepared13 = p->prepared[13];
    const lagc_real t68 = prepared12 * t61 + (t56 + t53);
    const lagc_real t69 = t51 + t63;
    const lagc_real t70 = 1.0 / t64;
    const lagc_real t71 = t44 + t25 * t31;
    const lagc_real t72 = t65 * t35;
    const lagc_real t73 = t3 * t2 + t0 * t1;
    const lagc_real t74 = t9 - t7;
    const lagc_real prepared14 = p->prepared[14];
    const lagc_real t75 = t67 * prepared14;
    const lagc_real t76 = prepared14 * t68;
    const lagc_real prepared15 = p->prepared[15];
    const lagc_real t77 = t10 * t69;
    const lagc_real t78 = t0 * t68 + t2 * t67;
    const lagc_real t79 = t0 * t67;
    const lagc_real t80 = t2 * t68;
    const lagc_real t81 = t55 * t33 - t71 - t49 * t72;
    const lagc_real prepared16 = p->prepared[16];
    const lagc_real t82 = t5 * t74 - t4 * t73;
    const lagc_real t83 = t63 - t77 * t17;
    const lagc_real t84 = t81 * t70;
    const lagc_real t85 = t5 * t73 + t4 * t74;
    const lagc_real t86 = der_q2 * 2.0;
    const lagc_real t87 = l3 * (t76 + t62 * prepared15) + t78 * prepared16;
    const lagc_real t88 = der_q2 * t82;
    const lagc_real t89 = der_q3 * t82;
    const lagc_real t90 = t83 * t35;
    const lagc_real t91 = t25 * t29 - t58;
    const lagc_real t92 = der_q2 * t85;
    const lagc_real t93 = der_q3 * t85;
    const lagc_real t94 = t4 * (t5 * t59 + t60 * prepared13 - t75) - t5 * (t76 + (t4 * t59 + prepared13 * t62));
    const lagc_real t95 = t16 * t87;
    const lagc_real t96 = l3 * (t75 - t60 * prepared15) + prepared16 * (t79 - t80);
    const lagc_real t97 = t13 * t96;
    const lagc_real t98 = t91 - t77 * t33 - t90 * t49;
    const lagc_real t99 = 1.0 / (t81 * t84 + (t50 * t55 + t65 * t72));
    const lagc_real t100 = t15 * t87 + t14 * t96;
    const lagc_real t101 = t98 * t70;
    const lagc_real t102 = l2 * t94 + t95 - t97 - t100;
    const lagc_real t103 = t100 + (t97 - t95);
    const lagc_real t104 = t50 * t77 - t65 * t90 - t81 * t101;
    const lagc_real t105 = t103 + t21 * t102;
    const lagc_real t106 = prepared16 * (t29 * t78 + (t31 * t79 - t31 * t80));
    const lagc_real t107 = der_q1 * (2.0 * (t88 + t89) + der_q1 * t82) + (der_q2 * (t88 + 2.0 * t89) + t32 * t82);
    const lagc_real t108 = t104 * t99;
    const lagc_real t109 = der_q1 * ((t92 + t93) * 2.0 + der_q1 * t85) + (der_q2 * (t92 + t93 * 2.0) + t85 * t32);
    const lagc_real t110 = l4 * t107 + (t57 + l3 * (der_q1 * (der_q1 * t29 + t29 * t86) + t29 * t19));
    const lagc_real t111 = t98 * t101 + (t69 * t77 + t83 * t90);
    const lagc_real t112 = l4 * t109 + (t56 + l3 * (der_q1 * (der_q1 * t31 + t31 * t86) + t31 * t19));
    const lagc_real t113 = t106 + t43 * t102 - t54 * t105;
    const lagc_real t114 = t104 * t108 - t111;
    const lagc_real t115 = 1.0 / t114;
    const lagc_real t116 = t110 - t55 * t102 - t72 * t105 - t84 * t113;
    const lagc_real t117 = t115 * (t108 * t116 + (t112 + t77 * t102 - t90 * t105 - t101 * t113));
    const lagc_real t118 = t108 * t117 - t99 * t116;
    const lagc_real t119 = t70 * t113 - t101 * t117 - t84 * t118;
    /* der(der(q3)) */
    xdot[5] = t119;
    const lagc_real t120 = t35 * t105 - t90 * t117 - t72 * t118 - t54 * t119;
    /* der(der(q2)) */
    xdot[4] = t120;
    const lagc_real t121 = t55 * t118 - (t10 * t102 + t77 * t117) - t43 * t119 - t21 * t120;
    /* der(der(q1)) */
    xdot[3] = t121;
    const lagc_real t122 = t26 * t120;
    const lagc_real t123 = prepared10 * t119;
    const lagc_real t124 = t8 * t121;
    const lagc_real t125 = t50 * t118 - (t102 + t69 * t117) - t33 * t119 - t17 * t120 - t124;
    const lagc_real t126 = t48 * t118 + (t103 - t63 * t117) - t27 * t119 - t122 - t17 * t121;
    const lagc_real t127 = t71 * t118 + (t106 - t91 * t117) - t123 - t27 * t120 - t33 * t121;
    const lagc_real t128 = t50 * t121 + (t48 * t120 + (t110 + t71 * t119));
    const lagc_real t129 = t112 - t91 * t119 - t63 * t120 - t69 * t121;
    const lagc_real t130 = t99 * (t110 * t110) + 1e-300 - t115 * (t112 * t112);
    const lagc_real t131 = t125 * (t10 * t125) + t126 * (t35 * t126) - t129 * (t115 * t129);
    const lagc_real t132 = t35 * (t103 * t103 + t122 * t122) + (t70 * (t106 * t106 + t123 * t123) + t130);
    const lagc_real t133 = t127 * (t70 * t127) + t128 * (t99 * t128) + t131;
    health[1] = t133 / (t10 * (t102 * t102 + t124 * t124) + t132);
    health[0] = lagc_min(lagc_min(t30 / t26, t64 * p->prepared[17]), -(t114 / t111));
    /* ring[1], four_bar.lag:32 */
    lam[0] = -t118;
    /* ring[2], four_bar.lag:32 */
    lam[1] = -t117;
    (void)(t);
}

/* mass matrix, forces and constraint rows */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real der_q1 = x[3];
    qdot[0] = der_q1;
    const lagc_real der_q2 = x[4];
    qdot[1] = der_q2;
    const lagc_real der_q3 = x[5];
    qdot[2] = der_q3;
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real l3 = p->l3;
    const lagc_real l2 = p->l2;
    const lagc_real t2 = t0 * l2;
    const lagc_real t3 = t0 * t1;
    const lagc_real t4 = sc0[0];
    const lagc_real t5 = sc1[0];
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = t3 - t6;
    const lagc_real t8 = t7 * l3;
    const lagc_real t9 = t2 + t8 * 0.5;
    const lagc_real prepared15 = p->prepared[15];
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t10 = sc2[1];
    const lagc_real t11 = t0 * t5;
    const lagc_real t12 = t1 * t4;
    const lagc_real t13 = t11 + t12;
    const lagc_real t14 = sc2[0];
    const lagc_real t15 = t13 * t14;
    const lagc_real t16 = t7 * t10 - t15;
    const lagc_real l4 = p->l4;
    const lagc_real t17 = t16 * l4;
    G[5] = t17;
    const lagc_real t18 = 0.5 * t17;
    const lagc_real t19 = t8 + (t2 + t18);
    const lagc_real prepared14 = p->prepared[14];
    const lagc_real t20 = t19 * prepared14;
    const lagc_real t21 = l3 * t13;
    const lagc_real t22 = l2 * t4;
    const lagc_real t23 = t10 * t13;
    const lagc_real t24 = t7 * t14 + t23;
    const lagc_real t25 = l4 * t24;
    const lagc_real t26 = 0.5 * t25;
    const lagc_real t27 = t21 + (t22 + t26);
    const lagc_real prepared16 = p->prepared[16];
    const lagc_real t28 = l3 * (t9 * prepared15 + t20) + (t14 * t27 + t10 * t19) * prepared16;
    const lagc_real t29 = t22 + 0.5 * t21;
    const lagc_real t30 = prepared14 * t27;
    const lagc_real t31 = prepared16 * (t14 * t19 - t10 * t27) - l3 * (prepared15 * t29 + t30);
    const lagc_real prepared13 = p->prepared[13];
    const lagc_real prepared18 = p->prepared[18];
    const lagc_real t32 = t0 * prepared18;
    const lagc_real t33 = t4 * prepared18;
    const lagc_real t34 = t4 * (l2 * (t33 + (t30 + t29 * prepared13)) - (t5 * t28 + t1 * t31));
    const lagc_real t35 = t0 * (t1 * t28 - t5 * t31 + l2 * (t20 + (t9 * prepared13 + t32))) + t34;
    M[0] = t35 + p->prepared[19];
    const lagc_real t36 = t8 + t18;
    const lagc_real t37 = prepared14 * t36;
    const lagc_real prepared20 = p->prepared[20];
    const lagc_real t38 = t21 + t26;
    const lagc_real t39 = t7 * (l3 * (t37 + t7 * prepared20) + prepared16 * (t10 * t36 + t14 * t38));
    const lagc_real prepared21 = p->prepared[21];
    const lagc_real t40 = prepared14 * t38;
    const lagc_real t41 = prepared16 * (t14 * t36 - t10 * t38) - l3 * (t40 + t13 * prepared20);
    const lagc_real t42 = t11 * t41;
    const lagc_real t43 = t12 * t41;
    const lagc_real prepared22 = p->prepared[22];
    const lagc_real t44 = l2 * (t0 * (t37 + t7 * prepared22) + t4 * (t40 + t13 * prepared22));
    M[1] = t39 + (prepared21 - t42) - t43 + t44;
    M[2] = t39 + prepared21 - t42 - t43;
    const lagc_real t45 = t14 * t24;
    const lagc_real prepared23 = p->prepared[23];
    const lagc_real t46 = t10 * prepared23 + p->prepared[8];
    const lagc_real t47 = prepared23 * (t14 * t16) - t24 * t46;
    const lagc_real prepared24 = p->prepared[24];
    const lagc_real t48 = t7 * (t45 * prepared23 + t16 * t46) - t11 * t47 - t12 * t47 + prepared24;
    M[4] = t48;
    M[3] = t48 + (t0 * t16 + t4 * t24) * p->prepared[6];
    M[5] = prepared24 + prepared23 * (t23 * t24 + (t7 * (t45 + t10 * t16) - t15 * t16));
    const lagc_real t49 = der_q1 * der_q1;
    const lagc_real t50 = der_q1 * t11 + der_q2 * t12 + (der_q1 * t12 + der_q2 * t11);
    const lagc_real t51 = der_q3 * t14;
    const lagc_real t52 = t50 * t51;
    const lagc_real t53 = der_q1 * t3 - der_q2 * t6 + (der_q2 * t3 - der_q1 * t6);
    const lagc_real t54 = der_q3 * t10;
    const lagc_real t55 = der_q3 * t7;
    const lagc_real t56 = der_q1 * der_q2;
    const lagc_real t57 = t11 * t56;
    const lagc_real t58 = der_q2 * der_q2;
    const lagc_real t59 = t12 * t56;
    const lagc_real t60 = t12 * t49 + (t57 + (t57 + t12 * t58)) + (t11 * t58 + (t59 + (t59 + t11 * t49)));
    const lagc_real t61 = t6 * t56;
    const lagc_real t62 = t3 * t58 - t61 + (t3 * t49 - t61 + (2.0 * (t3 * t56) - t6 * (t49 + t58)));
    const lagc_real t63 = t14 * (t60 + t13 * (der_q3 * der_q3)) - t10 * t62;
    const lagc_real t64 = l4 * (t52 - t53 * t54 * 2.0 - (t54 * t55 - t52) + t63);
    const lagc_real t65 = t2 * t49;
    const lagc_real t66 = l3 * t62;
    const lagc_real t67 = t65 + t66;
    const lagc_real t68 = 0.5 * t64 - t67;
    const lagc_real t69 = prepared14 * t68;
    const lagc_real t70 = t65 + 0.5 * t66;
    const lagc_real t71 = t22 * t49;
    const lagc_real t72 = l3 * t60;
    const lagc_real t73 = t71 + t72;
    const lagc_real t74 = t51 * t53;
    const lagc_real t75 = t74 + (t74 + t54 * (der_q3 * t13)) + 2.0 * (t50 * t54);
    const lagc_real t76 = l4 * (t75 + (t10 * t60 + t14 * (t62 + der_q3 * t55)));
    const lagc_real t77 = t73 + 0.5 * t76;
    const lagc_real t78 = prepared14 * t77;
    const lagc_real t79 = t71 + 0.5 * t72;
    const lagc_real t80 = t4 * (t32 * t49 - (t69 - prepared13 * t70));
    const lagc_real t81 = l3 * (t69 - prepared15 * t70) + prepared16 * (t10 * t68 - t14 * t77);
    const lagc_real t82 = t10 * t77 + t14 * t68;
    const lagc_real t83 = t12 * t81 + (t7 * (l3 * (t78 + prepared15 * t79) + prepared16 * t82) + t11 * t81);
    r[1] = t83;
    r[0] = -(l2 * (t80 - t0 * (t78 + (t33 * t49 + prepared13 * t79))) - t83);
    r[2] = -(prepared16 * (t15 * t77 - t7 * t82 - t23 * t68));
    const lagc_real t84 = l3 + t10 * l4;
    const lagc_real t85 = t14 * l4;
    const lagc_real t86 = t12 * t84 + (t11 * t84 + t7 * t85);
    G[0] = -(t22 + t86);
    G[1] = -t86;
    G[2] = -t25;
    const lagc_real t87 = t7 * t84;
    const lagc_real t88 = t11 * t85;
    const lagc_real t89 = t12 * t85;
    G[3] = t87 + (t2 - t88) - t89;
    G[4] = t87 - t88 - t89;
    gamma[0] = -(t64 - t67);
    gamma[1] = t73 + t76;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real q3 = x[2];
    lagc_real sc0[2]; lagc_sine_cosine(q3, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = t0 * p->prepared[25];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t2 = sc1[1];
    const lagc_real prepared27 = p->prepared[27];
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = sc0[0];
    const lagc_real t5 = t3 * t4;
    w[0] = t1 + p->prepared[26] + (t2 * (t0 * prepared27 + p->prepared[28]) - prepared27 * t5);
    const lagc_real prepared29 = p->prepared[29];
    const lagc_real t6 = t0 * t2 * prepared29;
    const lagc_real t7 = t5 * prepared29;
    w[1] = t6 + (t1 + p->prepared[30] - t7 + p->prepared[31]) + t2 * p->prepared[32];
    w[2] = t1 + p->prepared[33];
    const lagc_real t8 = t0 * p->prepared[34];
    const lagc_real prepared35 = p->prepared[35];
    w[5] = prepared35;
    w[3] = t8 + (t6 - t7 + prepared35);
    w[4] = t8 + prepared35;
    const lagc_real q1 = x[0];
    lagc_real sc2[2]; lagc_sine_cosine(q1, sc2);
    const lagc_real t9 = sc2[0];
    const lagc_real l2 = p->l2;
    const lagc_real t10 = t2 * t9;
    const lagc_real l4 = p->l4;
    const lagc_real t11 = t0 * l4;
    const lagc_real t12 = t11 + p->l3;
    const lagc_real t13 = sc2[1];
    const lagc_real t14 = t3 * t13;
    const lagc_real t15 = t2 * t13 - t3 * t9;
    const lagc_real t16 = t4 * l4;
    const lagc_real t17 = t15 * t16;
    const lagc_real t18 = t10 * t12 + (t12 * t14 + t17);
    w[6] = -(t9 * l2 + t18);
    w[7] = -t18;
    w[8] = -(t17 + t11 * (t10 + t14));
    const lagc_real t19 = t14 * t16;
    const lagc_real t20 = t10 * t16;
    const lagc_real t21 = t12 * t15 - t19 - t20;
    w[10] = t21;
    w[9] = l2 * t13 + t21;
    w[11] = t11 * t15 - (t19 + t20);
    (void)(t);
}

/* L D L^T of the matrix that `assemble` left in w */
static void lagc_fn_factor(lagc_real *w, lagc_real *health)
{
    const lagc_real w1 = w[1];
    const lagc_real t0 = 1.0 / w[0];
    w[22] = t0;
    const lagc_real t1 = w1 * t0;
    w[12] = t1;
    const lagc_real w3 = w[3];
    const lagc_real t2 = w3 * t0;
    w[13] = t2;
    const lagc_real w6 = w[6];
    const lagc_real t3 = w6 * t0;
    w[14] = t3;
    const lagc_real w9 = w[9];
    const lagc_real t4 = w9 * t0;
    w[15] = t4;
    const lagc_real t5 = w[4] - w1 * t2;
    const lagc_real w2 = w[2];
    const lagc_real t6 = w2 - w1 * t1;
    const lagc_real t7 = 1.0 / t6;
    w[23] = t7;
    const lagc_real t8 = t5 * t7;
    w[16] = t8;
    const lagc_real t9 = w[7] - w1 * t3;
    const lagc_real t10 = t9 * t7;
    w[17] = t10;
    const lagc_real t11 = w[10] - w1 * t4;
    const lagc_real t12 = t11 * t7;
    w[18] = t12;
    const lagc_real t13 = w[8] - w3 * t3 - t5 * t10;
    const lagc_real w5 = w[5];
    const lagc_real t14 = w5 - w3 * t2 - t5 * t8;
    const lagc_real t15 = 1.0 / t14;
    w[24] = t15;
    const lagc_real t16 = t13 * t15;
    w[19] = t16;
    const lagc_real t17 = w[11] - w3 * t4 - t5 * t12;
    const lagc_real t18 = t17 * t15;
    w[20] = t18;
    const lagc_real t19 = w6 * t4 + t9 * t12 + t13 * t18;
    const lagc_real t20 = 1.0 / (w6 * t3 + t9 * t10 + t13 * t16);
    const lagc_real t21 = t19 * t20;
    w[21] = t21;
    w[25] = -t20;
    const lagc_real t22 = w9 * t4 + t11 * t12 + t17 * t18;
    const lagc_real t23 = t19 * t21 - t22;
    w[26] = 1.0 / t23;
    health[0] = lagc_min(lagc_min(t6 / w2, t14 / w5), -(t23 / t22));
    health[1] = 0.0;
}

/* M s1 - G^T s2 = r1, G s1 = r2 */
static void lagc_fn_solve(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real r0 = r[0];
    const lagc_real w15 = w[15];
    const lagc_real w18 = w[18];
    const lagc_real w12 = w[12];
    const lagc_real t0 = r[1] - r0 * w12;
    const lagc_real w20 = w[20];
    const lagc_real w13 = w[13];
    const lagc_real w16 = w[16];
    const lagc_real t1 = r[2] - r0 * w13 - w16 * t0;
    const lagc_real w21 = w[21];
    const lagc_real w14 = w[14];
    const lagc_real w17 = w[17];
    const lagc_real w19 = w[19];
    const lagc_real t2 = r[3] - r0 * w14 - w17 * t0 - w19 * t1;
    const lagc_real t3 = w[26] * (r[4] - r0 * w15 - w18 * t0 - w20 * t1 - w21 * t2);
    const lagc_real t4 = w[25] * t2 - w21 * t3;
    const lagc_real t5 = w[24] * t1 - w20 * t3 - w19 * t4;
    s[2] = t5;
    const lagc_real t6 = w[23] * t0 - w18 * t3 - w17 * t4 - w16 * t5;
    s[1] = t6;
    s[0] = r0 * w[22] - w15 * t3 - w14 * t4 - w13 * t5 - w12 * t6;
    s[3] = -t4;
    s[4] = -t3;
}

/* one step of refinement of what solve gave */
static void lagc_fn_refine(const lagc_real *w, const lagc_real *r, lagc_real *s)
{
    const lagc_real t0 = s[0];
    const lagc_real w9 = w[9];
    const lagc_real t1 = s[4];
    const lagc_real w6 = w[6];
    const lagc_real t2 = s[3];
    const lagc_real w1 = w[1];
    const lagc_real t3 = s[1];
    const lagc_real w3 = w[3];
    const lagc_real t4 = s[2];
    const lagc_real t5 = w9 * t1 + (w6 * t2 + (r[0] - w[0] * t0 - w1 * t3 - w3 * t4));
    const lagc_real w15 = w[15];
    const lagc_real w10 = w[10];
    const lagc_real w11 = w[11];
    const lagc_real w18 = w[18];
    const lagc_real w7 = w[7];
    const lagc_real w4 = w[4];
    const lagc_real w12 = w[12];
    const lagc_real t6 = w10 * t1 + (w7 * t2 + (r[1] - w1 * t0 - w[2] * t3 - w4 * t4)) - w12 * t5;
    const lagc_real w20 = w[20];
    const lagc_real w8 = w[8];
    const lagc_real w13 = w[13];
    const lagc_real w16 = w[16];
    const lagc_real t7 = w11 * t1 + (w8 * t2 + (r[2] - w3 * t0 - w4 * t3 - w[5] * t4)) - w13 * t5 - w16 * t6;
    const lagc_real w21 = w[21];
    const lagc_real w14 = w[14];
    const lagc_real w17 = w[17];
    const lagc_real w19 = w[19];
    const lagc_real t8 = r[3] - w6 * t0 - w7 * t3 - w8 * t4 - w14 * t5 - w17 * t6 - w19 * t7;
    const lagc_real t9 = r[4] - w9 * t0 - w10 * t3 - w11 * t4 - w15 * t5 - w18 * t6 - w20 * t7 - w21 * t8;
    const lagc_real t10 = w[26] * t9;
    const lagc_real t11 = w[25] * t8 - w21 * t10;
    const lagc_real t12 = w[24] * t7 - w20 * t10 - w19 * t11;
    const lagc_real t13 = w[23] * t6 - w18 * t10 - w17 * t11 - w16 * t12;
    const lagc_real t14 = t0 + (w[22] * t5 - w15 * t10 - w14 * t11 - w13 * t12 - w12 * t13);
    const lagc_real t15 = t3 + t13;
    const lagc_real t16 = t4 + t12;
    const lagc_real t17 = -(t11 - t2);
    const lagc_real t18 = -(t10 - t1);
    s[0] = t14;
    s[1] = t15;
    s[2] = t16;
    s[3] = t17;
    s[4] = t18;
}

/* holonomic residuals */
static void lagc_fn_position(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *phi)
{
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = t0 * t1 - t2 * t3;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = t0 * t3 + t1 * t2;
    const lagc_real t7 = sc2[0];
    const lagc_real l4 = p->l4;
    const lagc_real l2 = p->l2;
    const lagc_real l3 = p->l3;
    /* ring[1], four_bar.lag:32 */
    phi[0] = (t4 * t5 - t6 * t7) * l4 + (t0 * l2 + t4 * l3) + p->l1;
    /* ring[2], four_bar.lag:32 */
    phi[1] = t2 * l2 + t6 * l3 + l4 * (t4 * t7 + t5 * t6);
    (void)(t);
}

/* rates of the constraint rows */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real der_q1 = x[3];
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[0];
    const lagc_real t2 = t0 * t1;
    const lagc_real der_q2 = x[4];
    const lagc_real t3 = sc0[0];
    const lagc_real t4 = sc1[1];
    const lagc_real t5 = t3 * t4;
    const lagc_real t6 = der_q1 * t2 + der_q2 * t5 + (der_q1 * t5 + t2 * der_q2);
    const lagc_real l3 = p->l3;
    const lagc_real t7 = der_q1 * p->l2;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t8 = sc2[1];
    const lagc_real t9 = sc2[0];
    const lagc_real t10 = t0 * t4;
    const lagc_real t11 = t1 * t3;
    const lagc_real t12 = der_q1 * t10 - der_q2 * t11 + (der_q2 * t10 - der_q1 * t11);
    const lagc_real der_q3 = x[5];
    const lagc_real t13 = t10 - t11;
    const lagc_real t14 = t2 + t5;
    const lagc_real l4 = p->l4;
    /* ring[1], four_bar.lag:32 */
    psi[0] = -(t6 * l3 + (t3 * t7 + (t6 * t8 + (t9 * t12 + der_q3 * (t9 * t13 + t8 * t14))) * l4));
    /* ring[2], four_bar.lag:32 */
    psi[1] = l3 * t12 + (t0 * t7 + l4 * (t8 * t12 + der_q3 * (t8 * t13 - t9 * t14) - t6 * t9));
    (void)(t);
}

/* size of the terms of each constraint row */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l2 = p->l2;
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = t0 * t1 - t2 * t3;
    const lagc_real l3 = p->l3;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = t0 * t3 + t1 * t2;
    const lagc_real t7 = sc2[0];
    const lagc_real l4 = p->l4;
    const lagc_real t8 = fabs(t0 * l2) + (fabs(t4 * l3) + (fabs((t4 * t5 - t6 * t7) * l4) + 1e-300));
    const lagc_real t9 = t8 + p->prepared[36];
    s[0] = t9;
    const lagc_real t10 = fabs(l4 * (t4 * t7 + t5 * t6)) + (fabs(l3 * t6) + (1e-300 + fabs(l2 * t2)));
    s[1] = lagc_max(t10, lagc_max(t9, t10) * 1e-06);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = fabs(sc0[1]);
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = fabs(sc1[1]);
    const lagc_real t2 = t0 * t1;
    const lagc_real t3 = fabs(x[3]);
    const lagc_real t4 = fabs(x[4]);
    const lagc_real t5 = t3 * t4;
    const lagc_real t6 = fabs(sc0[0]);
    const lagc_real t7 = fabs(sc1[0]);
    const lagc_real t8 = t6 * t7;
    const lagc_real t9 = t2 + t8;
    const lagc_real t10 = t3 * t3;
    const lagc_real t11 = t4 * t4;
    const lagc_real t12 = t2 * t5 * 2.0 + 2.0 * (t5 * t8) + (t9 * t10 + t9 * t11);
    const lagc_real prepared37 = p->prepared[37];
    const lagc_real t13 = fabs(x[5]);
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t14 = fabs(sc2[1]);
    const lagc_real t15 = t13 * t14;
    const lagc_real t16 = t3 * t9 + t4 * t9;
    const lagc_real t17 = t0 * t7;
    const lagc_real t18 = t1 * t6;
    const lagc_real t19 = t17 + t18;
    const lagc_real t20 = t3 * t19 + t4 * t19;
    const lagc_real t21 = fabs(sc2[0]);
    const lagc_real t22 = t13 * t21;
    const lagc_real t23 = 2.0 * (t5 * t17) + 2.0 * (t5 * t18) + (t10 * t19 + t11 * t19);
    const lagc_real t24 = t19 * t21 + t9 * t14;
    const lagc_real t25 = t13 * t13;
    const lagc_real prepared38 = p->prepared[38];
    const lagc_real t26 = 2.0 * (t15 * t16) + 2.0 * (t20 * t22) + (t12 * t14 + (t21 * t23 + t24 * t25));
    const lagc_real prepared39 = p->prepared[39];
    const lagc_real t27 = t21 * prepared39;
    const lagc_real t28 = t13 * t27;
    const lagc_real t29 = t18 * t28;
    const lagc_real t30 = t17 * t28;
    const lagc_real t31 = t15 * prepared39;
    const lagc_real t32 = t8 * t31;
    const lagc_real t33 = t2 * t31;
    const lagc_real t34 = prepared37 + t14 * prepared38;
    const lagc_real t35 = t3 * t34;
    const lagc_real t36 = 2.0 * (t8 * t35);
    const lagc_real t37 = t4 * t34;
    const lagc_real t38 = 2.0 * (t2 * t37);
    const lagc_real t39 = t3 * t27;
    const lagc_real t40 = t18 * t39;
    const lagc_real t41 = t4 * t27;
    const lagc_real t42 = t17 * t41;
    const lagc_real t43 = t18 * t41;
    const lagc_real t44 = t17 * t39;
    const lagc_real t45 = 2.0 * (t8 * t37);
    const lagc_real t46 = 2.0 * (t2 * t35);
    const lagc_real t47 = t30 + (t32 + (t33 + (t36 + (t38 + (t40 + (t42 + (t43 + (t44 + (t45 + t46)))))))));
    const lagc_real t48 = t13 * prepared39;
    const lagc_real t49 = t0 * t3;
    const lagc_real prepared40 = p->prepared[40];
    const lagc_real prepared41 = p->prepared[41];
    const lagc_real t50 = t32 + (t46 + (t45 + (t44 + (t43 + (t42 + (t40 + (t38 + (t36 + (t30 + t33)))))))));
    const lagc_real t51 = t3 * (t49 * prepared40 + (t49 * prepared41 + (t29 + t50)));
    const lagc_real t52 = t4 * (t29 + t47) + ((t13 * t24 + t20 * t21 + t14 * t16) * t48 + t51);
    s[0] = t12 * prepared37 + (t26 * prepared38 + t52);
    const lagc_real t53 = t14 * t19 + t9 * t21;
    const lagc_real t54 = 2.0 * (t16 * t22) + 2.0 * (t15 * t20) + (t12 * t21 + (t14 * t23 + t25 * t53));
    const lagc_real t55 = t18 * t31;
    const lagc_real t56 = t17 * t31;
    const lagc_real t57 = t8 * t28;
    const lagc_real t58 = t2 * t28;
    const lagc_real t59 = t8 * t39;
    const lagc_real t60 = t2 * t41;
    const lagc_real t61 = 2.0 * (t18 * t35);
    const lagc_real t62 = 2.0 * (t17 * t37);
    const lagc_real t63 = 2.0 * (t18 * t37);
    const lagc_real t64 = 2.0 * (t17 * t35);
    const lagc_real t65 = t8 * t41;
    const lagc_real t66 = t2 * t39;
    const lagc_real t67 = t56 + (t57 + (t58 + (t59 + (t60 + (t61 + (t62 + (t63 + (t64 + (t65 + t66)))))))));
    const lagc_real t68 = t3 * t6;
    const lagc_real t69 = t57 + (t66 + (t65 + (t64 + (t63 + (t62 + (t61 + (t60 + (t59 + (t56 + t58)))))))));
    const lagc_real t70 = t3 * (prepared40 * t68 + (prepared41 * t68 + (t55 + t69)));
    const lagc_real t71 = t4 * (t55 + t67) + (t48 * (t13 * t53 + t14 * t20 + t16 * t21) + t70);
    s[1] = prepared37 * t23 + (prepared38 * t54 + t71);
    (void)(t);
}

/* size of the terms of each row's gradient */
static void lagc_fn_gradient_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = fabs(sc0[0]);
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = fabs(sc1[1]);
    const lagc_real t2 = t0 * t1;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t3 = fabs(sc2[1]);
    const lagc_real prepared38 = p->prepared[38];
    const lagc_real t4 = t3 * prepared38 + p->prepared[37];
    const lagc_real t5 = t2 * t4;
    const lagc_real t6 = fabs(sc0[1]);
    const lagc_real t7 = fabs(sc1[0]);
    const lagc_real t8 = t1 * t6 + t0 * t7;
    const lagc_real t9 = fabs(sc2[0]);
    const lagc_real t10 = prepared38 * t9;
    const lagc_real t11 = t8 * t10;
    const lagc_real t12 = t6 * t7;
    const lagc_real t13 = t4 * t12;
    const lagc_real prepared40 = p->prepared[40];
    const lagc_real t14 = t2 + t12;
    const lagc_real t15 = t0 * prepared40 + prepared38 * (t3 * t14 + t8 * t9);
    s[0] = t5 + (t11 + (t13 + (t5 + (t11 + t13)))) + t15;
    const lagc_real t16 = t2 * t10;
    const lagc_real t17 = t4 * t8;
    const lagc_real t18 = t10 * t12;
    const lagc_real t19 = t6 * prepared40 + prepared38 * (t9 * t14 + t3 * t8);
    s[1] = t16 + (t17 + (t18 + (t16 + (t17 + t18)))) + t19;
    (void)(t);
}

/* reach of each constraint row */
static void lagc_fn_reaches(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *c, lagc_real *s)
{
    const lagc_real size0 = c[0];
    const lagc_real q2 = x[1];
    lagc_real sc0[2]; lagc_sine_cosine(q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q1 = x[0];
    lagc_real sc1[2]; lagc_sine_cosine(q1, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t2 = sc2[0];
    const lagc_real l4 = p->l4;
    const lagc_real t3 = t2 * l4;
    const lagc_real t4 = sc1[0];
    const lagc_real t5 = sc2[1];
    const lagc_real l3 = p->l3;
    const lagc_real t6 = l4 * t5 + l3;
    const lagc_real t7 = t1 * t3 + t4 * t6;
    const lagc_real t8 = sc0[0];
    const lagc_real t9 = t1 * t6 - t3 * t4;
    const lagc_real t10 = t0 * t3 + t6 * t8;
    const lagc_real l2 = p->l2;
    const lagc_real t11 = l2 - t3 * t8 + t0 * t6;
    const lagc_real t12 = t0 * t1 - t4 * t8;
    const lagc_real t13 = t1 * t8;
    const lagc_real t14 = t0 * t4;
    const lagc_real t15 = t13 + t14;
    const lagc_real t16 = t2 * t12 + t5 * t15;
    const lagc_real t17 = fabs(l4 * t16);
    const lagc_real t18 = size0 * (fabs(t0 * t7 + t8 * t9) + (fabs(t1 * t10 + t4 * t11) + t17)) + 1e-300;
    s[0] = t18;
    const lagc_real t19 = t5 * t12 - t2 * t15;
    const lagc_real t20 = fabs(l4 * t19);
    const lagc_real t21 = 1e-300 + size0 * (fabs(t0 * t9 - t7 * t8) + (fabs(t1 * t11 - t4 * t10) + t20));
    s[1] = lagc_max(t21, lagc_max(t18, t21) * 1e-06);
    const lagc_real size1 = c[1];
    const lagc_real t22 = t6 * t14 + (t6 * t13 + t3 * t12);
    const lagc_real t23 = t4 * l2;
    const lagc_real t24 = lagc_max(0.0, size1);
    const lagc_real t25 = t1 * l2;
    const lagc_real t26 = l3 * t24;
    const lagc_real t27 = l4 * t24;
    const lagc_real t28 = fabs(t24 * p->l1) + (fabs(t24 * t25) + (fabs(t12 * t26) + (1e-300 + fabs(t19 * t27))));
    const lagc_real t29 = size1 * (fabs(t22) + (t17 + fabs(t22 + t23))) + t28;
    s[2] = t29;
    const lagc_real t30 = t6 * t12 - t3 * t13 - t3 * t14;
    const lagc_real t31 = fabs(t23 * t24) + (fabs(t15 * t26) + (1e-300 + fabs(t16 * t27)));
    const lagc_real t32 = size1 * (fabs(t30) + (t20 + fabs(t25 + t30))) + t31;
    s[3] = lagc_max(t32, 1e-06 * lagc_max(t29, t32));
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real der_q1 = x[3];
    const lagc_real t1 = der_q1 * p->l2;
    const lagc_real t2 = t0 * t1;
    const lagc_real t3 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t4 = sc1[0];
    const lagc_real t5 = t3 * t4;
    const lagc_real der_q2 = x[4];
    const lagc_real t6 = sc1[1];
    const lagc_real t7 = t0 * t6;
    const lagc_real t8 = der_q1 * t5 + der_q2 * t7 + (der_q1 * t7 + t5 * der_q2);
    const lagc_real l3 = p->l3;
    const lagc_real t9 = t8 * l3;
    const lagc_real t10 = t2 + t9 * 0.5;
    const lagc_real t11 = t1 * t3;
    const lagc_real t12 = t3 * t6;
    const lagc_real t13 = t0 * t4;
    const lagc_real t14 = der_q1 * t12 - der_q2 * t13 + (der_q2 * t12 - der_q1 * t13);
    const lagc_real t15 = l3 * t14;
    const lagc_real t16 = t11 + 0.5 * t15;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t17 = sc2[1];
    const lagc_real t18 = sc2[0];
    const lagc_real der_q3 = x[5];
    const lagc_real t19 = t12 - t13;
    const lagc_real t20 = t5 + t7;
    const lagc_real prepared12 = p->prepared[12];
    const lagc_real t21 = t2 + t9 + (t8 * t17 + (t14 * t18 + der_q3 * (t18 * t19 + t17 * t20))) * prepared12;
    const lagc_real t22 = t11 + t15 + prepared12 * (t14 * t17 + der_q3 * (t17 * t19 - t18 * t20) - t8 * t18);
    const lagc_real t23 = der_q1 + der_q2;
    const lagc_real t24 = der_q3 + t23;
    const lagc_real t25 = der_q1 * der_q1 * p->prepared[44] + t23 * t23 * p->prepared[45];
    const lagc_real t26 = (t10 * t10 + t16 * t16) * p->prepared[15] + (t21 * t21 + t22 * t22) * p->prepared[42];
    const lagc_real t27 = t26 + (t24 * t24 * p->prepared[43] + t25);
    /* kinetic energy */
    e[0] = t27;
    /* energy of the balance */
    e[2] = t27;
    /* potential energy */
    e[1] = 0.0;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
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
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[0];
    const lagc_real der_q1 = x[3];
    const lagc_real t1 = der_q1 * p->l2;
    const lagc_real t2 = t0 * t1;
    const lagc_real t3 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t4 = sc1[0];
    const lagc_real t5 = t3 * t4;
    const lagc_real der_q2 = x[4];
    const lagc_real t6 = sc1[1];
    const lagc_real t7 = t0 * t6;
    const lagc_real t8 = der_q1 * t5 + der_q2 * t7 + (der_q1 * t7 + t5 * der_q2);
    const lagc_real l3 = p->l3;
    const lagc_real t9 = t8 * l3;
    const lagc_real t10 = t2 + t9 * 0.5;
    const lagc_real t11 = t1 * t3;
    const lagc_real t12 = t3 * t6;
    const lagc_real t13 = t0 * t4;
    const lagc_real t14 = der_q1 * t12 - der_q2 * t13 + (der_q2 * t12 - der_q1 * t13);
    const lagc_real t15 = l3 * t14;
    const lagc_real t16 = t11 + 0.5 * t15;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t17 = sc2[1];
    const lagc_real t18 = sc2[0];
    const lagc_real der_q3 = x[5];
    const lagc_real t19 = t12 - t13;
    const lagc_real t20 = t5 + t7;
    const lagc_real prepared12 = p->prepared[12];
    const lagc_real t21 = t2 + t9 + (t8 * t17 + (t14 * t18 + der_q3 * (t18 * t19 + t17 * t20))) * prepared12;
    const lagc_real t22 = t11 + t15 + prepared12 * (t14 * t17 + der_q3 * (t17 * t19 - t18 * t20) - t8 * t18);
    const lagc_real t23 = der_q1 + der_q2;
    const lagc_real t24 = der_q3 + t23;
    const lagc_real t25 = der_q1 * der_q1 * p->prepared[44] + t23 * t23 * p->prepared[45];
    const lagc_real t26 = (t10 * t10 + t16 * t16) * p->prepared[15] + (t21 * t21 + t22 * t22) * p->prepared[42];
    /* E */
    y[5] = t26 + (t24 * t24 * p->prepared[43] + t25);
    (void)(t);
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
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l2 = p->l2;
    const lagc_real t1 = t0 * l2;
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t2 = sc1[1];
    const lagc_real t3 = t0 * t2;
    const lagc_real t4 = sc0[0];
    const lagc_real t5 = sc1[0];
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = t3 - t6;
    const lagc_real l3 = p->l3;
    const lagc_real t8 = t7 * l3;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t9 = sc2[1];
    const lagc_real t10 = t0 * t5;
    const lagc_real t11 = t2 * t4;
    const lagc_real t12 = t10 + t11;
    const lagc_real t13 = sc2[0];
    const lagc_real t14 = t7 * t9 - t12 * t13;
    const lagc_real l4 = p->l4;
    const lagc_real t15 = t14 * l4;
    J[5] = t15;
    J[17] = t15;
    c[0] = t1 + p->l1 + t8 + t15;
    const lagc_real t16 = l2 * t4;
    const lagc_real t17 = l3 * t12;
    const lagc_real t18 = t7 * t13 + t9 * t12;
    const lagc_real t19 = l4 * t18;
    c[1] = t16 + t17 + t19;
    const lagc_real der_q1 = x[3];
    const lagc_real der_q2 = x[4];
    const lagc_real t20 = t10 * der_q1 + t11 * der_q2 + (t11 * der_q1 + t10 * der_q2);
    const lagc_real t21 = l3 * t20;
    const lagc_real t22 = t4 * der_q1;
    const lagc_real t23 = l2 * t22;
    const lagc_real t24 = t0 * der_q1;
    const lagc_real t25 = t2 * t24 - t6 * der_q2 + (t3 * der_q2 - t5 * t22);
    const lagc_real der_q3 = x[5];
    const lagc_real t26 = l4 * (t9 * t20 + (t13 * t25 + t18 * der_q3));
    c[2] = -(t21 + (t23 + t26));
    const lagc_real t27 = l3 * t25;
    const lagc_real t28 = l2 * t24;
    const lagc_real t29 = l4 * (t9 * t25 + t14 * der_q3 - t13 * t20);
    c[3] = t27 + (t28 + t29);
    const lagc_real t30 = t13 * l4;
    const lagc_real t31 = t2 * t30;
    const lagc_real t32 = l3 + t9 * l4;
    const lagc_real t33 = t5 * t32;
    const lagc_real t34 = t31 + t33;
    const lagc_real t35 = t5 * t30;
    const lagc_real t36 = t2 * t32;
    const lagc_real t37 = l2 - t35 + t36;
    J[0] = -(t0 * t34 + t4 * t37);
    const lagc_real t38 = t0 * t30;
    const lagc_real t39 = t38 + t4 * t32;
    const lagc_real t40 = t4 * t30;
    const lagc_real t41 = t0 * t32 - t40;
    J[1] = -(t2 * t39 + t5 * t41);
    const lagc_real t42 = -t19;
    J[2] = t42;
    J[11] = t42;
    J[3] = t0 * t37 - t4 * t34;
    J[4] = t2 * t41 - t5 * t39;
    const lagc_real t43 = der_q1 * t35;
    const lagc_real t44 = der_q2 * t35;
    const lagc_real t45 = der_q1 * t36;
    const lagc_real t46 = der_q2 * t32;
    const lagc_real t47 = t2 * t46;
    const lagc_real t48 = l2 * der_q1;
    const lagc_real t49 = l4 * der_q3;
    const lagc_real t50 = t9 * t49;
    const lagc_real t51 = t2 * t50;
    const lagc_real t52 = der_q3 * t35;
    const lagc_real t53 = der_q2 * t31;
    const lagc_real t54 = der_q1 * t31;
    const lagc_real t55 = t5 * t46;
    const lagc_real t56 = der_q1 * t33;
    const lagc_real t57 = t5 * t50;
    const lagc_real t58 = der_q3 * t31;
    const lagc_real t59 = t0 * (t43 + t44 - t45 - t47 - t48 - t51 + t52);
    J[6] = t59 + t4 * (t53 + t54 + t55 + t56 + t57 + t58);
    const lagc_real t60 = t22 * t30;
    const lagc_real t61 = der_q2 * t40;
    const lagc_real t62 = t0 * t46;
    const lagc_real t63 = t24 * t32;
    const lagc_real t64 = t0 * t50;
    const lagc_real t65 = der_q3 * t40;
    const lagc_real t66 = der_q2 * t38;
    const lagc_real t67 = t24 * t30;
    const lagc_real t68 = t22 * t32;
    const lagc_real t69 = t4 * t46;
    const lagc_real t70 = t4 * t50;
    const lagc_real t71 = der_q3 * t38;
    J[7] = t2 * (t60 + t61 - t62 - t63 - t64 + t65) + t5 * (t66 + t67 + t68 + t69 + t70 + t71);
    const lagc_real t72 = l4 * t20 + t12 * t49;
    const lagc_real t73 = t7 * t49 + l4 * t25;
    J[8] = t13 * t72 - t9 * t73;
    const lagc_real t74 = t11 * t32 + (t10 * t32 + t7 * t30);
    J[9] = -(t16 + t74);
    J[10] = -t74;
    const lagc_real t75 = t4 * (t47 + (t45 + (t48 + t51)) - t44 - t43 - t52);
    J[12] = -(t0 * (t56 + (t55 + (t54 + (t53 + (t57 + t58))))) + t75);
    const lagc_real t76 = t2 * (t69 + (t68 + (t66 + (t67 + (t70 + t71)))));
    J[13] = -(t76 + t5 * (t63 + (t62 + t64) - t60 - t61 - t65));
    J[14] = -(t9 * t72 + t13 * t73);
    const lagc_real t77 = t7 * t32;
    const lagc_real t78 = t10 * t30;
    const lagc_real t79 = t11 * t30;
    J[15] = t77 + (t1 - t78) - t79;
    J[16] = t77 - t78 - t79;
    sizes[0] = fabs(t1) + (fabs(t8) + fabs(t15)) + p->prepared[36];
    sizes[1] = fabs(t16) + fabs(t17) + fabs(t19);
    sizes[2] = fabs(t23) + (fabs(t21) + fabs(t26));
    sizes[3] = fabs(t28) + (fabs(t27) + fabs(t29));
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
