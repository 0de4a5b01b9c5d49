"""Functions through points, against NumPy, SciPy and what can be worked out by hand."""

import random
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy
import pytest
from scipy.interpolate import CubicSpline, PPoly

import lagc
from lagc.diagnostics.faults import Refused
from lagc.reports.equations.write import write
from lagc.semantics.names.namespace import columns
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Graph
from lagc.symbolic.interpolants import interpolant
from lagc.symbolic.walk import evaluate
from tests.codegen.tools import bits

KINDS = ("held", "linear", "cubic")
SEED = 8


def points(rng: random.Random) -> tuple[list[float], list[float]]:
    """Between 2 and 40, of any scale; neighbours are at most a few hundred times as far apart as others."""
    count, scale, size = (
        rng.choice([2, 3, 4, 5, 9, 40]),
        10.0 ** rng.randint(-6, 6),
        10.0 ** rng.randint(-6, 6),
    )
    knots = [scale * rng.uniform(-5.0, 5.0)]
    for _ in range(count - 1):
        knots.append(knots[-1] + scale * rng.uniform(0.02, 2.0))
    values = [size * rng.choice([rng.uniform(-1.0, 1.0), rng.choice([0.0, 1.0])]) for _ in knots]
    return knots, values


def truth(
    kind: str, straight: bool, knots: list[float], values: list[float], x: float
) -> tuple[float, float]:
    """The value and the slope."""
    if kind == "cubic":
        spline = CubicSpline(knots, values)  # not a knot
        inside = min(max(x, knots[0]), knots[-1])
        slope = float(spline(inside, 1)) if inside == x or straight else 0.0
        return float(spline(inside)) + (x - inside) * slope, slope
    if kind == "held":
        return values[max(int(numpy.searchsorted(knots, x, "right")) - 1, 0)], 0.0
    place = min(max(int(numpy.searchsorted(knots, x, "right")) - 1, 0), len(knots) - 2)
    slope = (values[place + 1] - values[place]) / (knots[place + 1] - knots[place])
    if straight or knots[0] <= x < knots[-1]:
        return values[place] + slope * (x - knots[place]), slope
    return values[0 if x < knots[0] else -1], 0.0


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", KINDS)
def test_random_tables_are_what_numpy_and_scipy_make_of_their_points(kind: str) -> None:
    rng = random.Random(f"{kind} {SEED}")
    for _ in range(150):
        knots, values = points(rng)
        straight = rng.random() < 0.5 and kind != "held"
        graph = Graph()
        x = graph.symbol("time", "time")
        node = interpolant(x, knots, values, kind, straight, "u")
        slope = tangent(graph, [node], {x: graph.one})[0]
        span = knots[-1] - knots[0]
        asked = [*knots[1:-1], *(rng.uniform(knots[0] - span, knots[-1] + span) for _ in range(20))]
        found = [evaluate([node, slope], {x: at}) for at in asked]
        true = [truth(kind, straight, knots, values, at) for at in asked]
        # Two ways of the same sum: rounding of the largest value, over the shortest way for slopes.
        size = max(max(map(abs, values)), *(abs(value) for value, _ in true))
        least = min(b - a for a, b in pairwise(knots))
        for (value, rate), (own, wanted) in zip(found, true):
            assert value == pytest.approx(own, rel=1e-12, abs=1e-11 * size)
            assert rate == pytest.approx(wanted, rel=1e-10, abs=1e-10 * size / least)


def text(numbers: Sequence[float]) -> str:
    return "{" + ", ".join(map(repr, numbers)) + "}"


@pytest.mark.full
def test_compiled_tables_agree_bitwise_and_with_their_expressions() -> None:
    """Of time, of a coordinate and of a parameter, which is looked up once."""
    rng = random.Random(SEED)
    drawn, lines = [], []
    for k in range(30):
        knots, values = points(rng)
        kind, at = KINDS[k % 3], ("1[1/s]*time", "x/1[m]", "c")[k // 3 % 3]
        drawn.append((knots, values, kind, at))
        lines.append(f'output Real y{k} = table({at}, {text(knots)}, {text(values)}, "{kind}");')
    model = (
        "model M coordinate Length x; parameter Real c = 0.25; body b = Particle(mass = 1, at = {x, 0, 0});"
        f"force f = {{table(x, {{-1, 0, 1}}, {{1, 0, 2}} [N]), 0, 0}} at b; {' '.join(lines)} end M;"
    )
    one, other = (lagc.loads(model).compile(backend=backend) for backend in ("c", "numpy"))
    for _ in range(40):
        t, x, c = (10.0 ** rng.randint(-6, 6) * rng.uniform(-8.0, 8.0) for _ in range(3))
        bound = [system.bind({"c": c}).system for system in (one, other)]
        state = [x, rng.uniform(-1.0, 1.0)]
        ours, theirs = (system.outputs(t, [*state, 0.0]) for system in bound)
        assert bits(ours) == bits(theirs)
        for value, (knots, values, kind, at) in zip(ours, drawn):
            where = {"1[1/s]*time": t, "x/1[m]": x, "c": c}[at]
            true, slope = truth(kind, kind == "cubic", knots, values, where)
            size = max(map(abs, values)) + abs(true) + abs(slope) * (abs(where) + abs(knots[0]))
            assert value == pytest.approx(true, abs=1e-12 * size * len(knots))
    many = numpy.array([[0.1 * k - 2.0, 1.0, 0.0] for k in range(40)])
    space: dict[str, Any] = {"__name__": "made"}
    exec(next(iter(generated(model).values())), space)
    columns = space["rhs_many"](0.0, many[:, : space["NX"]])
    for state, row in zip(many, columns):
        assert row[1] == truth("linear", False, [-1.0, 0.0, 1.0], [1.0, 0.0, 2.0], state[0])[0]


def generated(model: str) -> dict[str, str]:
    from lagc.compiler.pipeline import program
    from lagc.compiler.stages import Choice, render
    from lagc.diagnostics.faults import Source

    return render(program(Source("made.lag", model), Choice()), "numpy")


# -- motion ------------------------------------------------------------------------------------


PUSHED = """model Pushed
  parameter Mass m = 2;
  coordinate Length x;
  body b = Particle(mass = m, at = {x, 0, 0});
  force f = {TABLE, 0, 0} at b;
end Pushed;"""


def pieces(kind: str, knots: list[float], values: list[float]) -> PPoly:
    slopes = numpy.diff(values) / numpy.diff(knots)
    if kind == "held":
        return PPoly([values[:-1]], knots)
    return CubicSpline(knots, values) if kind == "cubic" else PPoly([slopes, values[:-1]], knots)


@pytest.mark.full
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_force_through_points_moves_a_mass_as_its_integrals_say(kind: str, backend: str) -> None:
    rng = random.Random(f"{kind} {SEED}")
    for count in (2, 5, 12):
        knots = [0.0]
        for _ in range(count - 1):
            knots.append(knots[-1] + rng.uniform(0.2, 2.0))
        values = [rng.uniform(-3.0, 3.0) for _ in knots]
        table = f'table(time, {text(knots)}, {text(values)} [N], "{kind}")'
        system = lagc.loads(PUSHED.replace("TABLE", table)).compile(backend=backend)
        run = system.simulate(knots[-1], points=101, accuracy=1e-11)
        assert run.status == "ok"
        force = pieces(kind, knots, values)
        for name, true in (("x", force.antiderivative(2)), ("der(x)", force.antiderivative(1))):
            wanted = numpy.array([true(t) / 2.0 for t in run.t])
            assert numpy.max(numpy.abs(run[name] - wanted)) <= 1e-11 * numpy.max(abs(wanted))


DRIVEN = """model Driven
  parameter Mass m = 2;
  coordinate Length x, y(start = 1);
  body b = Particle(mass = m, at = {x, y, 0});
  constraint drive: x = TABLE;
  potential spring = 1/2*3[N/m]*y^2;
  output Force pull = reaction(drive);
end Driven;"""
PLACES = "{0, 0.4, 1, 1.5, 2}, {0, 0.3, 0.1, -0.2, 0.1}"


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_row_that_is_driven_by_a_table_needs_the_force_of_its_second_derivative(backend: str) -> None:
    table = f'table(time, {PLACES} [m], "cubic")'
    system = lagc.loads(DRIVEN.replace("TABLE", table)).compile(backend=backend)
    run = system.simulate(2.0, accuracy=1e-10)
    spline = CubicSpline([0.0, 0.4, 1.0, 1.5, 2.0], [0.0, 0.3, 0.1, -0.2, 0.1])
    assert run.status == "ok"
    assert run["x"] == pytest.approx(spline(run.t), abs=1e-12)
    assert run["pull"] == pytest.approx(2.0 * spline(run.t, 2), abs=1e-10)
    assert run["y"] == pytest.approx(numpy.cos(1.5**0.5 * run.t), abs=1e-10)


@pytest.mark.parametrize(
    "table, kind",
    [
        (f'table(time, {PLACES} [m], "held")', "jump"),
        (f"table(time, {PLACES} [m])", "kink"),
        (f'table(time, {PLACES} [m], "cubic", extrapolation = "hold")', "kink"),
        (f'table(x, {PLACES} [m], "linear")', "kink"),
    ],
)
def test_rows_and_places_that_follow_tables_that_bend_are_warned_of(table: str, kind: str) -> None:
    body = "body b = Particle(mass = 1, at = {x, 1[m]*TABLE/1[m], 0});"
    moving = f"model A coordinate Length x(rate = 1); {body} end A;"
    for model, code in ((DRIVEN, "LAG0421"), (moving, "LAG0422")):
        found = lagc.loads(model.replace("TABLE", table)).check()
        assert [fault.code for fault in found] == [code]
        assert f"has a {kind}" in found[0].message and "knot of a table" in found[0].message


@pytest.mark.full
def test_one_bend_among_many_knots_is_found() -> None:
    rng = random.Random(SEED)
    for _ in range(10):
        bend, count = rng.randrange(20, 380), 400
        values = [0.0 if k <= bend else float(k - bend) for k in range(count)]
        knots = [0.25 * k for k in range(count)]
        line = f'table(time, {text(knots)}, {text(values)} [m], "linear", extrapolation = "line")'
        (found,) = lagc.loads(DRIVEN.replace("TABLE", line)).check()
        assert found.code == "LAG0421"
        straight = line.replace(text(values), text([2.0 * knot for knot in knots]))
        assert not lagc.loads(DRIVEN.replace("TABLE", straight)).check()
        smooth = f"1[m]*({line}/1[m])^2"  # its slope is zero where that of the table jumps
        assert not lagc.loads(DRIVEN.replace("TABLE", smooth)).check()


# -- files -------------------------------------------------------------------------------------


def model_of(folder: Path, table: str, kind: str = "Force") -> lagc.ModelFile:
    path = folder / "model.lag"
    path.write_text(
        "model M coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0});"
        f"output {kind} u = {table}; end M;"
    )
    return lagc.load(str(path))


def asked(folder: Path, table: str, times: Sequence[float] = (0.0, 0.5, 1.5, 9.0)) -> list[float]:
    system = model_of(folder, table).compile(backend="numpy").system
    return [system.outputs(t, [0.0, 0.0, 0.0])[0] for t in times]


@pytest.mark.parametrize(
    "content, table",
    [
        ("time,u\n0,1\n1,3\n2,-1\n", 'table(time, "d.csv", "u")'),
        ("time,u\n0,1\n1,3\n2,-1\n", 'table(time, "d.csv")'),
        ("\ufefftime [s],u [N]\r\n0,1\r\n1,3\r\n2,-1\r\n\r\n", 'table(time, "d.csv", "u")'),
        ("t [ms] , u [kN]\n 0 , 1e-3\n 1e3, +.003\n2000,-0.001\n", 'table(time, "d.csv", "u")'),
        ('"a, b",u,note [furlong],time\n9,1,x,0\n9,3,,1\nnan,-1,"a ""b""",2\n',
         'table(time, "d.csv", "u", over = "time")'),
        ("u,time\n1,0\n3,1\n-1,2", 'table(time, "d.csv", values = "u", over = "time")'),
        ("t [h],u [mN]\n0,1000\n2.77777777777777777e-4,3000\n5.5555555555555555e-4,-1000\n",
         '1*table(time, "d.csv")'),
    ],
)  # fmt: skip
def test_a_column_of_a_file_is_a_table(content: str, table: str, tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text(content, newline="")
    assert asked(tmp_path, table) == pytest.approx([1.0, 2.0, 1.0, -1.0], rel=1e-14)


def test_the_remedy_for_columns_without_a_unit_is_one_in_the_header(tmp_path: Path) -> None:
    (tmp_path / "m.lag").write_text(
        "model M coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0});\n"
        'force f = {table(time, "d.csv", "u1") - table(time, "d.csv", "v"), 0, 0} at b; end M;'
    )
    (tmp_path / "d.csv").write_text("t,u1,v\n0,1,2\n1,2,3\n")
    with pytest.raises(Refused) as refused:
        lagc.load(str(tmp_path / "m.lag")).compile().simulate(1.0)
    remedy = refused.value.faults[0].remedy
    assert remedy == "write the unit of each column in the first line of the file: `u [N]`"
    (tmp_path / "d.csv").write_text("t,u1 [N],v [N]\n0,1,2\n1,2,3\n")
    assert lagc.load(str(tmp_path / "m.lag")).compile().simulate(1.0).status == "ok"


def test_what_a_run_writes_is_a_table_with_its_units(tmp_path: Path) -> None:
    from lagc.simulation.formats import save

    run = lagc.load("simple_pendulum").compile(backend="numpy").simulate(1.0, points=21)
    save(run, str(tmp_path / "d.csv"), units=True)
    system = model_of(tmp_path, 'table(time, "d.csv", "theta", "cubic")', "Angle").compile(backend="numpy")
    assert [system.system.outputs(t, [0.0] * 3)[0] for t in run.t] == list(run["theta"])


@pytest.mark.full
@pytest.mark.parametrize("units", [True, False])
def test_each_column_that_a_run_writes_is_found(units: bool, tmp_path: Path) -> None:
    """Arrays, rates, rotations and sensitivities too."""
    from lagc.simulation.formats import save

    model = lagc.loads(
        """model M parameter Stiffness k[2, 1] = {{1}, {2}}; coordinate Length x[2](each start = 0.1);
        coordinate Orientation o(rate = {1, 2, 3}); frame B = rotate(world, o);
        body s = Solid(mass = 1, inertia = {1, 1, 1}, frame = B, com = {x[1], x[2], 0});
        force f = {-k[1, 1]*x[1], -k[2, 1]*x[2], 0} at s;
        output Force K[1, 2] = {{k[1, 1]*x[1], 0}}; end M;"""
    )
    run = model.compile(backend="numpy").simulate(0.5, points=3, sensitivity=["k[2,1]", "start(x[1])"])
    save(run, str(tmp_path / "d.csv"), units)
    assert {"x[1]", "der(x[2])", "K[1,2]", "d(x[1])/d(k[2,1])", "o.rate.x"} <= set(run.columns)
    for name in run.columns:
        kind = f"Real[{run.units[name]}]" if units and run.units[name] else "Real"
        found = model_of(tmp_path, f'table(time, "d.csv", "{name}")', kind).compile(backend="numpy").system
        assert [found.outputs(t, [0.0] * 3)[0] for t in run.t] == list(run[name]), name


@pytest.mark.parametrize(
    "head, name, unit",
    [
        ("u[N]", "u", "N"),
        ("u [1]", "u", "1"),
        ("u [m ]", "u", "m "),
        ("K[ 1, 2 ] [N/m]", "K[ 1, 2 ]", "N/m"),
        ("u]", "u]", None),
    ],
)
def test_an_index_stands_right_behind_a_name(head: str, name: str, unit: str | None) -> None:
    assert columns(f'"{head}"\n1\n').heads == [(name, unit)]


@pytest.mark.parametrize(
    "content, table, code, said",
    [
        (None, '"d.csv", "u"', "LAG0226", "No such file"),
        (b"", '"d.csv", "u"', "LAG0314", "is empty"),
        (b"\n\n", '"d.csv", "u"', "LAG0314", "is empty"),
        (b"time,u\n", '"d.csv", "u"', "LAG0314", "at least two rows; this has 0"),
        (b"time,u\n0,1\n", '"d.csv", "u"', "LAG0314", "at least two rows; this has 1"),
        (b"0,1\n1,2\n", '"d.csv", "u"', "LAG0314", "no column names"),
        (b"time,u\n0,1\n1\n", '"d.csv", "u"', "LAG0314", "2 columns, but 1 values in line 3"),
        (b"time,u\n0,1\n\n1,2\n", '"d.csv", "u"', "LAG0314", "2 columns, but 0 values in line 3"),
        (b"time,u\n0,1\n1,2,\n", '"d.csv", "u"', "LAG0314", "2 columns, but 3 values in line 3"),
        (b"time,u\n0,1\n1,nan\n", '"d.csv", "u"', "LAG0314", "in line 3: `nan` is not a finite number"),
        (b"time,u\n0,1\n1,1e999\n", '"d.csv", "u"', "LAG0314", "in line 3: `1e999`"),
        (b"time,u\n0,1\n1,1_0\n", '"d.csv", "u"', "LAG0314", "in line 3: `1_0`"),
        ("time,u\n0,1\n1,\u0661\n".encode(), '"d.csv", "u"', "LAG0314", "in line 3"),
        (b"time,u\n0,1\n1,\n", '"d.csv", "u"', "LAG0314", "in line 3: the cell is empty"),
        (b"time;u\n0;1\n1;2\n", '"d.csv", "u"', "LAG0314", "no column `u`"),
        (b"time,u\n0,1\n1,2\n", '"d.csv", "v"', "LAG0314", "no column `v`"),
        (b"time,u\n0,1\n1,2\n", '"d.csv", "u", over = "t"', "LAG0314", "no column `t`"),
        (b"time,u,u\n0,1,1\n1,2,2\n", '"d.csv", "u"', "LAG0314", "two columns called `u`"),
        (b"time,u,v\n0,1,1\n1,2,2\n", '"d.csv"', "LAG0210", "`time`, `u`, `v`"),
        (b"time,u\n0,1\n0,2\n", '"d.csv", "u"', "LAG0314", "line 3 of the file has 0 again"),
        (b"time,u\n0,1\n2,2\n1,2\n", '"d.csv", "u"', "LAG0314", "line 4 of the file has 1 after 2"),
        (b'"time",u\n0,"1\n"\n2,2\n1,2\n', '"d.csv", "u"', "LAG0314", "line 5 of the file has 1"),
        (b"time,u [m]\n0,1\n1,2\n", '"d.csv", "u"', "LAG0302", "Length"),
        (b"time,u [rad]\n0,1\n1,2\n", '"d.csv", "u"', "LAG0302", "a number"),
        (b"time [m],u\n0,1\n1,2\n", '"d.csv", "u"', "LAG0301", "the table has the argument Length [m]"),
        (b"time,u [Newton]\n0,1\n1,2\n", '"d.csv", "u"', "LAG0304", "Newton"),
        (b"time,u\n0,1\n1,2\xff\n", '"d.csv", "u"', "LAG0226", "not UTF-8"),
        (b'time,u\n0,1\n1,"2\n', '"d.csv", "u"', "LAG0314", "comma-separated"),
        (b"time,u\n0,1\n1,2\x00\n", '"d.csv", "u"', "LAG0314", ""),
    ],
)
def test_data_that_make_no_table(
    content: bytes | None, table: str, code: str, said: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "d.csv").write_bytes(content)
    (found,) = model_of(tmp_path, f"table(time, {table})").check()
    assert found.code == code and said in found.message and found.span is not None


def test_files_are_regular_not_too_large_and_beside_the_model(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "d.csv").write_text("time,u\n0,1\n1,2\n")
    (inner / "link.csv").symlink_to(tmp_path / "d.csv")
    (inner / "folder.csv").mkdir()
    for name, code in (
        ("../d.csv", "LAG0217"), (str(tmp_path / "d.csv"), "LAG0217"), ("link.csv", "LAG0217"),
        ("folder.csv", "LAG0226"), ("/dev/zero", "LAG0217"),
    ):  # fmt: skip
        (found,) = model_of(inner, f'table(time, "{name}", "u")').check()
        assert found.code == code, name
    monkeypatch.setattr("lagc.semantics.names.namespace.LARGEST_DATA", 10)
    (found,) = model_of(tmp_path, 'table(time, "d.csv", "u")').check()
    assert found.code == "LAG0226" and "larger" in found.message
    monkeypatch.setattr("lagc.semantics.names.namespace.LARGEST_DATA", 1000)
    monkeypatch.setattr("lagc.semantics.names.namespace.MOST_ROWS", 1)
    (found,) = model_of(tmp_path, 'table(time, "d.csv", "u")').check()
    assert found.code == "LAG0314" and "more than 1 rows" in found.message


@pytest.mark.usefixtures("own_cache")
def test_a_file_that_changes_is_read_again(tmp_path: Path) -> None:
    for last in (2.0, 3.0, 2.0):
        (tmp_path / "d.csv").write_text(f"time,u\n0,1\n1,{last}\n")
        assert asked(tmp_path, 'table(time, "d.csv", "u")', [1.0]) == [last]
    (tmp_path / "d.csv").unlink()
    with pytest.raises(Refused):
        asked(tmp_path, 'table(time, "d.csv", "u")', [1.0])


# -- what people see ---------------------------------------------------------------------------


def test_equations_name_tables_and_their_slopes() -> None:
    model = """model M
      coordinate Length x, y;
      body b = Particle(mass = 1, at = {x, y + TABLE, 0});
      force f = {table(time, {0, 1}, {2, 3} [N]) + table(x, {0, 1}, {2, 3} [N]), 0, 0} at b;
    end M;"""
    table = 'table(x, {0, 1, 2, 3, 4}, {0, 1, 0, 2, 5} [m], "cubic")'
    equations = lagc.loads(model.replace("TABLE", table)).compile().equations
    written = write(equations)
    assert "table_2(x)" in written and "table'(x)" in written and "table''(x)" in written
    assert not any(word in written for word in ("table'''", "knots", "entry"))
    assert r"\mathit{table}''\left(x\right)" in write(equations, "latex")
    made: dict[str, Any] = {}
    exec(write(equations, "sympy"), made)
    assert "table''(x(t))" in str(made["equations"])


def test_tables_are_called_as_their_columns(tmp_path: Path) -> None:
    (tmp_path / "d.csv").write_text("time,a,b,c\x1b[31m %}\n0,1,1,3\n1,2,2,4\n")
    (tmp_path / "e.csv").write_text("time,a\n0,5\n1,7\n")
    model = """model M coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0});
      force f = {FORCE, 0, 0} at b; end M;"""
    (tmp_path / "model.lag").write_text(
        model.replace("FORCE", " + ".join(f"1[N]*({i} + table(time, {table}))^2" for i, table in enumerate((
            '"d.csv", "a"', '"d.csv", "b"', '"e.csv"', '"d.csv", "c\x1b[31m %}"', '"d.csv", "a", "cubic"',
            "{0, 1}, {1, 4}",
        ))))
    )  # fmt: skip
    written = write(lagc.load(str(tmp_path / "model.lag")).compile().equations)
    # The same numbers are one table.
    assert all(f"{name}(t)" in written for name in ("a", "a_2", "c_31m", "a_3", "table"))
    assert "b(t)" not in written and "\x1b" not in written
