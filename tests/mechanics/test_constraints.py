"""Rows: their kinds, redundancy, contradiction; faults of the mechanics, each with its code."""

from collections.abc import Callable

import pytest

from lagc.diagnostics.faults import Refused
from lagc.mechanics.derive import derive
from lagc.symbolic.graph import Node
from tests.mechanics.builder import SPAN, Builder


def plane(*names: str) -> tuple[Builder, list[Node]]:
    b = Builder()
    q = [b.coordinate(name) for name in names or ("x", "y", "z")]
    b.particle("p", b.parameter("m"), (*q, 0.0, 0.0)[:3])
    return b, q


def codes(b: Builder) -> list[str]:
    with pytest.raises(Refused) as refused:
        derive(b.model())
    assert all(f.span is not None and f.remedy for f in refused.value.faults)
    return [f.code for f in refused.value.faults]


def test_holonomic_rows_come_first() -> None:
    b, (x, y, z) = plane()
    b.constraint("roll", b.der(x) - b.der(y) * z)
    b.constraint("path", z - b.graph.sin(b.time))
    b.constraint("fast", b.der(x) ** 2 - 1.0)
    rows = derive(b.model()).rows
    assert [(r.label, r.level.value, r.linear, r.time_dependent) for r in rows] == [
        ("path", "position", True, True),
        ("roll", "velocity", True, False),
        ("fast", "velocity", False, False),
    ]


def test_a_constraint_on_a_declared_speed_is_no_position() -> None:
    b, (x, y, _) = plane()
    u = b.speed("u", b.der(x) + b.der(y))
    b.constraint("slow", u - 1.0)
    assert [r.level.value for r in derive(b.model()).rows] == ["velocity"]


def test_velocity_row_that_sums_two_others_is_left_out() -> None:
    b, (x, y, z) = plane()
    b.constraint("a", b.der(x) - b.der(z))
    b.constraint("b", x * b.der(y) + b.der(z))
    b.constraint("c", b.der(x) + x * b.der(y))
    e = derive(b.model())
    assert e.dropped == ("row `c` is left out: it follows from `a`, `b`",)


def test_hidden_zero_is_left_out() -> None:
    """A row whose terms cancel by an identity that the graph does not know."""
    b, (x, y, _) = plane()
    g = b.graph
    hidden = g.sin(2.0 * y) - 2.0 * g.sin(y) * g.cos(y)
    b.constraint("nothing", b.der(x) * hidden)
    assert derive(b.model()).dropped == ("row `nothing` is left out: it holds whatever the motion",)


def circle(radius: float, rooted: bool = False) -> Builder:
    """A particle on a circle, and a row that asks for another radius, or that."""
    b = Builder()
    angle, length = b.coordinate("angle"), b.parameter("l")
    x, y = length * b.graph.sin(angle), length * b.graph.cos(angle)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    residual = b.graph.sqrt(x**2 + y**2) - radius * length if rooted else x**2 + y**2 - (radius * length) ** 2
    b.constraint("circle", residual)
    return b


def test_row_that_the_geometry_meets_is_left_out() -> None:
    assert not derive(circle(1.0).model()).rows


def test_row_that_the_geometry_never_meets() -> None:
    assert codes(circle(2.0)) == ["LAG0409"]


def test_row_that_the_geometry_meets_for_one_sign_of_a_parameter() -> None:
    assert codes(circle(1.0, rooted=True)) == ["LAG0409"]


def test_velocity_row_that_agrees_on_positions_only_is_kept_consistent() -> None:
    """der(z) = z - 1 follows from z = 1, though not where z is anything else."""
    b, (_, _, z) = plane()
    b.constraint("height", z - 1.0)
    b.constraint("rise", b.der(z) - (z - 1.0))
    assert derive(b.model()).dropped == ("row `rise` is left out: it follows from `height`",)


def test_rows_that_agree_for_some_parameters_stay() -> None:
    """Equal by default, not for other values: the run will tell."""
    b, (x, _, _) = plane()
    b.constraint("a", x - b.parameter("first", 1.0))
    b.constraint("b", x - b.parameter("second", 1.0))
    assert len(derive(b.model()).rows) == 2


def test_sides_that_always_differ() -> None:
    b, (x, _, _) = plane()
    b.constraint("c", x - x + 2.0)
    assert codes(b) == ["LAG0408"]


def test_relation_of_parameters() -> None:
    b, _ = plane()
    b.constraint("c", b.parameter("a") - b.parameter("b"))
    assert codes(b) == ["LAG0409"]


ONE_SIDED = {  # zero where l is 1, and not for all others
    "root": lambda g, a: g.sqrt(a * a) - a,
    "max": lambda g, a: g.binary("max", a, -g.one) - a,
    "min": lambda g, a: g.binary("min", a, g.zero),
    "select": lambda g, a: g.select(g.binary("lt", g.zero, a), g.zero, a),
    "sign": lambda g, a: g.unary("sign", a) - 1.0,
}


@pytest.mark.parametrize("way", ONE_SIDED)
def test_row_that_holds_for_some_values_of_a_parameter_alone(way: str) -> None:
    b, _ = plane()
    b.constraint("c", ONE_SIDED[way](b.graph, b.parameter("l", 1.0)))
    assert codes(b) == ["LAG0409"]


@pytest.mark.parametrize("way", ONE_SIDED)
def test_velocity_row_that_holds_for_some_values_of_a_parameter_stays(way: str) -> None:
    """It says nothing where l > 0, and forbids any motion where l is less."""
    b, (x, _, _) = plane()
    b.constraint("c", ONE_SIDED[way](b.graph, b.parameter("l", 1.0)) * b.der(x))
    assert [r.label for r in derive(b.model()).rows] == ["c"]


def test_zero_rows_of_a_vector_are_no_rows() -> None:
    b, (x, y, _) = plane()
    b.constraint("c", x, 0.0, y)
    assert [r.label for r in derive(b.model()).rows] == ["c[1]", "c[3]"]


def _mass_in_time(b: Builder, q: list[Node]) -> None:
    b.particle("leaking", b.graph.sin(b.time) + 2.0, (q[0], 0.0, 0.0))


def _input_in_lagrangian(b: Builder, q: list[Node]) -> None:
    b.lagrangian("extra", b.input("u") * b.der(q[0]) ** 2)


def _input_in_constraint(b: Builder, q: list[Node]) -> None:
    b.constraint("c", q[0] - b.input("u"))


def _quadratic_speed(b: Builder, q: list[Node]) -> None:
    b.speed("u", b.der(q[0]) ** 2)


def _dependent_speeds(b: Builder, q: list[Node]) -> None:
    b.speed("u", b.der(q[0]) + b.der(q[1]))
    b.speed("w", 2.0 * b.der(q[0]) + 2.0 * b.der(q[1]))


def _speed_of_nothing(b: Builder, q: list[Node]) -> None:
    b.speed("u", q[0] + 0.0)


def _many_speeds(b: Builder, q: list[Node]) -> None:
    for k in range(4):
        b.speed(f"u{k}", b.der(q[0]) + k * b.der(q[1]))


@pytest.mark.parametrize(
    "change, code",
    [
        (_quadratic_speed, "LAG0401"), (_dependent_speeds, "LAG0402"), (_speed_of_nothing, "LAG0402"),
        (_many_speeds, "LAG0403"), (_mass_in_time, "LAG0404"), (_input_in_lagrangian, "LAG0406"),
        (_input_in_constraint, "LAG0407"),
    ],
)  # fmt: skip
def test_refused(change: Callable[[Builder, list[Node]], None], code: str) -> None:
    b, q = plane()
    change(b, q)
    assert codes(b) == [code]


def test_all_faults_of_a_stage_at_once() -> None:
    b, (x, y, _) = plane()
    u = b.input("u")
    b.constraint("a", x - u)
    b.constraint("b", y - u)
    assert codes(b) == ["LAG0407", "LAG0407"]
    assert SPAN.line == 1
