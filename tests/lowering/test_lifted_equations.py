"""The lifted form of the equations: the same motion as the dense system in 50 digits, in work that grows
as the model does."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import mpmath
import numpy as np
import pytest

import lagc
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused
from lagc.lowering.kkt import solve as kkt
from lagc.lowering.kkt.articulated_body import articulated_body
from lagc.lowering.kkt.fill_ordering import eliminate
from lagc.lowering.kkt.solve import Solver, solvers
from lagc.lowering.program import Function
from lagc.lowering.storage import places
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.simulation.system import NOT_FINITE, OK, SINGULAR_MASS
from lagc.symbolic.graph import Node
from tests.lowering import large
from tests.lowering.exact import values
from tests.lowering.interpret import interpret
from tests.mechanics.numbers import consistent_state, random_state
from tests.mechanics.random_systems import random_system

DIGITS = 50


def lifted_alone(e: EquationsOfMotion) -> Solver:
    system = articulated_body(e)
    assert system is not None
    plan = eliminate(system.structure)
    assert plan is not None
    return Solver(system, plan)


def solved(e: EquationsOfMotion, solver: Solver) -> list[Function]:
    return kkt.rhs(places(e, e.model.parameters), solver, False)


def run(e: EquationsOfMotion, functions: Sequence[Function], state: Mapping[Node, float]) -> np.ndarray:
    """Accelerations and multipliers, and behind them the least pivot ratio and the square of what is left."""
    given = [*(p.symbol for p in e.model.parameters), *(u.symbol for u in e.model.inputs)]
    arrays = {"p": [state[s] for s in given], "t": [state[e.time]], "x": [state[s] for s in (*e.q, *e.v)]}
    found = interpret(functions[0], arrays)
    for watch in functions[1:]:
        found |= interpret(watch, {**arrays, "health": found["health"]})
    return np.array([*found["xdot"][len(e.q) : len(e.q) + len(e.v)], *found["lam"], *found["health"][:2]])


def dense(e: EquationsOfMotion, state: Mapping[Node, float]) -> tuple[np.ndarray, float]:
    """Accelerations and multipliers of [M -G^T; G 0] in many digits, and the condition of the matrix, its
    rows and columns scaled by the square roots of their largest entries."""
    n, size = len(e.v), len(e.v) + len(e.rows)
    with mpmath.workdps(DIGITS):
        k, right = mpmath.zeros(size), mpmath.zeros(size, 1)
        for (i, j), value in zip(e.mass_matrix, values(list(e.mass_matrix.values()), state)):
            k[i, j] = k[j, i] = value
        for r, row in enumerate(e.rows):
            for j, value in zip(row.jacobian, values(list(row.jacobian.values()), state)):
                k[n + r, j], k[j, n + r] = value, -value
        for i, (tau, h) in enumerate(zip(values(e.given_forces, state), values(e.bias_forces, state))):
            right[i] = tau - h
        for r, gamma in enumerate(values([row.gamma for row in e.rows], state)):
            right[n + r] = gamma
        found = mpmath.lu_solve(k, right)
        a = np.array([[float(k[i, j]) for j in range(size)] for i in range(size)])
    scale = np.sqrt(np.abs(a).max(axis=1))
    condition = float(np.linalg.cond(a / np.outer(scale, scale)))
    return np.array([float(x) for x in found]), condition


@pytest.mark.sample(1, 8)
@pytest.mark.parametrize("seed", range(60))
def test_every_form_gives_the_motion_of_random_systems(seed: int) -> None:
    """Rounding of a backward stable elimination, times what the pivots say that it grows by."""
    e = derive(random_system(seed))
    state = consistent_state(e, seed)
    if state is None:
        return
    wanted, condition = dense(e, state)
    if condition > 1e12:  # rows that depend on each other there
        return
    size = float(np.abs(wanted).max()) or 1.0
    for solver in solvers(e):
        *found, health, left = run(e, solved(e, solver), state)
        assert abs(left) < 1e-16
        assert left <= (20.0 * 2.0**-53 / health) ** 2
        assert np.abs(found - wanted).max() <= 1e-14 * condition / min(abs(health), 1.0) * size


@pytest.mark.sample(2)
@pytest.mark.parametrize("family", large.TREES)
def test_trees_are_solved_to_rounding(family: str) -> None:
    e = large.equations(large.TREES[family], 7)
    state = random_state(e, 5)
    wanted, condition = dense(e, state)
    found = run(e, solved(e, lifted_alone(e)), state)[: len(e.v)]
    error = np.abs(found - wanted).max() / np.abs(wanted).max()
    assert error <= 2e-16 * condition + 2e-15


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [4, 5, 8])
def test_entries_may_cancel_that_the_structure_has(n: int) -> None:
    """Speeds that are the rates of absolute angles, of coordinates that are relative."""
    rates = [" + ".join(f"der(q[{j}])" for j in range(1, i + 1)) for i in range(1, n + 1)]
    speeds = "".join(f"  speed AngularVelocity u{i} = {rate};\n" for i, rate in enumerate(rates))
    e = large.equations(large.RODS.replace("  point P[0]", f"{speeds}  point P[0]"), n)
    state = random_state(e, n)
    wanted, condition = dense(e, state)
    found = run(e, solved(e, lifted_alone(e)), state)[:n]
    assert np.abs(found - wanted).max() <= (2e-16 * condition + 2e-15) * np.abs(wanted).max()


NOWHERE = """
model M
  coordinate Length a, b;
  point P = {b, -a, 0};
  point Q = {-a, -a, 0};
  point R = {b + 2*a, b, 0};
  body on = Particle(mass = 1 [kg], at = R);
  point there = P + {a, -a, 0} + (Q - P);  // a moves it along y alone
  force f = (-1 [N.s/m])*velocity(there) at there;
  constraint c: dot(there - R, {1, 0, 0}) = 0.1 [m];
end M;
"""


def test_a_sum_whose_terms_cancel_is_no_unknown() -> None:
    e = large.equations(NOWHERE, 0)
    state = consistent_state(e, 5)
    assert state is not None
    wanted, condition = dense(e, state)
    for solver in solvers(e):
        found = run(e, solved(e, solver), state)[: len(wanted)]
        assert np.abs(found - wanted).max() <= 1e-15 * condition * np.abs(wanted).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize("family", large.LOOPS)
def test_loops_are_solved_to_rounding(family: str) -> None:
    e = large.equations(large.LOOPS[family], 6)
    state = consistent_state(e, 5)
    assert state is not None
    wanted, condition = dense(e, state)
    for solver in solvers(e):
        found = run(e, solved(e, solver), state)[: len(wanted)]
        error = np.abs(found - wanted).max() / np.abs(wanted).max()
        assert error <= 1e-15 * condition


def costs(text: str, sizes: Sequence[int]) -> list[int]:
    found = []
    for n in sizes:
        e = large.equations(text, n)
        found.append(solved(e, lifted_alone(e))[0].cost)
    return found


MOST = {  # operations of one more link or body, with the pivots watched
    "chain": 60, "relative": 90, "rods": 120, "spherical": 191, "balls_relative": 1000, "balls": 420,
    "tree": 55,
}  # fmt: skip


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("family", MOST)
def test_work_grows_as_the_number_of_bodies(family: str) -> None:
    text = large.TREES[family]
    sizes = (31, 63, 127) if family == "tree" else (20, 30, 40)
    found = costs(text, sizes)
    steps = [(b - a) / (m - n) for (n, a), (m, b) in pairwise(zip(sizes, found))]
    assert steps[0] <= MOST[family]
    assert steps[1] <= 1.05 * steps[0]


INSIDE = {  # forces of a parameter that is for nothing else, some of which cancel where they are put together
    "a pair along a rod": "force a[i] = -f*F[i].z at P[i-1];\n    force b[i] = f*F[i].z at P[i];",
    "a pair at a point": "force a[i] = f*F[i].x at P[i];\n    force b[i] = -f*F[i].x at P[i];",
    "against what holds": "force a[i] = f*F[1].z at P[1];",
}


@pytest.mark.full
@pytest.mark.parametrize("inside", INSIDE)
@pytest.mark.parametrize("n", [3, 24])
def test_forces_that_cancel_move_nothing(inside: str, n: int) -> None:
    text = large.RELATIVE.replace("structural Integer n = 5", f"structural Integer n = {n}")
    acting = text.replace("    body bob[i]", f"    {INSIDE[inside]}\n    body bob[i]")
    acting = acting.replace("  parameter Mass m", "  parameter Force f = 3 [N];\n  parameter Mass m", 1)
    assert "f*F" in acting
    with_force, without = [lagc.loads(one).compile(backend="numpy") for one in (acting, text)]
    rates = [system.rhs(0.0, without.start()) for system in (with_force, without)]
    np.testing.assert_allclose(*rates, rtol=0.0, atol=1e-11 * max(abs(rates[1])))


def test_a_health_tells_of_a_speed_without_inertia() -> None:
    """The last link has no mass: its pivot is what rounding leaves."""
    e = large.equations(large.WEIGHTED, 6)
    state = random_state(e, 1)
    state.update((p.symbol, 0.0) for p in e.model.parameters if p.name in ("tip", "m"))
    state.update((p.symbol, 1.0) for p in e.model.parameters if p.name == "tip")
    health = run(e, solved(e, lifted_alone(e)), state)[-2]
    assert not health > 1e-13


@pytest.mark.full
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_code_without_a_mass_matrix_tells_what_it_cannot_solve(backend: str) -> None:
    """Nothing dense is there to ask: statuses come from the pivots and from what is not finite."""
    made = lagc.loads(large.CHAIN).compile(parameters={"n": 25}, backend=backend)
    assert "system" not in made.program.functions
    system = made.system
    size = system.nx
    xdot, lam = [0.0] * size, [0.0]
    assert system.rhs(0.0, [0.1 * (k % 5) for k in range(size)], xdot, lam) == OK
    assert system.rhs(0.0, [math.nan] * size, xdot, lam) == NOT_FINITE
    massless = made.bind({"m": 0.0}).system
    assert massless.rhs(0.0, [0.1 * (k % 5) for k in range(size)], xdot, lam) in (SINGULAR_MASS, NOT_FINITE)
    with pytest.raises(Refused, match="singular"):
        made.simulate(1.0, parameters={"m": 0.0})


ATTRACTING = """
model M
  structural Integer n = 5;
  parameter Mass m = 1 [kg];
  coordinate Length x[n], y[n];
  for i in 1:n loop
    body b[i] = Particle(mass = m, at = {x[i], y[i], 0});
    for j in 1:i-1 loop
      potential V[i, j] = -(1 [N.m2.kg-2])*m^2/norm(position(b[i]) - position(b[j]));
    end for;
  end for;
end M;
"""


@pytest.mark.full
def test_many_forces_make_no_solve_dense() -> None:
    """Operations for each pair of bodies, with a mass matrix that is diagonal."""
    found = []
    for n in (10, 20, 30):
        program = pipeline.optimize(large.equations(ATTRACTING, n), work=False)
        assert program.interface.solve == "straight"
        found.append(program.interface.operations / (n * (n - 1) / 2))
    assert max(found) <= 15.0  # the distance takes 9, the force on both 6
