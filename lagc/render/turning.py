"""The kernel of sine and cosine, for models that have angles."""

from __future__ import annotations

from lagc.optimize.program import Program, uses
from lagc.render.kernels.assembly import Chosen, chosen
from lagc.render.kernels.shipped import parts


def turning(program: Program) -> Chosen:
    """`sine_cosine` and what it calls, where a function of the model has a sine or cosine; else nothing."""
    there = any(
        n and o.op in ("sin", "cos")
        for f in program.functions.values()
        for o, n in zip(f.operations, uses(f))
    )
    return chosen(parts(), {}, ["sine_cosine"] if there else [])
