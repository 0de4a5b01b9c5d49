static const int lagc_first[LAGC_NQUAT] = {LAGC_QUATERNIONS};

/* Unit length for each quaternion in x; one that is zero or not finite is left. */
static void lagc_normalise(double *x)
{
    int k, i;
    for (k = 0; k < LAGC_NQUAT; k++) {
        double *e = x + lagc_first[k], largest = 0.0, length;
        double square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
        if (!(1e-200 < square && square < 1e200)) {
            for (i = 0; i < 4; i++)
                if (!(fabs(e[i]) <= largest))
                    largest = fabs(e[i]);
            if (!(0.0 < largest && largest < HUGE_VAL))
                continue;
            for (i = 0; i < 4; i++)
                e[i] = e[i] / largest;
            square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
        }
        length = sqrt(square);
        for (i = 0; i < 4; i++)
            e[i] = e[i] / length;
    }
}
