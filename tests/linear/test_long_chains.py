"""Derivatives and linear models of long chains with joint angles, whose mass matrix is all but singular,
against 50 digits in angles from the vertical; and of springs that are stiff and soft. Eigenvalues of slow
motions beside fast ones, against 50 digits."""

from functools import cache
from random import Random

import mpmath
import numpy as np
import pytest
from mpmath import mpf

import lagc
from lagc.simulation.linearization.stability import spectrum

M, L, G = mpf(1), mpf("0.2"), mpf("9.81")


@cache
def chain(n: int) -> lagc.CompiledModel:
    return lagc.load("large/relative_chain").compile(parameters={"n": n}, backend="numpy")


def inertia(n: int, i: int, j: int) -> mpf:
    """Of the angles from the vertical, with the chain straight."""
    return M * L**2 * (n - 1 - max(i, j) + (mpf(1) / 3 if i == j else mpf(1) / 2))


def weight(n: int, i: int) -> mpf:
    return M * G * L * (n - 1 - i + mpf(1) / 2)


def accelerations(q: list[mpf], v: list[mpf]) -> list[mpf]:
    """Of the joint angles."""
    n = len(q)
    th, w = ([mpmath.fsum(x[: i + 1]) for i in range(n)] for x in (q, v))
    a, r = mpmath.matrix(n, n), mpmath.matrix(n, 1)
    for i in range(n):
        r[i] = -weight(n, i) * mpmath.sin(th[i])
        for j in range(n):
            a[i, j] = inertia(n, i, j) * mpmath.cos(th[i] - th[j])
            r[i] -= inertia(n, i, j) * mpmath.sin(th[i] - th[j]) * w[j] ** 2
    found = mpmath.lu_solve(a, r)
    return [found[i] - (found[i - 1] if i else 0) for i in range(n)]


@pytest.mark.full
@pytest.mark.parametrize("n", [10, 40])
def test_accelerations_of_a_long_chain_keep_their_derivatives(n: int) -> None:
    chance = Random(n)
    x, d = ([chance.gauss(0.0, 0.3) for _ in range(2 * n)] for _ in range(2))
    with mpmath.workdps(50):

        def at(h: mpf) -> list[mpf]:
            moved = [a + h * b for a, b in zip(x, d)]
            return accelerations(moved[:n], moved[n:])

        h = mpf(10) ** -15
        ahead, back = at(h), at(-h)
        expected = np.array([float((a - b) / (2 * h)) for a, b in zip(ahead, back)])
    found = chain(n).jacobian("accelerations", "state", 0.0, x) @ np.array(d)
    assert np.abs(found - expected).max() <= 2e-12 * np.abs(expected).max()


@pytest.mark.full
def test_a_long_chain_hangs_with_its_frequencies() -> None:
    n = 40
    with mpmath.workdps(30):
        a = mpmath.matrix(n, n)
        for i in range(n):
            for j in range(n):
                a[i, j] = inertia(n, i, j) / mpmath.sqrt(weight(n, i) * weight(n, j))
        expected = sorted(float(1 / mpmath.sqrt(x)) for x in mpmath.eigsy(a, eigvals_only=True))
    values = chain(n).linearize(x=[0.0] * 2 * n).eigenvalues
    assert not values.real.any()
    assert np.sort(values.imag)[n:].tolist() == pytest.approx(expected, rel=6e-12)


@pytest.mark.full
def test_energy_of_a_longer_chain_is_least_where_it_hangs() -> None:
    n = 80
    assert chain(n).linearize(x=[0.0] * 2 * n).stability == "stable: energy is least there"


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "coupling, stability",
    [
        (0.0, "stable: energy is least there"),
        (0.999999e5, "stable: energy is least there"),
        (1e5, "neutral: the linear model does not decide"),
        (1.000001e5, "unstable"),
    ],
)
def test_stiff_springs_say_nothing_of_soft_ones(coupling: float, stability: str) -> None:
    """k1 k2 = 1e10 (N/m)^2: it is least where the square of the coupling is below that."""
    text = f"""model Two
      coordinate Length x, y;
      parameter Stiffness c = {coupling} [N/m];
      body p = Particle(mass = 1 [kg], at = {{x, y, 0}});
      potential V = 0.5 [N/m]*x^2 + 0.5e10 [N/m]*y^2 + c*x*y;
    end Two;"""
    assert lagc.loads(text).compile(backend="numpy").linearize().stability == stability


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
