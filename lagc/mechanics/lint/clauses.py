"""Warnings of `when` clauses that never act."""

from __future__ import annotations

from collections.abc import Iterator

from lagc.diagnostics.faults import Fault
from lagc.semantics.model import Model
from lagc.symbolic.walk import evaluate, symbols


def idle_clauses(model: Model) -> Iterator[Fault]:
    """Yield LAG0436 of each clause whose condition holds from the start and compares time with discrete
    variables that the clause alone changes: a clause acts when its condition becomes true."""
    values = {p.symbol: p.value for p in model.parameters if p.value is not None} | {model.time: 0.0}
    variables = {d.symbol: d for d in model.discretes}
    for clause in model.whens:
        own = {target for target, _ in clause.changes}
        others = {target for other in model.whens if other is not clause for target, _ in other.changes}
        asked = symbols([clause.condition]) - {p.symbol for p in model.parameters}
        clock = [variables[s] for s in variables if s in asked]
        if not clock or not asked - {model.time} <= own - others or model.time not in asked:
            continue
        try:
            now = values | dict(zip([d.symbol for d in clock], evaluate([d.start for d in clock], values)))
            holds = evaluate([clause.condition], now) == [1.0]
        except KeyError:  # a value is not known before the run
            continue
        if holds:
            message = f"the clause never acts: `{clause.words}` is true at the start, it does not become true"
            remedy = f"give `{clock[0].name}` a start with which the condition is false at time 0"
            yield Fault("LAG0436", message, clause.span, remedy=remedy, severity="warning")
