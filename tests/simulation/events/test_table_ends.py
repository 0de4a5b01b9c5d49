"""Tables beyond their ends, by steps so long that they tell little of where they come to a knot."""

import math

import pytest

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("no_cache")

MODEL = """model Line
  parameter Real c = 1;
  coordinate Length y(start = 3, rate = 1);
  body b = Particle(mass = 1, at = {y, 0, 0});
  force f = {c*table(y, {0,1,2,3} [m], {0,1,4,9} [N], <kind>), 0, 0} at b;
end Line;"""
LINE, CUBIC = 'extrapolation = "line"', 'interpolation = "cubic"'
LONG = {"method": "rk4", "step": 1.0, "stop": 20.0}
ROUGH = {"method": "dopri5", "rtol": 0.33765058585536833, "atol": 0.0, "stop": 20.0}


def runs(kind: str, c: float, y: float, rate: float, **options: object) -> list[Run]:
    model = lagc.loads(MODEL.replace("<kind>", kind))
    return [
        model.compile(backend=backend).simulate(
            parameters={"c": c}, starts={"y": y, "der(y)": rate}, points=3, **options  # type: ignore[arg-type]
        )
        for backend in ("numpy", "c")
    ]  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("kind", "c", "y", "rate", "options"),
    [
        (LINE, -3.0, 2.999999, 1.8352657330486064, {**LONG, "stop": 2.0}),
        (CUBIC, 0.3, 3.0, 1.0, ROUGH),
        (CUBIC, -3.0, 2.999999, 100.0, LONG),
    ],
)
def test_no_run_leaves_the_table(
    kind: str, c: float, y: float, rate: float, options: dict[str, object]
) -> None:
    """A step that seems to come back below the last knot, and once it ends there does not."""
    one, two = runs(kind, c, y, rate, **options)
    assert one.status == two.status == "ok", (one.message, two.message)
    assert one.states == two.states and all(math.isfinite(x) for x in one.states[-1])


def test_beyond_the_last_knot_a_run_goes_on() -> None:
    """y'' = c (9 + s (y - 3)) there, of which y grows as exp(sqrt(c s) t)."""
    runs_found = runs(LINE, 0.3, 3.0, 1.0, method="dopri5", rtol=1e-9, stop=10.0)
    growth = math.sqrt(0.3 * 5.0)
    far = 9.0 / 5.0
    exact = 3.0 - far + far * math.cosh(10.0 * growth) + math.sinh(10.0 * growth) / growth
    for run in runs_found:
        assert run["y"][-1] == pytest.approx(exact, rel=1e-6)
