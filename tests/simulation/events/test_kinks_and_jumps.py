"""A run that gets to a kink or a jump ends there, and says why."""

import pytest

import lagc

pytestmark = pytest.mark.usefixtures("no_cache")

MODEL = """model M
  parameter Length l(min = 0) = 1 [m];
  parameter Time T(min = 0) = 1 [s];
  coordinate Length x(start = -1 [m], rate = 2 [m/s]), y, z(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {{x, y, z}});
  {rows}
end M;"""


def told(rows: str, backend: str) -> tuple[str, float, str]:
    run = lagc.loads(MODEL.format(rows=rows)).compile(backend=backend).simulate(1.0)
    return run.status, run.times[-1], run.message


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_run_that_comes_to_a_tip_fails_and_says_so(backend: str) -> None:
    status, t, message = told("constraint cone: z = norm({x, y, 0});", backend)
    assert (
        status == "failed" and "`cone` is not differentiable there" in message and "contradict" not in message
    )
    assert 0.45 < t <= 0.5 + 1e-9


@pytest.mark.sample(2)
@pytest.mark.parametrize("rows, where", [
    ("constraint c: y = abs(x);", "the constraint `c` has a kink where `x` passes 0"),
    ("constraint c: y = 0.3*l*sign(x);", "the constraint `c` has a jump where `x` passes 0"),
    ("constraint c: y = if time < 0.5 [s] then l else 2*l;", "a jump where `time` passes 0.5"),
    ("constraint c: y = l*floor(4*x/l + 4.5);", "passes a whole number"),
    ("body p = Particle(mass = 1 [kg], at = {0, abs(x), 0});", "the place of `p` has a kink"),
    ("potential V = if x > 0 then 1 [J] else 0;", "the energy `V` has a jump"),
    ("speed Velocity u = der(y)*sign(x);", "the speed `u` has a jump"),
])  # fmt: skip
def test_a_run_stops_at_a_kink_or_a_jump(rows: str, where: str) -> None:
    status, t, message = told(rows, "numpy")
    assert status == "failed" and where in message
    assert abs(t - (0.0625 if "floor" in rows else 0.5)) < 1e-5


@pytest.mark.full
def test_a_motion_that_keeps_away_from_a_kink_is_followed() -> None:
    system = lagc.loads(MODEL.format(rows="constraint c: y = abs(x - 9*l);")).compile(backend="numpy")
    assert [fault.code for fault in system.equations.warnings] == ["LAG0421"]
    assert system.simulate(1.0).status == "ok"


@pytest.mark.full
def test_smooth_rows_are_not_said_to_bend() -> None:
    for rows in (
        "constraint aa: x^2 + y^2 = 2*l^2; constraint bb: x = l*(3*time/T - 1);",
        "constraint aa: x + y = 0; constraint bb: x^3/l^2 + y = l*(time/T)^2;",
        "constraint cone: z = sqrt(x^2 + y^2 + 1e-4*l^2);",
    ):
        assert "differentiable" not in told(rows, "numpy")[2], rows
