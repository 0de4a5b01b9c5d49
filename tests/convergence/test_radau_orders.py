"""Radau IIA of order 5: its coefficients, and the order of its steps with and without a constraint."""

from itertools import pairwise
from math import log2
from typing import Any

import numpy as np

import lagc
from lagc.kernels.integrators.tableaus import radau5
from tests.simulation.test_radau import PENDULUM


def test_coefficients_solve_the_collocation_conditions() -> None:
    """The rows of A integrate powers up to 2; A^-1 and T diag T^-1 are what they are named (30 digits)."""
    from mpmath import matrix, mpf, norm, workdps

    def rows(table: tuple[dict[int, str], ...], first: int) -> Any:
        number = lambda text: mpf(text.partition("/")[0]) / mpf(text.partition("/")[2] or "1")  # noqa: E731
        return matrix([[number(row.get(first + j, "0")) for j in range(3)] for row in table])

    with workdps(40):
        c = [mpf(text) for text in radau5.C]
        a, inverse = rows(radau5.A, 2), rows(radau5.INVERSE, 2)
        forth, back = rows(radau5.FORTH, 1), rows(radau5.BACK, 1)
        for k in range(1, 4):
            for i in range(3):
                assert abs(sum(a[i, j] * c[j] ** (k - 1) for j in range(3)) - c[i] ** k / k) < 1e-35
        shift, (re, im) = mpf(radau5.SHIFT), map(mpf, radau5.SHIFTS)
        diagonal = matrix([[shift, 0, 0], [0, re, -im], [0, im, re]])
        assert norm(a * inverse - matrix([[1, 0, 0], [0, 1, 0], [0, 0, 1]])) < 1e-35
        assert norm(back * diagonal * forth - inverse) < 1e-34


def fixed(text: str, step: float) -> Any:
    """The end of a run over 1 s in fixed steps."""
    return lagc.loads(text).compile(backend="numpy").simulate(1.0, method="radau5", step=step).final


def test_orders_of_fixed_steps() -> None:
    """Order 5 on a pendulum and, with its constraint at velocity level, on the same pendulum in x and y."""
    plane = """model Plane
  parameter Length l = 1 [m];
  coordinate Length x(start = sin(1)*l), y(start = -cos(1)*l);
  body b = Particle(mass = 1 [kg], at = {x, 0 [m], y});
  constraint rod: x^2 + y^2 = l^2;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
end Plane;"""
    exact = (
        lagc.loads(PENDULUM)
        .compile(backend="numpy")
        .simulate(1.0, method="dop853", rtol=1e-14)
        .final["theta"]
    )
    cases: list[tuple[str, Any]] = [(PENDULUM, lambda f: f["theta"])]
    cases.append((plane, lambda f: np.arctan2(f["x"], -f["y"])))
    for text, angle in cases:
        steps = (0.1, 0.05, 0.025)
        errors = [abs(angle(fixed(text, h)) - exact) for h in steps]
        for coarse, fine in pairwise(errors):
            assert 4.5 < log2(coarse / fine) < 6.0, errors
