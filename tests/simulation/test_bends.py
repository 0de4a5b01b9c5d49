"""Bends that no look at single coordinates shows: the run ends there, and says why.

The tip of a cone is met where two coordinates are zero at once; a way on the rows leads there.
"""

from __future__ import annotations

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


@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_run_that_comes_to_a_tip_fails_and_says_so(backend: str) -> None:
    status, t, message = told("constraint cone: z = norm({x, y, 0});", backend)
    assert (
        status == "failed" and "`cone` is not differentiable there" in message and "contradict" not in message
    )
    assert 0.45 < t <= 0.5 + 1e-9


def test_smooth_rows_are_not_said_to_bend() -> None:
    for rows in (
        "constraint aa: x^2 + y^2 = 2*l^2; constraint bb: x = l*(3*time/T - 1);",
        "constraint aa: x + y = 0; constraint bb: x^3/l^2 + y = l*(time/T)^2;",
        "constraint cone: z = sqrt(x^2 + y^2 + 1e-4*l^2);",
    ):
        assert "differentiable" not in told(rows, "numpy")[2], rows
