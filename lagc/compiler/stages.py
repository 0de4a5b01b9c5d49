"""The stages of the compiler: from a text to a model, its equations, a program and code.

    parse -> resolve -> derive -> optimize -> render

Each stage takes the result of the one before, and is imported when it is needed.
"""

from __future__ import annotations

import gc
from collections.abc import Mapping, Sequence
from contextlib import ContextDecorator
from typing import TYPE_CHECKING

from lagc.base.records import RLock, dataclass, field, replace
from lagc.base.text import Given, Quantity
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host.budgets import stage

if TYPE_CHECKING:
    from lagc.lowering.program import Program
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.semantics.model import Model
    from lagc.semantics.scenes import Inputs
    from lagc.syntax.tree import Tree

PER_CHARACTER = 1e-3  # s of additional time limit of a stage for each character of the model
PER_PAIR = 0.05  # s for each pair of coordinates or constraints
PER_OPERATION = 1e-3  # s for each operation of the right-hand side


@dataclass(frozen=True)
class Choice:
    """A model of a file, with its scene, effects and values. Values of structural parameters become part of
    the code, as do `inputs` that are not numbers, the condition `until` that ends a run, and `outputs`, the
    names of what it is for (None: all).  Other parameters stay symbols.  `contact_modes`: those in which
    contacts are held as equations and loads (None: they act). `probes` are expressions that become
    outputs."""

    model: str | None = None
    scene: str | None = None
    with_effects: tuple[str, ...] = ()
    without_effects: tuple[str, ...] = ()
    parameters: Given = field(default_factory=dict)
    inputs: Inputs = field(default_factory=dict)
    until: str | None = None
    outputs: tuple[str, ...] | None = None
    contact_modes: tuple[int, ...] | None = None
    probes: tuple[str, ...] = ()


class _Uncollected(ContextDecorator):
    """A block without garbage collection, because stages create many objects that all stay. Collection is one
    switch for all threads: the first thread that enters turns it off, and the last one that leaves restores
    it."""

    def __init__(self) -> None:
        self.lock = RLock()
        self.inside = 0
        self.was_on = False

    def __enter__(self) -> None:
        with self.lock:
            if self.inside == 0:
                self.was_on = gc.isenabled()
                gc.disable()
            self.inside += 1

    def __exit__(self, *_: object) -> None:
        with self.lock:
            self.inside -= 1
            if self.inside == 0 and self.was_on:
                gc.enable()


uncollected = _Uncollected()


@uncollected
def parse(source: Source) -> Tree:
    from lagc.syntax.parse import parse as run

    with stage("reading the model", PER_CHARACTER * len(source.text)):
        return run(source)


@uncollected
def resolve(tree: Tree, choice: Choice, roots: tuple[str, ...] = ()) -> Model:
    """Return the model that `choice` selects. Of `choice.parameters`, it contains only the values of
    structural ones; the others are given to each run."""
    from lagc.semantics.resolve import resolve as run

    def resolved(values: Mapping[str, float]) -> Model:
        return run(
            tree,
            scene=choice.scene,
            with_effects=choice.with_effects,
            without_effects=choice.without_effects,
            model=choice.model,
            parameters=dict(values),
            inputs=choice.inputs,
            until=choice.until,
            roots=roots,
            probes=choice.probes,
        )

    # Values of structural parameters are part of the model, all others are given to each run. Which ones are
    # structural is known only after the model is resolved, so it is resolved again until that does not
    # change.
    given = {name: _in_si(name, value) for name, value in choice.parameters.items()}
    with stage("finding what its names mean", PER_CHARACTER * len(tree.source.text)):
        values: dict[str, float] = {}
        try:
            model = resolved(values)
        except Refused:
            if not given:
                raise
            model = resolved(given)  # a structural parameter has no value in the model
            values = given
        # A parameter counts as built in if it is so without the given values.
        built_in = dict.fromkeys(model.built_in)
        while (wanted := {name: given[name] for name in given if name in built_in}) != values:
            values, model = wanted, resolved(wanted)
            built_in.update(dict.fromkeys(model.built_in))
        model = replace(model, built_in=tuple(built_in))
        if choice.contact_modes is not None:
            from lagc.mechanics.formulation.contacts import hold_contacts

            model = hold_contacts(model, choice.contact_modes)
        if choice.outputs is None:
            return model
        from lagc.semantics.requests import PROBE, asked_for

        return asked_for(model, (*choice.outputs, *(o.name for o in model.outputs if PROBE in o.name)))


def _in_si(name: str, given: float | Quantity) -> float:
    """Return the number in SI units; its dimension is checked where the parameter's unit is known."""
    if not isinstance(given, Quantity):
        return float(given)
    if given.unit is None:
        return given.value
    from lagc.semantics.units import UnknownUnit, unit
    from lagc.semantics.values.unit_hints import spelling_remedy

    try:
        return unit(given.unit).to_si(given.value)
    except UnknownUnit as error:
        fault = Fault("LAG0605", f"`{name}`: {error.reason}", remedy=spelling_remedy(error.text))
        raise Refused([fault]) from None


@uncollected
def derive(model: Model) -> EquationsOfMotion:
    from lagc.mechanics.derive import derive as run

    unknowns = len(model.coordinates) + len(model.constraints)
    with stage("deriving the equations", PER_PAIR * unknowns**2):
        return run(model)


@uncollected
def optimize(
    equations: EquationsOfMotion, work: bool, differentiate: bool = False, sensitive: bool = False,
    stiff: bool = False, expand: bool = False, directional: bool = False,
) -> Program:  # fmt: skip
    from lagc.lowering.lower_equations import optimize as run

    unknowns = len(equations.v) + len(equations.rows)
    with stage("simplifying the equations", PER_PAIR * unknowns**2):
        return run(equations, work, differentiate, sensitive, stiff, expand, directional)


@uncollected
def render(
    program: Program, target: str, complete: bool = True, real: str = "double", only: Sequence[str] = ()
) -> dict[str, str]:
    """Return the generated files as {name: text}.  `complete`: usable without lagc.  `only`: in C, the
    functions that there are.  `target`: "c", "numpy", or "functions", which is C that does not integrate."""
    with stage("writing the code", PER_OPERATION * program.interface.operations):
        if target in ("c", "functions"):
            from lagc.codegen.c.emit import render as render_c
            from lagc.codegen.c.runtime import EVALUATED
            from lagc.codegen.kernel_compiler.real_types import TYPES

            return render_c(program, complete, TYPES[real], EVALUATED if target == "functions" else only)
        from lagc.codegen.python.emit import render as render_numpy

        return render_numpy(program, complete)
