"""Reactions that the equations leave open: the null space of G^T decides, at any scale of an equation."""

import random

import pytest

import lagc
from lagc.lowering.lower_equations import optimize
from lagc.mechanics.identities.linear_algebra import Span
from lagc.reports.explain import explanation
from tests.reports.models import equations_of

BEAM = """\
model Beam "A beam on three supports, held along x by one"
  parameter Length l = 2 [m];
  coordinate Length x, z;
  coordinate Angle th;
  frame F = rotate_y(world, th);
  body beam = Solid(mass = 3 [kg], inertia = {{1, 1, 1}}, frame = F, com = {{x, 0, z}});
  constraint left: {a!r}*dot(position(beam) - l*F.x, world.z) = 0;
  constraint middle: {b!r}*z = 0;
  constraint right: {c!r}*dot(position(beam) + l*F.x, world.z) = 0;
  constraint along: x = 0;
  effect gravity
    Gravity field;
  end gravity;
  scene s uses gravity
    simulate(stop = 1 [s]);
  end s;
end Beam;
"""
SPINNING = """\
model Door "A door on two hinges, each of three equations, that share the force along the axis"
  parameter Length L = 1 [m];
  coordinate Length x, y, z(start = 0.1 [m]);
  coordinate Orientation o(rate = {{0, 0, 2}} [rad/s]);
  frame F = rotate(world, o);
  body door = Solid(mass = 3 [kg], inertia = {{1, 1, 1}}, frame = F, com = {{x, y, z}} + 0.5*L*F.x);
  constraint low: {a!r}*({{x, y, z}} - 0.4*L*F.z) = {a!r}*L*{{0, 0, -0.3}};
  constraint high: {{x, y, z}} + 0.4*L*F.z = L*{{0, 0, 0.5}};
  scene s simulate(stop = 1 [s]); end s;
end Door;
"""


@pytest.mark.parametrize("scales", [(1.0, 1.0, 1.0), (1.0, 1e4, 1.0), (1e-3, 1.0, 50.0)])
def test_all_supports_of_a_beam_are_named(scales: tuple[float, float, float]) -> None:
    a, b, c = scales
    system = lagc.loads(BEAM.format(a=a, b=b, c=c)).compile(backend="numpy")
    run = system.simulate()
    assert run.open_reactions == ("left", "middle", "right")
    assert run.to_dict()["open_reactions"] == ["left", "middle", "right"]
    (note,) = [note for note in run.notes if "reactions open" in note]
    assert all(f"`{name}`" in note for name in ("left", "middle", "right")) and "`along`" not in note
    equations = equations_of(BEAM.format(a=a, b=b, c=c))
    facts = explanation(equations, optimize(equations))
    assert facts["open_reactions"] == ["left", "middle", "right"] and len(facts["redundant"]) == 1


def test_hinges_share_the_force_along_their_axis_alone() -> None:
    run = lagc.loads(SPINNING.format(a=1e3)).compile(backend="numpy").simulate()
    assert run.open_reactions == ("low[3]", "high[3]")


def test_a_motion_with_unique_reactions_names_none() -> None:
    run = lagc.load("models/classic/four_bar.lag").compile(backend="numpy").simulate(0.1)
    assert run.open_reactions == ()


@pytest.mark.parametrize("seed", range(40))
def test_rows_of_random_null_spaces(seed: int) -> None:
    """Against the singular vectors of numpy; rows differ in size by up to 1e6."""
    np = pytest.importorskip("numpy")
    dice = random.Random(seed)
    n, columns = dice.randint(2, 9), 12
    rows = [[dice.gauss(0, 1) * (dice.random() < 0.5) for _ in range(columns)] for _ in range(n)]
    for _ in range(dice.randint(0, 3)):
        of = dice.sample(range(len(rows)), dice.randint(1, 2))
        rows.append([sum(dice.choice((1, 2, -3)) * rows[k][j] for k in of) for j in range(columns)])
    factors = [10.0 ** dice.uniform(-3, 3) for _ in rows]
    rows = [[f * x for x in row] for f, row in zip(factors, rows)]
    unit = np.array([np.array(r) / (np.linalg.norm(r) or 1.0) for r in rows])
    left, sizes, _ = np.linalg.svd(unit)
    null = left[:, sum(sizes > 1e-10) :]
    expected = {k for k in range(len(rows)) if np.linalg.norm(null[k]) > 1e-8}
    assert Span(rows).entangled() == expected
