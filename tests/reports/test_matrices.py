"""The matrices that people get for their own algebra."""

import sympy

import lagc


def test_the_simple_pendulum() -> None:
    """m l^2 theta'' = -m g l sin(theta)."""
    found = lagc.load("simple_pendulum").compile().matrices()
    m, length, g, theta = (sympy.Symbol(name, real=True) for name in ("m", "l", "field.g", "theta"))
    assert found.mass_matrix == sympy.Matrix([[m * length**2]])
    assert found.given_forces - found.bias_forces == sympy.Matrix([-m * g * length * sympy.sin(theta)])
    assert found.constraint_jacobian.shape == (0, 1)


def test_shapes_of_a_constrained_system() -> None:
    found = lagc.load("string_pendulum").compile().matrices()
    assert found.mass_matrix == sympy.Symbol("m", real=True) * sympy.eye(2)
    assert found.constraint_jacobian.shape == (1, 2) and found.gamma.shape == (1, 1)
    assert found.qdot == found.v
