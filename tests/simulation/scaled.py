"""The same model in other units of length, mass and time: every number with a dimension is another."""

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import pytest

from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.lowering.program import Program
from lagc.semantics.declarations import bodies
from lagc.semantics.names.scope import Array, Scalar, Value
from lagc.semantics.units import Dimension, Unit, unit
from lagc.semantics.values import evaluate
from lagc.simulation.backends.c import CModel
from lagc.simulation.backends.python import NumpyModel
from lagc.simulation.system import System

Factors = tuple[Fraction, Fraction, Fraction]  # of kg, m, s


def factor(dimension: Dimension, factors: Factors) -> float:
    """What a number of `dimension` is multiplied by."""
    found = Fraction(1)
    rest = 1.0
    for base, exponent in zip(factors, dimension):
        whole, part = divmod(exponent, 12)
        found *= base**whole
        rest *= float(base) ** (part / 12)
    return float(found) * rest


@contextmanager
def units(factors: Factors) -> Iterator[None]:
    """Within it, models are read with all their numbers in the other units."""
    to_si, with_dimension = Unit.to_si, evaluate._with_dimension

    def other_si(self: Unit, value: float) -> float:
        return to_si(self, value) * factor(self.dimension, factors)

    def other_with_dimension(value: Value, dimension: Dimension, bare: bool) -> Value:
        found = with_dimension(value, dimension, bare)
        if isinstance(value, Array) or not isinstance(found, Scalar) or found is value:
            return found
        return Scalar(factor(dimension, factors) * found.node, found.dimension)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Unit, "to_si", other_si)
        patch.setattr(evaluate, "_with_dimension", other_with_dimension)
        patch.setattr(bodies, "STANDARD", bodies.STANDARD * factor(bodies.GRAVITY, factors))
        yield


def program(source: Source, factors: Factors, **choice: Any) -> Program:
    """For a run."""
    with units(factors):
        model = pipeline.resolve(pipeline.parse(source), pipeline.Choice(**choice))
        return pipeline.optimize(pipeline.derive(model), work=True)


def system(made: Program, backend: str) -> System:
    kind = CModel if backend == "c" else NumpyModel
    model = kind(made.interface, pipeline.render(made, backend))
    return model.bind(model.defaults())


def state_factors(made: Program, factors: Factors) -> list[float]:
    """Of each entry of x."""
    interface = made.interface
    texts = [*interface.q_units, *interface.v_units, *["J"] * interface.nz,
             *(variable.unit for variable in interface.discretes)]  # fmt: skip
    return [factor(unit(text or "1").dimension, factors) for text in texts]
