"""Reasons are told where they were found, and only there; what is out of balance is not called good."""

from math import cos, pi, sin
from random import Random

import pytest

import lagc
from lagc.api import Run
from lagc.simulation.global_error.energy_balance import balance
from lagc.simulation.request import Request
from lagc.simulation.simulate import simulate
from lagc.simulation.system import OK, STEP_UNDERFLOW, Options, Trajectory, Vector
from lagc.simulation.verdict import UNKNOWN, verdict
from tests.interfaces import interface
from tests.simulation.systems import LINE, DoublePendulum, Handmade, Oscillator

pytestmark = pytest.mark.usefixtures("no_cache")

LINE_MODEL = """model M
  coordinate Length x(start = {x} [m], rate = {v} [m/s], fixed = true);
  body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
  {action}
end M;"""
REASONS = {"without bound": "singular", "stiff": "stiff", "drive the motion back": "not smooth",
           "chaotic": "chaotic",
           "round-off": "rounding", "depends on others": "rank"}  # fmt: skip


def reasons(message: str) -> set[str]:
    return {name for words, name in REASONS.items() if words in message}


def told(action: str, x: float, v: float, stop: float, accuracy: float = 1e-6) -> Run:
    model = lagc.loads(LINE_MODEL.format(x=x, v=v, action=action)).compile(backend="numpy")
    return model.simulate(stop, accuracy=accuracy, points=101)


@pytest.mark.parametrize(
    ("action", "v", "end"),
    [
        ("potential V = -1 [J.m]/x;", 0.0, pi / 8.0**0.5),  # free fall into a centre
        ("potential V = -1/2*1 [J.m2]/x^2;", 0.0, 1.0),  # x^2 = 1 - t^2
        ("potential V = -1 [J]*(x/(1 [m]))^4;", 2.0**0.5, 1.0 / 2.0**0.5),  # x' = sqrt(2) x^2
        ("potential V = -1 [J]*exp(x/(1 [m]));", (2.0 * 2.718281828459045) ** 0.5, 0.857763884960707),
    ],
)
def test_a_singularity_is_found_at_its_time(action: str, v: float, end: float) -> None:
    run = told(action, 1.0, v, 3.0)
    assert run.status == "failed" and reasons(run.message) == {"singular"}, run.message
    assert abs(float(run.message.split("t = ")[1].split(" s")[0]) - end) < 1e-4


def test_forces_that_jump_to_and_fro_are_found() -> None:
    # friction that brings to rest, and then pushes to both sides in turn
    friction = "force F = (0.5 [N] - 1.0 [N]*sign(der(x)))*world.x at b;"
    system = lagc.loads(LINE_MODEL.format(x=0, v=1, action=friction)).compile(backend="numpy").load("numpy")
    run = system.integrate(
        Options("dop853", 1e-9, 1e-9, max_steps=1000), 0.0, [0.0, 1.0, 0.0], [0.0, 0.5, 2.0]
    )
    assert reasons(verdict(system, run, 2.0)[1]) == {"not smooth"}


@pytest.mark.full
def test_exponential_growth_is_found() -> None:
    run = simulate(DoublePendulum(), Request(stop=60.0, accuracy=1e-6))
    assert run.status == "failed" and reasons(run.message) == {"chaotic"}, run.message


class Stiff(Handmade):
    """x follows cos t within a thousandth of a millionth of a second."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def start(self) -> list[float]:
        return [1.0, 0.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[:] = [x[1], -1e4 * (x[1] + sin(t)) - cos(t)]
        return OK


def test_stiffness_is_found() -> None:
    system = Stiff()
    run = system.integrate(Options("dop853", 1e-6, 1e-6, max_steps=2000), 0.0, [1.0, 0.0], [0.0, 10.0])
    assert reasons(verdict(system, run, 10.0)[1]) == {"stiff"}


@pytest.mark.parametrize("t", [0.3, 1.1, 2.9])
def test_no_reason_is_told_of_a_plain_motion(t: float) -> None:
    # a run of an oscillator that is said to have ended, and of one with forces that bend
    times = [0.03 * t * k for k in range(34)]
    states = [[cos(s), -sin(s)] for s in times]
    run = Trajectory(times, states, times[-1], states[-1], STEP_UNDERFLOW, steps=30)
    status, message = verdict(Oscillator(), run, 5.0)
    assert status == "failed" and reasons(message) == set() and message.endswith(UNKNOWN)


class Leaking(Handmade):
    """An oscillator that loses energy of which its balance knows nothing: as where something is not seen."""

    def __init__(self, damping: float, known: float = 0.0) -> None:
        super().__init__(interface(**LINE))
        self.damping, self.known = damping, known

    def start(self) -> list[float]:
        return [1.0, 0.0]

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[:] = [x[1], -x[0] - self.damping * x[1]]
        return OK

    def energies(self, t: float, x: Vector) -> list[float]:
        e = 0.5 * x[0] * x[0] + 0.5 * x[1] * x[1]
        return [0.5 * x[1] * x[1], 0.5 * x[0] * x[0], 1e6 + e]  # an offset says nothing


@pytest.mark.sample(4)
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("share", [1e-3, 0.1, 100.0, 1e4])
def test_energy_out_of_balance_is_never_ok(accuracy: float, share: float) -> None:
    # after 10 s the energy has lost about 5 times the damping; errors of the states explain 20 times A
    run = simulate(Leaking(share * accuracy), Request(stop=10.0, accuracy=accuracy))
    if share < 1.0:
        assert run.status == "ok", run.message
    else:
        assert run.status == "failed" and "out of balance" in run.message
        assert reasons(run.message) == set()


def fall(seed: int, more: str) -> tuple[Run, float]:
    """A motion about the origin with a term `more` of the potential, and that term's height."""
    chance = Random(seed)
    height, x, w = chance.uniform(0.02, 0.05), chance.uniform(0.7, 1.0), chance.uniform(0.7, 1.0)
    model = f"""model M
      coordinate Length x(start = {x!r} [m]), y(rate = {w!r} [m/s]);
      body p = Particle(mass = 1 [kg], at = {{x, y, 0}});
      potential V = 1/2*1 [N/m]*(x^2 + y^2) + {height!r} [J]*{more};
    end M;"""
    return lagc.loads(model).compile(backend="numpy").simulate(4.0, points=400), height


@pytest.mark.parametrize("seed", range(3))
def test_an_energy_that_jumps_is_out_of_balance(seed: int) -> None:
    """An angle passes its cut."""
    run, _ = fall(seed, "atan2(y, x)")
    assert run.status == "failed" and "out of balance" in run.message and "the energy jumps" in run.message


@pytest.mark.parametrize("seed", range(3))
def test_a_step_that_is_narrower_than_any_of_the_run_is_none_of_these(seed: int) -> None:
    """It is found: the speed along x takes up what it is high, and y never knows of it."""
    run, height = fall(seed, "tanh(x/(1e-9 [m]))")
    assert run.status == "ok", run.message
    start, w = run.states[0][0], run.states[0][3]
    for t, (_, y, _, speed, *_) in zip(run.times, run.states):
        assert y == pytest.approx(w * sin(t), abs=1e-5) and speed == pytest.approx(w * cos(t), abs=1e-5)
    energies = [0.5 * (x[0] ** 2 + x[2] ** 2) + (height if x[0] > 0.0 else -height) for x in run.states]
    assert energies == pytest.approx([0.5 * start**2 + height] * len(energies), abs=1e-5)


def test_the_library_is_in_balance_by_far() -> None:
    for name in ("classic/kapitza_pendulum", "course/disc_on_a_line_implicit", "classic/knife_edge"):
        model = lagc.load(name).compile(backend="numpy")
        for accuracy in (1e-4, 1e-6):
            run = model.simulate(1.0, accuracy=accuracy, points=51)
            assert run.status == "ok", run.message
            trajectory = Trajectory(run.times, run.states, run.times[-1], run.states[-1])
            out = balance(run.system, trajectory, list(run.scales.values()), accuracy)
            assert out.imbalance < 0.1 * out.explained, name


def test_a_potential_that_jumps_in_time_does_work() -> None:
    run = told("potential V = if time < 0.7 [s] then 0 else 1/2*9 [N/m]*x^2;", 1.0, 0.5, 2.0)
    assert run.status == "ok", run.message
    x0 = 1.0 + 0.5 * 0.7
    end = x0 * cos(3.0 * 1.3) + 0.5 / 3.0 * sin(3.0 * 1.3)
    assert abs(run.states[-1][0] - end) < 2e-6
    assert abs(run.energy.imbalance) < 1e-4


@pytest.mark.full
def test_what_doubles_cannot_tell_is_no_fault_of_the_model() -> None:
    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(1.0, accuracy=1e-18)
    assert run.status == "failed" and run.estimated is not None
    assert "double precision" in run.message and "ill-conditioned" not in run.message
    limit = f"about {run.estimated:.0e} can be reached, and more by the code of `lagc build --real quad`"
    assert limit in run.message
