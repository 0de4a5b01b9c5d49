"""A file with the scenes of one name alone: of n scenes, each would be looked at n times else."""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import replace
from lagc.syntax.tree import Declaration, ModelDeclaration, Package, Scene, Tree


class ByScene:
    """`tree`, taken apart once."""

    def __init__(self, tree: Tree):
        self.tree = tree
        self.body = _Body(tree.declarations)

    def only(self, name: str) -> Tree:
        """The tree without the other scenes of its models."""
        return replace(self.tree, declarations=self.body.only(name))


class _Body:
    def __init__(self, declarations: Sequence[Declaration]):
        self.others: list[Declaration] = []
        self.inner: dict[int, tuple[ModelDeclaration | Package, _Body]] = {}  # by place among the others
        self.scenes: dict[str, list[tuple[int, Scene]]] = {}  # with how many of the others come before
        for d in declarations:
            if isinstance(d, Scene):
                self.scenes.setdefault(d.name, []).append((len(self.others), d))
                continue
            if isinstance(d, ModelDeclaration | Package):
                self.inner[len(self.others)] = d, _Body(d.body)
            self.others.append(d)

    def only(self, name: str) -> tuple[Declaration, ...]:
        kept = list(self.others)
        for k, (d, body) in self.inner.items():
            kept[k] = replace(d, body=body.only(name))
        for before, scene in reversed(self.scenes.get(name, [])):
            kept.insert(before, scene)
        return tuple(kept)
