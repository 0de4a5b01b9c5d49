"""The invariants of the objects between the stages: a model, its equations of motion, a program."""

from functools import singledispatch
from itertools import chain

from lagc.lowering.program import Function, Program, operands
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.jacobian import formed_of
from lagc.semantics.model import Coordinate, Force, Model, Potential, Torque
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable, symbols


@singledispatch
def verify(stage: object) -> None:
    """Check the invariants of the object; AssertionError or ValueError names the first one that fails."""
    raise TypeError(type(stage))


@verify.register
def _(model: Model) -> None:
    for group in (model.parameters, model.inputs, model.coordinates, model.speeds, model.frames, model.points,
                  model.bodies, model.actions, model.constraints, model.outputs,
                  model.discretes):  # fmt: skip
        names = [item.name for item in group]
        assert len(names) == len(set(names)), f"a name stands twice: {names}"
    labels = [label for c in model.constraints for label in c.labels]
    assert len(labels) == len(set(labels))
    for constraint in model.constraints:
        assert len(constraint.labels) == len(constraint.residuals) == len(constraint.units)
        assert not any(residual.is_zero for residual in constraint.residuals)
    nodes = expressions_of_motion(model)
    assert all(node.graph is model.graph for node in nodes)
    known = {"time", "parameter", "input", "coordinate", "rate", "speed", "discrete", "multiplier"}
    for kind in {node.record.kind for node in reachable(nodes) if node.op == "symbol"}:
        assert kind in known, f"{kind} stands outside of the outputs"


def expressions_of_motion(model: Model) -> list[Node]:
    """Return all expressions but those of the outputs."""
    found: list[Node] = []
    for frame in model.frames:
        found += [x for row in frame.axes for x in row] + [*frame.angular_velocity, *frame.spin]
    for body in model.bodies:
        found += [body.mass, *body.position, *body.velocity]
        found += [x for row in body.inertia or () for x in row]
    for action in model.actions:
        if isinstance(action, Potential):
            found.append(action.energy)
        elif isinstance(action, Force):
            found += [*action.vector, *action.velocity]
        elif isinstance(action, Torque):
            found += action.vector
        else:
            found.append(action.function)
    for coordinate in model.coordinates:
        if isinstance(coordinate, Coordinate):
            found += [coordinate.start, coordinate.rate]
        else:
            found += [*coordinate.start, *coordinate.rate]
    found += [speed.expression for speed in model.speeds]
    found += [variable.start for variable in model.discretes]
    found += [residual for c in model.constraints for residual in c.residuals]
    found += [condition.residual for condition in model.initial_conditions]
    return found + [x for when in model.whens for x in chain(*when.changes)]


@verify.register
def _(equations: EquationsOfMotion) -> None:
    nq, nv = len(equations.q), len(equations.v)
    assert all(len(a) == nq for a in (equations.q_units, equations.qdot, equations.starts_q))
    assert all(len(a) == nv for a in (equations.a, equations.v_units, equations.starts_v))
    assert len(equations.bias_forces) == len(equations.given_forces) == nv
    assert all(0 <= j <= i < nv and not m.is_zero for (i, j), m in equations.mass_matrix.items())
    assert all(0 <= i <= nq - 4 for i in equations.quaternions)
    holonomic = [row.holonomic for row in equations.rows]
    assert holonomic == sorted(holonomic, reverse=True), "rows are not holonomic first"
    assert len({row.label for row in equations.rows}) == len(equations.rows)
    for row in equations.rows:
        assert row.jacobian and all(0 <= j < nv for j in row.jacobian)
        assert row.holonomic or row.residual is row.rate
    verify_leaves(equations)


def verify_leaves(equations: EquationsOfMotion) -> None:
    """Check on which symbols the expressions depend."""
    parameters = {p.symbol for p in equations.model.parameters}
    given = parameters | {*equations.model.undetermined} | {equations.time}
    position = given | set(equations.q)
    state = position | set(equations.v)
    late = state | set(equations.a) | set(equations.lam)
    phi = [row.residual for row in equations.rows if row.holonomic]
    rows = [x for row in equations.rows for x in (row.rate, row.gamma)]
    rows += formed_of([row.jacobian for row in equations.rows])
    works = [c.power for c in equations.contributions]
    works += formed_of([c.forces for c in equations.contributions])
    balance = [equations.kinetic, equations.energy, *equations.rates.values()]
    forces = [*equations.qdot, *equations.mass_matrix.values(), *equations.bias_forces,
              *equations.given_forces, *works]  # fmt: skip
    conditions = [residual for residual, _ in equations.initial_conditions]
    rates = [s.rate for s in equations.stated_rates]
    assert symbols([s.value for s in equations.starts]) <= parameters
    assert symbols([*phi, equations.potential]) <= position
    assert symbols(forces) <= state | set(equations.lam)
    assert symbols(conditions) <= state
    assert symbols([*rows, *balance, *rates]) <= state
    late = late | {contact.multiplier for contact in equations.contacts}
    assert symbols([equations.power, *(o.expression for o in equations.outputs)]) <= late


@verify.register
def _(function: Function) -> None:
    outputs, count = dict(function.outputs), operands()
    for position, operation in enumerate(function.operations):
        assert len(operation.operands) == count[operation.op]
        assert all(0 <= operand < position for operand in operation.operands)
        if operation.op == "load":
            assert isinstance(operation.payload, tuple) and operation.payload[0] in function.inputs
    for store in function.stores:
        assert 0 <= store.index < outputs[store.array]
        assert 0 <= store.value < len(function.operations)


@verify.register
def _(program: Program) -> None:
    assert set(program.interface.functions) == set(program.functions)
    for name, function in program.functions.items():
        assert function.name == name
        verify(function)
