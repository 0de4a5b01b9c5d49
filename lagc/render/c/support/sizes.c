/* -- sizes --
 * States are judged by the largest magnitude of their kind: coordinates, or speeds, of one unit.
 * Kind 0 are the coordinates that are numbers, as angles are. */

#define LAGC_TINY 1e-300 /* stands for zero where it divides zero */

/* Of the change of a row over the sizes of states: a row whose terms vanish is judged by it. */
#define LAGC_RESTING 1e-3

static const int lagc_kinds[] = {LAGC_KINDS_OF_X};

/* sizes[KINDS] become at least those of x. */
static void lagc_enlarge(const double *x, double *sizes)
{
    int i;
    for (i = 0; i < LAGC_NQ + LAGC_NV; i++)
        if (fabs(x[i]) > sizes[lagc_kinds[i]])
            sizes[lagc_kinds[i]] = fabs(x[i]);
}
