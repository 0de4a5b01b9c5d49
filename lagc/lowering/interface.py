"""The Interface of a program: names, units, places and sizes, taken from the model."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import accumulate
from math import inf
from typing import Any

from lagc.base.records import names, replace
from lagc.diagnostics.faults import Fault, Span
from lagc.diagnostics.suggest import moments as moments_remedy
from lagc.host import cache
from lagc.lowering.event_relations import EventRelation
from lagc.lowering.kkt.prune import Components
from lagc.lowering.program import Block, Clause, Contact, Field, Function, Interface
from lagc.lowering.series import counts
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.semantics.model import Discrete, Input, Lagrangian, Limit, Model, Parameter
from lagc.semantics.units import NONE, Dimension, S, over, unit
from lagc.symbolic.derivative import Slopes
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.expression_text import text
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Matrix
from lagc.symbolic.walk import depends, symbols

_DEFINITE = 1e-12  # of the product of the moments: minors that may be rounding
# Of no bearing on the numbers.
_UNHASHED = (
    "source_name", "model_hash", "notes", "warnings", "dropped", "start_places", "row_places",
    "initial_places", "relations", "timed", "flowing", "driven", "doubtful", "derivatives",
    "part_ends", "part_columns", "written", "conservative", "series", "methods",
    "scales", "events", "blocks", "enclosed",
)  # fmt: skip
_OPTIONAL = (
    "contacts", "late_relations", "loading_rows", "held_rows", "pushed_contacts", "servos", "curved_loads",
)  # fmt: skip
_OF_DISCRETES = ("discretes", "booleans")


def used_parameters(equations: EquationsOfMotion, roots: Iterable[Node]) -> tuple[Parameter, ...]:
    """Return the parameters that `roots` depend on, in order of declaration."""
    reached = symbols(roots)
    return tuple([p for p in equations.model.parameters if p.symbol in reached])


def interface(
    equations: EquationsOfMotion,
    parameters: tuple[Parameter, ...],
    functions: Mapping[str, Function],
    slopes: Slopes,
    loads: Mapping[str, Any],
    *,
    read: tuple[int, ...] = (),
    work: bool,
    straight: bool,
    work_size: int,
    health: int,
    operations: int,
    velocity_unknowns: int,
    dropped: tuple[str, ...] = (),
    remarks: tuple[str, ...] = (),
    derivatives: Mapping[str, tuple[tuple[int, int], ...]],
    relations: tuple[EventRelation, ...] = (),
) -> Interface:
    """Return the interface of `functions`, of `slopes`, the derivatives of the initial equations, and of
    `loads` that depend on reactions (`Loads.described`). `dropped` are names that were left out; `remarks`
    become notes."""
    model = equations.model
    # A parameter without a place reaches nothing: a note says so.
    kept = {p.name for p in parameters}
    notes = [f"parameter `{p.name}` reaches nothing" for p in model.parameters if p.name not in kept]
    # Does the motion depend on time itself? The right-hand side, or the dense system, tells.
    flowing = _timed(functions["system" if "system" in functions else "rhs"])
    # The functions do not say what a run needs besides: names, units, places, tables, sizes.
    found = Interface(
        model=model.name, scene=model.scene, model_hash="",
        nz=1 if work else 0,
        whens=_clauses(equations, int(work)),
        contacts=_contacts(equations, int(work)),
        blocks=_blocks(equations, bool(loads.get("loading_rows") or loads.get("pushed_contacts"))),
        **_of_equations(equations),
        **_of_functions(functions, slopes, len(equations.q) + len(equations.v)),
        **_of_discretes(model),
        **_of_relations(relations),
        **loads,
        parameters=tuple([parameter_field(p) for p in parameters]),
        inputs=tuple([input_field(u) for u in model.inputs]),
        limits=tuple([_limit(x) for x in model.limits]),
        solve="straight" if straight else "looped",
        work_size=work_size,
        health=health,
        operations=operations,
        velocity_unknowns=velocity_unknowns,
        read=read,
        effects=tuple([e.name for e in model.effects if e.used]),
        simulate=dict(model.simulate), scales=dict(model.scales),
        notes=(*model.notes, *notes, *equations.dropped, *remarks),
        dropped=dropped,
        servos=tuple([(c.name, c.actuator) for c in model.constraints if c.actuator]),
        timed=flowing or ("indicators" in functions and _timed(functions["indicators"])),
        flowing=flowing,
        doubtful=_doubtful(model),
        derivatives=dict(derivatives),
    )  # fmt: skip
    return replace(found, model_hash=_digest(found, functions))  # the hash is that of everything else


def _contacts(equations: EquationsOfMotion, nz: int) -> tuple[Contact, ...]:
    """Return the contacts as a run needs them."""
    # Discrete variables are the last states; an impulse that a model reads is one of them.
    first = len(equations.q) + len(equations.v) + nz
    states = {variable.name: first + k for k, variable in enumerate(equations.model.discretes)}
    return tuple([
        Contact(c.label, c.contact.unit, place(c.contact.span), len(c.jacobians) - 1,
                c.contact.poisson, states.get(f"impulse({c.label})", -1), len(c.normals),
                c.contact.bounds_rate)
        for c in equations.contacts
    ])  # fmt: skip


def _blocks(equations: EquationsOfMotion, loaded: bool) -> tuple[Block, ...]:
    """Return the blocks of contacts: systems whose motions do not depend on each other. All contacts are one
    block if loads depend on reactions, `loaded`, or if one is two-sided."""
    contacts, q, v = equations.contacts, equations.q, equations.v
    if not contacts:
        return ()
    rows = [row.multiplier for row in equations.rows]
    components = Components(equations)
    if loaded or any(contact.normals for contact in contacts):
        components.tie([(v[0], symbol) for symbol in (*q, *v, *rows, *(c.contact.state for c in contacts))])
    # A component that reads another one's states depends on them.
    components.tie([(a, b) for a, nodes in components.read for b in symbols(nodes) if b in components.leader])
    leaders = [components.find(contact.contact.state) for contact in contacts]
    timed = {components.find(a) for a, nodes in components.read if equations.time in symbols(nodes)}

    def places(found: Sequence[Node], own: Node) -> tuple[int, ...]:
        return tuple([i for i, symbol in enumerate(found) if components.find(symbol) is own])

    return tuple(
        [
            Block(places(leaders, own), places(q, own), places(v, own), places(rows, own), own in timed)
            for own in dict.fromkeys(leaders)
        ]
    )


def _of_equations(equations: EquationsOfMotion) -> dict[str, Any]:
    """Return sizes, names, units and places of states, rows and outputs."""
    return {
        "source_name": _source_name(equations),
        "nq": len(equations.q),
        "nv": len(equations.v),
        "nc": len(equations.rows),
        "nh": sum(1 for row in equations.rows if row.holonomic),
        "q_names": equations.q_names,
        "v_names": equations.v_names,
        "q_units": equations.q_units,
        "v_units": equations.v_units,
        "kinds": kinds(equations.q_units, equations.v_units),
        "row_labels": tuple([row.label for row in equations.rows]),
        "row_units": tuple([row.unit for row in equations.rows]),
        "quaternions": equations.quaternions,
        "outputs": _outputs(equations),
        "rate_names": tuple([s.name for s in equations.stated_rates]),
        "rate_units": tuple([s.unit for s in equations.stated_rates]),
        "massless": tuple(
            [i for i in range(len(equations.v)) if i not in equations.massive or i in equations.unit_pivots]
        ),
        "start_levels": tuple([s.stated.level for s in equations.starts]),
        "start_places": tuple([place(s.stated.span) for s in equations.starts]),
        "row_places": tuple([place(row.span) for row in equations.rows]),
        "initial_places": tuple([place(span) for _, span in equations.initial_conditions]),
        "warnings": tuple([_warning(fault) for fault in equations.warnings]),
        "conservative": equations.power.is_zero
        and not equations.contacts
        and all([row.holonomic for row in equations.rows]),
        "balance": equations.balance,
        "driven": bool(depends([row.rate for row in equations.rows], [equations.time])),
    }


def _enclosed(functions: Iterable[Function], moved: int) -> tuple[int, ...]:
    """Return the states of (q, v) whose ends in a box of time and these functions read."""
    read = {o.payload for f in functions if "box" in f.inputs for o in f.operations if o.op == "load"}
    return tuple([i for i in range(moved) if not read.isdisjoint({("box", 1 + i), ("box", moved + 2 + i)})])


def _of_functions(functions: Mapping[str, Function], slopes: Slopes, moved: int) -> dict[str, Any]:
    """Return what the functions and the derivatives of the initial equations tell of themselves; `moved` are
    the states (q, v)."""
    # The derivatives of the initial equations as tables: ends of rows and columns of entries. Where sums are
    # shared, also those of the parts.
    bind = functions.get("bind")
    columns = slopes.columns
    parts = (*slopes.rows, *slopes.sums) if slopes.sums else ()
    return {
        "condition_ends": tuple(accumulate([len(own) for own in columns])),
        "condition_columns": tuple([k for own in columns for k in own]),
        "part_ends": tuple(accumulate([len(own) for own in parts])),
        "part_columns": tuple([k for own in parts for k in own]),
        "written": sum([function.written for function in functions.values()]),
        "preparation": bind.cost if bind else 0,
        "prepared": bind.outputs[0][1] if bind else 0,
        "functions": tuple(functions),
        "series": counts(functions),
        "enclosed": _enclosed(functions.values(), moved),
        "features": dict(functions["features"].outputs)["e"] if "features" in functions else 0,
        "poles": dict(functions["poles"].outputs)["e"] if "poles" in functions else 0,
    }


def _of_discretes(model: Model) -> dict[str, Any]:
    return {
        "discretes": tuple([discrete_field(variable) for variable in model.discretes]),
        "booleans": tuple([int(variable.boolean) for variable in model.discretes]),
    }


def _of_relations(relations: Sequence[EventRelation]) -> dict[str, Any]:
    return {
        "relations": tuple([relation.words for relation in relations]),
        "counted_relations": tuple([int(relation.edges is not None) for relation in relations]),
        "late_relations": sum(relation.late for relation in relations),
        "timed_relations": sum(1 for relation in relations if relation.slope is not None),
        "relations_aside": tuple([int(relation.aside) for relation in relations]),
    }


def _timed(function: Function) -> bool:
    """Return whether the values of a function depend on time itself: that of turning frames may cancel."""
    return any(isinstance(o.payload, tuple) and o.payload[0] == "t" for o in function.operations)


def _doubtful(model: Model) -> bool:
    """Return whether the kinetic energy may be negative although no mass or moment of inertia is."""
    tensors = [body.inertia for body in model.bodies if body.inertia is not None]
    free = any(isinstance(action, Lagrangian) for action in model.actions)
    return free or not all(_without_products(tensor) or _positive(tensor) for tensor in tensors)


def _without_products(tensor: Matrix) -> bool:
    return all(row[k].is_zero for i, row in enumerate(tensor) for k in range(i))


def _positive(tensor: Matrix) -> bool:
    """Return whether a tensor of numbers is positive definite, by its leading minors (J. J. Sylvester,
    1852)."""
    if not all(x.is_const for row in tensor for x in row):
        return False
    (a, d, e), (_, b, f), (_, _, c) = [[x.value for x in row] for row in tensor]
    second = a * b - d * d
    third = c * second + e * (d * f - b * e) - f * (a * f - d * e)
    return bool(a > 0.0 and b > 0.0 and second > _DEFINITE * a * b and third > _DEFINITE * a * b * c)


def _warning(fault: Fault) -> str:
    where = f" ({place(fault.span)})" if fault.span else ""
    return f"{fault.code}: {fault.message}{where}" + (f"; {fault.remedy}" if fault.remedy else "")


def place(span: Span) -> str:
    """Return file and line without the directory: generated text must not depend on where a file is."""
    return f"{_file(span.source.name)}:{span.line}"


def _file(path: str) -> str:
    return path.replace("\\", "/").rpartition("/")[2]


def _source_name(equations: EquationsOfMotion) -> str:
    """Return the file that the first definition of the model was read from."""
    model = equations.model
    for things in (model.coordinates, model.bodies, model.parameters):
        for thing in things:
            return _file(thing.span.source.name)
    return ""


def _clauses(equations: EquationsOfMotion, nz: int) -> tuple[Clause, ...]:
    """Return the clauses `when` as a run needs them."""
    place = {state: k for k, state in enumerate((*equations.q, *equations.v))}
    first = len(place) + nz
    place.update((variable.symbol, first + k) for k, variable in enumerate(equations.model.discretes))
    return tuple([
        Clause(when.clause.words, when.clause.marks, when.clause.reason,
               tuple([place[state] for state, _ in when.changes]), when.clause.fails)
        for when in equations.whens
    ])  # fmt: skip


def parameter_field(p: Parameter) -> Field:
    return Field(
        p.name, p.value, p.minimum, p.maximum, p.unit, p.display_unit, place(p.span), p.description, p.whole
    )


def discrete_field(x: Discrete) -> Field:
    value = x.start.value if x.start.is_const else None
    return Field(x.name, value, -inf, inf, x.unit, x.display_unit, place(x.span), x.description)


def _limit(x: Limit) -> Field:
    return Field(x.name, None, x.minimum, x.maximum, x.unit, x.unit, place(x.span), x.remedy)


def input_field(u: Input) -> Field:
    return Field(u.name, u.default, u.minimum, u.maximum, u.unit, u.unit, place(u.span), u.description)


def _outputs(equations: EquationsOfMotion) -> tuple[Field, ...]:
    inf = float("inf")
    declared = {o.name: o for o in equations.model.outputs}
    found = []
    for o in equations.outputs:
        source = declared.get(o.name)
        where = place(source.span) if source else ""
        text = source.description if source else ""
        found.append(Field(o.name, None, -inf, inf, o.unit, o.display_unit, where, text))
    return tuple(found)


def _digest(interface: Interface, functions: Mapping[str, Function]) -> str:
    """Return a hash of everything that decides a result: no file names, no places."""
    texts = []
    for name in names(Interface):
        absent = name in _OPTIONAL and not getattr(interface, name)
        if name not in _UNHASHED and not absent and (interface.discretes or name not in _OF_DISCRETES):
            value = getattr(interface, name)
            if name in ("parameters", "inputs", "outputs", "limits", "discretes"):
                value = [(x.name, x.value, x.minimum, x.maximum, x.unit) for x in value]
            elif name == "contacts":
                value = [(x.name, x.slips, *["poisson"] * x.poisson) for x in value]
            elif name == "simulate":
                value = sorted(value.items())
            texts.append(f"{name}={value!r}")
    if interface.part_ends:
        texts.append(f"parts={interface.part_ends}{interface.part_columns}")
    for name, function in functions.items():
        texts.append(f"{name} {function.inputs} {function.outputs}{function.cleared or ''}")
        texts.append("\n".join([f"{o.op}{o.operands}{o.payload!r}" for o in function.operations]))
        texts.append("\n".join([f"{s.array}[{s.index}]={s.value}" for s in function.stores]))
    return cache.key(*texts)


def kinds(q_units: Sequence[str], v_units: Sequence[str]) -> tuple[int, ...]:
    """Return the kind of each coordinate, then of each speed; those of coordinates come first."""
    known: dict[tuple[str, Dimension], int] = {("q", NONE): 0}
    states = [("q", _dimension(u)) for u in q_units] + [("v", _dimension(u)) for u in v_units]
    return tuple([known.setdefault(state, len(known)) for state in states])


def rates(q_units: Sequence[str], v_units: Sequence[str]) -> dict[int, int]:
    """Return the scaling group of the rates of each scaling group of coordinates, if there is one."""
    states = kinds(q_units, v_units)
    speeds = {_dimension(u): kind for u, kind in zip(v_units, states[len(q_units) :])}
    pairs = {kind: speeds.get(over(_dimension(u), S)) for u, kind in zip(q_units, states)}
    return {kind: speed for kind, speed in pairs.items() if speed is not None}


def _dimension(text: str) -> Dimension:
    return unit(text or "1").dimension


FLAT = 1.0 + 1e-9  # round-off of a flat body's moments: one is the sum of the others


def bounded(model: Model) -> Model:
    """Return `model` with the bounds that its bodies and contacts need, unless declared bounds imply them:
    masses and moments of inertia are not negative, and no moment exceeds the sum of the two others; friction
    is not negative, and a restitution is from 0 to 1."""
    asked = [*_inertias(model), *_laws(model)]
    direct = {limit.value: limit for limit in asked}
    parameters = tuple([
        replace(p, minimum=max(p.minimum, own.minimum), maximum=min(p.maximum, own.maximum))
        if (own := direct.get(p.symbol)) is not None else p
        for p in model.parameters
    ])  # fmt: skip
    known = {p.symbol: (p.minimum, p.maximum) for p in parameters}
    least = intervals([limit.value for limit in asked], known)
    found = [
        limit
        for limit in asked
        if limit.value not in known and not _within(least[limit.value], limit)
        and symbols([limit.value]) <= known.keys()
    ]  # fmt: skip
    return replace(model, parameters=parameters, limits=(*model.limits, *found))


def _inertias(model: Model) -> Iterator[Limit]:
    for body in model.bodies:
        yield Limit(f"mass of {body.name}", body.mass, "kg", 0.0, inf, body.span)
        for k, row in enumerate(body.inertia or ()):
            yield Limit(f"moment of inertia {k + 1} of {body.name}", row[k], "kg.m2", 0.0, inf, body.span)
        if body.inertia is not None:
            moments = [row[k] for k, row in enumerate(body.inertia)]
            for k, a in enumerate(moments):
                b, c = moments[k - 2], moments[k - 1]
                room = (b + c) * FLAT - a
                if not any(_part(room) is _part(x) for x in moments):  # that it is not negative is asked
                    others = " + ".join(str(i + 1) for i in range(3) if i != k)
                    name = f"moments of inertia {others} - {k + 1} of {body.name}"
                    remedy = moments_remedy([text(x) for x in moments], k)
                    yield Limit(name, room, "kg.m2", 0.0, inf, body.span, remedy)


def _laws(model: Model) -> Iterator[Limit]:
    for contact in model.contacts:
        numbers = (("restitution", contact.restitution, 1.0), ("friction", contact.friction, inf),
                   ("static friction", contact.static, inf))  # fmt: skip
        for name, node, most in numbers:
            if node is not None and not node.is_const:
                yield Limit(f"{name} of {contact.label}", node, "", 0.0, most, contact.span)
        if contact.static is not None and contact.friction is not None:
            more = contact.static - contact.friction
            if not more.is_const:
                name = f"static friction less friction of {contact.label}"
                remedy = "give `static` a value from that of `friction` on, or leave it out"
                yield Limit(name, more, "", 0.0, inf, contact.span, remedy)


def _within(values: tuple[float, float], limit: Limit) -> bool:
    """Return whether an interval is within the bounds of a limit."""
    return values[0] >= limit.minimum and values[1] <= limit.maximum


def _part(x: Node) -> Node:
    """Return the node that `x` is a positive multiple of."""
    return x.args[0] if x.op == "scale" and x.value > 0.0 else x
