"""The exercises of `docs/course.md`: the formulas of derivations against those of the books, by SymPy."""

import re
from typing import Any

import pytest

from lagc.reports.derivation.derivation import Derivation
from lagc.reports.derivation.document import Formulas
from lagc.reports.patterns.formula_trees import Call, Form, Series, Symbol, Term, Total
from lagc.symbolic.graph import Node
from lagc.symbolic.sympy import to_sympy
from tests.derivation.course import ROOT, about_of, derivation_from, exercises
from tests.derivation.values import solution

sympy = pytest.importorskip("sympy")

LIBRARY = ROOT / "models"
POSITIVE = {"m", "l", "M", "A", "C", "l0", "l1", "l2", "m1", "m2", "g", "R", "gamma"}
MARKS = {"rate": "d_", "acceleration": "dd_", "virtual": "v_", "multiplier": "lam_"}


def letter(node: Node) -> Any:
    """The symbol of SymPy: `d_theta` of a rate, `dd_theta` of a second derivative, `v_theta` of a virtual
    velocity, `lam_slide` of a multiplier."""
    record = node.record
    name = record.owner.rpartition(".")[2].removeprefix("der(").removesuffix(")")
    return sympy.Symbol(
        MARKS.get(record.kind, "") + name, positive=name in POSITIVE and record.kind == "parameter"
    )


def as_sympy(form: Form | Term | Series, found: Derivation) -> Any:
    if isinstance(form, Total):
        return sympy.Add(*[as_sympy(x, found) for x in form.terms])
    if isinstance(form, Term):
        sign = -1 if form.negative else 1
        factors = [as_sympy(f, found) ** sympy.Rational(str(e)) for f, e in form.factors]
        return sympy.Mul(sign * sympy.Rational(str(form.size)), *factors)
    if isinstance(form, Call):
        return getattr(sympy, {"abs": "Abs"}.get(form.op, form.op))(*[as_sympy(x, found) for x in form.args])
    assert isinstance(form, Symbol)
    meaning = found.meanings.get(form.node)
    return letter(form.node) if meaning is None else to_sympy([meaning], letter)[0]


def shown(found: Derivation, about: str) -> Any:
    """The formula about something in a solution."""
    ((form, _),) = next(w.forms for w in found.written if w.about == about)
    return as_sympy(form, found)


def from_text(text: str, found: Any) -> Any:
    """The book's expression in the symbols of `found`, and others by their names."""
    text = re.sub(r"virtual\((\w+)\)", r"v_\1", re.sub(r"lambda\((\w+)\)", r"lam_\1", text))
    text = re.sub(r"(\w+)''", r"dd_\1", text.replace("^", "**"))
    text = re.sub(r"\bt\b", "time", re.sub(r"(\w+)'", r"d_\1", text))
    words = set(re.findall(r"[a-zA-Z_]\w*", text)) - {"sin", "cos", "tan"}
    names = {word: sympy.Symbol(word, positive=word in POSITIVE) for word in words}
    return sympy.sympify(text, {**names, **{str(x): x for x in found.free_symbols}})


def equations_of_lagrange(L: Any, names: list[str]) -> list[Any]:
    """d/dt(dL/dq') - dL/dq for each coordinate (J. L. Lagrange, 1788)."""
    letters = {str(x): x for x in L.free_symbols}

    def of(mark: str, name: str) -> Any:
        return letters.get(mark + name, sympy.Symbol(mark + name))

    def change(x: Any) -> Any:
        rates = [x.diff(of("", q)) * of("d_", q) + x.diff(of("d_", q)) * of("dd_", q) for q in names]
        return sympy.Add(x.diff(of("", "time")), *rates)

    return [change(L.diff(of("d_", q))) - L.diff(of("", q)) for q in names]


ROWS = [(x.source, *row) for x in exercises() for row in x.rows]


@pytest.mark.sample(20)
@pytest.mark.parametrize(
    "source, step, latex, book, said", ROWS, ids=[f"{k}-{x[1]}" for k, x in enumerate(ROWS)]
)
def test_both_columns_are_equal(source: str, step: str, latex: str, book: str, said: str) -> None:
    equations, found = derivation_from(source)
    formula = shown(found, about_of(step, equations))
    answer = from_text(book, formula)
    if said == ", up to d/dt":
        names = [c.name for c in equations.model.coordinates]
        assert not any(map(sympy.simplify, equations_of_lagrange(formula - answer, names)))
        return
    factor = re.fullmatch(r", times `(.*)`", said)
    assert said == "" or factor
    answer *= from_text(factor[1], formula) if factor else 1
    assert sympy.simplify(formula - answer) == 0, formula


def test_formulas_are_those_of_the_derivation() -> None:
    """Each is a row, or a row that goes on from the one with its left side."""
    for exercise in exercises():
        _, found = derivation_from(exercise.source)
        written = set()
        for row in [row for block in found.blocks if isinstance(block, Formulas) for row in block.rows]:
            right = "".join(row.lines) + row.note.rstrip()
            written |= {right, f"{row.left} = {right}"}
        for step, latex, *_ in exercise.rows:
            assert latex in written or latex.partition(" = ")[2] in written, (step, latex)


def test_the_page_shows_lines_of_the_library() -> None:
    for exercise in exercises():
        if exercise.name:
            (path,) = LIBRARY.rglob(f"{exercise.name}.lag")
            lines = path.read_text(encoding="utf-8").splitlines()
            assert [line for line in exercise.code.splitlines() if line not in lines] == []


def test_ten_exercises_of_two_textbooks() -> None:
    assert sum(not x.name for x in exercises()) == 10
    assert len({x.name for x in exercises() if x.name}) >= 9


def test_velocities_and_accelerations_of_the_pendulum() -> None:
    """V = l theta' v, a = l theta'' v - l theta'^2 u (the course: x1, z1)."""
    found = solution("course/simple_pendulum")
    lines = [row for block in found.blocks for row in getattr(block, "rows", ()) if hasattr(row, "left")]
    by_left = {row.left: "".join(row.lines) for row in lines}
    assert by_left[r"\vec{V}(\mathit{bob})"] == r"l \, \dot{\theta} \, \vec{v}"
    acceleration = r"-l \, \dot{\theta}^{2} \, \vec{u} + l \, \ddot{\theta} \, \vec{v}"
    assert by_left[r"\vec{a}(\mathit{bob})"] == acceleration
