"""Constraints that contradict each other are refused, by the smallest set of their names."""

import random
import re

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source

T = "1 [m/s]*time"
CASES = [
    # At the level of positions, of speeds and of accelerations.
    ("constraint a: x = y; constraint b: 2*x = 2*y + 1 [m];", "LAG0610", "ab"),
    ("constraint a: x^2 + y^2 = 1 [m2]; constraint b: x^2 + y^2 = 4 [m2];", "LAG0610", "ab"),
    ("constraint a: x = 0; constraint b: der(x) = 1 [m/s];", "LAG0610", "ab"),
    (f"constraint a: x = {T}; constraint b: x = 2*{T};", "LAG0610", "ab"),
    (f"constraint a: x = {T}*time/1 [s]; constraint b: x = 2*{T}*time/1 [s];", "LAG0614", "ab"),
    # Others that take no part are not named; the last is a sum of others.
    ("constraint c: z = 1 [m]; constraint a: x = y; constraint d: z = x; constraint b: x = y + 1 [m];",
     "LAG0610", "ab"),
    ("constraint a: der(x) = der(y); constraint b: der(y) = z/1 [m]*der(z); "
     "constraint c: der(x) = z/1 [m]*der(z) - 1 [m/s];", "LAG0610", "abc"),
    (f"constraint a: x = {T}*time/1 [s] + y; constraint b: y = z; constraint d: x + y = 1 [m]; "
     f"constraint c: x - 2*{T}*time/1 [s] = z;", "LAG0614", "abc"),
    # A fixed value takes part.
    ("coordinate Length u(start = 1 [m], fixed = true); constraint a: u = 2 [m] + 0*x;", "LAG0610", "a"),
]  # fmt: skip


@pytest.mark.parametrize("lines, code, named", CASES)
def test_the_smallest_set_is_named(lines: str, code: str, named: str) -> None:
    head = "model M coordinate Length x, y, z(start = 1); body p = Particle(mass = 1, at = {x, y, z});"
    more = "body q = Particle(mass = 1, at = {u, 0, 0});" if "u(" in lines else ""
    faults = [f for f in check(Source("m.lag", f"{head} {lines} {more} end M;"), Choice())
              if f.severity == "error"]  # fmt: skip
    assert [fault.code for fault in faults] == [code]
    labels = re.findall(r"`([a-z])`", faults[0].message)
    assert sorted(labels) == [*named, *(["u"] if "u(" in lines else [])]
    assert faults[0].span is not None and len(faults[0].related) == len(labels) - 1
    assert faults[0].remedy


@pytest.mark.parametrize("other", ["x = 5 [m]", "x*y = 5 [m]*y"])
def test_rows_that_depend_and_hold_together_are_none(other: str) -> None:
    text = (
        "model M coordinate Length x(start = 5), y(start = 1); body p = Particle(mass = 1, at = {x, y, 0}); "
        f"constraint a: x^2 = 25 [m2]; constraint b: {other}; potential V = 1 [N]*y; end M;"
    )
    assert [fault.code for fault in check(Source("m.lag", text), Choice())] == []


def chain(links: int, reach: float, by_rows: bool, rng: random.Random) -> str:
    """Points in a plane, the last of them put in its place by rows, or by its geometry."""
    free = links if by_rows else links - 1
    starts = [(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)) for _ in range(free)]
    points = ["{0, 0, 0}", *(f"{{x{i}, y{i}, 0}}" for i in range(1, free + 1)), f"{{{reach}, 0, 0}} [m]"]
    text = [f"coordinate Length x{i}(start = {x}), y{i}(start = {y});" for i, (x, y) in enumerate(starts, 1)]
    text += [f"body b{i} = Particle(mass = 1, at = {points[i]});" for i in range(1, free + 1)]
    text += [f"point P{i} = {points[i]};" for i in range(links + 1)]
    text += [f"constraint link{i}: norm(P{i} - P{i - 1}) = 1 [m];" for i in range(1, links + 1)]
    text += [f"constraint closed: P{links} = {points[-1]};"] if by_rows else []
    return "model A " + "\n".join(text) + "\nend A;"


@pytest.mark.sample(1, 4)
@pytest.mark.parametrize("by_rows", [True, False])
@pytest.mark.parametrize("links", range(2, 7))
def test_all_rows_of_a_chain_that_does_not_reach_are_named(links: int, by_rows: bool) -> None:
    """A chain whose ends are farther apart than it is long; with a link left out it reaches any place.  No
    equation is left out; one too many may be named."""
    rng = random.Random(10 * links + by_rows)
    expected = {*(f"link{i}" for i in range(1, links + 1)), *(["closed[1]"] if by_rows else [])}
    exact = 0
    for most in (1.1, 6.0):
        text = chain(links, round(links * rng.uniform(1.02, most), 3), by_rows, rng)
        (fault,) = check(Source("a.lag", text), Choice())
        assert fault.code == "LAG0610"
        named = set(re.findall("constraint `([^`]*)`", fault.message))
        hidden = int((re.findall(r"(\d+) more", fault.message) or ["0"])[0])
        assert len(expected - named) <= hidden and named - expected <= {"closed[2]"}, fault.message
        assert "rate of" not in fault.message
        exact += named <= expected
    assert exact > 0
