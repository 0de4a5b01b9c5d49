"""A linear model of a compiled model about a state of its motion.

With y the independent entries of the state x = (q, v) (see `independent_states`), and x' = f(x, u) along the
constraints:

dy' = A dy + B du,      d(output) = C dy + D du,      A = S (df/dx) X,

X is the derivative of x by y, and S selects y; df/dx includes the multipliers and the changes of constraint
forces.  The eigenvalues of A are exactly those of the constrained system.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cached_property
from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.base.records import dataclass, field, replace
from lagc.simulation.linearization.derivatives import ROUNDING, Array, Point, largest_beside, rounded
from lagc.simulation.linearization.independent_states import independent, is_higher_order_rigid
from lagc.simulation.linearization.stability import Spectrum, is_energy_minimum, spectrum
from lagc.simulation.system import OK, Options

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

AT_REST_RATE = 1e-9  # relative rate of a state at an equilibrium
FURTHER = 0.3  # of the size of a state: the length of motion to compare with
CLOSELY, MANY = 1e-10, 1000  # tolerance and number of steps of that motion
AT_REST = 1e-8  # of a mode's largest entry: coordinates that it does not move
RIGID = "the constraints allow some motions there only to first order; these have eigenvalues, too"


@dataclass(frozen=True)
class Linear:
    """A linear model about the state `x` = (q, v) at the time `t` (s), in SI units.

    A, B, C and D belong to the independent `states` y (`indices` into x), `inputs` and `outputs`. `motions`
    is dx/dy, `lam` are the multipliers, `scales` the sizes of the entries of y.  `changing` tells which
    entries of y change in the motion itself.  `time_dependent`: the derivatives seem to depend on time
    itself.  `linear`: they seem to depend on parameters only.  `energy_minimum`: an equilibrium of a
    conservative system at a strict minimum of the potential energy.  `free`: for an equilibrium, the number
    of directions in which it is one of a family.  `higher_order_rigid`: the constraints allow some of the
    motions only to first order.  `varying`: A changes along the motion, although no state that changes now
    acts on others.  `contacts`: what each contact does."""

    system: NumpySystem
    t: float
    x: list[float]
    lam: list[float]
    indices: list[int]
    motions: Array
    A: Array
    B: Array
    C: Array
    D: Array
    scales: Array
    changing: list[bool]
    time_dependent: bool
    linear: bool
    notes: tuple[str, ...] = ()
    energy_minimum: bool = False
    free: int = 0
    higher_order_rigid: bool = False
    varying: bool = False
    contacts: dict[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<{type(self).__name__} of {self.system.interface.model} at t = {self.t:g} s: {sizes}>"

    @property
    def states(self) -> tuple[str, ...]:
        """The names of the independent states y."""
        names = self.system.interface.state_names
        return tuple([names[i] for i in self.indices])

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the inputs u."""
        return tuple([f.name for f in self.system.interface.inputs])

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple([f.name for f in self.system.interface.outputs])

    @property
    def equilibrium(self) -> bool:
        """Whether x is an equilibrium: all rates are round-off."""
        return not any(self.changing)

    @property
    def steady(self) -> bool:
        """Whether the states that change in the motion act on no others, so that A stays constant."""
        return not self.varying and not any(self.changing[k] for k in self._acting[0])

    @property
    def idle(self) -> tuple[str, ...]:
        """The states that act only on one another; each gives an eigenvalue 0."""
        return tuple([self.states[k] for k in sorted(self._acting[1])])

    @cached_property
    def _acting(self) -> tuple[list[int], list[int]]:
        """The states that act on others, and those that act on none."""
        kept, idle = list(range(len(self.A))), list[int]()
        while not self.varying:
            found = [k for k in kept if not self.A[kept, k].any()]
            if not found:
                return kept, idle
            idle += found
            kept = [k for k in kept if k not in found]
        return kept, idle

    @cached_property
    def _acting_spectrum(self) -> Spectrum:
        """The spectrum of the states that act."""
        kept, _ = self._acting
        return spectrum(self.A[np.ix_(kept, kept)], self.scales[kept])

    @cached_property
    def _spectrum(self) -> tuple[Any, Any]:
        kept, idle = self._acting
        n = len(self.A)
        values, vectors = np.zeros(n, dtype=complex), np.zeros((n, n), dtype=complex)
        values[: len(kept)], vectors[kept, : len(kept)] = self._acting_spectrum
        for k in reversed(idle):  # eigenvalue times entry = row of A times vector
            for j in np.flatnonzero(values):
                vectors[k, j] = self.A[k] @ vectors[:, j] / values[j]
        vectors[idle, range(len(kept), n)] = 1.0
        order = sorted(range(n), key=lambda k: (-values[k].real, abs(values[k]), -values[k].imag))
        return values[order], vectors[:, order]

    @property
    def eigenvalues(self) -> Any:
        """The eigenvalues of A in 1/s: the fastest growing first; of a pair, the one with positive
        imaginary part first."""
        return self._spectrum[0]

    @cached_property
    def modes(self) -> Any:
        """The changes of x = (q, v), one column for each eigenvalue. The largest entry of the coordinates is
        1, or of the speeds if no coordinate moves."""
        found = self.motions @ self._spectrum[1]
        for k in range(found.shape[1]):
            q = found[: self.system.nq, k]
            part = q if np.abs(q).max(initial=0.0) > AT_REST * np.abs(found[:, k]).max() else found[:, k]
            found[:, k] /= part[np.abs(part).argmax()]
        return found

    @property
    def momentary(self) -> bool:
        """Whether A changes in the motion, so that its eigenvalues do not tell what grows."""
        return not self.linear and (self.time_dependent or not self.steady)

    @property
    def stability(self) -> str | None:
        """The stability of an equilibrium or steady motion by the eigenvalues, `idle` states aside; None if
        they do not tell."""
        if self.momentary or not self.states:
            return None
        if self.higher_order_rigid:
            return "undecided: constraints are singular there"
        growth = max(self._acting_spectrum.values.real, default=0.0)
        if growth > 0.0:
            return "unstable"
        if growth < 0.0:
            return "asymptotically stable"
        least = self.energy_minimum and not self.free
        return "stable: energy is least there" if least else "neutral: the linear model does not decide"

    def to_dict(self) -> dict[str, Any]:
        """The linear model as plain data for JSON, in SI units."""
        interface = self.system.interface
        names = interface.state_names
        return {
            "t": self.t,
            "x": dict(zip(names, self.x)),
            "multipliers": dict(zip(interface.row_labels, self.lam)),
            "contacts": dict(self.contacts),
            "equilibrium": self.equilibrium, "steady": self.steady, "momentary": self.momentary,
            "stability": self.stability,
            "free": self.free,
            "states": list(self.states), "idle": list(self.idle),
            "inputs": list(self.inputs), "outputs": list(self.outputs),
            "A": self.A.tolist(), "B": self.B.tolist(), "C": self.C.tolist(), "D": self.D.tolist(),
            "eigenvalues": [
                {"real": value.real, "imag": value.imag,
                 "frequency": frequency(value), "damping": damping(value),
                 "mode": {name: [part.real, part.imag] for name, part in zip(names, mode)}}
                for value, mode in zip(self.eigenvalues.tolist(), self.modes.T.tolist())
            ],
        }  # fmt: skip


def frequency(value: complex) -> float:
    """The frequency of the oscillation in Hz; 0 for a real eigenvalue."""
    return abs(value.imag) / (2.0 * pi)


def damping(value: complex) -> float | None:
    """The damping ratio -Re/|.|; None for the eigenvalue 0."""
    return -value.real / abs(value) if value else None


def linearize(system: NumpySystem, t: float, x: Sequence[float]) -> Linear:
    """Return the linear model about the state x = (q, v), which must satisfy the constraints.

    If forces have a kink there, it is the model on the side of larger indicators, with a note.  Raises
    ArithmeticError if the accelerations are not determined, forces jump, or derivatives of rates are not
    finite.  Derivatives of outputs that are not finite are NaN, with a note."""
    with np.errstate(all="ignore"):  # values that are not finite are refused
        try:
            found = _on_all_sides(system, t, x) if system.interface.relations else _linearized(system, t, x)
            if found.steady and not found.equilibrium and not found.linear and _varies(found):
                found = replace(found, varying=True)
            found.modes  # noqa: B018  with its eigenvalues
        except np.linalg.LinAlgError:
            raise ArithmeticError("numbers there are too large or too small for a linear model") from None
    return found


def _on_all_sides(system: NumpySystem, t: float, x: Sequence[float]) -> Linear:
    """The linear model at a state where modes may change, with notes on the other sides."""
    from lagc.simulation.linearization.derivatives import branches, jumps

    point, sizes = Point(system, t, x), size_of_states(system)
    own, others = branches(point, sizes)
    if own is None:
        return _linearized(system, t, x)
    for words, modes in others:
        if jumps(point, own, modes, np.maximum(np.abs(point.x), sizes)):
            raise ArithmeticError(f"forces are discontinuous there, where {words}: there is no linear model")
    found = _linearized(system, t, x, own)
    notes = [_branch_note(words, found, _linearized(system, t, x, modes)) for words, modes in others]
    return replace(found, notes=(*found.notes, *[note for note in notes if note]))


def _branch_note(words: str, one: Linear, two: Linear) -> str:
    """A note on the entries that differ on the other side, or ""."""
    from lagc.simulation.linearization.derivatives import differing

    if one.indices != two.indices:
        return f"forces have a kink there, where {words}: on the other side the model has other states"
    rates, outputs = [f"der({name})" for name in one.states], list(one.outputs)
    found = []
    for above, below, here, there in (
        (rates, one.states, one.A, two.A), (rates, one.inputs, one.B, two.B),
        (outputs, one.states, one.C, two.C), (outputs, one.inputs, one.D, two.D),
    ):  # fmt: skip
        found += [f"d({above[i]})/d({below[j]}) is {here[i, j]:.6g}, and {there[i, j]:.6g} on the other side"
                  for i, j in differing(here, there)]  # fmt: skip
    more = f"; {len(found) - 1} more entries differ" if len(found) > 1 else ""
    return f"forces have a kink there, where {words}: {found[0]}{more}" if found else ""


def _linearized(
    system: NumpySystem, t: float, x: Sequence[float], modes: Sequence[float] | None = None
) -> Linear:
    """The linear model on the branch `modes`, or on that of the state."""
    point = Point(system, t, x, clean=True, modes=modes)
    first = len(system.interface.parameters)
    # Derivatives of rates along the motion, and the sizes that their round-off is relative to.
    by_x, by_u = point.unsure("state"), point.unsure("parameter")
    sizes, size_inputs = point.rate_sizes("state", by_x), point.rate_sizes("parameter", by_u)[:, first:]
    rates, by_inputs = point.total("rate", "state"), point.total("rate", "parameter")[:, first:]
    changing = _changing(point, rates, point.rate_sizes("state"))
    chosen = independent(point, changing.tolist())
    outputs, out_inputs = point.total("output", "state"), point.total("output", "parameter")[:, first:]
    # A = S (df/dx) X and B = S (df/du + (df/dx) dx/du), with entries that are round-off set to 0.
    moved, put = np.abs(chosen.motions), np.abs(chosen.inputs)
    a = rounded(rates @ chosen.motions, sizes @ moved)[chosen.indices]
    b = rounded(rates @ chosen.inputs + by_inputs, sizes @ put + size_inputs)[chosen.indices]
    # Outputs depend on accelerations and multipliers too.
    late = np.abs(point.partial("output", "acceleration"))
    of_state = np.abs(point.partial("output", "state")) + late @ by_x
    of_inputs = np.abs(point.partial("output", "parameter")) + late @ by_u
    c = rounded(outputs @ chosen.motions, of_state @ moved)
    d = rounded(outputs @ chosen.inputs + out_inputs, of_state @ put + of_inputs[:, first:])
    interface = system.interface
    if lost := _without_value(a, b):
        without = ", ".join([f"der({interface.state_names[chosen.indices[k]]})" for k in lost])
        raise ArithmeticError(f"the derivatives of {without} have no finite value there")
    lost = _without_value(c, d)
    c[lost], d[lost] = np.nan, np.nan
    notes = [f"the output `{interface.outputs[k].name}` has no derivatives there" for k in lost]
    rigid = is_higher_order_rigid(point, chosen, size_of_states(system))
    if rigid:
        notes.append(RIGID)
    moving = changing[chosen.indices].tolist()
    # Whether the model depends on time or on the state is tried within its own pace.
    scales = _scales(point, chosen.indices, a)
    pace, far = np.linalg.norm(a * scales / scales[:, None]), _far(point)
    time = 1.0 / float(pace) if pace else 1.0
    least = (
        not any(moving) and _keeps_energy(system, chosen.indices, a) and is_energy_minimum(point, chosen, a)
    )
    return Linear(system, t, point.x, point.lam, chosen.indices, chosen.motions, a, b, c, d, scales, moving,
                  _differs(point, time, 0.0 * far), not _differs(point, time, far), tuple(notes),
                  energy_minimum=least and not rigid, higher_order_rigid=rigid)  # fmt: skip


def _without_value(*tables: Array) -> list[int]:
    """The rows in which a value is not finite."""
    finite = np.isfinite(np.hstack(tables)).all(axis=1)
    return np.flatnonzero(~finite).tolist()


def _keeps_energy(system: NumpySystem, indices: Sequence[int], a: Array) -> bool:
    """Whether energy is conserved, with quadratic kinetic energy and no other forces. Then all motions about
    an equilibrium oscillate if and only if the potential energy has a minimum there, which is stable (G.
    Lejeune Dirichlet, J. reine angew. Math. 32, 1846)."""
    interface, speeds = system.interface, np.array(indices) >= system.nq
    kept = interface.conservative and not (interface.doubtful or interface.relations or interface.whens)
    return bool(kept and 0 < 2 * speeds.sum() == len(a) and not a[np.ix_(speeds, speeds)].any())


def _changing(point: Point, rates: Array, sizes: Array) -> Array:
    """Which entries of x change in the motion, by their first or second derivative."""
    far = _far(point)
    once = np.array([*point.value("qdot"), *point.a])
    once[(np.abs(once) <= AT_REST_RATE * (sizes @ far)) | point.rounding_rates()] = 0.0
    twice = rates @ once + point.total("rate", "time")[:, 0]
    terms = sizes @ np.abs(once) + point.rate_sizes("time")[:, 0]
    changes: Array = (once != 0.0) | (np.abs(twice) > AT_REST_RATE * terms)
    return changes


def _far(point: Point) -> Array:
    """The size of each state, at least its value."""
    return np.maximum(np.abs(point.x), size_of_states(point.system))


def _differs(point: Point, time: float, sizes: Array) -> bool:
    """Whether derivatives of the equations change within `time`, or at states up to `sizes` away."""
    system, chance = point.system, random.Random(0)
    own = Point(system, point.t, point.x, point.a, point.lam)
    outputs = system.interface.stack["start"].start
    for _ in range(3):
        t = point.t + time * chance.uniform(0.1, 1.0)
        x = [value + size * chance.uniform(0.1, 1.0) for value, size in zip(point.x, sizes.tolist())]
        for group in ("state", "acceleration"):
            here = own.by(group)[:outputs]
            there = Point(system, t, x, point.a, point.lam).by(group)[:outputs]
            largest = np.maximum(largest_beside(here), largest_beside(there))
            if not (np.abs(there - here) <= ROUNDING * largest).all():
                return True
    return False


def _varies(now: Linear) -> bool:
    """Whether A changes when the state has moved by a share of its size. An example is a pendulum that starts
    from the horizontal, where gravity has no slope.  False if the motion continues with other states, or not
    at all."""
    system, point = now.system, Point(now.system, now.t, now.x)
    sizes, once = size_of_states(system), np.array([*point.value("qdot"), *point.a])
    twice = point.total("rate", "state") @ once + point.total("rate", "time")[:, 0]
    pace = float(max((np.abs(once) / sizes).max(), np.sqrt((np.abs(twice) / sizes).max())))
    end = now.t + FURTHER / pace if pace > 0.0 else inf
    if end == inf:
        return False
    x = [*now.x, *[0.0] * (system.nx - len(now.x))]
    run = system.integrate(Options(rtol=CLOSELY, max_steps=MANY), now.t, x, [end])
    if run.status != OK or not end > now.t:
        return False
    later = _linearized(system, end, run.x[: len(now.x)])
    if later.indices != now.indices:
        return False
    kept = sorted({*now._acting[0], *later._acting[0]})
    one, two = (m.A[np.ix_(kept, kept)] * now.scales[kept] / now.scales[kept][:, None] for m in (now, later))
    apart = np.abs(two - one).max(initial=0.0)
    return bool(apart > CLOSELY**0.5 * np.abs(one).max(initial=0.0))


def _scales(point: Point, indices: Sequence[int], a: Array) -> Array:
    """Sizes of coordinates; sizes of speeds are those that change the coordinates by as much, in the time
    in which both act alike on each other."""
    nq, sizes = point.system.nq, size_of_states(point.system)
    reach = np.abs(point.partial("qdot", "state")[:, nq:]) / sizes[:nq, None]
    sizes[nq:] = 1.0 / np.where(reach.any(axis=0), reach.max(axis=0, initial=0.0), 1.0)
    found = sizes[list(indices)]
    scaled, q = a * found / found[:, None], np.array(indices) < nq
    there, back, own = (np.linalg.norm(scaled[np.ix_(i, j)]) for i, j in ((q, ~q), (~q, q), (~q, ~q)))
    pace = np.sqrt(back / there) if there and back else own
    found[~q] *= pace or 1.0
    return found


def size_of_states(system: NumpySystem) -> Array:
    """A typical size of each coordinate and speed. It is 1 rad for angles, 1 for numbers without unit, or
    else the largest parameter or initial value of the same unit, or else 1."""
    interface = system.interface
    known: dict[str, float] = {}
    units = interface.state_units
    fields = (*interface.parameters, *interface.inputs)
    for unit, value in [*zip((f.unit for f in fields), system.parameters), *zip(units, system.start())]:
        if abs(value) < float("inf"):
            known[unit] = max(known.get(unit, 0.0), abs(value))
    return np.array([1.0 if unit in ("rad", "") else known.get(unit) or 1.0 for unit in units])
