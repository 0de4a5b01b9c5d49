/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real q2 = x[1];
    lagc_real sc0[2]; lagc_sine_cosine(q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc1[0];
    const lagc_real q1 = x[0];
    lagc_real sc2[2]; lagc_sine_cosine(q1, sc2);
    const lagc_real t4 = sc2[0];
    const lagc_real t5 = sc2[1];
    const lagc_real l4 = p->l4;
    const lagc_real rho = p->rho;
    const lagc_real t6 = l4 * rho;
    const lagc_real l2 = p->l2;
    const lagc_real t7 = l2 * rho;
    const lagc_real l3 = p->l3;
    const lagc_real t8 = l3 * rho;
    const lagc_real t9 = l4 * t6;
    const lagc_real t10 = l3 * l3;
    const lagc_real t11 = t6 * t10;
    const lagc_real t12 = t9 * (l4 * 0.3333333333333333);
    const lagc_real t13 = l2 * t0;
    const lagc_real t14 = t1 * t9;
    const lagc_real t15 = t10 * (t8 * 0.3333333333333333) + t12;
    const lagc_real t16 = t13 * t14;
    const lagc_real t17 = l3 * t14;
    const lagc_real t18 = t13 * (l3 * t6);
    const lagc_real t19 = t0 * (t10 * t7);
    const lagc_real t20 = t2 * t3;
    const lagc_real t21 = t20 * (l2 * t9);
    const lagc_real t22 = t19 + (t15 + (t11 + (l2 * 0.3333333333333333 + (l3 + l4)) * (l2 * t7))) - t21;
    const lagc_real t23 = t22 + (2.0 * t18 + (t16 + t17));
    const lagc_real t24 = t16 * 0.5;
    const lagc_real t25 = 1.0 / t23;
    const lagc_real t26 = t17 + t11;
    const lagc_real t27 = t21 * 0.5;
    const lagc_real t28 = t4 * t0;
    const lagc_real t29 = t5 * t2;
    const lagc_real t30 = t0 * t5;
    const lagc_real t31 = t4 * t2;
    const lagc_real t32 = t26 - t27 + (t15 + t19 * 0.5 + (t18 + t24));
    const lagc_real der_q1 = x[3];
    /* der(q1) */
    xdot[0] = der_q1;
    const lagc_real t33 = der_q1 * der_q1;
    const lagc_real der_q2 = x[4];
    /* der(q2) */
    xdot[1] = der_q2;
    const lagc_real t34 = der_q2 * der_q2;
    const lagc_real t35 = der_q1 * der_q2;
    const lagc_real t36 = t25 * t32;
    const lagc_real t37 = t29 * t35;
    const lagc_real t38 = t28 * t35;
    const lagc_real t39 = t31 * t35;
    const lagc_real t40 = l4 * t1;
    const lagc_real t41 = t15 + t26;
    const lagc_real t42 = t12 + t17 * 0.5;
    const lagc_real t43 = l3 + t40;
    const lagc_real t44 = t30 - t31;
    const lagc_real t45 = t41 - t32 * t36;
    const lagc_real t46 = t28 + t29;
    const lagc_real der_q3 = x[5];
    /* der(q3) */
    xdot[2] = der_q3;
    const lagc_real t47 = der_q3 * der_q3;
    const lagc_real t48 = t42 + (t24 - t27);
    const lagc_real t49 = l4 * t3;
    const lagc_real t50 = 1.0 / t45;
    const lagc_real t51 = der_q1 * t29 + der_q2 * t28 + (der_q1 * t28 + der_q2 * t29);
    const lagc_real t52 = der_q3 * t3;
    const lagc_real t53 = der_q1 * t30 - der_q2 * t31 + (der_q2 * t30 - der_q1 * t31);
    const lagc_real t54 = 2.0 * (der_q3 * t1);
    const lagc_real t55 = t1 * t47;
    const lagc_real t56 = t28 * t33 + t37 + (t37 + t28 * t34) + (t29 * t34 + t38 + (t38 + t29 * t33));
    const lagc_real t57 = t30 * (2.0 * t35) - t31 * (t33 + t34) + (t30 * t34 - t39 + (t30 * t33 - t39));
    const lagc_real t58 = t25 * t48;
    const lagc_real t59 = t44 * t49;
    const lagc_real t60 = t51 * t52;
    const lagc_real t61 = t52 * t53;
    const lagc_real t62 = t59 + (t28 * t43 + t43 * t29);
    const lagc_real t63 = t42 - t32 * t58;
    const lagc_real t64 = l2 * t4 + t62;
    const lagc_real t65 = l2 * t33;
    const lagc_real t66 = l3 * t57;
    const lagc_real t67 = l3 * t56;
    const lagc_real t68 = t50 * t63;
    const lagc_real t69 = t64 * t25;
    const lagc_real t70 = t4 * t65;
    const lagc_real t71 = t5 * t65;
    const lagc_real t72 = l4 * 0.5;
    const lagc_real t73 = t29 * t49 + t28 * t49;
    const lagc_real t74 = t7 * 0.25;
    const lagc_real t75 = t43 * t44 - t73;
    const lagc_real t76 = t12 - t48 * t58 - t63 * t68;
    const lagc_real t77 = t69 * t32 - t62;
    const lagc_real t78 = (t60 - t44 * t55 - t1 * t57 + (t3 * (t56 + t46 * t47) + (t60 - t53 * t54))) * t72;
    const lagc_real t79 = t78 - (t71 + t66);
    const lagc_real t80 = t8 * (t71 + 0.5 * t66);
    const lagc_real t81 = t8 * (t70 + 0.5 * t67);
    const lagc_real t82 = t72 * (t1 * t56 + (t61 + t46 * t55) + (t3 * (t57 + t44 * t47) + (t61 + t51 * t54)));
    const lagc_real t83 = t82 + (t70 + t67);
    const lagc_real t84 = l2 * t5 + t75;
    const lagc_real t85 = 1.0 / t76;
    const lagc_real t86 = t59 + t40 * t46;
    const lagc_real t87 = t77 * t50;
    const lagc_real t88 = t0 * t3 + t1 * t2;
    const lagc_real t89 = t0 * t1 - t20;
    const lagc_real t90 = t6 * t79;
    const lagc_real t91 = t6 * t83;
    const lagc_real t92 = t25 * t84;
    const lagc_real t93 = t1 * t83 + t3 * t79;
    const lagc_real t94 = t9 * 0.5;
    const lagc_real t95 = t1 * t79;
    const lagc_real t96 = t3 * t83;
    const lagc_real t97 = t69 * t48 - t86 - t63 * t87;
    const lagc_real t98 = t5 * t89 - t4 * t88;
    const lagc_real t99 = t75 - t92 * t32;
    const lagc_real t100 = t97 * t85;
    const lagc_real t101 = t5 * t88 + t4 * t89;
    const lagc_real t102 = der_q2 * 2.0;
    const lagc_real t103 = l3 * (t91 + 0.5 * t81) + t93 * t94;
    const lagc_real t104 = der_q2 * t98;
    const lagc_real t105 = der_q3 * t98;
    const lagc_real t106 = t99 * t50;
    const lagc_real t107 = t40 * t44 - t73;
    const lagc_real t108 = der_q2 * t101;
    const lagc_real t109 = der_q3 * t101;
    const lagc_real t110 = t31 * t103;
    const lagc_real t111 = l3 * (t90 - 0.5 * t80) + t94 * (t95 - t96);
    const lagc_real t112 = t28 * t111;
    const lagc_real t113 = t107 - t92 * t48 - t106 * t63;
    const lagc_real t114 = 1.0 / (t97 * t100 + (t64 * t69 + t77 * t87));
    const lagc_real t115 = t30 * t103 + t29 * t111;
    const lagc_real t116 = t113 * t85;
    const lagc_real t117 = l2 * (t4 * (t71 * t74 + t80 - t90) - t5 * (t91 + (t70 * t74 + t81))) + t110 - t112;
    const lagc_real t118 = t117 - t115;
    const lagc_real t119 = t115 + (t112 - t110);
    const lagc_real t120 = der_q1 * (2.0 * (t104 + t105) + der_q1 * t98);
    const lagc_real t121 = t64 * t92 - t77 * t106 - t97 * t116;
    const lagc_real t122 = der_q1 * (2.0 * (t108 + t109) + der_q1 * t101);
    const lagc_real t123 = t119 + t36 * t118;
    const lagc_real t124 = t94 * (t44 * t93 + (t46 * t95 - t46 * t96));
    const lagc_real t125 = t121 * t114;
    const lagc_real t126 = t71 + l3 * (der_q1 * (der_q1 * t44 + t44 * t102) + t44 * t34);
    const lagc_real t127 = l4 * (t120 + (der_q2 * (t104 + 2.0 * t105) + t47 * t98)) + t126;
    const lagc_real t128 = t113 * t116 + (t84 * t92 + t99 * t106);
    const lagc_real t129 = t70 + l3 * (der_q1 * (der_q1 * t46 + t46 * t102) + t46 * t34);
    const lagc_real t130 = l4 * (t122 + (der_q2 * (t108 + 2.0 * t109) + t101 * t47)) + t129;
    const lagc_real t131 = t124 + t58 * t118 - t68 * t123;
    const lagc_real t132 = t121 * t125 - t128;
    const lagc_real t133 = 1.0 / t132;
    const lagc_real t134 = t127 - t69 * t118 - t87 * t123 - t100 * t131;
    const lagc_real t135 = t133 * (t125 * t134 + (t130 + t92 * t118 - t106 * t123 - t116 * t131));
    const lagc_real t136 = t125 * t135 - t114 * t134;
    const lagc_real t137 = t85 * t131 - t116 * t135 - t100 * t136;
    /* der(der(q3)) */
    xdot[5] = t137;
    const lagc_real t138 = t50 * t123 - t106 * t135 - t87 * t136 - t68 * t137;
    /* der(der(q2)) */
    xdot[4] = t138;
    const lagc_real t139 = t69 * t136 - (t25 * t118 + t92 * t135) - t58 * t137 - t36 * t138;
    /* der(der(q1)) */
    xdot[3] = t139;
    const lagc_real t140 = t41 * t138;
    const lagc_real t141 = t12 * t137;
    const lagc_real t142 = t23 * t139;
    const lagc_real t143 = t64 * t136 - (t118 + t84 * t135) - t48 * t137 - t32 * t138 - t142;
    const lagc_real t144 = t62 * t136 + (t119 - t75 * t135) - t42 * t137 - t140 - t32 * t139;
    const lagc_real t145 = t86 * t136 + (t124 - t107 * t135) - t141 - t42 * t138 - t48 * t139;
    const lagc_real t146 = t64 * t139 + (t62 * t138 + (t127 + t86 * t137));
    const lagc_real t147 = t130 - t107 * t137 - t75 * t138 - t84 * t139;
    const lagc_real t148 = t114 * (t127 * t127) + 1e-300 - t133 * (t130 * t130);
    const lagc_real t149 = t143 * (t25 * t143) + t144 * (t50 * t144) - t147 * (t133 * t147);
    const lagc_real t150 = t50 * (t119 * t119 + t140 * t140) + (t85 * (t124 * t124 + t141 * t141) + t148);
    const lagc_real t151 = t145 * (t85 * t145) + t146 * (t114 * t146) + t149;
    health[1] = t151 / (t25 * (t118 * t118 + t142 * t142) + t150);
    health[0] = lagc_min(lagc_min(t45 / t41, t76 / t12), -(t132 / t128));
    /* ring[1], four_bar.lag:32 */
    lam[0] = -t136;
    /* ring[2], four_bar.lag:32 */
    lam[1] = -t135;
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
    const lagc_real l3 = p->l3;
    const lagc_real rho = p->rho;
    const lagc_real t0 = l3 * rho;
    const lagc_real t1 = l3 * t0;
    const lagc_real l4 = p->l4;
    const lagc_real t2 = l4 * rho;
    const lagc_real t3 = l4 * t2;
    const lagc_real t4 = l4 * t3;
    const lagc_real t5 = 0.08333333333333333 * t4;
    const lagc_real t6 = l3 * t1 * 0.08333333333333333 + t5;
    const lagc_real l2 = p->l2;
    const lagc_real t7 = rho * (l2 * l2);
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t8 = sc0[1];
    const lagc_real t9 = t8 * t7;
    const lagc_real t10 = l2 * t8;
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t11 = sc1[1];
    const lagc_real t12 = t8 * t11;
    const lagc_real t13 = sc0[0];
    const lagc_real t14 = sc1[0];
    const lagc_real t15 = t13 * t14;
    const lagc_real t16 = t12 - t15;
    const lagc_real t17 = l3 * t16;
    const lagc_real t18 = t0 * (t10 + t17 * 0.5);
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t19 = sc2[1];
    const lagc_real t20 = t8 * t14;
    const lagc_real t21 = t13 * t11;
    const lagc_real t22 = t20 + t21;
    const lagc_real t23 = sc2[0];
    const lagc_real t24 = t22 * t23;
    const lagc_real t25 = t16 * t19 - t24;
    const lagc_real t26 = l4 * t25;
    G[5] = t26;
    const lagc_real t27 = t26 * 0.5;
    const lagc_real t28 = t17 + (t10 + t27);
    const lagc_real t29 = t2 * t28;
    const lagc_real t30 = t13 * t7;
    const lagc_real t31 = l2 * t13;
    const lagc_real t32 = l3 * t22;
    const lagc_real t33 = t0 * (t31 + 0.5 * t32);
    const lagc_real t34 = t22 * t19;
    const lagc_real t35 = t16 * t23 + t34;
    const lagc_real t36 = l4 * t35;
    const lagc_real t37 = 0.5 * t36;
    const lagc_real t38 = t32 + (t31 + t37);
    const lagc_real t39 = t2 * t38;
    const lagc_real t40 = 0.08333333333333333 * t7 + t8 * (t9 * 0.25 + (t18 + t29));
    const lagc_real t41 = l3 * (0.5 * t18 + t29) + 0.5 * (t3 * (t23 * t38 + t19 * t28));
    const lagc_real t42 = 0.5 * (t3 * (t23 * t28 - t19 * t38)) - l3 * (0.5 * t33 + t39);
    const lagc_real t43 = l2 * (t40 + t13 * (t30 * 0.25 + (t33 + t39))) + t8 * (t11 * t41 - t14 * t42);
    M[0] = t6 + (t43 - t13 * (t14 * t41 + t11 * t42));
    const lagc_real t44 = t17 + t27;
    const lagc_real t45 = t2 * t44;
    const lagc_real t46 = t16 * t1;
    const lagc_real t47 = t32 + t37;
    const lagc_real t48 = t16 * (l3 * (t45 + 0.25 * t46) + 0.5 * (t3 * (t23 * t47 + t19 * t44)));
    const lagc_real t49 = t2 * t47;
    const lagc_real t50 = t22 * t1;
    const lagc_real t51 = 0.5 * (t3 * (t23 * t44 - t19 * t47)) - l3 * (t49 + 0.25 * t50);
    const lagc_real t52 = t20 * t51;
    const lagc_real t53 = t21 * t51;
    M[1] = t48 + (t6 - t52) - t53 + l2 * (t8 * (0.5 * t46 + t45) + t13 * (0.5 * t50 + t49));
    M[2] = t6 + t48 - t52 - t53;
    const lagc_real t54 = t23 * t35 + t19 * t25;
    const lagc_real t55 = t3 * (t16 * (0.25 * (l4 * t54) + 0.5 * (l3 * t25)));
    const lagc_real t56 = t3 * (0.25 * (l4 * (t23 * t25 - t19 * t35)) - 0.5 * (l3 * t35));
    const lagc_real t57 = t20 * t56;
    const lagc_real t58 = t21 * t56;
    M[3] = t55 + (t5 - t57) - t58 + 0.5 * (t3 * (l2 * (t8 * t25 + t13 * t35)));
    M[4] = t5 + t55 - t57 - t58;
    M[5] = t5 + 0.25 * (t4 * (t16 * t54 - t24 * t25 + t34 * t35));
    const lagc_real t59 = der_q1 * der_q1;
    const lagc_real t60 = der_q1 * t20 + der_q2 * t21 + (der_q1 * t21 + der_q2 * t20);
    const lagc_real t61 = der_q3 * t23;
    const lagc_real t62 = t60 * t61;
    const lagc_real t63 = der_q1 * t12 - der_q2 * t15 + (der_q2 * t12 - der_q1 * t15);
    const lagc_real t64 = der_q3 * t19;
    const lagc_real t65 = der_q3 * t16;
    const lagc_real t66 = der_q1 * der_q2;
    const lagc_real t67 = t20 * t66;
    const lagc_real t68 = der_q2 * der_q2;
    const lagc_real t69 = t21 * t66;
    const lagc_real t70 = t21 * t59 + (t67 + (t67 + t21 * t68)) + (t20 * t68 + (t69 + (t20 * t59 + t69)));
    const lagc_real t71 = t15 * t66;
    const lagc_real t72 = t12 * t68 - t71 + (t12 * t59 - t71 + (t12 * t66 * 2.0 - t15 * (t59 + t68)));
    const lagc_real t73 = t23 * (t70 + t22 * (der_q3 * der_q3)) - t19 * t72;
    const lagc_real t74 = l4 * (t62 - t63 * t64 * 2.0 - (t64 * t65 - t62) + t73);
    const lagc_real t75 = t10 * t59;
    const lagc_real t76 = l3 * t72;
    const lagc_real t77 = t75 + t76;
    const lagc_real t78 = 0.5 * t74 - t77;
    const lagc_real t79 = t2 * t78;
    const lagc_real t80 = t0 * (t75 + 0.5 * t76);
    const lagc_real t81 = t31 * t59;
    const lagc_real t82 = l3 * t70;
    const lagc_real t83 = t0 * (t81 + 0.5 * t82);
    const lagc_real t84 = t81 + t82;
    const lagc_real t85 = t63 * t61;
    const lagc_real t86 = t85 + (t85 + t64 * (der_q3 * t22)) + t60 * t64 * 2.0;
    const lagc_real t87 = l4 * (t86 + (t19 * t70 + t23 * (t72 + der_q3 * t65)));
    const lagc_real t88 = t84 + 0.5 * t87;
    const lagc_real t89 = t2 * t88;
    const lagc_real t90 = l3 * (t79 - 0.5 * t80) + 0.5 * (t3 * (t19 * t78 - t23 * t88));
    const lagc_real t91 = t19 * t88 + t23 * t78;
    const lagc_real t92 = t21 * t90 + (t16 * (l3 * (t89 + 0.5 * t83) + 0.5 * (t3 * t91)) + t20 * t90);
    r[1] = t92;
    const lagc_real t93 = l2 * (t13 * (0.25 * (t59 * t9) - (t79 - t80)) - t8 * (0.25 * (t59 * t30) + (t83 + t89)));
    r[0] = -(t93 - t92);
    r[2] = -(0.5 * (t3 * (t24 * t88 - t16 * t91 - t34 * t78)));
    const lagc_real t94 = l3 + l4 * t19;
    const lagc_real t95 = l4 * t23;
    const lagc_real t96 = t21 * t94 + (t20 * t94 + t16 * t95);
    G[0] = -(t31 + t96);
    G[1] = -t96;
    G[2] = -t36;
    const lagc_real t97 = t16 * t94;
    const lagc_real t98 = t20 * t95;
    const lagc_real t99 = t21 * t95;
    G[3] = t97 + (t10 - t98) - t99;
    G[4] = t97 - t98 - t99;
    gamma[0] = -(t74 - t77);
    gamma[1] = t87 + t84;
    (void)(t);
}

/* entries of [M G^T; G 0] into w */
static void lagc_fn_assemble(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *w)
{
    const lagc_real l2 = p->l2;
    const lagc_real q2 = x[1];
    lagc_real sc0[2]; lagc_sine_cosine(q2, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = l2 * t0;
    const lagc_real l4 = p->l4;
    const lagc_real rho = p->rho;
    const lagc_real t2 = l4 * rho;
    const lagc_real q3 = x[2];
    lagc_real sc1[2]; lagc_sine_cosine(q3, sc1);
    const lagc_real t3 = l4 * sc1[1];
    const lagc_real t4 = t1 * (t2 * t3);
    const lagc_real l3 = p->l3;
    const lagc_real t5 = l3 * t2;
    const lagc_real t6 = t3 * t5;
    const lagc_real t7 = t1 * t5;
    const lagc_real t8 = l3 * l3;
    const lagc_real t9 = t8 * t2;
    const lagc_real t10 = rho * t8;
    const lagc_real t11 = t10 * t1;
    const lagc_real t12 = t2 * (l4 * l4) * 0.3333333333333333;
    w[5] = t12;
    const lagc_real t13 = l3 * t10 * 0.3333333333333333 + t12;
    const lagc_real t14 = l4 * sc1[0];
    const lagc_real t15 = sc0[0];
    const lagc_real t16 = t14 * (t2 * (l2 * t15));
    const lagc_real t17 = (l3 + (l4 + l2 * 0.3333333333333333)) * (rho * (l2 * l2));
    w[0] = t4 + (t6 + (t7 * 2.0 + (t9 + (t11 + (t13 - t16))))) + t17;
    const lagc_real t18 = t4 * 0.5;
    const lagc_real t19 = t9 + t6;
    const lagc_real t20 = t16 * 0.5;
    w[1] = t11 * 0.5 + (t18 + (t13 + (t7 + t19) - t20));
    w[2] = t13 + t19;
    const lagc_real t21 = t6 * 0.5;
    w[3] = t21 + (t18 + (t12 - t20));
    w[4] = t12 + t21;
    const lagc_real q1 = x[0];
    lagc_real sc2[2]; lagc_sine_cosine(q1, sc2);
    const lagc_real t22 = sc2[0];
    const lagc_real t23 = t22 * t0;
    const lagc_real t24 = l3 + t3;
    const lagc_real t25 = sc2[1];
    const lagc_real t26 = t25 * t15;
    const lagc_real t27 = t25 * t0 - t22 * t15;
    const lagc_real t28 = t27 * t14;
    const lagc_real t29 = t23 * t24 + (t26 * t24 + t28);
    w[6] = -(l2 * t22 + t29);
    w[7] = -t29;
    w[8] = -((t26 + t23) * t3 + t28);
    const lagc_real t30 = t26 * t14;
    const lagc_real t31 = t23 * t14;
    const lagc_real t32 = t27 * t24 - t30 - t31;
    w[10] = t32;
    w[9] = l2 * t25 + t32;
    w[11] = t27 * t3 - (t30 + t31);
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
    const lagc_real l4 = p->l4;
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
    const lagc_real t6 = t0 * t3 + t2 * t1;
    const lagc_real t7 = sc2[0];
    const lagc_real l2 = p->l2;
    const lagc_real l3 = p->l3;
    /* ring[1], four_bar.lag:32 */
    phi[0] = p->l1 + (l4 * (t4 * t5 - t6 * t7) + (l2 * t0 + l3 * t4));
    /* ring[2], four_bar.lag:32 */
    phi[1] = l2 * t2 + l3 * t6 + l4 * (t4 * t7 + t6 * t5);
    (void)(t);
}

/* rates of the constraint rows */
static void lagc_fn_velocity(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *psi)
{
    const lagc_real l3 = p->l3;
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
    const lagc_real t6 = der_q1 * t2 + der_q2 * t5 + (der_q1 * t5 + der_q2 * t2);
    const lagc_real t7 = p->l2 * der_q1;
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t8 = sc2[1];
    const lagc_real t9 = sc2[0];
    const lagc_real t10 = t0 * t4;
    const lagc_real t11 = t3 * t1;
    const lagc_real t12 = der_q1 * t10 - der_q2 * t11 + (der_q2 * t10 - der_q1 * t11);
    const lagc_real der_q3 = x[5];
    const lagc_real t13 = t10 - t11;
    const lagc_real t14 = t2 + t5;
    /* ring[1], four_bar.lag:32 */
    psi[0] = -(l3 * t6 + (t3 * t7 + l4 * (t8 * t6 + (t9 * t12 + der_q3 * (t13 * t9 + t14 * t8)))));
    /* ring[2], four_bar.lag:32 */
    psi[1] = l3 * t12 + (t0 * t7 + l4 * (t8 * t12 + der_q3 * (t13 * t8 - t14 * t9) - t9 * t6));
    (void)(t);
}

/* size of the terms of each constraint row */
static void lagc_fn_scales(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real l2 = p->l2;
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real l3 = p->l3;
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t1 = sc1[1];
    const lagc_real t2 = sc0[0];
    const lagc_real t3 = sc1[0];
    const lagc_real t4 = t0 * t1 - t2 * t3;
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = t0 * t3 + t2 * t1;
    const lagc_real t7 = sc2[0];
    const lagc_real t8 = fabs(p->l1) + fabs(l2 * t0) + fabs(l3 * t4) + fabs(l4 * (t4 * t5 - t6 * t7)) + 1e-300;
    s[0] = t8;
    const lagc_real t9 = fabs(l4 * (t4 * t7 + t6 * t5)) + (fabs(l3 * t6) + (1e-300 + fabs(l2 * t2)));
    s[1] = lagc_max(t9, lagc_max(t8, t9) * 1e-06);
    (void)(t);
}

/* size of the terms of each row's gamma */
static void lagc_fn_gamma_sizes(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *s)
{
    const lagc_real t0 = fabs(p->l3);
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t1 = fabs(sc0[1]);
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t2 = fabs(sc1[1]);
    const lagc_real t3 = t1 * t2;
    const lagc_real t4 = fabs(x[3]);
    const lagc_real t5 = fabs(x[4]);
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = fabs(sc0[0]);
    const lagc_real t8 = fabs(sc1[0]);
    const lagc_real t9 = t7 * t8;
    const lagc_real t10 = t3 + t9;
    const lagc_real t11 = t4 * t4;
    const lagc_real t12 = t5 * t5;
    const lagc_real t13 = t3 * t6 * 2.0 + t9 * t6 * 2.0 + (t10 * t11 + t10 * t12);
    const lagc_real t14 = t7 * t2;
    const lagc_real t15 = fabs(x[5]);
    const lagc_real t16 = fabs(p->l4);
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t17 = fabs(sc2[0]);
    const lagc_real t18 = t16 * t17;
    const lagc_real t19 = t15 * t18;
    const lagc_real t20 = t14 * t19 * 2.0;
    const lagc_real t21 = t1 * t8;
    const lagc_real t22 = t21 * t19 * 2.0;
    const lagc_real t23 = fabs(sc2[1]);
    const lagc_real t24 = t15 * t23;
    const lagc_real t25 = t16 * t24;
    const lagc_real t26 = t9 * t25 * 2.0;
    const lagc_real t27 = t3 * t25 * 2.0;
    const lagc_real t28 = t0 + t16 * t23;
    const lagc_real t29 = t4 * t28;
    const lagc_real t30 = 2.0 * (t9 * t29);
    const lagc_real t31 = t5 * t28;
    const lagc_real t32 = 2.0 * (t3 * t31);
    const lagc_real t33 = t4 * t18;
    const lagc_real t34 = t14 * t33 * 2.0;
    const lagc_real t35 = t5 * t18;
    const lagc_real t36 = t21 * t35 * 2.0;
    const lagc_real t37 = t14 * t35 * 2.0;
    const lagc_real t38 = t21 * t33 * 2.0;
    const lagc_real t39 = 2.0 * (t9 * t31);
    const lagc_real t40 = 2.0 * (t3 * t29);
    const lagc_real t41 = t22 + (t26 + (t27 + (t30 + (t32 + (t34 + (t36 + (t37 + (t38 + (t39 + t40)))))))));
    const lagc_real t42 = t4 * t10 + t5 * t10;
    const lagc_real t43 = t21 + t14;
    const lagc_real t44 = t4 * t43 + t5 * t43;
    const lagc_real t45 = t15 * t17;
    const lagc_real t46 = t21 * t6 * 2.0 + t14 * t6 * 2.0 + (t43 * t11 + t43 * t12);
    const lagc_real t47 = t43 * t17 + t10 * t23;
    const lagc_real t48 = t15 * t15;
    const lagc_real t49 = 2.0 * (t24 * t42) + 2.0 * (t44 * t45) + (t23 * t13 + (t17 * t46 + t47 * t48));
    const lagc_real t50 = t26 + (t40 + (t39 + (t38 + (t37 + (t36 + (t34 + (t32 + (t30 + (t27 + t22)))))))));
    const lagc_real t51 = fabs(p->l2) * t4;
    const lagc_real t52 = t16 * (t49 + 2.0 * (t15 * (t15 * t47 + t17 * t44 + t23 * t42)));
    s[0] = t0 * t13 + (t5 * (t20 + t41) + (t52 + t4 * (t20 + t50 + t1 * t51 * 3.0)));
    const lagc_real t53 = 2.0 * (t14 * t25);
    const lagc_real t54 = 2.0 * (t21 * t25);
    const lagc_real t55 = 2.0 * (t9 * t19);
    const lagc_real t56 = 2.0 * (t3 * t19);
    const lagc_real t57 = 2.0 * (t9 * t33);
    const lagc_real t58 = 2.0 * (t3 * t35);
    const lagc_real t59 = 2.0 * (t14 * t29);
    const lagc_real t60 = 2.0 * (t21 * t31);
    const lagc_real t61 = 2.0 * (t14 * t31);
    const lagc_real t62 = 2.0 * (t21 * t29);
    const lagc_real t63 = 2.0 * (t9 * t35);
    const lagc_real t64 = 2.0 * (t3 * t33);
    const lagc_real t65 = t54 + (t55 + (t56 + (t57 + (t58 + (t59 + (t60 + (t61 + (t62 + (t63 + t64)))))))));
    const lagc_real t66 = t43 * t23 + t10 * t17;
    const lagc_real t67 = 2.0 * (t42 * t45) + 2.0 * (t24 * t44) + (t17 * t13 + (t23 * t46 + t48 * t66));
    const lagc_real t68 = t55 + (t64 + (t63 + (t62 + (t61 + (t60 + (t59 + (t58 + (t57 + (t56 + t54)))))))));
    const lagc_real t69 = t16 * (t67 + 2.0 * (t15 * (t15 * t66 + t23 * t44 + t17 * t42)));
    s[1] = t0 * t46 + (t5 * (t53 + t65) + (t69 + t4 * (t53 + t68 + t7 * t51 * 3.0)));
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
    const lagc_real t3 = fabs(p->l4);
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t4 = fabs(sc2[1]);
    const lagc_real t5 = fabs(p->l3) + t3 * t4;
    const lagc_real t6 = t2 * t5;
    const lagc_real t7 = fabs(sc0[1]);
    const lagc_real t8 = fabs(sc1[0]);
    const lagc_real t9 = t7 * t1 + t0 * t8;
    const lagc_real t10 = fabs(sc2[0]);
    const lagc_real t11 = t3 * t10;
    const lagc_real t12 = t9 * t11;
    const lagc_real t13 = t7 * t8;
    const lagc_real t14 = t13 * t5;
    const lagc_real t15 = fabs(p->l2);
    const lagc_real t16 = t13 + t2;
    s[0] = t6 + (t12 + (t14 + (t6 + (t12 + t14)))) + (t15 * t0 + t3 * (t16 * t4 + t9 * t10));
    const lagc_real t17 = t2 * t11;
    const lagc_real t18 = t9 * t5;
    const lagc_real t19 = t13 * t11;
    s[1] = t17 + (t18 + (t19 + (t17 + (t19 + t18)))) + (t15 * t7 + t3 * (t16 * t10 + t9 * t4));
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
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t2 = sc2[0];
    const lagc_real t3 = l4 * t2;
    const lagc_real t4 = sc1[0];
    const lagc_real l3 = p->l3;
    const lagc_real t5 = sc2[1];
    const lagc_real t6 = l3 + l4 * t5;
    const lagc_real t7 = t1 * t3 + t4 * t6;
    const lagc_real t8 = sc0[0];
    const lagc_real t9 = t1 * t6 - t4 * t3;
    const lagc_real t10 = t0 * t3 + t8 * t6;
    const lagc_real l2 = p->l2;
    const lagc_real t11 = l2 - t8 * t3 + t0 * t6;
    const lagc_real t12 = t1 * t0 - t4 * t8;
    const lagc_real t13 = t1 * t8;
    const lagc_real t14 = t4 * t0;
    const lagc_real t15 = t13 + t14;
    const lagc_real t16 = t12 * t2 + t15 * t5;
    const lagc_real t17 = fabs(l4 * t16);
    const lagc_real t18 = 1e-300 + size0 * (fabs(t0 * t7 + t8 * t9) + (fabs(t1 * t10 + t4 * t11) + t17));
    s[0] = t18;
    const lagc_real t19 = t12 * t5 - t15 * t2;
    const lagc_real t20 = fabs(l4 * t19);
    const lagc_real t21 = 1e-300 + size0 * (fabs(t0 * t9 - t8 * t7) + (fabs(t1 * t11 - t4 * t10) + t20));
    s[1] = lagc_max(t21, lagc_max(t18, t21) * 1e-06);
    const lagc_real size1 = c[1];
    const lagc_real t22 = t14 * t6 + (t13 * t6 + t12 * t3);
    const lagc_real t23 = l2 * t4;
    const lagc_real t24 = lagc_max(0.0, size1);
    const lagc_real t25 = l2 * t1;
    const lagc_real t26 = l3 * t24;
    const lagc_real t27 = l4 * t24;
    const lagc_real t28 = fabs(p->l1 * t24) + (fabs(t25 * t24) + (fabs(t12 * t26) + (1e-300 + fabs(t19 * t27))));
    const lagc_real t29 = size1 * (fabs(t22) + (t17 + fabs(t23 + t22))) + t28;
    s[2] = t29;
    const lagc_real t30 = t12 * t6 - t13 * t3 - t14 * t3;
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
    const lagc_real l2 = p->l2;
    const lagc_real der_q1 = x[3];
    const lagc_real t1 = l2 * der_q1;
    const lagc_real t2 = t0 * t1;
    const lagc_real l3 = p->l3;
    const lagc_real t3 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t4 = sc1[0];
    const lagc_real t5 = t3 * t4;
    const lagc_real der_q2 = x[4];
    const lagc_real t6 = sc1[1];
    const lagc_real t7 = t0 * t6;
    const lagc_real t8 = der_q1 * t5 + der_q2 * t7 + (der_q1 * t7 + der_q2 * t5);
    const lagc_real t9 = l3 * t8;
    const lagc_real t10 = t2 + t9 * 0.5;
    const lagc_real t11 = t3 * t1;
    const lagc_real t12 = t3 * t6;
    const lagc_real t13 = t0 * t4;
    const lagc_real t14 = der_q1 * t12 - der_q2 * t13 + (der_q2 * t12 - der_q1 * t13);
    const lagc_real t15 = l3 * t14;
    const lagc_real t16 = t11 + 0.5 * t15;
    const lagc_real rho = p->rho;
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t17 = sc2[1];
    const lagc_real t18 = sc2[0];
    const lagc_real der_q3 = x[5];
    const lagc_real t19 = t12 - t13;
    const lagc_real t20 = t5 + t7;
    const lagc_real t21 = t2 + t9 + 0.5 * (l4 * (t17 * t8 + (t18 * t14 + der_q3 * (t19 * t18 + t20 * t17))));
    const lagc_real t22 = t11 + t15 + 0.5 * (l4 * (t17 * t14 + der_q3 * (t19 * t17 - t20 * t18) - t18 * t8));
    const lagc_real t23 = 0.5 * ((t10 * t10 + t16 * t16) * (l3 * rho));
    const lagc_real t24 = der_q1 + der_q2;
    const lagc_real t25 = l3 * t24;
    const lagc_real t26 = l4 * (der_q3 + t24);
    const lagc_real t27 = (t25 * (l3 * t25) + t26 * (l4 * t26)) * 0.041666666666666664;
    const lagc_real t28 = t23 + 0.5 * ((t21 * t21 + t22 * t22) * (l4 * rho));
    const lagc_real t29 = t28 + rho * (t27 + t1 * (l2 * t1) * 0.16666666666666666);
    /* kinetic energy */
    e[0] = t29;
    /* energy of the balance */
    e[2] = t29;
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
    const lagc_real l2 = p->l2;
    const lagc_real der_q1 = x[3];
    const lagc_real t1 = l2 * der_q1;
    const lagc_real t2 = t0 * t1;
    const lagc_real l3 = p->l3;
    const lagc_real t3 = sc0[1];
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t4 = sc1[0];
    const lagc_real t5 = t3 * t4;
    const lagc_real der_q2 = x[4];
    const lagc_real t6 = sc1[1];
    const lagc_real t7 = t0 * t6;
    const lagc_real t8 = der_q1 * t5 + der_q2 * t7 + (der_q1 * t7 + der_q2 * t5);
    const lagc_real t9 = l3 * t8;
    const lagc_real t10 = t2 + t9 * 0.5;
    const lagc_real t11 = t3 * t1;
    const lagc_real t12 = t3 * t6;
    const lagc_real t13 = t0 * t4;
    const lagc_real t14 = der_q1 * t12 - der_q2 * t13 + (der_q2 * t12 - der_q1 * t13);
    const lagc_real t15 = l3 * t14;
    const lagc_real t16 = t11 + 0.5 * t15;
    const lagc_real rho = p->rho;
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t17 = sc2[1];
    const lagc_real t18 = sc2[0];
    const lagc_real der_q3 = x[5];
    const lagc_real t19 = t12 - t13;
    const lagc_real t20 = t5 + t7;
    const lagc_real t21 = t2 + t9 + 0.5 * (l4 * (t17 * t8 + (t18 * t14 + der_q3 * (t19 * t18 + t20 * t17))));
    const lagc_real t22 = t11 + t15 + 0.5 * (l4 * (t17 * t14 + der_q3 * (t19 * t17 - t20 * t18) - t18 * t8));
    const lagc_real t23 = 0.5 * ((t10 * t10 + t16 * t16) * (l3 * rho));
    const lagc_real t24 = der_q1 + der_q2;
    const lagc_real t25 = l3 * t24;
    const lagc_real t26 = l4 * (der_q3 + t24);
    const lagc_real t27 = (t25 * (l3 * t25) + t26 * (l4 * t26)) * 0.041666666666666664;
    const lagc_real t28 = t23 + 0.5 * ((t21 * t21 + t22 * t22) * (l4 * rho));
    /* E */
    y[5] = t28 + rho * (t27 + t1 * (l2 * t1) * 0.16666666666666666);
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
    const lagc_real l1 = p->l1;
    const lagc_real l2 = p->l2;
    const lagc_real q1 = x[0];
    lagc_real sc0[2]; lagc_sine_cosine(q1, sc0);
    const lagc_real t0 = sc0[1];
    const lagc_real t1 = l2 * t0;
    const lagc_real l3 = p->l3;
    const lagc_real q2 = x[1];
    lagc_real sc1[2]; lagc_sine_cosine(q2, sc1);
    const lagc_real t2 = sc1[1];
    const lagc_real t3 = t0 * t2;
    const lagc_real t4 = sc0[0];
    const lagc_real t5 = sc1[0];
    const lagc_real t6 = t4 * t5;
    const lagc_real t7 = t3 - t6;
    const lagc_real t8 = l3 * t7;
    const lagc_real l4 = p->l4;
    const lagc_real q3 = x[2];
    lagc_real sc2[2]; lagc_sine_cosine(q3, sc2);
    const lagc_real t9 = sc2[1];
    const lagc_real t10 = t0 * t5;
    const lagc_real t11 = t4 * t2;
    const lagc_real t12 = t10 + t11;
    const lagc_real t13 = sc2[0];
    const lagc_real t14 = t7 * t9 - t12 * t13;
    const lagc_real t15 = l4 * t14;
    J[5] = t15;
    J[17] = t15;
    c[0] = l1 + t1 + t8 + t15;
    const lagc_real t16 = l2 * t4;
    const lagc_real t17 = l3 * t12;
    const lagc_real t18 = t7 * t13 + t12 * t9;
    const lagc_real t19 = l4 * t18;
    c[1] = t16 + t17 + t19;
    const lagc_real der_q1 = x[3];
    const lagc_real der_q2 = x[4];
    const lagc_real t20 = der_q1 * t10 + der_q2 * t11 + (der_q1 * t11 + der_q2 * t10);
    const lagc_real t21 = l3 * t20;
    const lagc_real t22 = der_q1 * t4;
    const lagc_real t23 = l2 * t22;
    const lagc_real t24 = der_q1 * t0;
    const lagc_real t25 = t2 * t24 - der_q2 * t6 + (der_q2 * t3 - t5 * t22);
    const lagc_real der_q3 = x[5];
    const lagc_real t26 = l4 * (t9 * t20 + (t13 * t25 + der_q3 * t18));
    c[2] = -(t21 + (t23 + t26));
    const lagc_real t27 = l3 * t25;
    const lagc_real t28 = l2 * t24;
    const lagc_real t29 = l4 * (t9 * t25 + der_q3 * t14 - t13 * t20);
    c[3] = t27 + (t28 + t29);
    const lagc_real t30 = l4 * t13;
    const lagc_real t31 = t2 * t30;
    const lagc_real t32 = l3 + l4 * t9;
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
    sizes[0] = fabs(l1) + fabs(t1) + fabs(t8) + fabs(t15);
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
