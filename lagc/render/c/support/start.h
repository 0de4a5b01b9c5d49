/* How firmly a start value is stated: in a conflict the smaller gives way, FIXED never does. */
enum {
    LAGC_UNSTATED = 0,
    LAGC_DECLARED = 1,
    LAGC_SCENE = 2,
    LAGC_RUN = 3,
    LAGC_FIXED = 4
};

#define LAGC_PREDICTED 3 /* sets of values that are tried because linear prediction asks for them */

/* Room for lagc_consistent; no need to fill it. */
typedef struct {
    int culprit;            /* of a failure: the condition that is missed most; of NOT_FINITE the
                               index in q, v and the stated rates; of INVALID see LAGC_BAD_... */
    int loose[LAGC_NU];     /* 1: this value may have moved */
    double y[LAGC_NU];      /* q, v, and the stated rates */
    int levels[LAGC_NU];
    int part[LAGC_NU];      /* 1: of a quaternion, behind its first */
    int used[LAGC_NU];
    int places[LAGC_NU];
    int picked[LAGC_NU];
    int best_picked[LAGC_NU];
    int values[LAGC_NU];
    int columns[LAGC_NU];
    int stated[LAGC_NU];
    int marks[LAGC_NU];
    int let[LAGC_NU];
    int set_picked[LAGC_PREDICTED * LAGC_NU];
    double home[LAGC_NU];   /* the guess */
    double weights[LAGC_NU];
    double widths[LAGC_NU];
    double common[LAGC_NU];
    double reach[LAGC_NU];
    double steepest[LAGC_NU];
    double moves[LAGC_NU];
    double now[LAGC_NU];
    double best[LAGC_NU];
    double trial[LAGC_NU];
    double turned[LAGC_NU];
    double step[LAGC_NU];
    double ways[LAGC_NU];
    double kept[LAGC_NU];
    double held[LAGC_NU];
    double reached[LAGC_NU];
    double answer[LAGC_NU];
#if LAGC_NPOSITION
    double settled[LAGC_NU]; /* the guess, where what is alone in a condition meets it */
    int is_settled;
#endif
    double set_ways[LAGC_PREDICTED * LAGC_NU];
    double set_count[LAGC_PREDICTED];
    double set_total[LAGC_PREDICTED];
    double ease;
    int work;               /* factorisations so far */
    int first;              /* the spread that led to a start */
    int other;              /* the one that did where most was free */
    int count;              /* of columns */
    int positions;          /* of the rows that follow: conditions of positions come first */
    int ended;              /* where the rows end: those of one part */
    int left;               /* rows of the table */
    int rank;               /* columns that the linear conditions ask for */
    int rows[LAGC_NE];
    int all[LAGC_NE];
    int order[LAGC_NE];
    int group[LAGC_NE];
    int solved[LAGC_NE];
    int basis[LAGC_NE];
    int chosen[LAGC_NE];
    double c[LAGC_NE];
    double sizes[LAGC_NE];
    double scales[LAGC_NE];
    double terms[LAGC_NE];  /* of each condition at the guess */
    double trial_c[LAGC_NE];
    double trial_sizes[LAGC_NE];
    double right[LAGC_NE];
    double J[LAGC_NJ];
    double trial_J[LAGC_NJ];
    int blurred[LAGC_NJ];   /* 1: a derivative that is rounding */
    double matrix[LAGC_NE * (LAGC_NU + 1)];
    double rests[LAGC_NE * (LAGC_NU + 1)];
} lagc_start_work;

/* Move the guess x[NX] onto all conditions of the start: constraints, their rates, the initial
 * section, unit quaternions; x[NQ+NV..] is left.  What is stated less firmly moves first, of what is
 * stated as few as possible.  `levels` of q, v and the stated rates, in this order; NULL: the model's.
 * Any other status than OK leaves x as it was.  INCONSISTENT: no start was found; the conditions are phi[NH], psi[NC], those of the
 * initial section, those of the stated rates, unit quaternions, in this order. */
lagc_status lagc_consistent(const lagc_params *p, double t, double *x, const int *levels,
                            lagc_start_work *w);
