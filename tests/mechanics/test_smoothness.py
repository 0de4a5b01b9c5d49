"""Where an expression has a jump or a kink is found in every place that it can stand.

The truth is known by construction: pieces that agree to a chosen order where one follows the other.
"""

from random import Random

import pytest

from lagc.compiler.stages import Choice, derive, parse, resolve
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


VARIABLES = ("x/l", "th", "time/T", "ps + th^2", "sin(th) + x/l", "norm({x, y, 0})/l - 2", "x*y/l^2 - time/T")


def expressions(u: str, chance: Random) -> list[tuple[str, str]]:
    """Numbers without a dimension that change their form where u = 0 (or where it is whole), and how."""
    c = f"{chance.uniform(0.3, 3.0):.3f}"
    n = chance.choice((2, 3, 4))
    return [
        (f"abs({u})", KINK), (f"abs({u})^{2 * n - 1}", SMOOTH), (f"({u})*abs({u})", SMOOTH),
        (f"sqrt({c}*({u})^{2 * n})", SMOOTH), (f"abs(({u})^2 + {c})", SMOOTH), (f"sign({u})", JUMP),
        (f"{c}*sign({u})*({u})", KINK), (f"sign({u})*({u})^{n}", SMOOTH), (f"floor({u})", JUMP),
        (f"-floor({c}*({u}))", JUMP), (f"cos(2*pi*({u} - floor({u})))", SMOOTH), (f"mod({u}, 1)", JUMP),
        (f"abs(mod({u}, 1) - 1/2)", KINK), (f"cos(2*pi*mod({u}, 1))", SMOOTH), (f"max({u}, {c}*({u}))", KINK),
        (f"max({u}, 0)^{n}", SMOOTH), (f"min({u}, {c})", KINK), (f"min(max({u}, 0), 1)", KINK),
        (f"if {u} < 0 then {c} else exp({u})", JUMP), (f"if {u} > 0 then {c}*({u}) else sin({u})", KINK),
        (f"if {u} <= 0 then ({u})^3/6 else ({u}) - sin({u})", SMOOTH),
        (f"if {u} < 0 then 1 else cos({u})", SMOOTH), (f"if {u} > 0 and {u} < 1 then {c} else 0", JUMP),
        (f"if not {u} < 1 then 1 else if {u} < 0 then 0 else 3*({u})^2 - 2*({u})^3", SMOOTH),
        (f"if l < 2 [m] then {u} else 2*({u})", SMOOTH), (f"if T > 0 then abs({u}) else 0", KINK),
    ]  # fmt: skip


# a place, its warning, and the kinds that are warned of
PLACES = [
    ("constraint k: y = l*({e});", "LAG0421", (KINK, JUMP)),
    ("constraint k: der(y) = der(x)*({e});", "LAG0421", (JUMP,)),
    ("constraint k: der(y) = l/T*({e});", "LAG0421", (JUMP,)),
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
    """Of the warnings about smoothness."""
    warnings = derive(resolve(parse(Source("m.lag", f"{head}{line}\nend M;")), Choice())).warnings
    return {f.code for f in warnings if f.code.startswith("LAG042")}


@pytest.mark.full
@pytest.mark.parametrize("place", range(len(PLACES)))
def test_a_break_is_warned_of_where_the_mechanics_cannot_hold_it(place: int) -> None:
    chance = Random(place)
    template, code, warned = PLACES[place]
    for k in range(len(expressions("x", chance))):
        u = chance.choice(VARIABLES)
        expression, kind = expressions(f"({u})", chance)[k]
        line, size = template.format(e=expression), chance.choice(SIZES)
        given = "potential" in line and u == "time/T"  # a force that changes with time
        found = codes(line, sized(size))
        assert found == ({code} if kind in warned and not given else set()), (line, kind, size)


SMOOTH_FORMS = (
    "abs(2 + sin({u}))", "max(cos({u}), -3)", "min(1, 3 + sin({u}))", "max(tanh({u}), -2)",
    "abs(atan({u}) - 2)", "floor(0.5 + 0.1*sin({u}))", "sign(1.1*cosh({u}) - cos({u}))",
    "if sin({u})*cos({u}) < 1 then {u} else 0", "sqrt(({u})^4*({w}))", "norm({{{u}, ({w}), 0}})",
)  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("u, w", [("x/l", "1 + th^2"), ("th - 1/5", "2 + sin(ps)"), ("2*x/l - ps", "1.7")])
def test_relations_that_cannot_change_are_no_breaks(u: str, w: str) -> None:
    for form in SMOOTH_FORMS:
        e = form.format(u=u, w=w)
        for template in (PLACES[0][0], PLACES[6][0], "potential V = 1 [J]*({e});"):
            assert codes(template.format(e=e)) == set(), e


def test_singular_configurations_are_left_to_the_run() -> None:
    """Norms, quotients and angles may have a bad point that no motion gets to."""
    for row in (
        "z = norm({x, 2*x, 0})",
        "x = l*normalize({y, z, 0}).x",
        "th = atan2(y, x)",
        "z = norm({x, y, 0})",
    ):
        head = HEAD.replace("{x, y, 0}", "{x, y, z}") + "coordinate Length z(start = 1 [m]);"
        assert codes(f"constraint k: {row};", head) == set()


def test_a_change_that_the_rows_keep_away_from_is_none() -> None:
    for row in ("abs(x) = l", "abs(x - y) = 2*l", "abs(x)/l = 2 + sin(th)^2"):
        assert codes(f"constraint k: {row};") == set(), row
    for row in ("abs(x) = y + l", "abs(th) = sin(ps)"):
        assert codes(f"constraint k: {row};") == {"LAG0421"}, row


@pytest.mark.sample(4)
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


def test_initial_conditions_may_bend() -> None:
    assert codes("initial\n  abs(x) = 0.1 [m];") == set()


def test_rates_in_added_energies_may_not_bend() -> None:
    assert codes("kinetic K = 1/2*1 [kg.m/s]*abs(der(x));") == {"LAG0423"}
    assert codes("kinetic K = 1/2*m*abs(der(x))^3/(1 [m/s]);") == set()
