"""Equations of large models by their rules: written out, they are the equations of all elements. Lines that
differ by subscripts alone."""

from fractions import Fraction
from math import isclose
from random import Random

import pytest

import lagc
from lagc.cli.main import main
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.equations.page import page
from lagc.reports.equations.plain_text import TextWriter
from lagc.reports.equations.write import write
from lagc.reports.explain import explanation
from lagc.reports.names import ranged
from lagc.reports.patterns.formula_trees import Linear, Series, Symbol, Term, Total, all_of, terms_of, value
from lagc.reports.patterns.index_rules import FEW, _are_equal, _key, rule, summed
from lagc.symbolic.graph import Graph, Node
from lagc.symbolic.walk import evaluate
from tests.reports.models import rows
from tests.reports.scripts import ruled_residuals, values_at

CHAIN = """model Tip
  structural Integer n = 5;
  parameter Mass m(min = 0) = 1 [kg], M(min = 0) = 3 [kg];
  parameter Length l(min = 0) = 0.2 [m], L(min = 0) = 0.5 [m];
  coordinate Angle th[n](each start = 30 [deg]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + LENGTH*{sin(th[i]), 0, -cos(th[i])};
    body bob[i] = Particle(mass = MASS, at = P[i]);
  end for;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  FURTHER
end Tip;
"""
TIP = "body tip = Particle(mass = M, at = P[n]);"
SPRING = "potential spring = 0.5*7 [N.m/rad2]*(th[8] - th[9])^2;"
LARGE = ("chain", "relative_chain", "rope", "ball_chain", "mobile", "truss", "lattice", "n_body")


def chain(n: int, length: str = "l", mass: str = "m", further: str = "") -> EquationsOfMotion:
    text = CHAIN.replace("LENGTH", length).replace("MASS", mass).replace("FURTHER", further)
    return lagc.loads(text).compile(parameters={"n": n}, backend="numpy").equations


def large(name: str, n: int) -> EquationsOfMotion:
    model = lagc.load(f"{'classic' if name == 'chain' else 'large'}/{name}")
    return model.compile(parameters={"n": n + (name == "mobile")}, backend="numpy").equations


def a_state(equations: EquationsOfMotion, seed: int) -> dict[Node, float]:
    chance = Random(seed)
    moving = (*equations.q, *equations.v, *equations.a, *equations.lam)
    state = {node: chance.uniform(-1, 1) for node in moving}
    for i in equations.quaternions:
        parts = equations.q[i : i + 4]
        size = sum(state[x] ** 2 for x in parts) ** 0.5
        state |= {x: state[x] / size for x in parts}
    given = [*equations.model.parameters, *equations.model.inputs]
    state |= {x.symbol: 1.0 for x in equations.model.discretes}
    return state | {equations.time: 0.0} | {x.symbol: x.value for x in given if x.value is not None}


def derived(equations: EquationsOfMotion, state: dict[Node, float]) -> list[float]:
    """What is zero, in the order of the speeds and rows: M a + h - tau - G^T lam, and the residuals."""
    columns = [
        equations.inertial_forces,
        list(equations.bias_forces),
        list(equations.given_forces),
        equations.constraint_forces,
    ]
    values = [evaluate(column, state) for column in columns]
    rows = evaluate([row.residual for row in equations.rows], state)
    return [*[a + h - tau - g for a, h, tau, g in zip(*values)], *rows]


def check(equations: EquationsOfMotion) -> None:
    """The script by rules has all equations, each up to a factor."""
    text = write(equations, "sympy", full=False)
    found, true = [], []
    for seed in (1, 2):
        state = a_state(equations, seed)
        residuals = ruled_residuals(text, values_at(equations, state), 0.0)
        for name in equations.q_names:  # q' = N v
            assert abs(residuals.pop(name, 0.0)) < 1e-12
        found.append(residuals)
        labels = [*equations.v_names, *[row.label for row in equations.rows]]
        true.append(dict(zip(labels, derived(equations, state), strict=True)))
    assert sorted(found[0]) == sorted(true[0])
    for label, x in found[0].items():
        assert isclose(x * true[1][label], found[1][label] * true[0][label], rel_tol=1e-7, abs_tol=1e-9), (
            label
        )


@pytest.mark.sample(0, 3)
@pytest.mark.parametrize("name", LARGE)
def test_equations_by_rules_are_the_derived_ones(name: str) -> None:
    check(large(name, 20))


@pytest.mark.full
def test_a_net_is_written_by_rules() -> None:
    equations = lagc.load("large/net").compile(parameters={"n": 7}, backend="numpy").equations
    check(equations)
    assert len(page(equations, full=False).lines) == 29


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", LARGE)
def test_equations_fit_on_pages_whatever_their_number(name: str) -> None:
    few, many = (write(large(name, n), full=False) for n in (20, 100 if name != "n_body" else 30))
    assert len(few.splitlines()) <= 100 and len(many) < 8000
    if name != "mobile":  # a tree has a level more
        assert len(few.splitlines()) == len(many.splitlines())


@pytest.mark.sample(0, 3)
@pytest.mark.parametrize(
    ("how", "most"),
    [
        ({"further": TIP}, 1),
        ({"mass": "if i == n then M else m"}, 2),
        ({"length": "(if i == 9 then L else l)"}, 34),
        ({"further": SPRING}, 4),
        ({"mass": "i*m"}, 55),
        ({"mass": "(i^2 + 1)*m"}, 55),
    ],
)
def test_what_breaks_the_pattern_stands_apart(how: dict[str, str], most: int) -> None:
    equations = chain(20, **how)
    check(equations)
    found = page(equations, full=False).lines
    assert len(found) <= most
    if how == {"further": SPRING}:
        assert [x.indices for x in found if not x.counters] == [(8,), (9,)]


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", ["chain", "relative_chain", "ball_chain", "mobile", "n_body"])
def test_compiled_accelerations_solve_equations_by_rules(name: str) -> None:
    model = lagc.load(f"{'classic' if name == 'chain' else 'large'}/{name}")
    system = model.compile(parameters={"n": 21}, backend="numpy")
    equations = system.equations
    text, state = write(equations, "sympy", full=False), a_state(equations, 3)
    off = ruled_residuals(text, values_at(equations, state), 0.0)
    rates = system.rhs(0.0, [state[x] for x in (*equations.q, *equations.v)])
    state |= dict(zip(equations.a, rates[len(equations.q) :]))
    zero = ruled_residuals(text, values_at(equations, state), 0.0)
    assert all(abs(x) < 1e-9 * max(map(abs, off.values())) for x in zero.values())


@pytest.mark.full
@pytest.mark.parametrize("name", ["chain", "lattice", "n_body"])
def test_a_rule_stands_for_the_terms_of_all_equations(name: str) -> None:
    equations = large(name, 14)
    ruled = [line for whole in page(equations, full=False).lines for line in all_of(whole)]
    plain = page(equations).lines
    by_label = {(line.kind, line.indices, line.label[:6]): line for line in plain}
    assert len(ruled) == len(plain)
    for line in ruled:
        assert _are_equal(line, by_label[line.kind, line.indices, line.label[:6]])


@pytest.mark.full
def test_a_chain_of_any_length_is_one_equation(capsys: pytest.CaptureFixture[str]) -> None:
    for n in (13, 60):
        assert main(["equations", "classic/chain", "-p", f"n={n}"]) == 0
        said = capsys.readouterr().out
        assert said.count(" = 0") == 1 and f"for i = 1..{n}" in said
        assert f"sum(k = i + 1..{n}, ({n + 1} - k)*l*cos(th[i] - th[k])*th[k]'')" in said
    assert main(["equations", "classic/chain", "-p", "n=30", "--format", "latex"]) == 0
    said = capsys.readouterr().out
    assert (
        r"\sum_{k=i + 1}^{30} \left(31 - k\right) \, l \, \cos\left(\mathit{th}_{i} - \mathit{th}_{k}\right)"
        in said
    )
    assert r"\quad \text{for } i = 1, \ldots, 30" in said
    assert main(["equations", "classic/chain", "-p", "n=30", "--full"]) == 0
    said = capsys.readouterr().out
    assert said.count(" = 0\n") == 30 and "sum" not in said and "more" not in said


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", LARGE)
def test_latex_of_rules_is_read_by_another_program(name: str) -> None:
    """matplotlib's reader of formulas stands in for TeX."""
    mathtext = pytest.importorskip("matplotlib.mathtext")
    reader = mathtext.MathTextParser("path")
    body = write(large(name, 20), "latex", full=False)
    assert r"\mathrm{2" not in body
    for line in rows(body):
        formula = f"${line}$"
        assert reader.parse(formula).width > 0.0, formula


@pytest.mark.full
def test_the_longest_chains_are_recursions() -> None:
    equations = large("chain", 400)
    text = write(equations, full=False)
    assert "s1[i] = " in text and len(text.splitlines()) < 40


@pytest.mark.parametrize("seed", range(30))
def test_a_series_has_the_terms_that_it_stands_for(seed: int) -> None:
    """Runs of random rules, mixed with other terms; written out again they are the same."""
    chance, graph = Random(seed), Graph()
    nodes = [graph.symbol("x", str(k)) for k in range(5)]
    terms: list[Term] = []
    for part in range(chance.randrange(1, 5)):
        n, a, b = chance.randrange(1, 9), chance.randrange(1, 30), chance.choice((-1, 0, 1, 2))
        c, d = Fraction(chance.randrange(-9, 9), chance.choice((1, 2, 7))), Fraction(chance.randrange(-3, 4))
        start = 20 if b < 0 else 0
        for k in range(n):
            symbols = [Symbol(nodes[part], part, (a + k,)), Symbol(nodes[4], 4, (start + b * k,))]
            terms.append(Term(False, c + k * d + 100, tuple([(x, 1) for x in symbols])))
    chance.shuffle(terms) if seed % 3 == 0 else None
    found = summed(Total(tuple(terms)), set()).terms
    back = [term for part in found for term in terms_of(part, {})]
    assert sorted(map(repr, map(_key, back))) == sorted(map(repr, map(_key, terms)))
    if len(terms) <= FEW:
        assert not any(isinstance(part, Series) for part in found)


def test_decimals_follow_a_rule_but_for_rounding() -> None:
    made = rule([[Fraction(repr(0.1 * k)), k] for k in range(3, 30)], "k")
    assert made is not None and made.numbers == [Linear(0, (("k", Fraction(1, 10)),)), Linear(0, (("k", 1),))]
    assert rule([[Fraction(1, 10), 0]] * 4, "k") is None


@pytest.mark.parametrize("start", range(-3, 4))
@pytest.mark.parametrize("step", [-3, -2, -1, 1, 2, 3])
def test_linear_expressions_are_as_people_write_them(start: int, step: int) -> None:
    number = Linear(start, (("k", step),))
    text = TextWriter({}).number(number)
    assert eval(text, {"k": 17}) == start + 17 * step == value(number, {"k": 17})
    assert "+ -" not in text and "- -" not in text and "1*k" not in text


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(
    "name", ["chain", "relative_chain", "rope", "ball_chain", "mobile", "truss", "n_body"]
)
def test_energies_of_large_models_are_written(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = f"{'classic' if name == 'chain' else 'large'}/{name}"
    assert main(["explain", path, "-p", "n=25"]) == 0
    said = capsys.readouterr().out
    block = said.split("\nenergy\n")[1].split("\n\n")[0]
    assert "K2 = " in block and "parts)" not in block.splitlines()[0]


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
