"""Linear equations of any rank, and motions through configurations where constraints lose rank."""

from typing import Any

import pytest

from lagc.lowering.program import Program
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
