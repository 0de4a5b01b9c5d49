"""Runs of generated C in a loop, without Python between the steps: the states, the counts and the CPU time.

A probe is one more C file beside the generated ones.  It exists for `double`, and for `__float128`, whose
results are returned as sums of two doubles.
"""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from ctypes import c_double, c_int, c_long, c_size_t
from dataclasses import dataclass
from math import inf
from time import perf_counter, process_time
from typing import Any

import numpy as np
import numpy.typing as npt

from lagc.kernels import METHODS
from lagc.lowering.program import Interface
from lagc.simulation.backends.compile import library
from lagc.simulation.system import INTERRUPTED, OK, TERMINATED

Array = npt.NDArray[np.float64]
SLICE = {"double": 500, "quad": 5}  # steps between two looks at the clock and at signals
QUAD_FLAGS = ("-O0", "-std=gnu99", "-lquadmath")  # all time is in calls for __float128
_TEXT = """\
#include "@.h"
#include <string.h>

typedef REAL real;
static @_params p;
static @_state s;
static @_work w;

/* Integrate `repeats` times from x0 at times[0]; room has n*(NX + 1) + NY + 1 numbers. The last run is
 * returned as hi + lo: n rows of NX states, then n rows of NY outputs. After `slice` steps (0: no limit) it
 * returns: call again `resumed`, with the same room. counts: right-hand sides, steps,
 * rejected steps, recorded times. */
int lagc_probe(const double *values, int count, int method, double rtol, double step, const double *x0,
               const double *times, size_t n, long repeats, long slice, int resumed, real *room, double *hi,
               double *lo, long *counts)
{
    real x[@@_NX > 0 ? @@_NX : 1];
    real *grid = room, *states = room + n, *y = room + n*(@@_NX + 1);
    static size_t done;
    int status = 0;
    p = @_default_params();
    for (int j = 0; j < count; j++)
        ((real *)&p)[j] = values[j];
    BIND
    for (size_t k = 0; k < n; k++)
        grid[k] = times[k];
    @_options o = @_default_options();
    o.method = method;
    o.rtol = rtol;
    o.atol = 0;
    o.step = step;
    o.max_steps = 0;
    for (long r = 0; r < repeats; r++) {
        if (!resumed) {
            for (int i = 0; i < @@_NX; i++)
                x[i] = x0[i];
            memset(&w, 0, sizeof w);
            @_begin(&s, grid[0], x);
            done = 0;
        }
        status = @_record(&p, &s, &o, grid, n, states, &done, slice, &w);
    }
    if (status == INTERRUPTED)
        return status;
    for (size_t k = 0; k < done*@@_NX; k++) {
        hi[k] = (double)states[k];
        lo[k] = (double)(states[k] - hi[k]);
    }
    OUTPUTS
    counts[0] = s.rhs;
    counts[1] = s.steps;
    counts[2] = s.rejected;
    counts[3] = (long)done;
    return status;
}
"""
_OUTPUTS = """\
hi += n*@@_NX;
    lo += n*@@_NX;
    for (size_t k = 0; k < done; k++) {
        (void)@_outputs(&p, grid[k], states + k*@@_NX, y, &w);
        for (int i = 0; i < @@_NY; i++) {
            *hi = (double)y[i];
            *lo++ = (double)(y[i] - *hi);
            hi++;
        }
    }"""


@dataclass(frozen=True)
class Setting:
    """A method with a relative tolerance, or with a fixed step in s."""

    method: str
    rtol: float = 0.0
    step: float = 0.0

    @property
    def size(self) -> float:
        """The tolerance or the step."""
        return self.step or self.rtol

    def __str__(self) -> str:
        return f"--step {self.step:.1e}" if self.step else f"--rtol {self.rtol:.1e}"


@dataclass(frozen=True)
class Shot:
    """One run of a probe: values hi + lo, a row for each recorded time and a column for each quantity."""

    hi: Array
    lo: Array
    rhs: int
    steps: int
    rejected: int
    seconds: float  # CPU time
    ended: bool  # by the model


class Failed(Exception):
    """A run that did not reach its end; `status` of the C interface."""


class Late(Exception):
    """A run that has passed the deadline of its probe: no failure of its setting, which others survive."""


class Probe:
    """The generated C of a model with the parameter values of a run, and the initial state x0. A run that
    goes on at the deadline (of `perf_counter`) ends. `look` is called now and then, and may raise."""

    deadline = inf
    look: Callable[[], None] = staticmethod(lambda: None)

    def __init__(self, sources: Mapping[str, str], interface: Interface, values: Sequence[float],
                 x0: Sequence[float], real: str = "double", flags: tuple[str, ...] = ()):  # fmt: skip
        (own,) = [name.removesuffix(".c") for name in sources if name.endswith(".c")]
        header, quad = sources[f"{own}.h"], real == "quad"
        text = _TEXT.replace("OUTPUTS", _OUTPUTS if interface.outputs else "(void)y;")
        text = text.replace("BIND", "@_bind(&p);" if f" {own}_bind(" in header else "")
        text = text.replace("REAL", "__float128" if quad else "double")
        text = text.replace("INTERRUPTED", str(INTERRUPTED))
        text = text.replace("@@", own.upper()).replace("@", own)
        compiled = library({**sources, "probe.c": text}, (*flags, *(QUAD_FLAGS if quad else ())))
        self._call: Any = compiled.lagc_probe
        self._slice = SLICE[real]
        self._real: Any = ctypes.c_longdouble if quad else c_double  # 16 bytes, aligned, as __float128
        self.nx, self.ny = interface.nx, len(interface.outputs)  # without a work integral
        self.moving = interface.nq + interface.nv  # discrete variables jump between recorded times
        first = [*x0[: self.moving], *x0[len(x0) - len(interface.discretes) :]]
        self.values, self.x0 = (c_double * len(values))(*values), (c_double * self.nx)(*first)

    def run(self, setting: Setting, times: Sequence[float], repeats: int = 1) -> Shot:
        """Integrate `repeats` times and record.  Raises Failed, and Late at the deadline. Within repeated
        runs, which are short (2 ms in all), it looks neither at the clock nor at signals."""
        n, columns = len(times), self.nx + self.ny
        room = (self._real * (n * (self.nx + 1) + self.ny + 1))()
        hi, lo = (c_double * (n * columns))(), (c_double * (n * columns))()
        counts = (c_long * 4)()
        grid = (c_double * n)(*times)
        began = process_time()
        status, resumed = INTERRUPTED, 0
        while status == INTERRUPTED:
            if perf_counter() > self.deadline:
                raise Late("a run takes longer than the budget")
            status = self._call(
                self.values, c_int(len(self.values)), c_int(METHODS.index(setting.method)),
                c_double(setting.rtol), c_double(setting.step), self.x0, grid,
                c_size_t(n), c_long(repeats), c_long(self._slice if repeats == 1 else 0), c_int(resumed),
                room, hi, lo, counts,
            )  # fmt: skip
            resumed = 1
            self.look()
        seconds = (process_time() - began) / repeats
        if status not in (OK, TERMINATED):
            raise Failed(status)
        rhs, steps, rejected, done = counts
        high, low = (self._table(part, n, done) for part in (hi, lo))
        return Shot(high, low, rhs, steps, rejected, seconds, status == TERMINATED)

    def _table(self, flat: Any, n: int, done: int) -> Array:
        values = np.frombuffer(flat, dtype=float)
        states = values[: n * self.nx].reshape(n, self.nx)[:done]
        outputs = values[n * self.nx :].reshape(n, self.ny)[:done]
        return np.hstack([states[:, : self.moving], outputs])
