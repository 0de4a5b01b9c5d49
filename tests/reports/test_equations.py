"""Equations as a person would write them. Equations of any length are written: powers and products that would
be long have names for their parts."""

import random
import re
import subprocess
import sys
from fractions import Fraction
from random import Random

import pytest
import sympy

import lagc
from lagc.diagnostics.faults import Refused
from lagc.reports.algebra.polynomials import fraction
from lagc.reports.algebra.trigonometric_identities import ShortAlgebra
from lagc.reports.equations import formulas
from lagc.reports.equations.latex import equations_latex, letter
from lagc.reports.equations.write import write
from tests.reports.models import EVERYTHING, LONG, derived, equations_of, rows


def lines(name: str, scene: str | None = None) -> list[str]:
    return [line for line in write(derived(name, scene)).splitlines() if " = 0" in line]


def test_simple_pendulum() -> None:
    assert write(derived("course/simple_pendulum")) == "l*theta'' + g*sin(theta) = 0\n\nwhere g = field.g"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("course/particle_under_gravity", ["x'' = 0", "y'' = 0", "z'' + g = 0"]),
        (
            "course/string_pendulum",
            [
                "m*x'' - x*lambda_string/sqrt(x^2 + z^2) = 0",
                "m*z'' + m*g - z*lambda_string/sqrt(x^2 + z^2) = 0",
                "sqrt(x^2 + z^2) - l = 0",
            ],
        ),
        (
            "classic/double_pendulum",
            [
                "l1*(m1 + m2)*theta1'' + m2*l2*cos(theta1 - theta2)*theta2''"
                " + m2*l2*sin(theta1 - theta2)*theta2'^2 + g*(m1 + m2)*sin(theta1) = 0",
                "l1*cos(theta1 - theta2)*theta1'' + l2*theta2''"
                " - l1*sin(theta1 - theta2)*theta1'^2 + g*sin(theta2) = 0",
            ],
        ),
        (
            "classic/elastic_pendulum",
            [
                "m*s'' - m*(l0 + s)*theta'^2 + k*s - m*g0*cos(theta) = 0",
                "(l0 + s)^2*theta'' + 2*(l0 + s)*s'*theta' + g0*(l0 + s)*sin(theta) = 0",
            ],
        ),
        ("classic/kepler", ["x'' + mu*x/(x^2 + y^2)^(3/2) = 0", "y'' + mu*y/(x^2 + y^2)^(3/2) = 0"]),
        (
            "classic/euler_top",
            [
                "I1*o.rate.x' - (I2 - I3)*o.rate.y*o.rate.z = 0",
                "I2*o.rate.y' + (I1 - I3)*o.rate.x*o.rate.z = 0",
                "I3*o.rate.z' - (I1 - I2)*o.rate.x*o.rate.y = 0",
            ],
        ),
    ],
)
def test_classics_look_as_in_a_textbook(name: str, expected: list[str]) -> None:
    assert lines(name) == expected


def test_kinematics_of_declared_speeds_are_written() -> None:
    text = write(derived("classic/chaplygin_sleigh_speeds"))
    assert "x' = cos(theta)*u - sin(theta)*s" in text


@pytest.mark.full
def test_long_equations_are_written_with_named_parts() -> None:
    """A power of a sum of 24 terms has some 80,000 of them: it is not multiplied out."""
    text = write(equations_of(LONG))
    assert "// shared parts" in text and "s1 = " in text
    assert len(text) < 100_000


def test_latex() -> None:
    row = r"  l \, \ddot{\theta} + g \, \sin \theta &= 0"
    text = write(derived("course/simple_pendulum"), "latex")
    assert text == f"\\begin{{align*}}\n{row}\n\\end{{align*}}\nwhere $g$ is \\texttt{{field.g}}"
    shown = equations_latex(derived("course/simple_pendulum"))
    assert shown == f"$$\n\\begin{{aligned}}\n{row}\n\\end{{aligned}}\n$$"


@pytest.mark.parametrize(
    ("name", "dots", "expected"),
    [
        ("theta", 0, r"\theta"),
        ("th[2]", 0, r"\mathit{th}_{2}"),
        ("theta1", 2, r"\ddot{\theta}_{1}"),
        ("x[1,2]", 1, r"\dot{x}_{1,2}"),
        ("a.bob[3]", 0, r"\mathit{bob}_{\mathrm{a},3}".replace(r"\mathrm{a}", "a")),
        ("lambda_string", 0, r"\lambda_{\mathrm{string}}"),
    ],
)
def test_names_in_latex(name: str, dots: int, expected: str) -> None:
    assert letter(name, dots) == expected


def test_body_rates_in_latex() -> None:
    """omega, wherever the orientation is declared; no other name that ends alike is taken for one."""
    text = write(equations_of(TURNING), "latex")
    assert all(rf"\dot{{\omega}}_{{{owner},x}}" in text for owner in ("o", r"\mathrm{arm},1,p"))
    assert r"x_{k,\mathrm{rate}}" in text


def test_latex_has_balanced_braces_for_every_kind_of_expression() -> None:
    text = write(equations_of(EVERYTHING), "latex")
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")


@pytest.mark.full
def test_the_script_runs_with_sympy() -> None:
    """Really run, in a fresh interpreter; the equation is the pendulum's."""
    script = write(derived("course/simple_pendulum"), "sympy")
    check = (
        "\nassert len(equations) == 1"
        "\nleft = equations[0].lhs"
        "\nassert left == l*theta.diff(t, 2) + g*sympy.sin(theta), left"
    )
    done = subprocess.run([sys.executable, "-c", script + check], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", [3, 5, 7, 21, 100])
def test_what_is_made_of_whole_numbers_is_written_so(n: int) -> None:
    """Their quotients are rounded, and so are products and sums of these."""
    text = write(lagc.load("large/rope").compile(parameters={"n": n}, backend="numpy").equations, full=False)
    assert f"{n}*{'L*a[1]' if n < 7 else 'g'}" in text and not re.search(r"\d\.\d", text)


@pytest.mark.parametrize("seed", range(20))
def test_fractions_differ_from_numbers_by_rounding(seed: int) -> None:
    chance = Random(seed)
    a, b, c = (chance.randrange(1, 40) for _ in range(3))
    assert fraction(a / b * (1 / c)) == Fraction(a, b * c)
    assert fraction(sum([1 / b] * 50)) == Fraction(50, b)
    value = chance.uniform(-1, 1) * 10 ** chance.randrange(-8, 8)
    assert fraction(value) == Fraction(repr(value))
    assert fraction(1.00000000000001) == Fraction("1.00000000000001")


def test_turns_about_an_axis_of_no_simple_length_leave_simple_numbers() -> None:
    found = equations_of(
        "model M coordinate Angle a, b; frame F = rotate(world, {1, 0.5, 0}, a);"
        "frame G = rotate(F, {1, 0.5, 0}, b); point P = 1 [m]*F.z;"
        "body s = Solid(mass = 1 [kg], inertia = {1, 2, 2}, frame = F, com = P);"
        "body t = Solid(mass = 1 [kg], inertia = {1, 2, 2}, frame = G, com = P + 1 [m]*G.z); end M;"
    )
    assert write(found).splitlines()[1:] == [
        "(27 + 10*cos(b))*a'' + (11 + 5*cos(b))*b'' - 10*sin(b)*a'*b' - 5*sin(b)*b'^2 = 0",
        "(11 + 5*cos(b))*a'' + 11*b'' + 5*sin(b)*a'^2 = 0",
    ]


def test_multiples_of_pi_are_written_with_pi() -> None:
    text = "model A\n  {}coordinate Angle a, b;\n  potential V = 1 [J]*(cos(2*pi/5 + a) - pi*b^2);\nend A;\n"
    assert "sin(2*pi/5 + a)" in write(equations_of(text.format("")))
    named = "parameter Real pi = 3 [1];\n  "
    assert "pi" not in write(equations_of(text.format(named).replace("2*pi", "6.283185307179586")))


def test_squares_of_sine_and_cosine_are_one_below_lines_and_under_roots() -> None:
    distance = "R[1]^2 + R[2]^2 - 2*R[1]*R[2]*cos(2*pi/5 - phi[1] + phi[2])"
    assert f"G*m*R[1]/({distance})^(3/2)" in write(derived("large/n_body"))
    for name in ("large/n_body", "large/truss"):
        assert "^2*sin" not in write(derived(name)).replace("'^2*sin", "")


@pytest.mark.full
def test_joint_angles_add_up() -> None:
    """Along an arm each frame is turned against the one before."""
    text = write(derived("large/relative_chain"))
    assert "shared" not in text and "9*cos(q[3] + q[4])" in text


def test_names_that_python_reserves_are_legal_in_the_script() -> None:
    script = write(equations_of(RESERVED), "sympy")
    compile(script, "script", "exec")
    assert "lambda_ = " in script


TURNING = """
model Top
  parameter Inertia I = 1 [kg.m2];
  coordinate Orientation p;
  body top = Solid(mass = 1 [kg], inertia = {I, 2*I, 3*I}, frame = rotate(world, p), com = {0, 0, 0});
end Top;
model Spring
  parameter Real x = 2;
end Spring;
model Springs
  Spring rate;
end Springs;
model Turning
  Top arm[1];
  Springs k;
  coordinate Orientation o;
  frame F = rotate(world, o);
  body solid = Solid(mass = 1 [kg], inertia = {1, 2, 3} [kg.m2], frame = F, com = {0, 0, 0});
  torque T = k.rate.x*F.x*(1 [N.m]) on solid;
end Turning;
"""

RESERVED = """
model Reserved
  parameter Mass t = 1 [kg];
  parameter Stiffness sympy = 2 [N/m];
  coordinate Length lambda(start = 1 [m]), equations;
  body b = Particle(mass = t, at = {lambda, equations, 0});
  potential V = 1/2*sympy*lambda^2;
end Reserved;
"""


@pytest.mark.full
@pytest.mark.parametrize(
    "name",
    [
        "classic/andrews_squeezer", "classic/car_axis", "classic/heavy_top_quaternion", "classic/pleiades",
        "classic/rolling_disc", "course/string_pendulum",
    ],
)  # fmt: skip
def test_latex_is_read_by_another_program(name: str) -> None:
    """matplotlib's reader of formulas stands in for TeX."""
    mathtext = pytest.importorskip("matplotlib.mathtext")
    reader = mathtext.MathTextParser("path")
    for line in rows(write(derived(name), "latex")):
        formula = f"${line}$"
        assert reader.parse(formula).width > 0.0, formula  # ParseFatalException where it cannot be read


@pytest.mark.parametrize("name", ["arenstorf_orbit", "two_bodies_on_a_spring", "double_pendulum_explicit"])
def test_what_is_just_multiplied_out_is_written(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever looking for squares in it takes."""
    equations = derived(f"classic/{name}")
    expected = write(equations)
    algebra = ShortAlgebra(formulas.nonnegative(equations))
    collector = formulas.collector_of(formulas.SymbolKinds(equations), algebra)
    formulas.everything(equations, collector, formulas.divided(equations, collector))
    spent = algebra.spent
    monkeypatch.setattr(formulas, "ShortAlgebra", lambda known, _: ShortAlgebra(known, limit=spent))
    assert write(equations) == expected


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
