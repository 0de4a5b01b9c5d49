/* Behind the printed sine and cosine: at points of many ranges, a digest of their bits; with QUAD the
 * largest error in units of the last place of the true values, by libquadmath. */
#include <float.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef QUAD
#include <quadmath.h>
#endif

static uint64_t seed = 88172645463325252u;

static uint64_t chance(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static double uniform(void) { return (double)(chance() >> 11) / 9007199254740992.0; }

static double of_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof x);
    return bits;
}

/* A point of range k; 0 where there is no such range. */
static int point(int k, double *x)
{
    static const double ends[] = {0.785, 0.79, 3.2, 100.0, 99999.0, 1e6, 1e10, 1e22};
    static const double below[] = {1e3, 1e5, 1e9, 9e15};
    int n;
    *x = 2.0 * uniform() - 1.0;
    if (k < 8)
        *x *= ends[k];
    else if (k == 8) /* any exponent: subnormal to the largest */
        do
            *x = of_bits(chance());
        while (!(*x - *x == 0.0));
    else if (k == 9) /* subnormal, and tiny */
        *x = of_bits(chance() & 0xbfffffffffffffffu) * 1e-200;
    else if (k < 14) { /* next to a multiple of pi/2 */
        *x = (double)(int64_t)(*x * below[k - 10]) * 1.5707963267948966;
        n = (int)(chance() % 9) - 4;
        *x = of_bits(bits_of(*x) + (uint64_t)(*x == 0.0 ? 0 : (int64_t)n));
    } else if (k == 14) { /* not so near */
        *x = (double)(int64_t)(*x * 6e4) * 1.5707963267948966;
        n = (int)(chance() % 40);
        *x += ldexp(uniform() - 0.5, -n);
    } else if (k == 15) { /* where what is reduced, and how, changes */
        *x = (1.0 + *x * 1e-10) * (chance() & 1 ? 1e5 : 0.785);
        *x = chance() & 1 ? *x : -*x;
    } else
        return 0;
    return 1;
}

#ifdef QUAD
static double units(double got, __float128 value)
{
    int exponent;
    __float128 error = fabsq((__float128)got - value);
    frexpq(value, &exponent);
    return (double)ldexpq(error, exponent < -1021 ? 1074 : 53 - exponent);
}
#endif

int main(int argc, char **argv)
{
    long count = argc > 1 ? atol(argv[1]) : 1000;
    double x, pair[2], other = 0.0, before[2] = {0.0, 1.0}, both[4];
    int k, different, show = argc > 2;
    for (k = 0; point(k, &x); k++) {
        uint64_t digest = 14695981039346656037u;
        double worst[2] = {0.0, 0.0};
        long i;
        for (i = 0; i < count; i++) {
            point(k, &x);
            lagc_sine_cosine(x, pair);
            lagc_sine_cosine_two(x, other, both); /* in one place, then in the other; ranges mix */
            different = memcmp(both, pair, sizeof pair) || memcmp(both + 2, before, sizeof pair);
            lagc_sine_cosine_two(other, x, both);
            different |= memcmp(both + 2, pair, sizeof pair) || memcmp(both, before, sizeof pair);
            if (different && FLT_EVAL_METHOD == 0)
                return printf("two at once differ at %a, %a\n", x, other), 1;
            if (chance() % 4 == 0) {
                other = x;
                memcpy(before, pair, sizeof pair);
            }
            if (show)
                printf("%a %a %a\n", x, pair[0], pair[1]);
            digest = (digest ^ bits_of(pair[0])) * 1099511628211u;
            digest = (digest ^ bits_of(pair[1])) * 1099511628211u;
#ifdef QUAD
            {
                __float128 s, c;
                double a, b;
                sincosq((__float128)x, &s, &c);
                a = fmax(units(pair[0], s), units(both[2], s));
                b = fmax(units(pair[1], c), units(both[3], c));
                if (!(a <= worst[0]))
                    worst[0] = a;
                if (!(b <= worst[1]))
                    worst[1] = b;
            }
#endif
        }
        if (!show)
            printf("%d %016llx %.4f %.4f\n", k, (unsigned long long)digest, worst[0], worst[1]);
    }
    return 0;
}
