"""Discrete variables: the last entries of the state, which clauses `when` alone change."""

from __future__ import annotations

from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import NDISC, NINT, NQ, NSEARCH, NV, NX
from lagc.kernels.language.words import Vec


def keep_discrete(x: Vec[NX], other: Vec[NX]) -> None:
    """Copy the discrete variables of x, which a step does not change."""
    if NDISC > 0:
        for i in range(NDISC):
            other[NINT + i] = x[NINT + i]


def box_discrete(s: State, w: Work) -> None:
    """Store the discrete variables behind the ends of w.search.box."""
    if NDISC > 0:
        if NSEARCH > 0:
            for i in range(NDISC):
                w.search.box[2 * (NQ + NV) + 2 + i] = s.x[NINT + i]
