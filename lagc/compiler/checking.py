"""Check every model, scene and effect of a source for the errors that a run would report.

A stage reports all its errors at once.  Later stages are not checked for a text with errors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from lagc.base.records import dataclass, replace
from lagc.compiler.stages import PER_OPERATION, Choice, derive, optimize, parse, resolve
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host.budgets import Exhausted, go_on, stage

if TYPE_CHECKING:
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.semantics.model import Model
    from lagc.syntax.tree import Tree


_UNUSED = "LAG0230"  # an effect that no scene uses
STAGES = ("syntax", "names and dimensions", "equations", "initial conditions")


@dataclass(frozen=True, slots=True)
class Checked:
    """The faults, and the stages that were not reached everywhere because an earlier one had errors
    (`unseen`)."""

    faults: list[Fault]
    unseen: tuple[str, ...]


def check(source: Source, choice: Choice, roots: tuple[str, ...] = ()) -> list[Fault]:
    return look(source, choice, roots).faults


def look(source: Source, choice: Choice, roots: tuple[str, ...] = ()) -> Checked:
    """Check the syntax of `source` and, if it has no errors, each of its models and scenes, and unused
    effects. `choice` may name one model or scene.  Its parameter values are given to the models that have
    them."""
    reached = [len(STAGES)]  # number of stages, for each model and scene
    faults = _check_scenes(source, choice, roots, reached)
    if choice.parameters:
        from lagc.simulation.request import is_of_other_value

        faults = [
            fault
            for fault in faults
            if fault.span is None
            or not is_of_other_value(f"{fault.code}: {fault.message}", choice.parameters)
        ]
    return Checked(faults, STAGES[min(reached) :])


def _check_scenes(source: Source, choice: Choice, roots: tuple[str, ...], reached: list[int]) -> list[Fault]:
    try:
        tree = parse(source)
    except Refused as refused:
        reached.append(1)
        return list(refused.faults)
    known: set[str] = set()

    def faults_of(file: Tree, each: Choice) -> dict[tuple[object, ...], Fault]:
        return _faults(file, each, roots, known, reached)

    return [*faults_in_scenes(tree, choice, roots, faults_of), *_unknown_parameters(choice, known)]


def faults_in_scenes(
    tree: Tree, choice: Choice, roots: tuple[str, ...],
    faults_of: Callable[[Tree, Choice], dict[tuple[object, ...], Fault]],
) -> list[Fault]:  # fmt: skip
    """Return the warnings of a text and the faults by `faults_of` of each scene; of an unused effect, only
    those that it has with and without the other effects."""
    from lagc.semantics.resolve import text_warnings
    from lagc.semantics.scenes import ByScene, variants

    # Faults by place: scenes share declarations, so one fault would be found in each.
    faults = by_place(text_warnings(tree))
    if choice.scene is not None:
        return list((faults | faults_of(tree, choice)).values())
    models: set[str | None] = set()
    scenes = ByScene(tree)
    # Each scene, and effects that no scene uses, alone and beside the others.
    for v in variants(tree, choice.model, roots):
        each = replace(
            choice,
            model=v.model,
            scene=v.scene,
            with_effects=(*choice.with_effects, *v.with_effects),
            without_effects=(*choice.without_effects, *v.without_effects),
        )
        # The first check of a model covers what its scenes share.
        file = scenes.only(v.scene) if v.scene and v.model in models else tree
        models.add(v.model)
        found = faults_of(file, each)
        if file is not tree:  # the scenes that use the effects are not in it
            found = {key: fault for key, fault in found.items() if fault.code != _UNUSED}
        if found and v.alone:  # an effect that no scene uses: errors with and without the other effects
            alone = replace(each, without_effects=(*each.without_effects, *v.alone))
            without = faults_of(file, alone)
            found = {key: fault for key, fault in found.items() if key in without}
        for key, fault in found.items():
            faults.setdefault(key, fault)
    return list(faults.values())


def _faults(
    tree: Tree, choice: Choice, roots: tuple[str, ...], known: set[str], reached: list[int]
) -> dict[tuple[object, ...], Fault]:
    """Return the faults of one choice by code and place, warnings first. Adds the names of its parameters and
    inputs to `known`, and the number of stages that it reached to `reached`."""
    faults: Sequence[Fault]
    warnings: Sequence[Fault] = ()
    asked: Sequence[Fault] = ()
    stages = 2
    try:
        model = resolve(tree, choice, roots)
        warnings, stages = model.warnings, 3
        units = {p.name: p.unit for p in model.parameters} | {u.name: u.unit for u in model.inputs}
        known.update(units, model.built_in)
        if choice.parameters:
            from lagc.simulation.request import angle_warnings

            asked = angle_warnings(choice.parameters, units)
        equations = derive(model)
        warnings, stages = equations.warnings, 4
        if not any(fault.code == _UNUSED for fault in warnings):
            from lagc.mechanics.lint.loads import motionless_system

            warnings = [*warnings, *motionless_system(equations)]
        faults = _initial_faults(model, equations, choice)
    except Refused as refused:
        faults = refused.faults
    reached.append(stages)
    return by_place([*asked, *warnings, *faults])


def by_place(faults: Sequence[Fault]) -> dict[tuple[object, ...], Fault]:
    """Return the first fault of each code at each place."""
    found: dict[tuple[object, ...], Fault] = {}
    for fault in faults:
        span = fault.span
        at = (span.source.name, span.start, span.end) if span else (fault.message,)
        found.setdefault((fault.code, *at), fault)
    return found


def _initial_faults(model: Model, equations: EquationsOfMotion, choice: Choice) -> list[Fault]:
    """Try the initial state, and return warnings. A warning tells that a parameter has no value, that the
    check took too long, or that an output has no finite value.  Raises Refused if a run would fail before its
    first step."""
    from lagc.compiler.pipeline import unused
    from lagc.compiler.source_spans import placed
    from lagc.simulation.initialization.dry_run import NoStart, try_start
    from lagc.simulation.request import bound_parameters

    # The interface says which parameters a run must give; a value that is missing ends the check with a
    # warning.
    program = optimize(equations, work=True)
    interface, left = program.interface, unused(model, program.interface)
    fields = (*interface.parameters, *interface.inputs)
    names = {f.name for f in (*fields, *left)}
    given = {name: value for name, value in choice.parameters.items() if name in names}
    values = bound_parameters(interface, given, left, demanding=False)
    missing = {f.name for f, value in zip(fields, values) if value != value}
    for p in model.parameters:
        if p.name in missing:
            message = f"parameter `{p.name}` has no value: the initial state was not checked"
            return [Fault("LAG0603", message, p.span,
                          remedy=f"give it one: -p {p.name}=...", severity="warning")]  # fmt: skip
    # The check has a limit of time, a run has none: beyond it the initial state is not refused.
    try:
        with stage("checking the initial state", PER_OPERATION * interface.operations):
            strange = try_start(program, values)
    except NoStart as found:
        raise placed(equations, found) from None
    except Exhausted:
        if not go_on():
            raise
        return [Fault("LAG0805", "the initial state was not checked completely, because that takes too long",
                      remedy="`lagc sim` has no such limit; `lagc check --max-time 1h` sets another",
                      severity="warning")]  # fmt: skip
    return [
        Fault("LAG0616", f"output `{o.name}` has no finite initial value", o.span, severity="warning")
        for o in model.outputs
        if o.name in strange
    ]


def _unknown_parameters(choice: Choice, known: set[str]) -> list[Fault]:
    """Faults for given parameters that no model has, if a model could be resolved."""
    names = [name for name in choice.parameters if known and name not in known]
    if not names:
        return []
    from lagc.simulation.request import unknown

    return [unknown(name, known, "parameter or input", "LAG0601") for name in names]
