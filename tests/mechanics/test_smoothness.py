"""Where an expression has a jump or a kink is found in every place that it can stand.

The truth is known by construction: pieces that agree to a chosen order where one follows the other.
"""

from __future__ import annotations

from random import Random

import pytest

from lagc.compiler.checking import check
from lagc.compiler.pipeline import Choice
from lagc.diagnostics.faults import Source

SMOOTH, KINK, JUMP = "smooth", "kink", "jump"
HEAD = """model M
parameter Mass m(min = 0) = 1 [kg];
parameter Length l(min = 0) = 1 [m];
parameter Time T(min = 0) = 1 [s];
coordinate Length x(start = 0.3 [m]), y(start = 0.2 [m]);
coordinate Angle th(start = 0.4), ps;
body b = Particle(mass = m, at = {x, y, 0});
frame F = rotate_x(rotate_z(world, th), ps);
body d = Solid(mass = m, inertia = {1, 1, 1} [kg.m2], frame = F, com = {0, 0, 0});
"""
SIZES = (1e-15, 1e-9, 1e-3, 1.0, 1e6, 1e15)


def sized(size: float) -> str:
    """HEAD with other lengths."""
    head = HEAD
    for factor in (1, 0.3, 0.2):
        assert f"= {factor} [m]" in head
        head = head.replace(f"= {factor} [m]", f"= {factor * size!r} [m]")
    return head


VARIABLES = (
    "x/l",
    "th",
    "time/T",
    "ps + th^2",
    "sin(th) + x/l",
    "norm({x, y, 0})/l - 2",
    "x*y/l^2 - time/T",
)


def expressions(u: str, chance: Random) -> list[tuple[str, str]]:
    """Numbers without a dimension that change their form where u = 0 (or where it is whole), and how."""
    c = f"{chance.uniform(0.3, 3.0):.3f}"
    n = chance.choice((2, 3, 4))
    return [
        (f"abs({u})", KINK),
        (f"abs({u})^{2 * n - 1}", SMOOTH),
        (f"({u})*abs({u})", SMOOTH),
        (f"sqrt(({u})^2)", KINK),
        (f"sqrt({c}*({u})^{2 * n})", SMOOTH),
        (f"abs(({u})^2 + {c})", SMOOTH),
        (f"sign({u})", JUMP),
        (f"{c}*sign({u})*({u})", KINK),
        (f"sign({u})*({u})^{n}", SMOOTH),
        (f"floor({u})", JUMP),
        (f"-floor({c}*({u}))", JUMP),
        (f"cos(2*pi*({u} - floor({u})))", SMOOTH),
        (f"mod({u}, 1)", JUMP),
        (f"abs(mod({u}, 1) - 1/2)", KINK),
        (f"cos(2*pi*mod({u}, 1))", SMOOTH),
        (f"max({u}, {c}*({u}))", KINK),
        (f"max({u}, 0)^{n}", SMOOTH),
        (f"min({u}, {c})", KINK),
        (f"min(max({u}, 0), 1)", KINK),
        (f"if {u} < 0 then {c} else exp({u})", JUMP),
        (f"if {u} > 0 then {c}*({u}) else sin({u})", KINK),
        (f"if {u} <= 0 then ({u})^3/6 else ({u}) - sin({u})", SMOOTH),
        (f"if {u} < 0 then 1 else cos({u})", SMOOTH),
        (f"if {u} > 0 and {u} < 1 then {c} else 0", JUMP),
        (f"if not {u} < 1 then 1 else if {u} < 0 then 0 else 3*({u})^2 - 2*({u})^3", SMOOTH),
        (f"if l < 2 [m] then {u} else 2*({u})", SMOOTH),
        (f"if T > 0 then abs({u}) else 0", KINK),
    ]


# a place, its fault, and the kinds that it refuses
PLACES = [
    ("constraint k: y = l*({e});", "LAG0421", (KINK, JUMP)),
    ("constraint k: der(y) = der(x)*({e});", "LAG0421", (KINK, JUMP)),
    ("constraint k: der(y) = l/T*({e});", "LAG0421", (KINK, JUMP)),
    ("point P = {{0, l*({e}), 0}}; constraint k: position(b) = P + {{0, 0, 0}};", "LAG0421", (KINK, JUMP)),
    ("function f(Real a) = a; constraint k: y = l*f({e});", "LAG0421", (KINK, JUMP)),
    ("body c = Particle(mass = m, at = {{0, 0, l*({e})}});", "LAG0422", (KINK, JUMP)),
    (
        "frame G = rotate_z(world, ({e})); "
        "body c = Solid(mass = m, inertia = {{1, 2, 3}} [kg.m2], frame = G, com = {{0, 0, 0}});",
        "LAG0422",
        (KINK, JUMP),
    ),
    ("potential V = 1 [J]*({e});", "LAG0423", (JUMP,)),
    ("kinetic K = 1/2*m*(2 + ({e}))*der(x)^2;", "LAG0423", (JUMP,)),
    ("lagrangian L = 1 [N.s]*({e})*der(x);", "LAG0423", (JUMP,)),
    ("speed Velocity u = (3 + ({e}))*der(x);", "LAG0424", (JUMP,)),
    ("force f = 1 [N]*({e})*world.x at b;", "", ()),
    ("dissipation D = 1 [N.s/m]*({e})*der(x)^2;", "", ()),
    ("output Real out = ({e});", "", ()),
]


def codes(line: str, head: str = HEAD) -> set[str]:
    """Of the faults, but for those of a start: not every one of these rows can be met."""
    faults = check(Source("m.lag", f"{head}{line}\nend M;"), Choice())
    return {f.code for f in faults if f.severity == "error" and not f.code.startswith("LAG061")}


@pytest.mark.full
@pytest.mark.parametrize("place", range(len(PLACES)))
def test_a_break_is_refused_where_the_mechanics_cannot_hold_it(place: int) -> None:
    chance = Random(place)
    template, code, refused = PLACES[place]
    for k in range(len(expressions("x", chance))):
        u = chance.choice(VARIABLES)
        expression, kind = expressions(f"({u})", chance)[k]
        line, size = template.format(e=expression), chance.choice(SIZES)
        given = "potential" in line and u == "time/T"  # a force that changes with time
        found = codes(line, sized(size))
        assert found == ({code} if kind in refused and not given else set()), (line, kind, size)


def bends(u: str, w: str) -> list[str]:
    """Numbers that bend where u = 0, or where it is a whole number of quarter turns, without a word of it;
    w is positive."""
    return [
        f"norm({{{u}, 2*({u}), 0}})",
        f"sqrt(({u})^2*(1 + ({u})^2))",
        f"sqrt(({u})^2*({w}))",
        f"sqrt(({u})^4 + ({w})*({u})^2)",
        f"(({u})^2)^0.5",
        f"(({u})^2*({w}))^0.3",
        f"exp(log(({u})^2)/2)",
        f"sqrt(1 - cos({u}))",
        f"sqrt(sin({u})^2 + (1 - cos({u}))^2)",
        f"acos(cos({u}))",
        f"asin(sin({u}))",
        f"acos(1 - ({u})^2)",
        f"atan2(sqrt(({u})^2), {w})",
        f"sqrt(1 + sin({u}))",
    ]


def jumps(u: str, w: str) -> list[str]:
    return [
        f"({u})/norm({{{u}, 0, 0}})",
        f"({w})*({u})/sqrt(({u})^2*({w}))",
        f"({u})*(({u})^2)^(-0.5)",
        f"atan(1/({u}))",
        f"tanh(({w})/({u}))",
        f"atan(tan({u}))",
    ]


def smooth(u: str, w: str) -> list[str]:
    """Numbers that are smooth, or as smooth as it takes, though it does not meet the eye."""
    return [
        f"abs(2 + sin({u}))",
        f"max(cos({u}), -3)",
        f"min(1, 3 + sin({u}))",
        f"max(tanh({u}), -2)",
        f"abs(atan({u}) - 2)",
        f"floor(0.5 + 0.1*sin({u}))",
        f"sign(1.1*cosh({u}) - cos({u}))",
        f"if sin({u})*cos({u}) < 1 then {u} else 0",
        f"sqrt(({u})^4*({w}))",
        f"sqrt(({u})^2 + ({w}))",
        f"(({u})^2)^1.3",
        f"sin({u})/({u})",
        f"(1 - cos({u}))/({u})^2",
        f"tanh(1/({u})^2)",
        f"exp(-1/({u})^2)",
        f"cos(acos(cos({u})))",
        f"cos(atan2(sin({u}), cos({u})))",
        f"acos(cos({u}))^2*sin({u})^2",
        f"asin(sin({u})/2)",
        f"sqrt(5/4 - cos({u}))",
        f"1/(2 + sin({u}))",
        f"tan(sin({u})/2)",
        f"atan2(({w})*sin({u})/9, 2 + cos({u}))",
        f"norm({{{u}, ({w}), 0}})",
    ]


UNSPELT = [
    ("x/l", "1 + th^2"),
    ("th - 1/5", "2 + sin(ps)"),
    ("ps + sin(th)", "exp(x/l)"),
    ("2*x/l - ps", "1.7"),
]


UNSPELT_PLACES = [
    ("constraint k: y = l*({e});", "LAG0421", (KINK, JUMP)),
    ("body c = Particle(mass = m, at = {{0, l*({e}), x}});", "LAG0422", (KINK, JUMP)),
    ("potential V = 1 [J]*({e});", "LAG0423", (JUMP,)),
]


@pytest.mark.full
@pytest.mark.parametrize("u, w", UNSPELT)
def test_kinks_and_jumps_that_no_word_tells_of(u: str, w: str) -> None:
    for kind, forms in ((KINK, bends), (JUMP, jumps), (SMOOTH, smooth)):
        for e in forms(u, w):
            for template, code, refused in UNSPELT_PLACES:
                assert codes(template.format(e=e)) == ({code} if kind in refused else set()), (e, kind, code)


def test_a_change_that_the_rows_keep_away_from_is_none() -> None:
    for row in ("norm({x, 0, 0}) = l", "norm({x - y, 0, 0}) = l", "norm(position(b)) = l",
                "abs(x - y) = 2*l", "norm({x, y, 0}) + norm({x - l, y, 0}) = 3*l",
                "norm({x, y, 0})/l = 2 + sin(th)", "atan2(y, x) = 1", "tanh(l/x) = 2"):  # fmt: skip
        assert codes(f"constraint k: {row};") == set(), row
    for row in (
        "norm({x - y, 0, 0}) = y",
        "norm({x, 2*x, 0}) = y + l",
        "abs(x) = y + l",
        "abs(th) = sin(ps)",
    ):
        assert codes(f"constraint k: {row};") == {"LAG0421"}, row


@pytest.mark.parametrize("size", SIZES)
def test_a_change_that_the_rows_meet_is_one_at_any_size(size: float) -> None:
    """For two values on one side of zero: from afar there is no change of sign."""
    head = sized(size)
    for a, b in ((0.3, 0.7), (3.0, 5.0), (30.0, 70.0), (-0.02, -9.0)):
        row = f"constraint k: abs(x)*l = (y - {a}*l)*(y - {b}*l);"
        assert codes(row, head) == {"LAG0421"}, (row, size)
        row = f"constraint k: norm({{x, l, 0}})*l = (y - {a}*l)*(y - {b}*l);"
        assert codes(row, head) == set(), (row, size)


def test_energies_may_have_walls_and_corners() -> None:
    for energy in ("l/x", "l/abs(x)", "l^12/x^12", "log(norm({x, y, 0})/l)",
                   "norm(position(b))/l", "tan(th)^2",
                   "(norm({x, 0, 0})/l - 1)^2", "acos(cos(th))", "l/norm({x - y, 0, 0})"):  # fmt: skip
        assert codes(f"potential V = 1 [J]*{energy};") == set(), energy


def test_what_jumps_on_the_cut_of_an_angle() -> None:
    def found(line: str) -> list[tuple[str, str]]:
        faults = check(Source("m.lag", f"{HEAD}{line}\nend M;"), Choice())
        return [(f.code, f.severity) for f in faults]

    cut = [("LAG0425", "warning")]
    for angle in ("atan2(y, x)", "atan2(sin(th), cos(th))", "(atan2(y, x) - 1)^2", "atan2(x, -l)"):
        assert found(f"potential V = 1 [J]*{angle};") == cut, angle
    assert found("constraint k: th = atan2(y, x);") == [("LAG0421", "error")]
    assert found("constraint k: x = l*atan2(sin(time/T), cos(time/T));") == [("LAG0421", "error")]
    assert found("constraint k: y*cos(th) = x*sin(th);") == []
    assert found("body c = Particle(mass = m, at = {0, 0, l*atan2(y, x)});") == [("LAG0422", "error")]
    assert found("body c = Particle(mass = m, at = {0, 0, l*atan2(y, l + norm({x, y, 0}))});") == []
    turned = "frame G = rotate_z(world, atan2(y, x))"
    solid = "body c = Solid(mass = m, inertia = {1, 1, 1} [kg.m2], frame = G, com = {0, 0, 0})"
    assert found(f"{turned}; {solid};") == []
    for angle in ("atan2(y, x)^2", "cos(atan2(y, x))", "atan2(y, norm({x, l, 0}))", "atan2(sin(th), 2)"):
        assert found(f"potential V = 1 [J]*{angle};") == [], angle


def test_initial_conditions_may_bend() -> None:
    assert codes("initial\n  abs(x) = 0.1 [m];") == set()


def test_rates_in_added_energies_may_not_bend() -> None:
    assert codes("kinetic K = 1/2*1 [kg.m/s]*abs(der(x));") == {"LAG0423"}
    assert codes("kinetic K = 1/2*m*abs(der(x))^3/(1 [m/s]);") == set()


POINTED = (  # rows that hold where the norm of what moves is zero, and have no gradient there
    "z = {u}*{w}/{r}", "z = {u}^3/{r}^2", "z = 2*{r}", "z = l*{u}*{w}/{r}^2", "z = {u}^2*{w}/{r}^2",
    "l*sin(th) = {r}", "z = sqrt({r}*l)", "z = ({u}^3*{w} - 2*{u}*{w}^3)/{r}^3",
    "der(z) = der({v})*{u}/{r}", "{{z, th*l}} = {{{r}, x}}", "z = l*({u}^4 - {w}^4)/{r}^4",
)  # fmt: skip
ROUND = (  # that have one, or do not hold
    "{r} = l", "z = {r}^2/l", "z = {r}^4/l^3", "z = ({u}^4 - {w}^4)/{r}^2/l", "z = l*exp(-{r}^2/l^2)",
    "{r} + norm({{{u} - l, {w}, 0}}) = 3*l", "{r}/l = 2 + sin(th)", "z = l*cos({r}/l)", "z = {r}^3/l^2",
    "z = l*sin({r}/l)/({r}/l)", "z = {u}^2*{w}^2/{r}^3*sin({u}/l)*sin({w}/l)", "({r} - 3*l)^2 + z^2 = l^2",
    "z = norm({{{u}, {w}, l}})", "z = {r}^(3/2)/l^(1/2)",
)  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize("u, w", [("x", "y"), ("(x - l)", "(y + z0)"), ("(x - y)", "(x + 3*y)")])
def test_rows_without_a_gradient_at_a_point(u: str, w: str) -> None:
    head = HEAD.replace("{x, y, 0}", "{x, y, z}")
    head += "parameter Length z0 = 0.7 [m];\ncoordinate Length z(start = 1 [m]);\n"
    for forms, expected in ((POINTED, [("LAG0426", "warning")]), (ROUND, [])):
        for form in forms:
            row = form.format(u=u, w=w, v="x", r=f"norm({{{u}, {w}, 0}})")
            faults = check(Source("m.lag", f"{head}constraint k: {row};\nend M;"), Choice())
            assert [(f.code, f.severity) for f in faults] == expected, row
