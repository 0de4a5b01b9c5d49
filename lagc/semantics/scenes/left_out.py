"""Warnings for declarations that have no part in any motion: effects that no scene uses, and annotations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from lagc.diagnostics.faults import Fault
from lagc.semantics.names.scope import Instance
from lagc.semantics.scenes.choice import Setting
from lagc.syntax import tree

_SETTINGS = {"StopTime": "stop", "Tolerance": "accuracy", "Interval": "every"}  # of `experiment`


def unused_effects(
    file: tree.Tree, instance: Instance, setting: Setting, scenes: Mapping[str, tree.Scene]
) -> list[Fault]:
    """Return a warning for each effect of the main model that no scene of the file uses."""
    known = [*scenes.values(), *(d for d, _ in _within(file.declarations) if isinstance(d, tree.Scene))]
    used = {name.name for scene in known for name in scene.uses} | setting.uses.all
    left = {n: e for n, e in instance.effects.items() if n not in used and e.span.source is file.source}
    first = next(iter(scenes.values()), None)
    uses = ", ".join([name.name for name in first.uses] if first else [])
    found = []
    for name, effect in left.items():
        listed = f"{uses}, {name}" if uses else name if first else ", ".join(left)
        begin = f"scene {first.name if first else 'lab'} uses {listed}"
        remedy = f"write `{begin}{' ...' if first and first.body else ';'}`, or run with `--with {name}`"
        message = f"no scene uses the effect `{name}`, which has no part in the motion"
        found.append(Fault("LAG0230", message, effect.name_span, remedy=remedy, severity="warning"))
    return found


def ignored_annotations(file: tree.Tree) -> list[Fault]:
    """Return a warning for each annotation, which has no effect."""
    return [
        Fault("LAG0231", "an annotation has no effect", d.span, remedy=_instead(d, body), severity="warning")
        for d, body in _within(file.declarations)
        if isinstance(d, tree.Annotation)
    ]


def _instead(annotation: tree.Annotation, body: Sequence[tree.Declaration]) -> str:
    """Return the settings to write for `annotation(experiment(StopTime = 10))`."""
    for argument in annotation.arguments:
        call = argument.value
        if isinstance(call, tree.Call) and call.function.span.text == "experiment":
            settings = [
                f"{_SETTINGS[a.name]} = {a.value.span.text}"
                for a in call.arguments
                if a.name in _SETTINGS and a.value is not None
            ]
            if settings:
                simulate = f"simulate({', '.join(settings)});"
                scene = next((d for d in body if isinstance(d, tree.Scene)), None)
                if scene is None:
                    return f"write `scene lab {simulate} end lab;`"
                return f"write `{simulate}` in the scene `{scene.name}`"
    return "delete it"


def _within(
    declarations: Sequence[tree.Declaration],
) -> Iterator[tuple[tree.Declaration, Sequence[tree.Declaration]]]:
    """Yield all declarations of a file, each with those beside it."""
    for d in declarations:
        yield d, declarations
        if isinstance(d, tree.ModelDeclaration | tree.Package | tree.Effect | tree.Scene):
            yield from _within(d.body)
