"""Expressions as functions of one leaf at a time.

Of a sum only the terms that the leaf moves are evaluated, so that all n leaves of a sum of n terms cost as
much as a few evaluations of it, not n.  The functions are written in Python, once for all leaves that move
the same operations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import lru_cache
from operator import attrgetter
from typing import Any

from lagc.symbolic.evaluate import extend, value_of
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Table
from lagc.symbolic.operators import LOOKED_UP, VALUES
from lagc.symbolic.walk import reachable

_SUMS = ("add", "scale")


class Shape:
    """What of `node` each of its leaves moves: its sums, with all that is added up in them as terms."""

    def __init__(self, node: Node):
        order = reachable([node])
        uses: dict[Node, list[Node]] = {}
        for user in order:
            for argument in user.args:
                uses.setdefault(argument, []).append(user)
        within = {x for x in order if x.op in _SUMS and [u.op in _SUMS for u in uses.get(x, ())] == [True]}
        self.node = node
        self.sums: dict[Node, dict[Node, float]] = {}
        self.users: dict[Node, list[Node]] = {}
        for x in order:
            if x in within:
                continue
            if x.op in _SUMS:
                self.sums[x] = terms(x, within)
            for below in dict.fromkeys(self.sums.get(x, x.args)):
                self.users.setdefault(below, []).append(x)
        self.places = {x: {t: k for k, t in enumerate(table)} for x, table in self.sums.items()}

    def moved(self, leaf: Node) -> list[Node]:
        """All that `leaf` moves, arguments before users."""
        seen: set[Node] = set()
        stack = [leaf]
        while stack:
            for user in self.users.get(stack.pop(), ()):
                if user not in seen:
                    seen.add(user)
                    stack.append(user)
        return sorted(seen, key=attrgetter("index"))

    def period(self, leaf: Node) -> float:
        """By how much `leaf` may go for `node` to be the same, as it stands in sines and cosines alone;
        infinite where that is not so."""
        speeds: set[float] = set()
        for user in self.users.get(leaf, ()):
            above = [x.op for x in self.users.get(user, ())] if user in self.sums else [user.op]
            if not above or not set(above) <= {"sin", "cos"}:
                return math.inf
            speeds.add(abs(self.sums[user][leaf]) if user in self.sums else 1.0)
        least = min(speeds, default=0.0)
        return 2.0 * math.pi / least if least and all(s % least == 0.0 for s in speeds) else math.inf


class Lines:
    """The expression of a `shape` at a state, as a function of each leaf alone."""

    def __init__(self, shape: Shape, state: Mapping[Node, float]):
        self.shape, self.state = shape, state
        self.known = dict(state)
        extend(self.known, [shape.node])
        self.parts = {x: [c * self.known[t] for t, c in table.items()] for x, table in shape.sums.items()}

    def along(self, leaf: Node) -> Callable[[float], float]:
        """The node as a function of `leaf`; outside its domain the value is NaN."""
        shape, known = self.shape, self.known
        moved = shape.moved(leaf)
        names, lines = {leaf: "x"}, []
        places = {x: k for k, x in enumerate((leaf, *moved))}
        constants: list[float | Table] = [known[shape.node]]

        def constant(value: float | Table) -> str:
            constants.append(value)
            return f"c[{len(constants) - 1}]"

        for k, x in enumerate(moved):
            own = sorted([t for t in shape.sums.get(x, ()) if t in places], key=places.__getitem__)
            if own:
                factors = [f"{constant(shape.sums[x][t])}*{names[t]}" for t in own]
                text = " + ".join([constant(self._rest(x, own)), *factors])
            else:
                arguments = [names.get(a) or constant(known[a]) for a in x.args]
                if x.op in LOOKED_UP:
                    arguments.insert(0, constant(x.value))
                text = f"of_{x.op}({', '.join(arguments)})"
                if x.op == "mul":
                    text = "*".join([f"{a}**{e}" for a, e in zip(arguments, x.value)])
            names[x] = f"y{k}"
            lines.append(f"y{k} = {text}")
        made = _written(tuple(lines), names.get(shape.node, "c[0]"))
        return made(constants, lambda at: self._slowly(leaf, moved, at))

    def _slowly(self, leaf: Node, moved: Sequence[Node], at: float) -> float:
        """Where part of the expression has no value, which not every condition needs."""
        found = {**self.known, leaf: at}
        for x in moved:
            terms = self.shape.sums.get(x)
            found[x] = sum([c * found[t] for t, c in terms.items()]) if terms else value_of(x, found)
        return found[self.shape.node]

    def _rest(self, x: Node, own: Sequence[Node]) -> float:
        """The sum of the terms of x but for `own`."""
        parts, places = list(self.parts[x]), self.shape.places[x]
        for t in own:
            parts[places[t]] = 0.0
        try:
            return math.fsum(parts)
        except (OverflowError, ValueError):
            return math.nan


@lru_cache(1000)
def _written(lines: Sequence[str], result: str) -> Callable[..., Callable[[float], float]]:
    """What makes a function of `lines`, given their constants, and what to ask where it has no value."""
    body = "".join([f"            {line}\n" for line in lines])
    space: dict[str, Any] = {f"of_{op}": function for op, function in VALUES.items()}
    exec(
        "def made(c, slowly):\n    def value(x):\n        try:\n"
        f"{body}            return {result}\n"
        "        except (ValueError, ZeroDivisionError, OverflowError):\n            return slowly(x)\n"
        "    return value\n",
        space,
    )
    found: Callable[..., Callable[[float], float]] = space["made"]
    return found


def terms(node: Node, within: Collection[Node] | None = None) -> dict[Node, float]:
    """The terms of a sum, with their factors; of sums in it those that are `within` (None: all) are taken
    apart."""
    inner, stack = {node}, [node]
    while stack:
        x = stack.pop()
        for argument in x.args if x.op in _SUMS else ():
            if argument.op in _SUMS and argument not in inner and (within is None or argument in within):
                inner.add(argument)
                stack.append(argument)
    found: dict[Node, float] = {node: 1.0}
    for x in sorted(inner, key=attrgetter("index"), reverse=True) if node.op in _SUMS else ():
        c = found.pop(x) * (x.value if x.op == "scale" else 1.0)
        for argument in x.args:
            found[argument] = found.get(argument, 0.0) + c
    return found
