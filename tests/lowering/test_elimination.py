"""The elimination against dense solutions, over random sparse KKT matrices. Where a dense solve takes far
more operations a straight one is taken, whatever the size."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.lowering.kkt.fill_ordering import Elimination, Structure, eliminate
from lagc.lowering.kkt.ldl import Matrix, factor, pair, refine, residual, substitute
from lagc.lowering.kkt.solve import solvers
from lagc.lowering.scalar.value_numbering import Block
from lagc.mechanics.formulation.equations import EquationsOfMotion
from tests.lowering.interpret import interpret


def random_kkt(seed: int, n: int, c: int) -> tuple[np.ndarray, np.ndarray]:
    """[M G^T; G 0] with a sparse positive definite M and independent rows G."""
    rng = np.random.default_rng(seed)
    b = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.3)
    m = b @ b.T + np.diag(rng.uniform(0.5, 2.0, n))
    g = rng.normal(size=(c, n)) * (rng.random((c, n)) < 0.4)
    columns = rng.permutation(n)[:c]
    g[np.arange(c), columns] += 3.0 * np.sign(g[np.arange(c), columns] + 0.1)
    k = np.zeros((n + c, n + c))
    k[:n, :n], k[n:, :n], k[:n, n:] = m, g, g.T
    return k, rng.normal(size=n + c)


def lower_entries(k: np.ndarray) -> list[tuple[int, int]]:
    return [(i, j) for i in range(len(k)) for j in range(i + 1) if k[i, j] != 0.0]


def planned(n: int, c: int, entries: list[tuple[int, int]]) -> Elimination | None:
    return eliminate(Structure(n, c, tuple(entries)))


def compiled(k: np.ndarray, n: int, c: int, refined: bool):
    """A function w -> s, health that solves with the structure of `k`."""
    entries = lower_entries(k)
    plan = planned(n, c, entries)
    assert plan is not None
    block = Block()
    matrix = Matrix({at: block.load("w", i) for i, at in enumerate(entries)}, {})
    right = [block.load("r", i) for i in range(n + c)]
    factors = factor(block, plan, matrix)
    x = substitute(block, plan, factors, matrix, right)
    _, left = residual(block, plan, factors, matrix, right, x)
    if refined:
        x = refine(block, plan, factors, matrix, right, x)
    for i, value in enumerate(x):
        block.store("s", i, value)
    block.store("health", 0, factors.health)
    block.store("health", 1, left)
    return block.function("test", ("w", "r"), (("s", n + c), ("health", 2)), ""), entries


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 9), st.integers(0, 4), st.booleans())
def test_solutions_of_random_kkt_systems(seed, n, c, refined):
    c = min(c, n)
    k, right = random_kkt(seed, n, c)
    function, entries = compiled(k, n, c, refined)
    found = interpret(function, {"w": [float(k[at]) for at in entries], "r": list(map(float, right))})
    wanted = np.linalg.solve(k, right)
    error = np.abs(np.array(found["s"]) - wanted).max()
    # without pivoting the error grows with the smallest pivot, which `health` tells
    assert error <= 1e-13 * np.linalg.cond(k) / min(found["health"][0], 1.0) * np.abs(wanted).max()
    assert found["health"][0] > 0.0
    assert found["health"][1] < 1e-16


def test_a_redundant_row_shows_in_the_health():
    k, right = random_kkt(3, 5, 3)
    k[7, :5] = k[6, :5] + k[5, :5]
    k[:5, 7] = k[7, :5]
    function, entries = compiled(k, 5, 3, refined=True)
    found = interpret(function, {"w": [float(k[at]) for at in entries], "r": list(map(float, right))})
    assert abs(found["health"][0]) < 1e-13


def test_a_singular_mass_matrix_shows_in_the_health():
    b = np.array([[1.0, 2.0, 0.5], [0.3, 1.0, 1.0], [1.3, 3.0, 1.5]])  # row 3 = row 1 + row 2
    k = b @ b.T
    function, entries = compiled(k, 3, 0, refined=False)
    found = interpret(function, {"w": [float(k[at]) for at in entries], "r": [1.0, 1.0, 1.0]})
    assert abs(found["health"][0]) < 1e-13


def test_a_massless_speed_waits_for_the_constraint_that_moves_it():
    entries = [(0, 0), (2, 0), (2, 1)]  # M = diag(m, 0), one row on both
    plan = planned(2, 1, entries)
    assert plan is not None
    assert [step.unknown for step in plan.steps] == [0, 2, 1]
    k = np.array([[2.0, 0.0, 1.0], [0.0, 0.0, -3.0], [1.0, -3.0, 0.0]])
    function, entries = compiled(k, 2, 1, refined=True)
    found = interpret(function, {"w": [float(k[at]) for at in entries], "r": [1.0, 2.0, 3.0]})
    assert found["s"] == pytest.approx(list(np.linalg.solve(k, [1.0, 2.0, 3.0])), rel=1e-14)


@pytest.mark.parametrize("entries", [[(0, 0)], [(0, 0), (2, 0)], [(0, 0), (2, 1)]])
def test_no_order_where_the_structure_is_singular_or_needs_pivoting(entries):
    assert planned(2, 1, entries) is None


def test_a_chain_of_blocks_fills_in_nothing():
    """A tridiagonal matrix has factors with one entry a column in any minimum degree order."""
    n = 40
    entries = [(i, i) for i in range(n)] + [(i + 1, i) for i in range(n - 1)]
    plan = planned(n, 0, entries)
    assert plan is not None
    assert len(plan.lower) == n - 1


def test_two_by_two_by_cramer():
    block = Block()
    w = {at: block.load("w", i) for i, at in enumerate([(0, 0), (1, 0), (1, 1)])}
    x, ratio = pair(block, w, [block.load("r", 0), block.load("r", 1)])
    for i, value in enumerate(x):
        block.store("s", i, value)
    block.store("s", 2, ratio)
    function = block.function("test", ("w", "r"), (("s", 3),), "")
    found = interpret(function, {"w": [3.0, 1.0, 2.0], "r": [1.0, -4.0]})
    assert found["s"] == pytest.approx([6.0 / 5.0, -13.0 / 5.0, 5.0 / 6.0], rel=1e-15)


def test_rest_in_balance_is_no_bad_residual():
    """Accelerations that are rounding errors of large forces in balance: still a good solution."""
    k = np.zeros((4, 4))
    k[:2, :2] = np.diag([1.0, 3.0])
    g = np.array([[0.3, 0.7], [-0.9, 0.1]])
    k[2:, :2], k[:2, 2:] = g, g.T
    right = np.array([-9.81, -29.43, 0.0, 0.0])  # two rows hold both speeds
    function, entries = compiled(k, 2, 2, refined=True)
    found = interpret(function, {"w": [float(k[at]) for at in entries], "r": list(map(float, right))})
    assert np.abs(found["s"][:2]).max() < 1e-13
    assert found["health"][1] < 1e-26


@pytest.mark.parametrize("seed", range(8))
def test_what_takes_more_than_the_most_has_no_order(seed: int) -> None:
    dice = np.random.default_rng(seed)
    structure = Structure(9, 3, tuple(lower_entries(random_kkt(seed, 9, 3)[0])))
    plan = eliminate(structure)
    assert plan is not None and plan.flops == sum(step.flops for step in plan.steps)
    assert eliminate(structure, plan.flops) == plan
    assert eliminate(structure, plan.flops - 1) is None
    assert eliminate(structure, dice.uniform(0, plan.flops - 1)) is None


NET = """
model Net "knots, joined to their neighbours by rods"
  structural Integer n = 3;
  parameter Length d = 0.3 [m];
  coordinate Length x[n*n], y[n*n], z[n*n];
  for i in 1:n loop
    point P[i, 0] = {i*d, 0, 0};
    for j in 1:n loop
      point P[i, j] = {i*d + x[(i-1)*n+j], y[(i-1)*n+j], -j*d + z[(i-1)*n+j]};
      body knot[i, j] = Particle(mass = 1, at = P[i, j]);
      constraint down[i, j]: norm(P[i, j] - P[i, j-1]) = d;
    end for;
  end for;
  for i in 1:n-1 loop
    for j in 1:n loop
      constraint across[i, j]: norm(P[i+1, j] - P[i, j]) = d;
    end for;
  end for;
end Net;
"""


def net(n: int) -> EquationsOfMotion:
    return Compilation(Source("net.lag", NET), Choice(parameters={"n": n})).equations


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("n", (6, 7, 9, 12))
def test_a_net_is_solved_by_its_own_structure(n: int) -> None:
    e = net(n)
    (solver,) = solvers(e)
    unknowns = len(e.v) + len(e.rows)
    assert 10 * solver.plan.flops < unknowns**3 / 3
