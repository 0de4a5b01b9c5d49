"""Chains of turns about oblique axes, whose vectors are sums of more terms than doubles have digits: what is
said of them is what is said of short ones. Constraints at the end of a long chain are judged as those of a
short one."""

from math import cos, sin, sqrt

import pytest

import lagc
from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Refused, Source
from lagc.mechanics.analysis.analysis import analyse
from lagc.mechanics.derive import derive
from lagc.mechanics.identities.samples import magnitudes
from lagc.symbolic.graph import Graph, Node
from tests.reports.models import equations_of

OBLIQUE = """
model Chain
  structural Integer n = {n};
  coordinate Angle q[n](each start = 0.2 [rad]);
  frame F[0] = world;
  point P[0] = {{0, 0, 0}};
  for i in 1:n loop
    frame F[i] = rotate(F[i-1], F[i-1].z + F[i-1].y, q[i]);
    point P[i] = P[i-1] + 0.3 [m]*F[i].x;
    body b[i] = Particle(mass = 0.5 [kg], at = P[i]);
    {each}
  end for;
  {more}
end Chain;
"""
SPRING = "potential s[i] = 1/2*3 [N.m]*q[i]^2;"
DRAG = "dissipation d = 1/2*0.1 [kg/s]*dot(velocity(b[n]), velocity(b[n]));"
TIP = "constraint tip: P[n].z = 0.1 [m];"
AGAIN = "constraint again: 2*dot(P[n] - P[0], world.z) = 0.2 [m];"


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("n", [3, 9, 20])
def test_springs_and_drag_leave_nothing_conserved(n: int) -> None:
    found = analyse(equations_of(OBLIQUE.format(n=n, each=SPRING, more=DRAG)))
    assert found.degrees_of_freedom == n
    assert not found.cyclic and not found.conserved


@pytest.mark.full
@pytest.mark.parametrize("n", [9, 20])
def test_a_row_at_the_tip_takes_one_freedom(n: int) -> None:
    found = analyse(equations_of(OBLIQUE.format(n=n, each=SPRING, more=TIP)))
    assert found.degrees_of_freedom == n - 1 and not found.redundant
    twice = analyse(equations_of(OBLIQUE.format(n=n, each=SPRING, more=TIP + AGAIN)))
    assert twice.degrees_of_freedom == n - 1 and len(twice.redundant) == 1


@pytest.mark.full
@pytest.mark.parametrize("n", [3, 16])
def test_a_friction_that_may_drive_is_warned_of(n: int) -> None:
    push = "force air = -0.05 [kg/s]*velocity(b[n-1]) at b[n];"
    faults = lagc.loads(OBLIQUE.format(n=n, each="", more=push)).check()
    assert [fault.code for fault in faults if fault.code != "LAG0429"] == ["LAG0412"]


@pytest.mark.parametrize("turns", [1, 10, 60])
def test_terms_are_as_large_as_their_rounding_tells(turns: int) -> None:
    """A vector of length 5 that is turned: its length stays, and no component has larger terms than that many
    roundings of it.  Its components and the difference of its square are told from what vanishes."""
    graph = Graph()
    angle, half = graph.symbol("coordinate", "q"), graph.const(sqrt(0.5))
    vector: tuple[Node, Node, Node] = (graph.const(3.0), graph.const(4.0), graph.zero)
    c, s = graph.cos(angle), graph.sin(angle)
    x, y, z = 3.0, 4.0, 0.0
    a, b = cos(0.3), sin(0.3)
    for _ in range(turns):
        u, v, w = vector  # about (0, 1, 1)/sqrt(2)
        along = half * (v + w)
        across = half * (w - v)
        vector = (
            c * u + s * across,
            half * along - half * (c * across - s * u),
            half * along + half * (c * across - s * u),
        )
        p, q = sqrt(0.5) * (y + z), sqrt(0.5) * (z - y)
        x, y, z = a * x + b * q, sqrt(0.5) * (p - (a * q - b * x)), sqrt(0.5) * (p + (a * q - b * x))
    square = graph.sum(part * part for part in vector)
    state = {angle: 0.3}
    *parts, whole, none = magnitudes([*vector, square, square - 25.0], state)
    for (value, size), exact in zip(parts, (x, y, z)):
        assert value == pytest.approx(exact, abs=1e-14 * turns)
        assert size <= 5.0 * 20.0 * turns
    assert whole[0] == pytest.approx(25.0, rel=1e-13)
    assert abs(none[0]) <= 1e-11 * none[1] and 2.5 <= none[1] <= 25.0 * 40.0 * turns


CHAIN = """model M
structural Integer n = {n};
parameter Length l(min = 0) = 0.3 [m];
coordinate Angle a[n](each start = 20 [deg]), b[n](each start = 25 [deg]);
point P[0] = {{0, 0, 0}};
for i in 1:n loop
  point P[i] = P[i-1] + l*{{sin(a[i])*cos(b[i]), sin(a[i])*sin(b[i]), -cos(a[i])}};
  body m[i] = Particle(mass = 1 [kg], at = P[i]);
end for;
coordinate Length s(start = 1 [m]);
body e = Particle(mass = 1 [kg], at = {{0, 0, s}});
constraint c: {row};
end M;"""
SHORT, LONG = 2, 20

ROWS = {
    "norm(P[n]) = l": [],
    "norm(P[n]) = 0": ["LAG0413"],  # wherever it holds
    "P[n].x^2 = 0": ["LAG0413"],
    "P[n].x^2*P[n].y = 0": ["LAG0413"],
    "abs(P[n].x) = 0.5*l + P[n].y": ["LAG0421"],
    "norm({P[n].x, P[n].y, 0}) = s": [],  # the tip of a cone
    "norm({P[n].x, P[n].y, l}) = 0.7*P[n].z": [],
}


def faults(n: int, row: str) -> list[str]:
    model = resolve(parse(Source("m.lag", CHAIN.format(n=n, row=row))), Choice())
    try:
        return [fault.code for fault in derive(model).warnings]
    except Refused as refused:
        return [fault.code for fault in refused.faults]


@pytest.mark.sample(3)
@pytest.mark.parametrize("row", ROWS)
def test_rows_of_long_chains_are_judged_as_those_of_short_ones(row: str) -> None:
    assert faults(SHORT, row) == faults(LONG, row) == ROWS[row]
