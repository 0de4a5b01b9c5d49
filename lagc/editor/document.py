"""One text and the answers about it; each stage runs when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from typing import Any

from lagc.base.records import dataclass
from lagc.compiler.checking import by_place, faults_in_scenes
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Edit, Fault, Refused, Source
from lagc.editor import words
from lagc.editor.completion import Offer, completions
from lagc.editor.facts import Values, fact, said
from lagc.editor.names import Declared, Index, Use, nodes_at
from lagc.host.budgets import Limits, stage
from lagc.semantics.context import Context
from lagc.semantics.model import Model
from lagc.semantics.names.scope import Environment, Value
from lagc.semantics.resolve import resolve
from lagc.semantics.units import UnknownUnit, describe, unit
from lagc.semantics.values.expressions import EVALUATORS
from lagc.syntax import tree
from lagc.syntax.formatter import format_source
from lagc.syntax.lexer import Lexed
from lagc.syntax.parse import read

QUICK = 0.15  # s for names and dimensions
Faults = dict[tuple[object, ...], Fault]


@dataclass(frozen=True)
class Hover:
    """Markdown about the characters start..end."""

    text: str
    start: int
    end: int


@dataclass
class Resolved:
    """The models of a text by model and scene, the values of its expressions, and the faults; `complete`: all
    scenes were looked at."""

    models: dict[tuple[str | None, str | None], Model]
    values: Values
    faults: list[Fault]
    complete: bool = False


class Document:
    """A text called `name`, a path if it is a file; `roots` are further folders for imports. Names and
    dimensions are looked at for `quick` s, by default `QUICK`."""

    def __init__(self, name: str, text: str, roots: tuple[str, ...] = (), quick: float | None = None):
        self.source, self.roots, self.quick = Source(name, text), roots, quick

    def with_edits(self, edits: tuple[Edit, ...] | list[Edit]) -> Document:
        text = self.source.text
        for edit in sorted(edits, key=lambda edit: -edit.start):
            text = text[: edit.start] + edit.text + text[edit.end :]
        return Document(self.source.name, text, self.roots, self.quick)

    # -- stages ------------------------------------------------------------------------

    @cached_property
    def _read(self) -> tuple[tree.Tree, Lexed, list[Fault]]:
        return read(self.source)

    @property
    def tree(self) -> tree.Tree:
        """The tree, without the passages that cannot be read."""
        return self._read[0]

    @property
    def syntax_faults(self) -> list[Fault]:
        return self._read[2]

    @cached_property
    def names(self) -> Index:
        return Index(self.tree, self.roots)

    @cached_property
    def resolved(self) -> Resolved:
        """The models, if the syntax has no faults; those that are found within `quick` s."""
        found = Resolved({}, {}, [])
        evaluators = {kind: _recording(f, self.source, found.values) for kind, f in EVALUATORS.items()}

        def faults_of(file: tree.Tree, choice: Choice) -> Faults:
            chosen = (choice.scene, choice.with_effects, choice.without_effects, choice.model)
            try:
                with stage("finding what names mean"):
                    model = resolve(file, *chosen, roots=self.roots, evaluators=evaluators)
            except Refused as refused:
                return by_place(refused.faults)
            found.models[choice.model, choice.scene] = model
            return by_place(model.warnings)

        if not self.syntax_faults:
            with suppress(Refused), Limits(time=self.quick or QUICK):
                found.faults = faults_in_scenes(self.tree, Choice(), self.roots, faults_of)
                found.complete = True
        return found

    @property
    def settled(self) -> bool:
        """Whether `faults` are all that it can tell: the syntax has some, or all scenes were looked at."""
        return bool(self.syntax_faults) or self.resolved.complete

    @property
    def faults(self) -> list[Fault]:
        """The faults of syntax, or else of names and dimensions."""
        return self.syntax_faults or self.resolved.faults

    # -- answers -----------------------------------------------------------------------

    def formatted(self) -> str | None:
        """Return the text in the standard layout, or None if its syntax has faults."""
        return None if self.syntax_faults else format_source(self.source)

    def hover(self, offset: int) -> Hover | None:
        """Return what is known of the name, the unit or the expression at an offset."""
        use = self.names.at(offset)
        if use is not None and offset < use.span.end:
            return Hover(self.about(use.target), use.span.start, use.span.end)
        for node in nodes_at(self.tree.declarations, offset):
            at = node.span.start, node.span.end
            text = _of_word(node) or said(self.resolved.values.get(at), self._known)
            if text and not isinstance(node, tree.Number):  # of `60 [deg]` all
                return Hover(text, *at)
        return None

    @cached_property
    def _known(self) -> dict[Any, float]:
        """The values of parameters."""
        models = self.resolved.models.values()
        return {p.symbol: p.value for m in models for p in m.parameters if p.value is not None}

    def about(self, declared: Declared) -> str:
        first, *more = declared.span.text.splitlines()
        parts = [f"```lag\n{first.strip()}{' ...' if more else ''}\n```"]
        if declared.description:
            parts.append(declared.description)
        for model in self.resolved.models.values():
            text = fact(declared, model)
            if text:
                parts.append(text)
                break
        return "\n\n".join(parts)

    def completions(self, offset: int) -> list[Offer]:
        """Return what may be written at an offset, the likely first."""
        return completions(self.source, self.names, offset)

    def renamed(self, use: Use, name: str) -> list[Edit]:
        """Return the edits that rename a declaration in this file. Raises Refused if it is in another one, if
        the text has errors, or if it would have some or name something else."""
        place = use.target.place
        if place.source is not self.source:
            message = f"`{use.target.name}` is declared in `{place.source.name}`"
            raise Refused([Fault("LAG0202", message, use.span)])
        spans = self.names.references(use.target)
        edits = [Edit(span.start, span.end, name) for span in spans]
        new = self.with_edits(edits)
        other = new.names.at(spans[0].start)
        same = other is not None and len(new.names.references(other.target)) == len(spans)
        errors = errors_of(self.faults) or errors_of(new.faults)
        if not errors and not same:
            errors = [Fault("LAG0202", f"`{use.target.name}` cannot be called `{name}` here", use.span)]
        if errors:
            raise Refused(errors)
        return edits


def errors_of(faults: list[Fault]) -> list[Fault]:
    return [fault for fault in faults if fault.severity == "error"]


def _recording(evaluator: Callable[..., Value], source: Source, values: Values) -> Callable[..., Value]:
    """Return an evaluator that records the values of the expressions of a text."""

    def record(context: Context, e: tree.Expression, environment: Environment, *more: Any) -> Value:
        value = evaluator(context, e, environment, *more)
        if e.span.source is source:
            alone = not environment.bindings and not environment.instance.path
            values.setdefault((e.span.start, e.span.end), (value, alone))
        return value

    return record


def _of_word(node: object) -> str:
    """Return what a word of the language means: a unit, a quantity type, a function, a joint, or ""."""
    match node:
        case tree.Unit():
            try:
                known = unit(node.text)
            except UnknownUnit:
                return ""
            return f"`{node.text}` = {known.factor:.12g} in SI, {describe(known.dimension)}"
        case tree.TypeName(path=(name,)) if name in words.types():
            return f"`{name}`, a quantity in `{words.types()[name] or '1'}`"
        case tree.Name(name=name):
            call = words.FUNCTIONS.get(name) or words.THINGS.get(name)
            return "" if call is None else f"```lag\n{words.shown(name, call)}\n```"
    return ""
