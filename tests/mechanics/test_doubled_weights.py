"""A potential that is the weight of a body beside `Gravity` gets a warning; another one does not."""

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source

MODEL = """model M
  parameter Mass m = 2 [kg];
  parameter Length l = 0.7 [m];
  parameter Acceleration g = 9.81 [m/s2];
  parameter Stiffness k = 3 [N/m];
  coordinate Length z;
  coordinate Angle theta(start = 0.3);
  body a = Particle(mass = m, at = {0, 0, z});
  body b = Particle(mass = m, at = l*{sin(theta), 0, -cos(theta)});
  Gravity field(g = 9.81 [m/s2]);
  PUT
end M;
"""


@pytest.mark.parametrize(
    "written, doubled",
    [
        ("potential w = m*g*z;", "`a`"),
        ("potential w = m*g*l*(1 - cos(theta));", "`b`"),
        ("potential w = m*9.80665 [m/s2]*z + m*g*l;", "`a`"),
        ("potential w = m*g*(z - l*cos(theta));", "all bodies"),
        ("potential w = 1/2*k*z^2;", None),
        ("potential w = m*g*z + 1/2*k*z^2;", None),
        ("potential w = -m*g*z;", None),  # a buoyancy
        ("potential w = m*1.62 [m/s2]*z;", None),
        ("potential w = m*g*l*(1 - cos(2*theta));", None),
        ("input Force F = 1; potential w = F*z;", None),
    ],
)
def test_weights_that_count_twice(written: str, doubled: str | None) -> None:
    found = [
        f for f in check(Source("m.lag", MODEL.replace("PUT", written)), Choice()) if f.code == "LAG0435"
    ]
    assert [f.message for f in found] == (
        [f"`w` is the weight of {doubled}, which `field` contains already"] if doubled else []
    )


def test_a_potential_without_gravity_is_one() -> None:
    text = MODEL.replace("PUT", "potential w = m*g*z;").replace("Gravity field(g = 9.81 [m/s2]);", "")
    assert not [f for f in check(Source("m.lag", text), Choice()) if f.code == "LAG0435"]
