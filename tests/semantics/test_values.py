"""Expressions: numbers, dimensions, vectors, functions, against Python's own arithmetic. Values that no
quantity of a kind has: a fraction for an Integer, an impossible inertia, `time` twice. What the leaves of
a model are called is what the language calls them."""

import math

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused
from lagc.symbolic.leaves import derived
from tests.semantics.reading import output, read, read_body


@pytest.mark.parametrize(
    "expression, expected",
    [
        ("1 + 2*3", 7.0), ("2^(3^2)", 512.0), ("-2^2", -4.0), ("(-2)^2", 4.0), ("7/2/2", 1.75),
        ("2 - 3 - 4", -5.0), ("2^(-1)", 0.5), ("pi", math.pi),
        ("sin(1) + cos(2)*tan(0.5)", math.sin(1) + math.cos(2) * math.tan(0.5)),
        ("atan2(1, -1)", math.atan2(1, -1)),
        ("asin(0.5) + acos(0.5) + atan(3)", math.asin(0.5) + math.acos(0.5) + math.atan(3)),
        ("sinh(1)*cosh(1)/tanh(1)", math.sinh(1) * math.cosh(1) / math.tanh(1)),
        ("exp(1) + log(2) + log10(1000)", math.e + math.log(2) + 3.0), ("sqrt(2)", math.sqrt(2)),
        ("abs(-2) + sign(-3)", 1.0), ("floor(2.7) + ceil(2.2)", 5.0), ("mod(7, 3)", 1.0),
        ("min(3, 1, 2) + max({3, 1, 2})", 4.0), ("sum({1, 2, 3})", 6.0), ("size({1, 2, 3})", 3.0),
        ("sum({i^2 for i in 1:10})", 385.0), ("({i for i in 10:-3:0})[4]", 1.0),
        ("({{10*i + j for j in 1:3} for i in 0:2})[3, 2]", 22.0),
        ("sum({sum({i for i in 1:i}) for i in 1:4})", 20.0), ("({i for i in 1:3} [km])[2]/1 [m]", 2000.0),
        ("sum({if i == 2 then 5 else i for i in 1:3})", 9.0), ("sum(i^2 for i in 1:10)", 385.0),
        ("sum(sum(i*j for j in i+1:3) for i in 1:3)", 11.0), ("1 + sum({i for i in 2:1})", 1.0),
        ("dot(sum({i, 10*i, 100*i} for i in 1:4), {1, 2, 3})", 10.0 * 321.0),
        ("sum({{1, 2}, {3, 4}})[2]", 6.0), ("size({i for i in 1:0})", 0.0),
        ("max(1, sum(2*i for i in 1:max(1, 2)))", 6.0), ("dot({1, 2, 3}, {4, 5, 6})", 32.0),
        ("dot({1, 2}, {4, 5}) + dot({2}, {3})", 20.0), ("norm({3, 4, 0})", 5.0),
        ("norm({1, 1, 1, 1})^2 + norm({3, 4})", 9.0), ("cross({1, 0, 0}, {0, 1, 0}).z", 1.0),
        ("normalize({0, 3, 4}).z", 0.8), ("({{1, 2, 3}, {0, 1, 0}, {0, 0, 1}}*{1, 1, 1}).x", 6.0),
        ("if 1 < 2 then 3 else 4", 3.0), ("if 1 > 2 then 3 elseif 2 >= 2 then 5 else 4", 5.0),
        ("if not (1 == 2) and (1 <> 2 or false) then 1 else 0", 1.0), ("30 [deg]", math.pi / 6),
        ("50 [%]", 0.5), ("1 [rev]", 2 * math.pi),
    ],
)  # fmt: skip
def test_a_number(expression: str, expected: float) -> None:
    model = read_body(f"output Real y = {expression};")
    assert output(model, "y") == pytest.approx(expected, rel=1e-15, abs=1e-15)


@pytest.mark.parametrize(
    "type_name, expression, expected",
    [
        ("Length", "3", 3.0), ("Length", "3 [km] + 2 [m]", 3002.0), ("Length", "-3/2", -1.5),
        ("Velocity", "36 [km/h]", 10.0), ("Area", "(2 [m])^2", 4.0), ("Length", "sqrt(4 [m2])", 2.0),
        ("Frequency", "1/(2 [s])", 0.5), ("Energy", "1/2*m*(3 [m/s])^2", 9.0),
        ("Real[kg/m]", "m/(4 [m])", 0.5), ("Angle", "atan2(1 [m], 1 [m])", math.pi / 4),
        ("Length", "max(1 [m], 2 [mm])", 1.0), ("Length", "norm({3 [m], 4 [m], 0})", 5.0),
        ("Length", "0", 0.0), ("Length", "1 [m] - ({0, 1 [J], 0}.x/(2 [J]))^2", 1.0),
    ],
)  # fmt: skip
def test_a_quantity(type_name: str, expression: str, expected: float) -> None:
    assert output(read_body(f"output {type_name} y = {expression};"), "y") == pytest.approx(
        expected, rel=1e-15
    )


def test_short_and_reserved_names_are_free() -> None:
    names = [
        "t", "q", "I", "E", "int", "double", "lambda", "main", "None", "def", "class", "nan", "auto", "pi",
        "world",
    ]  # fmt: skip
    for name in names:
        model = read_body(f"parameter Real {name} = 3; output Real y = 2*{name};")
        assert output(model, "y") == 6.0, name


def test_the_user_hides_what_is_there() -> None:
    assert output(read_body("parameter Real pi = 3; output Real y = pi;"), "y") == 3.0
    assert output(read_body("function sin(Real u) = 2*u; output Real y = sin(1);"), "y") == 2.0


def test_a_sum_of_ten_thousand_terms() -> None:
    assert output(read_body(f"output Real y = {' + '.join(['1'] * 10_000)};"), "y") == 10_000.0


def test_functions_are_written_out() -> None:
    model = read_body("function f(Length u, Real k) = k*u^2; function g(Length u) = f(u, k = 3) + 1 [m2]; "
                      "output Area y = g(x);")  # fmt: skip
    assert output(model, "y", x=2.0) == 13.0


def test_velocities_are_time_derivatives() -> None:
    """Of r = (A sin(w t) x, x^2/L, 0) by the chain rule."""
    model = read_body(
        "parameter Real[1/s] w = 3; parameter Length L = 0.5; point P = {sin(w*time)*x, x^2/L, 0};"
        "output Velocity u = velocity(P); output Acceleration a = acceleration(P);"
    )
    t, x, v = 0.7, 1.3, -0.4
    found = [output(model, f"u[{k}]", x=x, der_x=v, time=t) for k in (1, 2, 3)]
    assert found == pytest.approx(
        [3 * math.cos(2.1) * x + math.sin(2.1) * v, 2 * x * v / 0.5, 0.0], rel=1e-14
    )


def test_the_angular_velocity_of_euler_angles() -> None:
    """z-x-z angles: w = psi' z + theta' x' + phi' z''.

    H. Goldstein, *Classical Mechanics*, 3rd ed., 2002, sec. 4.9.
    """
    model = read_body(
        "coordinate Angle psi, theta, phi; frame A = rotate_z(world, psi); frame B = rotate_x(A, theta);"
        "frame C = rotate(B, B.z, phi);"
        "body s = Solid(mass = 1, inertia = {1, 1, 1}, frame = C, com = {0, 0, 0});"
        "output AngularVelocity w = angular_velocity(s);"
    )
    psi, theta, phi, dpsi, dtheta, dphi = 0.3, 0.8, -1.1, 0.5, -0.7, 1.9
    motion = {"psi": psi, "theta": theta, "phi": phi, "der_psi": dpsi, "der_theta": dtheta, "der_phi": dphi}
    expected = [
        dtheta * math.cos(psi) + dphi * math.sin(theta) * math.sin(psi),
        dtheta * math.sin(psi) - dphi * math.sin(theta) * math.cos(psi),
        dpsi + dphi * math.cos(theta),
    ]
    assert [output(model, f"w[{k}]", **motion) for k in (1, 2, 3)] == pytest.approx(expected, rel=1e-14)


def test_what_a_body_knows() -> None:
    model = read_body(
        "frame F = rotate_z(world, x/1 [m]);"
        "body s = Solid(mass = 3, inertia = {1, 2, 3}, frame = F, com = {x, 0, 0});"
        "output Mass k = s.mass; output Energy T = kinetic(s); output Momentum p = momentum(s).x;"
        "output AngularMomentum h = angular_momentum(s).z;"
        "output Velocity u = velocity(s, at = {x, 2 [m], 0}).x; output Length g = s.x - 2*s.z;"
    )
    motion = {"x": 0.3, "der_x": 2.0}
    assert output(model, "k") == 3.0
    assert output(model, "T", **motion) == pytest.approx(0.5 * 3 * 4 + 0.5 * 3 * 4)
    assert output(model, "p", **motion) == pytest.approx(6.0)
    assert output(model, "h", **motion) == pytest.approx(6.0)  # the centre moves along x through the origin
    assert output(model, "u", **motion) == pytest.approx(2.0 - 2.0 * 2.0)
    assert output(model, "g", **motion) == 0.3


@pytest.mark.parametrize("sign", ["", "-"])
def test_integers_are_told_apart_to_the_last_one_that_is_held_exactly(sign: str) -> None:
    first, last = sorted(int(sign + str(2**53 - k)) for k in (1, 2))
    model = read_body(
        f"for i in {first}:{last} loop point P[i] = {{i*1 [m], 0, 0}}; end for;"
        f"output Real y = P[{last}].x/1 [m]; output Real z = P[{first}].x/1 [m];"
    )
    assert (output(model, "y"), output(model, "z")) == (last, first)


BODY = "coordinate Length x(rate = 1);\n  body b = Particle(mass = 1, at = {x, 0, 0});"


def codes(text: str) -> list[str]:
    return [f.code for f in lagc.loads(f"model M\n  {text}\nend M;").check() if f.severity == "error"]


@pytest.mark.parametrize(
    "declared",
    ["output Length time = 2*x;", "parameter Time time = 1 [s];", "discrete Real time(start = 0);"],
)
def test_a_quantity_is_not_called_time(declared: str) -> None:
    """It would be a second column of that name in results."""
    assert codes(f"{BODY}\n  {declared}") == ["LAG0202"]
    assert codes(f"{BODY}\n  {declared.replace(' time', ' time2', 1)}") == []


@pytest.mark.parametrize(
    "declared",
    ["parameter Integer n = 1.5;", "discrete Integer k(start = 0.5);", "structural Integer n = 1.5;"],
)
def test_an_integer_is_whole(declared: str) -> None:
    assert codes(f"{BODY}\n  {declared}") == ["LAG0208"]
    assert codes(f"{BODY}\n  {declared.replace('.5', '')}") == []


@pytest.mark.parametrize("backend", ["numpy"])
def test_an_integer_that_is_given_is_whole(backend: str) -> None:
    text = f"model M\n  parameter Integer n = 2;\n  {BODY}\n  force f = n*1 [N]*world.x at b;\nend M;"
    model = lagc.loads(text).compile(backend=backend)
    with pytest.raises(Refused, match="Integer"):
        model.simulate(1, parameters={"n": 2.7})
    assert model.simulate(1, parameters={"n": 3.0}).final["x"] == pytest.approx(1 + 3 / 2, abs=1e-5)


def solid(matrix: str) -> list[str]:
    return codes(f"body b = Solid(mass = 1, inertia = {matrix}, com = {{0, 0, 1}});\n"
                 "  joint j = Spherical(world, b, at = {0, 0, 0});")  # fmt: skip


def test_a_matrix_of_inertia_belongs_to_a_body() -> None:
    """Random bodies of points have such matrices; one whose moments are changed has none."""
    assert solid("{{2, 1.9, 0}, {1.9, 2, 0}, {0, 0, 0.5}}") == ["LAG0308"]
    assert solid("{{1, 0.5, 0}, {0.5, 1, 0}, {0, 0, 1.5}}") == []
    chance = np.random.default_rng(1)
    for _ in range(20):
        points = chance.normal(size=(chance.integers(2, 6), 3))
        real = sum(np.dot(r, r) * np.eye(3) - np.outer(r, r) for r in points)
        values, axes = np.linalg.eigh(real)
        wrong = axes @ np.diag([values[0], values[1], 1.01 * (values[0] + values[1])]) @ axes.T
        for matrix, expected in ((real, []), (0.5 * (wrong + wrong.T), ["LAG0308"])):
            rows = ", ".join("{" + ", ".join(f"{a!r}" for a in row.tolist()) + "}" for row in matrix)
            assert solid("{" + rows + "}") == expected


TEXT = """
model Part
  parameter Mass m = 2 [kg];
  input Force pull;
  coordinate Length x[2];
  coordinate Orientation o;
  speed Velocity fast = 2*der(x[1]);
  frame F = rotate(world, o);
  body b = Solid(mass = m, inertia = {1, 2, 3} [kg.m2], frame = F, com = {x[1], x[2], 0});
  force push = {pull, 0, 0} at b;
end Part;
model Middle Part q; end Middle;
model Whole Part p; Part a[2]; Middle deep; end Whole;
"""
# Type, what stands before the path of the part, and behind it.
LEAVES = [
    ("Mass", "", "m"), ("Force", "", "pull"), ("Length", "", "x[2]"), ("Velocity", "", "fast"),
    *(("Real", "", f"o.{part}") for part in "wxyz"),
    *(("AngularVelocity", "", f"o.rate.{axis}") for axis in "xyz"),
    ("Velocity", "der(", "x[1])"), ("Acceleration", "der(der(", "x[2]))"),
    ("Acceleration", "der(", "fast)"), ("AngularAcceleration", "der(", "o.rate.y)"),
    ("Power", "power(", "push)"), ("Momentum", "momentum(", "x[1])"),
]  # fmt: skip
TOTALS = [
    ("Time", "time"), *(("Energy", f"{name}()") for name in ("energy", "kinetic", "potential")),
    *(("Momentum", f"momentum().{axis}") for axis in "xyz"),
    *(("AngularMomentum", f"angular_momentum().{axis}") for axis in "xyz"),
]  # fmt: skip


@pytest.mark.parametrize("where", ["p.", "a[2].", "deep.q."])
def test_a_symbol_writes_itself_as_the_language_does(where: str) -> None:
    """Each expression is one leaf, whose name is that expression; their records differ."""
    asked = [*TOTALS, *((kind, f"{head}{where}{tail}") for kind, head, tail in LEAVES)]
    outputs = "".join(f"output {kind} y{k} = {name};" for k, (kind, name) in enumerate(asked))
    model = read(TEXT.replace("end Whole", f"{outputs} end Whole"), model="Whole")
    leaves = [output.expression for output in model.outputs]
    assert [leaf.op for leaf in leaves] == ["symbol"] * len(asked)
    assert [leaf.record.name for leaf in leaves] == [name for _, name in asked]
    assert len({leaf.record for leaf in leaves}) == len(asked)


def test_derivatives_of_records_are_those_of_names() -> None:
    """At the state level: q, its rates, declared speeds and body rates."""
    model = read(TEXT, model="Part")
    orientation = model.coordinates[-1]
    moving = [model.coordinates[0].symbol, model.coordinates[0].rate_symbol, model.speeds[0].symbol,
              *orientation.rate_symbols]  # fmt: skip
    for symbol in moving:
        assert symbol.record.derivative.name == derived(symbol.record.name)
        assert model.graph.leaf(symbol.record) is symbol


@pytest.mark.parametrize("name", ["o.w", "o.rate.x", "der(x[1])", "m", "fast"])
def test_only_coordinates_that_are_numbers_have_a_momentum(name: str) -> None:
    text = TEXT.replace("end Part;", f"output Real y = momentum({name}); end Part;", 1)
    with pytest.raises(Refused) as refused:
        read(text, model="Part")
    assert "LAG0221" in {fault.code for fault in refused.value.faults}
