"""DOP853 in C for a right-hand side in C: the loop that a person writes around generated equations.

Coefficients are SciPy's.  Dense output as in E. Hairer, S. P. Norsett, G. Wanner, Solving ODEs I, II.6; step
control by (II.4.11) with the error of (II.10.17).
"""

from __future__ import annotations

import ctypes
import importlib
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lagc.simulation.backends.compile import FLAGS, compiler
from lagc.study.probe import Array

_TEXT = """\
#include "rhs.c"
#include <math.h>
#include <string.h>
enum { N = @N };
static void f(const double *x, double *dx)
{
    const double *in[1] = { x };
    double *out[1] = { dx };
    rhs(in, out, 0, 0, 0);
}
static double k[16][N], z[N], q[7][N];

/* Integrate to times[n - 1]; out has n rows.  Returns the count of right-hand sides, or -1. */
long solve(const double *x0, const double *times, int n, double tol, double *out)
{
    double y[N], yn[N], t = times[0], h = 1e-4 * (times[n - 1] - t);
    int rejected = 0, next = 1;
    long count = 1;
    memcpy(y, x0, sizeof y);
    memcpy(out, y, sizeof y);
    f(y, k[0]);
    while (next < n) {
        if (!(t + h > t))
            return -1;
        if (t + h > times[n - 1])
            h = times[n - 1] - t;
@STAGES        for (int i = 0; i < N; i++)
            yn[i] = y[i] + h*(@B);
        f(yn, k[12]);
        count += 12;
        double e3 = 0, e5 = 0;
        for (int i = 0; i < N; i++) {
            const double a = fabs(y[i]), b = fabs(yn[i]), scale = tol + tol*(a > b ? a : b);
            const double third = (@E3)/scale, fifth = (@E5)/scale;
            e3 += third*third;
            e5 += fifth*fifth;
        }
        const double below = e5 + 0.01*e3, error = below > 0 ? fabs(h)*e5/sqrt(below*N) : 0;
        double factor = error > 0 ? 0.9*pow(error, -0.125) : 10;
        if (!(error < 1)) {
            h *= factor > 0.2 ? factor : 0.2;
            rejected = 1;
            continue;
        }
        if (times[next] <= t + h) {
@EXTRA            count += 3;
            for (int i = 0; i < N; i++) {
                const double d = yn[i] - y[i];
                q[0][i] = d;
                q[1][i] = h*k[0][i] - d;
                q[2][i] = 2*d - h*(k[12][i] + k[0][i]);
@DENSE            }
            for (; next < n && times[next] <= t + h; next++) {
                const double s = (times[next] - t)/h;
                for (int i = 0; i < N; i++) {
                    double v = 0;
                    for (int j = 6; j >= 0; j--)
                        v = (v + q[j][i])*(j % 2 ? 1 - s : s);
                    out[next*N + i] = y[i] + v;
                }
            }
        }
        t += h;
        memcpy(y, yn, sizeof y);
        memcpy(k[0], k[12], sizeof y);
        factor = factor > 10 ? 10 : factor;
        h *= rejected && factor > 1 ? 1 : factor;
        rejected = 0;
    }
    return count;
}
"""


def _sum(row: Sequence[float]) -> str:
    return " + ".join(f"({float(c)!r})*k[{j}][i]" for j, c in enumerate(row) if c != 0)


def _stage(row: Sequence[float], s: int, indent: str) -> str:
    loop = f"for (int i = 0; i < N; i++)\n{indent}    z[i] = y[i] + h*({_sum(row)});\n"
    return f"{indent}{loop}{indent}f(z, k[{s}]);\n"


def solver(folder: Path, x0: Sequence[float], times: Sequence[float]) -> Callable[[float], Array]:
    """Compile with `rhs.c` of casadi in the folder; the result maps a tolerance to the states."""
    table: Any = importlib.import_module("scipy.integrate._ivp.dop853_coefficients")
    a = table.A
    text = _TEXT.replace("@N", str(len(x0)))
    text = text.replace("@STAGES", "".join(_stage(a[s][:s], s, " " * 8) for s in range(1, 12)))
    text = (
        text.replace("@B", _sum(table.B[:12])).replace("@E3", _sum(table.E3)).replace("@E5", _sum(table.E5))
    )
    text = text.replace("@EXTRA", "".join(_stage(a[s][:s], s, " " * 12) for s in range(13, 16)))
    rows = "".join(f"{' ' * 16}q[{3 + j}][i] = h*({_sum(row)});\n" for j, row in enumerate(table.D))
    (folder / "solve.c").write_text(text.replace("@DENSE", rows))
    words = compiler()
    if words is None:
        raise ImportError("no C compiler")
    subprocess.run([*words, *FLAGS, "solve.c", "-o", "solve.so", "-lm"], check=True, cwd=folder)
    call: Any = ctypes.CDLL(str(folder / "solve.so")).solve
    call.restype = ctypes.c_long
    n, size = len(times), len(x0)
    start, grid = (ctypes.c_double * size)(*x0), (ctypes.c_double * n)(*times)
    out: Any = (ctypes.c_double * (n * size))()

    def run(tolerance: float) -> Array:
        if call(start, grid, ctypes.c_int(n), ctypes.c_double(tolerance), out) < 0:
            raise ArithmeticError("the step size underflowed")
        return np.frombuffer(out, dtype=float).reshape(n, size)

    return run


def casadi_folder(function: Any) -> Path:
    """A temporary folder with the C of a casadi function `rhs`."""
    folder = Path(tempfile.mkdtemp(prefix="lagc-benchmark-"))
    function.generate("rhs.c", {"with_header": False})
    Path("rhs.c").rename(folder / "rhs.c")
    return folder
