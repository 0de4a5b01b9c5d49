"""Linear equations of any rank, and motions through configurations where constraints lose rank. Rows that all
but depend on others: what they demand is met, or the run does not end well."""

import math
import random
from typing import Any

import pytest

import lagc
from lagc.lowering.program import Program
from lagc.simulation.solution import Solution
from lagc.simulation.system import INCONSISTENT, OK, REDUNDANT, SINGULAR_MASS, Options
from tests.interfaces import interface
from tests.simulation.handmade import module
from tests.simulation.programs import BACKENDS, build, four_bar

numpy = pytest.importorskip("numpy")


def packed(m: Any) -> Any:
    return [float(m[i, j]) for i in range(len(m)) for j in range(i + 1)]


class Fallback:
    """The kernels that factor and solve, with M, G and the sizes of gamma as they are given."""

    def __init__(self, n: int, m: int) -> None:
        self.kernels = module(Program(interface(nq=n, nv=n, nc=m, nh=m, solve="dense"), {}))
        self.kernels.fn_gamma_sizes = lambda p, t, x, s: None
        self.work = self.kernels.Work()
        self.work.rows.regularity = [1.0] * m

    def factor(self, mass: list[float], g: list[float]) -> int:
        self.work.M, self.work.G = mass, g
        status: int = self.kernels.factor_rank_revealing([], 0.0, [], 1e-5, self.work)
        return status

    def solve(self, force: list[float], right: list[float]) -> tuple[int, list[float], list[float]]:
        z, lam = force[:], [0.0] * len(right)
        return self.kernels.solve_rank_revealing(self.work, right, z, lam), z, lam


SIZES = [(5, 2, 2), (6, 4, 2), (6, 5, 3), (3, 3, 3), (4, 6, 3), (7, 3, 3)]


@pytest.mark.parametrize(("n", "m", "rank"), SIZES)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_it_is_the_least_squares_solution(n: int, m: Any, rank: int, scale: float) -> None:
    """Against the pseudo-inverse: the accelerations, and the shortest multipliers."""
    random = numpy.random.default_rng(n + 10 * m)
    root = random.normal(size=(n, n))
    mass = root @ root.T + numpy.eye(n)
    g = scale * random.normal(size=(m, rank)) @ random.normal(size=(rank, n))
    force, right = random.normal(size=n), g @ random.normal(size=n)
    fallback = Fallback(n, m)
    status = fallback.factor(packed(mass), g.ravel().tolist())
    assert status == (OK if rank == m else REDUNDANT) and fallback.work.factors.rank == rank
    status, a, lam = fallback.solve(force.tolist(), right.tolist())
    assert status == (OK if rank == m else REDUNDANT)
    null = numpy.linalg.svd(g)[2][rank:].T
    particular = numpy.linalg.pinv(g, rcond=1e-10) @ right
    free = numpy.linalg.solve(null.T @ mass @ null, null.T @ (force - mass @ particular)) if rank < n else []
    expected = particular + null @ free
    assert a == pytest.approx(expected.tolist(), rel=1e-9, abs=1e-10)
    shortest = numpy.linalg.pinv(g.T, rcond=1e-10) @ (mass @ expected - force)
    assert lam == pytest.approx(shortest.tolist(), rel=1e-8, abs=1e-9 * max(abs(shortest)))


def test_a_massless_coordinate_that_a_constraint_holds() -> None:
    fallback = Fallback(3, 1)
    mass = numpy.diag([1.0, 0.0, 2.0])
    assert fallback.factor(packed(mass), [1.0, -1.0, 0.0]) == OK
    status, a, lam = fallback.solve([1.0, 0.0, 3.0], [0.5])
    assert status == OK and a == pytest.approx([1.0, 0.5, 1.5]) and lam == pytest.approx([0.0], abs=1e-15)


def test_a_massless_coordinate_that_nothing_holds() -> None:
    fallback = Fallback(3, 1)
    assert fallback.factor(packed(numpy.diag([1.0, 0.0, 2.0])), [1.0, 0.0, 1.0]) == SINGULAR_MASS
    assert fallback.work.culprit == 1


def test_very_uneven_masses_are_not_taken_for_dependent_rows() -> None:
    """A mass of 1e-12 between two of 1: both rods in line hold it, and each other's rows by 1e-6."""
    fallback = Fallback(3, 2)
    mass, g = numpy.diag([1.0, 1e-12, 1.0]), [-1.0, 1.0, 0.0, 0.0, -1.0, 1.0]
    assert fallback.factor(packed(mass), g) == OK
    status, a, _ = fallback.solve([1.0, 0.0, 0.0], [0.0, 0.0])
    assert status == OK and a == pytest.approx([0.5, 0.5, 0.5], rel=1e-11)


def test_rows_without_entries() -> None:
    """A row that vanishes asks nothing, or the impossible."""
    fallback = Fallback(2, 1)
    assert fallback.factor([1.0, 0.0, 1.0], [0.0, 0.0]) == REDUNDANT
    status, a, lam = fallback.solve([1.0, 2.0], [0.0])
    assert (status, a, lam) == (REDUNDANT, [1.0, 2.0], [0.0])
    assert fallback.solve([1.0, 2.0], [1.0])[0] == INCONSISTENT and fallback.work.culprit == 0


@BACKENDS
def test_dependent_rows_are_free_again_after_the_configuration(backend: str) -> None:
    system = build(four_bar(1, 0.0, -4.0), backend)
    x = system.start()
    assert system.rhs(0.0, x, [0.0] * 8, [0.0] * 3) == REDUNDANT
    later = system.integrate(Options(), 0.0, x, [0.2])
    assert system.rhs(0.2, later.x, [0.0] * 8, [0.0] * 3) == OK


@pytest.mark.full
@BACKENDS
@pytest.mark.parametrize("tolerance", [1e-9, 1e-4])
def test_an_overconstrained_linkage_moves(backend: str, tolerance: float) -> None:
    """Two parallelograms with one rod too many, which is dependent on the constraints only: the
    stages of a step leave them."""
    fair, over = (build(four_bar(2, 1.0, -4.0, spare), backend) for spare in (False, True))
    x = fair.start()
    options = Options(rtol=tolerance, atol=tolerance)
    one, other = (s.integrate(options, 0.0, x, [0.2]) for s in (fair, over))
    assert other.status == OK and other.redundant_rows == (5,)
    assert other.x == pytest.approx(one.x, abs=30.0 * tolerance)
    long = over.integrate(options, 0.0, x, [10.0])
    assert long.status == OK and long.position_drift <= 1e-14 and long.velocity_drift <= 1e-14
    energy = over.energies(0.0, long.x)[2] - over.energies(0.0, x)[2]
    assert abs(energy) < 1e3 * tolerance
    assert long.x[2] - long.x[0] == pytest.approx(1.0, abs=1e-9)


PAIR = """
model Pair "two rows of one plane, but for a small share; the planes meet in a line along {d}"
  parameter Mass m = 1 [kg];
  parameter Real e = {e!r};
  coordinate Length x, y, z;
  body b = Particle(mass = m, at = {{x, y, z}});
  constraint first: {first} = 0;
  constraint second: {first} + e*({second}) = 0;
  potential V = (1 [N])*({push});
end Pair;
"""
RODS = """
model Rods "two rods whose far ends are d apart: x = 0 follows, and nothing less"
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m], d = {d!r} [m];
  coordinate Length x, y, z(start = -1);
  body b = Particle(mass = m, at = {{x, y, z}});
  constraint first: norm({{x, y, z}}) = l;
  constraint second: norm({{x - d, y, z}}) = sqrt(l^2 + d^2);
  potential V = (9.8 [N])*z + (3 [N])*x + (1 [N])*y;
end Rods;
"""


def _sum(weights: list[int]) -> str:
    return " + ".join(f"({w})*{name}" for w, name in zip(weights, "xyz"))


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(12))
def test_a_share_of_its_own_is_met_or_told(seed: int) -> None:
    """Two planes through the origin at an angle of about e: the particle can move along their common
    line only, c = first x second, with the acceleration -(push . c) c / c^2 / m."""
    chance = random.Random(seed)
    c = [0, 0, 0]
    while not any(c):
        a, b, f = ([chance.randint(-3, 3) for _ in range(3)] for _ in range(3))
        c = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    e = 10.0 ** chance.uniform(-10.0, -2.0)
    run = _run(PAIR.format(d=c, e=e, first=_sum(a), second=_sum(b), push=_sum(f)))
    along = -0.5 * sum(x * y for x, y in zip(f, c)) / sum(x * x for x in c)
    off = max(abs(run[name][-1] - along * x) for name, x in zip("xyz", c))
    if run.status == "ok":
        assert off <= 1e-6 * max(1.0, max(abs(along * x) for x in c)) + 1e-15 / e
    else:
        assert "nearly depends on others" in run.message and e < 1e-3
        assert run.estimated is None or run.estimated > 1e-6
        assert math.isclose(float(run.message.split("share of ")[1].split()[0]), e, rel_tol=100.0)


def _run(text: str) -> Solution:
    return lagc.loads(text).compile(backend="numpy").simulate(1.0, points=21)


@pytest.mark.sample(1)
@pytest.mark.parametrize("d", [1e-2, 1e-3, 1e-5, 1e-6, 1e-8, 1e-10])
def test_two_rods_with_ends_close_together(d: float) -> None:
    run = _run(RODS.format(d=d))
    if run.status == "ok":
        assert abs(run["x"]).max() <= 1e-6
    else:
        assert "nearly depends on others" in run.message


def test_a_row_that_does_depend_is_no_fault() -> None:
    text = PAIR.format(d="y", e=0.0, first="x - y", second="z", push="x + 2*y + 3*z")
    run = _run(text)
    assert run.status == "ok"
    assert run["z"][-1] == pytest.approx(-1.5) and run["x"][-1] == pytest.approx(-0.75)
