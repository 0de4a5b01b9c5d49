"""Compute the sensitivities of a run to parameters and initial values, with an estimate of their error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from lagc.base.text import FINEST
from lagc.kernels.integrators.tableaus import order
from lagc.simulation.global_error.verified_run import longest_step
from lagc.simulation.linearization.derivatives import Array
from lagc.simulation.request import Request
from lagc.simulation.sensitivity.contact_passage import ModeOf, Passage
from lagc.simulation.sensitivity.initial_sensitivity import start_slopes
from lagc.simulation.sensitivity.sensitivities import CLEAR, Mode, Sensitivities
from lagc.simulation.sensitivity.variational_equations import Followed, Variation
from lagc.simulation.simulate import by_hand
from lagc.simulation.system import Options

if TYPE_CHECKING:
    from lagc.simulation.solution import Solution

TOLERANCE = 1e-7  # of a run at rest, which has no tolerance
ATTEMPTS = 4
SAFETY = 2.0  # factor on the difference of two runs
FEW = 24  # steps for each event: fewer are tied to the events, whatever the tolerance
LONGEST_AT = 1e-5  # tolerance of the longest step: at a finer one it is shorter, as chosen steps are
MORE, MOST = 100, 10_000  # steps of an integration: a multiple of those of the motion, plus a constant

Progress = Callable[[float], None]


def sensitivities(
    mode_of: ModeOf, whole: Mode | None, run: Solution, request: Request, progress: Progress | None = None
) -> None:
    """Add sensitivities to `run`, the result of the complete `request`, by the code for its states. `whole`
    is that of the model with contacts, if it has any. If they fail or miss the accuracy, the run fails, and
    its message says why."""
    began, x0 = perf_counter(), _begun(run)
    mode = mode_of(x0)
    system, directions = mode.system, mode.directions
    shape = (len(run.times), system.nq + system.nv, len(directions))
    values, doubts = np.full(shape, np.nan), np.zeros(shape[1:])
    found = Sensitivities(
        mode_of, directions, run.times, run.states, values, doubts, None, "", False, 0, 0, 0, 0.0
    )
    with np.errstate(all="ignore"):  # values that are not finite are detected
        try:
            if run.interrupted or not run.times:
                raise ArithmeticError("the motion was interrupted")
            start, doubts, reasons = start_slopes(system, x0, request.starts, directions, request.guesses)
            # Directions that end early are given up, with their reasons; the others go on.
            kept = [k for k in range(len(directions)) if k not in reasons]
            while kept:
                lost = _verified(
                    found, whole, run, request, kept, (start[:, kept], doubts[:, kept]), progress
                )
                if not lost:
                    break
                names = ", ".join([f"`{directions[k].name}`" for k in lost])
                reasons[lost[0]], found.message, found.estimated = f"{names}: {found.message}", "", None
                kept = [k for k in kept if k not in lost]
            found.message = "; ".join(filter(None, [found.message, *reasons.values()]))
        except ArithmeticError as error:
            found.message = str(error)
    found.run_s = perf_counter() - began
    run.sensitivities = found
    if found.message:
        run.message += f"; sensitivities: {found.message}"
        run.status = "failed" if run.status == "ok" else run.status
        run.interrupted = run.interrupted or found.interrupted


def _begun(run: Solution) -> list[float]:
    """The initial state, before an impact there, with the contacts that it hits open."""
    t, *states = run.corners[0] if run.corners else (None, run.states[0])
    if t != run.times[0]:
        return list(run.states[0])
    x, names = list(states[0]), [contact.name for contact in run.system.interface.contacts]
    for event in run.events:
        if event.t == t and event.kind == "impact":
            x[len(x) - len(names) + names.index(event.contact)] = 0.0
    return x


def _verified(
    found: Sensitivities,
    whole: Mode | None,
    run: Solution,
    request: Request,
    kept: list[int],
    start: tuple[Array, Array],
    progress: Progress | None,
) -> list[int]:
    """Fill `found` in the directions `kept` and return those that end early; every second run starts
    displaced."""
    n, x0 = len(start[0]), _begun(run)
    mode = found.mode_of(x0).of(kept)
    kinds = mode.system.interface.kinds
    rests = len(run.times) > 1 and all(x[:n] == x0[:n] for x in run.states)

    # One integration. Contacts are passed segment by segment, as S jumps with their events.
    def follow(options: Options) -> Followed:
        displaced, most = found.integrations % 2 == 1, MORE * run.cost.steps + MOST
        begun = start[0] + displaced * start[1]
        along: Variation | Passage
        if whole is None or rests:
            along = Variation(mode, begun, options, rests, most)
        else:
            along = Passage(whole, found.mode_of, kept, begun, options, displaced, most)
        done = along.integrate(x0, run.times, progress)
        found.steps, found.rejected = found.steps + done.steps, found.rejected + done.rejected
        found.integrations += 1
        found.interrupted = found.interrupted or done.interrupted
        return done

    # One integration at a tolerance: the longest step shrinks with it, by the order of the method.
    def at(tol: float, halves: bool) -> Followed:
        longest = longest_step(mode.system, run.times[-1], request.max_step)
        longest *= (tol / LONGEST_AT) ** (1.0 / order(run.method))
        return follow(Options(method=run.method, rtol=tol, max_step=longest, halves=halves, alone=run.alone))

    # By hand one integration is the result; else integrations at finer tolerances go on until they agree.
    if request.by_hand:
        done = follow(by_hand(request))
        found.values[:, :, kept], found.message = done.values, done.message
        found.doubts[:, kept] = _doubts(done, 0.0, kinds)
        return [kept[k] for k in done.lost]
    assert request.accuracy is not None
    done = _refined(found, kinds, at, TOLERANCE if rests else max(run.rtol, 10.0 * FINEST), request.accuracy)
    found.values[:, :, kept], found.message = done.values, done.message
    found.doubts[:, kept] = _doubts(done, found.estimated or 0.0, kinds)
    if not found.message and (found.estimated is None or not found.estimated <= request.accuracy):
        known = "is not known" if found.estimated is None else f"seems to be {found.estimated:.3g}"
        found.message = f"their accuracy {known}, {request.accuracy:.3g} was asked for"
    return [kept[k] for k in done.lost]


def _refined(
    found: Sensitivities, kinds: Sequence[int], at: Callable[[float, bool], Followed], tol: float,
    accuracy: float,
) -> Followed:  # fmt: skip
    """Return the sensitivities `at` a tolerance, `tol` or a finer one, for which the error of `found` is
    within the accuracy, if there is one."""
    # As for the motion: two integrations, the finer one displaced by the doubts of its start, until
    # their difference is within the accuracy.
    done = at(tol, False)
    for _ in range(ATTEMPTS):
        if done.message or tol <= FINEST:
            break
        if found.estimated is not None and done.steps < FEW * done.passed[-1]:  # events end most steps
            again = at(tol, False)
            if again.message:
                break
            done = again
        before, tol = done, max(0.1 * tol, FINEST)
        finer = at(tol, True)
        if finer.message and done.reached >= finer.reached:
            done.message = finer.message if finer.interrupted else f"at a finer tolerance, {finer.message}"
            done.lost = finer.lost
            break
        done = finer
        apart = found.estimated
        found.estimated = SAFETY * _distance(before, done, kinds)
        if found.estimated <= accuracy or (apart is not None and found.estimated > 0.5 * apart):
            break
    return done


def _distance(one: Followed, two: Followed, kinds: Sequence[int]) -> float:
    """The largest difference of two results, relative to the largest in its scaling group and direction, or
    to the terms that cancel at events. Values within round-off, and times between the events of the two, do
    not count."""
    end = min(one.reached, two.reached)
    alike = np.flatnonzero(one.passed[:end] == two.passed[:end])
    far, sizes = np.abs(one.values[alike] - two.values[alike]), np.abs(two.values[:end])
    worst = 0.0
    for k, kind in enumerate(sorted(set(kinds))):
        mask = np.array(kinds) == kind
        apart, size = (values[:, mask].max(axis=(0, 1), initial=0.0) for values in (far, sizes))
        size = np.maximum(size, two.terms[k])
        known = size > CLEAR * (one.rounding[k] + two.rounding[k])
        relative = np.divide(apart, size, out=np.zeros_like(apart), where=known)
        worst = max(worst, float(relative.max(initial=0.0)))
    return worst


def _doubts(done: Followed, estimated: float, kinds: Sequence[int]) -> Array:
    """The error of each state by directions: the estimated error of its scaling group, or its round-off."""
    place = np.searchsorted(sorted(set(kinds)), kinds)
    sizes = np.array(
        [np.fmax.reduce(np.abs(done.values[:, place == k]), axis=(0, 1), initial=0.0)
         for k in range(len(done.terms))]
    )  # fmt: skip
    found: Array = np.maximum(CLEAR * done.rounding, estimated * np.maximum(sizes, done.terms))
    return found[place]
