"""Quantities that are declared without their kind, `Length x(start = 1);`, and the declaration to write."""

from __future__ import annotations

import re

from lagc.diagnostics.suggest import foreign
from lagc.semantics.context import Context
from lagc.semantics.names.scope import Entry, Scalar, Value, flat
from lagc.semantics.names.undeclared import dimension_of
from lagc.semantics.refusals import Poisoned, Wrong
from lagc.semantics.time_derivatives import LATE, MOVING
from lagc.semantics.units import NONE, TYPES, Dimension, UnknownUnit, name_of, unit
from lagc.semantics.values.evaluate import evaluate
from lagc.syntax import tree

_UNKNOWN = frozenset({"Real", "Length", "Angle", "Charge"})
_RATES = frozenset({"Velocity", "AngularVelocity", "Current"})
_COMPUTED = frozenset({"Force", "Torque", "Energy", "Power", "Acceleration", "AngularAcceleration"})
_UNIT = re.compile(r'\bunit\s*=\s*"([^"]*)"\s*,?\s*')
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
    given = _UNIT.search(text)
    if given is not None:
        name, text = typed(given[1]) or name, _UNIT.sub("", text).replace("()", "")
    elif name == "Real" and dimension is not None:
        name = name_of(dimension)
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
    start = next((a.value for a in source.arguments if a.name in ("start", "guess")), None)
    bracket = _BRACKET.match(text, len(source.name))
    written = bracket[1] if bracket is not None and typed(bracket[1]) else None
    if written is not None and bracket is not None:
        text = text[: bracket.start()] + text[bracket.end() :]
        name = typed(written) or "Real"
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


def typed(text: str) -> str | None:
    """Return the type with the unit of a text: `Mass` for `kg`, `Real[kg/s]`."""
    try:
        return name_of(unit(text).dimension)
    except UnknownUnit:
        return None
