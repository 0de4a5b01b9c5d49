/* Calls every function of a generated model, and prints what they find to the last bit. */
#include "model.h"
#include <stdio.h>

static model_work work;
#ifdef STARTED
static model_start_work start_work;
#endif

static void show(const char *name, model_status status, const double *x, int n)
{
    int i;
    printf("%s %d", name, (int)status);
    for (i = 0; i < n; i++)
        printf(" %a", x[i]);
    printf("\n");
}

static void functions(const model_params *p, double t, const double *x)
{
    double xdot[MODEL_NX], e[3];
#ifdef CONSTRAINED
    double lambda[MODEL_NC], phi[MODEL_NC], psi[MODEL_NC], G[MODEL_NC * MODEL_NV], gamma[MODEL_NC];
    show("rhs", model_rhs(p, t, x, xdot, lambda, &work), xdot, MODEL_NX);
    show("lambda", MODEL_OK, lambda, MODEL_NC);
    model_constraints(p, t, x, NULL, NULL, NULL, NULL, &work);
    model_constraints(p, t, x, phi, psi, G, gamma, &work);
    show("phi", MODEL_OK, phi, MODEL_NH);
    show("psi", MODEL_OK, psi, MODEL_NC);
    show("G", MODEL_OK, G, MODEL_NC * MODEL_NV);
    show("gamma", MODEL_OK, gamma, MODEL_NC);
    model_position(p, t, x, phi);
    show("phi", MODEL_OK, phi, MODEL_NH);
    model_velocity(p, t, x, psi);
    show("psi", MODEL_OK, psi, MODEL_NC);
    model_scales(p, t, x, psi);
    show("scales", MODEL_OK, psi, MODEL_NC);
    {
        double right[MODEL_NV + MODEL_NC], left[MODEL_NV + MODEL_NC];
        const model_status status = model_assemble(p, t, x, &work);
        int i;
        for (i = 0; i < MODEL_NV + MODEL_NC; i++)
            right[i] = i + 1.0;
        model_solve(right, left, &work);
        show("solve", status, left, MODEL_NV + MODEL_NC);
    }
#endif
    show("rhs", model_rhs(p, t, x, xdot, NULL, &work), xdot, MODEL_NX);
#ifdef FORMED
    {
        double M[MODEL_NV * MODEL_NV], r[MODEL_NV];
        model_mass_matrix(p, t, x, M, &work);
        show("M", MODEL_OK, M, MODEL_NV * MODEL_NV);
        model_forces(p, t, x, r, &work);
        show("r", MODEL_OK, r, MODEL_NV);
    }
#endif
    model_energies(p, t, x, e);
    show("e", MODEL_OK, e, 3);
#ifdef CONDITIONED
    {
        double u[MODEL_NU], c[CONDITIONED], J[SLOPES], sizes[CONDITIONED];
        int i;
        for (i = 0; i < MODEL_NU; i++)
            u[i] = i < MODEL_NX ? x[i] : 0.5;
        model_conditions(p, t, u, c, J, sizes);
        show("conditions", MODEL_OK, c, CONDITIONED);
        show("J", MODEL_OK, J, SLOPES);
        show("sizes", MODEL_OK, sizes, CONDITIONED);
    }
#endif
#ifdef OBSERVED
    {
        double y[MODEL_NY];
        const model_status status = model_outputs(p, t, x, y, &work);
        show("y", status, y, MODEL_NY);
    }
#endif
}

static void motion(const model_params *p, const double *x, const model_options *o)
{
    const double times[3] = {0.03, 0.05, 0.1};
    double states[3 * MODEL_NX], dense[MODEL_NX];
    size_t done = 0;
    model_state s;
    model_status status;
    model_begin(&s, 0.0, x);
    do
        status = model_record(p, &s, o, times, 3, states, &done, 4, &work);
    while (status == MODEL_INTERRUPTED && done < 3);
    show("record", status, states, (int)done * MODEL_NX);
    status = model_step(p, &s, 0.2, o, &work);
    show("step", status, s.x, MODEL_NX);
    status = model_dense(p, &s, 0.5 * (s.t_old + s.t), o, dense, &work);
    show("dense", status, dense, MODEL_NX);
    status = model_advance(p, &s, 0.12, o, &work);
    show("advance", status, s.x, MODEL_NX);
    printf("%ld %ld %ld %a %a\n", s.steps, s.rejected, s.rhs, s.position_drift, s.velocity_drift);
}

int main(void)
{
    model_params p = model_default_params();
    model_options o = model_default_options();
    double x[MODEL_NX];
    if (model_work_size() != sizeof work || model_state_size() != sizeof(model_state)
        || model_params_size() != sizeof p || model_members()->name == NULL)
        return 1;
#ifdef MODEL_NPREPARED
    model_bind(&p);
    show("bind", 0, p.prepared, MODEL_NPREPARED);
#endif
    model_start(&p, x);
#ifdef STARTED
    show("consistent", model_consistent(&p, 0.0, x, NULL, &start_work), x, MODEL_NX);
#endif
#ifdef LIMITED
    {
        double b[MODEL_NLIMITS];
        model_limits(&p, b);
        show("limits", 0, b, MODEL_NLIMITS);
    }
#endif
    functions(&p, 0.0, x);
    o.max_steps = 200;
    motion(&p, x, &o);
    o.method = MODEL_DOPRI5;
    o.rtol = 1e-6;
    motion(&p, x, &o);
    o.step = 0.01;
    motion(&p, x, &o);
    return 0;
}
