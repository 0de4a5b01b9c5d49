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
    xdot[0] = -(0.5 * t3);
    const lagc_real o_w = x[0];
    const lagc_real t4 = o_w * o_rate_x + o_y * o_rate_z - o_z * o_rate_y;
    /* der(o.x) */
    xdot[1] = t4 * 0.5;
    const lagc_real t5 = o_w * o_rate_y + o_z * o_rate_x - o_x * o_rate_z;
    /* der(o.y) */
    xdot[2] = t5 * 0.5;
    const lagc_real t6 = o_w * o_rate_z + o_x * o_rate_y - o_y * o_rate_x;
    /* der(o.z) */
    xdot[3] = t6 * 0.5;
    const lagc_real t7 = o_x * o_x;
    const lagc_real t8 = o_y * o_y;
    const lagc_real t9 = o_z * o_z;
    const lagc_real t10 = o_w * o_w;
    const lagc_real d_ = p->d;
    const lagc_real t11 = p->m * d_;
    const lagc_real t12 = p->field_g * t11;
    const lagc_real t13 = d_ * t11;
    const lagc_real t14 = 0.5 * (t5 * t6);
    const lagc_real t15 = o_rate_y * t4 - o_rate_z * t3 - o_rate_x * t5;
    const lagc_real t16 = o_rate_x * t6 - o_rate_y * t3 - o_rate_z * t4;
    const lagc_real t17 = o_rate_z * t5 - o_rate_x * t3 - o_rate_y * t6;
    const lagc_real t18 = t1 + t0 + t2;
    const lagc_real t19 = o_rate_z * t6 + (o_rate_x * t4 + o_rate_y * t5);
    const lagc_real t20 = 0.25 * (o_w * t17 - t4 * t3) - 0.25 * (t18 * t4 + o_x * t19);
    const lagc_real t21 = 0.5 * (t14 + 0.5 * (o_y * t15)) + (0.5 * (t14 + 0.5 * (o_z * t16)) + t20);
    const lagc_real t22 = 0.5 * (t4 * t5);
    const lagc_real t23 = 0.25 * (o_w * t15 - t6 * t3) - (t18 * t6 + o_z * t19) * 0.25;
    const lagc_real t24 = 0.5 * (t22 + 0.5 * (o_x * t16)) + (0.5 * (t22 + 0.5 * (o_y * t17)) - t23);
    const lagc_real t25 = o_z * t21 + o_x * t24;
    const lagc_real t26 = o_z * t15 + (t6 * t6 + (t4 * t4 + o_x * t17));
    const lagc_real t27 = o_y * t21 + o_z * t26 - o_w * t24;
    const lagc_real t28 = o_w * t21 + o_x * t26 + o_y * t24;
    const lagc_real t29 = o_x * t21 - o_z * t24;
    const lagc_real I2 = p->I2;
    const lagc_real I1 = p->I1;
    const lagc_real t30 = I2 - I1;
    const lagc_real t31 = 2.0 * (t13 * (o_z * t25 - o_y * t27 + o_w * t28 - o_x * t29));
    const lagc_real t32 = (t7 + (t8 - t9 - t10)) * t12 - (t31 - t30 * (o_rate_y * o_rate_z));
    const lagc_real t33 = 0.5 * t10;
    const lagc_real t34 = 0.5 * t7;
    const lagc_real t35 = 0.5 * t9;
    const lagc_real t36 = 0.5 * t8;
    const lagc_real t37 = t33 - t34 + t35 - t36;
    const lagc_real t38 = o_x * o_z;
    const lagc_real t39 = 0.5 * t38;
    const lagc_real t40 = o_w * o_y;
    const lagc_real t41 = 0.5 * t40;
    const lagc_real t42 = t39 + (t41 + (t39 + t41));
    const lagc_real t43 = o_w * o_x - o_y * o_z;
    const lagc_real t44 = 2.0 * (o_z * (o_z * t37 + o_x * t42) - o_x * (o_x * t37 - o_z * t42));
    const lagc_real t45 = t44 - o_y * (2.0 * (o_y * t37 - o_w * t42) + 4.0 * (o_z * t43));
    const lagc_real t46 = 1.0 / (I1 + (t45 + o_w * ((o_w * t37 + o_y * t42) * 2.0 + o_x * t43 * 4.0)) * t13);
    const lagc_real t47 = t41 - t39;
    const lagc_real t48 = t36 - (t34 + (t33 - t35));
    const lagc_real t49 = 4.0 * (o_z * t47) + 2.0 * (o_x * t48);
    const lagc_real t50 = o_x * o_y + o_w * o_z;
    const lagc_real t51 = 4.0 * (o_y * t47 + o_z * t50) - 2.0 * (o_w * t48);
    const lagc_real t52 = 4.0 * (o_w * t47 + o_x * t50) + 2.0 * (o_y * t48);
    const lagc_real t53 = 4.0 * (o_x * t47) - 2.0 * (o_z * t48);
    const lagc_real t54 = t13 * (o_z * t49 - o_y * t51 + o_w * t52 - o_x * t53);
    const lagc_real t55 = t54 * t46;
    const lagc_real t56 = I1 + t13 * (o_w * t51 - o_x * t49 + o_y * t52 - o_z * t53);
    const lagc_real t57 = t13 * (o_x * t51 + o_w * t49 - o_z * t52 - o_y * t53);
    const lagc_real t58 = 1.0 / I2;
    const lagc_real t59 = t57 * t58;
    const lagc_real t60 = t56 - t54 * t55 - t57 * t59;
    const lagc_real t61 = 2.0 * (t13 * (o_w * t27 - o_x * t25 + o_y * t28 - o_z * t29));
    const lagc_real t62 = 2.0 * (t13 * (o_x * t27 + o_w * t25 - o_z * t28 - o_y * t29));
    const lagc_real t63 = 2.0 * ((t38 - t40) * t12) - (t61 + t30 * (o_rate_x * o_rate_y)) - t32 * t55 + t62 * t59;
    const lagc_real t64 = 1.0 / t60 * t63;
    /* der(o.rate.z) */
    xdot[6] = t64;
    /* der(o.rate.x) */
    xdot[4] = t32 * t46 - t55 * t64;
    /* der(o.rate.y) */
    xdot[5] = -(t62 * t58 + t59 * t64);
    health[0] = t60 / t56;
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
    qdot[0] = -(0.5 * t3);
    const lagc_real o_w = x[0];
    const lagc_real t4 = o_w * o_rate_x + o_y * o_rate_z - o_z * o_rate_y;
    qdot[1] = t4 * 0.5;
    const lagc_real t5 = o_w * o_rate_y + o_z * o_rate_x - o_x * o_rate_z;
    qdot[2] = t5 * 0.5;
    const lagc_real t6 = o_w * o_rate_z + o_x * o_rate_y - o_y * o_rate_x;
    qdot[3] = t6 * 0.5;
    const lagc_real I1 = p->I1;
    const lagc_real t7 = o_w * o_w;
    const lagc_real t8 = 0.5 * t7;
    const lagc_real t9 = o_x * o_x;
    const lagc_real t10 = 0.5 * t9;
    const lagc_real t11 = o_z * o_z;
    const lagc_real t12 = 0.5 * t11;
    const lagc_real t13 = o_y * o_y;
    const lagc_real t14 = 0.5 * t13;
    const lagc_real t15 = t8 - t10 + t12 - t14;
    const lagc_real t16 = o_x * o_z;
    const lagc_real t17 = 0.5 * t16;
    const lagc_real t18 = o_w * o_y;
    const lagc_real t19 = 0.5 * t18;
    const lagc_real t20 = t17 + (t19 + (t17 + t19));
    const lagc_real t21 = o_w * o_x - o_y * o_z;
    const lagc_real t22 = 2.0 * (o_z * (o_z * t15 + o_x * t20) - o_x * (o_x * t15 - o_z * t20));
    const lagc_real t23 = t22 - o_y * (2.0 * (o_y * t15 - o_w * t20) + 4.0 * (o_z * t21));
    const lagc_real d_ = p->d;
    const lagc_real t24 = p->m * d_;
    const lagc_real t25 = d_ * t24;
    M[0] = I1 + (t23 + o_w * ((o_w * t15 + o_y * t20) * 2.0 + o_x * t21 * 4.0)) * t25;
    M[1] = 0.0;
    const lagc_real I2 = p->I2;
    M[2] = I2;
    const lagc_real t26 = t19 - t17;
    const lagc_real t27 = t14 - (t10 + (t8 - t12));
    const lagc_real t28 = 4.0 * (o_z * t26) + 2.0 * (o_x * t27);
    const lagc_real t29 = o_x * o_y + o_w * o_z;
    const lagc_real t30 = 4.0 * (o_y * t26 + o_z * t29) - 2.0 * (o_w * t27);
    const lagc_real t31 = 4.0 * (o_w * t26 + o_x * t29) + 2.0 * (o_y * t27);
    const lagc_real t32 = 4.0 * (o_x * t26) - 2.0 * (o_z * t27);
    M[3] = t25 * (o_z * t28 - o_y * t30 + o_w * t31 - o_x * t32);
    M[4] = t25 * (o_x * t30 + o_w * t28 - o_z * t31 - o_y * t32);
    M[5] = I1 + t25 * (o_w * t30 - o_x * t28 + o_y * t31 - o_z * t32);
    const lagc_real t33 = p->field_g * t24;
    const lagc_real t34 = 0.5 * (t5 * t6);
    const lagc_real t35 = o_rate_y * t4 - o_rate_z * t3 - o_rate_x * t5;
    const lagc_real t36 = o_rate_x * t6 - o_rate_y * t3 - o_rate_z * t4;
    const lagc_real t37 = o_rate_z * t5 - o_rate_x * t3 - o_rate_y * t6;
    const lagc_real t38 = t1 + t0 + t2;
    const lagc_real t39 = o_rate_z * t6 + (o_rate_x * t4 + o_rate_y * t5);
    const lagc_real t40 = 0.25 * (o_w * t37 - t4 * t3) - 0.25 * (t38 * t4 + o_x * t39);
    const lagc_real t41 = 0.5 * (t34 + 0.5 * (o_y * t35)) + (0.5 * (t34 + 0.5 * (o_z * t36)) + t40);
    const lagc_real t42 = 0.5 * (t4 * t5);
    const lagc_real t43 = 0.25 * (o_w * t35 - t6 * t3) - (t38 * t6 + o_z * t39) * 0.25;
    const lagc_real t44 = 0.5 * (t42 + 0.5 * (o_x * t36)) + (0.5 * (t42 + 0.5 * (o_y * t37)) - t43);
    const lagc_real t45 = o_z * t41 + o_x * t44;
    const lagc_real t46 = o_z * t35 + (t6 * t6 + (t4 * t4 + o_x * t37));
    const lagc_real t47 = o_y * t41 + o_z * t46 - o_w * t44;
    const lagc_real t48 = o_w * t41 + o_x * t46 + o_y * t44;
    const lagc_real t49 = o_x * t41 - o_z * t44;
    const lagc_real t50 = I2 - I1;
    const lagc_real t51 = 2.0 * (t25 * (o_z * t45 - o_y * t47 + o_w * t48 - o_x * t49));
    r[0] = (t9 + (t13 - t11 - t7)) * t33 - (t51 - t50 * (o_rate_y * o_rate_z));
    r[1] = -(2.0 * (t25 * (o_x * t47 + o_w * t45 - o_z * t48 - o_y * t49)));
    const lagc_real t52 = 2.0 * (t25 * (o_w * t47 - o_x * t45 + o_y * t48 - o_z * t49));
    r[2] = 2.0 * ((t16 - t18) * t33) - (t52 + t50 * (o_rate_x * o_rate_y));
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
    dq[0] = -(0.5 * (o_y * d1 + (o_x * d0 + o_z * d2)));
    const lagc_real o_w = x[0];
    dq[1] = (o_w * d0 + o_y * d2 - o_z * d1) * 0.5;
    dq[2] = (o_w * d1 + o_z * d0 - o_x * d2) * 0.5;
    dq[3] = (o_w * d2 + o_x * d1 - o_y * d0) * 0.5;
    (void)(p);
    (void)(t);
}

/* energies */
static void lagc_fn_energies(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *e)
{
    const lagc_real d_ = p->d;
    const lagc_real t0 = p->m * d_;
    const lagc_real o_y = x[2];
    const lagc_real o_w = x[0];
    const lagc_real o_rate_x = x[4];
    const lagc_real o_rate_z = x[6];
    const lagc_real o_z = x[3];
    const lagc_real o_rate_y = x[5];
    const lagc_real t1 = o_w * o_rate_x + o_y * o_rate_z - o_z * o_rate_y;
    const lagc_real o_x = x[1];
    const lagc_real t2 = o_w * o_rate_y + o_z * o_rate_x - o_x * o_rate_z;
    const lagc_real t3 = o_w * o_rate_z + o_x * o_rate_y - o_y * o_rate_x;
    const lagc_real t4 = o_x * o_rate_x + o_y * o_rate_y + o_z * o_rate_z;
    const lagc_real t5 = 0.5 * (o_y * t1 + o_x * t2) - (o_w * t3 - o_z * t4) * 0.5;
    const lagc_real t6 = o_x * t1 + o_z * t3;
    const lagc_real t7 = o_y * t3 + (o_z * t2 + (o_w * t1 - o_x * t4));
    const lagc_real t8 = o_rate_y * (p->I2 * o_rate_y) + p->I1 * (o_rate_x * o_rate_x + o_rate_z * o_rate_z);
    const lagc_real t9 = 0.5 * (t0 * (d_ * ((t5 * t5 + t6 * t6) * 4.0 + t7 * t7))) + 0.5 * t8;
    /* kinetic energy */
    e[0] = t9;
    const lagc_real t10 = t0 * (p->field_g * (o_y * o_z + o_w * o_x)) * 2.0;
    /* potential energy */
    e[1] = t10;
    /* energy of the balance */
    e[2] = t10 + t9;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real d_ = p->d;
    const lagc_real o_x = x[1];
    const lagc_real o_y = x[2];
    const lagc_real o_w = x[0];
    const lagc_real o_z = x[3];
    /* X */
    y[0] = 2.0 * (d_ * (o_x * o_y - o_w * o_z));
    /* Y */
    y[1] = d_ * (1.0 - (o_z * o_z + o_x * o_x) * 2.0);
    const lagc_real t0 = d_ * (o_y * o_z + o_w * o_x);
    /* Z */
    y[2] = 2.0 * t0;
    const lagc_real m = p->m;
    const lagc_real o_rate_x = x[4];
    const lagc_real o_rate_z = x[6];
    const lagc_real o_rate_y = x[5];
    const lagc_real t1 = o_w * o_rate_x + o_y * o_rate_z - o_z * o_rate_y;
    const lagc_real t2 = o_w * o_rate_y + o_z * o_rate_x - o_x * o_rate_z;
    const lagc_real t3 = o_w * o_rate_z + o_x * o_rate_y - o_y * o_rate_x;
    const lagc_real t4 = o_x * o_rate_x + o_y * o_rate_y + o_z * o_rate_z;
    const lagc_real t5 = 0.5 * (o_y * t1 + o_x * t2) - (o_w * t3 - o_z * t4) * 0.5;
    const lagc_real t6 = o_x * t1 + o_z * t3;
    const lagc_real t7 = o_y * t3 + (o_z * t2 + (o_w * t1 - o_x * t4));
    const lagc_real t8 = o_rate_y * (p->I2 * o_rate_y) + p->I1 * (o_rate_x * o_rate_x + o_rate_z * o_rate_z);
    const lagc_real t9 = 0.5 * (((t5 * t5 + t6 * t6) * 4.0 + t7 * t7) * (d_ * (m * d_))) + 0.5 * t8;
    /* E */
    y[3] = 2.0 * (t0 * (m * p->field_g)) + t9;
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
