"""A system that nothing moves has a warning, and no other system. A potential that is the weight of a body
beside `Gravity` gets a warning; another one does not."""

import pytest

import lagc
from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source

BODY = "body b = Particle(mass = 1, at = {x, 0, 0}); "
BOB = "body c = Particle(mass = 1, at = {x + sin(a)*1 [m], 0, cos(a)*1 [m]}); "
COUPLED = f"{BODY}coordinate Angle a; {BOB}"


@pytest.mark.parametrize(
    "lines, told",
    [
        (BODY, ["x"]),
        (f"{BODY} dissipation D = 1/2*3 [N.s/m]*der(x)^2;", ["x"]),  # friction alone moves nothing
        (f"{BODY} force f = {{1 [N], 0, 0}} at b;", []),
        (f"{BODY} potential V = 1/2*3 [N/m]*x^2;", []),
        (f"{BODY} constraint c: x = 0;", []),
        (f"{BODY} constraint c: x >= 0;", []),
        ("coordinate Length y(rate = 1, start = -1); body b = Particle(mass = 1, at = {x, 0, 0}); "
         "body c = Particle(mass = 1, at = {y, 0, 0}); constraint hit: x >= y;", []),
        (f"{BODY} input Force u; force f = u*world.x at b;", []),
        (f"{BODY} when time > 1 [s] then reinit(der(x), 2 [m/s]); end when;", []),
        (f"{BODY} initial der(x) = 1 [m/s];", []),
        (f"{BODY} scene s start der(x) = 0; end s;", []),  # stated: it is meant to rest
        ("body b = Particle(mass = 1, at = {x, 1 [m/s]*time, 0});", []),  # the body moves
        ("coordinate Length y(rate = 1); body b = Particle(mass = 1, at = {x, y, 0});", []),
        (f"{BODY} coordinate Length y(rate = 1); body c = Particle(mass = 1, at = {{0, y, 0}});", []),
        (f"{COUPLED} Gravity field;", []),  # the pendulum pushes its cart
        (COUPLED, ["x", "a"]),
        ("coordinate Orientation o; body s = Solid(mass = 1, inertia = {1, 2, 3}, "
         "frame = rotate(world, o), com = {x, 0, 0});", ["x", "o"]),
    ],
)  # fmt: skip
def test_a_system_that_nothing_moves_has_a_warning(lines: str, told: list[str]) -> None:
    text = f"model A coordinate Length x; {lines} end A;"
    found = check(Source("m.lag", text), Choice())
    names = ", ".join(f"`{name}`" for name in told)
    assert [f.code for f in found] == (["LAG0429"] if told else [])
    assert all(f"nothing moves {names}:" in f.message for f in found)
    if told:  # as a run shows
        run = lagc.loads(text).compile(backend="numpy").simulate(1.0)
        assert all(set(run[name]) == {0.0} for name in told if name != "o")


def test_warnings_are_shown_beside_the_errors_of_a_later_stage() -> None:
    text = (
        "model A coordinate Length x; coordinate Angle q(start = 45); Gravity one; Gravity two; "
        "body b = Particle(mass = 1, at = {x, sin(q)*1 [m], 0}); output Length y = 1 [m2]/x; "
        "constraint c: x^2 + 1 [m2] = 0; end A;"
    )
    codes = [fault.code for fault in check(Source("m.lag", text), Choice())]
    assert codes == ["LAG0618", "LAG0229", "LAG0610"]


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
