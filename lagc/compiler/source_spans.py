"""Where in the text of a model it is written that there is no first step, and what to do about it."""

import re
from collections.abc import Iterator, Sequence
from math import inf, isfinite

from lagc.diagnostics.faults import Fault, Refused, Span
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import Body, Potential
from lagc.simulation.initialization.initialize import NoStart
from lagc.simulation.initialization.result import Anchor
from lagc.symbolic.expression_text import text
from lagc.symbolic.graph import Node
from lagc.symbolic.leaves import Symbol
from lagc.symbolic.walk import evaluate, reachable

LONGEST = 60  # characters of an expression that is shown
MOST_SHOWN = 4  # further places
_RUBBING = re.compile(r"/(abs|norm)\((der|velocity)\(")  # of a force against the motion: 0/0 at rest


def placed(equations: EquationsOfMotion, found: NoStart) -> Refused:
    """Return the fault of `found`, with its places in the text that `equations` come from."""
    (fault,) = found.faults
    values = _values(equations, found)
    spans = [(span, label) for anchor in found.anchors for span, label in _spans(equations, anchor)]
    message, remedy = fault.message, fault.remedy
    # A place where an expression has no value explains more than the rows that it spoils, so it comes
    # first.
    strange = _strange(equations, fault.code, found, values)
    if strange is not None:
        where, what = strange
        message += f": {what}"
        if remedy is None and _RUBBING.search(what):
            remedy = "write dry friction as `(friction = 0.3, at = b)` of the constraint to its surface"
        spans = [(where, "here"), *spans] if where is not None else spans
    elif fault.code == "LAG0612":
        light = _light(equations, values)
        spans += [(body.span, f"the mass of `{body.name}` is {mass:g} kg") for body, mass in light]
        remedy = "begin in another configuration, or choose other coordinates: this one moves nothing there"
        if light:
            named = " or ".join([f"`{body.name}`" for body, _ in light[:MOST_SHOWN]])
            remedy = f"give {named} a positive mass, or inertia"
    places = {(span.start, span.end): (span, label) for span, label in reversed(spans)}
    shown = [*reversed(places.values())]
    span = shown[0][0] if shown else None
    return Refused([Fault(fault.code, message, span, tuple(shown[1 : MOST_SHOWN + 1]), remedy)])


def _values(equations: EquationsOfMotion, found: NoStart) -> dict[Node, float]:
    """Return the symbols at the start: those that were dropped are 0."""
    model = equations.model
    values = {equations.time: 0.0}
    for parameter in model.parameters:
        own = found.p.get(parameter.name, parameter.value)
        values[parameter.symbol] = inf - inf if own is None else own
    for given in model.inputs:
        values[given.symbol] = found.p.get(given.name, given.default)
    named = zip((*equations.q, *equations.v), equations.state_names)
    return {**values, **{symbol: found.x.get(name, 0.0) for symbol, name in named}}


def _spans(equations: EquationsOfMotion, anchor: Anchor) -> Iterator[tuple[Span, str]]:
    kind, name = anchor
    if kind == "row":
        yield from ((row.span, f"constraint `{name}`") for row in equations.rows if row.label == name)
    elif kind == "contact":
        yield from ((c.contact.span, f"constraint `{name}`") for c in equations.contacts if c.label == name)
    elif kind == "initial":
        yield equations.initial_conditions[int(name)][1], "a condition of the start"
    else:
        for own, start in zip(_begun(equations), equations.starts):
            if own.name == name:
                yield (start.stated.span if kind == "start" else _declaration_of(equations, own)), f"`{name}`"


def _begun(equations: EquationsOfMotion) -> list[Symbol]:
    """Return the states and rates to which `equations.starts` belong."""
    rates = [s.symbol for s in equations.stated_rates]
    return [x.record for x in (*equations.q, *equations.v, *rates)]


def _declaration_of(equations: EquationsOfMotion, state: Symbol) -> Span:
    """Return the place where the coordinate or speed of a state is declared."""
    things = (*equations.model.coordinates, *equations.model.speeds)
    return next(thing.span for thing in things if thing.name == state.owner)


def _light(equations: EquationsOfMotion, values: dict[Node, float]) -> list[tuple[Body, float]]:
    """Return the bodies without mass."""
    bodies = equations.model.bodies
    masses = evaluate([body.mass for body in bodies], values)
    return [(body, mass) for body, mass in zip(bodies, masses) if not mass > 0.0]


def _strange(
    equations: EquationsOfMotion, code: str, found: NoStart, values: dict[Node, float]
) -> tuple[Span | None, str] | None:
    """Return the first expression without a finite value, and the place of what it belongs to."""
    for span, nodes in _suspects(equations, code, found):
        what = _culprit(nodes, values)
        if what is not None:
            return span, what
    return None


def _suspects(
    equations: EquationsOfMotion, code: str, found: NoStart
) -> Iterator[tuple[Span | None, Sequence[Node]]]:
    """Yield the expressions that may lack a value: those of the model text first, then derived ones."""
    labels = {name for kind, name in found.anchors if kind == "row"}
    if code in ("LAG0610", "LAG0611"):
        for state, start in zip(_begun(equations), equations.starts):
            if ("start", state.name) in found.anchors:
                yield start.stated.span, [start.value]
        for row in equations.rows:
            if row.label in labels:
                yield row.span, [row.residual, row.rate, *row.jacobian.values()]
        for k, (residual, span) in enumerate(equations.initial_conditions):
            if ("initial", str(k)) in found.anchors:
                yield span, [residual]
    # Derived expressions come last: a fault in the text explains those that follow from it.
    if code != "LAG0613":
        return
    spans = {thing.name: thing.span for thing in (*equations.model.bodies, *equations.model.actions)}
    for action in equations.model.actions:
        if isinstance(action, Potential):
            yield action.span, [action.energy]
    for contribution in equations.contributions:
        nodes = [*contribution.forces.values(), contribution.power]
        yield spans.get(contribution.name), nodes
    for body in equations.model.bodies:
        yield body.span, [body.mass]
    for row in equations.rows:
        yield row.span, [row.rate, *row.jacobian.values(), row.gamma]
    derived = [*equations.qdot, *equations.bias_forces, *equations.given_forces, equations.power]
    yield None, [*derived, *equations.mass_matrix.values()]


def _culprit(nodes: Sequence[Node], values: dict[Node, float]) -> str | None:
    """Return the first of all below `nodes` that has no finite value where its arguments have."""
    known = [node for node in reachable(nodes) if node.op != "symbol" or node in values]
    order = [node for node in known if node.op not in ("select", "and", "or", "not", "lt", "le", "eq")]
    if any(node.op == "symbol" and node not in values for node in reachable(nodes)):
        return None  # accelerations and multipliers, which are not known
    found = dict(zip(order, evaluate(order, values)))
    for node in order:
        if not isfinite(found[node]) and all(isfinite(found.get(a, 0.0)) for a in node.args):
            return f"{_shown(node)} has no finite value{_where(node, found)}"
    return None


def _where(node: Node, found: dict[Node, float]) -> str:
    parts = [
        f"{_shown(a)} = {found[a]:.6g}" for a in node.args if a.op != "const" and a in found and a is not node
    ]
    return f", where {' and '.join(parts)}" if parts and len(parts) <= 3 else ""


def _shown(node: Node) -> str:
    written = text(node)
    return f"`{written}`" if len(written) <= LONGEST else "an expression"
