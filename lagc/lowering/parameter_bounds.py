"""The bounds that parameters keep: those that were declared, and those that bodies ask for."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf

from lagc.base.records import replace
from lagc.semantics.model import Limit, Model
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import symbols

FLAT = 1.0 + 1e-9  # rounding of a flat body's moments, of which one is the sum of the others


def bounded(model: Model) -> Model:
    """`model` with the bounds that its bodies ask for: neither a mass nor a moment of inertia is negative,
    and no moment is more than the two others together, as each is a sum of squares of two coordinates.
    Where declared bounds see to that already, there are none."""
    asked = list(_inertias(model))
    direct = {limit.value for limit in asked}
    parameters = tuple([
        replace(p, minimum=0.0) if p.symbol in direct and p.minimum < 0.0 else p for p in model.parameters
    ])  # fmt: skip
    known = {p.symbol: (p.minimum, p.maximum) for p in parameters}
    least = intervals([limit.value for limit in asked], known)
    found = [
        limit
        for limit in asked
        if limit.value not in known and not least[limit.value][0] >= 0.0
        and symbols([limit.value]) <= known.keys()
    ]  # fmt: skip
    return replace(model, parameters=parameters, limits=(*model.limits, *found))


def _inertias(model: Model) -> Iterator[Limit]:
    for body in model.bodies:
        yield Limit(f"mass of {body.name}", body.mass, "kg", 0.0, inf, body.span)
        for k, row in enumerate(body.inertia or ()):
            yield Limit(f"moment of inertia {k + 1} of {body.name}", row[k], "kg.m2", 0.0, inf, body.span)
        if body.inertia is not None:
            moments = [row[k] for k, row in enumerate(body.inertia)]
            for k, a in enumerate(moments):
                b, c = moments[k - 2], moments[k - 1]
                room = (b + c) * FLAT - a
                if not any(_part(room) is _part(x) for x in moments):  # that it is not negative is asked
                    name = f"the sum of the other moments of inertia of {body.name} less number {k + 1}"
                    yield Limit(name, room, "kg.m2", 0.0, inf, body.span)


def _part(x: Node) -> Node:
    """What `x` is a positive multiple of."""
    return x.args[0] if x.op == "scale" and x.value > 0.0 else x
