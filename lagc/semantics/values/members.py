"""Members and elements of values: `frame.x`, `vector.z`, `orientation.rate`, `instance.name`, subscripts."""

from collections.abc import Iterable, Sequence

from lagc.diagnostics.faults import Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics.context import Context
from lagc.semantics.model import Body, Frame, Orientation
from lagc.semantics.names.scope import (
    Array,
    Indexed,
    Part,
    Reference,
    Scalar,
    Value,
    Wrench,
    kind,
    vector_value,
)
from lagc.semantics.units import KG, NONE, M, S, over
from lagc.syntax import tree

MOST_NAMED = 8  # names listed in a remedy
_MOTION = (
    "velocity", "acceleration", "angular_velocity", "kinetic", "momentum", "angular_momentum", "position",
)  # fmt: skip
_SHORT = {"v": "velocity", "r": "position", "r_0": "position", "a": "acceleration", "w": "angular_velocity"}
AXES = ("x", "y", "z")
OF_ORIENTATION = ("w", *AXES, "rate")
OF_BODY = ("mass", "position", "frame", *AXES)


def member(context: Context, value: Value, e: tree.Member) -> Value:
    """Return `value.name`.  Raises Wrong."""
    if isinstance(value, Part):
        return _of_instance(context, value, e)
    if isinstance(value, Reference) and e.name in value.entry.parts:
        return value.entry.parts[e.name]
    known = _members(value)
    if e.name not in known:
        listed = f"it has {', '.join(known)}" if known else None
        remedy = _call_remedy(value, e) or did_you_mean(e.name, known) or listed
        raise Wrong("LAG0206", f"{kind(value)} has no `{e.name}`", e.name_span, remedy)
    if isinstance(value, Frame):
        axis = AXES.index(e.name)
        return vector_value((value.axes[0][axis], value.axes[1][axis], value.axes[2][axis]), NONE)
    if isinstance(value, Orientation):
        if e.name == "rate":
            return vector_value(value.rate_symbols, over(NONE, S))
        return Scalar(value.symbols["wxyz".index(e.name)], NONE)
    if isinstance(value, Body):
        return _of_body(value, e.name)
    if isinstance(value, Wrench):
        return value.force if e.name == "force" else value.moment
    assert isinstance(value, Array)
    return value.elements[AXES.index(e.name)]


def _call_remedy(value: Value, e: tree.Member) -> str | None:
    """Return a remedy for a member that is written as a function: `velocity(b)`."""
    name, of = e.name, e.base.span.text
    if isinstance(value, Body) and name in _SHORT:
        return f"write `{_SHORT[name]}({of})`"
    if isinstance(value, Scalar) and name in ("der", "dot", "diff", "v"):
        return f"write `der({of})`"
    if name in _MOTION and isinstance(value, Body | Array | Frame):
        return f"write `{name}({of})`"
    return None


def _members(value: Value) -> tuple[str, ...]:
    if isinstance(value, Frame):
        return AXES
    if isinstance(value, Orientation):
        return OF_ORIENTATION
    if isinstance(value, Body):
        return tuple(name for name in OF_BODY if name != "frame" or value.frame is not None)
    if isinstance(value, Array) and len(value.elements) == 3:
        return AXES
    if isinstance(value, Wrench):
        return ("force", "moment")
    return tuple(value.entry.parts) if isinstance(value, Reference) else ()


def _of_body(body: Body, name: str) -> Value:
    if name == "mass":
        return Scalar(body.mass, KG)
    if name == "frame":
        assert body.frame is not None
        return body.frame
    if name in AXES:
        return Scalar(body.position[AXES.index(name)], M)
    return vector_value(body.position, M)


def _of_reaction(value: Value, numbers: Sequence[int]) -> str | None:
    """Return a remedy for `reaction(roll[1])`: reports call the components of a constraint `roll[1]`."""
    if isinstance(value, Reference) and value.entry.kind == "constraint":
        written = ", ".join(map(str, numbers))
        return f"write `reaction({value.entry.name})[{written}]` for the force of one component"
    return None


def _of_instance(context: Context, part: Part, e: tree.Member) -> Value:
    instance = part.instance
    entry = instance.entries.get(e.name)
    if entry is not None:
        return context.value(entry, e.name_span)
    owner = instance.path.rstrip(".")
    if e.name in instance.unused:
        raise Wrong("LAG0214", f"`{e.name}` of `{owner}` {instance.unused[e.name]}", e.name_span)
    message = f"`{owner}` has no `{e.name}`"
    remedy = did_you_mean(e.name, instance.entries) or _contents(instance.entries)
    raise Wrong("LAG0206", message, e.name_span, remedy)


def _contents(names: Iterable[str]) -> str | None:
    """Return the known names as a remedy, if there are not too many."""
    found = list(names)
    return f"it has {', '.join(f'`{n}`' for n in found)}" if 0 < len(found) <= MOST_NAMED else None


def element(context: Context, base: Value, numbers: list[int], e: tree.Index) -> Value:
    """Return `base[i, j]`.  Raises Wrong."""
    if isinstance(base, Indexed):
        elements = base.entry.elements or {}
        entry = elements.get(tuple(numbers))
        if entry is None:
            written = ", ".join(str(n) for n in numbers)
            message = f"there is no `{base.entry.path}[{written}]`"
            remedy = _declared_range(list(elements))
            related = ((base.entry.span, "declared here"),)
            raise Wrong("LAG0207", message, e.span, remedy, related)
        return context.value(entry, e.span)
    value: Value = base
    for number, index in zip(numbers, e.indices):
        if not isinstance(value, Array):
            raise Wrong("LAG0207", f"{kind(value)} has no elements", e.span, _of_reaction(value, numbers))
        if not 1 <= number <= len(value.elements):
            message = f"there is no element {number}; the array has {len(value.elements)}"
            remedy = "elements are counted from 1"
            raise Wrong("LAG0207", message, index.span, remedy)
        value = value.elements[number - 1]
    return value


def part(context: Context, base: Value, wanted: list[int | list[int]], e: tree.Index) -> Value:
    """Return `base[1:n, 2]`: a list of numbers takes several elements, a number one.  Raises Wrong."""

    def found(before: list[int], rest: list[int | list[int]]) -> Value:
        if not rest:
            return element(context, base, before, e)
        first = rest[0]
        if isinstance(first, int):
            return found([*before, first], rest[1:])
        return Array(tuple([found([*before, number], rest[1:]) for number in first]))

    return found([], wanted)


def _declared_range(subscripts: list[tuple[int, ...]]) -> str | None:
    if not subscripts:
        return None
    if all(len(s) == 1 for s in subscripts):
        return f"its subscripts run from {min(subscripts)[0]} to {max(subscripts)[0]}"
    return f"{len(subscripts)} elements are declared"
