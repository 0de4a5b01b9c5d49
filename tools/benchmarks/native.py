"""One right-hand side of generated C, timed in C: a small driver beside the files that `lagc build` writes.

Times are CPU times of the driver's process, medians of seven batches.  The flags are those of
the C backend, so that what is timed here is what `lagc sim` runs.
"""

from __future__ import annotations

import resource
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from lagc.simulation.backends.compile import FLAGS, compiler

DRIVER = r"""
#define _POSIX_C_SOURCE 199309L
#include "@.h"
#include <stdio.h>
#include <stdlib.h>
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

static double x0[@@_NX + 1], xdot[@@_NX + 1], lam[@@_NC + 1];
static @_work work;
static @_params p;

static double batch(long n)
{
    const double first = x0[0], began = now();
    for (long k = 0; k < n; k++) {
        x0[0] = first + 1e-9 * (double)(k & 7);
        @_rhs(&p, 0.0, x0, xdot, lam, &work);
    }
    x0[0] = first;
    return (now() - began) / (double)n;
}

int main(int n, char **word)
{
    double times[7];
    p = @_default_params();
#ifdef @@_NPREPARED
    @_bind(&p);
#endif
    for (int i = 0; i < @@_NQ + @@_NV && i + 1 < n; i++)
        x0[i] = strtod(word[i + 1], NULL);
    const long count = (long)(0.02 / (batch(3) + 1e-9)) + 3;
    for (int i = 0; i < 7; i++)
        times[i] = batch(count);
    qsort(times, 7, sizeof *times, by_size);
    printf("%.17g\n", times[3]);
    return 0;
}
"""


class Native:
    """Generated C with the driver; its right-hand side is timed at `x0`.  `seconds`: CPU time that the C
    compiler took for it."""

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

    def rhs(self) -> float:
        """CPU seconds of one right-hand side."""
        done = subprocess.run([str(self.path), *self.words], check=True, capture_output=True, text=True)
        return float(done.stdout)


def _of_children() -> float:
    """CPU seconds of processes that were waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
