"""Compilations: the stages of the compiler, run as far as needed, for any number of threads.

A run of a cached model loads none of the stages.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

from lagc.base.records import RLock, dataclass, once, replace
from lagc.compiler.artifact import (
    Artifact,
    Head,
    load_artifact,
    load_head,
    store_artifact,
    store_head,
    version_key,
)
from lagc.compiler.fixed_discretes import DERIVED, refuse_contacts, with_fixed_discretes
from lagc.compiler.stages import Choice, derive, optimize, parse, render, resolve, uncollected
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host import cache
from lagc.host.model_library import folder_of
from lagc.kernels import DEFAULT_METHOD, EXPLICIT, IMPLICIT, METHODS, SERIES
from lagc.lowering.program import Field

if TYPE_CHECKING:
    from types import CodeType

    from lagc.lowering.program import Interface, Program
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.semantics.context import Points
    from lagc.semantics.model import Model


class Compilation:
    """One choice of one source, compiled as far as needed. Each stage runs at most once, for any number of
    threads.  Pickles as source and choice, with what was `read` of other files.  `look` is called with the
    resolved model and may refuse it."""

    variant = ""  # of the program: "derivatives", "sensitivities", or a method besides the default one

    def __init__(
        self, source: Source, choice: Choice, roots: tuple[str, ...] = (), read: Head | None = None,
        look: Callable[[Model], None] = lambda model: None,
    ):  # fmt: skip
        self.source, self.choice, self.roots, self.read, self.look = source, choice, roots, read, look
        self.lock = RLock()
        self.others: dict[str, Compilation] = {}  # by method

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.source, self.choice, self.roots, self.read)

    @property
    def is_current(self) -> bool:
        """Whether the files that it was compiled from are unchanged."""
        return self.read is not None and self.read.is_current

    def agree(self, read: Head) -> None:
        """Record the imported files.  Raises Refused if one has changed since an earlier stage."""
        # Stages run at different times: a file that was edited between two of them would give equations of
        # one text and derivatives of another.
        before, now = dict((self.read or read).imports), dict(read.imports)
        changed = [path for path in {**before, **now} if before.get(path) != now.get(path)]
        if changed:
            message = f"`{changed[0]}` has changed since the model was compiled"
            raise Refused([Fault("LAG0705", message, remedy="compile the model again")])
        self.read = read

    @once
    def model(self) -> Model:
        found = resolve(parse(self.source), self.choice, self.roots)
        self.agree(Head(found.imports, found.built_in))
        self.look(found)
        return found

    @once
    def equations(self) -> EquationsOfMotion:
        return derive(self.model)

    @once
    def program(self) -> Program:
        """Return the program for a run, which also integrates the work of non-conservative forces."""
        differentiate, sensitive = (self.variant == name for name in DERIVED)
        stiff, expand = self.variant in IMPLICIT, self.variant in SERIES
        work = not (differentiate or sensitive)
        return optimize(self.equations, work, differentiate, sensitive, stiff, expand)

    @once
    def differentiated(self) -> Compilation:
        """Return the same choice with derivatives, for evaluations."""
        # A variant, not a part of the plain program: first and second derivatives can be several times as
        # large as the equations, and most runs need none.
        return _Variant(self, "derivatives")

    @once
    def sensitive(self) -> Compilation:
        """Return the same choice with what sensitivities of a run need."""
        return _Variant(self, "sensitivities")

    def taking(self, method: str) -> Compilation:
        """Return the same choice with code for this method of integration."""
        if method == DEFAULT_METHOD:
            return self
        with self.lock:
            return self.others.setdefault(method, _Variant(self, method))

    def artifact(self, target: str) -> Artifact:
        """Return the compiled model for `target`, from the cache, or compiled now and stored."""
        with self.lock:
            # One compilation for all threads; the others then find it in the cache.
            return self.cached_artifact(target) or self._compiled(target)

    def cached_artifact(self, target: str) -> Artifact | None:
        head = load_head(self._head_name)
        # Two steps: the head, found by the text alone, lists the imported files and the structural
        # parameters; with their contents and values it names the artifact. Thus no file is parsed if nothing
        # has changed.
        found = None if head is None else load_artifact(self._artifact_name(target, head))
        if head is not None and found is not None:
            self.agree(head)
        return found

    @once
    def _head_name(self) -> str:
        choice = self.choice
        inputs = [(name, _input_text(given)) for name, given in sorted(choice.inputs.items())]
        effects = choice.with_effects, choice.without_effects
        # All of a choice that changes the model. Values of parameters do not: they are bound at run time, and
        # only those that are structural enter the name of the artifact.
        chosen = repr((choice.model, choice.scene, *effects, inputs, choice.until, choice.outputs,
                       choice.contact_modes, choice.probes))  # fmt: skip
        texts = [self.source.text, *(text for _, text in inputs), choice.until or "", *choice.probes]
        # Without imports and tables the folder has no influence, and a copy of the file elsewhere shares the
        # cache.
        reads = any(word in text for word in ("import", "table") for text in texts)
        folder = folder_of(self.source.name) if reads else ""
        named = (self.source.name, folder, self.source.text, repr(self.roots), chosen)
        return cache.key(version_key(), *named)

    def _artifact_name(self, target: str, head: Head) -> str:
        values = [f"{name}={value!r}" for name, value in sorted(self.choice.parameters.items())
                  if name in head.structural]  # fmt: skip
        what = (target, self.variant) if self.variant else (target,)
        return cache.key(self._head_name, *what, *values, *(found or "" for _, found in head.imports))

    @uncollected
    def _compiled(self, target: str) -> Artifact:
        # The code contains the one method that the run uses; generated C for delivery has several.
        methods = () if self.variant in DERIVED else (self.variant or DEFAULT_METHOD,)
        program = replace(self.program, interface=replace(self.program.interface, methods=methods))
        sources = render(program, target, complete=False)
        artifact = Artifact(
            interface=program.interface,
            sources=sources,
            unused=unused(self.model, program.interface),
            code=_code(sources) if target == "numpy" else (),
        )
        # The head is stored first: an artifact without a head is never found, a head without an artifact is
        # only a miss.
        head = Head(self.model.imports, self.model.built_in)
        store_head(self._head_name, head)
        store_artifact(self._artifact_name(target, head), artifact)
        return artifact


class _Variant(Compilation):
    """A compilation with more functions that shares its equations with another one."""

    # The lock is that of the base: stages of both call each other, and two locks could be taken in either
    # order.
    def __init__(self, base: Compilation, variant: str):
        super().__init__(base.source, base.choice, base.roots)
        self.base, self.lock, self.variant = base, base.lock, variant

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.base, self.variant)

    def agree(self, read: Head) -> None:
        self.base.agree(read)

    @once
    def model(self) -> Model:
        found = self.base.model
        # Events change discrete variables during a run; in derivatives they are held constant. Taylor series
        # and derivatives of contacts are refused.
        if self.variant not in (*EXPLICIT, *IMPLICIT):
            refuse_contacts(found, self.variant)
        return with_fixed_discretes(found) if self._holds else found

    @once
    def equations(self) -> EquationsOfMotion:
        model = self.model
        return derive(model) if self._holds else self.base.equations

    @property
    def _holds(self) -> bool:
        """Whether discrete variables are inputs: a run by another method changes them."""
        return bool(self.base.model.discretes) and self.variant in DERIVED

    @once
    def program(self) -> Program:
        # Explicit methods use one program. Implicit ones need Jacobians, Taylor series their recurrences.
        return self.base.program if self.variant in EXPLICIT else super().program

    @once
    def differentiated(self) -> Compilation:
        return self.base.differentiated

    def taking(self, method: str) -> Compilation:
        return self.base.taking(method)


def _input_text(given: Source | Points) -> str:
    """Return the text that stands for an input in a cache key."""
    if isinstance(given, Source):
        return repr((folder_of(given.name), given.text))
    return repr([list(map(float, column)) for column in given[:2]]) + given[2]


def _code(sources: Mapping[str, str]) -> tuple[CodeType, ...]:
    from lagc.simulation.backends.python import compiled

    ((name, text),) = sources.items()
    return compiled(text, name)


def equations(source: Source, choice: Choice) -> EquationsOfMotion:
    """Return the equations of motion for display. Raises Refused if a given value is invalid for a run."""
    from lagc.lowering.interface import input_field
    from lagc.simulation.request import given_values

    compilation = Compilation(source, choice)
    # A value that a run would refuse is refused here too, though equations show only names.
    model, faults = compilation.model, list[Fault]()
    given_values(
        choice.parameters, (*map(input_field, model.inputs), *_unread_fields(model, frozenset())), faults
    )
    if faults:
        raise Refused(faults)
    return compilation.equations


def program(
    source: Source, choice: Choice, roots: tuple[str, ...] = (), differentiate: bool = False
) -> Program:
    """Return the program for generated code; the given values are its defaults."""
    return delivered(Compilation(source, choice, roots), Contents(derivatives=differentiate))


@dataclass(frozen=True)
class Contents:
    """Parts of generated code: methods of integration, derivatives (`directional`: those along directions),
    `events` for integrators of the caller, and the run that returns its error, `verified`."""

    methods: Sequence[str] = EXPLICIT
    derivatives: bool = False
    directional: bool = False
    events: bool = False
    verified: bool = False


EXPLICIT_METHODS = Contents()


def delivered(compilation: Compilation, contents: Contents = EXPLICIT_METHODS) -> Program:
    """Return the program of a compilation for generated code; the given values are its defaults."""
    from lagc.simulation.request import bound_parameters

    methods = contents.methods
    for method in methods:
        if method in SERIES:
            refuse_contacts(compilation.model, method)
    if contents.derivatives:
        refuse_contacts(compilation.model, "derivatives")
    # Methods need more than the rates: stiff ones the Jacobian, series the Taylor recurrences of each
    # operation.
    stiff, expand = (not set(kind).isdisjoint(methods) for kind in (IMPLICIT, SERIES))
    found = optimize(
        compilation.equations, False, contents.derivatives, stiff=stiff, expand=expand,
        directional=contents.directional,
    )  # fmt: skip
    interface = found.interface
    values = bound_parameters(
        interface, compilation.choice.parameters, unused(compilation.model, interface), demanding=False
    )
    # Values of the choice become the defaults of the generated code, in the order of the interface.
    fields = [replace(f, value=v) for f, v in zip((*interface.parameters, *interface.inputs), values)]
    n = len(interface.parameters)
    bound = replace(interface, parameters=tuple(fields[:n]), inputs=tuple(fields[n:]), methods=tuple(methods),
                    events=contents.events, verified=contents.verified)  # fmt: skip
    return replace(found, interface=bound)


def with_all_methods(compilation: Compilation) -> Program:
    """Return the program of a compilation with all methods that its equations admit."""
    if compilation.model.contacts:
        return delivered(compilation, Contents([m for m in METHODS if m not in SERIES]))
    # An operation without a recurrence (LAG0591) excludes Taylor series alone; other reasons are reported.
    try:
        return delivered(compilation, Contents(METHODS))
    except Refused as refused:
        if any(fault.code != "LAG0591" for fault in refused.faults):
            raise
        return delivered(compilation, Contents([m for m in METHODS if m not in SERIES]))


def unused(model: Model, interface: Interface) -> tuple[Field, ...]:
    """Return the parameters of the model that have no effect, and those that are part of the code."""
    return _unread_fields(model, {f.name for f in (*interface.parameters, *interface.inputs)})


def _unread_fields(model: Model, but: Container[str]) -> tuple[Field, ...]:
    """Return the parameters of the model, and those that are part of the code, except the names in `but`."""
    from lagc.lowering.interface import parameter_field

    fields = [parameter_field(p) for p in model.parameters if p.name not in but]
    listed = {p.name for p in model.parameters}
    structural = [n for n in model.built_in if n not in listed and n not in but]
    return (*fields, *(Field(n, None, -inf, inf, "", "", "", "") for n in structural))
