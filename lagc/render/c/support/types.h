/* Room for the calls below; fill it with zeros before its first use.  Between calls it holds nothing
 * that another needs, but for lagc_solve after lagc_assemble: it may serve any states, in any order. */
typedef struct {
    int culprit;        /* what a status refers to: an index of v or x, or a row */
    long fallbacks;     /* linear solves that took the slower, safer way */
#if LAGC_NC
    int redundant[LAGC_NC]; /* 1: this row was found to depend on others */
    int lost;               /* rows of G are known to depend on others */
    double lam[LAGC_NC];
#else
    double lam[1];
#endif
    double xdot[LAGC_NX];
    double reached[LAGC_KINDS]; /* sizes of the kinds of states, with the one that is tried */
    double weights[LAGC_NX];
    double longest; /* that of the trajectory, in a second attempt at a step */
    double play[LAGC_NX]; /* rates that what projection leaves of coordinates is over a step */
    double kept[13][LAGC_NX]; /* rates and end of a step that is tried once more */
    double qdot[LAGC_NQ];
    double M[LAGC_NV * (LAGC_NV + 1) / 2]; /* packed by rows of the lower triangle */
    double force[LAGC_NV];
    double low[LAGC_NV * (LAGC_NV + 1) / 2];
    double column[LAGC_NV];
#if LAGC_NC
    double G[LAGC_NC * LAGC_NV];
    double gamma[LAGC_NC];
    double sizes[LAGC_NC]; /* of the terms of gamma */
    double weight;
    double miss;
    double slight[LAGC_NC];
    double b[LAGC_NC * LAGC_NV];
    double f[LAGC_NC * LAGC_NC];
    double table[LAGC_NC * LAGC_NC];
    double normal[LAGC_NC * LAGC_NC];
    double lengths[LAGC_NC];
    double free[LAGC_NC];
    double found[LAGC_NC];
    double scales[LAGC_NC]; /* of residuals, and of their rates */
    double rates[LAGC_NC];
    double rows[LAGC_NC];
    double right[LAGC_NV + LAGC_NC];
    double left[LAGC_NV + LAGC_NC];
    double moved[LAGC_NX];
#if LAGC_NH
    double parts[2][LAGC_NX]; /* of the error of a step */
    double other[2][LAGC_NX]; /* the same of another attempt */
    double nudged[LAGC_NX];
#endif
    double dq[LAGC_NQ];
    int order[LAGC_NC];
    int rank;
    int dense;
#if LAGC_NWORK
    double entries[LAGC_NWORK];
#endif
#endif
} lagc_work;

typedef enum { LAGC_DOP853 = 0, LAGC_DOPRI5 = 1 } lagc_method;

/* Numbers are finite and not negative. */
typedef struct {
    int method;        /* lagc_method */
    int project;       /* 0: let the constraints drift */
    long max_steps;    /* of one call, accepted and rejected; 0: no limit */
    double rtol;       /* below 1; of the largest magnitude so far of the states of the same kind */
    double atol;       /* added for every state; where it is 0, rtol is 1e-15 at least */
    double step;       /* > 0: fixed steps, rtol and atol unused */
    double first_step; /* 0: chosen */
    double max_step;   /* 0: no limit */
} lagc_options;

/* The culprit of INVALID; of a parameter or an input: LAGC_BAD_PARAMETER + its place in lagc_params; behind
 * these, of a value that is made of parameters: its place in lagc_limits. */
enum {
    LAGC_BAD_METHOD = 0,
    LAGC_BAD_MAX_STEPS = 1,
    LAGC_BAD_RTOL = 2,
    LAGC_BAD_ATOL = 3,
    LAGC_BAD_STEP = 4,
    LAGC_BAD_FIRST_STEP = 5,
    LAGC_BAD_MAX_STEP = 6,
    LAGC_BAD_TIME = 7, /* s->t, t1, t, times, or n and *done */
    LAGC_BAD_BUDGET = 8,
    LAGC_BAD_LEVEL = 9,
    LAGC_BAD_PARAMETER = 16
};

/* A state on its way: t and x now, and the last step, with all that dense output of it and the next
 * step need.  A copy is a state of its own. */
typedef struct {
    double t;
    double x[LAGC_NX];
    double t_old;          /* where the last step began */
    double position_drift; /* largest scaled residuals after a step */
    double velocity_drift;
    long steps;
    long rejected;
    long rhs; /* evaluations */
    int culprit;
    double sizes[LAGC_KINDS]; /* of coordinates, and speeds, of one unit: the largest so far */
    double longest; /* step that was tried at first */
    int listening; /* the error of the last step was judged with its rounding */
    double recalled; /* 1 where rounding made a step good, and less the longer ago that is; 0: forgotten */
    double noise[LAGC_NX]; /* that rounding, of the rates */
    long entered; /* steps and attempts before this call */
    int called; /* from here on for the functions below: no step was made since the caller had it */
    int method; /* of the last step */
    int rate;   /* at (t, x): k[0], the last of k, or to be found */
    int dense;  /* of the last step: r, k, or to be found */
#if LAGC_NC
    int lost;
#endif
    long on_grid;
    double grid;
    double stride;
    double h;
    double error_old;
    double h_old;
    double x_old[LAGC_NX];
    double t_seen;
    double x_seen[LAGC_NX];  /* where the last step ended */
    lagc_params p;           /* of the last step */
    double y[LAGC_NX];       /* where the next may end */
    double k[16][LAGC_NX];   /* rates at the stages */
    double r[8][LAGC_NX];    /* coefficients of the dense output */
} lagc_state;
