/* -- trajectories -- */

lagc_status lagc_dense(const lagc_params *p, lagc_state *s, double t, const lagc_options *o,
                       double *x, lagc_work *w)
{
    int i, status;
    if (t == s->t || s->h_old == 0.0) {
        for (i = 0; i < LAGC_NX; i++)
            x[i] = s->x[i];
        return LAGC_OK;
    }
    if (!s->has_dense) {
        if (o->method == LAGC_DOPRI5) {
            status = lagc_dopri5_dense(p, s->t_old, s->x_old, s->x, s->h_old, w);
        } else {
            status = lagc_dop853_dense(p, s->t_old, s->x_old, s->x, s->h_old, w);
            s->rhs += 3;
        }
        if (LAGC_FAILED(status))
            return (lagc_status)lagc_stop(s, status, w);
        s->has_dense = 1;
    }
    if (o->method == LAGC_DOPRI5)
        lagc_dopri5_at((t - s->t_old) / s->h_old, w, x);
    else
        lagc_dop853_at((t - s->t_old) / s->h_old, w, x);
#if LAGC_NC || LAGC_NQUAT
    if (o->project) {
        double position, velocity;
        status = lagc_project(p, t, x, &position, &velocity, w);
        if (LAGC_FAILED(status))
            return (lagc_status)lagc_stop(s, status, w);
    }
#endif
    return LAGC_OK;
}

lagc_status lagc_advance(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o,
                         lagc_work *w)
{
    lagc_status status = LAGC_OK;
    while (status == LAGC_OK && s->t != t1)
        status = lagc_step(p, s, t1, o, w);
    return status;
}

lagc_status lagc_record(const lagc_params *p, lagc_state *s, const lagc_options *o,
                        const double *times, size_t n, double *states, size_t *done, long budget,
                        lagc_work *w)
{
    lagc_status status;
    double t1, direction;
    long count = 0;
    if (n == 0)
        return LAGC_OK;
    t1 = times[n - 1];
    direction = t1 >= s->t ? 1.0 : -1.0;
    for (;;) {
        while (*done < n && (times[*done] - s->t) * direction <= 0.0) {
            status = lagc_dense(p, s, times[*done], o, states + *done * LAGC_NX, w);
            if (status != LAGC_OK)
                return status;
            *done += 1;
        }
        if (*done == n)
            return LAGC_OK;
        if (budget > 0 && count == budget)
            return LAGC_INTERRUPTED;
        status = lagc_step(p, s, t1, o, w);
        if (status != LAGC_OK)
            return status;
        count++;
    }
}
