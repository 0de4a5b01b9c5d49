"""Bodies that keep their velocities as unknowns with pivots of their own: the same motion as the dense system
in 50 digits, in work that grows as the model does, however many loops it has."""

from itertools import pairwise

import numpy as np
import pytest

import lagc
from lagc.base.records import replace
from lagc.lowering.kkt.articulated_body import articulated_body
from lagc.lowering.kkt.fill_ordering import eliminate
from lagc.lowering.kkt.solve import Solver, solvers
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from tests.lowering import large
from tests.lowering.test_lifted_equations import dense, run, solved
from tests.mechanics.numbers import consistent_state
from tests.mechanics.random_systems import random_system

HEAVY = {
    "even": large.LADDER,
    "at the end": large.LADDER.replace(
        "  effect", "  body tip = Particle(mass = 1e6*m, at = P[n]);\n  effect", 1
    ),
    "every other": large.LADDER.replace("mass = m,", "mass = m*(1 + 1e6*(i - 2*floor(i/2))),"),
    "closed": large.CLOSED,
    "measured": large.LADDER.replace(  # by what has no mass
        "  effect",
        "  coordinate Length s(start = 1);\n  constraint measure: s = dot(P[2], {3/5, 0, 4/5});\n  effect",
        1,
    ),
}
BESIDE = """
  coordinate Length p, q;
  for k in 1:2 loop
    body tip[k] = Particle(mass = m, at = {0.3*p + 0.7*q, 0, 0});
  end for;
  potential spring = 50[N/m]*(p - 0.3[m])^2;
  constraint hold: p = 0.1[m]*sin(q/1[m]);
"""


def keeping(e: EquationsOfMotion) -> Solver | None:
    """All velocities of bodies that can be kept are; None where there are none."""
    system = articulated_body(e)
    if system is None or not system.heavy:
        return None
    plan = eliminate(replace(system.structure, kept=system.heavy))
    assert plan is not None
    return Solver(system, plan)


@pytest.mark.sample(1, 10)
@pytest.mark.parametrize("seed", range(60))
def test_random_systems(seed: int) -> None:
    e = derive(random_system(seed))
    solver, state = keeping(e), consistent_state(e, seed)
    if solver is None or state is None:
        return
    wanted, condition = dense(e, state)
    *found, health, left = run(e, solved(e, solver), state)
    assert 0.0 <= left < 1e-16
    assert left <= (20.0 * 2.0**-53 / health) ** 2
    assert np.abs(found - wanted).max() <= 1e-14 * condition / min(abs(health), 1.0) * np.abs(wanted).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", [3, 4, 9])
@pytest.mark.parametrize("masses", HEAVY)
def test_loops(masses: str, n: int) -> None:
    """Accelerations as good as those without; the pivots show the uneven masses at most."""
    e = large.equations(HEAVY[masses], n)
    solver, state = keeping(e), consistent_state(e, 5)
    assert solver is not None and state is not None
    wanted, condition = dense(e, state)
    *found, health, left = run(e, solved(e, solver), state)
    assert health > (1e-4 if masses in ("even", "closed", "measured") else 1e-8)
    assert left < 1e-16
    assert np.abs(found - wanted).max() <= 1e-15 * condition * np.abs(wanted).max()


@pytest.mark.full
def test_work_grows_as_the_number_of_loops() -> None:
    """Of a ladder, whose rungs close a loop each; the form that is taken."""
    found = []
    for n in (20, 30, 40):
        e = large.equations(large.LADDER, n)
        found.append(min(solved(e, solver)[0].cost for solver in solvers(e)))
    steps = [(b - a) / 10 for a, b in pairwise(found)]
    assert steps[0] <= 530
    assert steps[1] <= 1.05 * steps[0]


@pytest.mark.full
@pytest.mark.parametrize("text", [large.STRIP, large.TRAILERS], ids=["strip", "trailers"])
def test_work_grows_as_the_number_of_rows(text: str) -> None:
    """Of particles and rods alone no velocity is shared, and nothing is lifted; trailers that do not slip are
    held where their masses are not, and move with that."""
    found = []
    for n in (20, 40, 60):
        e = large.equations(text, n)
        found.append(min(solved(e, solver)[0].cost for solver in solvers(e)))
    assert found[2] - found[1] == pytest.approx(found[1] - found[0], rel=0.02)


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", [3, 9])
def test_trailers_are_solved_to_rounding(n: int) -> None:
    e = large.equations(large.TRAILERS, n)
    state = consistent_state(e, 5)
    assert state is not None
    wanted, condition = dense(e, state)
    for solver in solvers(e):
        *found, health, left = run(e, solved(e, solver), state)
        assert left <= (20.0 * 2.0**-53 / health) ** 2
        assert np.abs(found - wanted).max() <= 1e-15 * condition * np.abs(wanted).max()


@pytest.mark.full
@pytest.mark.parametrize("n", [4, 20])
def test_a_speed_that_rows_alone_give_a_mass_is_watched(n: int) -> None:
    """Beside a ladder; the mass matrix of p and q has rank one.  At rest in q = 0, p = sin(q)/10 leaves
    2 m (0.3 dp/dq + 0.7)^2 q'' = dp/dq k (0.3 - p)."""
    text = large.LADDER.replace("  effect", BESIDE + "  effect", 1)
    system = lagc.loads(text).compile(parameters={"n": n}, backend="numpy")
    xdot = system.rhs(0.0, system.start())
    place = system.interface.nq + system.interface.v_names.index("der(q)")
    assert xdot[place] == pytest.approx(0.1 * 100.0 * 0.3 / (2.0 * (0.03 + 0.7) ** 2), rel=1e-10)


def test_what_has_no_mass_is_not_kept() -> None:
    system = articulated_body(
        large.equations(large.LADDER.replace("(min = 0) = 1 [kg]", "(min = 0) = 0 [kg]"), 4)
    )
    assert system is not None and not system.heavy
