"""Classification of the explicit constraints into rows.

A residual without rates is holonomic: phi(t,q) = 0, with its rate d(phi)/dt = 0 at velocity level. Any other
is a velocity row psi(t,q,v) = 0, affine in v or not. For both,

    G = d(rate)/d(v)        G a = gamma,  gamma = -d(rate)/dt along the motion with v' = 0.
"""

from collections.abc import Sequence

from lagc.base.records import dataclass
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import Law, Level, Row
from lagc.mechanics.formulation.jacobian import formed_of, gradients
from lagc.mechanics.formulation.states import States
from lagc.semantics.model import Constraint
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.expression_text import text
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends, symbols


@dataclass(frozen=True, slots=True)
class Classified:
    """A row, its constraint and the power that its multiplier of one does when drives move it."""

    row: Row
    constraint: Constraint
    drive: Node  # in v; zero for a row that is at rest with the coordinates


def classify(states: States) -> list[Classified]:
    """Return the rows of the model's constraints, holonomic ones first, in the order of declaration. Raises
    Refused: LAG0407 a row that depends on an input, LAG0408 a row that no motion meets."""
    model = states.model
    labels = [(c, k) for c in model.constraints for k in range(len(c.residuals))]
    raw = [c.residuals[k] for c, k in labels]
    _check(states, labels, raw)
    residuals = states.in_speeds(raw)
    with_speeds = depends(residuals, states.v)
    # Every row is brought to its rate, a holonomic one by d/dt with the speeds held, and the rate to
    # G a = gamma: gamma is minus the derivative of the rate along the states.
    holonomic = [x for x in residuals if x not in with_speeds]
    rate_of = dict(zip(holonomic, tangent(states.graph, holonomic, states.drift)))
    rates = [rate_of.get(x, x) for x in residuals]
    gammas = tangent(states.graph, rates, states.drift)
    in_time = depends(residuals, [model.time])
    jacobians = gradients(states.graph, rates, states.place_of_v)
    # A row is affine if its gradient does not depend on the speeds. The nodes that gradients
    # are formed of are asked first, because the gradients of long chains are not formed.
    varies = depends(formed_of(jacobians), states.v)
    affine = [
        residual in rate_of or not varies or not depends(own.values(), states.v)
        for residual, own in zip(residuals, jacobians)
    ]
    found: list[Classified] = []
    for n, (c, k) in enumerate(labels):
        row = Row(
            label=c.labels[k],
            constraint=c.name,
            level=Level.VELOCITY if residuals[n] in with_speeds else Level.POSITION,
            law=Law.SERVO if c.actuator else Law.PERFECT,
            multiplier=states.graph.symbol("multiplier", c.labels[k]),
            residual=residuals[n],
            rate=rates[n],
            jacobian=jacobians[n],
            gamma=-gammas[n],
            unit=c.units[k],
            time_dependent=residuals[n] in in_time,
            linear=affine[n],
            span=c.span,
            effect=c.effect,
        )
        found.append(Classified(row, c, _drive(states, row, raw[n])))
    return sorted(found, key=lambda x: not x.row.holonomic)


def _drive(states: States, row: Row, raw: Node) -> Node:
    """Return sum of rate_i d(rate of row)/d(rate_i) less the rate of the row, which is zero. For an affine
    row that is minus its value at rest: the speed that the drive imposes."""
    # For an affine row r(v) = A v + b this is -b. In general the homogeneous part of degree 1 less the row:
    # Euler's theorem, sum of rate_i dr/d(rate_i) - r.
    graph = states.graph
    if row.holonomic:
        moved = row.time_dependent
        return -tangent(graph, [row.residual], {states.model.time: graph.one})[0] if moved else graph.zero
    if row.linear:
        return -states.at_rest([raw])[0]
    raw = states.in_rates([raw])[0]
    slopes = gradient(graph, {raw: graph.one}, list(states.rates))
    total = graph.sum(rate * slope for rate, slope in slopes.items()) - raw
    return states.in_speeds([total])[0]


def _check(states: States, labels: Sequence[tuple[Constraint, int]], raw: Sequence[Node]) -> None:
    # An input has no known derivative, so a row that depends on one has no rate.
    inputs = {given.symbol: given.name for given in states.model.inputs}
    driven = depends(raw, inputs)
    faults: list[Fault] = []
    for (c, k), node in zip(labels, raw):
        if node in driven:
            own = symbols([node])
            faults.append(_driven_by_input(c, next(inputs[u] for u in inputs if u in own)))
        elif node.is_const and not node.is_zero:
            faults.append(_impossible(c, k, node))
    if faults:
        raise Refused(faults)


def _driven_by_input(c: Constraint, u: str) -> Fault:
    return Fault(
        "LAG0407",
        f"the constraint `{c.name}` depends on the input `{u}`, whose time derivative is not known",
        c.span,
        remedy=f"say what `{u}` is over `time` before it is compiled, in a scene, by `--input '{u}=...'` or "
        f'`compile(inputs={{"{u}": ...}})`, or let it act through a force',
    )


def _impossible(c: Constraint, k: int, node: Node) -> Fault:
    amount = f"{text(node)} {c.units[k]}".rstrip()
    return Fault(
        "LAG0408",
        f"no motion meets the constraint `{c.labels[k]}`: its sides always differ by {amount}",
        c.left.span,
        ((c.right.span, "differs from this"),),
        remedy="correct one of the two sides, or remove the constraint",
    )
