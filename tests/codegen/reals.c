/* Integrates the model from a start to t1 and prints the end: PREFIX, UPPER and REAL are given. */
#include <stdio.h>
#include <stdlib.h>
#ifdef QUAD
#include <quadmath.h>
#endif

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define NAME(n) JOIN(PREFIX, n)
#define SIZE(n) JOIN(UPPER, n)

static REAL parse(const char *text)
{
#ifdef QUAD
    return strtoflt128(text, NULL);
#else
    return (REAL)strtod(text, NULL);
#endif
}

int main(int count, char **words)
{
    NAME(_params) p = NAME(_default_params)();
    NAME(_options) o = NAME(_default_options)();
    NAME(_work) *w = calloc(1, NAME(_work_size)());
    NAME(_state) *s = calloc(1, NAME(_state_size)());
    REAL x[SIZE(_NX)];
    int i, status;
#ifdef PREPARED
    NAME(_bind)(&p);
#endif
    o.rtol = parse(words[2]);
    o.method = atoi(words[3]);
    for (i = 0; i < SIZE(_NX) && i + 4 < count; i++)
        x[i] = parse(words[4 + i]);
    NAME(_begin)(s, 0, x);
    status = NAME(_advance)(&p, s, parse(words[1]), &o, w);
    printf("%d\n", status);
    for (i = 0; i < SIZE(_NX); i++) {
#ifdef QUAD
        char text[64];
        quadmath_snprintf(text, sizeof text, "%.36Qe", s->x[i]);
        printf("%s\n", text);
#else
        printf("%.17g\n", (double)s->x[i]);
#endif
    }
    return 0;
}
