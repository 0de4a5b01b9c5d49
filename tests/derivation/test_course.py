"""Results that a course prints (F. Menan, Mecanique analytique, 2024; L. D. Landau, E. M. Lifshitz,
Mechanics, 1976), against the formulas that a solution shows, by SymPy."""

from __future__ import annotations

import re
from typing import Any

import pytest

from lagc.reports.derivation.derivation import Derivation
from lagc.reports.patterns.formula_trees import Call, Form, Series, Symbol, Term, Total
from lagc.symbolic.graph import Node
from lagc.symbolic.sympy import to_sympy
from tests.derivation.values import solution

sympy = pytest.importorskip("sympy")

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


def shown(name: str, about: str, scene: str | None = None) -> Any:
    """The formula about something in a solution."""
    found = solution(name, scene)
    ((form, _),) = next(w.forms for w in found.written if w.about == about)
    return as_sympy(form, found)


def from_text(text: str, found: Any) -> Any:
    """The book's expression in the symbols of `found`, and others by their names."""
    words = set(re.findall(r"[a-zA-Z_]\w*", text)) - {"sin", "cos", "tan"}
    names = {word: sympy.Symbol(word, positive=word in POSITIVE) for word in words}
    return sympy.sympify(text, {**names, **{str(x): x for x in found.free_symbols}})


PENDULUM, SLIDE = "course/simple_pendulum", "course/moving_slide_implicit"
RESULTS = [
    (PENDULUM, "K of bob", "m*l**2*d_theta**2/2"),
    (PENDULUM, "U of field", "m*g*l*cos(theta)"),
    (PENDULUM, "dL/dq' 0", "m*l**2*d_theta"),
    (PENDULUM, "dL/dq 0", "-m*g*l*sin(theta)"),
    (PENDULUM, "d/dt dK/dq' 0", "m*l**2*dd_theta"),
    (PENDULUM, "virtual power of field", "-m*g*l*sin(theta)*v_theta"),
    ("course/particle_under_gravity", "Q of field", "-m*g"),
    (SLIDE, "K2", "m*d_x**2/(2*cos(theta)**2)"),
    (SLIDE, "K1", "m*gamma*time*d_x"),
    (SLIDE, "K0", "m*gamma**2*time**2/2"),
    ("course/moving_slide_explicit", "compatible with slide", "v_y - v_x*tan(theta)"),
    ("course/moving_slide_explicit", "reaction(slide) solved", "m*(g - gamma*tan(theta))*cos(theta)**2"),
    ("classic/heavy_top", "K of top",
     "A*(d_theta**2 + d_phi**2*sin(theta)**2)/2 + C*(d_psi + d_phi*cos(theta))**2/2"),
    ("classic/double_pendulum", "K", "(m1 + m2)*l1**2*d_theta1**2/2 + m2*l2**2*d_theta2**2/2"
     " + m2*l1*l2*d_theta1*d_theta2*cos(theta1 - theta2)"),
    ("classic/elastic_pendulum", "K of bob", "m*(d_s**2 + (l0 + s)**2*d_theta**2)/2"),
    ("course/wheel_rolling_explicit", "reaction(roll) solved", "(I*k*x + m*a*C)/(m*a**2 + I)"),
    ("course/wheel_rolling_implicit", "result 0 ", "(m*a**2 + I)*dd_theta + k*a**2*theta - C"),
    ("classic/double_pendulum", "U of field", "(m1 + m2)*g*l1*cos(theta1) + m2*g*l2*cos(theta2)"),
    ("classic/heavy_top", "conserved momentum(psi)", "C*(d_psi + d_phi*cos(theta))"),
    ("classic/spherical_pendulum_angles", "K of bob", "m*l**2*(d_theta**2 + sin(theta)**2*d_phi**2)/2"),
    ("classic/spherical_pendulum_angles", "conserved momentum(phi)", "m*l**2*sin(theta)**2*d_phi"),
    ("classic/bead_on_hoop_angle", "K0", "m*R**2*w**2*sin(theta)**2/2"),
    ("classic/bead_on_hoop_angle", "result 0 ", "m*R**2*(dd_theta - (w**2*cos(theta) - g/R)*sin(theta))"),
    ("classic/atwood_machine", "result 0 ", "(m1 + m2 + I/r**2)*dd_x - (m1 - m2)*g"),
    ("classic/wedge_and_block", "conserved momentum(X)", "(M + m)*d_X + m*d_s*cos(alpha)"),
]  # fmt: skip


@pytest.mark.parametrize("name, about, text", RESULTS)
def test_results_of_the_course(name: str, about: str, text: str) -> None:
    found = shown(name, about)
    assert sympy.simplify(found - from_text(text, found)) == 0, found


def test_the_slide_in_one_parameter() -> None:
    """m (1 + tan^2 theta) x'' + m gamma + m g tan theta = 0, from its terms."""
    found = shown(SLIDE, "d/dt dK/dq' 0") - shown(SLIDE, "Q of field")
    text = "m*((1 + tan(theta)**2)*dd_x + gamma + g*tan(theta))"
    assert sympy.simplify(found - from_text(text, found)) == 0


def test_velocities_and_accelerations_of_the_pendulum() -> None:
    """V = l theta' v, a = l theta'' v - l theta'^2 u (the course: x1, z1)."""
    found = solution(PENDULUM)
    lines = [row for block in found.blocks for row in getattr(block, "rows", ()) if hasattr(row, "left")]
    by_left = {row.left: "".join(row.lines) for row in lines}
    assert by_left[r"\vec{V}(\mathit{bob})"] == r"l \, \dot{\theta} \, \vec{v}"
    acceleration = r"-l \, \dot{\theta}^{2} \, \vec{u} + l \, \ddot{\theta} \, \vec{v}"
    assert by_left[r"\vec{a}(\mathit{bob})"] == acceleration
