"""A linear model of a compiled one about a state of its motion.

With y the independent ones of the state x = (q, v) (see `independent`), x' = f(x, u) along the constraints:

    dy' = A dy + B du,      d(output) = C dy + D du,      A = S (df/dx) X,

X what x changes by with y, S the choice of y: multipliers and what constraint forces change by are in df/dx.
Eigenvalues of A are those of the constrained system, and no others.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import cached_property
from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np

from lagc.base.records import dataclass, replace
from lagc.simulation.linearization.derivatives import ROUNDING, Array, Point, largest_beside, rounded
from lagc.simulation.linearization.independent_states import independent, is_halted
from lagc.simulation.linearization.stability import Spectrum, is_least, spectrum
from lagc.simulation.system import OK, Options

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem

STILL = 1e-9  # of what moves the state by its size: rates of an equilibrium
FURTHER = 0.3  # of the size of a state: how far a motion is followed
CLOSELY, MANY = 1e-10, 1000  # its tolerance and steps
AT_REST = 1e-8  # of what a mode moves: coordinates that it leaves where they are
HALTED = "some motions that constraints allow there to first order go no further; they have eigenvalues, too"


@dataclass(frozen=True)
class Linear:
    """`states` are the names of the entries of y; `x` is the state (q, v) at time `t`."""

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
    scales: Array  # sizes of the entries of y, alike in time
    changing: list[bool]  # of the entries of y, whether they change in the motion itself
    of_time: bool  # whether derivatives seem to depend on time itself
    linear: bool  # whether they seem to depend on nothing but parameters
    notes: tuple[str, ...] = ()  # where it is one of those of several sides
    least: bool = False  # it is an equilibrium at which energy, which is kept, has a strict minimum
    free: int = 0  # of an equilibrium: directions in which it seems to be one of many
    halted: bool = False  # some of the motions that constraints allow there are ones to first order only
    turning: bool = False  # A is another as the motion goes on, though what changes acts on nothing else now

    def __repr__(self) -> str:
        sizes = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<{type(self).__name__} of {self.system.interface.model} at t = {self.t:g} s: {sizes}>"

    @property
    def states(self) -> tuple[str, ...]:
        names = self.system.interface.state_names
        return tuple([names[i] for i in self.indices])

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple([f.name for f in self.system.interface.inputs])

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple([f.name for f in self.system.interface.outputs])

    @property
    def still(self) -> bool:
        """Whether it is an equilibrium: all rates are rounding."""
        return not any(self.changing)

    @property
    def steady(self) -> bool:
        """Whether what changes in the motion acts on nothing else, so that in the rest A stays what it is."""
        return not self.turning and not any(self.changing[k] for k in self._acting[0])

    @property
    def idle(self) -> tuple[str, ...]:
        """The states that act on nothing but one another: each brings an eigenvalue 0."""
        return tuple([self.states[k] for k in sorted(self._acting[1])])

    @cached_property
    def _acting(self) -> tuple[list[int], list[int]]:
        """The states that act on others in the end, and those that act on none but ones before them."""
        kept, idle = list(range(len(self.A))), list[int]()
        while not self.turning:
            found = [k for k in kept if not self.A[kept, k].any()]
            if not found:
                return kept, idle
            idle += found
            kept = [k for k in kept if k not in found]
        return kept, idle

    @cached_property
    def _own(self) -> Spectrum:
        """Of the states that act."""
        kept, _ = self._acting
        return spectrum(self.A[np.ix_(kept, kept)], self.scales[kept])

    @cached_property
    def _spectrum(self) -> tuple[Any, Any]:
        kept, idle = self._acting
        n = len(self.A)
        values, vectors = np.zeros(n, dtype=complex), np.zeros((n, n), dtype=complex)
        values[: len(kept)], vectors[kept, : len(kept)] = self._own
        for k in reversed(idle):  # they follow: value times entry = row of A
            for j in np.flatnonzero(values):
                vectors[k, j] = self.A[k] @ vectors[:, j] / values[j]
        vectors[idle, range(len(kept), n)] = 1.0
        order = sorted(range(n), key=lambda k: (-values[k].real, abs(values[k]), -values[k].imag))
        return values[order], vectors[:, order]

    @property
    def eigenvalues(self) -> Any:
        """Of A, 1/s: the fastest growing first, of a pair that with the positive imaginary part."""
        return self._spectrum[0]

    @cached_property
    def modes(self) -> Any:
        """What x = (q, v) moves by, a column an eigenvalue: of the coordinates, or where none moves of the
        speeds, the largest is 1."""
        found = self.motions @ self._spectrum[1]
        for k in range(found.shape[1]):
            q = found[: self.system.nq, k]
            part = q if np.abs(q).max(initial=0.0) > AT_REST * np.abs(found[:, k]).max() else found[:, k]
            found[:, k] /= part[np.abs(part).argmax()]
        return found

    @property
    def momentary(self) -> bool:
        """Whether A changes in the motion, so that its eigenvalues are those of a moment and tell not what
        grows."""
        return not self.linear and (self.of_time or not self.steady)

    @property
    def stability(self) -> str | None:
        """What the eigenvalues say of an equilibrium or steady motion, `idle` states aside; None where they
        say nothing."""
        if self.momentary or not self.states:
            return None
        if self.halted:
            return "undecided: constraints are singular there"
        growth = max(self._own.values.real, default=0.0)
        if growth > 0.0:
            return "unstable"
        if growth < 0.0:
            return "asymptotically stable"
        least = self.least and not self.free
        return "stable: energy is least there" if least else "neutral: the linear model does not decide"

    def to_dict(self) -> dict[str, Any]:
        """Numbers in SI."""
        interface = self.system.interface
        names = interface.state_names
        return {
            "t": self.t,
            "x": dict(zip(names, self.x)),
            "multipliers": dict(zip(interface.row_labels, self.lam)),
            "equilibrium": self.still, "steady": self.steady, "momentary": self.momentary,
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
    """Hz, of the oscillation; 0 where there is none."""
    return abs(value.imag) / (2.0 * pi)


def damping(value: complex) -> float | None:
    """The damping ratio -Re/|.|; None of the eigenvalue 0."""
    return -value.real / abs(value) if value else None


def linearize(system: NumpySystem, t: float, x: Sequence[float]) -> Linear:
    """About the state x = (q, v), which meets the constraints; where forces bend there, on the side on which
    what they depend on is larger, with a note.  Raises ArithmeticError where the motion is not determined
    there, forces jump, or derivatives of rates are not finite; those of outputs are nan then, with a note."""
    with np.errstate(all="ignore"):  # what is not finite is refused
        try:
            found = _on_all_sides(system, t, x) if system.interface.switches else _linearized(system, t, x)
            if found.steady and not found.still and not found.linear and _turns(found):
                found = replace(found, turning=True)
            found.modes  # noqa: B018  with its eigenvalues
        except np.linalg.LinAlgError:
            raise ArithmeticError("numbers there are too large or too small for a linear model") from None
    return found


def _on_all_sides(system: NumpySystem, t: float, x: Sequence[float]) -> Linear:
    from lagc.simulation.linearization.nonsmooth_points import branches, jumps

    point, sizes = Point(system, t, x), size_of_states(system)
    own, others = branches(point, sizes)
    if own is None:
        return _linearized(system, t, x)
    for words, modes in others:
        if jumps(point, own, modes, np.maximum(np.abs(point.x), sizes)):
            raise ArithmeticError(f"forces jump there, where {words}: no linear model tells what they do")
    found = _linearized(system, t, x, own)
    notes = [_bent(words, found, _linearized(system, t, x, modes)) for words, modes in others]
    return replace(found, notes=(*found.notes, *[note for note in notes if note]))


def _bent(words: str, one: Linear, two: Linear) -> str:
    """What is another on the other side; nothing where nothing is."""
    from lagc.simulation.linearization.nonsmooth_points import differing

    if one.indices != two.indices:
        return f"forces bend there, where {words}: on the other side the model has other states"
    rates, outputs = [f"der({name})" for name in one.states], list(one.outputs)
    found = []
    for above, below, here, there in (
        (rates, one.states, one.A, two.A), (rates, one.inputs, one.B, two.B),
        (outputs, one.states, one.C, two.C), (outputs, one.inputs, one.D, two.D),
    ):  # fmt: skip
        found += [f"d({above[i]})/d({below[j]}) is {here[i, j]:.6g}, and {there[i, j]:.6g} on the other side"
                  for i, j in differing(here, there)]  # fmt: skip
    more = f"; {len(found) - 1} more entries differ" if len(found) > 1 else ""
    return f"forces bend there, where {words}: {found[0]}{more}" if found else ""


def _linearized(
    system: NumpySystem, t: float, x: Sequence[float], modes: Sequence[float] | None = None
) -> Linear:
    """On a branch, where it is not that of the state."""
    point = Point(system, t, x, clean=True, modes=modes)
    first = len(system.interface.parameters)
    by_x, by_u = point.unsure("state"), point.unsure("parameter")
    sizes, size_inputs = point.rate_sizes("state", by_x), point.rate_sizes("parameter", by_u)[:, first:]
    rates, by_inputs = point.total("rate", "state"), point.total("rate", "parameter")[:, first:]
    changing = _changing(point, rates, point.rate_sizes("state"))
    chosen = independent(point, changing.tolist())
    outputs, out_inputs = point.total("output", "state"), point.total("output", "parameter")[:, first:]
    moved, put = np.abs(chosen.motions), np.abs(chosen.inputs)
    a = rounded(rates @ chosen.motions, sizes @ moved)[chosen.indices]
    b = rounded(rates @ chosen.inputs + by_inputs, sizes @ put + size_inputs)[chosen.indices]
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
    halted = is_halted(point, chosen, size_of_states(system))
    if halted:
        notes.append(HALTED)
    moving = changing[chosen.indices].tolist()
    scales = _scales(point, chosen.indices, a)
    pace, far = np.linalg.norm(a * scales / scales[:, None]), _far(point)
    time = 1.0 / float(pace) if pace else 1.0
    least = not any(moving) and _keeps_energy(system, chosen.indices, a) and is_least(point, chosen, a)
    return Linear(system, t, point.x, point.lam, chosen.indices, chosen.motions, a, b, c, d, scales, moving,
                  _differs(point, time, 0.0 * far), not _differs(point, time, far), tuple(notes),
                  least=least and not halted, halted=halted)  # fmt: skip


def _without_value(*tables: Array) -> list[int]:
    """The lines in which something is not finite."""
    finite = np.isfinite(np.hstack(tables)).all(axis=1)
    return np.flatnonzero(~finite).tolist()


def _keeps_energy(system: NumpySystem, indices: Sequence[int], a: Array) -> bool:
    """Whether energy is kept, of which speeds have their own part and no other force: then all motions about
    an equilibrium oscillate where it is least, and there alone, which is stable (G. Lejeune Dirichlet,
    *J. reine angew. Math.* 32, 1846)."""
    interface, speeds = system.interface, np.array(indices) >= system.nq
    kept = interface.conservative and not (interface.doubtful or interface.switches or interface.whens)
    return bool(kept and 0 < 2 * speeds.sum() == len(a) and not a[np.ix_(speeds, speeds)].any())


def _changing(point: Point, rates: Array, sizes: Array) -> Array:
    """Which entries of x change in the motion, now or by their second derivative."""
    far = _far(point)
    once = np.array([*point.value("qdot"), *point.a])
    once[(np.abs(once) <= STILL * (sizes @ far)) | point.rounding_rates()] = 0.0
    twice = rates @ once + point.total("rate", "time")[:, 0]
    terms = sizes @ np.abs(once) + point.rate_sizes("time")[:, 0]
    changes: Array = (once != 0.0) | (np.abs(twice) > STILL * terms)
    return changes


def _far(point: Point) -> Array:
    """What is no small part of the state."""
    return np.maximum(np.abs(point.x), size_of_states(point.system))


def _differs(point: Point, time: float, sizes: Array) -> bool:
    """Whether derivatives of the equations by the state, a or lam are others up to so much later, at states
    that are up to `sizes` off."""
    system, chance = point.system, random.Random(0)
    own = Point(system, point.t, point.x, point.a, point.lam)  # on the branch of each state
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


def _turns(now: Linear) -> bool:
    """Whether other states act, or act otherwise, where one that changes has moved by a share of its size, as
    of a pendulum that sets out from the horizontal, where gravity has no slope.  False where the motion goes
    on with other states, or not at all."""
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
    """Sizes of coordinates, and of speeds what changes these by as much in the time in which both act
    alike on each other."""
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
    """What is not small for each coordinate and speed: 1 rad, 1 for what has no unit, else the largest
    parameter or start value of the unit, else 1."""
    interface = system.interface
    known: dict[str, float] = {}
    units = interface.state_units
    fields = (*interface.parameters, *interface.inputs)
    for unit, value in [*zip((f.unit for f in fields), system.parameters), *zip(units, system.start())]:
        if abs(value) < float("inf"):
            known[unit] = max(known.get(unit, 0.0), abs(value))
    return np.array([1.0 if unit in ("rad", "") else known.get(unit) or 1.0 for unit in units])
