"""Degrees of freedom of closed loops, the truth being known from how they are made, and seen again
in the singular values of a Jacobian by finite differences."""

import math
import random
from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np
import pytest

from lagc.mechanics.analysis.analysis import Analysis, analyse
from lagc.mechanics.analysis.mobility import mobility
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.constraints import classify
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.identities.constraint_manifold import walk
from lagc.semantics.model import Frame
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import Vector, add, matmul, matvec, sub, transpose
from lagc.symbolic.walk import evaluate
from tests.mechanics.builder import Builder

Made = tuple[Builder, int]  # with its mobility


def twist(b: Builder, frame: Frame, skew: Sequence[Sequence[Node]]) -> list[Node]:
    """Three rows that are zero where the matrix of a rotation is one of no turn, or of half ones."""
    return [skew[2][1], skew[0][2], skew[1][0]]


def ring(
    rng: random.Random,
    lengths: Sequence[float],
    twists: Sequence[float],
    offsets: Sequence[float],
    starts: Sequence[float],
    scale: float = 1.0,
) -> Builder:
    """Denavit and Hartenberg's loop: turn, offset, length, twist, until it is closed; six rows."""
    b = Builder()
    g = b.graph
    at, frame = b.vector((0.0, 0.0, 0.0)), b.world
    for k, (length, alpha, offset, start) in enumerate(zip(lengths, twists, offsets, starts)):
        q = b.coordinate(f"q{k}", start, unit="rad")
        frame = b.rotate(f"J{k}", frame, "z", q)
        step = (scale * b.parameter(f"a{k}", length), g.zero, scale * b.parameter(f"d{k}", offset))
        at = add(at, matvec(frame.axes, step))
        frame = b.rotate(f"L{k}", frame, "x", b.parameter(f"alpha{k}", alpha))
        b.solid(f"s{k}", g.one, (0.1, 0.2, 0.25), frame, at)
    b.constraint("closed", *at)
    b.constraint("turned", *twist(b, frame, frame.axes))
    return b


def planar(rng: random.Random, n: int = 5) -> Made:
    """An n-bar in a plane, in space: three of six rows are spare."""
    turns = [rng.uniform(0.4, 1.0) for _ in range(n - 1)]
    lengths = [rng.uniform(0.7, 1.5) for _ in range(n - 1)]
    heading, x, y = 0.0, 0.0, 0.0
    for turn, length in zip(turns, lengths):
        heading += turn
        x, y = x + length * math.cos(heading), y + length * math.sin(heading)
    back = math.atan2(-y, -x)
    starts = [*turns, back - heading]
    starts[0] -= back  # the last link comes back along the first axis: all turns add up to none
    twists = [0.0] * n
    b = ring(rng, [*lengths, math.hypot(x, y)], twists, twists, starts)
    return b, n - 3


def spherical(rng: random.Random, n: int = 4) -> Made:
    """All axes through one point: the three rows of position say nothing."""
    b = ring(rng, [0.0] * n, [rng.uniform(0.6, 1.1) for _ in range(n)], [0.0] * n,
             [rng.uniform(1.0, 1.9) for _ in range(n)])  # fmt: skip
    return b, n - 3


def bennett(rng: random.Random) -> Made:
    """G. T. Bennett's 4R: opposite links alike, sin(alpha)/a = sin(beta)/b."""
    alpha, beta = rng.uniform(0.4, 0.8), rng.uniform(0.9, 1.4)
    a = rng.uniform(0.5, 2.0)
    length = a * math.sin(beta) / math.sin(alpha)
    first = rng.uniform(0.7, 1.5)
    ratio = math.sin((alpha + beta) / 2.0) / math.sin((beta - alpha) / 2.0)
    second = 2.0 * math.atan(ratio / math.tan(first / 2.0))
    starts = [first, second, -first, -second]
    return ring(rng, [a, length] * 2, [alpha, beta] * 2, [0.0] * 4, starts), 1


def general_7r(rng: random.Random) -> Made:
    """Nothing special: 7 joints less 6 rows."""

    def draw(low: float, high: float) -> list[float]:
        return [rng.uniform(low, high) for _ in range(7)]

    return ring(rng, draw(0.5, 1.5), draw(-1.2, 1.2), draw(-0.3, 0.3), draw(0.6, 1.2)), 1


def sarrus(rng: random.Random) -> Made:
    """P. F. Sarrus: two legs that fold in different planes guide a plate up and down."""
    b = Builder()
    turn, low = rng.uniform(0.9, 2.0), rng.uniform(0.2, 0.5)
    ends: list[tuple[Vector, Frame]] = []
    for leg, heading in enumerate((0.0, turn)):
        length = rng.uniform(0.8, 1.4)
        frame = b.rotate(f"B{leg}", b.world, "z", b.graph.const(heading))
        at = matvec(frame.axes, b.vector((1.0, 0.0, 0.0)))
        for k, (start, reach) in enumerate([(low, length), (-2.0 * low, length), (low, 0.0)]):
            frame = b.rotate(f"F{leg}{k}", frame, "y", b.coordinate(f"q{leg}{k}", start, unit="rad"))
            at = add(at, matvec(frame.axes, b.vector((0.0, 0.0, reach))))
            b.solid(f"s{leg}{k}", b.graph.one, (0.1, 0.2, 0.25), frame, at)
        at = sub(at, matvec(frame.axes, b.vector((1.0, 0.0, 0.0))))
        ends.append((at, b.rotate(f"E{leg}", frame, "z", b.graph.const(-heading))))
    (left, first), (right, second) = ends
    b.constraint("closed", *sub(left, right))
    b.constraint("turned", *twist(b, first, matmul(transpose(first.axes), second.axes)))
    return b, 1


def cranks(rng: random.Random) -> Made:
    """A plate on three to six equal parallel cranks: each beyond the second is spare."""
    b = Builder()
    g = b.graph
    length = b.parameter("l", rng.uniform(0.5, 2.0))
    start = rng.uniform(0.3, 1.2)
    reach = rng.uniform(0.5, 2.0)
    x = b.coordinate("x", reach * math.cos(start))
    y = b.coordinate("y", reach * math.sin(start))
    turn = b.coordinate("turn", 0.0, unit="rad")
    frame = b.rotate("plate", b.world, "z", turn)
    b.solid("s", g.one, (0.1, 0.1, 0.2), frame, (x, y, 0.0))
    for k in range(rng.randint(3, 6)):
        px, py = rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)
        hx = x + px * g.cos(turn) - py * g.sin(turn) - px
        hy = y + px * g.sin(turn) + py * g.cos(turn) - py
        b.constraint(f"crank{k}", g.sqrt(hx * hx + hy * hy) - length)
    return b, 1


def windows(rng: random.Random) -> Made:
    """A row of parallelograms of equal links in a tilted plane, closed in space."""
    b = Builder()
    g = b.graph
    n = rng.randint(1, 4)
    tilt = b.rotate("tilt", b.world, "x", b.parameter("tilt", rng.uniform(0.2, 1.2)))
    crank, coupler = b.parameter("a", rng.uniform(0.5, 1.5)), b.parameter("b", rng.uniform(0.5, 1.5))
    start = rng.uniform(0.4, 1.2)
    th = [b.coordinate(f"th{k}", start, unit="rad") for k in range(n + 1)]
    ph = [b.coordinate(f"ph{k}", 0.0, unit="rad") for k in range(n)]

    def tip(angle: Node, length: Node) -> Vector:
        return matvec(tilt.axes, (length * g.cos(angle), length * g.sin(angle), g.zero))

    for k, angle in enumerate(th):
        b.particle(f"p{k}", g.one, tip(angle, crank))
    for k, angle in enumerate(ph):
        b.particle(f"c{k}", g.one, add(tip(th[k], crank), tip(angle, 0.5 * coupler)))
        base = tip(g.zero, coupler)
        b.constraint(
            f"loop{k}", *sub(add(tip(th[k], crank), tip(angle, coupler)), add(base, tip(th[k + 1], crank)))
        )
    return b, 1


def frames(rng: random.Random) -> Made:
    """Random points in a plane and random rods between them: generic, so the count of M. Gruebler
    holds where no part is overbraced: each new point hangs on at most two rods."""
    b = Builder()
    g = b.graph
    fixed = [(g.const(0.0), g.const(0.0)), (g.const(1.3), g.const(0.2))]
    points, values = list(fixed), [(0.0, 0.0), (1.3, 0.2)]
    freedom = 0
    for k in range(rng.randint(3, 7)):
        at = (rng.uniform(-1.0, 2.0), rng.uniform(-1.5, 1.5))
        x, y = b.coordinate(f"x{k}", at[0]), b.coordinate(f"y{k}", at[1])
        b.particle(f"p{k}", g.one, (x, y, 0.0))
        rods = rng.randint(1, 2)
        for other in rng.sample(range(len(points)), rods):
            (ox, oy), (sx, sy) = points[other], values[other]
            length = b.parameter(f"l{k}_{other}", math.hypot(at[0] - sx, at[1] - sy))
            b.constraint(f"rod{k}_{other}", (x - ox) ** 2 + (y - oy) ** 2 - length**2)
        freedom += 2 - rods
        points.append((x, y))
        values.append(at)
    return b, freedom


KINDS: list[Callable[[random.Random], Made]] = [
    planar, spherical, bennett, general_7r, sarrus, cranks, windows, frames,
    lambda rng: planar(rng, rng.randint(4, 8)), lambda rng: spherical(rng, rng.randint(5, 6)),
]  # fmt: skip


def by_differences(e: EquationsOfMotion) -> int:
    """n less the rank of the holonomic rows' slopes, by central differences, at a state met by a walk."""
    met = walk(build_states(e.model), e.rows)
    state = met.far[-1]
    residuals = [row.residual for row in e.rows]
    h = 1e-6
    columns = []
    for x in e.q:
        ahead = evaluate(residuals, {**state, x: state[x] + h})
        back = evaluate(residuals, {**state, x: state[x] - h})
        columns.append([(a - c) / (2.0 * h) for a, c in zip(ahead, back)])
    sizes = np.linalg.svd(np.array(columns).T, compute_uv=False)
    assert np.max(np.abs(evaluate(residuals, state))) < 1e-10
    return len(e.q) - int(np.sum(sizes > 1e-6))  # central differences err by about 1e-10


@pytest.mark.sample(0, 6)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_mobility_of_loops(kind: int, seed: int) -> None:
    b, truth = KINDS[kind](random.Random(f"{kind} {seed}"))
    e = derive(b.model())
    states = build_states(e.model)
    found = mobility(states, e.rows, walk(states, e.rows))
    assert len(e.v) - found.rank == truth
    assert len(found.spare) == len(e.rows) - found.rank
    assert by_differences(e) == truth


@pytest.mark.full
@pytest.mark.parametrize("kind", [0, 2, 4, 5, 6, 7])
def test_mobility_is_told(kind: int) -> None:
    b, truth = KINDS[kind](random.Random(kind))
    a = analyse(derive(b.model()))
    assert a.degrees_of_freedom == a.positional_freedom == truth
    assert len(a.redundant) == a.rows - (a.speeds - truth)


@pytest.mark.full
def test_what_is_redundant_where_the_loop_is_closed_only_seems_so() -> None:
    for made in (bennett, cranks):
        b, _ = made(random.Random(5))
        seems = analyse(derive(b.model())).seems
        assert seems.degrees_of_freedom and seems.redundant
    for made in (frames, sarrus):  # two parallel hinges turn about two directions wherever they are
        b, _ = made(random.Random(5))
        seems = analyse(derive(b.model())).seems
        assert not seems.degrees_of_freedom and not seems.redundant


def parallelogram_flat() -> Analysis:
    b = Builder()
    g = b.graph
    one, two, three = (b.coordinate(f"q{k}", 0.0, unit="rad") for k in range(3))
    length, base = b.parameter("l", 1.0), b.parameter("b", 2.0)
    for k, angle in enumerate((one, two, three)):
        b.particle(f"p{k}", g.one, (length * g.cos(angle), length * g.sin(angle), 0.0))
    x = length * g.cos(one) + base * g.cos(two) - base - length * g.cos(three)
    y = length * g.sin(one) + base * g.sin(two) - length * g.sin(three)
    b.constraint("loop", x, y)
    return analyse(derive(b.model()))


def test_a_configuration_that_adds_a_freedom_is_told() -> None:
    """The flat parallelogram may fold either way; each way has one degree of freedom."""
    a = parallelogram_flat()
    assert (a.degrees_of_freedom, a.more_at_start, a.redundant) == (1, 1, ())


@pytest.mark.full
@pytest.mark.parametrize("rolls", [False, True])
def test_velocity_rows_beside_a_loop_with_redundant_rows(rolls: bool) -> None:
    """A disc that rolls at the end of a Bennett linkage's joint adds a coordinate and a relation; one that
    is pushed along as dz = y dx adds three coordinates, a row and no relation."""
    b, _ = bennett(random.Random(3))
    g = b.graph
    joint = g.symbol("coordinate", "q0")
    spin = b.coordinate("spin", 0.0, unit="rad")
    b.lagrangian("disc", 0.5 * b.der(spin) ** 2, is_kinetic=True)
    if rolls:
        b.constraint("roll", b.der(spin) - 2.0 * b.der(joint))
    else:
        x, y = b.coordinate("x"), b.coordinate("y")
        b.lagrangian("cart", 0.5 * (b.der(x) ** 2 + b.der(y) ** 2), is_kinetic=True)
        b.constraint("roll", b.der(x) - y * b.der(spin) - b.der(joint))
    a = analyse(derive(b.model()))
    assert len(a.redundant) == 3
    assert (a.degrees_of_freedom, a.positional_freedom) == ((1, 1) if rolls else (3, 4))


@pytest.mark.parametrize("scale", [1e-15, 1e15])
def test_mobility_at_any_size(scale: float) -> None:
    b = Builder()
    g = b.graph
    start = b.parameter("l", scale)
    x, y = b.coordinate("x", 0.6 * scale, unit="m"), b.coordinate("y", 0.8 * scale, unit="m")
    turn = b.coordinate("turn", 0.0, unit="rad")
    frame = b.rotate("plate", b.world, "z", turn)
    b.solid("s", g.one, (0.1 * scale**2,) * 3, frame, (x, y, 0.0))
    for k, (px, py) in enumerate([(0.3, 0.1), (-0.5, 0.4), (0.2, -0.9), (0.8, 0.7)]):
        px, py = scale * px, scale * py
        hx = x + px * g.cos(turn) - py * g.sin(turn) - px
        hy = y + px * g.sin(turn) + py * g.cos(turn) - py
        b.constraint(f"crank{k}", hx * hx + hy * hy - start**2)
    a = analyse(derive(b.model()))
    assert (a.degrees_of_freedom, a.redundant) == (1, ("crank2", "crank3"))


def test_what_is_held_to_second_order_is_held() -> None:
    """Two rods in line: the point between them may move sideways to first order only."""
    b = Builder()
    x, y = b.coordinate("x", 0.0), b.coordinate("y", 0.3)
    b.particle("p", b.graph.one, (x, y, 0.0))
    b.constraint("left", (x + 1.0) ** 2 + (y - 0.3) ** 2 - 1.0)
    b.constraint("right", (x - 1.0) ** 2 + (y - 0.3) ** 2 - 1.0)
    a = analyse(derive(b.model()))
    assert (a.degrees_of_freedom, a.more_at_start) == (0, 1)


@pytest.mark.sample(3)
@pytest.mark.parametrize("at_start", [True, False])
@pytest.mark.parametrize("touching", [1, 2, 3])
@pytest.mark.parametrize("seed", range(3))
def test_surfaces_that_touch_leave_what_both_allow(seed: int, touching: int, at_start: bool) -> None:
    """w = 0 and 3 w = c1 y1^2 + ... in turned coordinates, all c > 0: every y is zero as well, though
    the rank is two at most.  The others are free."""
    rng = random.Random(f"{seed} {touching}")
    n = touching + 1 + rng.randint(0, 2)
    turned, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(n, n)))
    b = Builder()
    offset = [0.0] * n if at_start else [rng.uniform(-0.2, 0.2) for _ in range(n)]
    x = [b.coordinate(f"x{k}", s) for k, s in enumerate(offset)]
    b.lagrangian("kinetic", b.graph.sum(0.5 * b.der(y) ** 2 for y in x), is_kinetic=True)
    w, *y = [b.graph.sum(float(c) * z for c, z in zip(row, x)) for row in turned[: touching + 1]]
    b.constraint("plane", w)
    b.constraint("cup", 3.0 * w - b.graph.sum(rng.uniform(0.5, 2.0) * z**2 for z in y))
    a = analyse(derive(b.model()))
    assert a.degrees_of_freedom == a.positional_freedom == n - 1 - touching
    assert a.seems.degrees_of_freedom and a.seems.positional_freedom
    assert a.more_at_start >= touching - 1


@pytest.mark.parametrize("speeds", [0, 1])
def test_velocity_rows_beside_surfaces_that_touch(speeds: int) -> None:
    b = Builder()
    x, y, z, u, v = (b.coordinate(k, s) for k, s in zip("xyzuv", (0.0, 0.0, 1.0, 0.3, 0.2)))
    b.lagrangian("kinetic", b.graph.sum(0.5 * b.der(k) ** 2 for k in (x, y, z, u, v)), is_kinetic=True)
    b.constraint("ball", x * x + y * y + z * z - 1.0)
    b.constraint("plane", z - 1.0)
    if speeds:
        b.constraint("knife", b.der(u) - (1.0 + v * v) * b.der(v))
    a = analyse(derive(b.model()))
    assert a.degrees_of_freedom == a.positional_freedom == 2 - speeds


@pytest.mark.parametrize(("way", "held"), [("norm", 2), ("norm", 3), ("squares", 1), ("squares", 2)])
def test_a_radius_of_zero_holds_all_that_it_holds(way: str, held: int) -> None:
    """Where such a row comes to be counted: no gradient tells, and `derive` refuses it."""
    b = Builder()
    rng = random.Random(f"{way} {held}")
    x = [b.coordinate(f"x{k}", rng.uniform(-0.5, 0.5)) for k in range(4)]
    b.lagrangian("kinetic", b.graph.sum(0.5 * b.der(y) ** 2 for y in x), is_kinetic=True)
    r, square = b.parameter("r", 0.0), b.graph.sum(y**2 for y in x[:held])
    b.constraint("ball", b.graph.sqrt(square) - r if way == "norm" else square - r**2)
    states = build_states(b.model())
    rows = [x.row for x in classify(states)]
    found = mobility(states, rows, walk(states, rows))
    assert (found.rank, found.proved) == (held, False)


def test_freedom_is_never_less_than_none() -> None:
    """More rows than speeds that all but agree, so that no state is found."""
    b = Builder()
    x, y = b.coordinate("x", 0.3), b.coordinate("y", 0.7)
    b.particle("p", b.graph.one, (x, y, 0.0))
    for k in range(4):
        b.constraint(f"r{k}", (x - 1e-9 * k) ** 2 + (1.0 + 1e-9 * k) * y**2 - 1.0)
    states = build_states(b.model())
    rows = [c.row for c in classify(states)]
    assert 0 <= mobility(states, rows, walk(states, rows)).rank <= 2


@pytest.mark.sample(6)
@pytest.mark.parametrize("how", ["numbers", "parameters", "sums", "rates"])
@pytest.mark.parametrize("seed", range(6))
def test_rows_that_agree_in_all_but_the_last_digits_are_told_apart(seed: int, how: str) -> None:
    """Random combinations of random rows, some of them with a last digit (of 8 to 15) that differs;
    the truth by elimination of the decimals as they are written."""
    rng = random.Random(f"{seed} {how}")
    b = Builder()
    g = b.graph
    x = [b.coordinate(f"x{k}", 0.0) for k in range(4)]
    b.lagrangian("kinetic", g.sum(0.5 * b.der(y) ** 2 for y in x), is_kinetic=True)
    table = [[Fraction(rng.randint(11, 99), 10) for _ in x] for _ in range(rng.randint(1, 2))]
    for _ in range(2):
        factors = [rng.randint(1, 3) for _ in table]
        row = [sum(f * y for f, y in zip(factors, column)) for column in zip(*table)]
        table.append([Fraction(y) for y in row])
    entries: list[list[Node]] = [[] for _ in table]
    for k, row in enumerate(table):
        last = Fraction(1, 10 ** rng.randint(7, 13)) if rng.random() < 0.5 and k else Fraction(0)
        for j, whole in enumerate(row):
            end = last if j == 1 else Fraction(0)
            name = f"c{k}{j}"
            if how == "sums":
                entry = b.parameter(name, float(whole)) + b.parameter(f"d{k}{j}", float(end))
            else:
                value = float(whole + end)
                assert Fraction(repr(value)) == whole + end
                entry = b.parameter(name, value) if how == "parameters" else g.const(value)
            entries[k].append(entry)
            row[j] = whole + end
        moving = [b.der(y) for y in x] if how == "rates" else x
        b.constraint(f"r{k}", g.sum(c * y for c, y in zip(entries[k], moving)))
    states = build_states(b.model())
    rows = [c.row for c in classify(states)]
    found = mobility(states, rows, walk(states, rows))
    kept = independent(table)
    assert found.proved and found.rank == len(kept)
    assert found.spare == frozenset(range(len(rows))) - kept
    assert found.unseen <= kept


def independent(table: Sequence[Sequence[Fraction]]) -> frozenset[int]:
    """The first rows that span all."""
    kept: dict[int, list[Fraction]] = {}
    found = set()
    for k, row in enumerate(table):
        rest = list(row)
        for pivot, base in kept.items():
            rest = [a - rest[pivot] / base[pivot] * c for a, c in zip(rest, base)]
        if any(rest):
            kept[next(j for j, c in enumerate(rest) if c)] = rest
            found.add(k)
    return frozenset(found)


def test_rows_that_agree_but_for_rounding_only_seem_to_depend() -> None:
    for other in (math.sqrt(2.0) * (1.0 + 2e-15), math.sqrt(2.0) + 1e-13):
        b = Builder()
        x, y = b.coordinate("x", 0.0), b.coordinate("y", 0.0)
        b.particle("p", b.graph.one, (x, y, 0.0))
        b.constraint("one", x + b.parameter("c", math.sqrt(2.0)) * y)
        b.constraint("two", x + b.parameter("d", other) * y)
        states = build_states(b.model())
        rows = [c.row for c in classify(states)]
        found = mobility(states, rows, walk(states, rows))
        assert (found.rank, found.spare, found.proved) == (1, frozenset({1}), False)
