/* what depends on parameters alone, then these */
static void lagc_fn_bind(const lagc_params *p, lagc_real *prepared)
{
    const lagc_real d_ = p->d;
    prepared[10] = d_;
    const lagc_real m = p->m;
    prepared[9] = m;
    const lagc_real t0 = d_ * m;
    const lagc_real t1 = d_ * t0;
    prepared[1] = t1;
    prepared[0] = 2.0 * t1;
    const lagc_real I1 = p->I1;
    prepared[11] = I1;
    const lagc_real I2 = p->I2;
    prepared[12] = I2;
    prepared[2] = I1 - I2;
    const lagc_real field_g = p->field_g;
    prepared[13] = field_g;
    const lagc_real t2 = t0 * field_g;
    prepared[5] = t2;
    prepared[3] = 2.0 * t2;
    prepared[4] = t1 * 4.0;
    prepared[6] = lagc_sign(I2);
    prepared[7] = 0.5 * t1;
    prepared[8] = 2.0 * d_;
}

/* right-hand side: qdot, accelerations, multipliers */
static void lagc_fn_rhs(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *xdot, lagc_real *lam, lagc_real *health)
{
    const lagc_real o_y = x[2];
    const lagc_real o_rate_y = x[5];
    const lagc_real o_x = x[1];
    const lagc_real o_rate_x = x[4];
    const lagc_real o_z = x[3];
    const lagc_real o_rate_z = x[6];
    /* der(o.w) */
    xdot[0] = -((o_y * o_rate_y + (o_x * o_rate_x + o_z * o_rate_z)) * 0.5);
    const lagc_real o_w = x[0];
    /* der(o.x) */
    xdot[1] = 0.5 * (o_rate_x * o_w + o_y * o_rate_z - o_rate_y * o_z);
    /* der(o.y) */
    xdot[2] = 0.5 * (o_rate_y * o_w + o_rate_x * o_z - o_x * o_rate_z);
    /* der(o.z) */
    xdot[3] = 0.5 * (o_rate_z * o_w + o_rate_y * o_x - o_y * o_rate_x);
    const lagc_real t0 = o_y * o_x;
    const lagc_real t1 = o_z * o_w;
    const lagc_real t2 = t0 + t1;
    const lagc_real t3 = o_z * o_z;
    const lagc_real t4 = o_x * o_x;
    const lagc_real t5 = 1.0 - 2.0 * (t3 + t4);
    const lagc_real t6 = o_y * o_z;
    const lagc_real t7 = o_x * o_w;
    const lagc_real t8 = t6 - t7;
    const lagc_real t9 = o_rate_z * (o_rate_z * t5 - 2.0 * (o_rate_y * t8));
    const lagc_real t10 = o_rate_x * (o_rate_y * t2 * 2.0 - o_rate_x * t5) - t9;
    const lagc_real prepared0 = p->prepared[0];
    const lagc_real t11 = o_y * o_y;
    const lagc_real t12 = 1.0 - 2.0 * (t3 + t11);
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t13 = t12 * prepared1;
    const lagc_real t14 = t0 - t1;
    const lagc_real t15 = o_x * o_z;
    const lagc_real t16 = o_y * o_w;
    const lagc_real t17 = t15 + t16;
    const lagc_real t18 = o_rate_x * (o_rate_y * t12 - 2.0 * (o_rate_x * t14));
    const lagc_real t19 = t18 - 2.0 * (o_rate_z * (o_rate_z * t14 - o_rate_y * t17));
    const lagc_real t20 = o_rate_y * p->prepared[2];
    const lagc_real t21 = t15 - t16;
    const lagc_real t22 = t6 + t7;
    const lagc_real t23 = 1.0 - 2.0 * (t4 + t11);
    const lagc_real t24 = 2.0 * (o_rate_x * (o_rate_y * t21 - o_rate_x * t22));
    const lagc_real t25 = t24 - o_rate_z * (2.0 * (o_rate_z * t22) - o_rate_y * t23);
    const lagc_real t26 = t13 * t19 + (o_rate_x * t20 + t21 * (prepared0 * t25 + p->prepared[3]));
    const lagc_real t27 = t2 * t10 * prepared0 + t26;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real t28 = t2 * t8 * prepared4 + prepared0 * (t21 * t23 + t12 * t17);
    const lagc_real I1 = p->I1;
    const lagc_real t29 = 1.0 / (t12 * t13 + prepared4 * (t21 * t21 + t2 * t2) + I1);
    const lagc_real t30 = t28 * t29;
    const lagc_real t31 = prepared1 * t23;
    const lagc_real t32 = t25 * t31 + (o_rate_z * t20 + prepared0 * (t8 * t10 + t17 * t19));
    const lagc_real t33 = I1 + (t23 * t31 + prepared4 * (t8 * t8 + t17 * t17));
    const lagc_real t34 = t33 - t28 * t30;
    const lagc_real t35 = (t27 * t30 - (t23 * p->prepared[5] + t32)) * (1.0 / t34);
    /* der(o.rate.x) */
    xdot[4] = t35;
    /* der(o.rate.y) */
    xdot[5] = 0.0;
    health[1] = 0.0;
    /* der(o.rate.z) */
    xdot[6] = t27 * t29 + t30 * t35;
    health[0] = lagc_min(t34 / t33, p->prepared[6]);
    (void)(t);
    (void)(lam);
}

/* mass matrix, forces and constraint equations */
static void lagc_fn_system(const lagc_params *p, lagc_real t, const lagc_real *x, lagc_real *qdot, lagc_real *M, lagc_real *r, lagc_real *G, lagc_real *gamma)
{
    const lagc_real o_y = x[2];
    const lagc_real o_rate_y = x[5];
    const lagc_real o_x = x[1];
    const lagc_real o_rate_x = x[4];
    const lagc_real o_z = x[3];
    const lagc_real o_rate_z = x[6];
    qdot[0] = -((o_y * o_rate_y + (o_x * o_rate_x + o_z * o_rate_z)) * 0.5);
    const lagc_real o_w = x[0];
    qdot[1] = 0.5 * (o_rate_x * o_w + o_y * o_rate_z - o_rate_y * o_z);
    qdot[2] = 0.5 * (o_rate_y * o_w + o_rate_x * o_z - o_x * o_rate_z);
    qdot[3] = 0.5 * (o_rate_z * o_w + o_rate_y * o_x - o_y * o_rate_x);
    const lagc_real t0 = o_y * o_y;
    const lagc_real t1 = o_x * o_x;
    const lagc_real t2 = 1.0 - (t0 + t1) * 2.0;
    const lagc_real prepared1 = p->prepared[1];
    const lagc_real t3 = t2 * prepared1;
    const lagc_real t4 = o_y * o_z;
    const lagc_real t5 = o_x * o_w;
    const lagc_real t6 = t4 - t5;
    const lagc_real t7 = o_x * o_z;
    const lagc_real t8 = o_y * o_w;
    const lagc_real t9 = t7 + t8;
    const lagc_real prepared4 = p->prepared[4];
    const lagc_real I1 = p->I1;
    M[0] = t2 * t3 + (t6 * t6 + t9 * t9) * prepared4 + I1;
    M[1] = 0.0;
    M[4] = 0.0;
    r[1] = 0.0;
    M[2] = p->I2;
    const lagc_real t10 = o_y * o_x;
    const lagc_real t11 = o_z * o_w;
    const lagc_real t12 = t10 + t11;
    const lagc_real t13 = t7 - t8;
    const lagc_real t14 = o_z * o_z;
    const lagc_real t15 = 1.0 - 2.0 * (t0 + t14);
    const lagc_real prepared0 = p->prepared[0];
    M[3] = -(prepared4 * (t6 * t12) + (t2 * t13 + t9 * t15) * prepared0);
    const lagc_real t16 = prepared1 * t15;
    M[5] = I1 + (t15 * t16 + prepared4 * (t13 * t13 + t12 * t12));
    const lagc_real t17 = t4 + t5;
    const lagc_real t18 = 2.0 * (o_rate_x * (o_rate_y * t13 - o_rate_x * t17));
    const lagc_real t19 = t18 - o_rate_z * (2.0 * (o_rate_z * t17) - o_rate_y * t2);
    const lagc_real t20 = 1.0 - 2.0 * (t1 + t14);
    const lagc_real t21 = o_rate_x * (2.0 * (o_rate_y * t12) - o_rate_x * t20);
    const lagc_real t22 = t21 - o_rate_z * (o_rate_z * t20 - 2.0 * (o_rate_y * t6));
    const lagc_real t23 = t10 - t11;
    const lagc_real t24 = o_rate_x * (o_rate_y * t15 - 2.0 * (o_rate_x * t23));
    const lagc_real t25 = t24 - 2.0 * (o_rate_z * (o_rate_z * t23 - o_rate_y * t9));
    const lagc_real prepared2 = p->prepared[2];
    const lagc_real t26 = t3 * t19 + (prepared0 * (t6 * t22 + t9 * t25) + o_rate_y * o_rate_z * prepared2);
    r[0] = -(t2 * p->prepared[5] + t26);
    const lagc_real t27 = prepared2 * (o_rate_y * o_rate_x) + prepared0 * (t12 * t22 + t13 * t19) + t16 * t25;
    r[2] = t13 * p->prepared[3] + t27;
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
    const lagc_real o_y = x[2];
    const lagc_real t1 = o_y * o_y;
    const lagc_real o_x = x[1];
    const lagc_real o_z = x[3];
    const lagc_real t2 = o_x * o_z;
    const lagc_real o_w = x[0];
    const lagc_real t3 = o_y * o_w;
    const lagc_real t4 = o_rate_x * (1.0 - (t1 + o_x * o_x) * 2.0) - 2.0 * (o_rate_z * (t2 - t3));
    const lagc_real t5 = 2.0 * (o_rate_x * (t2 + t3)) - o_rate_z * (1.0 - 2.0 * (t1 + o_z * o_z));
    const lagc_real t6 = o_y * o_z;
    const lagc_real t7 = o_x * o_w;
    const lagc_real t8 = o_rate_x * (t6 - t7) - o_rate_z * (o_y * o_x + o_z * o_w);
    const lagc_real t9 = t0 * 0.5 + (t4 * t4 + (t5 * t5 + t8 * t8 * 4.0)) * p->prepared[7];
    /* kinetic energy */
    e[0] = t9;
    const lagc_real t10 = (t6 + t7) * p->prepared[3];
    /* potential energy */
    e[1] = t10;
    /* energy of the balance */
    e[2] = t9 + t10;
    (void)(t);
}

/* outputs of the model */
static void lagc_fn_outputs(const lagc_params *p, lagc_real t, const lagc_real *x, const lagc_real *e, const lagc_real *a, const lagc_real *lam, lagc_real *y)
{
    const lagc_real o_x = x[1];
    const lagc_real o_y = x[2];
    const lagc_real o_w = x[0];
    const lagc_real o_z = x[3];
    const lagc_real prepared8 = p->prepared[8];
    /* X */
    y[0] = (o_x * o_y - o_w * o_z) * prepared8;
    /* Y */
    y[1] = p->d * (1.0 - 2.0 * (o_z * o_z + o_x * o_x));
    /* Z */
    y[2] = prepared8 * (o_y * o_z + o_x * o_w);
    /* E */
    y[3] = e[0] + e[1];
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
