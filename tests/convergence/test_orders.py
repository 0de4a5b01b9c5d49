"""The methods have the orders of their tableaus: order conditions, and measured orders."""

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import pairwise
from math import cos, exp, factorial, inf, log2, sin, sqrt
from random import Random
from typing import Any

import pytest
from mpmath import mpf, workdps

from lagc.codegen.kernel_compiler.kernel_syntax import exact
from lagc.compiler.stages import render
from lagc.kernels.integrators.tableaus import bs32, dop853, dopri5, rk4
from lagc.simulation.system import OK, Options, Vector
from tests.codegen.tools import of_model
from tests.interfaces import interface
from tests.simulation.handmade import integrate, integrator
from tests.simulation.systems import LINE, Handmade, Oscillator, Rod

Row = dict[int, float]  # stage -> coefficient; stages count from 1, zeros are left out


class Tableau:
    """A method of `lagc.kernels.integrators.tableaus`, in numbers of a type."""

    def __init__(
        self, method: Any, error_order: int, dense_order: int, number: Callable[[Fraction], Any] = float
    ) -> None:
        self.name: str = method.__name__.rpartition(".")[2]
        self.order: int = method.ORDER
        self.error_order, self.dense_order = error_order, dense_order
        self.c, self.extra_c = ([number(exact(c)) for c in row] for row in (method.C, method.EXTRA_C))
        self.a, self.errors, self.extra_a, self.dense = (
            [_row(row, number) for row in rows]
            for rows in (method.A, method.ERROR, method.EXTRA_A, method.DENSE)
        )
        self.b = _row(method.B, number)
        self.uses_new = bool(method.USES_END_RATE)
        self.exponent, self.beta = float(exact(method.EXPONENT)), float(exact(method.BETA))

    @property
    def stages(self) -> int:
        """s, without the evaluation at the new point."""
        return len(self.c)


def _row(row: dict[int, str], number: Callable[[Fraction], Any]) -> Row:
    return {stage: number(exact(text)) for stage, text in row.items()}


DOPRI5, DOP853 = Tableau(dopri5, 4, 4), Tableau(dop853, 7, 7)
METHODS = pytest.mark.parametrize("tableau", [DOPRI5, DOP853], ids=["dopri5", "dop853"])

Tree = tuple["Tree", ...]


def trees(order: int, largest: Tree | None = None) -> Iterator[Tree]:
    """The rooted trees with `order` nodes: a node is the tuple of its branches."""
    yield from (tuple(f) for f in forests(order - 1, order - 1))


def forests(nodes: int, most: int) -> Iterator[list[Tree]]:
    """Multisets of trees with `nodes` nodes in all, each of at most `most`."""
    if nodes == 0:
        yield []
        return
    for size in range(min(nodes, most), 0, -1):
        same = list(trees(size))
        for count in range(nodes // size, 0, -1):
            for chosen in _multisets(same, count):
                for rest in forests(nodes - count * size, size - 1):
                    yield [*chosen, *rest]


def _multisets(items: list[Tree], count: int, first: int = 0) -> Iterator[list[Tree]]:
    if count == 0:
        yield []
        return
    for i in range(first, len(items)):
        for rest in _multisets(items, count - 1, i):
            yield [items[i], *rest]


def nodes(tree: Tree) -> int:
    return 1 + sum(nodes(branch) for branch in tree)


def density(tree: Tree) -> int:
    value = nodes(tree)
    for branch in tree:
        value *= density(branch)
    return value


def weights(tree: Tree, a: list[list[float]]) -> list[float]:
    """Phi_i(tree) for each stage: the product over branches of sum_j a_ij Phi_j(branch)."""
    found = [1.0] * len(a)
    for branch in tree:
        inner = weights(branch, a)
        found = [f * sum(x * y for x, y in zip(row, inner)) for f, row in zip(found, a)]
    return found


def matrix(tableau: Tableau) -> list[list[float]]:
    """a of all stages: the method's, the new point, the ones for dense output."""
    rows = [*tableau.a, tableau.b, *tableau.extra_a]
    return [[row.get(j + 1, 0.0) for j in range(len(rows))] for row in rows]


def dot(row: Row, values: list[float]) -> float:
    return sum(value * values[stage - 1] for stage, value in row.items())


def test_number_of_trees() -> None:
    assert [len(list(trees(n))) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


@METHODS
def test_order_conditions(tableau: Tableau) -> None:
    """sum_i b_i Phi_i(tree) = 1/gamma(tree) for every tree up to the order, and not beyond
    (Hairer, Norsett, Wanner 1993, theorem II.2.13)."""
    a = matrix(tableau)
    for order in range(1, tableau.order + 1):
        for tree in trees(order):
            assert dot(tableau.b, weights(tree, a)) == pytest.approx(1.0 / density(tree), abs=2e-14), tree
    beyond = (abs(dot(tableau.b, weights(t, a)) - 1.0 / density(t)) for t in trees(tableau.order + 1))
    assert max(beyond) > 1e-7


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("method", "errors", "dense"),
    [(dop853, (5, 3), 7), (dopri5, (4,), 4), (rk4, (), 3), (bs32, (2,), 3)],
    ids=["dop853", "dopri5", "rk4", "bs32"],
)
def test_coefficients_have_the_digits_of_quadruple_precision(
    method: Any, errors: tuple[int, ...], dense: int
) -> None:
    """Every condition of the method, of its errors, which none up to their orders sees, and of dense output,
    holds to 1e-24: 30 digits are published."""
    with workdps(45):
        tableau = Tableau(method, 0, dense, lambda c: mpf(c.numerator) / c.denominator)
        a = matrix(tableau)
        asked = [(tableau.b, method.ORDER, 1), *((row, n, 0) for row, n in zip(tableau.errors, errors))]
        asked += [(interpolant(tableau, s), dense, s) for s in (mpf(3) / 10, mpf(7) / 8)]
        for tree in [tree for n in range(1, method.ORDER + 1) for tree in trees(n)]:
            values = weights(tree, a)
            for row, order, s in asked:
                if nodes(tree) <= order:
                    assert abs(dot(row, values) - mpf(s) ** nodes(tree) / density(tree)) < 1e-24, tree


@METHODS
def test_step_control_is_that_of_the_order_of_the_error(tableau: Tableau) -> None:
    """To 1/128: exponents are sums of powers of 1/2."""
    expected = 1.0 / (tableau.error_order + 1) - 0.75 * tableau.beta
    assert tableau.exponent == pytest.approx(expected, abs=1.0 / 128.0)
    assert 128.0 * tableau.exponent % 1.0 == 0.0 and 128.0 * tableau.beta % 1.0 == 0.0
    assert tableau.uses_new == any(tableau.stages + 1 in row for row in tableau.errors)


def test_powers_of_errors_are_right_to_a_few_last_places() -> None:
    """Each root and each product rounds once; seven of both at the most."""
    space: dict[str, Any] = {}
    exec(render(of_model("classic/double_pendulum"), "numpy")["double_pendulum.py"], space)
    chance = Random(1)
    for a in [10.0 ** chance.uniform(-300.0, 300.0) for _ in range(200)]:
        exponent = chance.randrange(128) / 128.0
        with workdps(30):
            assert abs(space["rational_power"](a, exponent) / mpf(a) ** exponent - 1) < 1e-15
    assert space["rational_power"](0.0, 0.125) == 0.0 and space["rational_power"](inf, 0.125) == inf


@METHODS
def test_stage_times_are_row_sums(tableau: Tableau) -> None:
    times = [*tableau.c, 1.0, *tableau.extra_c]
    assert [sum(row) for row in matrix(tableau)] == pytest.approx(times, abs=1e-14)


@pytest.mark.parametrize(
    ("tableau", "row", "order"),
    [(DOPRI5, DOPRI5.errors[0], 4), (DOP853, DOP853.errors[0], 5), (DOP853, DOP853.errors[1], 3)],
    ids=["dopri5", "dop853-5", "dop853-3"],
)
def test_error_rows_vanish_to_their_order(tableau: Tableau, row: Row, order: int) -> None:
    """The difference of two methods: no condition up to the lower order sees it."""
    a = matrix(tableau)
    for n in range(1, order + 1):
        for tree in trees(n):
            assert dot(row, weights(tree, a)) == pytest.approx(0.0, abs=2e-14)
    assert max(abs(dot(row, weights(tree, a))) for tree in trees(order + 1)) > 1e-7


@METHODS
@pytest.mark.parametrize("s", [0.2, 0.5, 0.9])
def test_order_conditions_of_dense_output(tableau: Tableau, s: float) -> None:
    """sum_i b_i(s) Phi_i(tree) = s^order/gamma(tree)."""
    a = matrix(tableau)
    b = interpolant(tableau, s)
    for order in range(1, tableau.dense_order + 1):
        for tree in trees(order):
            expected = s**order / density(tree)
            assert dot(b, weights(tree, a)) == pytest.approx(expected, abs=1e-12), (order, tree)


def interpolant(tableau: Tableau, s: float) -> Row:
    """The weights b_i(s) of the dense output, from the recursion in `Tableau`."""
    n = tableau.stages + 1
    r1 = {i: tableau.b.get(i, 0.0) for i in range(1, n + 1)}
    r2 = {i: (i == 1) - r1[i] for i in r1}
    r3 = {i: r1[i] - (i == n) - r2[i] for i in r1}
    found: dict[int, float] = {}
    factor = 1.0
    for k, row in enumerate((r1, r2, r3, *tableau.dense)):
        factor *= s if k % 2 == 0 else 1.0 - s
        for i, value in row.items():
            found[i] = found.get(i, 0.0) + factor * value
    return found


class Closed(Handmade):
    """q' = -2 t q^2, v' = -v cos t: q = 1/(1 + t^2), v = exp(-sin t)."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = -2.0 * t * x[0] * x[0], -x[1] * cos(t)
        return OK

    def error(self, t: float, x: Vector) -> float:
        return sqrt((x[0] - 1.0 / (1.0 + t * t)) ** 2 + (x[1] - exp(-sin(t))) ** 2)

    def exact(self, t: float) -> list[float]:
        return [1.0 / (1.0 + t * t), exp(-sin(t))]


class Kepler(Handmade):
    """A planet of eccentricity 0.2, from perihelion."""

    def __init__(self) -> None:
        super().__init__(interface(nq=2, nv=2, q_names=("x", "y"), v_names=("u", "v"), q_units=("",) * 2,
                                   v_units=("",) * 2))  # fmt: skip

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        r = sqrt(x[0] * x[0] + x[1] * x[1])
        xdot[:] = [x[2], x[3], -x[0] / r**3, -x[1] / r**3]
        return OK

    def exact(self, t: float) -> list[float]:
        e, anomaly = 0.2, t
        for _ in range(50):
            anomaly -= (anomaly - e * sin(anomaly) - t) / (1.0 - e * cos(anomaly))
        c, s, minor = cos(anomaly), sin(anomaly), sqrt(1.0 - e * e)
        rate = 1.0 / (1.0 - e * c)
        return [c - e, minor * s, -s * rate, minor * c * rate]

    def error(self, t: float, x: Vector) -> float:
        return sqrt(sum((a - b) ** 2 for a, b in zip(x, self.exact(t))))


class Fall(Handmade):
    """x'' = 2 x^3 from rest at infinity: x = 1/(3 - t)."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = x[1], 2.0 * x[0] * x[0] * x[0]
        return OK

    def exact(self, t: float) -> list[float]:
        return [1.0 / (3.0 - t), 1.0 / (3.0 - t) ** 2]

    def error(self, t: float, x: Vector) -> float:
        return sqrt(sum((a - b) ** 2 for a, b in zip(x, self.exact(t))))


class Swing(Oscillator):
    """x = cos t."""

    def exact(self, t: float) -> list[float]:
        return [cos(t), -sin(t)]

    def error(self, t: float, x: Vector) -> float:
        return sqrt(sum((a - b) ** 2 for a, b in zip(x, self.exact(t))))


def slopes(errors: list[float]) -> list[float]:
    return [log2(a / b) for a, b in pairwise(errors)]


@pytest.mark.parametrize(
    ("tableau", "system", "t0", "t1", "first"),
    [
        (DOPRI5, Swing(), 0.0, 20.0, 1 / 4),
        (DOPRI5, Closed(), 0.5, 2.5, 1 / 32),
        (DOP853, Swing(), 0.0, 20.0, 1.0),
        (DOP853, Fall(), 0.0, 1.0, 1 / 3),
    ],
    ids=["dopri5-linear", "dopri5", "dop853-linear", "dop853"],
)
def test_order_of_fixed_steps(tableau: Tableau, system: Any, t0: float, t1: float, first: float) -> None:
    """Halving the step divides the global error by 2^order, in the limit."""
    errors = []
    for k in range(3):
        run = integrate(system, Options(method=tableau.name, step=first / 2**k), t0, system.exact(t0), [t1])
        errors.append(system.error(t1, run.x))
    assert slopes(errors)[-1] == pytest.approx(tableau.order, abs=0.15), slopes(errors)


@METHODS
@pytest.mark.parametrize("system", [Closed(), Kepler()], ids=["closed", "kepler"])
def test_order_of_dense_output(tableau: Tableau, system: Any) -> None:
    """Within one step from the exact state the error is O(h^(dense order + 1))."""
    first = 1 / 16 if tableau is DOPRI5 else 1 / 4
    errors = []
    for k in range(3):
        h = first / 2**k
        run = integrator(system, Options(method=tableau.name, step=h), 1.0, system.exact(1.0))
        assert run.step(1.0 + h) == OK
        worst = 0.0
        for s in (0.25, 0.5, 0.75):
            status, x = run.at(1.0 + s * h)
            assert status == OK
            worst = max(worst, system.error(1.0 + s * h, x))
        errors.append(worst)
    assert sum(slopes(errors)) / 2 == pytest.approx(tableau.dense_order + 1, abs=0.15), slopes(errors)


class Angle(Handmade):
    """The pendulum of `Rod` in its angle from below."""

    def __init__(self) -> None:
        super().__init__(interface(**LINE))

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        xdot[0], xdot[1] = x[1], -9.81 * sin(x[0])
        return OK


@METHODS
def test_projection_keeps_the_order(tableau: Tableau) -> None:
    """A pendulum in x and y on its circle, against its angle at the smallest tolerance.  (DOP853 is
    above its order at every step that rounding leaves visible.)"""
    angle = integrate(Angle(), Options(rtol=1e-14, atol=1e-14), 0.0, [1.0, 0.0], [2.0]).x[0]
    start = [sin(1.0), -cos(1.0), 0.0, 0.0]
    errors = []
    for steps in (40, 80, 160) if tableau is DOPRI5 else (20, 40, 80):
        run = integrate(Rod(), Options(method=tableau.name, step=2.0 / steps), 0.0, start, [2.0])
        assert run.position_drift <= 1e-15 and run.velocity_drift <= 1e-15
        errors.append(sqrt((run.x[0] - sin(angle)) ** 2 + (run.x[1] + cos(angle)) ** 2))
    assert slopes(errors)[-1] > tableau.order - 0.15, slopes(errors)


@METHODS
def test_error_follows_the_tolerance(tableau: Tableau) -> None:
    """Six decades of tolerance are six decades of global error, within one."""
    system = Kepler()
    errors = []
    for tolerance in (1e-5, 1e-11):
        options = Options(method=tableau.name, rtol=tolerance, atol=tolerance)
        run = integrate(system, options, 0.0, system.exact(0.0), [10.0])
        assert run.status == OK
        errors.append(system.error(10.0, run.x))
    assert 1e5 < errors[0] / errors[1] < 1e7 and errors[1] < 1e-8


def test_densities() -> None:
    assert density(((), ())) == 3 and density((((),),)) == factorial(3)
