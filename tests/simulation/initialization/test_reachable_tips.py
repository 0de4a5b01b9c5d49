"""The tip of a planar chain is stated; its angles are not: a configuration is found wherever the tip can
be."""

import random
from collections.abc import Sequence
from math import cos, hypot, pi, sin

import pytest

from lagc.simulation.initialization.solver import Conditions, Consistency


def chain(lengths: Sequence[float], relative: bool) -> Conditions:
    """Unknowns: angles from the vertical, or from the link before, then x and z of the tip."""
    n = len(lengths)

    def evaluate(t: float, x: Sequence[float]) -> tuple[list[float], list[float], list[float]]:
        turned = [sum(x[: k + 1]) if relative else x[k] for k in range(n)]
        across = [length * sin(a) for length, a in zip(lengths, turned)]
        down = [-length * cos(a) for length, a in zip(lengths, turned)]
        slopes = [
            [-sum(part[k:]) if relative else -part[k] for k in range(n)]
            for part in ([-a for a in down], across)
        ]
        c = [x[n] - sum(across), x[n + 1] - sum(down)]
        sizes = [abs(x[n]) + sum(map(abs, across)), abs(x[n + 1]) + sum(map(abs, down))]
        return c, [*slopes[0], 1.0, *slopes[1], 1.0], sizes

    columns = [*range(n), n, *range(n), n + 1]
    units = [0] * n + [1, 1]
    return Conditions(
        n + 2, 0, (), units, range(n), [n + 1, 2 * n + 2], columns, evaluate, lambda: ([], [0.0, 1.0])
    )


@pytest.mark.sample(4)
@pytest.mark.parametrize("relative", [False, True])
@pytest.mark.parametrize("links", [3, 4, 5, 6, 8, 10, 12])
def test_a_tip_that_can_be_reached_is(links: int, relative: bool) -> None:
    """From straight down, where no angle lifts the tip: anywhere, and straight above (at x = 4e-16 or so)."""
    dice = random.Random(links)
    for k in range(12):
        lengths = [dice.uniform(0.5, 1.0) for _ in range(links)]
        far = sum(lengths) * dice.uniform(0.4, 0.97)
        angle = pi if k % 3 == 0 else dice.uniform(-pi, pi)
        tip = [far * sin(angle), -far * cos(angle)]
        search = Consistency(chain(lengths, relative), 0.0, [0.0] * links + tip, [0] * links + [4, 4])
        assert search.run() == 0, (lengths, tip)
        assert search.y[links:] == tip
        assert hypot(*search.evaluate(search.y)[0]) <= 1e-12 * sum(lengths)
