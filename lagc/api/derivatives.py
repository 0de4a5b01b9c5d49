"""Derivatives of a compiled model: Jacobians, linear models and equilibria."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from operator import index
from typing import TYPE_CHECKING, Any

from lagc.api.values import Parametrized, real, reals
from lagc.compiler.stages import PER_OPERATION
from lagc.host.budgets import Exhausted, reached

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem
    from lagc.simulation.linearization.derivatives import Array, Point
    from lagc.simulation.linearization.linear_model import Linear
    from lagc.simulation.solution import Solution

ACCURACY, COARSELY = 1e-9, 1e-4  # of the motion to a point of linearization; up to the second with a note
MOST_TRIES = 1_000_000  # random initial states for equilibria
ALONG = {"rates": "rate", "qdot": "qdot", "accelerations": "acceleration", "multipliers": "multiplier",
         "outputs": "output"}  # fmt: skip
FIXED = {"inertia": "inertia", "forces": "force", "rows": "row", "conditions": "condition", "start": "start",
        "indicators": "indicator"}  # fmt: skip


class Differentiable(Parametrized):
    """A compiled model with derivatives, whose code is compiled when it is first needed."""

    simulate: Callable[..., Solution]

    def differentiated(
        self, parameters: Mapping[str, Any] | None = None, x: Sequence[float] | None = None
    ) -> NumpySystem:
        """Return the system with derivatives and the parameters of this model, replaced by those given.
        Discrete variables are inputs that are held at their values in the whole state `x` (None: at their
        starts). Contacts are held in their modes in `x`, as equations and loads."""
        values, own = self._bound(parameters), self.interface
        if own.contacts and x is not None:
            from lagc.simulation.linearization.contact_modes import modes_of

            model = self._loaded.in_contact_modes(modes_of(own, x)).model
        else:
            model = self._loaded.differentiated.model
        if own.discretes:
            whole = self._acting(parameters).start() if x is None else x
            fields, held = (*own.parameters, *own.inputs), whole[own.nx - len(own.discretes) :]
            known = {f.name: value for f, value in zip((*fields, *own.discretes), (*values, *held))}
            values = [known[f.name] for f in (*model.interface.parameters, *model.interface.inputs)]
        return model.bind(values)

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
        """Return the exact derivatives of `of` by `wrt` at (t, x), x = (q, v), as a matrix in SI units.

        `of` is one of: "rates" (qdot, a), "qdot", "accelerations", "multipliers", "outputs", with a and lam
        from the equations of motion; "inertia" (M a), "forces" (tau - h + G^T lam), "rows" (G a - gamma),
        with `a` and `lam` as given or else those of the motion; "conditions", the initial equations (phi,
        psi, the initial section, stated rates); "start", the initial values of q, v and stated rates;
        "indicators", those of zero crossings.

        `wrt` is "time", "coordinates", "speeds", "state" (both), "parameters", "inputs", the name of one of
        them, or a sequence of these; with a and lam fixed also "accelerations" and "multipliers".

        Without x, the state has the initial values as written.  If forces have a kink there, the derivative
        is the one on the side of larger indicators, with a RuntimeWarning.  Raises KeyError for an unknown
        word, ValueError if x, a or lam has a wrong length, ArithmeticError if a value is not finite or the
        forces jump.
        """
        import numpy

        from lagc.simulation.linearization.derivatives import Point

        # The matrices are straight-line code of the differentiated model. The state is the initial one as
        # written unless x is given.
        system = self.differentiated(parameters)
        state = reals("x", system.start() if x is None else x, system.nx, system.interface.state_names)
        a = None if a is None else reals("a", a, system.nv)
        lam = None if lam is None else reals("lam", lam, system.nc)
        if of not in ALONG and of not in FIXED:
            raise KeyError(f"{of!r} is none of {', '.join((*ALONG, *FIXED))}")
        words = [wrt] if isinstance(wrt, str) else list(wrt)
        # Columns for each word of `wrt`, side by side. At a kink of forces the derivative of one side is
        # taken.
        with numpy.errstate(all="ignore"):  # values that are not finite are refused
            point = Point(system, real("t", t), state, a, lam)
            found = numpy.hstack([self._columns(point, of, word) for word in words])
            if system.interface.relations:
                found = self._on_one_side(point, of, words, found)
        if not numpy.isfinite(found).all():
            raise ArithmeticError(f"the derivatives of {of} have no finite value there")
        return found

    def _on_one_side(self, point: Point, of: str, words: Sequence[str], found: Array) -> Array:
        """Return the derivatives at a state where modes change; warns if they differ on the other side."""
        import warnings

        import numpy

        from lagc.simulation.linearization.derivatives import Point, branches, differing, jumps
        from lagc.simulation.linearization.linear_model import size_of_states

        system, sizes = point.system, size_of_states(point.system)
        own, others = branches(point, sizes)
        if own is None:
            return found

        def on(modes: Sequence[float]) -> tuple[Array, Array]:
            there = Point(system, point.t, point.x, point.a, point.lam, modes=modes)
            values = there.value(FIXED[of]) if of in FIXED else numpy.zeros(0)
            return numpy.hstack([self._columns(there, of, word) for word in words]), values

        # A jump of the value itself leaves no derivative; a jump of the slope leaves two, one for each
        # side.
        found, values = on(own)
        for relation, modes in others:
            there, beyond = on(modes)
            if jumps(point, own, modes, sizes) if of in ALONG else differing(values, beyond):
                raise ArithmeticError(
                    f"forces are discontinuous there, where {relation}: {of} have no derivatives"
                )
            for i, j in differing(found, there)[:1]:
                message = (
                    f"forces have a kink there, where {relation}: entry [{i}, {j}] is {found[i, j]:.6g}, and "
                )
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
        """Return the linear model about x = (q, v), which must satisfy the constraints, or about the motion
        at the time t (s). It belongs to the modes of contacts there.

        `progress` is called as in a run.  Raises Refused if there is no initial state or t is invalid,
        ValueError if x has a wrong length, ArithmeticError if the motion does not reach t or derivatives
        are not finite.
        """
        from lagc.base.records import replace
        from lagc.diagnostics.faults import Fault, Refused
        from lagc.simulation.linearization.linear_model import linearize

        t = real("t", t)
        if not 0.0 <= t < float("inf"):
            fault = f"the time of a linear model must be finite and not negative: {t:g} s"
            raise Refused([Fault("LAG0604", fault)])
        notes, n = tuple[str, ...](), self.interface.nq + self.interface.nv
        if x is None:
            whole, notes = self._at(t, parameters, starts, progress)
        else:
            whole = self._whole_state(t, reals("x", x, n, self.interface.state_names), parameters)
        found = linearize(self.differentiated(parameters, whole), t, whole[:n])
        if self.interface.contacts:
            from lagc.simulation.linearization.contact_modes import in_mode

            found = in_mode(self._acting(parameters), found, whole)
        return replace(found, notes=(*notes, *found.notes)) if notes else found

    def _acting(self, parameters: Mapping[str, Any] | None) -> NumpySystem:
        """Return the system without derivatives."""
        from lagc.simulation.backends.python import NumpySystem

        found = self._loaded.system("numpy").bind(self._bound(parameters))
        assert isinstance(found, NumpySystem)
        return found

    def _whole_state(self, t: float, x: Sequence[float], parameters: Mapping[str, Any] | None) -> list[float]:
        """Return the whole state of x = (q, v): discrete variables have their starts, contacts are in their
        modes there."""
        if not self.interface.discretes:
            return list(x)
        system = self._acting(parameters)
        whole = [*x, *system.start()[len(x) :]]
        if self.interface.contacts:
            from lagc.simulation.linearization.contact_modes import settled

            return settled(system, t, whole)
        return whole

    def equilibria(
        self,
        *,
        parameters: Mapping[str, Any] | None = None,
        starts: Mapping[str, Any] | None = None,
        tries: int | None = None,
        seed: int = 0,
    ) -> list[Linear]:
        """Return the linear models about the equilibria at t = 0 that are found.

        The search starts from the initial state and from `tries` random states.  The first result is the
        equilibrium found from the initial state, if any; the others are ordered by potential energy.  A
        family of equilibria gives one result.  A note of the first one tells if some have no linear model,
        or are no rest because the constraints do not determine one.  Raises ArithmeticError if none has a
        linear model.
        """
        from lagc.base.records import replace
        from lagc.host.budgets import stage
        from lagc.simulation.linearization import equilibria
        from lagc.simulation.linearization.contact_modes import Elsewhere, in_mode
        from lagc.simulation.linearization.linear_model import linearize

        # The guess of the search is the initial state with all stated values.
        if tries is not None and not 0 <= index(tries) <= MOST_TRIES:
            raise ValueError(f"`tries` must be from 0 to {MOST_TRIES:,}")
        guess, _ = self._at(0.0, parameters, starts, search=True)
        found: list[tuple[float, Linear]] = []
        reasons: list[str] = []
        # In each system (a model with contacts has one for each choice of modes) the search begins at the
        # guess, then at random states.
        for system, whole, share in self._at_rest(guess, parameters):
            most = equilibria.tries_for(system, share) if tries is None else tries
            with stage("looking for equilibria", PER_OPERATION * self.interface.operations):
                for e in equilibria.equilibria(system, whole[: system.nx], 0.0, most, seed):
                    try:
                        # A contact mode is accepted if its forces keep it; else the equilibrium belongs to
                        # another mode.
                        one = replace(linearize(system, 0.0, e.x), free=e.free)
                        if self.interface.contacts:
                            one = in_mode(self._acting(parameters), one, [*e.x, *whole[len(e.x) :]])
                        found.append((e.energy, one))
                    except Elsewhere:
                        continue
                    except ArithmeticError as error:
                        reasons.append(str(error))
        # The equilibrium of the initial state stays first; those by chance are ordered by energy.
        linear = [one for _, one in (*found[:1], *sorted(found[1:], key=lambda pair: pair[0]))]
        if reasons and not linear:
            raise ArithmeticError(reasons[0])
        many = len(found) + len(reasons)
        notes = [f"{len(reasons)} of {many} found have no linear model: {r}" for r in reasons[:1]]
        # Points at which forces balance but constraints leave the configuration open are no rest.
        rests = [one for one in linear if one.equilibrium] or linear  # or else all change with time
        if len(rests) < len(linear):
            left_out = f"{len(linear) - len(rests)} of {many} found are left out"
            notes.append(f"{left_out}: forces balance there, but the constraints determine no rest")
        return [replace(rests[0], notes=(*rests[0].notes, *notes)), *rests[1:]] if notes else rests

    def _at_rest(
        self, start: list[float], parameters: Mapping[str, Any] | None
    ) -> Iterator[tuple[NumpySystem, list[float], float]]:
        """Return the systems in which equilibria are looked for, with whole states and shares of the tries:
        with contacts, one for each of their modes."""
        yield self.differentiated(parameters, start), start, 1.0
        if self.interface.contacts:
            from lagc.diagnostics.faults import Refused
            from lagc.simulation.linearization.contact_modes import other_modes

            others = other_modes(self.interface, start)
            for whole in others:
                with suppress(Refused):  # no motion meets all of these
                    yield self.differentiated(parameters, whole), whole, 1.0 / len(others)

    def _at(
        self,
        t: float,
        parameters: Mapping[str, Any] | None,
        starts: Mapping[str, Any] | None,
        progress: Callable[[float], None] | None = None,
        search: bool = False,
    ) -> tuple[list[float], tuple[str, ...]]:
        """Return the whole state at a time, and notes on its accuracy. At an impact there is no linear model,
        but a state where a search begins."""
        run = self.simulate(
            t, accuracy=ACCURACY, points=2, parameters=parameters, starts=starts, progress=progress
        )
        # A state that is known less exactly than asked is good enough, with a note; a wrong one is not.
        notes = tuple[str, ...]()
        if run.interrupted:
            raise Exhausted if reached() else KeyboardInterrupt
        if run.status == "failed":
            known = run.estimated or 0.0
            if not ACCURACY < known <= COARSELY or run.times[-1] != t:  # the motion is wrong, or not known
                raise ArithmeticError(run.message)
            error = f"the state at t = {t:g} s has a relative error of {known:.1g}"
            notes = (f"{error}: {run.message}",)
        if run.times[-1] < t:
            raise ArithmeticError(f"the motion does not reach t = {t:g} s: {run.message}")
        struck = [e.contact for e in run.events if e.kind == "impact" and e.t == t]
        if struck and not search:
            raise ArithmeticError(f"`{struck[0]}` has an impact at t = {t:g} s")
        return run.states[-1], notes

    def _columns(self, point: Point, of: str, word: str) -> Array:
        group, columns = self._places(word, fixed=of in FIXED)
        table = point.partial(FIXED[of], group) if of in FIXED else point.total(ALONG[of], group)
        return table[:, columns]

    def _places(self, word: str, fixed: bool) -> tuple[str, slice]:
        """Return the group of variables that contains a word, and its columns in the group."""
        interface = self.interface
        nq, nv, n = interface.nq, interface.nv, len(interface.parameters)
        groups = {
            "time": ("time", slice(None)), "state": ("state", slice(None)),
            "coordinates": ("state", slice(nq)), "speeds": ("state", slice(nq, None)),
            "parameters": ("parameter", slice(n)), "inputs": ("parameter", slice(n, None)),
        }  # fmt: skip
        if fixed:
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
            f"{word!r} is not a coordinate, speed, parameter or input, and not one of {', '.join(groups)}"
        )
