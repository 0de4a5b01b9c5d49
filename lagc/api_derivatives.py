"""What of a compiled model takes derivatives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import index
from typing import TYPE_CHECKING, Any

from lagc.api_values import real, reals
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import PER_OPERATION
from lagc.host.budgets import Exhausted, reached

if TYPE_CHECKING:
    from lagc.lowering.program import Interface
    from lagc.simulation.backends.python import NumpySystem
    from lagc.simulation.linearization.derivatives import Array, Point
    from lagc.simulation.linearization.linearize import Linear
    from lagc.simulation.solution import Solution

ACCURACY, COARSELY = 1e-9, 1e-4  # of a motion that is followed to where it is linearised; of one with a note
MOST_TRIES = 1_000_000  # random postures: more find no more
ALONG = {"rates": "rate", "qdot": "qdot", "accelerations": "acceleration", "multipliers": "multiplier",
         "outputs": "output"}  # fmt: skip
HELD = {"inertia": "inertia", "forces": "force", "rows": "row", "conditions": "condition", "start": "start",
        "indicators": "indicator"}  # fmt: skip


class Differentiable:
    """A compiled model that can be differentiated; what it takes is compiled when it is first asked for."""

    _loaded: Loaded
    simulate: Callable[..., Solution]

    @property
    def interface(self) -> Interface:
        raise NotImplementedError

    def _bound(self, parameters: Mapping[str, Any] | None, demanding: bool = True) -> list[float]:
        raise NotImplementedError

    def differentiated(self, parameters: Mapping[str, Any] | None = None) -> NumpySystem:
        """The system with derivatives, bound to the parameters of this model, and to those given."""
        return self._loaded.differentiated.model.bind(self._bound(parameters))

    def jacobian(
        self,
        of: str,
        wrt: str | Sequence[str],
        t: float = 0.0,
        x: Sequence[float] | None = None,
        *,
        a: Sequence[float] | None = None,
        lam: Sequence[float] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> Array:
        """The exact derivatives of `of` by `wrt` at (t, x), x = (q, v), as a matrix, SI.

        `of`: "rates" (qdot, a), "qdot", "accelerations", "multipliers", "outputs", where a and lam follow
        from the equations; "inertia" (M a), "forces" (tau - h + G^T lam), "rows" (G a - gamma), with `a` and
        `lam` as they are given (else those of the motion); "conditions" of a start (phi, psi, the initial
        section, stated rates); "start" (values of q, v, stated rates); "indicators" of zero crossings.
        `wrt`: "time", "coordinates", "speeds", "state" (both), "parameters", "inputs", the name of one of
        them, where a and lam are given also "accelerations", "multipliers"; or a sequence of such words.
        Without x at the start values as they are written.  Where forces bend there it is that of the side on
        which what they depend on is larger, with a RuntimeWarning.  Raises KeyError for another word,
        ValueError where x, a or lam has another length, ArithmeticError where there is no finite value, or a
        jump.
        """
        import numpy

        from lagc.simulation.linearization.derivatives import Point

        system = self.differentiated(parameters)
        state = _entries("x", system.start() if x is None else x, system.nx)
        a = None if a is None else _entries("a", a, system.nv)
        lam = None if lam is None else _entries("lam", lam, system.nc)
        if of not in ALONG and of not in HELD:
            raise KeyError(f"{of!r} is none of {', '.join((*ALONG, *HELD))}")
        words = [wrt] if isinstance(wrt, str) else list(wrt)
        with numpy.errstate(all="ignore"):  # what is not finite is refused
            point = Point(system, real("t", t), state, a, lam)
            found = numpy.hstack([self._columns(point, of, word) for word in words])
            if system.interface.switches:
                found = self._on_one_side(point, of, words, found)
        if not numpy.isfinite(found).all():
            raise ArithmeticError(f"the derivatives of {of} have no finite value there")
        return found

    def _on_one_side(self, point: Point, of: str, words: Sequence[str], found: Array) -> Array:
        """The derivatives at a state at which conditions change; says so where they are others beyond."""
        import warnings

        import numpy

        from lagc.simulation.linearization.derivatives import Point
        from lagc.simulation.linearization.linearize import size_of_states
        from lagc.simulation.linearization.nonsmooth_points import branches, differing, jumps

        system, sizes = point.system, size_of_states(point.system)
        own, others = branches(point, sizes)
        if own is None:
            return found

        def on(modes: Sequence[float]) -> tuple[Array, Array]:
            there = Point(system, point.t, point.x, point.a, point.lam, modes=modes)
            values = there.value(HELD[of]) if of in HELD else numpy.zeros(0)
            return numpy.hstack([self._columns(there, of, word) for word in words]), values

        found, values = on(own)
        for switch, modes in others:
            there, beyond = on(modes)
            if jumps(point, own, modes, sizes) if of in ALONG else differing(values, beyond):
                raise ArithmeticError(f"forces jump there, where {switch}: {of} have no derivatives")
            for i, j in differing(found, there)[:1]:
                message = f"forces bend there, where {switch}: entry [{i}, {j}] is {found[i, j]:.6g}, and "
                message += f"{there[i, j]:.6g} on the other side"
                warnings.warn(message, RuntimeWarning, stacklevel=3)
        return found

    def linearize(
        self,
        t: float = 0.0,
        x: Sequence[float] | None = None,
        *,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Linear:
        """The linear model about x = (q, v), which meets the constraints, or about the motion from the start
        at time t (s), of which `progress` is told as in a run.  Raises Refused where there is no start or
        no such time, ValueError where x has another length, ArithmeticError where the motion does not get
        to t or there are no finite derivatives."""
        from lagc.base.records import replace
        from lagc.diagnostics.faults import Fault, Refused
        from lagc.simulation.linearization.linearize import linearize

        t = real("t", t)
        if not 0.0 <= t < float("inf"):
            fault = f"the time about which a motion is linearised is finite and not before its start: {t:g} s"
            raise Refused([Fault("LAG0604", fault)])
        notes = tuple[str, ...]()
        if x is None:
            x, notes = self._at(t, parameters, starts, progress)
        system = self.differentiated(parameters)
        found = linearize(system, t, _entries("x", x, system.nx))
        return replace(found, notes=(*notes, *found.notes)) if notes else found

    def equilibria(
        self,
        *,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        tries: int | None = None,
        seed: int = 0,
    ) -> list[Linear]:
        """The linear models about the equilibria at t = 0 that are found from the start and from so many
        random postures: the first is that which is found from the start, if one is, the others are in order
        of their potential energy; of families of equilibria one each.  Some may have no linear model, or
        be no rest as rows are solved, which a note of the first says; raises ArithmeticError where none has
        a linear model."""
        from lagc.base.records import replace
        from lagc.host.budgets import stage
        from lagc.simulation.linearization import equilibria
        from lagc.simulation.linearization.linearize import linearize

        if tries is not None and not 0 <= index(tries) <= MOST_TRIES:
            raise ValueError(f"`tries` is from 0 to {MOST_TRIES:,}")
        system = self.differentiated(parameters)
        guess, _ = self._at(0.0, parameters, starts)
        most = equilibria.tries_for(system) if tries is None else tries
        with stage("looking for equilibria", PER_OPERATION * self.interface.operations):
            found = equilibria.equilibria(system, guess, 0.0, most, seed)
            linear: list[Linear] = []
            reasons: list[str] = []
            for e in found:
                try:
                    linear.append(replace(linearize(system, 0.0, e.x), free=e.free))
                except ArithmeticError as error:
                    reasons.append(str(error))
        if reasons and not linear:
            raise ArithmeticError(reasons[0])
        notes = [f"{len(reasons)} of {len(found)} found have no linear model: {r}" for r in reasons[:1]]
        still = [one for one in linear if one.still] or linear  # else all change with time
        if len(still) < len(linear):
            left_out = f"{len(linear) - len(still)} of {len(found)} found are left out"
            notes.append(f"{left_out}: forces balance there, but rows determine no rest")
        return [replace(still[0], notes=(*still[0].notes, *notes)), *still[1:]] if notes else still

    def _at(
        self,
        t: float,
        parameters: Mapping[str, Any] | None,
        starts: Mapping[str, Any] | None,
        progress: Callable[[float], None] | None = None,
    ) -> tuple[list[float], tuple[str, ...]]:
        """The state there; and what is to be said of it."""
        run = self.simulate(
            t, accuracy=ACCURACY, points=2, parameters=parameters, starts=starts, progress=progress
        )
        notes = tuple[str, ...]()
        if run.interrupted:  # of half a motion nothing follows
            raise Exhausted if reached() else KeyboardInterrupt
        if run.status == "failed":
            known = run.estimated or 0.0
            if not ACCURACY < known <= COARSELY or run.times[-1] != t:  # the motion is wrong, or not known
                raise ArithmeticError(run.message)
            told = f"the state at t = {t:g} s is known to {known:.1g} of the largest on the way"
            notes = (f"{told}: {run.message}",)
        if run.times[-1] < t:
            raise ArithmeticError(f"the motion does not come to t = {t:g} s: {run.message}")
        return run.states[-1][: self.interface.nq + self.interface.nv], notes

    def _columns(self, point: Point, of: str, word: str) -> Array:
        group, columns = self._places(word, held=of in HELD)
        table = point.partial(HELD[of], group) if of in HELD else point.total(ALONG[of], group)
        return table[:, columns]

    def _places(self, word: str, held: bool) -> tuple[str, slice]:
        """The group that has the columns of a word, and which they are."""
        interface = self.interface
        nq, nv, n = interface.nq, interface.nv, len(interface.parameters)
        groups = {
            "time": ("time", slice(None)), "state": ("state", slice(None)),
            "coordinates": ("state", slice(nq)), "speeds": ("state", slice(nq, None)),
            "parameters": ("parameter", slice(n)), "inputs": ("parameter", slice(n, None)),
        }  # fmt: skip
        if held:
            groups["accelerations"] = "acceleration", slice(nv)
            groups["multipliers"] = "acceleration", slice(nv, None)
        if word in groups:
            return groups[word]
        given = [f.name for f in (*interface.parameters, *interface.inputs)]
        for group, names in (("state", interface.state_names), ("parameter", given)):
            if word in names:
                k = names.index(word)
                return group, slice(k, k + 1)
        raise KeyError(
            f"{word!r} is no coordinate, speed, parameter or input, nor one of {', '.join(groups)}"
        )


def _entries(name: str, values: Sequence[float], wanted: int) -> list[float]:
    found = reals(name, values)
    if len(found) != wanted:
        raise ValueError(f"{name} has {len(found)} entries, not {wanted}")
    return found
