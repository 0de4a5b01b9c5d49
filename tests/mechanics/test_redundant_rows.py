"""Rows are left out only where others say the same whatever the motion is, and the parameters are. Rows that
cannot depend on others are told by their columns alone; the truth are exact null vectors."""

from random import Random

import pytest
import sympy

import lagc
from lagc.diagnostics.faults import Refused
from lagc.mechanics.redundancy import entangled

pytestmark = pytest.mark.usefixtures("own_cache")

TEXT = """model R
  parameter Real p = 2, q = 3;
  coordinate Length x(start = 1 [m]), y(start = 1 [m]), z(start = 1 [m]);
  body m = Particle(mass = 1 [kg], at = {{x, y, z}});
  force f = {{1 [N], 2 [N], 3 [N]}} at m;
  constraint a: {first} = 0;
  constraint b: {second} = 0;
end R;"""
HELD = "der(x)"

# What they hold with other values than those at which the model is compiled
CASES = {
    "a choice": (HELD, "(if p > 1 then der(x) else der(y))", {"p": 0.5}, "xy"),
    "a kink": (HELD, "max(p - 1, 0)*der(x) + max(1 - p, 0)*der(y)", {"p": 0.5}, "xy"),
    "a size": (HELD + " - der(y)", "abs(p)*der(x) - p*der(y)", {"p": -2.0}, "xy"),
    "a root of a square": (HELD + " - der(y)", "sqrt(p^2)*der(x) - p*der(y)", {"p": -2.0}, "xy"),
    "a factor that vanishes": ("p*der(x)", HELD, {"p": 0.0}, "x"),
    "a difference that vanishes": ("(p - q)*der(x)", HELD, {"p": 3.0}, "x"),
    "a factor that fades": ("(1 - exp(-50*p))*der(x)", HELD, {"p": 0.0}, "x"),
    "a factor that saturates": ("tanh(100*p)*der(x)", HELD, {"p": 0.0}, "x"),
    "a factor next to 1": ("(1 + 1e-9*p)*der(x)", HELD, {"p": -1e9}, "x"),
    "the same": (HELD, "(if p > 1 then der(x) else der(y))", {"p": 1.5}, "x"),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("case", sorted(CASES))
def test_rows_hold_whatever_the_parameters(case: str) -> None:
    first, second, given, held = CASES[case]
    system = lagc.loads(TEXT.format(first=first, second=second)).compile(backend="numpy")
    run = system.simulate(1.0, parameters=given)
    assert run.status == "ok", run.message
    for axis, force in zip("xyz", (1.0, 2.0, 3.0)):
        way = 0.0 if axis in held else 0.5 * force
        assert run[axis][-1] == pytest.approx(1.0 + way, abs=1e-9)


def test_rows_that_contradict_each_other_for_some_parameters_do() -> None:
    second = "der(x) - (if p > 1 then 0 else 0.5)*1 [m/s]"
    system = lagc.loads(TEXT.format(first=HELD, second=second)).compile(backend="numpy")
    assert system.simulate(1.0).status == "ok"
    with pytest.raises(Refused, match="constraint `b`"):
        system.simulate(1.0, parameters={"p": 0.5})


def test_a_row_stays_that_another_is_a_part_of_on_one_branch() -> None:
    """z comes to 2.5 m, where the first row vanishes."""
    first = "(1 - max(0, z/1 [m] - 1.5)^2)*der(x)"
    run = lagc.loads(TEXT.format(first=first, second=HELD)).compile(backend="numpy").simulate(2.0)
    assert run.status == "ok" and abs(run["x"][-1] - 1.0) < 1e-12


@pytest.mark.parametrize("second", ["2*der(x)", "-der(x)/3", "der(x) + 0*der(y)"])
def test_what_is_the_same_is_left_out(second: str) -> None:
    equations = lagc.loads(TEXT.format(first=HELD, second=second)).compile(backend="numpy").equations
    assert equations.dropped == ("row `b` is left out: it follows from `a`",)


WAGON = """model Wagon
  coordinate Length x(start = 0.2 [m]), y;
  coordinate Angle a;
  frame F = rotate_z(world, a);
  point C = {{x, y, 0}};
  body w = Solid(mass = 10 [kg], inertia = {{1, 1, 1}}, frame = F, com = C + 0.1 [m]*F.x);
  constraint front: dot(velocity(w, at = C + 1 [m]*F.x), F.y) = 0;
  constraint mid: dot(velocity(w, at = C), F.y) = 0;
  constraint rear: dot(velocity(w, at = C - 1 [m]*F.x), F.y) = 0;
  constraint aside: der(x) = 0.1 [m/s];
  output Force N = {asked};
end Wagon;
"""


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    ("asked", "shared"),
    [("reaction(front)", True), ("reaction(rear)", True), ("reaction(aside)", False), ("0*1 [N]", False)],
)
def test_reactions_that_rows_share_are_told_of(asked: str, shared: bool) -> None:
    found = lagc.loads(WAGON.format(asked=asked)).check()
    assert [fault.code for fault in found] == ["LAG0428"] * shared


@pytest.mark.parametrize("seed", range(40))
def test_rows_that_are_left_out_are_in_no_sum_that_vanishes(seed: int) -> None:
    random = Random(seed)
    m, n = random.randint(2, 7), random.randint(2, 8)
    most = [random.randint(1, 3) % n + 1 for _ in range(m)]
    rows = [{j: random.choice((-2, -1, 1, 2, 0)) for j in random.sample(range(n), k)} for k in most]
    rows.append({j: rows[0].get(j, 0) + rows[1].get(j, 0) for j in rows[0] | rows[1]})
    matrix = sympy.Matrix(m + 1, n, lambda k, j: rows[k].get(j, 0))
    left = entangled([{j: x != 0 for j, x in row.items()} for row in rows])
    assert left
    for vector in matrix.T.nullspace():
        assert {k for k in range(m + 1) if vector[k] != 0} <= set(left)


def test_rows_that_add_a_column_each_are_left_out() -> None:
    assert entangled([dict.fromkeys(range(k + 1), True) for k in range(50)]) == []
    assert entangled([{0: False}, {0: True, 1: True}, {2: True}]) == [0]
