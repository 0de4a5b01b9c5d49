"""Equations of any length are written: powers and products that would be long have names for their parts."""

import random
import re

import pytest
import sympy

import lagc
from lagc.diagnostics.faults import Refused
from lagc.reports.equations.write import write

NAMES = "abcd"


def written(statement: str) -> str:
    """The equations of two particles with `statement`."""
    text = f"""model P
  coordinate Length {", ".join(NAMES)};
  body p = Particle(mass = 1 [kg], at = {{a, b, c}});
  body q = Particle(mass = 1 [kg], at = {{d, 0, 0}});
  {statement}
end P;
"""
    return write(lagc.loads(text).compile(backend="numpy").equations)


def value(text: str, at: dict[str, float]) -> float:
    """The left side of the first equation of motion at `at`, accelerations 0."""
    lines = [line for line in text.splitlines() if " = " in line and not line.startswith(("//", "where"))]
    known: dict[str, object] = dict(at)
    for line in lines:
        left, right = (re.sub(r"[abcd]''", "0", side).replace("^", "**") for side in line.split(" = "))
        if right != "0":
            known[left] = sympy.sympify(right, locals=known)
            continue
        return float(sympy.sympify(left, locals=known))
    raise AssertionError(text)


@pytest.mark.full
def test_powers_and_products_of_sums_have_the_value_of_what_was_meant() -> None:
    chance = random.Random(3)
    for _ in range(25):
        factors = []
        for _ in range(chance.choice((1, 1, 2, 12))):
            terms = " + ".join(f"{chance.randrange(1, 9)}*{n}" for n in chance.sample(NAMES, 3))
            factors.append(f"({terms})^{chance.choice((1, 2, 9, 10, 13))}")
        potential = "*".join(factors)
        plain = re.sub(r"([abcd])", r"(\1/1[m])", potential)
        text = written(f"potential V = 1 [J]*{plain};")
        at = {n: chance.uniform(0.01, 0.04) for n in NAMES}
        symbols = {n: sympy.Symbol(n) for n in NAMES}
        slope = sympy.diff(sympy.sympify(potential.replace("^", "**"), locals=symbols), symbols["a"])
        expected = float(slope.subs({symbols[n]: x for n, x in at.items()}))
        found = value(text, at)
        assert found == pytest.approx(expected, rel=1e-9) or found / expected == pytest.approx(
            value(text, dict.fromkeys(NAMES, 0.03)) / float(slope.subs({symbols[n]: 0.03 for n in NAMES})),
            rel=1e-9,
        )  # each equation is the derived one up to a factor
        assert len(text) < 100_000


def test_what_is_not_finite_is_refused() -> None:
    with pytest.raises(Refused, match="LAG0590"):
        written("body r = Particle(mass = 1 [kg], at = {exp(1e200*a/1[m])*1[m], 0, 0});")


@pytest.mark.parametrize("outer", ["sqrt({})", "1/({})", "1/sqrt({})", "({})^1.5"])
def test_long_sums_below_roots_and_lines_are_written_once(outer: str) -> None:
    inner = "1 + (a + 2*b + 3*c + 4*d + 5)^2 + (b - c*d)^2"
    plain = re.sub(r"([abcd])", r"(\1/1[m])", inner)
    text = written(f"potential V = 1 [J]*{outer.format(plain)};")
    assert text.count("s1 = ") == 1
    at = dict(zip(NAMES, (0.3, -0.2, 0.7, 0.1)))
    symbols = {n: sympy.Symbol(n) for n in NAMES}
    slope = sympy.diff(sympy.sympify(outer.format(inner).replace("^", "**"), locals=symbols), symbols["a"])
    ratio = [
        value(text, x) / float(slope.subs({symbols[n]: x[n] for n in NAMES})) for x in (at, {**at, "b": 0.4})
    ]
    assert ratio[0] == pytest.approx(ratio[1], rel=1e-12)


def test_a_ladder_is_written_on_a_page() -> None:
    text = write(lagc.load("large/truss").compile(backend="numpy").equations)
    roots = re.findall(r"sqrt\(((?:[^()]|\([^()]*\))*)\)", text)
    assert len(text) < 6000
    assert all(roots.count(root) == 1 or len(re.split(" [+-] ", root)) <= 12 for root in roots)
