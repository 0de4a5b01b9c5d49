"""From the syntax tree to the Model: the sequence of the stages of this room."""

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from lagc.base.records import replace
from lagc.diagnostics.faults import Fault, Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics import model as objects
from lagc.semantics.context import LATE, MOVING, Context
from lagc.semantics.declarations.quantities import declare_quantity
from lagc.semantics.instantiate import Builder
from lagc.semantics.names.namespace import Importer, Namespace
from lagc.semantics.names.scope import Entry, Environment, Instance, Reference, Uses, Value
from lagc.semantics.scenes import (
    Inputs,
    Numbers,
    Setting,
    check_effects,
    choose_model,
    choose_scene,
    ignored_annotations,
    read_command,
    read_inputs,
    read_rest,
    read_values,
    scenes_of,
    unused_effects,
)
from lagc.semantics.values.calls import look_at_uncalled
from lagc.semantics.values.expressions import EVALUATORS
from lagc.semantics.values.unit_hints import angular_hertz, whole_radians
from lagc.syntax import tree

RECURSION = 40_000  # Python frames; nesting is limited far below that
T = TypeVar("T")


def resolve(
    file: tree.Tree,
    scene: str | None = None,
    with_effects: Sequence[str] = (),
    without_effects: Sequence[str] = (),
    model: str | None = None,
    parameters: Numbers | None = None,
    starts: Numbers | None = None,
    inputs: Inputs | None = None,
    until: str | None = None,
    roots: Sequence[str] | None = None,
    probes: Sequence[str] = (),
    evaluators: Mapping[type, Callable[..., Value]] = EVALUATORS,
) -> objects.Model:
    """Return one scene of a model of the file, with all names resolved. `parameters` and `starts` are values
    by full name, in SI or with a unit; `inputs` are texts of expressions or points over time; `until` is the
    condition that ends a run; `roots` are further folders for imports; `probes` are expressions that become
    outputs; `evaluators` find the value of each kind of expression. Raises Refused with all faults."""
    sys.setrecursionlimit(max(sys.getrecursionlimit(), RECURSION))

    # A reaction that an output asks for needs a model in which its constraint is released: the file is
    # resolved twice then.
    def once(before: Context | None) -> tuple[Context, objects.Model]:
        importer = Importer(file.source, tuple(roots or ()))
        context = Context(importer, Uses(), declare, evaluators, before)
        found = _resolve(context, file, scene, with_effects, without_effects, model, parameters, starts,
                         inputs, until, probes)  # fmt: skip
        return context, found

    context, found = once(None)
    return replace(found, released=once(context)[1]) if context.held else found


def _resolve(
    context: Context,
    file: tree.Tree,
    scene: str | None,
    with_effects: Sequence[str],
    without_effects: Sequence[str],
    model: str | None,
    parameters: Numbers | None,
    starts: Numbers | None,
    inputs: Inputs | None,
    until: str | None,
    probes: Sequence[str],
) -> objects.Model:
    # Model and scene are chosen first: effects decide which declarations exist.
    importer = context.importer
    space = Namespace(file.declarations, None, importer)
    importer.look_at(file.declarations, space)
    try:
        declaration, where = choose_model(file, space, model)
        scenes = scenes_of(context, declaration, where)
        setting = choose_scene(scenes, scene, with_effects, without_effects)
        context.uses = setting.uses
        instance = Instance("", declaration, None)
        environment = Environment(instance, importer.inside(declaration, where))
        read_values(context, setting, environment)
        read_command(context, parameters, starts)
        read_inputs(context, inputs or {}, environment)
        if until is not None:
            from lagc.semantics.declarations.events import ending_clause

            context.whens.append((ending_clause(context, until), environment, None))
        # All names are entered before a value is asked for, so that declarations may come in any order.
        Builder(context, instance, {}).build(declaration, where)
        context.conditions[:0] = instance.conditions
        simulate = read_rest(context, setting, environment)
    except Wrong as wrong:
        context.report(wrong)
        context.refuse_faults()
        raise AssertionError("a fault refuses") from None
    check_effects(context, setting)
    # Every declaration is evaluated; what it depends on is evaluated before it.
    declared = [*_evaluate(context, instance), *_probes(context, probes, environment)]
    conditions = _conditions(context)
    whens = _whens(context)
    _refuse_jumps(context, declared, conditions)
    look_at_uncalled(context, instance.in_order())
    _check_given(context, instance)
    if not context.faults and not any(isinstance(x, _COORDINATES) for x in declared):
        context.report(_nothing_moves(declaration))
    context.refuse_faults()
    # Faults refuse the model here, warnings go with it.
    warnings = [*context.warnings.values(), *text_warnings(file)]
    if instance.effects:
        warnings += unused_effects(file, instance, setting, scenes)
    return _model(context, declaration, setting, declared, conditions, whens, simulate, warnings)


def text_warnings(file: tree.Tree) -> list[Fault]:
    """Return the warnings that the text of a file gives, whatever its models are."""
    return [*whole_radians(file), *angular_hertz(file), *ignored_annotations(file)]


def _nothing_moves(declaration: tree.ModelDeclaration) -> Wrong:
    """Return the fault of a model without coordinates, with the arrays of coordinates that have a size of
    0."""
    arrays = [
        declarator
        for d in declaration.body
        if isinstance(d, tree.Quantities) and d.kind == "coordinate"
        for declarator in d.declarators
        if declarator.dimensions
    ]
    empty = "; ".join(
        f"`{a.name}` has no entries, as {' or '.join(size.span.text for size in a.dimensions)} = 0"
        for a in arrays
    )
    reason = f": {empty}" if empty else ""
    message = f"the model `{declaration.name}` has no coordinates, so nothing can move{reason}"
    remedy = "set the size to 1 or more" if empty else "declare one: `coordinate Length x;`"
    return Wrong("LAG0222", message, declaration.name_span, remedy)


def _evaluate(context: Context, instance: Instance) -> list[objects.ModelObject]:
    """Return the objects of every declaration, in order; figures come last, so that no other expression
    depends on what is drawn."""
    found: list[objects.ModelObject] = []
    for entry in sorted(instance.in_order(), key=lambda entry: entry.kind == "draw"):
        if context.attempt(context.value, entry, entry.span):
            found.extend(entry.objects)
    return found


def _probes(context: Context, texts: Sequence[str], environment: Environment) -> list[objects.ModelObject]:
    found: list[objects.ModelObject] = []
    for k, text in enumerate(texts):
        from lagc.semantics.requests import parse_probe, probe_outputs  # where there are some

        written = parse_probe(context, text)
        context.attempt(lambda n, w: found.extend(probe_outputs(context, n, w, environment)), k + 1, written)
    return found


def _conditions(context: Context) -> list[objects.InitialCondition]:
    if not context.conditions:
        return []
    from lagc.semantics.declarations.actions import condition  # where there are some

    found: list[objects.InitialCondition] = []
    for written, environment in context.conditions:
        context.attempt(lambda w, e: found.extend(condition(context, w, e)), written, environment)
    return found


def _whens(context: Context) -> list[objects.When]:
    """Return the event clauses in order; clauses whose condition is constant are left out."""
    if not context.whens:
        return []
    from lagc.semantics.declarations.events import when_clause  # where there are some

    found: list[objects.When] = []

    def add_clause(written: tree.When, environment: Environment, effect: str | None) -> None:
        clause = when_clause(context, written, environment, effect)
        if context.clock.mask(clause.condition) & (MOVING | LATE):
            found.append(clause)

    for given in context.whens:
        context.attempt(add_clause, *given)
    return found


def _refuse_jumps(
    context: Context, declared: Sequence[objects.ModelObject], conditions: Sequence[objects.InitialCondition]
) -> None:
    """Report what depends on a discrete variable, and may not jump."""
    if _of(declared, objects.Discrete) or context.impulses:
        from lagc.semantics.declarations.events import refuse_in_constraints  # where there are some

        constraints, speeds = _of(declared, objects.Constraint), _of(declared, objects.Speed)
        refuse_in_constraints(context, constraints, conditions, speeds)


def _check_given(context: Context, instance: Instance) -> None:
    """Report values that are given to unknown or unsuitable names."""
    discrete = any(entry.kind == "discrete" for entry in instance.in_order())
    settable = "coordinate, rate, speed or discrete variable" if discrete else "coordinate, rate or speed"
    for table, what, code in (
        (context.parameters, "parameter or input", "LAG0215"),
        (context.starts, settable, "LAG0224"),
    ):
        kinds = ("coordinate", "speed", "discrete")
        if table is context.parameters:
            kinds = ("parameter", "structural", "input")
        for name, value in table.items():
            if name in context.taken:
                continue
            reason = instance.unused.get(value.owner)
            if reason is not None:
                context.report(Wrong(code, f"`{name}` {reason}", value.span))
                continue
            entries = [e for e in instance.in_order() if e.kind in kinds]
            if context.faults and any(not e.objects and e.path == _base(value.owner) for e in entries):
                continue
            known = [n for e in entries for n in (_names(e.objects) or [e.path])]
            remedy = _rate(instance, name, value.expression) if code == "LAG0224" else None
            remedy = remedy or did_you_mean(name, known) or _other_kind(instance, _base(value.owner))
            context.report(Wrong(code, f"there is no {what} `{name}`", value.span, remedy))


def _rate(instance: Instance, name: str, value: tree.Expression | None) -> str | None:
    """Return a remedy for `start dtheta = 1;`."""
    from lagc.semantics.names.undeclared import rate_of  # where there is a fault

    rate = rate_of(name, instance)
    return rate and (f"write `start {rate} = {value.span.text};`" if value else f"write `{rate}`")


def _base(name: str) -> str:
    """Return `a.th` for `a.th[2]`."""
    return name.rpartition("[")[0] if name.endswith("]") else name


def _other_kind(instance: Instance, path: str) -> str | None:
    """Return a remedy for a name that is given a value in the wrong way."""
    kind = next((e.kind for e in instance.in_order() if e.path == path), None)
    if kind == "parameter":
        return f"`{path}` is a parameter: write `parameter {path} = ...;`"
    if kind in ("coordinate", "discrete"):
        return f"`{path}` is a {kind}{' variable' if kind == 'discrete' else ''}: write `start {path} = ...;`"
    return None if kind is None else f"`{path}` is a {kind}"


def _names(found: Sequence[objects.ModelObject]) -> list[str]:
    names = [item.name for item in found if not isinstance(item, objects.Release)]
    return [*names, *(n.rate_symbol.record.name for n in found if isinstance(n, objects.Coordinate))]


def _of(found: Sequence[objects.ModelObject], kind: type[T]) -> tuple[T, ...]:
    return tuple([item for item in found if isinstance(item, kind)])


def _model(
    context: Context,
    declaration: tree.ModelDeclaration,
    setting: Setting,
    found: list[objects.ModelObject],
    conditions: list[objects.InitialCondition],
    whens: list[objects.When],
    simulate: dict[str, float],
    warnings: Sequence[Fault],
) -> objects.Model:
    # Objects of the declarations by kind; actions are of several kinds and keep their common order.
    kinds = objects.Potential | objects.Force | objects.Torque | objects.Dissipation | objects.Lagrangian
    effects = [
        objects.Effect(path, e.description or "", setting.uses.has(path), e.span)
        for path, e in context.effects.items()
    ]
    of_one_kind: dict[str, Any] = {field: _of(found, kind) for field, kind in _KINDS.items()}
    modes = [contact.mode for contact in _of(found, objects.Contact)]
    return objects.Model(
        name=declaration.name,
        scene=setting.name,
        description=declaration.description or "",
        graph=context.graph,
        time=context.time,
        # The objects of the declarations, each kind in the order of the text.
        coordinates=tuple([n for n in found if isinstance(n, _COORDINATES)]),
        actions=tuple([n for n in found if isinstance(n, kinds)]),
        discretes=(*_of(found, objects.Discrete), *context.impulses.values(), *modes),
        **of_one_kind,
        # The clauses, the choice of the scene, and what the resolution has gathered.
        initial_conditions=tuple(conditions),
        whens=tuple(whens),
        tables=tuple(context.curves.values()),
        effects=tuple(effects),
        scenes=setting.names,
        simulate=simulate,
        scales=context.scales,
        built_in=tuple(context.built_in),
        imports=tuple(context.importer.asked.items()),
        notes=setting.notes,
        warnings=tuple(warnings),
    )


_COORDINATES = (objects.Coordinate, objects.Orientation)
_KINDS: dict[str, type[Any]] = {  # fields of the model that hold objects of one kind
    "parameters": objects.Parameter, "inputs": objects.Input, "speeds": objects.Speed,
    "frames": objects.Frame, "points": objects.Point, "bodies": objects.Body,
    "constraints": objects.Constraint, "contacts": objects.Contact, "outputs": objects.Output,
    "limits": objects.Limit, "joints": objects.Joint, "releases": objects.Release,
    "figures": objects.Figure,
}  # fmt: skip


def _instance(context: Context, entry: Entry) -> Value:
    message = f"a size depends on `{entry.path}`, which is only created after the sizes are known"
    raise Wrong("LAG0205", message, entry.span)


def _without_kind(context: Context, entry: Entry) -> Value:
    from lagc.semantics.names.undeclared import refuse_without_kind  # where there is a fault

    return refuse_without_kind(context, entry)


def _action(context: Context, entry: Entry) -> Value:
    from lagc.semantics.declarations import actions  # where there are some

    return actions.DECLARE[entry.kind](context, entry)


def _body(context: Context, entry: Entry) -> Value:
    from lagc.semantics.declarations.bodies import declare_body, declare_gravity  # where there are some

    return declare_body(context, entry) if entry.kind == "body" else declare_gravity(context, entry)


def _joint(context: Context, entry: Entry) -> Value:
    from lagc.semantics.declarations.joints import declare_joint  # where there are some

    return declare_joint(context, entry)


def _figure(context: Context, entry: Entry) -> Value:
    from lagc.semantics.declarations.figures import declare_figure  # where there are some

    return declare_figure(context, entry)


def _constraint(context: Context, entry: Entry) -> Value:
    assert isinstance(entry.source, tree.Constraint)
    two_sided = entry.source.relation == "="
    if two_sided and all(argument.name == "by" for argument in entry.source.arguments):
        return _action(context, entry)
    from lagc.semantics.declarations.contacts import declare_contact, declare_rough  # where there are some

    return declare_rough(context, entry) if two_sided else declare_contact(context, entry)


DECLARE: dict[str, Callable[[Context, Entry], Value]] = {
    **dict.fromkeys(("constant", "parameter", "structural", "input", "output"), declare_quantity),
    **dict.fromkeys(("coordinate", "speed", "discrete"), declare_quantity),
    "function": lambda context, entry: Reference(entry), "instance": _instance, "quantity": _without_kind,
    **dict.fromkeys(("frame", "point", "potential", "kinetic", "lagrangian", "dissipation"), _action),
    **dict.fromkeys(("force", "torque", "placeholder"), _action),
    "constraint": _constraint, "body": _body, "gravity": _body, "joint": _joint, "draw": _figure,
}  # fmt: skip


def declare(context: Context, entry: Entry) -> Value:
    """Return the value of a declaration and append its objects to `entry.objects`.  Raises Wrong."""
    return DECLARE[entry.kind](context, entry)
