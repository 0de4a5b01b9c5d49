"""Different things have different names on paper, and legends say what short ones stand for."""

import re
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.equations.latex import LatexWriter, alike
from lagc.reports.equations.page import page
from lagc.reports.equations.write import write
from lagc.reports.names import Name, names
from lagc.reports.patterns.formula_trees import Symbol, indices
from lagc.symbolic.graph import Node
from tests.reports.models import MODELS, derived, equations_of, rows

MODEL = """model Names
  parameter Mass m = 1 [kg];
  parameter Length lambda_follow = 1 [m], t = 2 [m];
  coordinate Length x, y, sine;
  body b = Particle(mass = m, at = {x, y, sine});
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  constraint follow: x + lambda_follow = table(time, "path.csv", "x", "cubic");
  constraint other: y + t = table(time, "path.csv", "t", "cubic") + table(time, "path.csv", "sin", "cubic");
  constraint third: sine = table(x, {1, 2, 3, 4}, {0, 0, 0, 1} [m], "cubic")
    + table(time, "path.csv", "lambda_third", "cubic");
end Names;
"""


def with_tables(folder: Path) -> EquationsOfMotion:
    (folder / "path.csv").write_text(
        "s,x [m],t [m],sin [m],lambda_third [m]\n0,0,1,0,7\n1,2,3,5,1\n2,1,8,9,9\n"
    )
    (folder / "names.lag").write_text(MODEL)
    return lagc.load(str(folder / "names.lag")).compile().equations


def test_tables_and_multipliers_have_names_of_their_own(tmp_path: Path) -> None:
    text = write(with_tables(tmp_path))
    assert "x - x_table(time) + lambda_follow = 0" in text
    assert "y - t_table(time) - sin_table(time) + t = 0" in text
    assert "sine - table(x) - lambda_third_table(time) = 0" in text
    assert "multiplier_follow" in text and "table'(x)*lambda_third" in text
    assert "where g = field.g, lambda_third_table = column lambda_third of path.csv, " in text


def test_scripts_declare_tables(tmp_path: Path) -> None:
    pytest.importorskip("sympy")
    script = write(with_tables(tmp_path), "sympy")
    assert "x_table = sympy.Function('x_table', real=True)  # column x of path.csv\n" in script
    assert "\ntable = sympy.Function('table', real=True)\n" in script
    assert "g = sympy.Symbol('g', real=True)  # m/s2, field.g, acceleration of gravity\n" in script
    space: dict[str, Any] = {"__name__": "script"}
    exec(script, space)
    found = set().union(
        *[{str(x.func) for x in e.atoms(space["sympy"].Function)} for e in space["equations"]]
    )
    symbols = set().union(*[e.free_symbols for e in space["equations"]])
    assert {"x", "x_table", "t_table", "sin_table", "lambda_third", "lambda_third_table"} <= found
    assert {"t", "time", "lambda_follow", "g", "m"} >= {x.name for x in symbols} >= {"t", "time"}


def test_what_files_call_columns_stays_within_a_comment(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text('s,"u\x1b[31m %}\x00\u2028import os"\n0,1\n1,2\n')
    (tmp_path / "a.lag").write_text(
        "model A coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0});\n"
        'force f = {table(time, "d.csv"), 0, 0} at b; end A;\n'
    )
    equations = lagc.load(str(tmp_path / "a.lag")).compile().equations
    for form in ("text", "latex", "sympy"):
        assert not re.search("[\x00\x1b\u2028]", write(equations, form))
    compile(write(equations, "sympy"), "script", "exec")


ALIKE = """model Part
  parameter Real k = 1, omega_turn_x = 1, i = 1;
end Part;
model Alike
  parameter Mass m = 1 [kg], mu_a = 1 [kg], mu_a_ = 1 [kg];
  parameter Stiffness k1 = 1 [N/m], k_1 = 2 [N/m], K1 = 3 [N/m], K[2] = {1, 2}, K_1 = 1 [N/m];
  parameter Real k_a = 1, a_k = 1, pi_ = 1, lambda_ = 1, lambda = 2, t_ = 1, kappa_i = 1, lambda__c = 1;
  parameter Real a_1_k = 3, omega_turn_x = 4, x__1 = 1, x_1_ = 1;
  Part a, b[2];
  coordinate Length x(start = 1 [m]), x_, x1, x_1, xs[2], xs_1;
  coordinate Orientation turn;
  body one = Particle(mass = m, at = {x, x_, x1});
  body two = Particle(mass = m + mu_a + mu_a_, at = {x_1, xs[1], xs[2] + xs_1});
  body three = Particle(mass = m, at = {xs_1, 0, 0});
  body solid = Solid(mass = m, inertia = {1, 2, 3} [kg.m2], frame = rotate(world, turn), com = {0, 0, 0});
  potential V = (1 [J])*pi_*(k_a + a.k + b[1].k + b[2].k + a_1_k + omega_turn_x + pi)*sin(time*t_/(1 [s]));
  constraint c: x + x_1 + lambda*lambda_*lambda__c*x1 = 0;
end Alike;
"""


def printed(equations: EquationsOfMotion) -> list[tuple[Name, str]]:
    """Each symbol of the page, and how it is written in LaTeX."""
    found = page(equations)
    writer = LatexWriter(found.names)
    parts = {
        of: Symbol(of, "", indices(name.base)) for of, name in found.names.items() if isinstance(of, Node)
    }
    return list({(found.names[of], writer.symbol(x, 1)) for of, x in parts.items()})


def test_distinct_names_are_distinct_in_latex() -> None:
    found = printed(equations_of(ALIKE))
    written = [text for _, text in found]
    assert len(set(written)) == len(written)
    text = {name.base: text for name, text in found if name.order == 0}
    assert (text["k1"], text["k_1"], text["x_"]) == ("k_{1}", r"\mathit{k\_1}", r"\mathit{x\_}")
    assert (text["K[1]"], text["K1"], text["K_1"]) == ("K_{1}", r"\mathit{K1}", r"\mathit{K\_1}")
    assert (text["xs[2]"], text["xs_1"]) == (r"\mathit{xs}_{2}", r"\mathit{xs\_1}")
    assert (text["pi"], text["pi_"], text["lambda"]) == (r"\pi", r"\mathit{pi\_}", r"\lambda")
    assert text["mu_a"] == r"\mu_{a}"


@pytest.mark.sample(1, 11)
@pytest.mark.parametrize("path", sorted(MODELS.rglob("*.lag")), ids=lambda path: path.stem)
def test_no_name_of_the_library_collides(path: Path) -> None:
    """And each is written by its letters."""
    found = page(derived(str(path.relative_to(MODELS).with_suffix(""))), full=False)
    assert alike(found.names) == set()


def test_the_rule_does_not_depend_on_the_order_of_declarations() -> None:
    lines = ["parameter Stiffness k_1 = 2 [N/m];", "parameter Stiffness k1 = 1 [N/m];"]
    text = (
        "model A\n{}\ncoordinate Length x; body b = Particle(mass = 1, at = {{x, 0, 0}});\n"
        "potential V = (k1 + 2*k_1)*x^2; end A;"
    )
    both = [write(equations_of(text.format("\n".join(order))), "latex") for order in (lines, lines[::-1])]
    assert all(r"2 \, \mathit{k\_1}" in one and "k_{1}" in one for one in both)


def test_counters_are_no_subscripts() -> None:
    text = (
        "model A parameter Mass m_i = 1 [kg]; coordinate Length x[14];\n"
        "for j in 1:14 loop body b[j] = Particle(mass = m_i, at = {x[j], 0, 0}); "
        "potential V[j] = m_i*x[j]^4*(1 [1/(m2.s2)]); end for; end A;"
    )
    assert "for j = 1..14" in write(equations_of(text), full=False)


@pytest.mark.full
def test_names_that_would_be_alike_are_read_by_another_program() -> None:
    mathtext = pytest.importorskip("matplotlib.mathtext")
    lines = rows(write(equations_of(ALIKE), "latex"))
    assert any(r"\mathit{x\_1}" in line for line in lines)
    assert all(mathtext.MathTextParser("path").parse(f"${line}$").width > 0.0 for line in lines)


def test_legends_are_text_that_tex_reads(tmp_path: Path) -> None:
    """Braces are balanced, and what TeX takes for more than itself stands escaped."""
    name = "a_b%#&$ {c}^~.csv"
    (tmp_path / name).write_text("s,u [N]\n0,1\n1,2\n")
    (tmp_path / "a.lag").write_text(
        "model A coordinate Length x; body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        f'force f = {{table(time, "{name}"), 0, 0}} at b; end A;\n'
    )
    text = write(lagc.load(str(tmp_path / "a.lag")).compile().equations, "latex").partition("\nwhere ")[2]
    assert text == (r"$u$ is \texttt{column u of a\_b\%\#\&\$ \{c\}\textasciicircum{}\textasciitilde{}.csv}")


def test_no_two_names_are_alike(tmp_path: Path) -> None:
    bases = [(name.base, name.full, name.order) for name in names(with_tables(tmp_path)).values()]
    assert len({base for base, _, _ in bases}) == len({full for _, full, _ in bases})
