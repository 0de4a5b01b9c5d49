"""Models whose discrete variables are held, as linear models and derivatives take them."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.kernels import SERIES

if TYPE_CHECKING:
    from lagc.semantics.model import Model

DERIVED = ("derivatives", "sensitivities")


def refuse_contacts(model: Model, variant: str) -> None:
    """Raise Refused (LAG0623) if a model has contacts or dry friction, which this variant does not follow."""
    if model.contacts:
        asked = {"derivatives": "derivatives", "sensitivities": "sensitivities",
                 **dict.fromkeys(SERIES, "methods by power series, such as taylor,")}  # fmt: skip
        contact = model.contacts[0]
        message = f"{asked[variant]} do not follow {contact.title} yet"
        other = "compare runs with values that differ a little" if variant in DERIVED else "take dop853"
        if not contact.normals or variant not in SERIES:
            other += f", or {contact.otherwise}"
        raise Refused([Fault("LAG0623", message, contact.span, remedy=other)])


def with_fixed_discretes(model: Model) -> Model:
    """Return a model whose discrete variables are inputs: linear models and derivatives hold them. Those on
    which constraints depend, as the speed of a belt, are parameters."""
    from lagc.semantics.model import Input, Parameter
    from lagc.symbolic.walk import evaluate, symbols

    values = {p.symbol: float("nan") if p.value is None else p.value for p in model.parameters}
    fixed = symbols([residual for c in model.constraints for residual in c.residuals])
    held, given = list(model.parameters), list(model.inputs)
    for x in model.discretes:
        value, last = evaluate([x.start], values)[0], (-inf, inf, x.span, x.description)
        if x.symbol in fixed:
            held.append(Parameter(x.name, x.symbol, x.unit, x.display_unit, value, *last))
        else:
            given.append(Input(x.name, x.symbol, x.unit, value, *last))
    return replace(model, parameters=tuple(held), inputs=tuple(given), discretes=(), whens=())
