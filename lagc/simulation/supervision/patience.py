"""When a run in NumPy is given up for one in C."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import perf_counter

from lagc.diagnostics.faults import Refused
from lagc.lowering.program import Interface


class TakesLong(Exception):
    """The run has lasted as long as compiling it to C would, and there is a compiler."""


class Patience:
    """Progress that gives up after `limit` s: at worst, then, the run costs twice what it must."""

    def __init__(self, limit: float, inner: Callable[[float], None] | None):
        self.end = perf_counter() + limit
        self.inner = inner

    def __call__(self, t: float) -> None:
        if perf_counter() > self.end:
            if _compiles():
                raise TakesLong
            self.end = inf
        if self.inner is not None:
            try:
                self.inner(t)
            except Refused:  # it would take too long: perhaps C does not
                if _compiles():
                    raise TakesLong from None
                raise


def compile_time(interface: Interface) -> float:
    """How long a C compiler will take, s: a guess from what it has to read, within a factor of two on a
    machine of 2021."""
    projections = 1.2 if interface.nc else 0.0
    events = 0.4 if interface.switches else 0.0
    return 0.5 + projections + events + 2e-4 * interface.written


def _compiles() -> bool:
    from lagc.simulation.backends.compile import compiler

    return compiler() is not None
