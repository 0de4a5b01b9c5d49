"""How the symbols of the equations are shown to people."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

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
    own = [(p.symbol, p.name) for p in model.parameters] + [(i.symbol, i.name) for i in model.inputs]
    inside = {i + k for i in equations.quaternions for k in range(4)}
    moving = [(s, n) for i, (s, n) in enumerate(zip(equations.q, equations.q_names)) if i not in inside]
    short = _shortener([n for _, n in own + moving] + [n for n in equations.v_names if "(" not in n])
    found = {symbol: Name(short(name), name) for symbol, name in own + moving}
    for i in inside:
        found[equations.q[i]] = Name(equations.q_names[i], equations.q_names[i])
    for speed, acceleration, name in zip(equations.v, equations.a, equations.v_names):
        full = name[4:-1] if name.startswith("der(") else name
        order = 1 if name.startswith("der(") else 0
        base = full if ".rate." in full else short(full)
        found[speed] = Name(base, full, order)
        found[acceleration] = Name(base, full, order + 1)
    for symbol, row in zip(equations.lam, equations.rows):
        found[symbol] = Name(f"lambda_{row.label}", f"lambda_{row.label}")
    taken = {n.base for n in found.values()}
    found[equations.time] = Name("time" if "t" in taken else "t", "time")
    return found


def _shortener(full: Sequence[str]) -> Callable[[str], str]:
    ends: dict[str, set[str]] = {}
    for name in full:
        ends.setdefault(name.rpartition(".")[2], set()).add(name)
    return lambda name: name.rpartition(".")[2] if len(ends.get(name.rpartition(".")[2], ())) == 1 else name


def where(seen: Iterable[Name]) -> list[tuple[str, str]]:
    """(short, full) of the names that were shortened."""
    return sorted({(n.base, n.full) for n in seen if n.base != n.full and n.full != "time"})
