"""Equations of large models: some of many, with sums by their rule; they are worth what the full ones are."""

from __future__ import annotations

import re
from fractions import Fraction
from math import cos, isclose, pi, sin
from random import Random

import pytest

import lagc
from lagc.cli.main import main
from lagc.view.abridged import Series, Term, chosen, linear, series
from lagc.view.equations import write

WEIGHTED = """model W
  structural Integer n = 5;
  parameter Mass m = 1 [kg];
  coordinate Length x[n];
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + {x[i], 0, 0};
    body b[i] = Particle(mass = WEIGHT, at = P[i]);
  end for;
end W;
"""


def values(text: str, at: dict[tuple[str, int, int], float]) -> list[float]:
    """Of the left sides of the equations, with their sums and shared parts; scalars are 0.7."""

    def total(first: int, last: int, term) -> float:
        return sum(term(k) for k in range(first, last + 1))

    known = {**dict.fromkeys("lgmkFLM", 0.7), "at": at, "total": total, "sin": sin, "cos": cos, "pi": pi}
    found = []
    for left, right in (line.split(" = ", 1)[:: -1 if line[0] == "s" and line[1].isdigit() else 1]
                        for line in re.sub(r"(\w) = (\d+\.\.)", r"\1=\2", text).splitlines()
                        if " = " in line and not line.startswith("where")):  # fmt: skip
        code = re.sub(r"sum\((\w)=(\d+)\.\.(\d+), ", r"total(\2, \3, lambda \1: ", left)
        code = re.sub(r"(\w+)\[([^\]]+)\]('*)", lambda m: f"at[{m[1]!r}, {m[2]}, {len(m[3])}]", code)
        result = eval(code.replace("^", "**"), dict(known))
        if right == "0":
            found.append(result)
        else:
            known[right] = result
    return found


def lines_of(text: str) -> list[str]:
    return [line.removesuffix(" = 0") for line in text.splitlines() if line.endswith(" = 0")]


@pytest.mark.parametrize(
    ("model", "n"),
    [("classic/chain", 21), ("classic/chain", 40), ("large/lattice", 33), ("large/rope", 22), ("even", 24)],
)
def test_what_is_shown_of_many_equations_is_what_they_are(model: str, n: int) -> None:
    asked = lagc.loads(WEIGHTED.replace("WEIGHT", "m")) if model == "even" else lagc.load(model)
    equations = asked.compile(parameters={"n": n}, backend="numpy").equations
    chance, texts = Random(n), (write(equations), write(equations, full=False))
    (all_here, some_here), (all_there, some_there) = (
        [values(text, at) for text in texts]
        for at in ({(name, i, order): chance.uniform(-1, 1) for name in ("th", "u", "x", "a", "b")
                    for i in range(n + 1) for order in range(3)} for _ in range(2))
    )  # fmt: skip
    kinds = len(all_here) // n
    assert len(all_here) == kinds * n and len(some_here) == 3 * kinds
    for k, here in enumerate(some_here):  # each up to a factor
        at = k // 3 * n + (0, 1, n - 1)[k % 3]
        assert here and isclose(here * all_there[at], some_there[k] * all_here[at], rel_tol=1e-9)
    assert "sum(k = " in texts[1] or model == "large/lattice"


@pytest.mark.parametrize("n", [110, 1000])
def test_equations_of_long_chains_are_as_those_of_short_ones(n: int) -> None:
    equations = lagc.load("classic/chain").compile(parameters={"n": n}, backend="numpy").equations
    text, chance = write(equations, full=False), Random(n)
    assert len(text) < 700 and "shared" not in text
    at = {("th", k, order): chance.uniform(-1, 1) for k in range(1, n + 1) for order in range(3)}
    for i, found in zip((1, 2, n), values(text, at), strict=True):
        th = at["th", i, 0]
        true = (n + 1 - i) * 0.7 * sin(th)
        for k in range(1, n + 1):
            below, angle = n + 1 - max(i, k), th - at["th", k, 0]
            true += below * 0.7 * (cos(angle) * at["th", k, 2] + sin(angle) * at["th", k, 1] ** 2)
        assert isclose(found, true, rel_tol=1e-9)


def test_a_sum_without_a_rule_is_cut_and_says_so() -> None:
    asked = lagc.loads(WEIGHTED.replace("WEIGHT", "i^2*m"))
    equations = asked.compile(parameters={"n": 40}, backend="numpy").equations
    first = lines_of(write(equations, full=False))[0]
    assert first.endswith("*x[30]'' + ... (10 more terms)")
    assert lines_of(write(equations))[0].startswith(first.removesuffix("... (10 more terms)"))


def test_the_words_say_what_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["equations", "classic/chain", "-p", "n=100"]) == 0
    said = capsys.readouterr().out
    assert "// ... and 97 more, of der(th[3]) to der(th[99]): --full shows them" in said
    assert len(lines_of(said)) == 3
    assert main(["equations", "classic/chain", "-p", "n=30", "--format", "latex"]) == 0
    said = capsys.readouterr().out
    assert (
        r"\sum_{k=2}^{30} \left(31 - k\right) \, l \, \cos\left(\mathit{th}_{1} - \mathit{th}_{k}\right)"
        in said
    )
    assert r"\text{ and 27 more, of der(th[3]) to der(th[29]): --full shows them}" in said
    assert main(["equations", "classic/chain", "-p", "n=30", "--full"]) == 0
    said = capsys.readouterr().out
    assert len(lines_of(said)) == 30 and "sum" not in said and "more" not in said


def test_few_equations_are_all_there() -> None:
    for n in (1, 20):
        assert chosen([f"x[{k}]" for k in range(n)], False).numbers == list(range(n))
    several = [f"{c}[{k}]" for c in "abc" for k in range(10)]
    assert chosen(several, False).numbers == [0, 1, 9, 10, 11, 19, 20, 21, 29]
    assert chosen(several, True).numbers == list(range(30))
    others = chosen([chr(97 + k) for k in range(26)], False)
    assert others.numbers == list(range(20)) and others.words.startswith("and 6 more")


@pytest.mark.parametrize("seed", range(30))
def test_a_rule_has_the_terms_that_it_stands_for(seed: int) -> None:
    """Runs of random rules, mixed with other terms; written out again they are the same."""
    chance = Random(seed)
    terms: list[Term] = []
    for part in range(chance.randrange(1, 5)):
        n, a, b = chance.randrange(1, 9), chance.randrange(1, 30), chance.choice((-1, 0, 1, 2))
        c, d = Fraction(chance.randrange(-9, 9), chance.choice((1, 2, 7))), Fraction(chance.randrange(-3, 4))
        start = 20 if b < 0 else 0
        for k in range(n):
            terms.append(Term(c + k * d + 100, f"f{part}(x[{a + k}], y[{start + b * k}])"))
    chance.shuffle(terms) if seed % 3 == 0 else None
    found: list[Term] = []
    for part in series(terms, re.compile(r"(?<=\[)-?\d+(?=\])")):
        if isinstance(part, Series):
            assert part.last - part.first >= 3
            for k in range(part.first, part.last + 1):
                numbers = [str(a + b * k) for a, b in part.indices]
                text = "".join(x for pair in zip(part.pieces, [*numbers, ""]) for x in pair)
                found.append(Term(part.factor * (part.weight[0] + part.weight[1] * k), text))
        else:
            found.append(part)
    assert sorted(map(str, found)) == sorted(map(str, terms))


@pytest.mark.parametrize("start", range(-3, 4))
@pytest.mark.parametrize("step", range(-3, 4))
def test_linear_expressions_are_as_people_write_them(start: int, step: int) -> None:
    text = linear(start, step, "k")
    assert eval(text, {"k": 17}) == start + 17 * step
    assert "+ -" not in text and "- -" not in text and "1*k" not in text
