"""Consistent starts: held values are held, guesses move as little as the conditions demand."""

from math import sqrt

import numpy as np
import pytest
from scipy.optimize import minimize

import lagc
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.initialization.solver import Conditions, Consistency
from lagc.simulation.system import OK, Vector
from tests.simulation.systems import Oscillator, Pendulum, Spun, norm


def test_of_linear_equations_the_nearest_solution_is_found() -> None:
    """All sizes are alike here, so that the pseudo-inverse tells it; the second row is twice the first."""
    rows = np.array([[1.0, 2.0, 3.0, 0.5], [2.0, 4.0, 6.0, 1.0], [0.0, 1.0, -1.0, 2.0]])
    guess = np.full(4, 3.0)
    right = rows @ [1.0, -2.0, 0.5, 4.0]

    def evaluate(t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        sizes = abs(rows) @ np.abs(x) + abs(right)
        return (rows @ x - right).tolist(), rows.ravel().tolist(), sizes.tolist()

    equations = Conditions(4, 0, (), [0] * 4, (), [4, 8, 12], [*range(4)] * 3, evaluate, lambda: ([], [0.0]))
    search = Consistency(equations, 0.0, guess.tolist(), [0] * 4)
    assert search.run() == OK
    nearest = guess + np.linalg.pinv(rows, rcond=1e-9) @ (right - rows @ guess)
    assert search.y == pytest.approx(nearest.tolist(), abs=1e-12)


def test_without_conditions_nothing_changes() -> None:
    assert consistent_start(Oscillator()).x == [1.0, 0.0]
    assert consistent_start(Oscillator(), given={"x": 3.0}).x == [3.0, 0.0]


def test_guesses_go_to_the_circle_and_its_tangent() -> None:
    start = consistent_start(Pendulum())
    x, y, u, v = start.x
    assert not start.unmet
    assert abs(x * x + y * y - 1.0) < 1e-14 and abs(x * u + y * v) < 1e-14
    # with equal weights the nearest point is along the radius, and speeds lose their radial part;
    # steps of minimum norm end within the square of the change of it
    scale = norm((0.6, -0.9))
    assert x == pytest.approx(0.6 / scale, abs=0.01) and y == pytest.approx(-0.9 / scale, abs=0.01)
    radial = 0.5 * x + 0.5 * y
    assert (u, v) == (pytest.approx(0.5 - radial * x, abs=1e-12), pytest.approx(0.5 - radial * y, abs=1e-12))
    assert {c.name for c in start.changes} == {"x", "y", "der(x)", "der(y)"}
    assert "instead of 0.6 m" in str(start.changes[0])


def test_fixed_values_stay() -> None:
    start = consistent_start(Pendulum(start_levels=(4, 0, 0, 0)))
    assert start.x[:2] == [0.6, pytest.approx(-0.8, abs=1e-15)]


def test_given_values_are_held_where_they_can() -> None:
    assert consistent_start(Pendulum(), given={"x": 0.8}).x[:2] == [0.8, pytest.approx(-0.6, abs=1e-14)]
    start = consistent_start(Pendulum(), given={"x": 3.0})
    assert not start.unmet and norm(start.x[:2]) == pytest.approx(1.0)
    assert "x" in {c.name for c in start.changes}


def test_a_guess_in_a_singular_configuration_is_left() -> None:
    start = consistent_start(Pendulum(guess=(0.0, 0.0, 1.0, 0.0)))
    assert not start.unmet
    assert norm(start.x[:2]) == pytest.approx(1.0)


def test_contradicting_values_are_named() -> None:
    start = consistent_start(Pendulum(start_levels=(4, 4, 0, 0)))
    assert [m.name for m in start.unmet] == ["constraint `string` (m.lag:2)"]
    assert start.unmet[0].amount == pytest.approx(0.6**2 + 0.9**2 - 1.0)
    assert start.held == ("`x` (m.lag:1)", "`y` (m.lag:1)")


class Aimed(Pendulum):
    """A pendulum whose start is given by conditions: y = -x of positions, and x der(x) = 1/4 mixed."""

    def __init__(self, wanted: float = 0.25, **given: object) -> None:
        own = {
            "initial_places": ("m.lag:7", "m.lag:8"), "condition_ends": (2, 6, 8, 10),
            "condition_columns": (0, 1, 0, 1, 2, 3, 0, 1, 0, 2),
        }  # fmt: skip
        super().__init__(**{**own, **given})
        self.wanted = wanted

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        c, jacobian, sizes = super().conditions(t, x)
        c += [x[0] + x[1], x[0] * x[2] - self.wanted]
        sizes += [abs(x[0]) + abs(x[1]), abs(x[0] * x[2]) + self.wanted]
        return c, [*jacobian, 1.0, 1.0, x[2], x[0]], sizes


def test_initial_conditions() -> None:
    start = consistent_start(Aimed())
    r = sqrt(0.5)
    assert start.x == pytest.approx([r, -r, 0.25 / r, 0.25 / r], abs=1e-13)


def test_a_condition_on_speeds_may_move_positions() -> None:
    """der(x) is held, so that x der(x) can be met by moving x alone; y = -x is then broken."""
    levels = (0, 0, 4, 0)
    start = consistent_start(Aimed(start_levels=levels))
    assert "the condition at m.lag:8" in {m.name for m in start.unmet} or "m.lag:7" in str(start.unmet)
    assert consistent_start(Aimed(wanted=0.5 * sqrt(0.5), start_levels=levels)).unmet == ()


def test_quaternions_are_normalised() -> None:
    start = consistent_start(Spun((2.0, 0.0, 2.0, 0.0, 1.0, 0.0, 0.0)))
    assert start.x[:4] == pytest.approx([sqrt(0.5), 0.0, sqrt(0.5), 0.0], abs=1e-15)
    assert {c.name for c in start.changes} == {"o.w", "o.y"}


ROPE = """model Rope "hung up at both ends; of its shape nothing is stated"
  structural Integer n = 10;
  parameter Length L = 2 [m], D = 1.2 [m];
  coordinate Length x[n], z[n];
  point P[0] = {0, 0, 0};
  point P[n+1] = {D, 0, 0};
  for i in 1:n loop
    point P[i] = {D*i/(n+1) + x[i], 0, z[i] - 3*D*(i/(n+1))*(1 - i/(n+1))};
    body b[i] = Particle(mass = 1 [kg], at = P[i]);
  end for;
  for i in 0:n loop
    constraint s[i]: norm(P[i+1] - P[i]) = L/(n+1);
  end for;
  Gravity g;
end Rope;
"""


@pytest.mark.full
@pytest.mark.parametrize("n", (15, 60))
def test_displacements_that_are_all_zero_have_one_size(n: int) -> None:
    """The guess is up to a tenth of the length away from a start, which steps of least norm lead to; those of
    uneven sizes do not."""
    run = lagc.loads(ROPE).compile(parameters={"n": n}, backend="numpy").simulate(1e-9, rtol=1e-6)
    k = np.arange(1, n + 1) / (n + 1)
    x = np.array([run[f"x[{i}]"][0] for i in range(1, n + 1)])
    z = np.array([run[f"z[{i}]"][0] for i in range(1, n + 1)])
    assert max(abs(x).max(), abs(z).max()) < 0.5
    points = np.array([[0.0, 0.0], *zip(1.2 * k + x, z - 3.6 * k * (1 - k)), [1.2, 0.0]])
    assert np.hypot(*np.diff(points, axis=0).T) == pytest.approx(2.0 / (n + 1), rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_rope_of_rods_is_hung_from_a_parabola(backend: str) -> None:
    """Each place of it is stated, of sizes from a link to the whole rope: a smooth curve should bend as a
    whole, not where its numbers happen to be large."""
    text = """model Rope
      structural Integer n = 50;
      parameter Length L = 10, span = 6, l = L/n;
      coordinate Length x[n-1](start = {span*i/n for i in 1:n-1}),
        z[n-1](start = {-14 [m]*(i/n)*(1 - i/n) for i in 1:n-1});
      point P[0] = {0, 0, 0};
      point P[n] = {span, 0, 0};
      for i in 1:n-1 loop
        point P[i] = {x[i], 0, z[i]};
        body m[i] = Particle(mass = 0.1, at = P[i]);
      end for;
      for i in 1:n loop
        constraint rod[i]: norm(P[i] - P[i-1]) = l;
      end for;
    end Rope;"""
    found = np.array(lagc.loads(text).compile(backend=backend).start()[:98])

    def lengths(y: np.ndarray) -> np.ndarray:
        dx, dz = (np.diff([0.0, *y[49 * k : 49 * k + 49], end]) for k, end in enumerate((6.0, 0.0)))
        return np.asarray(np.hypot(dx, dz))

    assert lengths(found) == pytest.approx(np.full(50, 0.2), rel=1e-12)
    i = np.arange(1, 50) / 50
    guess = np.array([*(6.0 * i), *(-14.0 * i * (1.0 - i))])
    rods = {"type": "eq", "fun": lambda y: lengths(y) - 0.2}
    nearest = minimize(lambda y: np.sum((y - guess) ** 2), found, method="SLSQP", constraints=rods).x
    assert norm(list(found - guess)) < 1.25 * norm(list(nearest - guess))


@pytest.mark.sample(2)
@pytest.mark.parametrize("product", [100.0, -100.0])
@pytest.mark.parametrize("beside", [0, 1, 3])
def test_beginnings_are_on_all_sides(product: float, beside: int) -> None:
    """A guess between the branches of a hyperbola tells nothing of where they are, whatever else there is."""
    others = "".join(
        f"coordinate Length e{k}; constraint c{k}: e{k} = 1 [m];"
        f"body f{k} = Particle(mass = 1, at = {{e{k}, 0, 0}});\n"
        for k in range(beside)
    )
    text = f"""model Branches
      {others}
      coordinate Length x, y;
      body b = Particle(mass = 1, at = {{x, y, 0}});
      constraint product: x*y = {product} [m2];
    end Branches;"""
    start = lagc.loads(text).compile(backend="numpy").start()
    assert start[beside] * start[beside + 1] == pytest.approx(product, rel=1e-12)


@pytest.mark.full
def test_a_family_that_cannot_be_met_is_one_sentence() -> None:
    """Ten rods of a fifth of a metre from here to three metres away."""
    text = """model Short
      structural Integer n = 10;
      coordinate Length x[n](start = {0.3*i for i in 1:n} [m]), z[n];
      point P[0] = {0, 0, 0};
      for i in 1:n loop
        point P[i] = {x[i], 0, z[i]};
        body b[i] = Particle(mass = 1, at = P[i]);
        constraint rod[i]: norm(P[i] - P[i-1]) = 0.2 [m];
      end for;
      constraint far: x[n] = 3 [m];
    end Short;"""
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text).compile(backend="numpy").start()
    message = refused.value.faults[0].message
    assert message.count("`rod[") == 1 and "and 9 more of its kind by no more" in message
