"""Contacts that just touch: along a chain, indicators leave zero one after the other, and grow by powers
that dense output does not represent."""

from math import cos

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("own_cache")

CHAIN = """model Chain
  structural Integer n = 5;
  parameter Stiffness k = 1e6 [N/m];
  parameter Velocity last = 0 [m/s];
  coordinate Length u[n](each start = {start} [m]);
  for i in 1:n loop
    body p[i] = Particle(mass = 1 [kg], at = {{u[i] + 0.1 [m]*i, 0, 0}});
  end for;
  for i in 1:n-1 loop
    potential V[i] = {potential};
  end for;
  scene go
    start der(u[1]) = 1 [m/s];
    start der(u[n]) = last;
    simulate(stop = 0.1 [s]);
  end go;
end Chain;"""
BALLS = "k/2*max(u[i] - u[i+1], 0 [m])^2"
BRANCHES = "(if u[i] > u[i+1] then k/2*(u[i] - u[i+1])^2 else 0 [J])"
ROPE = "k/2*max(u[i+1] - u[i], 0 [m])^2"


def chain(n: int, potential: str = BALLS, start: float = 0.0) -> lagc.CompiledModel:
    text = CHAIN.format(potential=potential, start=start)
    return lagc.loads(text).compile(backend="numpy", parameters={"n": n})


def truth(n: int, last: float = 0.0, sign: float = 1.0) -> list[float]:
    """The speeds in the end."""

    def rates(_: float, x: np.ndarray) -> np.ndarray:
        force = sign * 1e6 * np.maximum(sign * (x[: n - 1] - x[1:n]), 0.0)
        return np.concatenate([x[n:], -np.append(force, 0.0) + np.append(0.0, force)])

    begin = np.zeros(2 * n)
    begin[n], begin[-1] = 1.0, last or begin[-1]
    found = solve_ivp(rates, (0.0, 0.1), begin, method="DOP853", rtol=1e-12, atol=1e-16, max_step=5e-5)
    return list(found.y[n:, -1])


def speeds(run: Run, n: int) -> list[float]:
    assert run.status == "ok", run.message
    return [float(run[f"der(u[{i}])"][-1]) for i in range(1, n + 1)]


@pytest.mark.full
@pytest.mark.parametrize(("start", "potential"), [(0.0, BALLS), (0.1, BALLS), (0.0, BRANCHES)])
@pytest.mark.parametrize("n", [3, 5, 8, 20])
def test_a_row_of_balls_is_hit(n: int, start: float, potential: str) -> None:
    run = chain(n, potential, start).simulate()
    assert speeds(run, n) == pytest.approx(truth(n), abs=2e-6)
    assert sum(speeds(run, n)) == pytest.approx(1.0, abs=1e-13)
    assert abs(run.energy.imbalance) < 1e-7
    assert run.cost.rhs < 1_500 * n and len(run.events) == 2 * n - 3


@pytest.mark.full
@pytest.mark.parametrize("start", [0.0, 0.1])
@pytest.mark.parametrize("method", ["dop853", "dopri5"])
def test_it_errs_by_what_was_asked(method: str, start: float) -> None:
    known = truth(10)
    system = chain(10, start=start)
    for rtol in (1e-4, 1e-7, 1e-10):
        run = system.simulate(method=method, rtol=rtol)
        assert speeds(run, 10) == pytest.approx(known, abs=20.0 * rtol)
        assert run.cost.rhs < 6_000


@pytest.mark.full
@pytest.mark.parametrize("n", [4, 7, 12])
def test_balls_are_hit_from_both_sides(n: int) -> None:
    """What comes out is as symmetrical as what goes in."""
    run = chain(n).simulate(parameters={"last": -1.0})
    found = speeds(run, n)
    assert found == [-v for v in reversed(found)]
    assert found == pytest.approx(truth(n, -1.0), abs=2e-6)


@pytest.mark.full
@pytest.mark.parametrize("n", [6, 12])
def test_a_rope_that_is_just_slack_is_pulled(n: int) -> None:
    run = chain(n, ROPE).simulate(parameters={"last": 2.0})
    assert speeds(run, n) == pytest.approx(truth(n, 2.0, -1.0), abs=5e-6)
    assert sum(speeds(run, n)) == pytest.approx(3.0, abs=1e-12)


HERTZ = """model Cradle
  structural Integer n = 5;
  parameter Force k(min = 0) = 1e6 [N];
  parameter Length d(min = 0) = 0.1 [m], gap = 0 [m];
  coordinate Length u[n];
  for i in 1:n loop
    body p[i] = Particle(mass = 1 [kg], at = {{u[i] + i*(d + gap), 0, 0}});
  end for;
  for i in 1:n-1 loop
    force left[i] = {{-k*{law}, 0, 0}} at p[i];
    force right[i] = {{k*{law}, 0, 0}} at p[i+1];
  end for;
  scene go
    start der(u[1]) = 1 [m/s];
    simulate(stop = 0.1 [s]);
  end go;
end Cradle;"""
WAY = "(u[i] - u[i+1] - gap)/d"
LAWS = {
    "max": "max(0, {way})^{power}",
    "outside": "(max(0 [m], u[i] - u[i+1] - gap)/d)^{power}",
    "if": "(if u[i] - u[i+1] > gap then ({way})^{power} else 0)",
    "abs": "max(0, sign({way}))*abs({way})^{power}",
    "other side": "(if u[i+1] - u[i] + gap < 0 then ({way})^{power} else 0)",
    "share": "(if {way} > 0 then ({way})^{power} else 0)",
    "least": "(-min(0 [m], u[i+1] - u[i] + gap)/d)^{power}",
}


def cradle(n: int, law: str, power: float) -> lagc.CompiledModel:
    text = HERTZ.format(law=LAWS[law].format(way=WAY, power=power))
    return lagc.loads(text).compile(backend="numpy", parameters={"n": n})


def cradle_truth(n: int, power: float, gap: float) -> list[float]:
    def rates(_: float, x: np.ndarray) -> np.ndarray:
        force = 1e6 * np.maximum((x[: n - 1] - x[1:n] - gap) / 0.1, 0.0) ** power
        return np.concatenate([x[n:], -np.append(force, 0.0) + np.append(0.0, force)])

    begin = np.zeros(2 * n)
    begin[n] = 1.0
    found = solve_ivp(rates, (0.0, 0.1), begin, method="DOP853", rtol=1e-12, atol=1e-15, max_step=2e-4)
    return list(found.y[n:, -1])


@pytest.mark.full
@pytest.mark.parametrize("gap", [0.0, 1e-6, 1e-4])
@pytest.mark.parametrize("power", [1.5, 2.5])
def test_a_cradle_of_many_balls(power: float, gap: float) -> None:
    """Forces that are no whole power of the way: none below zero, where sides are by rounding."""
    run = cradle(20, "max", power).simulate(parameters={"gap": gap})
    assert speeds(run, 20) == pytest.approx(cradle_truth(20, power, gap), abs=2e-6)
    assert run.cost.rhs < 80_000


@pytest.mark.sample(1)
@pytest.mark.parametrize("law", sorted(LAWS))
def test_however_the_force_is_written(law: str) -> None:
    run = cradle(4, law, 1.5).simulate(parameters={"gap": 1e-4})
    assert speeds(run, 4) == pytest.approx(cradle_truth(4, 1.5, 1e-4), abs=2e-6)


def test_a_power_of_what_is_negative_is_still_refused() -> None:
    """The sign that is asked for is no reason to go on where there is no force."""
    text = (
        "model S\n  coordinate Length x(start = 1 [m]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        "  force f = {-1 [N]*sign(x)*(x/1 [m])^1.5, 0, 0} at b;\nend S;"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(5.0)
    assert run.status == "failed" and "not a finite number" in run.message


FLOOR = """model Floor
  coordinate Length z;
  body b = Particle(mass = 1 [kg], at = {0, 0, z});
  potential V = 1e4 [N/m]/2*max(-z, 0 [m])^2;
  force f = {0, 0, if time > 0.5 [s] then -1 [N] else 0 [N]} at b;
end Floor;"""


def test_what_rests_on_a_floor_is_pressed_into_it() -> None:
    """It rises to where it just touches, in each swing."""
    run = lagc.loads(FLOOR).compile(backend="numpy").simulate(2.0, accuracy=1e-7)
    assert run.status == "ok", run.message
    for t, z in zip(run.t, run["z"]):
        assert z == pytest.approx(-1e-4 * (1.0 - cos(100.0 * max(t - 0.5, 0.0))), abs=1e-10)


@pytest.mark.parametrize("push", ["1 [N]", "(if time > 2 [s] then 1 [N] else 0 [N])"])
def test_friction_that_holds_is_still_told(push: str) -> None:
    text = (
        "model S\n  coordinate Length x(rate = 1 [m/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        f"  force f = {{{push} - 2 [N]*sign(der(x)), 0, 0}} at b;\nend S;"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(3.0)
    assert run.status == "failed" and "drive the motion back" in run.message


BLOCKS = """model Blocks
  parameter Stiffness k = 1e7 [N/m];
  coordinate Length z1(start = 0.1 [m]), z2(start = 0.2 [m]), z3(start = 0.3 [m]);
  body b1 = Particle(mass = 1, at = {0, 0, z1});
  body b2 = Particle(mass = 4, at = {0, 0, z2});
  body b3 = Particle(mass = 9, at = {0, 0, z3});
  potential c1 = k/2*max(0, 0.1 [m] - z1)^2;
  potential c2 = k/2*max(0, z1 + 0.1 [m] - z2)^2;
  potential c3 = k/2*max(0, z2 + 0.1 [m] - z3)^2;
  Gravity g;
end Blocks;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("stiffness", (1e5, 1e7, 1e9))
def test_blocks_that_just_touch_begin_to_fall(stiffness: float) -> None:
    """From a stack that is pressed by nothing, as a linear system of compressions while all are: its closed
    form by eigenvectors.  Rounding has each of the heights on the wrong side at first."""
    stop = 10.0 / np.sqrt(stiffness)  # nothing parts before
    run = (
        lagc.loads(BLOCKS)
        .compile(backend="numpy")
        .simulate(stop=stop, parameters={"k": stiffness}, accuracy=1e-5)
    )
    assert run.status == "ok", run.message
    masses = np.diag([1.0, 4.0, 9.0])
    springs = stiffness * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    squares, ways = eigh(springs, masses)
    modal = ways.T @ masses @ np.full(3, -9.81)
    exact = ways @ (modal * np.sin(np.sqrt(squares) * stop) / np.sqrt(squares))
    speeds = [run[f"der(z{i})"][-1] for i in (1, 2, 3)]
    assert speeds == pytest.approx(exact, abs=1e-5 * max(abs(exact)))


PUSHED = """model Row
  parameter Mass m[4] = {0.502, 8.56, 1, 1};
  parameter Time T = 0.415 [s];
  coordinate Length x[4];
  for i in 1:4 loop
    body b[i] = Particle(mass = m[i], at = {x[i], 0, 0});
  end for;
  for i in 1:3 loop
    potential c[i] = 1/2*(1 [N/m])*max(0, abs(x[i] - x[i+1]))^2;
  end for;
  force f = {if time > T then 1 [N] else 0 [N], 0, 0} at b[1];
end Row;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("accuracy", [1e-3, 1e-4, 1e-6, 1e-9])
def test_a_row_at_rest_is_pushed(accuracy: float) -> None:
    """All begins to move at T, by powers of the time; the first attempt at a step is far too long, explodes,
    and tells nothing of how large states become.  By eigenvectors, as the contacts are springs."""
    run = lagc.loads(PUSHED).compile(backend="numpy").simulate(stop=20.415, accuracy=accuracy)
    assert run.status == "ok", run.message
    masses, springs = np.diag([0.502, 8.56, 1.0, 1.0]), np.diag([1.0, 2.0, 2.0, 1.0])
    springs -= np.diag(np.ones(3), 1) + np.diag(np.ones(3), -1)
    squares, ways = eigh(springs, masses)
    modal, roots = ways[0], np.sqrt(np.abs(squares[1:]))
    exact = modal[0] * ways[:, 0] * 20.0 + ways[:, 1:] @ (modal[1:] * np.sin(roots * 20.0) / roots)
    speeds = [run[f"der(x[{i}])"][-1] for i in (1, 2, 3, 4)]
    assert speeds == pytest.approx(exact, abs=accuracy * max(abs(exact)))
    assert max(abs(np.array(speeds) - exact)) <= 3.0 * run.estimated * max(abs(exact))
