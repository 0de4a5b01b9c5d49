"""The stages in one place: from a text to something that runs.

    parse -> resolve -> derive -> optimize -> render -> load

Each stage takes the noun that the one before returns; a stage is imported when it is needed,
so that a run of a model that is in the cache loads none of the first four.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from lagc.diagnostics.faults import Fault, Refused, Source

if TYPE_CHECKING:
    from lagc.frontend.tree import Tree
    from lagc.meaning.model import Model
    from lagc.mechanics.equations import EquationsOfMotion
    from lagc.optimize.program import Program


@dataclass(frozen=True)
class Choice:
    """What of a file is meant: the model, its scene and effects, and values that are built in
    (structural integers; the other parameters stay symbols)."""

    model: str | None = None
    scene: str | None = None
    with_effects: tuple[str, ...] = ()
    without_effects: tuple[str, ...] = ()
    parameters: Mapping[str, float] = field(default_factory=dict)


def parse(source: Source) -> Tree:
    from lagc.frontend.parse import parse as run

    return run(source)


def resolve(tree: Tree, choice: Choice, roots: tuple[str, ...] = ()) -> Model:
    from lagc.meaning.resolve import resolve as run

    return run(
        tree,
        scene=choice.scene,
        with_effects=choice.with_effects,
        without_effects=choice.without_effects,
        model=choice.model,
        parameters=dict(choice.parameters),
        roots=roots,
    )


def derive(model: Model) -> EquationsOfMotion:
    from lagc.mechanics.derive import derive as run

    return run(model)


def optimize(equations: EquationsOfMotion, work: bool) -> Program:
    from lagc.optimize.optimize import optimize as run

    return run(equations, work=work)


def render(program: Program, target: str) -> dict[str, str]:
    """File name -> text."""
    if target == "c":
        from lagc.render.c.render import render as render_c

        return render_c(program)
    from lagc.render.numpy.render import render as render_numpy

    return render_numpy(program)


def check(source: Source, choice: Choice, roots: tuple[str, ...] = ()) -> list[Fault]:
    """Every fault of `source`: of its syntax or, where that is sound, of each of its scenes (of
    the chosen one where one is named)."""
    try:
        tree = parse(source)
    except Refused as refused:
        return list(refused.faults)
    faults: dict[tuple[object, ...], Fault] = {}
    scenes: list[str | None] = [choice.scene]
    done: set[str | None] = set()
    while scenes:
        scene = scenes.pop(0)
        try:
            model = resolve(tree, Choice(choice.model, scene, choice.with_effects, choice.without_effects,
                                         choice.parameters), roots)  # fmt: skip
            done |= {scene, model.scene}
            if choice.scene is None and scene is None:
                scenes = [s for s in model.scenes if s not in done]
            derive(model)
        except Refused as refused:
            for fault in refused.faults:
                span = fault.span
                at = (span.source.name, span.start, span.end) if span else ()
                faults.setdefault((fault.code, fault.message, *at), fault)
    return list(faults.values())
