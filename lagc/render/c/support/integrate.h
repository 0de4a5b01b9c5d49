lagc_options lagc_default_options(void);
size_t lagc_work_size(void);
size_t lagc_state_size(void);

#if LAGC_COMPLETE
/* Whether parameters and inputs are finite and within their bounds, and options make sense: OK or INVALID,
 * with *culprit one of LAGC_BAD_..., else -1.  Each of the three may be NULL: it is left out then. */
lagc_status lagc_check(const lagc_params *p, const lagc_options *o, int *culprit);

/* What a status means, in English; of a number that is none, too. */
const char *lagc_status_text(int status);

#endif
/* A new trajectory from (t, x); x meets the constraints.  *s need not be filled before. */
void lagc_begin(lagc_state *s, double t, const double *x);

/* lagc_step, lagc_advance and lagc_record look at the options, the times and the parameters of a call once,
 * before anything is done: INVALID says that one makes no sense, NOT_FINITE that a state is not finite
 * (s->culprit says which).  With these *s is as it was; with any other status it is where the last step
 * that was done has ended, and a call may go on from there.
 *
 * Between two of the calls below the caller may change anything in *p, such as inputs, any option, and
 * s->t and s->x: the next step begins with what is there then, at the cost of one evaluation where p, t
 * or x is another, and with the size of step that was found before.  What is not changed costs nothing:
 * the motion is that of one call, where t1 is the same. */

/* One step towards t1, before or after s->t, at most to it, and then exactly. */
lagc_status lagc_step(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o,
                      lagc_work *w);

/* x[NX] at a time t within the last step, which was made with the parameters of then; at any other INVALID.
 * Of the options it takes `project` alone.  Where it fails x has no meaning. */
lagc_status lagc_dense(const lagc_params *p, lagc_state *s, double t, const lagc_options *o,
                       double *x, lagc_work *w);

/* To t1 exactly, with error control and projection onto the constraints.  A step that is short only
 * to end at t1 does not make the next one short. */
lagc_status lagc_advance(const lagc_params *p, lagc_state *s, double t1, const lagc_options *o,
                         lagc_work *w);

/* To times[n-1], with the states at times[0..n-1] written to states[n*NX]: *done of them so far,
 * to be 0 in the first call.  The times are in order from s->t on, forwards or backwards.  After `budget`
 * steps (0: no limit) it returns INTERRUPTED; call it again to go on.  Where n is 0, times and states may
 * be NULL. */
lagc_status lagc_record(const lagc_params *p, lagc_state *s, const lagc_options *o,
                        const double *times, size_t n, double *states, size_t *done, long budget,
                        lagc_work *w);
