"""Statements of the language against what can be worked out by hand."""

import re
from math import cos, cosh, exp, sin, sqrt

import pytest

import lagc
from lagc.api import Run
from tests.semantics.reading import output, read_body

ACCURACY = 1e-9  # asked of the runs, relative and global; the comparisons allow ten times that


def run(text: str, stop: float = 1.0) -> Run:
    found = lagc.loads(text).compile(backend="numpy").simulate(stop=stop, accuracy=ACCURACY)
    assert found.status == "ok"
    return found


def near(expected: float) -> object:
    return pytest.approx(expected, rel=10 * ACCURACY, abs=10 * ACCURACY)


def test_the_remedy_for_a_number_beside_a_vector_mends_it() -> None:
    text = "model A coordinate Length x, y; body b = Particle(mass = 2, at = {x, y, 0});"
    text += "constraint c: velocity(b) = 0; end A;"
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text).compile()
    (fault,) = refused.value.faults
    new, old = re.findall("`([^`]*)`", fault.remedy or "")
    assert lagc.loads(text.replace(f"= {old};", f"= {new};")).compile().interface.nc == 2


def test_a_rayleigh_function() -> None:
    found = run(
        "model A coordinate Length x(rate = 2); body b = Particle(mass = 2, at = {x, 0, 0});"
        "dissipation D = 1/2*3 [N.s/m]*der(x)^2; output Power p = power(D); end A;"
    )
    v = 2 * exp(-1.5)
    assert found["der(x)"][-1] == near(v)
    assert found["p"][-1] == near(-3 * v * v)  # what the damper takes


def test_a_potential_that_depends_on_the_velocity() -> None:
    """A charge in a magnetic field B along z turns clockwise with q B/m = 6 rad/s."""
    found = run(
        "model A coordinate Length x, y, z; parameter Charge q = 2; parameter MagneticField B = 3;"
        "body p = Particle(mass = 1, at = {x, y, z});"
        "lagrangian magnetic = q*dot(1/2*B*cross(world.z, position(p)), velocity(p));"
        "scene s start der(x) = 1; end s; end A;"
    )
    assert found["x"][-1] == near(sin(6) / 6)
    assert found["y"][-1] == near(-(1 - cos(6)) / 6)


@pytest.mark.parametrize("term", ["kinetic K = k; potential V = v;", "lagrangian L = k - v;"])
def test_free_terms(term: str) -> None:
    text = (
        "model A coordinate Angle a(rate = 1); "
        + term.replace("= k", "= 1/2*2 [kg.m2]*der(a)^2").replace("v;", "3 [J]*a^2/2;")
        + "output Energy E = energy(); output Action p = momentum(a); end A;"
    )
    found = run(text)
    w = sqrt(1.5)
    assert found["a"][-1] == near(sin(w) / w)
    assert found["E"][-1] == near(1.0)
    assert found["p"][-1] == near(2 * cos(w))


def test_a_torque_between_two_bodies() -> None:
    found = run(
        "model A coordinate Angle a, b; frame F = rotate_z(world, a); frame G = rotate_z(world, b);"
        "body s = Solid(mass = 1, inertia = {2, 2, 2}, frame = F, com = {0, 0, 0});"
        "body t = Solid(mass = 1, inertia = {4, 4, 4}, frame = G, com = {0, 0, 0});"
        "torque M = {0, 0, 4} on s from t; output Power p = power(M);"
        "output AngularMomentum L[3] = angular_momentum(); end A;"
    )
    assert (found["a"][-1], found["b"][-1]) == (near(1.0), near(-0.5))
    assert found["p"][-1] == near(4 * (2 + 1))
    assert found["L[3]"][-1] == near(0.0)


@pytest.mark.parametrize(
    "constraint, unit, expected",
    [
        ("norm(position(b)) = 1 [m]", "N", -9.81 * 2),  # lhs - rhs grows outward, the string pulls inward
        ("1 [m] = norm(position(b))", "N", 9.81 * 2),
        ("dot(position(b), position(b)) = 1 [m2]", "N/m", -9.81),  # the gradient is 2 m long
        ("z = -1 [m]", "N", 9.81 * 2),  # lhs - rhs grows upward, the floor pushes up
        ("der(z) = 0", "N", 9.81 * 2),
        ("5*z = -5 [m]", "N", 9.81 * 2 / 5),
    ],
)
def test_a_reaction_is_positive_along_the_gradient(constraint: str, unit: str, expected: float) -> None:
    found = run(
        "model A coordinate Length x, z(start = -1); body b = Particle(mass = 2, at = {x, 0, z}); Gravity g;"
        f"constraint c: {constraint}; output Real[{unit}] R = reaction(c); end A;"
    )
    assert found["R"] == pytest.approx(expected, rel=1e-10)


def test_a_vector_of_constraints_and_a_moving_one() -> None:
    found = run(
        "model A coordinate Length x, y, z; body b = Particle(mass = 2, at = {x, y, z});"
        "Gravity g(direction = {0, -1, 0}); constraint path: position(b) = {0, 0, 3 [m/s2]*time^2/2};"
        "output Force R[3] = reaction(path); output Acceleration a[3] = acceleration(b); end A;"
    )
    assert [found[f"R[{k}]"][-1] for k in (1, 2, 3)] == [near(0.0), near(2 * 9.81), near(6.0)]
    assert found["a[3]"][0] == near(3.0)


def test_a_bead_on_a_line_that_turns() -> None:
    found = run(
        "model A parameter AngularVelocity W = 3; coordinate Length r(start = 0.1);"
        "frame F = rotate_z(world, W*time); body b = Particle(mass = 2, at = r*F.x);"
        "output AngularVelocity w[3] = angular_velocity(F); end A;"
    )
    assert found["r"][-1] == near(0.1 * cosh(3))
    assert found["w[3]"][-1] == near(3.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "frame",
    [
        "rotate(world, {cos(a), sin(a), 0}, c)",  # about an axis that turns itself
        "rotate(rotate_y(world, a), {1, 2, 3}, c)",
        "rotate(rotate_x(rotate_z(world, a), c), o)",
        "rotate_z(rotate(world, o), a + 2*c)",
    ],
)
def test_the_angular_velocity_is_that_of_the_axes(frame: str) -> None:
    found = run(
        "model A coordinate Angle a(rate = 0.7), c(start = 0.4, rate = 0.3);"
        "coordinate Orientation o(start = {1, 0.2, 0, 0.5}, rate = {0.3, 1, 0.2});"
        f"frame F = {frame}; frame G = rotate(world, o); frame H = rotate_x(rotate_z(world, a), c);"
        "body s = Solid(mass = 1, inertia = {1, 2, 2.5}, frame = F, com = 0.2 [m]*F.x);"
        "body t = Solid(mass = 1, inertia = {1, 1, 1.5}, frame = G, com = {0, 0, 0});"
        "body u = Solid(mass = 1, inertia = {1, 1, 1.5}, frame = H, com = {0, 0, 0});"
        "output Real d[3] = {norm(der(F.x) - cross(angular_velocity(F), F.x))*1 [s],"
        " norm(der(F.y) - cross(angular_velocity(F), F.y))*1 [s], norm(cross(F.x, F.y) - F.z)};"
        "output Velocity v = norm(velocity(s, at = {0, 0, 0})); output Energy E = energy(); end A;"
    )
    for k in (1, 2, 3):
        assert max(abs(found[f"d[{k}]"])) < 1e-12  # some rounding, of numbers near 1
    assert max(abs(found["v"])) < 1e-12  # the origin is a point of the solid
    assert found["E"][-1] == near(found["E"][0])


def test_an_off_centre_solid_is_a_compound_pendulum() -> None:
    found = run(
        "model A parameter Mass m = 2; parameter Length d = 0.3; coordinate Angle a(start = 1);"
        "frame F = rotate_y(world, a); Gravity g;"
        "body b = Solid(mass = m, frame = F, com = -d*F.z,"
        " inertia = {{1, 0, 0.1}, {0, 2, 0}, {0.1, 0, 2.5}});"
        "output AngularAcceleration w = der(der(a)); end A;"
    )
    theta = found["a"]
    expected = [-2 * 9.81 * 0.3 * sin(t) / (2 + 2 * 0.3**2) for t in theta]
    assert found["w"] == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize(
    "expression, expected",
    [
        ("size(K)", 2), ("size(K, 2)", 3), ("size(P)", 2), ("size(Q, 1) + 10*size(Q, 2)", 23),
        ("sum(K[1:2, 3])", 9), ("sum(K[2, 3:-1:1])", 15), ("norm(K[1, 1:3])", sqrt(14)),
        ("size(K[1:2, 2:3], 2)", 2), ("P[2].x/1 [m]", 8), ("Q[3, 2].y/1 [m]", 6),
    ],
)  # fmt: skip
def test_arrays_and_their_parts(expression: str, expected: float) -> None:
    model = read_body(
        "parameter Real K[2, 3] = {{1, 2, 3}, {4, 5, 6}};"
        "for i in 1:2 loop point P[i] = {i*x, 0, 0}; end for;"
        "for i in 1:3 loop for j in 1:2 loop point Q[i, j] = {0, i*j*1 [m], 0}; end for; end for;"
        f"output Real y = {expression};"
    )
    assert output(model, "y", x=4.0) == pytest.approx(expected, rel=1e-15)
