"""The changes and costs of the effects of a scene, for a compiled model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import process_time
from typing import TYPE_CHECKING, Any

from lagc.api.values import Parametrized, quantities, seconds
from lagc.base.records import replace
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import Compilation
from lagc.diagnostics.faults import Fault, Refused
from lagc.simulation.request import Request, bound_guesses, bound_parameters, bound_starts
from lagc.simulation.system import Options, rates_at

if TYPE_CHECKING:
    from lagc.lowering.program import Interface
    from lagc.simulation.works import Works
    from lagc.study.effects import Effects, Motion, Names, Variant

POINTS = 501  # recorded times
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
ALIKE = 4e-15  # difference of rates, over the largest of their unit on the motion, that is round-off


class Comparable(Parametrized):
    """A compiled model whose scene can be compared with scenes of fewer effects."""

    def effects(
        self,
        stop: float | None = None,
        *,
        accuracies: Sequence[float] = ACCURACIES, points: int = POINTS, of: Sequence[str] = (),
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None, guesses: Mapping[str, Any] | None = None,
        also: Mapping[str, Mapping[str, Any]] | None = None,
        progress: Callable[[float, str], None] = lambda part, doing: None,
    ) -> Effects:  # fmt: skip
        """Measure what each effect of the scene changes and costs, and find the cheapest scene for each
        accuracy.

        accuracies: the largest changes to find a scene for, relative to the range of each quantity.
        of: the coordinates and outputs to compare (default: all that every scene has).
        guesses: where to search for initial values, by name.
        also: other initial values, by a name for each, for which the recommended scenes are verified.

        `lagc.reports.effects` prints the result.  Raises Refused if an argument is invalid, if the scene has
        no effects, if there is no C compiler, or if the full scene does not run to `stop`.
        """
        from lagc.simulation.backends.compile import CannotCompile
        from lagc.study.effect_sets import study
        from lagc.study.effects import Comparison, Effects, Refusal

        # Faults of the arguments are reported before anything is compiled or run.
        model, interface = self._loaded.compilation.model, self._loaded.artifact.interface
        names = tuple([e.name for e in model.effects if e.used])
        offered = [e.name for e in model.effects if not e.used]
        if not names:
            remedy = f"the effects that it leaves out: {', '.join(offered)}"
            raise Refused([Fault("LAG0214", f"the scene `{model.scene}` uses no effect",
                                 remedy=remedy if offered else "the model declares none")])  # fmt: skip
        given = {**self._given, **quantities("parameters", parameters)}
        asked = quantities("starts", starts)
        bound_parameters(interface, given, self._loaded.artifact.unused)
        unknown = [name for name in of if name not in (*interface.q_names, *_outputs(interface))]
        if unknown:
            raise Refused([Fault("LAG0606", f"there is no coordinate or output `{unknown[0]}`")])
        guessed = quantities("guesses", guesses)
        begin = {name: {**asked, **quantities("also", own)} for name, own in (also or {}).items()}
        for own in (asked, *begin.values()):
            bound_guesses(interface, guessed, bound_starts(interface, own))
        # All runs are recorded at the same times, those of a run at the accuracy of the scene.
        request = Request(stop=seconds("stop", stop), points=points, starts=bound_starts(interface, asked))
        times = request.completed({**interface.simulate, "accuracy": 1e-6}).grid()
        scenes = _Scenes(self._loaded.compilation, given, guessed, times)
        # The full scene, then sets without effects; recommended sets are verified with other initial values.
        begun = Effects(model.scene, times[-1], names)
        elsewhere = {name: scenes.starting(own) for name, own in begin.items()}
        coarsest_first = sorted(accuracies, reverse=True)
        try:
            comparison = Comparison(scenes.starting(asked), begun, min(accuracies, default=1e-6), of)
            return study(comparison, scenes.closure, offered, coarsest_first, progress, elsewhere)
        except CannotCompile as error:
            raise Refused([Fault("LAG0701", f"effects cannot be measured: {error}")]) from None
        except Refusal as error:
            message = f"effects cannot be measured: the full scene does not run to {times[-1]:g} s: {error}"
            raise Refused([Fault("LAG0620", message, remedy="see `lagc sim` for the reason")]) from None


class _Scenes:
    """The scene of a compilation with other effects, each compiled once."""

    def __init__(self, compilation: Compilation, given: Mapping[str, Any], guesses: Mapping[str, Any],
                 times: Sequence[float]):  # fmt: skip
        self.compilation, self.given, self.guesses, self.times = compilation, given, guesses, times
        self.compiled: dict[tuple[Names, Names], Loaded | Refused] = {}

    def starting(self, starts: Mapping[str, Any]) -> Callable[[Names, Names], Variant | None]:
        """Return what makes a variant with these initial values, without some effects and with more; it
        returns None where the text has a fault then."""

        def make(without: Names, more: Names) -> Variant | None:
            if (without, more) not in self.compiled:
                self.compiled[without, more] = _compiled(self.compilation, without, more)
            found = self.compiled[without, more]
            if isinstance(found, Refused):
                return None
            return _Variant(found, self.given, starts, self.guesses, self.times)

        return make

    def closure(self, effects: Names) -> Names | None:
        """Return the effects with all that need them: those that are refused without them.  The refusal of a
        set names the effect whose declarations miss what was left out."""
        used = {e.name: e.span for e in self.compilation.model.effects if e.used}
        while True:
            found = _compiled(self.compilation, effects, frozenset())
            if not isinstance(found, Refused):
                return effects
            more = {
                name for fault in found.faults for name, span in used.items()
                if fault.span is not None and fault.span.source is span.source
                and span.start <= fault.span.start <= span.end
            }  # fmt: skip
            if more <= effects:
                return None
            effects |= more


def without(
    loaded: Loaded, given: Mapping[str, Any], effects: Sequence[str]
) -> tuple[Loaded, dict[str, Any]]:
    """Return the scene without these effects, and the given values of parameters that it has.  Raises
    Refused."""
    found = _compiled(loaded.compilation, frozenset(effects), frozenset(), loaded.asked)
    if isinstance(found, Refused):
        raise found
    artifact = found.artifact
    fields = (*artifact.interface.parameters, *artifact.interface.inputs, *artifact.unused)
    known = {f.name for f in fields}
    return found, {name: value for name, value in given.items() if name in known}


def _compiled(compilation: Compilation, without: Names, more: Names, backend: str = "c") -> Loaded | Refused:
    """Return the scene with other effects; a fault of the text, if it has one then."""
    choice = compilation.choice
    kept = tuple([name for name in choice.with_effects if name not in without])
    added = tuple(sorted(more))
    chosen = replace(choice, with_effects=(*kept, *added), parameters=dict(choice.parameters),
                     without_effects=(*choice.without_effects, *sorted(without)))  # fmt: skip
    try:
        return Loaded(Compilation(compilation.source, chosen, compilation.roots), backend)
    except Refused as refused:
        return refused


def _event_names(interface: Interface) -> list[str]:
    """Return the names of all events that a run may have."""
    from lagc.simulation.simulate import KINDS

    contacts = [c.name for c in interface.contacts]
    return [
        *interface.relations, *(name for clause in interface.whens for name in clause.names),
        *(f"{name}: impact" for name in contacts),
        *(f"{name} {kind}" for name in contacts for kind in KINDS.values()),
    ]  # fmt: skip


def _outputs(interface: Any) -> list[str]:
    return [x.name for x in interface.outputs]


class _Variant:
    """See `lagc.study.effects.Variant`."""

    def __init__(self, loaded: Loaded, given: Mapping[str, Any], starts: Mapping[str, Any],
                 guesses: Mapping[str, Any], times: Sequence[float]):  # fmt: skip
        interface = loaded.artifact.interface
        known = {f.name for f in (*interface.parameters, *interface.inputs, *loaded.artifact.unused)}
        own = {name: value for name, value in given.items() if name in known}
        self.loaded, self.times = loaded, times
        self.values = bound_parameters(interface, own, loaded.artifact.unused)
        states = set(interface.state_names)
        self.starts = bound_starts(interface, {n: v for n, v in starts.items() if n in states})
        inner = {n: v for n, v in guesses.items() if n in states}
        self.guesses = bound_guesses(interface, inner, self.starts)
        self.names = (*interface.q_names, *_outputs(interface))
        self.units = dict(zip(interface.state_names, interface.state_units))
        self.units.update({x.name: x.unit for x in interface.outputs})
        self.parameters = tuple([f.name for f in interface.parameters])
        self.operations, self.states = interface.operations, interface.nq + interface.nv
        self.state_names, self.coordinates = interface.state_names, interface.nq
        self.motions: dict[tuple[float, tuple[str, float] | None], Motion] = {}

    def motion(self, accuracy: float, scaled: tuple[str, float] | None = None) -> Motion:
        if (accuracy, scaled) not in self.motions:
            self.motions[accuracy, scaled] = self._motion(accuracy, scaled)
        return self.motions[accuracy, scaled]

    def _motion(self, accuracy: float, scaled: tuple[str, float] | None) -> Motion:
        import numpy as np

        from lagc.study.effects import Motion

        values = list(self.values)
        if scaled is not None:
            values[self.parameters.index(scaled[0])] *= scaled[1]
        request = Request(stop=self.times[-1], accuracy=accuracy, points=len(self.times), starts=self.starts,
                          guesses=self.guesses)  # fmt: skip
        try:
            run = self.loaded.simulate(request, values)
        except Refused as refused:
            return Motion(np.array([]), {}, [], {}, (), "", 0.0, refused.faults[0].message)
        if run.interrupted:
            raise KeyboardInterrupt
        found = {name: np.array(run.column(name)) for name in self.names}
        # A run that fails has three kinds: it ends early; it is not predictable beyond its last time; or it
        # is whole and less exact than asked, as its error bars tell.
        failed = run.status == "failed"
        cut = run.cut and len(run.times) > 1
        inexact = failed and len(run.times) == len(self.times) and bool(run.errors)
        ends = run.message if failed and not cut and not inexact else ""
        events = tuple([(event.t, event.name) for event in run.events])
        errors = run.errors
        if cut:  # its errors are those beyond the horizon
            units = [self.units.get(name, "") for name in found]
            sizes = dict.fromkeys(units, 0.0)
            for unit, column in zip(units, found.values()):
                sizes[unit] = max(sizes[unit], float(np.abs(column).max()))
            errors = {name: accuracy * sizes[unit] for name, unit in zip(found, units)}
        return Motion(np.array(run.times), found, run.states, errors, events, run.method, run.rtol,
                      ends, cut, frozenset(_event_names(self.loaded.artifact.interface)))  # fmt: skip

    def plain(self, setting: Motion, repeats: int) -> tuple[float, int]:
        """Return the CPU time and the evaluations of a run without verification, recorded at its end
        alone."""
        system = self.loaded.system("c").bind(self.values)
        if not hasattr(self, "x0"):
            self.x0 = self.loaded.initialize(system, Request(stop=self.times[-1], starts=self.starts,
                                                                  guesses=self.guesses)).x  # fmt: skip
        options = Options(method=setting.method, rtol=setting.rtol, max_steps=0)
        ends = [self.times[0], self.times[-1]]
        began = process_time()
        for _ in range(repeats):
            done = system.integrate(options, ends[0], self.x0, ends)
        return (process_time() - began) / repeats, done.rhs

    def works(self, motion: Motion) -> tuple[Works | None, dict[str, float]]:
        from lagc.simulation.works import works

        equations, system = self.loaded.compilation.equations, self.loaded.system("c").bind(self.values)
        pointwise = self.loaded.system("numpy").bind(self.values) if equations.contacts else None
        x, stop = list(motion.states[0]), float(motion.times[-1])
        found = works(equations, system, x, stop, motion.method, pointwise)
        if found is None:
            return None, {}
        # Works of actions, constraints and clauses by the effect that brought each; those of contacts
        # together have an owner if all are of one effect.
        given = [(c.effect, found.actions[c.name]) for c in equations.contributions]
        labels = {row.label: row.effect for row in equations.rows}
        given += [(labels[label], work) for label, work in found.rows.items()]
        given += [(equations.whens[k].clause.effect, work) for k, work in found.clauses.items()]
        owners = {row.contact.effect for row in equations.contacts}
        if len(owners) == 1 and found.of_contacts:
            given.append((owners.pop(), found.rest))
        sums: dict[str, float] = {}
        for effect, work in given:
            if effect is not None:
                sums[effect] = sums.get(effect, 0.0) + work
        return found, sums

    def nearest(self, motion: Motion, other: Variant) -> tuple[tuple[str, float], ...]:
        assert isinstance(other, _Variant)
        interface, others = self.loaded.artifact.interface, other.loaded.artifact.interface.relations
        own = {k: name for k, name in enumerate(interface.relations) if name not in others}
        if not own:
            return ()
        system: Any = self.loaded.system("numpy").bind(self.values)
        along = [system.indicators(t, list(x)) for t, x in zip(motion.times.tolist(), motion.states)]
        return tuple([(name, min(abs(values[k]) for values in along)) for k, name in own.items()])

    def same_along(self, motion: Motion, other: Variant, without: str = "") -> bool:
        assert isinstance(other, _Variant)
        if self.state_names != other.state_names:
            return False
        values = list(self.values)
        if without:
            values[self.parameters.index(without)] = 0.0
        mine, own = self.loaded.system("c").bind(values), other.loaded.system("c").bind(other.values)
        n = len(self.state_names)
        pairs = [
            (rates_at(mine, t, x), rates_at(own, t, [*x[:n], *own.start()[n:]]))
            for t, x in zip(motion.times.tolist(), motion.states)
        ]
        known = [(first[:n], second[:n]) for first, second in pairs if first and second]
        sizes: dict[tuple[bool, str], float] = {}  # of rates, of coordinates and speeds of each unit
        kinds = [(i < self.coordinates, self.units[name]) for i, name in enumerate(self.state_names)]
        for _, rates in known:
            for kind, rate in zip(kinds, rates):
                sizes[kind] = max(sizes.get(kind, 0.0), abs(rate))
        return all(
            abs(a - b) <= ALIKE * sizes[kind]
            for first, second in known
            for kind, a, b in zip(kinds, first, second)
        )
