"""Warnings of weights that count twice, and of systems that nothing moves.

Two potentials have the same forces if they change alike between any two configurations. Random ones are
compared.
"""

from collections.abc import Iterator
from random import Random

from lagc.diagnostics.faults import Fault
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import UNSTATED, Model, Orientation, Potential
from lagc.symbolic.vectors import dot
from lagc.symbolic.walk import evaluate, substitute, symbols

_POSES = 5
_SAME = 0.01  # of the weight: 9.81 and 9.80665 m/s2 are meant alike
_ROUNDING = 1e-9
_MOST = 10_000  # of a potential and a weight


def doubled_weights(model: Model) -> Iterator[Fault]:
    """Yield LAG0435 of each potential that is the weight of a body, or of all, beside `Gravity`."""
    potentials = [action for action in model.actions if isinstance(action, Potential)]
    written = [action for action in potentials if action.gravity is None]
    # The weights that a potential may repeat: of all bodies together, and of each.
    weights = [(field, "all bodies", field.energy) for field in potentials if field.gravity is not None]
    for field in potentials:
        if field.gravity is not None:
            g, direction = field.gravity
            weights += [
                (field, f"`{body.name}`", -(body.mass * g * dot(direction, body.position)))
                for body in model.bodies
            ]
    if not written or not weights or len(written) * len(weights) > _MOST:
        return
    # Changes between random poses tell potentials apart, whatever constant they contain.
    random = Random(0)
    values = {p.symbol: p.value for p in model.parameters if p.value is not None} | {model.time: 0.0}
    moving = [
        s for c in model.coordinates for s in (c.symbols if isinstance(c, Orientation) else (c.symbol,))
    ]
    nodes = [*(action.energy for action in written), *(energy for _, _, energy in weights)]
    try:
        poses = [
            evaluate(nodes, values | {symbol: random.uniform(-1.0, 1.0) for symbol in moving})
            for _ in range(_POSES)
        ]
    except KeyError:  # a value is not known before the run
        return
    changes = [[pose[k] - poses[0][k] for pose in poses] for k in range(len(nodes))]
    for action, own in zip(written, changes):
        for (field, whose, _), theirs in zip(weights, changes[len(written) :]):
            largest = max(theirs, key=abs)
            share = own[theirs.index(largest)] / largest if largest else 0.0
            if abs(share - 1.0) < _SAME and all(
                abs(a - share * b) <= _ROUNDING * abs(largest) for a, b in zip(own, theirs)
            ):
                message = f"`{action.name}` is the weight of {whose}, which `{field.name}` contains already"
                related = ((field.span, "gravity acts on all bodies"),)
                yield Fault("LAG0435", message, action.span, related, "remove one of the two", "warning")
                break


# -- systems that nothing moves ----------------------------------------------------------------------


def motionless_system(equations: EquationsOfMotion) -> list[Fault]:
    """Return LAG0429 if nothing moves the system: at zero speeds there are no forces, and constraints,
    initial values, initial equations, events and time change no speed."""
    v, model, zero = equations.v, equations.model, equations.graph.zero
    stated = [start for start in equations.starts_v if start.stated.level != UNSTATED]
    reset = {state for clause in equations.whens for state, _ in clause.changes}
    if (
        equations.rows or equations.contacts or equations.initial_conditions or equations.stated_rates
        or stated or not reset.isdisjoint(v) or not model.coordinates
    ):  # fmt: skip
        return []
    # At rest no force acts, no coordinate moves, and time moves no place: then it stays so.
    forces = map(equations.graph.sub, equations.given_forces, equations.bias_forces)
    at_rest = substitute(equations.graph, [*forces, *equations.qdot], dict.fromkeys(v, zero))
    axes = [x for body in model.bodies if body.frame for row in body.frame.axes for x in row]
    places = [*axes, *(x for body in model.bodies for x in body.position)]
    if any(not node.is_zero for node in at_rest) or equations.time in symbols(places):
        return []
    names = ", ".join(f"`{c.name}`" for c in model.coordinates[:6])
    names += ", ..." if len(model.coordinates) > 6 else ""
    where = f" in the scene `{model.scene}`" if len(model.scenes) > 1 else ""
    it, has = ("it", "it has") if len(model.coordinates) == 1 else ("them", "they have")
    message = f"nothing moves {names}{where}: no force, energy or constraint acts on {it}, and {has} no "
    message += "initial rate"
    rate = f"{model.coordinates[0].name.partition('[')[0]}(rate = 1)"
    remedy = f"write a force, an energy, `Gravity field;`, or an initial rate such as `{rate}`"
    return [Fault("LAG0429", message, model.coordinates[0].span, remedy=remedy, severity="warning")]
