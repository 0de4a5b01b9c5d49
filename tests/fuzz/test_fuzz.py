"""No text makes lagc stumble: a diagnostic or a result, within bounds.  In full: `python -m tests.fuzz`."""

from __future__ import annotations

import os
import random
import string

import pytest

from tests.fuzz.mutations import library, mutated
from tests.fuzz.trial import trial

COUNT = int(os.environ.get("LAGC_FUZZ", "400"))
TEXTS = library()
BATCH = 25

pytestmark = pytest.mark.usefixtures("no_cache")


@pytest.mark.parametrize("first", range(0, COUNT, BATCH))
def test_a_mutated_model_is_refused_or_runs(first: int) -> None:
    outcomes = [trial(mutated(TEXTS, seed)) for seed in range(first, first + BATCH)]
    assert set(outcomes) <= {"refused", "failed", "ran"}


def test_mutations_are_made_by_their_seed() -> None:
    assert mutated(TEXTS, 7) == mutated(TEXTS, 7) != mutated(TEXTS, 8)


@pytest.mark.parametrize("seed", range(20))
def test_noise_is_refused(seed: int) -> None:
    chance = random.Random(seed)
    text = "".join(chance.choice(string.printable + "é\u2028\0") for _ in range(chance.randrange(1, 400)))
    assert trial(text) == "refused"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "\ufeff",
        "model M",
        "/*" * 1000,
        "(" * 100_000,
        "model M coordinate Length x; potential V = " + "(" * 5000 + "x" + ")" * 5000 + "; end M;",
        "model M coordinate Length x; potential V = 1 [J]" + " + 1 [J]" * 20_000 + "; end M;",
        "model M coordinate Length x; parameter Real k = " + "-" * 20_000 + "1; end M;",
        "model M coordinate Length x; parameter Real k = 2^999999999; end M;",
        "model M coordinate Length x; parameter Real k = " + "9" * 5000 + "; end M;",
        "model M coordinate Length x[" + "9" * 30 + "]; end M;",
        "model " + "M" * 100_000 + " end M;",
        "package P " * 3000,
        "effect e " * 3000,
        "model M for i in 1:99999 loop for j in 1:99999 loop point P[i,j] = {0,0,0};",
        "model A B b; end A; model B A a; end B;",
        "model M extends M; end M;",
        "model M function f(Real u) = g(u) + g(u); function g(Real u) = f(u) + f(u); coordinate Length x;"
        "potential V = f(1)*1 [J]; end M;",
        "model M function f0(Real u) = u + u;"
        + "".join(f"function f{k}(Real u) = f{k - 1}(u) + f{k - 1}(u);" for k in range(1, 60))
        + "coordinate Length x; potential V = f59(x/1 [m])*1 [J]; end M;",
        "model M "
        + "".join(f"parameter Real p{k} = p{k + 1};" for k in range(5000))
        + " parameter Real p5000 = 1; end M;",
    ],
    ids=range(20),
)
def test_a_wicked_text_is_answered(text: str) -> None:
    assert trial(text) in ("refused", "ran")
