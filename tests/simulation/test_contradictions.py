"""Constraints that contradict each other are refused, by the smallest set of their names."""

from __future__ import annotations

import re

import pytest

from lagc.compiler.checking import check
from lagc.compiler.pipeline import Choice
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
