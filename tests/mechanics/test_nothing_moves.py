"""A system that nothing moves has a warning, and no other system."""

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
