"""What is said about contacts: remedies, the order of events, the work of an effect of contacts."""

import pytest

import lagc
from lagc.diagnostics.faults import Refused

FALL = """model N
  coordinate Length y(start = 1 [m]);
  body ball = Particle(mass = 5 [kg], at = {{0, 0, y}});
  Gravity field(g = 9.81 [m/s2]);
  {}
  scene s
    simulate(stop = 0.6 [s]);
  end s;
end N;
"""


def _remedy(lines: str) -> str:
    with pytest.raises(Refused) as found:
        lagc.loads(FALL.format(lines)).compile(backend="numpy")
    return str(found.value.remedy)


@pytest.mark.parametrize(("bound", "last"), [("2 [m]", "2 [m]"), ("2*(1 [m])", "2*(1 [m])")])
def test_both_bounds_keep_the_arguments(bound: str, last: str) -> None:
    both = _remedy(f"constraint c: 0 <= y <= {bound} (restitution = 0.5);")
    one, other = (
        "constraint c_1: 0 <= y (restitution = 0.5);",
        f"constraint c_2: y <= {last} (restitution = 0.5);",
    )
    assert both == f"write two constraints: `{one}` and `{other}`"
    assert lagc.loads(FALL.format(one + other)).check() == []


@pytest.mark.parametrize(
    ("lines", "remedy"),
    [("constraint edge: y >= 0; output Force F = reaction(nothing);", "there are `edge`"),
     ("constraint edge: y >= 0; output Force F = reaction(floor);", "there are `edge`"),
     ("constraint edge: y >= 0 (friction = 0.1, slip = y);", "write `slip = der(y)`"),
     ("constraint edge: y >= 0 (friction = 0.1, slip = {y, 2*y});", "`slip = {der(y), der(2*y)}`"),
     ("output Real F = impulse(nothing);", "declare a one-sided constraint"),
     ("output Length h(scale = -1 [mm]) = y;", "`scale = 0.1 [m]`")],
)  # fmt: skip
def test_remedies_name_what_there_is(lines: str, remedy: str) -> None:
    assert remedy in _remedy(lines)


def test_an_impact_comes_before_the_clause_that_it_causes() -> None:
    lines = """constraint c: y >= 0 (restitution = 0.5);
  when der(y) > 0.1 [m/s] then mark("up"); end when;"""
    run = lagc.loads(FALL.format(lines)).compile(backend="numpy").simulate(rtol=1e-8)
    impact, up = run.events
    assert (impact.kind, up.name) == ("impact", "up") and impact.t == up.t


@pytest.mark.full
def test_the_work_of_an_effect_of_contacts_is_what_they_take() -> None:
    """A ball that falls by h and leaves with half of its speed: contacts take 3/4 m g h."""
    lines = """effect ground
    constraint c: y >= 0 (restitution = 0.5);
  end ground;"""
    text = FALL.format(lines).replace("scene s\n", "scene s uses ground\n")
    (one,) = lagc.loads(text).compile(scene="s").effects().left_out
    assert one.work == pytest.approx(-0.75 * 5.0 * 9.81, rel=1e-6)
