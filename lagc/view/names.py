"""How the symbols of the equations are shown to people."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

from lagc.expr.graph import Node
from lagc.mechanics.equations import EquationsOfMotion
from lagc.records import dataclass


@dataclass(frozen=True, slots=True)
class Name:
    """A symbol as people see it: `base` with so many time derivatives; `full` the model's name."""

    base: str
    full: str
    order: int = 0


def names(equations: EquationsOfMotion) -> dict[Node, Name]:
    """How each symbol is shown: `field.g` as `g` where no other name ends so."""
    model = equations.model
    given = [p.symbol for p in model.parameters] + [i.symbol for i in model.inputs]
    plain = [*given, *(x for x in equations.q if not x.record.component)]
    short = _shortener([x.record.name for x in (*plain, *equations.v) if x.record.order == 0])
    found: dict[Node, Name] = {}
    for symbol in (*plain, *equations.q, *equations.v, *equations.a):
        record = symbol.record
        base = record.base if record.component else short(record.base)
        found[symbol] = Name(base, record.base, record.order)
    for row in equations.rows:
        found[row.multiplier] = Name(f"lambda_{row.label}", f"lambda_{row.label}")
    taken = {n.base for n in found.values()}
    pi = pi_of(equations)
    if pi is not None:
        found[pi] = Name("pi", "pi")
    found[equations.time] = Name("time" if "t" in taken else "t", "time")
    return found


def pi_of(equations: EquationsOfMotion) -> Node | None:
    """The symbol of pi; None where the model calls something else so."""
    model = equations.model
    names = [p.name for p in model.parameters] + [i.name for i in model.inputs] + [*equations.q_names]
    taken = any(name.rpartition(".")[2] == "pi" for name in (*names, *equations.v_names))
    return None if taken else equations.graph.symbol("number", "pi")


def _shortener(full: Sequence[str]) -> Callable[[str], str]:
    ends: dict[str, set[str]] = {}
    for name in full:
        ends.setdefault(name.rpartition(".")[2], set()).add(name)
    return lambda name: name.rpartition(".")[2] if len(ends.get(name.rpartition(".")[2], ())) == 1 else name


def taken(shown: Mapping[Node, Name]) -> set[str]:
    """The words at the beginning of names: counters are not called so."""
    return {re.split(r"[\[.]", name.base)[0] for name in shown.values()}


def where(seen: Iterable[Name]) -> list[tuple[str, str]]:
    """(short, full) of the names that were shortened."""
    return sorted({(n.base, n.full) for n in seen if n.base != n.full and n.full != "time"})
