"""States put back onto their constraints."""

from __future__ import annotations

from math import inf

from lagc.render.numpy.support.base import FAILED, INCONSISTENT, OK
from lagc.render.numpy.support.problem import Problem
from lagc.render.numpy.support.quaternions import normalise
from lagc.render.numpy.support.sizes import RESTING

# -- what follows is part of generated modules --

TARGET = 1e-15  # scaled residual that is taken for rounding
UNTOUCHED = (
    1e-16  # that is left as it is: what more is left at each step adds up, as it has one sign for long
)
HOPELESS = 1e-6  # scaled residual above which a projection has failed
SOLVES = 8  # at most, for positions and for speeds


def residual(values: list[float], scales: list[float]) -> float:
    """The largest of |value| / scale; infinity where one is not a number."""
    worst = 0.0
    for value, scale in zip(values, scales):
        size = abs(value) / scale
        if not size <= worst:
            worst = size if size == size else inf
    return worst


def measure(
    problem: Problem, t: float, x: list[float], sizes: list[float]
) -> tuple[list[float], list[float]]:
    """What residuals of rows are judged by, and what their rates are; `sizes` of the trajectory."""
    reaches = problem.reaches(t, x, [sizes[0] if sizes[0] < 1.0 else 1.0, *sizes[1:]])
    scales = [a + RESTING * b for a, b in zip(problem.scales(t, x), reaches)]
    return scales, reaches[problem.nc :] + scales[problem.nh :]


def project(problem: Problem, t: float, x: list[float], sizes: list[float]) -> tuple[int, float, float]:
    """Move `x` onto the constraints, by the shortest way in the metric of the mass matrix.

    Positions by simplified Newton iterations (G at the given x), M d = G^T mu, G d = -phi,
    dq = N d; then speeds, M dv = G^T mu, G dv = -psi, with the same factors.  Gives the status
    and the remaining scaled residuals of positions and speeds; `sizes` are those of each kind of
    states over the trajectory.
    """
    normalise(x, problem.quaternions)
    nq, nv, nc, nh = problem.nq, problem.nv, problem.nc, problem.nh
    if nc == 0:
        return OK, 0.0, 0.0
    scales, rates = measure(problem, t, x, sizes)
    r = [0.0] * (nv + nc)
    assembled = False
    position = 0.0
    if nh:
        phi = problem.position(t, x)
        position = residual(phi, scales)
        for n in range(SOLVES):
            if position <= (TARGET if n else UNTOUCHED):
                break
            if not assembled:
                status = problem.assemble(t, x)
                if status in FAILED:
                    return status, position, 0.0
                assembled = True
            r[nv : nv + nh] = [-a for a in phi]
            d = problem.solve(r)[:nv]
            y = x[:]
            for i, dq in enumerate(problem.displace(t, x, d)):
                y[i] += dq
            normalise(y, problem.quaternions)
            phi = problem.position(t, y)
            size = residual(phi, scales)
            if not size < position:
                break
            x[:nq] = y[:nq]
            position = size
        if position > HOPELESS:
            problem.culprit = _worst(phi, scales)
            return INCONSISTENT, position, 0.0
    psi = problem.velocity(t, x)
    velocity = residual(psi, rates)
    for n in range(SOLVES):
        if velocity <= (TARGET if n else UNTOUCHED):
            break
        if not assembled:
            status = problem.assemble(t, x)
            if status in FAILED:
                return status, position, velocity
            assembled = True
        r[nv:] = [-a for a in psi]
        d = problem.solve(r)[:nv]
        y = x[:]
        for i, dv in enumerate(d):
            y[nq + i] += dv
        psi = problem.velocity(t, y)
        size = residual(psi, rates)
        if not size < velocity:
            break
        x[nq : nq + nv] = y[nq : nq + nv]
        velocity = size
    if velocity > HOPELESS:
        problem.culprit = _worst(psi, rates)
        return INCONSISTENT, position, velocity
    return OK, position, velocity


def nudge(problem: Problem, t: float, x: list[float], sizes: list[float]) -> list[float]:
    """A state beside `x`, off its constraints by what projection leaves, in the direction that costs
    most in the metric of the mass matrix, with speeds that fit; empty where that cannot be told."""
    nq, nv = problem.nq, problem.nv
    if problem.assemble(t, x) in FAILED:
        return []
    r = [0.0] * nv
    for i, scale in enumerate(measure(problem, t, x, sizes)[0]):
        r.append((-TARGET if i % 2 else TARGET) * scale)
    d = problem.solve(r)[:nv]
    y = x[:]
    for i, dq in enumerate(problem.displace(t, x, d)):
        y[i] += dq
    r[nv:] = [-a for a in problem.velocity(t, y)]
    for i, dv in enumerate(problem.solve(r)[:nv]):
        y[nq + i] += dv
    return y


def _worst(values: list[float], scales: list[float]) -> int:
    """The row with the largest scaled residual."""
    row, worst = 0, 0.0
    for i, (value, scale) in enumerate(zip(values, scales)):
        if not abs(value) / scale <= worst:
            row, worst = i, abs(value) / scale
    return row
