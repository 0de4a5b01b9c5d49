"""Lines that differ by subscripts alone."""

import pytest

import lagc
from lagc.reports.explain import explanation
from lagc.reports.names import ranged


@pytest.mark.parametrize(
    "lines, shown",
    [
        ([f"th[{i}] [rad]" for i in range(1, 8)], ["th[1..7] [rad]"]),
        ([f"{x}[{i}].p" for i in (4, 5, 6) for x in "ab"], ["a[4..6].p", "b[4..6].p"]),
        ([f"row[{i},{j}]" for i in (1, 2) for j in (3, 4, 5)], ["row[1..2, 3..5]"]),
        ([f"c[{i}] of P[{i}].y" for i in range(3)], ["c[0..2] of P[0..2].y"]),
        (["a[1]", "a[2]"], ["a[1]", "a[2]"]),  # few
        (["a[1]", "b", "a[2]", "b", "a[4]"],) * 2,  # neither lost nor moved
        (["a[1]", "a[2]", "a[4]"], ["a[1]", "a[2]", "a[4]"]),  # with a gap
        ([f"a[{i}] at b[{i + 1}]" for i in range(3)], [f"a[{i}] at b[{i + 1}]" for i in range(3)]),
        (["a[1] starts at 1", "a[2] starts at 2", "a[3] starts at 3"],) * 2,
        (["x [1]", "x [2]", "x [3]"],) * 2,  # units
        (["first", *(f"a[{i}]" for i in (3, 1, 2)), "last"], ["first", "a[1..3]", "last"]),
    ],
)
def test_ranges(lines: list[str], shown: list[str]) -> None:
    assert ranged(lines) == shown


@pytest.mark.full
def test_what_is_too_much_is_not_examined() -> None:
    """A drive's power is told by its multiplier, which is asked of small systems alone."""
    text = """model Driven
      structural Integer n = 300;
      coordinate Length x[n], s;
      for i in 1:n loop
        body b[i] = Particle(mass = 1, at = {x[i], 0, 0});
      end for;
      body cart = Particle(mass = 1, at = {s, 0, 0});
      constraint drive: s = sin(time/(1 [s]))*1 [m];
    end Driven;"""
    small, large = (lagc.loads(text).compile(parameters={"n": n}, backend="numpy") for n in (3, 300))
    assert explanation(small.equations, small.program)["not_examined"] == []
    assert explanation(large.equations, large.program)["not_examined"] == ["energy", "total momenta"]
