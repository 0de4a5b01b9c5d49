"""Clauses `when` of mechanisms, in Cartesian coordinates with rows: pendulums on pivots that move are thrown
back, or braked and driven on at one moment; against their one angle by SciPy. Clauses that act at one
moment: balls of one mass that meet from both sides pass their speeds on."""

from collections.abc import Callable, Sequence
from math import asin, cos, hypot, pi, sin, sqrt
from random import Random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

STOP, POINTS, GRAVITY = 2.0, 9, 9.81
Condition = Callable[[float, float, float], float]  # true where positive: of time, angle and its rate
Action = Callable[[float, float, float], float]  # the rate behind it


class Pendulum:
    """theta'' = -(g sin theta + a cos theta)/l, where the pivot moves along x with acceleration a."""

    def __init__(self, chance: Random):
        self.l, self.A = chance.uniform(0.5, 1.5), chance.uniform(0.05, 0.2)
        self.W, self.theta, self.rate = (chance.uniform(*r) for r in ((2.0, 6.0), (-0.9, 0.9), (1.0, 3.0)))

    def text(self, clauses: str) -> str:
        pivot, speed = (
            f"{self.A!r}*sin({self.W!r}*time/(1 [s]))",
            f"{self.A * self.W!r}*cos({self.W!r}*time/(1 [s]))",
        )
        c, s = self.l * cos(self.theta), self.l * sin(self.theta)
        return f"""model M
          coordinate Length x(start = {s!r} [m], rate = {self.A * self.W + c * self.rate!r} [m/s]),
            z(start = {-c!r} [m], rate = {s * self.rate!r} [m/s]);
          body b = Particle(mass = 1 [kg], at = {{x, 0, z}});
          force weight = {{0, 0, -{GRAVITY} [N]}} at b;
          constraint rod: (x - {pivot}*1 [m])^2 + z^2 = {self.l!r}^2*1 [m2];
          {clauses.replace("PIVOT", pivot).replace("SPEED", f"{speed}*1 [m/s]")}
        end M;"""

    def rates(self, t: float, y: Sequence[float]) -> list[float]:
        a = -self.A * self.W**2 * sin(self.W * t)
        return [y[1], -(GRAVITY * sin(y[0]) + a * cos(y[0])) / self.l]

    def position(self, t: float, y: Sequence[float]) -> tuple[float, float]:
        return self.A * sin(self.W * t) + self.l * sin(y[0]), -self.l * cos(y[0])

    def truth(
        self, clauses: Sequence[tuple[Condition, Action]]
    ) -> tuple[list[float], list[tuple[float, float]]]:
        """The times at which clauses act, and the positions at the recorded times."""
        t, y, acted, places = 0.0, [self.theta, self.rate], list[float](), list[tuple[float, float]]()
        held = [condition(t, *y) > 0.0 for condition, _ in clauses]
        times = np.linspace(0.0, STOP, POINTS)
        while True:
            sides = []
            for condition, _ in clauses:

                def side(t: float, y: Sequence[float], condition: Condition = condition) -> float:
                    return condition(t, *y)

                side.terminal = True  # type: ignore[attr-defined]
                sides.append(side)
            for side, now in zip(sides, held):
                side.direction = -1.0 if now else 1.0  # type: ignore[attr-defined]
            run = solve_ivp(self.rates, (t, STOP), y, "DOP853", events=sides, dense_output=True,
                            rtol=1e-12, atol=1e-13, max_step=0.02)  # fmt: skip
            places += [
                self.position(u, run.sol(u)) for u in times if t <= u < run.t[-1] or u == run.t[-1] == STOP
            ]
            if run.status != 1:
                return acted, places
            t, y = float(run.t[-1]), [float(a) for a in run.y[:, -1]]
            due = [bool(len(found)) and not now for found, now in zip(run.t_events, held)]
            held = [now != bool(len(found)) for found, now in zip(run.t_events, held)]
            while any(due):
                for k, (_, action) in enumerate(clauses):
                    if due[k]:
                        y[1] = action(t, *y)
                        acted.append(t)
                sides_now = [condition(t, *y) for condition, _ in clauses]
                now = [was if abs(a) < 1e-9 else a > 0.0 for a, was in zip(sides_now, held)]
                due = [is_now and not was for is_now, was in zip(now, held)]
                held = now
            soon = [a + 1e-7 * rate for a, rate in zip(y, self.rates(t, y))]  # a side at zero goes on from it
            held = [condition(t + 1e-7, *soon) > 0.0 for condition, _ in clauses]


def judged(pendulum: Pendulum, text: str, clauses: Sequence[tuple[Condition, Action]]) -> int:
    acted, places = pendulum.truth(clauses)
    model = lagc.loads(text).compile(backend="numpy")
    for accuracy in (1e-4, 1e-5, 1e-8):
        run = model.simulate(STOP, accuracy=accuracy, points=POINTS)
        assert run.status == "ok" and run.estimated is not None, run.message
        assert len(run.events) == len(acted), (accuracy, run.events, acted)
        size = max(max(map(abs, place)) for place in places)
        off = max(
            abs(a - b) for x, z, place in zip(run["x"], run["z"], places) for a, b in zip((x, z), place)
        )
        assert off <= run.estimated * size + 1e-10, (accuracy, off, run.estimated)
    return len(acted)


@pytest.mark.full
def test_on_pivots_that_move() -> None:
    """Thrown back relative to the pivot, at a place and at an angle; each once."""
    found = 0
    for seed in range(16):
        chance = Random(seed)
        pendulum, e, X = Pendulum(chance), chance.uniform(0.3, 0.9), chance.uniform(0.2, 0.5)
        away = "x" if seed % 2 else "(x - PIVOT*1 [m])"
        back = f"{{SPEED - {e!r}*(der(x) - SPEED), -{e!r}*der(z)}}"
        text = pendulum.text(f"when {away} > {X!r} [m] then reinit({{der(x), der(z)}}, {back}); end when;")

        def beyond(
            t: float,
            angle: float,
            rate: float,
            p: Pendulum = pendulum,
            X: float = X,
            all_: bool = seed % 2 == 1,
        ) -> float:
            return p.position(t, [angle])[0] - X if all_ else p.l * sin(angle) - X

        found += judged(pendulum, text, [(beyond, lambda t, angle, rate, e=e: -e * rate)])
    assert found > 6


@pytest.mark.full
def test_what_one_makes_another_do() -> None:
    """Braked at a place, which makes it slow, which drives it on: each once."""
    found = 0
    for seed in range(6):
        chance = Random(seed)
        pendulum = Pendulum(chance)
        X, q, slow, add = (chance.uniform(*r) for r in ((0.2, 0.45), (0.2, 0.4), (0.8, 1.0), (0.7, 1.5)))
        text = pendulum.text(
            f"when x - PIVOT*1 [m] > {X!r} [m] then\n"
            f"  reinit({{der(x), der(z)}}, {{SPEED + {q!r}*(der(x) - SPEED), {q!r}*der(z)}}); end when;\n"
            f"when (der(x) - SPEED)^2 + der(z)^2 < {(slow * pendulum.l) ** 2!r}*1 [m2/s2] then\n"
            f"  reinit({{der(x), der(z)}}, {{der(x), der(z)}} + {add!r}*1 [1/s]*{{-z, x - PIVOT*1 [m]}});\n"
            "end when;"
        )

        def beyond(t: float, angle: float, rate: float, p: Pendulum = pendulum, X: float = X) -> float:
            return p.l * sin(angle) - X

        def slowed(t: float, angle: float, rate: float, slow: float = slow) -> float:
            return slow**2 - rate**2

        clauses = [
            (beyond, lambda t, angle, rate, q=q: q * rate),
            (slowed, lambda t, angle, rate, add=add: rate + add),
        ]
        found += judged(pendulum, text, clauses)
    assert found > 6


WIDE = 0.1


def balls(starts: str, rates: str, more: str = "") -> str:
    return f"""model Balls
      parameter Length d = 0;
      parameter Stiffness k = 7;
      coordinate Length x[3](start = {starts}, rate = {rates});
      for i in 1:3 loop
        body b[i] = Particle(mass = 1 [kg], at = {{x[i], 0, 0}});
      end for;
      {more}
      for i in 1:2 loop
        when x[i+1] - x[i] < {WIDE} [m] then
          reinit({{der(x[i]), der(x[i+1])}}, {{der(x[i+1]), der(x[i])}});
        end when;
      end for;
    end Balls;"""


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_what_one_clause_ends_the_next_makes_true_again(backend: str) -> None:
    """The first two part, the last two drive them together again, and they part once more.  So it is beside,
    where they meet one after the other."""
    system = lagc.loads(balls("{-1 [m] - d, 0 [m], 1 [m]}", "{1, 0, -1}")).compile(backend=backend)
    for places in (0, 1, -1, 2, -3, 7, 50, 1e3, 1e9):
        apart = places * 2.0**-53
        run = system.simulate(2.0, rtol=1e-9, parameters={"d": apart})
        assert run.status == "ok" and len(run.events) == 3, (places, run.events)
        assert [run[f"der(x[{i}])"][-1] for i in (1, 2, 3)] == pytest.approx([-1.0, 0.0, 1.0])
        there = [run[f"x[{i}]"][-1] for i in (1, 2, 3)]
        assert there == pytest.approx([-1.2, 0.0, 1.2], abs=1e-12 + 3.0 * abs(apart))


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8, 1e-11])
def test_runs_in_which_clauses_act_together_or_one_after_the_other_agree(accuracy: float) -> None:
    """On springs, from both sides at a time: each outer one swings, and the middle one is its wall."""
    springs = "potential s = k/2*((x[2] - x[1] - 0.2 [m])^2 + (x[3] - x[2] - 0.2 [m])^2);"
    text = balls("{-1/3, 0.05, 1/3 + 0.1}", "{0.7, 0, -0.7}", springs)
    run = lagc.loads(text).compile(backend="numpy").simulate(4.0, accuracy=accuracy)
    assert run.status == "ok" and run.estimated is not None, run.message
    assert len(run.events) == 9
    omega, rest = sqrt(7.0), 0.05 - 0.2
    begin, wall = -1.0 / 3.0 - rest, 0.05 - WIDE - rest
    size = hypot(begin, 0.7 / omega)
    turn = pi - asin(wall / size)  # the phase behind the wall
    largest = max(map(abs, run["x[1]"]))
    for t, left, middle, right in zip(run.t, run["x[1]"], run["x[2]"], run["x[3]"]):
        phase = turn + (2.0 * pi + asin(begin / size) + omega * t - turn) % (3.0 * pi - 2.0 * turn)
        place = rest + size * sin(phase)
        off = max(abs(left - place), abs(middle - 0.05), abs(right - 0.1 + place))
        assert off <= run.estimated * largest
