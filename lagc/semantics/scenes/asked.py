"""The outputs and coordinates that a run is asked for."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics.model import Coordinate, Model

MOST_NAMED = 12


def asked_for(model: Model, names: Sequence[str]) -> Model:
    """Return the model with those of its outputs that are among `names`.  Raises Refused (LAG0606) for a name
    that is no output, coordinate or speed."""
    known = [output.name for output in model.outputs]
    for c in model.coordinates:
        symbols = (c.symbol, c.rate_symbol) if isinstance(c, Coordinate) else (*c.symbols, *c.rate_symbols)
        known += [c.name, *(symbol.record.name for symbol in symbols)]
    known += [speed.name for speed in model.speeds]
    known = list(dict.fromkeys(known))
    faults = []
    for name in names:
        if name not in known:
            there = ", ".join([f"`{x}`" for x in known]) if len(known) <= MOST_NAMED else ""
            remedy = did_you_mean(name, known) or (f"there are {there}" if there else None)
            faults.append(Fault("LAG0606", f"there is no output or coordinate `{name}`", remedy=remedy))
    if faults:
        raise Refused(faults)
    kept = tuple([output for output in model.outputs if output.name in names])
    return replace(model, outputs=kept, asked=tuple(names))
