/* A small importer of Model Exchange (FMI 3.0): Runge-Kutta steps of one length, and event location by bisection
 * of the step, as its authors' habits have it:
 *     importer HABIT STOP STEP        HABIT: 0 stops before each root, 1 as near to it as it gets, 2 behind it,
 *                                     3 at the end of the step, also at events of time
 * It prints the time of each event that the FMU was asked to handle, then the states at the end. */
#include "fmi3Functions.h"
#include "lagc_model.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 200 };
static size_t n, nz;
static fmi3Instance fmu;

static void check(fmi3Status status)
{
    if (status != fmi3OK)
        exit(1);
}

static void tell(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String text)
{
    fprintf(stderr, "%s\n", text);
}

static void set(double t, const double *x)
{
    check(fmi3SetTime(fmu, t));
    check(fmi3SetContinuousStates(fmu, x, n));
}

static void rates(double t, const double *x, double *d)
{
    set(t, x);
    check(fmi3GetContinuousStateDerivatives(fmu, d, n));
}

static void step(double t, const double *x, double h, double *next) /* the classical method of order 4 */
{
    static const double at[] = {0.0, 0.5, 0.5, 1.0}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    double k[MOST] = {0}, y[MOST], sum[MOST] = {0};
    int stage;
    size_t i;
    for (stage = 0; stage < 4; stage++) {
        for (i = 0; i < n; i++)
            y[i] = x[i] + at[stage] * h * k[i];
        rates(t + at[stage] * h, y, k);
        for (i = 0; i < n; i++)
            sum[i] += weight[stage] * k[i];
    }
    for (i = 0; i < n; i++)
        next[i] = x[i] + h * sum[i];
    set(t + h, next);
}

static int changed(const double *before, const double *after)
{
    size_t k;
    for (k = 0; k < nz; k++)
        if ((before[k] > 0.0) != (after[k] > 0.0))
            return 1;
    return 0;
}

/* The length of the step from (t, x) to where the indicators change their signs. */
static double located(int habit, double t, const double *x, double h, const double *z)
{
    double low = 0.0, high = h, y[MOST], now[MOST];
    while (high - low > 1e-14 * (1.0 + fabs(t))) {
        const double middle = 0.5 * (low + high);
        step(t, x, middle, y);
        check(fmi3GetEventIndicators(fmu, now, nz));
        if (changed(z, now))
            high = middle;
        else
            low = middle;
    }
    return habit == 0 ? low : habit == 1 ? 0.5 * (low + high) : high;
}

static int handle_event(double t, double *x, double *next)
{
    fmi3Boolean again = 1, ends = 0, nominals, values, defined = 0;
    while (again)
        check(fmi3UpdateDiscreteStates(fmu, &again, &ends, &nominals, &values, &defined, next));
    if (!defined)
        *next = INFINITY;
    check(fmi3GetContinuousStates(fmu, x, n));
    check(fmi3EnterContinuousTimeMode(fmu));
    printf("event %.17g\n", t);
    return ends;
}

int main(int count, char **words)
{
    const int habit = atoi(words[1]);
    const double stop = atof(words[2]), most = atof(words[3]);
    double t = 0.0, next, x[MOST], y[MOST], z[MOST], after[MOST];
    size_t i;
    int ends;
    fmu = fmi3InstantiateModelExchange("one", TOKEN, NULL, 0, 0, NULL, tell);
    check(fmi3EnterInitializationMode(fmu, 0, 0.0, 0.0, 0, 0.0));
    check(fmi3ExitInitializationMode(fmu));
    check(fmi3GetNumberOfContinuousStates(fmu, &n));
    check(fmi3GetNumberOfEventIndicators(fmu, &nz));
    ends = handle_event(t, x, &next);
    while (!ends && t < stop) {
        double end = fmin(fmin(t + most, stop), habit == 3 ? stop : next);
        int crossed;
        fmi3Boolean enter, ended;
        set(t, x);
        check(fmi3GetEventIndicators(fmu, z, nz));
        step(t, x, end - t, y);
        check(fmi3GetEventIndicators(fmu, after, nz));
        crossed = changed(z, after);
        if (crossed && habit != 3) {
            end = t + located(habit, t, x, end - t, z);
            step(t, x, end - t, y);
        }
        for (i = 0; i < n; i++)
            x[i] = y[i];
        t = end;
        set(t, x);
        check(fmi3CompletedIntegratorStep(fmu, 1, &enter, &ended));
        if (crossed || enter || t >= next) {
            check(fmi3EnterEventMode(fmu));
            ends = handle_event(t, x, &next);
        }
    }
    for (i = 0; i < n; i++)
        printf("state %.17g\n", x[i]);
    return 0;
}
