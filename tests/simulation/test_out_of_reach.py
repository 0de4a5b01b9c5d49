"""A chain whose ends are farther apart than it is long: all of its links contradict each other, and no fewer,
since a chain with a link left out reaches any place.  No row is left out; one too many may be named."""

from __future__ import annotations

import random
import re

import pytest

from lagc.compiler.checking import check
from lagc.compiler.pipeline import Choice
from lagc.diagnostics.faults import Source


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
