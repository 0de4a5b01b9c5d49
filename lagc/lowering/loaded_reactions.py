"""Loads that depend on reactions: their forces beside the equations without them."""

from collections.abc import Sequence
from typing import Any

from lagc.base.records import dataclass, replace
from lagc.lowering.program import Function
from lagc.lowering.program_functions import made
from lagc.lowering.storage import Places
from lagc.mechanics.formulation.equations import EquationsOfMotion, Law
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends, substitute, symbols


@dataclass(frozen=True, slots=True)
class Loads:
    """The forces on each speed that depend on reactions. Without them, `rest` are the equations. `rows` are
    the numbers of the multipliers, `pushed` of the contacts with these normal forces; `slopes` the
    derivatives of `forces` by all, one after the other. `held` is 1 where an actuator holds the row: the
    force along its gradient, which a servo takes away, is not part of `forces`."""

    rows: tuple[int, ...]
    held: tuple[int, ...]
    pushed: tuple[int, ...]
    forces: tuple[Node, ...]
    slopes: tuple[Node, ...]
    linear: bool
    rest: EquationsOfMotion

    def described(self) -> dict[str, Any]:
        """Return the fields of an interface that tell of them."""
        return {"loading_rows": self.rows, "held_rows": self.held, "pushed_contacts": self.pushed,
                "curved_loads": not self.linear}  # fmt: skip


def loads_of(equations: EquationsOfMotion) -> Loads | None:
    """Return the loads of `equations`, along a step, that depend on reactions; None if there are none."""
    graph, lam = equations.graph, equations.lam
    pushes = [contact.multiplier for contact in equations.contacts]
    used = symbols(equations.given_forces) & {*lam, *pushes}
    if not used:
        return None
    rows = tuple([k for k, symbol in enumerate(lam) if symbol in used])
    pushed = tuple([k for k, symbol in enumerate(pushes) if symbol in used])
    chosen = [*(lam[k] for k in rows), *(pushes[k] for k in pushed)]
    # The system without these loads is solved first, then the law of the reactions.
    none = dict.fromkeys(chosen, graph.zero)
    without = substitute(graph, equations.given_forces, none)
    weights = zip(equations.loads, substitute(graph, list(equations.loads.values()), none))
    rest = replace(
        equations,
        given_forces=tuple(without),
        loads={velocity: weight for velocity, weight in weights if not weight.is_zero},
        power=substitute(graph, [equations.power], dict.fromkeys(pushes, graph.zero))[0],
    )
    held = tuple([int(equations.rows[k].law is Law.SERVO) for k in rows])
    # An actuator that holds a row acts by its multiplier along the gradient of the row.
    given = list(equations.given_forces)
    for k, servo in zip(rows, held):
        for j, slope in equations.rows[k].jacobian.items() if servo else ():
            given[j] += lam[k] * slope
    # Linear loads are the sum of their slopes times the reactions: no difference of large numbers.
    found = [gradient(graph, {force: graph.one}, chosen) for force in given]
    slopes = [own.get(symbol, graph.zero) for symbol in chosen for own in found]
    linear = not depends(slopes, chosen)
    forces = [graph.sub(force, other) for force, other in zip(given, without)]
    if linear:
        forces = [graph.sum(own.get(x, graph.zero) * x for x in chosen) for own in found]
    return Loads(rows, held, pushed, tuple(forces), tuple(slopes), linear, rest)


def loaded(along: Places, loads: Loads) -> Function:
    """Return the function of these forces and their derivatives."""
    parts: tuple[tuple[str, Sequence[Node]], ...] = (("f", loads.forces), ("D", loads.slopes))
    forces = ("contact_forces",) if loads.pushed else ()
    name = "pushed" if forces else "loaded"
    return made(along, name, (*along.state, "lam", *forces), parts, "forces that depend on reactions")
