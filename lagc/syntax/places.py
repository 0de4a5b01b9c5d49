"""The blocks in which each kind of declaration is allowed."""

from collections.abc import Iterable, Sequence
from typing import Any

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Span
from lagc.syntax import tree

FILE = "a file"
_MECHANICS = frozenset({"model", "effect"})
_REUSABLE = frozenset({"file", "package", "model", "effect"})

# Kind of declaration -> the blocks that may contain it.
_PLACES: dict[str, frozenset[str]] = {
    "model": frozenset({"file", "package"}),
    "package": frozenset({"file", "package"}),
    "import": frozenset({"file", "package", "model"}),
    "extends": frozenset({"model"}),
    "type": _REUSABLE,
    "function": _REUSABLE,
    "constant": _REUSABLE,
    "parameter": _MECHANICS | {"scene"},
    "structural": _MECHANICS | {"scene"},
    "input": _MECHANICS | {"scene"},
    "coordinate": _MECHANICS,
    "speed": _MECHANICS,
    "discrete": _MECHANICS,
    "output": _MECHANICS,
    "effect": frozenset({"model"}),
    "scene": frozenset({"model"}),
    "requires": frozenset({"effect"}),
    "excludes": frozenset({"effect"}),
    "start": frozenset({"scene"}),
    "simulate": frozenset({"scene"}),
    "annotation": frozenset({"file", "package", "model", "effect", "scene"}),
}
_IN_LOOPS = frozenset({
    "frame", "point", "body", "joint", "potential", "kinetic", "lagrangian", "dissipation",
    "draw",
    "force", "torque", "constraint", "initial", "for", "when", "instance",
})  # fmt: skip
_BY_INDEX = {  # how an array outside of a loop gets a value for each element
    "parameter": " = {... for i in 1:n}",
    "output": " = {... for i in 1:n}",
    "coordinate": "(start = {... for i in 1:n})",
    "speed": " = {... for i in 1:n}",
    "discrete": "(start = {... for i in 1:n})",
    "input": "",
}
_ENERGIES = {
    **dict.fromkeys(("T", "K", "KE", "Ek", "Ekin", "T_kin"), "kinetic"),
    **dict.fromkeys(("V", "U", "PE", "Ep", "Epot", "V_pot"), "potential"),
    **dict.fromkeys(("L", "Lagrangian"), "lagrangian"),
}
_OF_RUN = ("stop", "stoptime", "tstop", "t_end", "duration", "accuracy", "every", "points")  # settings
_LONGEST = 80  # characters of an energy that a remedy repeats
_SHOWN = {
    "file": "at the top of a file",
    "package": "in a package",
    "model": "in a model",
    "effect": "in an effect",
    "scene": "in a scene",
    "for": "in a loop",
}


def arrange(items: Iterable[Any], container: str, faults: list[Fault]) -> tuple[tree.Declaration, ...]:
    """Return the declarations of one block (`a model`, `an effect`, ... or FILE) in order, and report
    misplaced ones."""
    kind = container.rpartition(" ")[2]
    arranged, _ = _arrange(list(items), kind, False, faults)
    return arranged


def _arrange(
    items: Sequence[Any], container: str, initial: bool, faults: list[Fault]
) -> tuple[tuple[tree.Declaration, ...], bool]:
    """Return the declarations, and whether the block ends in an initial section; `initial`: it begins in
    one."""
    arranged: list[tree.Declaration] = []
    outside = True  # one fault for a run of equations outside
    misplaced: set[str] = set()  # one for each kind
    for item in items:
        kind = _kind(item)
        if isinstance(item, tree.Initial):
            if not item.conditions:
                initial = True
                _check(kind, item.span, container, misplaced, faults)
            elif initial:
                _gather(arranged, item)
            elif outside or _energy(item.conditions[0]):
                outside = False
                faults.append(_equation_outside(item, container))
            continue
        if isinstance(item, tree.ForLoop):
            body, _ = _arrange(item.body, "for", initial, faults)
            arranged.append(replace(item, body=body))
        else:
            initial = False
            if kind not in ("requires", "excludes"):
                arranged.append(item)
            if isinstance(item, tree.Quantities | tree.Instance):
                faults += [
                    _dotted_name_fault(d) for d in item.declarators if d.within and container != "scene"
                ]
        outside = True
        _check(kind, item.span, container, misplaced, faults)
    return tuple(arranged), initial


def _gather(arranged: list[tree.Declaration], item: tree.Initial) -> None:
    before = arranged[-1] if arranged else None
    if isinstance(before, tree.Initial) and _equal_names(before.unless, item.unless):
        conditions = before.conditions + item.conditions
        arranged[-1] = tree.Initial(conditions, before.unless, before.span.to(item.span))
    else:
        arranged.append(item)


def _equal_names(some: tuple[tree.Name, ...], others: tuple[tree.Name, ...]) -> bool:
    return [name.name for name in some] == [name.name for name in others]


def _kind(item: Any) -> str:
    if isinstance(item, tree.Quantities | tree.Construct | tree.Placeholder | tree.Load):
        return item.kind
    return _KINDS.get(type(item), type(item).__name__.lower())


_KINDS: dict[type, str] = {
    tree.TypeDeclaration: "type",
    tree.FunctionDeclaration: "function",
    tree.ForLoop: "for",
    tree.ModelDeclaration: "model",
}


def _check(kind: str, span: Span, container: str, misplaced: set[str], faults: list[Fault]) -> None:
    allowed = _IN_LOOPS if container == "for" else None
    places = _PLACES.get(kind, _MECHANICS)
    if kind in allowed if allowed is not None else container in places:
        return
    if kind in misplaced or (misplaced and container == "file"):
        return  # a whole block was closed too early, or too late
    misplaced.add(kind)
    begin = Span(span.source, span.start, min(span.end, span.start + len(kind)))
    shown = "an instance" if kind == "instance" else f"`{kind}`"
    good = [_SHOWN[place] for place in _SHOWN if place in places]
    if container == "for" and kind in _BY_INDEX:
        remedy = f"declare an array before the loop: `{kind} Type name[n]{_BY_INDEX[kind]};`"
    else:
        remedy = f"it belongs {' or '.join(good)}"
    if kind in ("start", "simulate") and container == "model" and "\n" not in span.text:
        remedy += f": `scene s {span.text} end s;`"
    if kind == "instance" and container == "scene":
        remedy += "; list the effects of a scene after `uses`: `scene name uses gravity;`"
    if kind in ("effect", "scene") and container == "effect":
        remedy += "; an `end` may be missing before it"
    faults.append(Fault("LAG0120", f"{shown} cannot stand {_SHOWN[container]}", begin, remedy=remedy))


def _equation_outside(item: tree.Initial, container: str) -> Fault:
    condition = item.conditions[0]
    left = condition.left
    if isinstance(left, tree.Name) and (left.name in _PLACES or left.name in _IN_LOOPS):
        message = f"a name is missing after `{left.name}`"
        return Fault("LAG0132", message, left.span, remedy=f"write `{left.name} name = ...`")
    message = "an equation is only allowed in the `initial` section"
    return Fault("LAG0122", message, condition.span, remedy=_instead(condition, container))


def _energy(condition: tree.Condition) -> str | None:
    """Return the kind of energy that `T = ...` and `V = ...` declare, or None."""
    return _ENERGIES.get(condition.left.name) if isinstance(condition.left, tree.Name) else None


def _instead(condition: tree.Condition, container: str) -> str:
    """Return what to write in place of an equation outside of the `initial` section."""
    target, right = condition.left.span.text, condition.right.span.text
    if container == "scene" and len(target + right) <= _LONGEST and "\n" not in target + right:
        if target.lower() in _OF_RUN:
            name = target if target in ("accuracy", "every", "points") else "stop"
            return f"write `simulate({name} = {right});`"
        name = target.removesuffix(".start")
        return f"for an initial value write `start {name} = {right};`, else `parameter {name} = {right};`"
    kind = _energy(condition)
    if kind == "lagrangian" and "der(" not in right:
        return "delete it: the Lagrangian is the kinetic energy of all bodies minus all energies `potential`"
    if kind is not None and len(right) <= _LONGEST and "\n" not in right:
        return f"write `{kind} {target} = {right};`"
    if "der(der(" in target + right or "acceleration(" in target + right:
        return (
            "delete it: the equations of motion follow from the bodies and what acts on them; write a force "
            "as `force f = {1 [N], 0, 0} at b;`"
        )
    if isinstance(condition.left, tree.Call) and target.endswith("(0)") and not target.startswith("der"):
        name = target.removesuffix("(0)")
        return f"write the initial value where `{name}` is declared, `{name}(start = {right})`"
    return (
        "for an equation that always holds write `constraint name: left = right;`; for a computed quantity "
        "`output Type name = value;`; for an initial condition put `initial` before it"
    )


def _dotted_name_fault(declarator: tree.Declarator) -> Fault:
    """Report `parameter a.l = 2;` outside of a scene."""
    message = "a declared name contains no `.`; a part of an instance is declared in its model"
    remedy = f"set its value at the instance, `Model a({declarator.name} = ...)`, or in a scene"
    return Fault("LAG0134", message, declarator.name_span, remedy=remedy)
