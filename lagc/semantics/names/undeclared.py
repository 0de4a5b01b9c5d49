"""Remedies for names that are not declared: the rate, the unit or the function that is meant, or the
declaration to write, in the dimension of its place; also for quantities without their kind or type.
"""

import re
from collections.abc import Iterator

from lagc.diagnostics.faults import Poisoned, Wrong
from lagc.diagnostics.suggest import (
    did_you_mean,
    foreign,
    foreign_call,
    looks_like_unit,
    remedy_of_word,
    unit_symbol,
)
from lagc.semantics.context import LATE, MOVING, Context
from lagc.semantics.names.scope import Entry, Environment, Instance, Scalar, Value, flat
from lagc.semantics.units import (
    CONSTANTS,
    ENERGY,
    FORCE,
    KG,
    NONE,
    POWER,
    TYPES,
    Dimension,
    M,
    S,
    UnknownUnit,
    dimension,
    name_of,
    over,
    raised,
    si_text,
    times,
    unit,
)
from lagc.semantics.values.calls import type_of
from lagc.semantics.values.evaluate import evaluate
from lagc.syntax import tree

_MOST = 6  # names in a remedy
_FACTOR = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*\*\s*$")  # a number before the name
_UNIT = re.compile(r"([A-Za-z]+)(?:\^?-?\d+)?(?:[*/.]([A-Za-z]+)(?:\^?-?\d+)?)*")
_SPEEDS = ("v", "vel", "w", "omega")
_ENERGIES = {"potential": ENERGY, "kinetic": ENERGY, "lagrangian": ENERGY, "dissipation": POWER, "point": M}
_TYPES = {  # likelier than those of other quantities of the same dimension
    ("dissipation", times(POWER, (0, 0, 2 * S[2], *NONE[3:]))): "RotationalDamping",
    ("potential", ENERGY): "RotationalStiffness",
}
_LOADS = {"force": FORCE, "torque": ENERGY}
_ARGUMENTS = {"mass": KG, "at": M, "com": M, "inertia": dimension(kg=1, m=2)}
_ANGLES = frozenset({"sin", "cos", "tan", "rotate", "rotate_x", "rotate_y", "rotate_z"})
_PLACES = frozenset({"position", "velocity", "acceleration", "kinetic", "momentum"})


def remedy(context: Context, e: tree.Name, environment: Environment) -> str:
    """Return the remedy for a name that is not declared; empty while a remedy is looked for."""
    if context.hushed:
        return ""
    instance, path = environment.instance, tuple(_path(context, e))
    known = [*environment.bindings, *instance.entries, *environment.space.known(), *CONSTANTS]
    known += ["time", "world"]
    return (
        _power_of_e(e, path)
        or _unit_factor(e)
        or _strength(e.name, instance)
        or rate_remedy(e.name, instance)
        or remedy_of_word("names", e.name)
        or foreign_call(e.name)
        or did_you_mean(e.name, known)
        or remedy_of_reaction(e, instance)
        or _axis(e.name)
        or _energy(context, e.name)
        or _declaration(context, e, environment, path)
    )


def remedy_of_reaction(e: tree.Name, instance: Instance) -> str | None:
    """Return a remedy for the argument of a function of constraints: which there are."""
    for function, advice in (
        (
            "reaction",
            "declare it, `constraint c: left = right;`, or ask for `reaction` of a body or parameter",
        ),
        ("impulse", "declare a one-sided constraint, as in `constraint floor: ball.z >= 0;`"),
    ):
        if e.span.source.text[: e.span.start].endswith(f"{function}("):
            names = [f"`{x.path}`" for x in instance.entries.values() if x.kind in ("constraint", "joint")]
            return f"there are {', '.join(names[:_MOST])}" if names else advice
    return None


def _strength(name: str, instance: Instance) -> str | None:
    """Return a remedy for `g`, which printed equations use for `field.g`."""
    fields = [e.name for e in instance.entries.values() if e.kind == "gravity"] if name == "g" else []
    if name == "g" and not fields:
        return "declare it, `parameter Acceleration g = 9.81 [m/s2];`, or write gravity as `Gravity field;`"
    return f"write {' or '.join(f'`{field}.g`' for field in fields)}" if fields else None


def rate_of(name: str, instance: Instance) -> str | None:
    """Return the rate that is called `xdot`, `dx`, `dx_dt` or `vx`, `der(x)`, or `x_ddot`, `der(der(x))`."""
    for pattern, order in (
        (r"(\w+?)_?(dot|d)(_?dot|d)", 2), (r"(dd|d2)_?(\w+?)(_?dt2?)?", 2), (r"(a)_?(\w+)", 2),
        (r"(\w+?)_?(dot|d|t|prime)", 1), (r"(d|v|w|omega|vel|D)_?(\w+?)(_?dt)?", 1),
    ):  # fmt: skip
        found = re.fullmatch(pattern, name)
        for part in found.groups() if found else ():
            entry = instance.entries.get(part or "")
            if entry is not None and entry.kind in ("coordinate", "speed"):
                return "der(" * order + entry.name + ")" * order
    return None


def rate_remedy(name: str, instance: Instance) -> str | None:
    """Return a remedy for a rate, or for a velocity `v` that is not declared."""
    rate = rate_of(name, instance)
    if rate is None and name in _SPEEDS:
        kind = "AngularVelocity" if name in ("w", "omega") else "Velocity"
        return f"write the rate `der(x)` of a coordinate, or declare `speed {kind} {name} = der(x);`"
    return rate and f"write `{rate}`"


def _power_of_e(e: tree.Name, path: tuple[tree.Expression, ...]) -> str | None:
    """Return a remedy for `e^(-t)`."""
    whole = path[0] if path else None
    if e.name not in ("e", "E") or not isinstance(whole, tree.Binary) or whole.op != "^":
        return "write `exp(1)`" if e.name == "e" else None
    text = whole.right.span.text
    text = text[1:-1] if text.startswith("(") and text.endswith(")") else text
    return f"write `exp({text})`" if whole.left is e else None


def _axis(name: str) -> str | None:
    """Return a remedy for `x`, which may be an axis."""
    if name not in ("x", "y", "z"):
        return None
    return f"for an axis write `world.{name}`; for an unknown declare `coordinate Length {name};`"


def _energy(context: Context, name: str) -> str | None:
    """Return a remedy for `T` and `V` in an output of an energy."""
    calls = {"T": "kinetic()", "V": "potential()", "U": "potential()"}
    declaration = context.chain[-1].declaration if context.chain else None
    if not isinstance(declaration, tree.Quantities) or declaration.kind != "output" or name not in calls:
        return None
    energy = declaration.type is not None and declaration.type.path == ("Energy",)
    return f"write `{calls[name]}`" if energy else None


def _unit_factor(e: tree.Name) -> str | None:
    """Return a remedy for `9.81*m/s^2` and `1*kg`."""
    text = e.span.source.text
    number, unit = _FACTOR.search(text[: e.span.start]), _UNIT.match(text, e.span.start)
    if number is None or unit is None or not looks_like_unit(e.name):
        return None
    end = e.span.end
    for part in re.finditer(r"[*/.]?([A-Za-z]+)(?:\^?-?\d+)?", unit[0]):
        if not looks_like_unit(part[1]):
            break
        end = unit.start() + part.end()
    words = text[e.span.start : end].replace("*", ".")
    return f"write `{number[1]} [{unit_symbol(words)}]`"


def _path(context: Context, e: tree.Name) -> Iterator[tree.Expression]:
    """Yield the expressions around a name in the declaration that is evaluated, the innermost first."""
    roots = _roots(context.chain[-1]) if context.chain else ()
    for root, _ in roots:
        around = []
        part: tree.Expression | None = root if _holds(root, e) else None
        while part is not None and part is not e:
            around.append(part)
            part = next((inner for inner in _parts(part) if _holds(inner, e)), None)
        if part is e:
            yield from reversed(around)
            return


def _holds(whole: tree.Expression, part: tree.Expression) -> bool:
    same = whole.span.source is part.span.source
    return same and whole.span.start <= part.span.start and part.span.end <= whole.span.end


def _parts(e: tree.Expression) -> tuple[tree.Expression, ...]:
    if isinstance(e, tree.Binary):
        return e.left, e.right
    if isinstance(e, tree.Unary):
        return (e.operand,)
    if isinstance(e, tree.Vector):
        return tuple(e.elements)
    if isinstance(e, tree.Call):
        return tuple(a.value for a in e.arguments if a.value is not None)
    if isinstance(e, tree.Conditional):
        return (*(part for branch in e.branches for part in branch), e.otherwise)
    if isinstance(e, tree.Member | tree.Index):
        return (e.base,)
    return ()


def _names(e: tree.Expression) -> Iterator[tree.Name]:
    if isinstance(e, tree.Name):
        yield e
    for part in _parts(e):
        yield from _names(part)


def _roots(entry: Entry) -> tuple[tuple[tree.Expression, Dimension | None], ...]:
    """Return the expressions of a declaration, each with the dimension that it needs (None: not known)."""
    source, declaration = entry.source, entry.declaration
    if isinstance(source, tree.Load):
        places = [part for part in (source.target, source.body, source.reaction) if part is not None]
        return (source.value, _LOADS[source.kind]), *((part, None) for part in places)
    if isinstance(source, tree.Constraint):
        span = source.left.span.to(source.right.span)
        both = tree.Binary("=", source.left, source.right, source.relation_span, span)
        return ((both, None),)
    if isinstance(source, tree.Construct):
        return ((source.value, _ENERGIES.get(source.kind)),)
    if not isinstance(source, tree.Declarator):
        return ()
    given = [(a.name or "", a.value) for a in source.arguments if a.value is not None]
    if not isinstance(declaration, tree.Quantities) or declaration.type is None:
        return tuple((value, _ARGUMENTS.get(name)) for name, value in given)
    try:
        meant: Dimension | None = type_of(declaration.type, entry.environment.space).dimension
    except Wrong:
        meant = None
    rate = None if meant is None else over(meant, S)
    found = [(value, rate if name == "rate" else meant) for name, value in given]
    return (*found, (source.value, meant)) if source.value is not None else tuple(found)


def _declaration(
    context: Context, e: tree.Name, environment: Environment, path: tuple[tree.Expression, ...]
) -> str:
    """Return the declaration of a name in the dimension of its place."""
    around = path[0] if path else None
    function = around.function if isinstance(around, tree.Call) else None
    called = function.name if isinstance(function, tree.Name) else ""
    if called in _PLACES:
        return f"declare it, `body {e.name} = Particle(mass = 1 [kg], at = {{0, 0, 0}} [m]);`"
    source = context.chain[-1].source if context.chain else None
    if isinstance(source, tree.Load) and not path and not _holds(source.value, e):
        return f"declare it, `point {e.name} = {{0, 0, 0}} [m];`"
    needed = _needed_dimension(context, e, environment, path)
    if needed is None:
        for name in _names(path[-1]) if path else ():
            known = name.name == e.name or dimension_of(context, name, environment) is not None
            if not known and rate_remedy(name.name, environment.instance):
                return f"declare `{name.name}` first: the dimension of `{e.name}` follows from it"
        return f"declare it, `parameter Real {e.name} = 1;`, or with a type such as `Length` for `Real`"
    if needed == NONE:
        kind = "Angle" if called in _ANGLES else "Real"
        return f"declare it, `parameter {kind} {e.name} = 1;`"
    named = _TYPES.get((context.chain[-1].kind, needed)) or name_of(needed)
    unit = TYPES[named].unit if named in TYPES else si_text(needed)
    return f"declare it, `parameter {named} {e.name} = 1 [{unit}];`"


def _needed_dimension(
    context: Context, e: tree.Name, environment: Environment, path: tuple[tree.Expression, ...]
) -> Dimension | None:
    """Return the dimension that a name needs to fit those around it, None if it is not known."""
    if not context.chain:
        return None
    wanted = next((meant for root, meant in _roots(context.chain[-1]) if _holds(root, e)), None)

    def of(part: tree.Expression) -> Dimension | None:
        return dimension_of(context, part, environment)

    # From the declaration inwards: each part passes on the dimension that it needs of the one inside.
    for part, inner in zip(reversed(path), (*reversed(path[:-1]), e)):
        if isinstance(part, tree.Binary):
            wanted = _of_operand(part, inner, wanted, of(part.right if inner is part.left else part.left))
        elif isinstance(part, tree.Call):
            name = part.function.name if isinstance(part.function, tree.Name) else ""
            named = next((a.name for a in part.arguments if a.value is inner), None)
            if name in ("Particle", "Solid"):
                place = next(k for k, a in enumerate(part.arguments) if a.value is inner)
                order = ("mass", "at") if name == "Particle" else ("mass", "inertia", "frame", "com")
                wanted = _ARGUMENTS.get(named or order[min(place, len(order) - 1)])
            elif name == "der":
                wanted = None if wanted is None else times(wanted, S)
            elif name == "sqrt":
                wanted = None if wanted is None else raised(wanted, 2)
            elif name not in ("abs", "min", "max", "norm", "sum"):
                wanted = NONE if name in _ANGLES or name in ("exp", "log", "sinh", "cosh", "tanh") else None
        elif isinstance(part, tree.Member | tree.Index | tree.Conditional):
            branch = isinstance(part, tree.Conditional) and inner not in [c for c, _ in part.branches]
            wanted = wanted if branch else None
    return wanted


def _of_operand(
    whole: tree.Binary, inner: tree.Expression, wanted: Dimension | None, other: Dimension | None
) -> Dimension | None:
    """Return the dimension of an operand from those of the whole and of the other operand."""
    if whole.op == "^":
        exponent = whole.right.value if isinstance(whole.right, tree.Number) else 0.0
        if inner is whole.right:
            return NONE
        return raised(wanted, 1.0 / exponent) if wanted is not None and exponent else None
    if whole.op not in ("*", "/"):
        return wanted if whole.op in ("+", "-") and wanted is not None else other
    if wanted is None or other is None:
        return None
    if whole.op == "/":
        return times(wanted, other) if inner is whole.left else over(other, wanted)
    return over(wanted, other)


def dimension_of(context: Context, e: tree.Expression, environment: Environment) -> Dimension | None:
    """Return the dimension of an expression, None if it has a fault or is 0."""
    context.hushed = True
    try:
        found = flat(evaluate(context, e, environment), e.span, "")
    except (Wrong, Poisoned):
        return None
    finally:
        context.hushed = False
    return next((x.dimension for x in found if x.dimension is not None), None)


_UNKNOWN = frozenset({"Real", "Length", "Angle", "Charge"})
_RATES = frozenset({"Velocity", "AngularVelocity", "Current"})
_COMPUTED = frozenset({"Force", "Torque", "Energy", "Power", "Acceleration", "AngularAcceleration"})
_UNIT_ATTRIBUTE = re.compile(r'\bunit\s*=\s*"([^"]*)"\s*,?\s*')
_ATTRIBUTES = ("start", "rate", "fixed", "min", "max", "displayUnit", "unit", "quantity", "nominal", "each")
_BRACKET = re.compile(r"\s*\[([^\]]*)\]")
_ANGULAR = re.compile(r"\b(deg|rad|mrad|rev)\b")
_EXAMPLES = {"output": " = value", "speed": " = der(x)", "structural": " = 3"}
_LONGEST = 80


def quantity_of(path: tuple[str, ...]) -> str | None:
    """Return the quantity type that `Length`, `length`, `SI.Position` or `float` means, or None."""
    name = foreign("types").get(path[-1], path[-1])
    return name if name in TYPES else None


def refuse_without_kind(context: Context, entry: Entry) -> Value:
    """Raise Wrong with the declaration to write, or Poisoned after the first name of several."""
    declaration, source = entry.declaration, entry.source
    assert isinstance(declaration, tree.Instance) and isinstance(source, tree.Declarator)
    if source is not declaration.declarators[0]:
        raise Poisoned
    span, path = declaration.type.span, ".".join(declaration.type.path)
    name = quantity_of(declaration.type.path) or "Real"
    dimension, moves = _value(context, entry, source)
    text = span.source.text[source.span.start : declaration.declarators[-1].span.end]
    given = _UNIT_ATTRIBUTE.search(text)
    if given is not None:
        name, text = type_of_unit(given[1]) or name, _UNIT_ATTRIBUTE.sub("", text).replace("()", "")
    elif name == "Real" and dimension is not None:
        name = name_of(dimension)
    # The type is that of the words, of the unit, or of the value; the kind follows from type and use.
    kind = _kind(name, source, moves)
    foreign = [a for a in source.arguments if a.name not in _ATTRIBUTES]
    if foreign and given is None:  # of a model of a library: `Inertia J(J = 1)`
        value = foreign[0].value
        text = f"{source.name} = {value.span.text}" if value and len(foreign) == 1 else source.name
    if kind == "speed" and source.value is None:
        text = f"{source.name} = der(x)"
    elif kind == "output" and source.value is None:
        text = f"{source.name} = value"
    elif kind == "structural" and source.value is None:
        text = f"{text} = 3"
    text = text if len(text) <= _LONGEST and "\n" not in text else f"{source.name}"
    message = f"the declaration of `{source.name}` does not say its kind, such as `parameter` or `coordinate`"
    raise Wrong("LAG0119", message, span, _remedy(kind, name, text, path))


def without_type(context: Context, entry: Entry) -> Wrong:
    """Return the fault of `coordinate theta [rad];` and `output x = l*y;`, with the line to write."""
    declaration, source = entry.declaration, entry.source
    assert isinstance(declaration, tree.Quantities) and isinstance(source, tree.Declarator)
    text = source.span.source.text[source.span.start : declaration.declarators[-1].span.end]
    message = f"`{entry.kind}` needs a type and a name; there is only `{source.name}`"
    if quantity_of((source.name,)) is not None:
        remedy = f"write `{entry.kind} {text} name{_EXAMPLES.get(entry.kind, '')};`"
        return Wrong("LAG0133", message, source.name_span, remedy)
    dimension, _ = _value(context, entry, source)
    # The type is that of a unit in brackets, of the value, or of the start; else a likely one.
    start = next((a.value for a in source.arguments if a.name in ("start", "guess")), None)
    bracket = _BRACKET.match(text, len(source.name))
    written = bracket[1] if bracket is not None and type_of_unit(bracket[1]) else None
    if written is not None and bracket is not None:
        text = text[: bracket.start()] + text[bracket.end() :]
        name = type_of_unit(written) or "Real"
    elif dimension is not None:
        name = name_of(dimension)
    elif start is not None and dimension_of(context, start, entry.environment) not in (None, NONE):
        name = name_of(dimension_of(context, start, entry.environment) or NONE)
    else:
        name = "Real" if entry.kind != "coordinate" else "Length" if len(source.name) == 1 else "Angle"
    if name == "Real" and _ANGULAR.search(written or text):
        name = "Angle"
    name = "Integer" if entry.kind == "structural" else name
    text = text if len(text) <= _LONGEST and "\n" not in text else source.name
    return Wrong("LAG0133", message, source.name_span, f"write `{entry.kind} {name} {text};`")


def _remedy(kind: str, name: str, text: str, path: str) -> str:
    line = f"write `{kind} {name} {text};`"
    if name == "Real" and kind == "coordinate":
        line += ", or a type such as `Angle` or `Length`"
    if name in ("Force", "Torque"):
        load = "force f = {1 [N], 0, 0} at b;" if name == "Force" else "torque M = {0, 0, 1 [N.m]} on b;"
        line += f"; for a {name.lower()} that acts on a body `{load}`"
    return line


def _kind(name: str, source: tree.Declarator, moves: bool) -> str:
    if source.value is not None:
        return "output" if moves else "structural" if name == "Integer" else "parameter"
    if name in _UNKNOWN or any(argument.name == "start" for argument in source.arguments):
        return "coordinate"
    if name in _RATES:
        return "speed"
    return "structural" if name == "Integer" else "output" if name in _COMPUTED else "parameter"


def _value(context: Context, entry: Entry, source: tree.Declarator) -> tuple[Dimension | None, bool]:
    """Return the dimension of the declared value (None: unknown), and whether it depends on the motion."""
    if source.value is None:
        return None, False
    before, context.faults = context.faults, []
    found: list[Scalar] = []
    try:
        found = flat(evaluate(context, source.value, entry.environment), source.value.span, "the value")
    except (Wrong, Poisoned):
        pass
    finally:
        context.faults = before + context.faults
    moves = any(context.clock.mask(x.node) & (MOVING | LATE) for x in found)
    return (found[0].dimension if found else None), moves or not found


def type_of_unit(text: str) -> str | None:
    """Return the type with the unit of a text: `Mass` for `kg`, `Real[kg/s]`."""
    try:
        return name_of(unit(text).dimension)
    except UnknownUnit:
        return None
