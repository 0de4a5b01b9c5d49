"""Rounding that all runs share enters the estimate: known motions in ill-conditioned coordinates."""

from collections.abc import Callable, Sequence
from math import cos, sin
from random import Random
from typing import Any

import mpmath
import pytest
from mpmath import mpf

import lagc
from lagc.api import Run
from lagc.simulation.request import Request
from lagc.simulation.simulate import simulate
from lagc.simulation.system import Vector
from tests.simulation.measured import worst_error
from tests.simulation.systems import Oscillator

pytestmark = pytest.mark.usefixtures("no_cache")
Exact = Callable[[float], list[float]]  # q, then v
ACCURACIES = (1e-4, 1e-6, 1e-8, 1e-10)


def true_error(run: Run, exact: Exact) -> float:
    return worst_error(run, [exact(t) for t in run.times])


def swing(start: mpf, omega: mpf, t: float) -> tuple[mpf, mpf]:
    """Angle and rate of a pendulum released at `start`: sin(theta/2) = k sn(K + omega t)."""
    k = mpmath.sin(start / 2)
    u = mpmath.ellipk(k * k) + omega * t
    sn, cn, dn = (mpmath.ellipfun(name, u, m=k * k) for name in ("sn", "cn", "dn"))
    theta = 2 * mpmath.asin(k * sn)
    return theta, 2 * k * omega * cn * dn / mpmath.cos(theta / 2)


def in_coordinates(rows: list[list[float]], chance: Random, nonlinear: bool) -> tuple[str, Exact]:
    """Independent oscillators or pendulums p = A q as a model in the coordinates q, and their motion.  A is a
    parameter: products of numbers in the text would be rounded before the run."""
    n = len(rows)
    q = [chance.uniform(-0.5, 0.5) for _ in range(n)]
    omega = [chance.uniform(1.0, 3.0) for _ in range(n)]
    lines = [f"coordinate Real q{k}(start = {q[k]!r}, fixed = true);" for k in range(n)]
    lines += [f"parameter Real a{i}{k} = {a!r};" for i, row in enumerate(rows) for k, a in enumerate(row)]
    place = [" + ".join(f"a{i}{k}*q{k}" for k in range(n)) for i in range(n)]
    rate = [" + ".join(f"a{i}{k}*der(q{k})" for k in range(n)) for i in range(n)]
    energy = "(1 - cos({}))" if nonlinear else "1/2*({})^2"
    kinetic = " + ".join(f"1/2*1 [kg.m2]*({r})^2" for r in rate)
    potential = " + ".join(f"{w!r}^2*1 [J]*{energy.format(p)}" for w, p in zip(omega, place))
    lines += [f"kinetic K = {kinetic};", f"potential V = {potential};"]
    with mpmath.workdps(40):
        matrix = mpmath.matrix([[mpf(a) for a in row] for row in rows])
        first = matrix * mpmath.matrix([mpf(a) for a in q])

    def exact(t: float) -> list[float]:
        with mpmath.workdps(40):
            if nonlinear:
                pairs = [swing(a, mpf(w), t) for a, w in zip(first, omega)]
            else:
                pairs = [(a * mpmath.cos(w * t), -a * w * mpmath.sin(w * t))
                         for a, w in zip(first, map(mpf, omega))]  # fmt: skip
            parts = [mpmath.lu_solve(matrix, mpmath.matrix([p[i] for p in pairs])) for i in (0, 1)]
            return [float(x) for part in parts for x in part]

    return "model M\n" + "\n".join(lines) + "\nend M;", exact


def hilbert(n: int) -> list[list[float]]:
    return [[1.0 / (i + j + 1) for j in range(n)] for i in range(n)]


def near(n: int, apart: float, chance: Random) -> list[list[float]]:
    """Rows that differ by `apart`."""
    base = [chance.uniform(0.5, 1.5) for _ in range(n)]
    return [[a + apart * chance.uniform(-1.0, 1.0) for a in base] for _ in range(n)]


def honest(text: str, exact: Exact, stop: float) -> list[Run]:
    """Runs at several accuracies: none has an error beyond twice its estimate (the rounding of a constant
    mass matrix is the same in both runs), or beyond the accuracy where it is `ok`."""
    model = lagc.loads(text).compile(backend="numpy")
    runs: list[Run] = []
    for accuracy in ACCURACIES:
        run = model.simulate(stop, accuracy=accuracy, points=11)
        assert run.estimated is not None
        if len(run.times) == 11:
            true = true_error(run, exact)
            assert true <= 2.0 * run.estimated, (accuracy, run.message)
            assert run.status == "failed" or true <= accuracy
        assert run.status == "failed" or run.estimated <= accuracy
        runs.append(run)
        if run.status == "failed":
            break
    return runs


@pytest.mark.sample(1)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_hilbert_mass_matrices(n: int, nonlinear: bool) -> None:
    text, exact = in_coordinates(hilbert(n), Random(n), nonlinear)
    runs = honest(text, exact, 2.0)
    assert runs[0].status == "ok"
    assert (runs[-1].status == "failed") == (n == 4)


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(8))
def test_any_coordinates(seed: int) -> None:
    chance = Random(seed)
    rows = chance.choice((hilbert(2), hilbert(3), near(2, 10.0 ** chance.uniform(-3.0, -1.0), chance)))
    text, exact = in_coordinates(rows, chance, nonlinear=chance.random() < 0.5)
    honest(text, exact, 2.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize("apart", [1e-1, 1e-2, 1e-3, 1e-4])
def test_coordinates_that_nearly_depend_on_each_other(apart: float) -> None:
    chance = Random(str(apart))
    text, exact = in_coordinates(near(2, apart, chance), chance, nonlinear=apart > 3e-3)
    runs = honest(text, exact, 2.0)
    if apart < 3e-4:
        assert runs[-1].status == "failed"
    else:
        assert runs[0].status == "ok"
    if apart > 3e-2:
        assert len(runs) == len(ACCURACIES) and runs[-2].status == "ok"


@pytest.mark.parametrize("ratio", [1e6, 1e12])
def test_masses_far_apart(ratio: float) -> None:
    # two masses on a spring, the position of one and the way to the other: the reduced mass swings
    reduced = ratio / (1.0 + ratio)
    text = f"""model M
      coordinate Length x(start = 0.5 [m]), s(start = 1 [m]);
      body a = Particle(mass = {ratio!r} [kg], at = {{x, 0, 0}});
      body b = Particle(mass = 1 [kg], at = {{x + s, 0, 0}});
      potential spring = 1/2*4 [N/m]*s^2;
    end M;"""
    omega = (4.0 / reduced) ** 0.5

    def exact(t: float) -> list[float]:
        s, v = cos(omega * t), -omega * sin(omega * t)
        share = 1.0 / (1.0 + ratio)
        return [0.5 + share * (1.0 - s), s, -share * v, v]

    assert honest(text, exact, 3.0)[0].status == "ok"


@pytest.mark.parametrize("offset", [1e3, 1e6, 1e9])
def test_large_terms_that_cancel(offset: float) -> None:
    text = f"""model M
      coordinate Length x(start = {offset + 1.0!r} [m]);
      body a = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      potential spring = 1/2*4 [N/m]*(x - {offset!r} [m])^2;
    end M;"""
    runs = honest(text, lambda t: [offset + cos(2.0 * t), -2.0 * sin(2.0 * t)], 3.0)
    assert (runs[-1].status == "ok") == (offset < 1e5)


@pytest.mark.parametrize("angle", [1e-1, 1e-3])
def test_rows_that_nearly_depend_on_each_other(angle: float) -> None:
    # both hold the particle on the x axis; the weight presses it against them
    text = f"""model M
      coordinate Length x(start = 1 [m]), y, z;
      body a = Particle(mass = 1 [kg], at = {{x, y, z}});
      constraint c: z = 0;
      constraint d: z + {angle!r}*y = 0;
      potential field = 1/2*4 [N/m]*x^2 + 9.81 [N]*z + 3 [N]*y;
    end M;"""
    runs = honest(text, lambda t: [cos(2.0 * t), 0.0, 0.0, -2.0 * sin(2.0 * t), 0.0, 0.0], 3.0)
    assert runs[0].status == "ok"


@pytest.mark.sample(1)
@pytest.mark.parametrize(("backend", "offset"), [("c", 0.5), ("numpy", 0.5), ("c", 0.0)])  # 2e6 steps
def test_forces_that_are_differences_of_near_numbers(backend: str, offset: float) -> None:
    # a swing of 1e-7 about a place where exp(x) - 1 has lost seven digits
    text = f"""model M
      coordinate Real x(start = {offset + 1e-7!r});
      kinetic K = 1/2*1 [kg.m2]*der(x)^2;
      potential V = 4 [J]*(exp(x - {offset!r}) - (x - {offset!r}));
    end M;"""
    run = lagc.loads(text).compile(backend=backend).simulate(2.0, accuracy=1e-12, points=11)
    assert run.estimated is not None
    # A step rounds the last place of 1 in a difference of 1e-7; the steps round differently, so that a
    # part of it remains.
    lost = 2.0**-53 / (1e-7 if offset == 0.0 else 1.0)
    assert run.estimated > 0.02 * lost and (offset > 0.0 or run.status == "failed")


def test_every_evaluation_is_counted() -> None:
    class Noted(Oscillator):
        calls = 0

        def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
            self.calls += 1
            return super().rhs(t, x, xdot, lam)

        def energies(self, t: float, x: Vector) -> list[float]:
            self.calls += 1
            return super().energies(t, x)

        def bind(self, values: Sequence[float]) -> Any:
            return self

    for accuracy in (1e-6, 1e-13):  # without a close look, and with one
        system: Any = Noted()
        run = simulate(system, Request(stop=3.0, accuracy=accuracy))
        # not those that the start is judged by, and that are told of the run
        assert system.calls - 3 == run.cost.rhs


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize("e", [1e-2, 1e-3, 1e-4, 5e-5, 2e-5, 1e-5, 3e-6])
def test_coordinates_that_all_but_coincide(e: float, backend: str) -> None:
    """a is at p + q and b at p + (1 + e) q, under constant forces: q = (f_b - f_a) t^2 / 2 / e, and the mass
    matrix has the condition 1 / e^2, at every state alike."""
    text = f"""model Coincide
  parameter Mass m = 1 [kg];
  parameter Real e = {e!r};
  coordinate Length p, q;
  body a = Particle(mass = m, at = {{p + q, 0, 0}});
  body b = Particle(mass = m, at = {{0, p + (1 + e)*q, 0}});
  force f = (1 [N])*world.x at a;
  force g = (3.3 [N])*world.y at b;
end Coincide;"""
    run = lagc.loads(text).compile(backend=backend).simulate(1.0)
    true = abs(run["q"][-1] * e / 1.15 - 1.0)
    assert run.estimated is not None and true <= run.estimated
    assert run.status == "ok" or e < 1e-4
