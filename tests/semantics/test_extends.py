"""Models that extend others in several ways; what is given on the way."""

from typing import Any

import pytest

from lagc.diagnostics.faults import Refused, Source
from lagc.semantics.instantiate import Builder
from lagc.semantics.names.scope import DEEPEST
from lagc.semantics.scenes import Variant, variants
from lagc.syntax.parse import parse
from tests.semantics.reading import read

BASE = """
partial model A
  parameter Real m = 1; parameter Real k = 1;
  coordinate Length x;
  effect e end e;
  scene s uses e;
end A;
partial model B extends A(m = 2); parameter Real own = 5; end B;
partial model C extends A(m = 3, k = 3); end C;
"""


def parameters(text: str, **choice: Any) -> dict[str, float | None]:
    return {p.name: p.value for p in read(text, **choice).parameters}


@pytest.mark.parametrize(
    ("model", "m", "k"),
    [
        ("extends B; extends C;", 2, 3),
        ("extends C; extends B;", 3, 3),
        ("extends A; extends B;", 2, 1),
        ("extends B; extends A;", 2, 1),
        ("extends B; extends A(m = 9);", 9, 1),  # the nearest to the model that is meant
        ("extends B; extends C(m = 9);", 9, 3),
        ("extends B(k = 8); extends C(m = 9, k = 7);", 9, 8),
        ("extends A; extends A(m = 4);", 4, 1),
    ],
)
def test_a_model_that_is_extended_in_several_ways_is_there_once(model: str, m: float, k: float) -> None:
    found = read(BASE + f"model D {model} end D;")
    values = {p.name: p.value for p in found.parameters}
    assert (values["m"], values["k"]) == (m, k)
    assert [c.name for c in found.coordinates] == ["x"]
    assert (found.scene, [e.name for e in found.effects]) == ("s", ["e"])
    within = parameters(BASE + f"model D {model} end D; model M D d(m = 0), e; end M;")
    assert (within["d.m"], within["d.k"], within["e.m"]) == (0, k, m)


def test_declarations_stand_where_the_first_way_has_them() -> None:
    found = read(BASE + "model D parameter Real a; extends B; parameter Real z; extends C; end D;")
    assert [p.name for p in found.parameters] == ["a", "m", "k", "own", "z"]


def test_other_models_with_names_of_each_other_are_refused_still() -> None:
    with pytest.raises(Refused) as refused:
        read(BASE + "partial model E parameter Real m = 1; end E; model D extends A; extends E; end D;")
    assert [f.code for f in refused.value.faults] == ["LAG0202"]


TWICE = "partial model A{1} extends A{0}; extends A{0}(m = {1}); end A{1};"
ARMS = (
    "partial model B{1} extends A{0}; end B{1}; partial model C{1} extends A{0}(m = {1}); end C{1};"
    "partial model A{1} extends B{1}; extends C{1}; end A{1};"
)


@pytest.mark.parametrize(("level", "steps"), [(TWICE, 1), (ARMS, 2)])
def test_work_is_in_proportion_to_what_is_written(
    level: str, steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There are 2^60 or 2^30 ways."""
    levels = DEEPEST // steps - 2
    text = "partial model A0 parameter Real m = 0; coordinate Length x; scene s; end A0;"
    text += "".join(level.format(i, i + 1) for i in range(levels)) + f"model M extends A{levels}; end M;"
    calls = []
    meant = Builder._extends

    def extends(self: Builder, *arguments: Any) -> None:
        calls.append(arguments)
        meant(self, *arguments)

    monkeypatch.setattr(Builder, "_extends", extends)
    assert parameters(text) == {"m": levels}
    assert len(calls) == text.count("extends")
    assert variants(parse(Source("m.lag", text))) == [Variant("M", "s")]


@pytest.mark.sample(1)
@pytest.mark.parametrize("level", [TWICE, ARMS])
def test_what_extends_too_deep_is_refused(level: str) -> None:
    text = "partial model A0 coordinate Length x; end A0;"
    text += "".join(level.format(i, i + 1).replace(f"(m = {i + 1})", "") for i in range(1000))
    with pytest.raises(Refused) as refused:
        read(text + "model M extends A1000; coordinate Length x; end M;")
    assert {f.code for f in refused.value.faults} == {"LAG0218"}


def test_models_that_extend_each_other_are_refused() -> None:
    text = "partial model A extends B; end A; partial model B extends C; extends A; end B;"
    with pytest.raises(Refused) as refused:
        read(text + "partial model C end C; model M extends A; coordinate Length x; end M;")
    assert [f.code for f in refused.value.faults] == ["LAG0205"]


def test_what_is_given_further_out_counts_within_instances() -> None:
    text = (
        "model P parameter Real n = 5; parameter Real k = 5; coordinate Length x; output Real y = n; end P;"
        "partial model A P p(k = 0); end A; partial model B extends A(p(n = 1, k = 1)); end B;"
        "model D extends B(p(n = 2)); end D;"
    )
    assert parameters(text) == {"p.n": 2, "p.k": 1}
    assert parameters(text + "model M D d(p(n = 3)), e; end M;") == {
        "d.p.n": 3,
        "d.p.k": 1,
        "e.p.n": 2,
        "e.p.k": 1,
    }
