"""Linear models of the whole library against differences of its right-hand sides along the constraints.
Linear models are the same whether derivatives are made entry by entry or along directions."""

import random
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.lowering import jacobians
from lagc.simulation.linearization.linear_model import Linear
from lagc.simulation.system import FAILED
from tests.physics.library import compiled, fullest

STEPS = (1e-4, 1e-6, 1e-8)  # of the scales, which may be far above the lengths of the curvature
CLOSE = 1e-6  # of the sums of terms: fourth-order differences leave 1e-12, their rounding 1e-12


def projected(linear: Linear, x: Any) -> Any:
    """x moved onto the constraints, with the independent entries where they are."""
    system, interface = linear.system, linear.system.interface
    dependent = [i for i in range(len(x)) if i not in linear.indices]
    n = interface.nh + interface.nc
    for _ in range(6):
        c, slopes, _ = system.conditions(linear.t, x.tolist()) if interface.condition_ends else ([], [], [])
        table = np.zeros((n + len(interface.quaternions), len(x)))
        for row in range(n):
            for place in interface.condition_entries(row):
                table[row, interface.condition_columns[place]] = slopes[place]
        residual = [*c[:n], *(0.5 * (x[k : k + 4] @ x[k : k + 4] - 1.0) for k in interface.quaternions)]
        for row, k in enumerate(interface.quaternions):
            table[n + row, k : k + 4] = x[k : k + 4]
        x[dependent] -= np.linalg.lstsq(table[:, dependent], np.array(residual), rcond=1e-11)[0]
    return x


def rates(linear: Linear, y: Any) -> tuple[Any, Any]:
    """dy/dt and outputs where the independent entries are those of x and y."""
    system = linear.system
    x = np.array(linear.x) + linear.motions @ y
    x = projected(linear, x)
    xdot, lam = [0.0] * system.nx, [0.0] * system.nc
    assert system.rhs(linear.t, x.tolist(), xdot, lam) not in FAILED
    return np.array(xdot)[linear.indices], np.array(system.outputs(linear.t, x.tolist()))


@pytest.mark.sample(1, 12)
@pytest.mark.parametrize("name, scene", fullest())
def test_a_linear_model_is_that_of_differences(name: str, scene: str) -> None:
    model = compiled(name, scene, "numpy")
    if model.interface.nv + model.interface.nc > 30:
        pytest.skip("a large one of the same kind")
    if model.interface.contacts:
        pytest.skip("contacts have no derivatives")
    linear = model.linearize()
    chance = random.Random(name)
    for _ in range(2):
        way = linear.scales * [chance.uniform(-1.0, 1.0) for _ in linear.states]
        assert any(is_close(linear, way, step) for step in STEPS), difference(linear, way, STEPS[0])


def difference(linear: Linear, way: Any, step: float) -> tuple[list[Any], list[Any]]:
    """Derivatives of rates and outputs along `way`, of fourth order, and the sizes of both."""
    around = [rates(linear, k * step * way) for k in (-2, -1, 1, 2)]
    sides = list(zip(*around))
    return [(a - d + 8.0 * (c - b)) / (12.0 * step) for a, b, c, d in sides], [
        np.abs(one[2]) for one in sides
    ]


def is_close(linear: Linear, way: Any, step: float) -> bool:
    """Whether A and C agree with differences of this step."""
    expected, values = difference(linear, way, step)
    for part, table in enumerate((linear.A, linear.C)):
        terms = np.abs(table) @ np.abs(way) + values[part] * 1e-6
        far = np.abs(table @ way - expected[part])
        stated = np.isfinite(terms)  # an output without derivatives there is `nan`, and has a note
        assert stated.all() or linear.notes
        terms, far = np.where(stated, terms, 0.0), np.where(stated, far, 0.0)
        if not (far <= CLOSE * np.maximum(terms, far_size(terms, linear, part))).all():
            return False
    return True


def far_size(terms: Any, linear: Linear, part: int) -> Any:
    """Entries that cancel are judged beside the others, in the units of the states."""
    if part == 1 or not len(terms):
        return terms + 1e-3 * max(terms, default=0.0)
    return linear.scales * max(terms / linear.scales)


def test_differences_see_a_wrong_entry() -> None:
    linear = compiled("classic/four_bar", "flat", "numpy").linearize()
    way = linear.scales * np.ones(2)
    expected = difference(linear, way, STEPS[0])[0][0]
    wrong: Any = linear.A * [[1.0, 1.0], [1.001, 1.0]]
    assert np.abs(linear.A @ way - expected).max() < 1e-9 < np.abs(wrong @ way - expected).max()


ROUNDING = 1e-12  # of the largest entry: a few hundred roundings
AT = {
    "classic/chaplygin_sleigh_speeds": 0.3, "classic/four_bar": 0.3, "classic/sphere_on_turntable": 0.3,
    "course/string_pendulum": 0.0, "classic/moving_rail": 0.0, "classic/wheelset": 0.0,
    "drag": 0.0,
}  # fmt: skip


DRAG = """
model Drag "a double pendulum that sets out from rest in a wind, in air whose drag has no slope there"
  parameter Length l = 0.2 [m];
  input Force u = 0;
  coordinate Angle a(start = 0.3), b(start = -0.2);
  body p = Particle(mass = 1 [kg], at = l*{sin(a), 0, -cos(a)});
  body q = Particle(mass = 1 [kg], at = l*{sin(a) + sin(b), 0, -cos(a) - cos(b)});
  force drag = -0.3 [kg/m]*norm(velocity(p))*velocity(p) at p;
  force wind = {u, 0, 0} at q;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  output Force f = 0.3 [kg/m]*norm(velocity(p))*velocity(p).x + u;
end Drag;
"""


@pytest.mark.sample(1)
@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize("name, t", AT.items())
def test_both_ways_agree(name: str, t: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is rounding is 0 in both."""
    file = lagc.loads(DRAG) if name == "drag" else lagc.load(name)
    one = file.compile(backend="numpy").linearize(t)
    monkeypatch.setattr(jacobians, "MOST", 0)
    two = file.compile(backend="numpy").linearize(t)
    assert one.system.interface.derivatives and not two.system.interface.derivatives
    assert (one.states, one.idle, one.stability, one.free) == (two.states, two.idle, two.stability, two.free)
    for ours, theirs in ((one.A, two.A), (one.B, two.B), (one.C, two.C), (one.D, two.D)):
        assert np.abs(ours - theirs).max(initial=0.0) <= ROUNDING * np.abs(ours).max(initial=0.0)
        assert ((ours == 0.0) == (theirs == 0.0)).all()
