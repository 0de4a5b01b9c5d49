"""Where an expression has a jump or a kink is found in every place that it can stand.

The truth is known by construction: pieces that agree to a chosen order where one follows the other.
"""

from __future__ import annotations

from random import Random

import pytest

from lagc.compiler import Choice, check
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
VARIABLES = (
    "x/l",
    "th",
    "time/T",
    "y/l + th^2",
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


def codes(line: str) -> set[str]:
    faults = check(Source("m.lag", f"{HEAD}{line}\nend M;"), Choice())
    return {f.code for f in faults if f.severity == "error"}


@pytest.mark.parametrize("place", range(len(PLACES)))
def test_a_break_is_refused_where_the_mechanics_cannot_hold_it(place: int) -> None:
    chance = Random(place)
    template, code, refused = PLACES[place]
    for k in range(len(expressions("x", chance))):
        u = chance.choice(VARIABLES)
        expression, kind = expressions(f"({u})", chance)[k]
        line = template.format(e=expression)
        given = "potential" in line and u == "time/T"  # a force that changes with time
        assert codes(line) == ({code} if kind in refused and not given else set()), (line, kind)


def test_a_distance_that_is_never_zero_may_be_the_root_of_a_square() -> None:
    assert codes("constraint k: norm({x, 0, 0}) = l;") == set()
    assert codes("constraint k: norm({x - y, 0, 0}) = l;") == set()
    assert codes("constraint k: norm({x - y, 0, 0}) = y;") == {"LAG0421"}


def test_initial_conditions_may_bend() -> None:
    assert codes("initial\n  abs(x) = 0.1 [m];") == set()


def test_rates_in_added_energies_may_not_bend() -> None:
    assert codes("kinetic K = 1/2*1 [kg.m/s]*abs(der(x));") == {"LAG0423"}
    assert codes("kinetic K = 1/2*m*abs(der(x))^3/(1 [m/s]);") == set()


def test_a_change_that_may_be_there_is_called_possible() -> None:
    (fault,) = check(Source("m.lag", f"{HEAD}constraint k: y = l*abs(2 + sin(th));\nend M;"), Choice())
    assert fault.code == "LAG0421" and "possible kink" in fault.message and fault.remedy
