"""Long chains: accelerations against an independent recursion along the links."""

from __future__ import annotations

import math

import numpy
import pytest

import lagc


def _accelerations(angles: numpy.ndarray, rates: numpy.ndarray, link: float, g: float) -> numpy.ndarray:
    """th'' of a chain of equal bobs in O(n), without a mass matrix: the tensions S_i of the massless
    links satisfy a tridiagonal system, since each link keeps its length,

        S_(i-1) cos(th_(i-1) - th_i) - 2 S_i + S_(i+1) cos(th_(i+1) - th_i) = -m l th_i'^2 (i > 1),

    and the transverse component of the difference of two bobs' accelerations is l th_i''.
    In extended precision.
    """
    n = len(angles)
    a, w = angles.astype(numpy.longdouble), rates.astype(numpy.longdouble)
    along = numpy.cos(a[1:] - a[:-1])
    across = numpy.sin(a[1:] - a[:-1])
    # forces on bob i per unit mass: gravity, S_i towards i-1, S_(i+1) towards i+1
    diagonal = numpy.full(n, numpy.longdouble(-2.0))
    diagonal[0] = -1.0
    right = -numpy.longdouble(link) * w * w
    right[0] -= numpy.longdouble(g) * numpy.cos(a[0])
    for i in range(1, n):  # elimination
        factor = along[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * along[i - 1]
        right[i] -= factor * right[i - 1]
    tension = numpy.zeros(n, dtype=numpy.longdouble)
    tension[n - 1] = right[n - 1] / diagonal[n - 1]
    for i in range(n - 2, -1, -1):
        tension[i] = (right[i] - along[i] * tension[i + 1]) / diagonal[i]
    turn = numpy.zeros(n, dtype=numpy.longdouble)
    turn[:-1] += tension[1:] * across
    turn[1:] -= tension[:-1] * across
    turn[0] -= numpy.longdouble(g) * numpy.sin(a[0])
    return (turn / numpy.longdouble(link)).astype(float)


@pytest.mark.sample(1)
@pytest.mark.parametrize("links", [10, 100])
def test_accelerations_of_a_chain(links: int) -> None:
    system = lagc.load("classic/chain").compile(parameters={"n": links}, backend="numpy")
    random = numpy.random.default_rng(1)
    angles, rates = random.uniform(-1.0, 1.0, links), random.uniform(-2.0, 2.0, links)
    found = system.rhs(0.0, [*angles, *rates])[links:]
    expected = _accelerations(angles, rates, 0.2, 9.81)
    assert abs(found - expected).max() <= 1e-12 * abs(expected).max()


def test_small_swings_of_a_chain_are_its_normal_modes() -> None:
    links, link, g = 12, 0.2, 9.81
    share = numpy.array([links + 1.0 - max(i, j) for i in range(1, links + 1) for j in range(1, links + 1)])
    mass = link**2 * share.reshape(links, links)
    stiffness = numpy.diag([g * link * (links + 1.0 - i) for i in range(1, links + 1)])
    values, modes = numpy.linalg.eig(numpy.linalg.solve(mass, stiffness))
    slowest = int(numpy.argmin(values))
    w, mode = math.sqrt(values[slowest]), modes[:, slowest]
    # close to the hanging rope of the same length: the first zero of J0
    assert math.isclose(w, 1.2024 * math.sqrt(g / (links * link)), rel_tol=0.05)

    system = lagc.load("classic/chain").compile(parameters={"n": links})
    size = 1e-5  # the nonlinear terms are size^2 smaller
    starts = {f"th[{i + 1}]": size * float(m) for i, m in enumerate(mode)}
    run = system.simulate(2.0, method="dop853", rtol=1e-11, atol=1e-16, points=21, starts=starts)
    assert run.status == "ok", run.message
    for i, m in enumerate(mode):
        assert abs(run[f"th[{i + 1}]"] - size * m * numpy.cos(w * run.t)).max() <= 1e-8 * size
