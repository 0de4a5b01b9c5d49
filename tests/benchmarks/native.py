"""Generated C, timed in C: a small driver beside the files that `lagc build` writes.

Times are CPU times of the driver's process, medians of seven batches.  The flags are those of
the C backend, so that what is timed here is what `lagc sim` runs.
"""

from __future__ import annotations

import resource
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lagc.compiler.pipeline import Choice, program, render
from lagc.host import model_library
from lagc.simulation.backends.compile import FLAGS, compiler

DRIVER = r"""
#define _POSIX_C_SOURCE 199309L
#include "@.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    const double u = *(const double *)a, v = *(const double *)b;
    return (u > v) - (u < v);
}

static double x0[@@_NX + 1], x[@@_NX + 1], lam[@@_NC + 1];
static @_work work;
static @_params p;

static double rhs_batch(long n)
{
    const double first = x0[0], began = now();
    double xdot[@@_NX + 1];
    long k;
    for (k = 0; k < n; k++) {
        x0[0] = first + 1e-9 * (double)(k & 7);
        @_rhs(&p, 0.0, x0, xdot, lam, &work);
    }
    x0[0] = first;
    return (now() - began) / (double)n;
}

static int run(const @_options *o, double t1, @_state *s)
{
    memset(&work, 0, sizeof work);
    @_begin(s, 0.0, x0);
    return (int)@_advance(&p, s, t1, o, &work);
}

/* rhs | run METHOD TOL T1,  then x0 */
int main(int n, char **word)
{
    double times[7];
    int i, status = 0, first = word[1][1] == 'h' ? 2 : 5;
    @_state s;
    p = @_default_params();
#ifdef @@_NPREPARED
    @_bind(&p);
#endif
    for (i = 0; i < @@_NQ + @@_NV && first + i < n; i++)
        x0[i] = strtod(word[first + i], NULL);
    if (first == 2) {
        double once = rhs_batch(3);
        long count = (long)(0.02 / (once + 1e-9)) + 3;
        for (i = 0; i < 7; i++)
            times[i] = rhs_batch(count);
        qsort(times, 7, sizeof *times, by_size);
        printf("%.17g\n", times[3]);
        return 0;
    }
    @_options o = @_default_options();
    o.method = atoi(word[2]);
    o.rtol = o.atol = strtod(word[3], NULL);
    const double t1 = strtod(word[4], NULL);
    double once = now();
    run(&o, t1, &s);
    once = now() - once;
    const int count = once > 0.02 ? 1 : (int)(0.02 / (once + 1e-7)) + 1;
    for (i = 0; i < 7; i++) {
        double began = now();
        int k;
        for (k = 0; k < count; k++)
            status = run(&o, t1, &s);
        times[i] = (now() - began) / count;
    }
    qsort(times, 7, sizeof *times, by_size);
    @_rhs(&p, s.t, s.x, x, lam, &work);
    printf("%.17g %d %ld %ld %ld %d", times[3], status, s.steps, s.rejected, s.rhs, @@_NX);
    for (i = 0; i < @@_NX; i++)
        printf(" %.17g", s.x[i]);
    for (i = 0; i < @@_NC; i++)
        printf(" %.17g", lam[i]);
    printf("\n");
    return 0;
}
"""


@dataclass(frozen=True)
class Run:
    """One integration: CPU seconds, the status, the counts, the state x and multipliers at the end."""

    seconds: float
    status: int
    steps: int
    rejected: int
    rhs: int
    x: tuple[float, ...]
    lam: tuple[float, ...]


class Native:
    """Generated C with the driver; `x0` is where its right-hand side is timed and runs begin.
    `seconds`: CPU time that the C compiler took for it."""

    def __init__(self, sources: Mapping[str, str], x0: Sequence[float]):
        self.words = [repr(float(a)) for a in x0]
        folder = Path(tempfile.mkdtemp(prefix="lagc-benchmark-"))
        for name, text in sources.items():
            (folder / name).write_text(text)
        own = next(name for name in sources if name.endswith(".h")).removesuffix(".h")
        (folder / "driver.c").write_text(DRIVER.replace("@@", own.upper()).replace("@", own))
        self.path = folder / "driver"
        words = compiler()
        assert words is not None, "these benchmarks need a C compiler"
        flags = [flag for flag in FLAGS if flag not in ("-shared", "-fPIC")]
        began = _of_children()
        subprocess.run([*words, *flags, "-c", f"{own}.c"], check=True, cwd=folder)
        self.seconds = _of_children() - began
        subprocess.run(
            [*words, *flags, "-o", "driver", "driver.c", f"{own}.o", "-lm"], check=True, cwd=folder
        )

    @classmethod
    def shipped(cls, model: str, x0: Sequence[float]) -> Native:
        """Of a model of the library."""
        return cls(render(program(model_library.read(model), Choice()), "c"), x0)

    def rhs(self, x: Sequence[float] = ()) -> float:
        """CPU seconds of one right-hand side, at x0 or at x."""
        return float(self._ask("rhs", *(map(repr, x) if x else self.words))[0])

    def run(self, t1: float, tolerance: float, method: str = "dop853") -> Run:
        """From x0 to t1 with rtol = atol = tolerance."""
        number = {"dop853": "0", "dopri5": "1"}[method]
        words = self._ask("run", number, repr(tolerance), repr(t1), *self.words)
        values = [float(w) for w in words[6:]]
        status, steps, rejected, rhs, nx = [int(w) for w in words[1:6]]
        return Run(float(words[0]), status, steps, rejected, rhs, tuple(values[:nx]), tuple(values[nx:]))

    def _ask(self, *words: str) -> list[str]:
        done = subprocess.run([str(self.path), *words], check=True, capture_output=True, text=True)
        return done.stdout.split()


def _of_children() -> float:
    """CPU seconds of processes that were waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
