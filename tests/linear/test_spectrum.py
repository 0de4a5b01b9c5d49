"""Eigenvalues of slow motions beside fast ones, against 50 digits."""

from random import Random

import mpmath
import numpy as np
import pytest

import lagc
from lagc.simulation.linearization.stability import spectrum


def test_slow_oscillators_beside_fast_ones() -> None:
    """Three masses that hang together by next to nothing: 1e-3, 1 and 1e6 rad/s, and none is 0."""
    text = """model Scales
  coordinate Length x, y, z;
  body a = Particle(mass = 1e-6, at = {x, 0, 0});
  body b = Particle(mass = 1, at = {y, 0, 0});
  body c = Particle(mass = 1e6, at = {z, 0, 0});
  potential V = 1/2*(1e6 [N/m]*x^2 + 1 [N/m]*(y - x)^2 + 1e-6 [N/m]*(z - y)^2 + 1 [N/m]*z^2);
end Scales;"""
    (linear,) = lagc.loads(text).compile(backend="numpy").equilibria(tries=2)
    stiffness = mpmath.matrix([[1e6 + 1, -1, 0], [-1, 1 + mpmath.mpf("1e-6"), -1e-6], [0, -1e-6, 1 + 1e-6]])
    with mpmath.workdps(50):
        roots = [mpmath.mpf(10) ** e for e in (-3, 0, 3)]
        form = mpmath.matrix(3, 3)
        for i in range(3):
            for j in range(3):
                form[i, j] = stiffness[i, j] / (roots[i] * roots[j])
        exact = sorted(float(mpmath.sqrt(e)) for e in mpmath.eigsy(form, eigvals_only=True))
    assert sorted(abs(linear.eigenvalues))[::2] == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_nothing_stays_nothing(seed: int) -> None:
    """Free chains of masses and springs over many powers of ten: they go on as one, and nothing grows."""
    chance = Random(seed)
    n = chance.randint(2, 5)
    masses = [10.0 ** chance.uniform(-4.0, 4.0) for _ in range(n)]
    forces = np.zeros((2, n, n))
    for part in forces:
        for i in range(n - 1):
            k = 10.0 ** chance.uniform(-4.0, 8.0)
            part[i : i + 2, i : i + 2] += [[k, -k], [-k, k]]
    accelerations = -forces / np.array(masses)[:, None]
    table = np.block([[np.zeros((n, n)), np.eye(n)], [accelerations[0], seed % 2 * accelerations[1]]])
    values = spectrum(table, np.ones(2 * n)).values
    assert (values == 0.0).sum() >= 2 and not (values.real > 0.0).any()
