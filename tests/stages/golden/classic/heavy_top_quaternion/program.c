/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real field_g = p->field_g;
    prepared[12] = field_g;
    const lagc_real m = p->m;
    prepared[8] = m;
    const lagc_real d_ = p->d;
    prepared[9] = d_;
    const lagc_real t0 = m * d_;
    const lagc_real t1 = field_g * t0;
    prepared[0] = t1;
    const lagc_real t2 = d_ * t0;
    const lagc_real t3 = t2 * 4.0;
    prepared[1] = t3;
    prepared[2] = t2 * 2.0;
    const lagc_real I2 = p->I2;
    prepared[11] = I2;
    const lagc_real I1 = p->I1;
    prepared[10] = I1;
    prepared[3] = I2 - I1;
    prepared[4] = 1.0 / I2;
    prepared[5] = t1 * 2.0;
    prepared[6] = 0.5 * t3;
    prepared[7] = d_ * 2.0;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real o_y = x[2];
    const lagc_real o_rate_y = x[5];
    const lagc_real t0 = o_y * o_rate_y;
    const lagc_real o_x = x[1];
    const lagc_real o_rate_x = x[4];
    const lagc_real t1 = o_x * o_rate_x;
    const lagc_real o_z = x[3];
    const lagc_real o_rate_z = x[6];
    const lagc_real t2 = o_z * o_rate_z;
    const lagc_real t3 = t0 + (t1 + t2);
    /* der(o.w) */
    xdot[0] = -(t3 * 0.5);
    const lagc_real o_w = x[0];
    const lagc_real t4 = o_rate_x * o_w + o_y * o_rate_z - o_rate_y * o_z;
    /* der(o.x) */
    xdot[1] = 0.5 * t4;
    const lagc_real t5 = o_rate_y * o_w + o_rate_x * o_z - o_x * o_rate_z;
    /* der(o.y) */
    xdot[2] = 0.5 * t5;
    const lagc_real t6 = o_rate_z * o_w + o_rate_y * o_x - o_y * o_rate_x;
    /* der(o.z) */
    xdot[3] = 0.5 * t6;
    const lagc_real t7 = o_x * o_x;
    const lagc_real t8 = o_y * o_y;
    const lagc_real t9 = o_z * o_z;
    const lagc_real t10 = o_w * o_w;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t11 = o_x * prepared1;
    const lagc_real t12 = o_rate_y * t4 - o_rate_z * t3 - o_rate_x * t5;
    const lagc_real t13 = o_rate_z * t5 - o_rate_x * t3 - o_rate_y * t6;
    const lagc_real t14 = o_z * t12 + (t6 * t6 + (t4 * t4 + o_x * t13));
    const lagc_real t15 = 0.5 * (t5 * t6);
    const lagc_real t16 = o_rate_x * t6 - o_rate_y * t3 - o_rate_z * t4;
    const lagc_real t17 = t2 + (t0 + t1);
    const lagc_real t18 = o_rate_z * t6 + (o_rate_x * t4 + o_rate_y * t5);
    const lagc_real t19 = (o_w * t13 - t3 * t4) * 0.25 - 0.25 * (t4 * t17 + o_x * t18);
    const lagc_real t20 = 0.5 * (t15 + 0.5 * (o_y * t12)) + (0.5 * (t15 + 0.5 * (o_z * t16)) + t19);
    const lagc_real t21 = 0.5 * (t4 * t5);
    const lagc_real t22 = 0.25 * (o_w * t12 - t3 * t6) - 0.25 * (t6 * t17 + o_z * t18);
    const lagc_real t23 = 0.5 * (t21 + 0.5 * (o_x * t16)) + (0.5 * (t21 + 0.5 * (o_y * t13)) - t22);
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t24 = 0.5 * (t11 * t14) + (o_w * t20 + o_y * t23) * prepared2;
    const lagc_real t25 = o_z * t20 + o_x * t23;
    const lagc_real t26 = o_x * t20 - o_z * t23;
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t27 = o_z * prepared1;
    const lagc_real t28 = 0.5 * (t14 * t27) + prepared2 * (o_y * t20 - o_w * t23);
    const lagc_real t29 = prepared2 * (o_z * t25 - o_x * t26) - o_rate_y * o_rate_z * prepared3 - o_y * t28;
    const lagc_real t30 = (t7 + (t8 - t9 - t10)) * p->prepared[0] - (o_w * t24 + t29);
    const lagc_real t31 = o_x * o_w - o_y * o_z;
    const lagc_real t32 = 0.5 * t10;
    const lagc_real t33 = 0.5 * t7;
    const lagc_real t34 = 0.5 * t9;
    const lagc_real t35 = 0.5 * t8;
    const lagc_real t36 = t32 - t33 + t34 - t35;
    const lagc_real t37 = o_x * o_z;
    const lagc_real t38 = 0.5 * t37;
    const lagc_real t39 = o_y * o_w;
    const lagc_real t40 = 0.5 * t39;
    const lagc_real t41 = t38 + (t40 + (t38 + t40));
    const lagc_real t42 = prepared2 * (o_z * (o_z * t36 + o_x * t41) - o_x * (o_x * t36 - o_z * t41));
    const lagc_real t43 = t42 - o_y * (t27 * t31 + prepared2 * (o_y * t36 - o_w * t41));
    const lagc_real I1 = p->I1;
    const lagc_real t44 = 1.0 / (o_w * (t11 * t31 + prepared2 * (o_w * t36 + o_y * t41)) + t43 + I1);
    const lagc_real t45 = prepared2 * (t35 - (t33 + (t32 - t34)));
    const lagc_real t46 = t40 - t38;
    const lagc_real t47 = o_y * o_x + o_z * o_w;
    const lagc_real t48 = o_y * t45 + prepared1 * (o_w * t46 + o_x * t47);
    const lagc_real t49 = t27 * t46 + o_x * t45;
    const lagc_real t50 = prepared1 * (o_y * t46 + o_z * t47) - o_w * t45;
    const lagc_real t51 = t11 * t46 - o_z * t45;
    const lagc_real t52 = o_w * t48 + (o_z * t49 - o_y * t50) - o_x * t51;
    const lagc_real t53 = t44 * t52;
    const lagc_real t54 = I1 + (o_y * t48 + (o_w * t50 - o_x * t49) - o_z * t51);
    const lagc_real t55 = o_x * t50 + o_w * t49 - o_z * t48 - o_y * t51;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t56 = t55 * prepared4;
    const lagc_real t57 = t54 - t52 * t53 - t55 * t56;
    const lagc_real t58 = o_w * t28 + (prepared3 * (o_rate_y * o_rate_x) - prepared2 * (o_x * t25 + o_z * t26));
    const lagc_real t59 = o_x * t28 + prepared2 * (o_w * t25 - o_y * t26) - o_z * t24;
    const lagc_real t60 = 1.0 / t57 * ((t37 - t39) * p->prepared[5] - (o_y * t24 + t58) - t30 * t53 + t56 * t59);
    /* der(o.rate.z) */
    xdot[6] = t60;
    /* der(o.rate.x) */
    xdot[4] = t30 * t44 - t53 * t60;
    /* der(o.rate.y) */
    xdot[5] = -(prepared4 * t59 + t56 * t60);
    health[0] = t57 / t54;
    health[1] = 0.0;
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint rows */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real o_y = x[2];
    const lagc_real o_rate_y = x[5];
    const lagc_real t0 = o_y * o_rate_y;
    const lagc_real o_x = x[1];
    const lagc_real o_rate_x = x[4];
    const lagc_real t1 = o_x * o_rate_x;
    const lagc_real o_z = x[3];
    const lagc_real o_rate_z = x[6];
    const lagc_real t2 = o_z * o_rate_z;
    const lagc_real t3 = t0 + (t1 + t2);
    qdot[0] = -(t3 * 0.5);
    const lagc_real o_w = x[0];
    const lagc_real t4 = o_rate_x * o_w + o_y * o_rate_z - o_rate_y * o_z;
    qdot[1] = 0.5 * t4;
    const lagc_real t5 = o_rate_y * o_w + o_rate_x * o_z - o_x * o_rate_z;
    qdot[2] = 0.5 * t5;
    const lagc_real t6 = o_rate_z * o_w + o_rate_y * o_x - o_y * o_rate_x;
    qdot[3] = 0.5 * t6;
    const lagc_real t7 = o_x * o_w - o_y * o_z;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t8 = o_x * prepared1;
    const lagc_real t9 = o_w * o_w;
    const lagc_real t10 = 0.5 * t9;
    const lagc_real t11 = o_x * o_x;
    const lagc_real t12 = 0.5 * t11;
    const lagc_real t13 = o_z * o_z;
    const lagc_real t14 = 0.5 * t13;
    const lagc_real t15 = o_y * o_y;
    const lagc_real t16 = 0.5 * t15;
    const lagc_real t17 = t10 - t12 + t14 - t16;
    const lagc_real t18 = o_x * o_z;
    const lagc_real t19 = 0.5 * t18;
    const lagc_real t20 = o_y * o_w;
    const lagc_real t21 = 0.5 * t20;
    const lagc_real t22 = t19 + (t21 + (t19 + t21));
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t23 = o_z * prepared1;
    const lagc_real t24 = prepared2 * (o_z * (o_z * t17 + o_x * t22) - o_x * (o_x * t17 - o_z * t22));
    const lagc_real t25 = t24 - o_y * (t7 * t23 + prepared2 * (o_y * t17 - o_w * t22));
    const lagc_real I1 = p->I1;
    M[0] = o_w * (t7 * t8 + (o_w * t17 + o_y * t22) * prepared2) + t25 + I1;
    M[1] = 0.0;
    M[2] = p->I2;
    const lagc_real t26 = prepared2 * (t16 - (t12 + (t10 - t14)));
    const lagc_real t27 = t21 - t19;
    const lagc_real t28 = o_y * o_x + o_z * o_w;
    const lagc_real t29 = o_y * t26 + prepared1 * (o_w * t27 + o_x * t28);
    const lagc_real t30 = t23 * t27 + o_x * t26;
    const lagc_real t31 = prepared1 * (o_y * t27 + o_z * t28) - o_w * t26;
    const lagc_real t32 = t8 * t27 - o_z * t26;
    M[3] = o_w * t29 + (o_z * t30 - o_y * t31) - o_x * t32;
    M[4] = o_x * t31 + o_w * t30 - o_z * t29 - o_y * t32;
    M[5] = I1 + (o_y * t29 + (o_w * t31 - o_x * t30) - o_z * t32);
    const lagc_real t33 = o_rate_y * t4 - o_rate_z * t3 - o_rate_x * t5;
    const lagc_real t34 = o_rate_z * t5 - o_rate_x * t3 - o_rate_y * t6;
    const lagc_real t35 = o_z * t33 + (t6 * t6 + (t4 * t4 + o_x * t34));
    const lagc_real t36 = 0.5 * (t5 * t6);
    const lagc_real t37 = o_rate_x * t6 - o_rate_y * t3 - o_rate_z * t4;
    const lagc_real t38 = t2 + (t0 + t1);
    const lagc_real t39 = o_rate_z * t6 + (o_rate_x * t4 + o_rate_y * t5);
    const lagc_real t40 = (o_w * t34 - t3 * t4) * 0.25 - 0.25 * (t4 * t38 + o_x * t39);
    const lagc_real t41 = 0.5 * (t36 + 0.5 * (o_y * t33)) + (0.5 * (t36 + 0.5 * (o_z * t37)) + t40);
    const lagc_real t42 = 0.5 * (t4 * t5);
    const lagc_real t43 = 0.25 * (o_w * t33 - t3 * t6) - 0.25 * (t6 * t38 + o_z * t39);
    const lagc_real t44 = 0.5 * (t42 + 0.5 * (o_x * t37)) + (0.5 * (t42 + 0.5 * (o_y * t34)) - t43);
    const lagc_real t45 = 0.5 * (t8 * t35) + prepared2 * (o_w * t41 + o_y * t44);
    const lagc_real t46 = o_z * t41 + o_x * t44;
    const lagc_real t47 = o_x * t41 - o_z * t44;
    const lagc_real prepared3 = p->prepared[3];
    const lagc_real t48 = 0.5 * (t23 * t35) + prepared2 * (o_y * t41 - o_w * t44);
    const lagc_real t49 = prepared2 * (o_z * t46 - o_x * t47) - o_rate_y * o_rate_z * prepared3 - o_y * t48;
    r[0] = (t11 + (t15 - t13 - t9)) * p->prepared[0] - (o_w * t45 + t49);
    r[1] = -(o_x * t48 + prepared2 * (o_w * t46 - o_y * t47) - o_z * t45);
    const lagc_real t50 = o_w * t48 + (prepared3 * (o_rate_y * o_rate_x) - prepared2 * (o_x * t46 + o_z * t47));
    r[2] = (t18 - t20) * p->prepared[5] - (o_y * t45 + t50);
    (void)(t);
    (void)(G);
    (void)(gamma);
}

/* dq = N(t,q) d */
static void lagc_fn_displace(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *d, lagc_real *dq)
{
    const lagc_real o_y = x[2];
    const lagc_real d1 = d[1];
    const lagc_real o_x = x[1];
    const lagc_real d0 = d[0];
    const lagc_real o_z = x[3];
    const lagc_real d2 = d[2];
    dq[0] = -((o_y * d1 + (o_x * d0 + o_z * d2)) * 0.5);
    const lagc_real o_w = x[0];
    dq[1] = 0.5 * (d0 * o_w + o_y * d2 - d1 * o_z);
    dq[2] = 0.5 * (d1 * o_w + d0 * o_z - o_x * d2);
    dq[3] = 0.5 * (d2 * o_w + d1 * o_x - o_y * d0);
    (void)(p);
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real o_rate_y = x[5];
    const lagc_real o_rate_x = x[4];
    const lagc_real o_rate_z = x[6];
    const lagc_real t0 = p->I2 * (o_rate_y * o_rate_y) + (o_rate_x * o_rate_x + o_rate_z * o_rate_z) * p->I1;
    const lagc_real o_x = x[1];
    const lagc_real o_w = x[0];
    const lagc_real o_y = x[2];
    const lagc_real o_z = x[3];
    const lagc_real t1 = o_rate_x * o_w + o_rate_z * o_y - o_rate_y * o_z;
    const lagc_real t2 = o_rate_z * o_w + o_rate_y * o_x - o_rate_x * o_y;
    const lagc_real t3 = o_x * t1 + o_z * t2;
    const lagc_real t4 = o_rate_y * o_w + o_rate_x * o_z - o_rate_z * o_x;
    const lagc_real t5 = o_rate_x * o_x + o_rate_y * o_y + o_rate_z * o_z;
    const lagc_real t6 = 0.5 * (o_y * t1 + o_x * t4) - 0.5 * (o_w * t2 - o_z * t5);
    const lagc_real t7 = o_y * t2 + (o_z * t4 + (o_w * t1 - o_x * t5));
    const lagc_real t8 = t0 * 0.5 + (t3 * t3 + t6 * t6 + t7 * t7 * 0.25) * p->prepared[6];
    /* kinetic energy */
    e[0] = t8;
    const lagc_real t9 = (o_y * o_z + o_x * o_w) * p->prepared[5];
    /* potential energy */
    e[1] = t9;
    /* energy of the balance */
    e[2] = t8 + t9;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real o_x = x[1];
    const lagc_real o_y = x[2];
    const lagc_real o_w = x[0];
    const lagc_real o_z = x[3];
    const lagc_real prepared7 = p->prepared[7];
    /* X */
    y[0] = (o_x * o_y - o_w * o_z) * prepared7;
    /* Y */
    y[1] = p->d * (1.0 - 2.0 * (o_z * o_z + o_x * o_x));
    const lagc_real t0 = o_y * o_z + o_x * o_w;
    /* Z */
    y[2] = prepared7 * t0;
    const lagc_real o_rate_y = x[5];
    const lagc_real o_rate_x = x[4];
    const lagc_real o_rate_z = x[6];
    const lagc_real t1 = p->I2 * (o_rate_y * o_rate_y) + (o_rate_x * o_rate_x + o_rate_z * o_rate_z) * p->I1;
    const lagc_real t2 = o_w * o_rate_x + o_y * o_rate_z - o_z * o_rate_y;
    const lagc_real t3 = o_w * o_rate_z + o_x * o_rate_y - o_y * o_rate_x;
    const lagc_real t4 = o_x * t2 + o_z * t3;
    const lagc_real t5 = o_w * o_rate_y + o_z * o_rate_x - o_x * o_rate_z;
    const lagc_real t6 = o_x * o_rate_x + o_y * o_rate_y + o_z * o_rate_z;
    const lagc_real t7 = 0.5 * (o_y * t2 + o_x * t5) - 0.5 * (o_w * t3 - o_z * t6);
    const lagc_real t8 = o_y * t3 + (o_z * t5 + (o_w * t2 - o_x * t6));
    /* E */
    y[3] = t0 * p->prepared[5] + (t1 * 0.5 + (t4 * t4 + t7 * t7 + t8 * t8 * 0.25) * p->prepared[6]);
    (void)(t);
    (void)(a);
    (void)(lam);
}

/* start values and guesses */
static void lagc_fn_start(const lagc_params *p, lagc_real *x)
{
    /* o.w */
    x[0] = 1.0;
    /* o.x */
    x[1] = 0.0;
    /* o.y */
    x[2] = 0.0;
    /* o.z */
    x[3] = 0.0;
    /* o.rate.x */
    x[4] = 0.0;
    /* o.rate.y */
    x[5] = 150.0;
    /* o.rate.z */
    x[6] = -4.61538;
    (void)(p);
}

/* derived values that have bounds */
static void lagc_fn_limits(const lagc_params *p, lagc_real *b)
{
    const lagc_real I1 = p->I1;
    const lagc_real I2 = p->I2;
    const lagc_real t0 = (I1 + I2) * 1.000000001 - I1;
    b[0] = t0;
    b[2] = t0;
    b[1] = I1 * 2.000000002 - I2;
}
