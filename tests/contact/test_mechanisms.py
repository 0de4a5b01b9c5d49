"""Random mechanisms and bodies on rough floors end within their estimate or by name, and gain no energy."""

from random import Random

import pytest

import lagc
from tests.contact.mechanisms import FAMILIES, text_of

NAMED = ("is predictable to", "have no solution, or several", "was not reached", "cannot be assured")
ACCURACY = 1e-6


def _ended(family: str, seed: str, count: int) -> int:
    """Run mechanisms of a family against runs with a hundredth of the accuracy. Return how many reach their
    end."""
    draw = FAMILIES[family][1]
    system = lagc.loads(text_of(family)).compile(backend="c")
    ended = 0
    for k in range(count):
        given = draw(Random(f"{family} {seed} {k}"))
        run = system.simulate(accuracy=ACCURACY, parameters=given, points=201)
        energy, stop = run["E"], float(run.t[-1])
        assert (energy[1:] - energy[:-1]).max(initial=0.0) <= 2.0 * ACCURACY * abs(energy).max(), (k, given)
        assert run.status == "ok" or any(each in run.message for each in NAMED), (k, run.message)
        ended += run.status == "ok"
        if stop == 0.0 or run.accuracy["estimated"] > ACCURACY:
            continue
        fine = system.simulate(stop, accuracy=ACCURACY / 100.0, parameters=given, points=201)
        if fine.t[-1] == stop:
            for name, scale in run.scales.items():
                error = abs(run.final.get(name, 0.0) - fine.final.get(name, 0.0))
                assert error <= ACCURACY * scale or scale == 0.0, (k, name, error, scale, given)
    return ended


@pytest.mark.full
@pytest.mark.parametrize("family", FAMILIES)
def test_10_mechanisms_end_within_their_estimate_or_by_name(family: str) -> None:
    assert _ended(family, "few", 10) >= 8


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES)
def test_40_mechanisms_end_within_their_estimate_or_by_name(family: str) -> None:
    assert _ended(family, "many", 40) >= 36
