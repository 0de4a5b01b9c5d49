"""Names, numbers, units and descriptions that programs of this kind stumble over."""

import random
from typing import TypeAlias

Dimension: TypeAlias = tuple[int, int, int, int]  # exponents of kg, m, s, A

NUMBER: Dimension = (0, 0, 0, 0)
MASS, LENGTH, TIME = (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)
FORCE, ENERGY, POWER = (1, 1, -2, 0), (1, 2, -2, 0), (1, 2, -3, 0)
INERTIA, SPEED, TURN = (1, 2, 0, 0), (0, 1, -1, 0), (0, 0, -1, 0)

TYPES: dict[str, Dimension] = {
    "Real": NUMBER, "Angle": NUMBER, "Mass": MASS, "Length": LENGTH, "Time": TIME, "Area": (0, 2, 0, 0),
    "Volume": (0, 3, 0, 0), "Velocity": SPEED, "AngularVelocity": TURN, "Acceleration": (0, 1, -2, 0),
    "AngularAcceleration": (0, 0, -2, 0), "Force": FORCE, "Torque": ENERGY, "Energy": ENERGY, "Power": POWER,
    "Action": (1, 2, -1, 0), "Inertia": INERTIA, "Momentum": (1, 1, -1, 0), "Stiffness": (1, 0, -2, 0),
    "RotationalStiffness": ENERGY, "Damping": (1, 0, -1, 0), "RotationalDamping": (1, 2, -1, 0),
    "Density": (1, -3, 0, 0), "LinearDensity": (1, -1, 0, 0), "Frequency": TURN, "Charge": (0, 0, 1, 1),
    "Current": (0, 0, 0, 1), "Voltage": (1, 2, -3, -1), "MagneticField": (1, 0, -2, -1),
    "Curvature": (0, -1, 0, 0), "Viscosity": (1, -1, -1, 0), "Pressure": (1, -1, -2, 0),
}  # fmt: skip

_UNITS: dict[Dimension, list[str]] = {
    NUMBER: ["rad", "deg", "1", "%", "rev"], MASS: ["kg", "g", "t", "lb", "mg"],
    LENGTH: ["m", "mm", "cm", "km", "ft", "inch", "um"], TIME: ["s", "ms", "min", "h"],
    FORCE: ["N", "kN", "kg.m/s2", "kg*m/s^2"], ENERGY: ["J", "N.m", "kJ", "kg.m2.s-2", "N.m/rad"],
    POWER: ["W", "J/s"], SPEED: ["m/s", "km/h", "m.s^-1"],
    TURN: ["rad/s", "1/s", "Hz", "rpm", "deg/s", "s-1"], (0, 1, -2, 0): ["m/s2", "m/s^2", "m/(s*s)"],
    (0, 0, 1, 1): ["C", "A.s"], (1, 0, -2, 0): ["N/m", "kg/s2"], (1, 0, -1, 0): ["N.s/m", "kg/s"],
    INERTIA: ["kg.m2", "g.cm2"],
}  # fmt: skip

PLAIN = ["a", "b", "c", "d", "k", "l", "m", "r", "u", "w", "x", "y", "z", "phi", "theta", "alpha", "mass"]
_NASTY = """
    M_PI M_cart M_1 INT INTERVAL UINT8 EXIT_1 EXIT_FAILURE HUGE_m HUGE_VAL MATH_x NULL EOF NAN INFINITY I
    _Complex complex errno assert isnan isinf unix linux stdin stdout BUFSIZ RAND_MAX FLT_MAX DBL_EPSILON
    INT_MAX CHAR_BIT SIZE_MAX PRId64 SIGINT CLOCKS_PER_SEC FP_NAN signbit offsetof NDEBUG bool true_ false_
    int double float register restrict inline auto char void long signed unsigned volatile static extern
    union struct switch goto sizeof typedef const case default do while break continue return
    class new delete this template namespace operator public private virtual friend using typename mutable
    try catch throw explicit export wchar_t nullptr constexpr and_eq bitand xor compl asm
    lambda None def pass async await yield global nonlocal raise except finally with is del self True_ False_
    print exec eval type_ list dict str numpy np math cos_ sin_ float64 array zeros nan inf e E pi_ exp_
    p q v t dt xdot lam work params rhs outputs assemble solve N M h tau G gamma psi q0 v0 n nq nv nx state
    s0 s1 s10 r0 _t0 tmp i j K T V L W lagc_options lagc_status begin record integrate displace conditions
    frac left right begin_ end_ mathrm theta_1 alpha_beta x_y_z a__b _x x_ __x x__ _ __ X Theta THETA omega
    der_ time_ world_ start rate fixed min max unit displayUnit model scene effect input output speed frame
    point body constraint force at on from unless uses requires import extends package partial function type
    constant parameter structural coordinate potential kinetic dissipation lagrangian torque joint when then
    loop each in Particle_ Solid_ field Gravity_ energy_ position_ velocity_ O0 l1 I1 O o l x1 x_1 x1_ x_1_
    con aux nul com1 prn self_ __init__ __class__ __name__ __builtins__ __file__ __main__ main exit abort
"""
NASTY = _NASTY.split()

SPECIAL = [
    "0", "1", "2", "3", "10", "0.5", "1e-30", "1e30", "1e-15", "1e15", "1e-308", "1e-320", "1e308", "5e-324",
    "1.7976931348623157e308", "9007199254740993", "0.1", "1e-9", "1e9", "123456789.123456789", "2.", ".5",
]  # fmt: skip

DESCRIPTIONS = [
    "", "plain", "*/", "/* */", "//", '\\"', "\\\\", "\\n", "%s %d %n", "{}", "{0.__class__}", "\\t\\\\\\\"",
    "\x1b[31mred\x1b[0m", "\x07\x08\x7f", "\u202e\u200b", "é ß 𝜃 ∂", "\\x00", "??/", "??=",
    "\\frac{1}{2}", "a,b;c", "=1+1", "\x85\u2028", "\t tab", "x" * 300, "# -*- coding: x -*-", "%",
    "&", "_^{}", "end M;", "'''", "`rm`", "$x^2$",
]  # fmt: skip


def name(chance: random.Random, taken: set[str], nasty: float) -> str:
    """One that is not in `taken`, and is then."""
    while True:
        if chance.random() < nasty:
            found = chance.choice(NASTY)
        else:
            found = chance.choice(PLAIN) + chance.choice(["", "", "1", "2", "_a", "3", "A"])
        if chance.random() < 0.003:
            found = (found * 60)[:180]
        if chance.random() < 0.1 or found in taken:
            found += chance.choice(["_", "1", "_1", "2", "0", "x", "X", "__"])
        if found not in taken:
            taken.add(found)
            return found


def description(chance: random.Random) -> str:
    """Mostly none; with the blank before it."""
    return f' "{chance.choice(DESCRIPTIONS)}"' if chance.random() < 0.12 else ""


def unit(dimension: Dimension, chance: random.Random) -> str:
    """One that measures `dimension`; "1" for a number."""
    known = _UNITS.get(dimension)
    if known and chance.random() < 0.8:
        return chance.choice(known)
    parts = [
        f"{base}{exponent if exponent != 1 else ''}"
        for base, exponent in zip(("kg", "m", "s", "A"), dimension)
        if exponent
    ]
    return ".".join(parts) or "1"


def quantity_type(dimension: Dimension, chance: random.Random) -> str:
    """A type of `dimension`: its name, or `Real[...]`."""
    known = [name for name, d in TYPES.items() if d == dimension]
    return chance.choice(known) if known and chance.random() < 0.9 else f"Real[{unit(dimension, chance)}]"


def times(a: Dimension, b: Dimension, sign: int = 1) -> Dimension:
    return (a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2], a[3] + sign * b[3])


def over(a: Dimension, b: Dimension) -> Dimension:
    return times(a, b, -1)
