"""What compiling costs grows with the model, no faster, where nothing couples its parts.

Work is counted, not timed: calls of functions, and elements that lists are extended by.
"""

import difflib
import gc
import sys
import tracemalloc
import weakref
from collections.abc import Callable, Collection
from random import Random
from types import FrameType
from typing import Any

import pytest

from lagc.compiler import checking, pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.diagnostics.suggest import NEAREST
from lagc.lowering.scalar.common_factors import factored, plan
from lagc.semantics.context import MOST_FAULTS
from lagc.semantics.instantiate import Builder
from lagc.simulation.initialization.dry_run import try_start
from lagc.symbolic.graph import Graph, Node
from lagc.syntax.formatter import format_source

POINT = """  parameter Mass m = 1 [kg];
  parameter Length L = 1 [m];
  parameter Energy E = 1 [J];
  coordinate Length x(start = 1), y;
  body b = Particle(mass = m, at = {x, y, 0});
"""


def model(lines: Callable[[int], str], n: int, first: str = POINT, last: str = "") -> str:
    return f"model M\n{first}" + "".join(lines(k) for k in range(n)) + last + "end M;\n"


def parameters(n: int) -> str:
    return model(lambda k: f"  parameter Real p{k} = {k};\n", n)


def constants(n: int) -> str:
    first = f"{POINT}  constant Real c0 = 1;\n"
    return model(lambda k: f"  constant Real c{k + 1} = c{k} + 1/{k + 1};\n", n, first)


def outputs(n: int) -> str:
    return model(lambda k: f"  output Length o{k} = {k}*x + y;\n", n)


def effects(n: int) -> str:
    used = ", ".join(f"e{k}" for k in range(n))
    return model(
        lambda k: f"  effect e{k}\n    force f{k} = {{{k} [N], 0, 0}} at b;\n  end e{k};\n", n,
        last=f"  scene s uses {used};\n",
    )  # fmt: skip


def scenes(n: int) -> str:
    one = POINT + "  effect g\n    Gravity field;\n  end g;\n"
    return model(lambda k: f"  scene s{k} uses g\n    start x = {k} [m];\n  end s{k};\n", n, one)


def a_sum(n: int) -> str:
    terms = " + ".join(f"sin({k + 1}*x/L)" for k in range(n))
    return model(lambda _: "", 0, last=f"  potential V = E*({terms});\n")


def a_product(n: int) -> str:
    factors = "*".join(f"(1 + x/L/{k + 2})" for k in range(n))
    return model(lambda _: "", 0, last=f"  potential V = E*{factors};\n")


def quotients(n: int) -> str:
    terms = " + ".join(f"{j + 1}*x/(y + {k + 1}*L)" for k in range(n) for j in range(3))
    return model(lambda _: "", 0, last=f"  potential V = E*({terms});\n")


def unknown_names(n: int) -> str:
    return model(lambda k: f"  output Length o{k} = {k}*quantity{k};\n", n)


def coordinates(n: int) -> str:
    return model(
        lambda k: f"  coordinate Length x{k}(start = 1);\n"
        f"  body b{k} = Particle(mass = m, at = {{x{k}, 0, 0}});\n", n, "  parameter Mass m = 1 [kg];\n",
    )  # fmt: skip


def instances(n: int) -> str:
    ball = (
        "model Ball\n  coordinate Length x(start = 1);\n  body b = Particle(mass = 3 [kg], at = {x, 0, 0});\n"
        "  potential V = 1/2*(1 [N/m])*x^2;\nend Ball;\n"
    )
    return f"{ball}model M\n  Ball a[{n}];\nend M;\n"


def ladder(n: int) -> str:
    """Two chains, and how far they are apart: n^2 derivatives, as this depends on all links before."""
    link = "point {0}[i] = {0}[i-1] + {{sin({1}[i]), 0, cos({1}[i])}}*(1 [m]);"
    body = "body b{0}[i] = Particle(mass = 1 [kg], at = {0}[i]);"
    sides = "\n    ".join(text.format(*names) for names in ("Pu", "Qw") for text in (link, body))
    return f"""model M
  coordinate Angle u[{n}], w[{n}];
  point P[0] = {{0, 0, 0}};
  point Q[0] = {{1, 0, 0}};
  for i in 1:{n} loop
    {sides}
    body slide[i] = Particle(mass = 1 [kg], at = norm(P[i] - Q[i])*world.x);
  end for;
end M;
"""


def roots(n: int) -> str:
    """A body at a sum of roots that touch zero smoothly, each of one of n coordinates."""
    declared = "".join(f"  coordinate Angle a{k}(start = 1);\n" for k in range(n))
    place = " + ".join(f"sqrt({k + 2}*sin(a{k})^4 + sin(a{k})^6)" for k in range(n))
    return (
        f"model M\n{declared}  body b = Particle(mass = 3 [kg], at = {{({place})*(1 [m]), 0, 0}});\nend M;\n"
    )


def circles(n: int) -> str:
    """Parts on circles that there are not: Newton's method goes on for long."""
    part = """model Part
  coordinate Length x(start = 1), y;
  body b = Particle(mass = 3 [kg], at = {x, y, 0});
  constraint c: x^2 + y^2 = -1 [m2];
end Part;
"""
    return f"{part}model M\n  Part a[{n}];\nend M;\n"


def derived(text: str) -> None:
    pipeline.derive(pipeline.resolve(pipeline.parse(Source("m.lag", text)), Choice()))


def through(text: str) -> None:
    source = Source("m.lag", text)
    equations = pipeline.derive(pipeline.resolve(pipeline.parse(source), Choice()))
    program = pipeline.optimize(equations, work=True)
    pipeline.render(program, "c")
    pipeline.render(program, "numpy")


def formatted(text: str) -> None:
    format_source(Source("m.lag", text))


def checked(text: str) -> None:
    checking.check(Source("m.lag", text), Choice())


def work(job: Callable[[Any], Any], text: Any) -> int:
    """Calls, and elements that lists are extended by."""
    count, before = 0, 0

    def look(frame: FrameType, event: str, called: Any) -> None:
        nonlocal count, before
        count += event in ("call", "c_call")
        if event[0] == "c" and getattr(called, "__name__", "") == "extend" and type(called.__self__) is list:
            if event == "c_call":
                before = len(called.__self__)
            elif event == "c_return":
                count += len(called.__self__) - before

    sys.setprofile(look)
    try:
        job(text)
    finally:
        sys.setprofile(None)
    return count


CASES = [
    (through, parameters, 100), (through, constants, 50), (through, outputs, 50), (through, effects, 50),
    (through, a_sum, 40), (through, a_product, 20), (formatted, parameters, 100),
    (through, quotients, 12), (checked, scenes, 6), (derived, roots, 4), (derived, circles, 4),
]  # fmt: skip


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(("job", "make", "n"), CASES, ids=[f"{c[1].__name__}-{c[0].__name__}" for c in CASES])
def test_work_grows_with_the_model(job: Callable[[str], None], make: Callable[[int], str], n: int) -> None:
    job(make(n))  # what is loaded, and written for many objects, once
    one, two, four = (work(job, make(k * n)) for k in (1, 2, 4))
    most = 2.6 if make is a_product else 2.25  # twice as much, where it is linear
    assert four - two < most * (two - one)


@pytest.mark.full
def test_breaks_are_looked_for_in_the_pieces_of_a_model() -> None:
    """Twice as long a ladder has four times the pieces; to evaluate rungs whole is 7 times the work."""
    derived(ladder(2))
    one, two, four = (work(derived, ladder(k * 6)) for k in (1, 2, 4))
    assert four - two < 4.4 * (two - one)


def circled(n: int, radius: int) -> str:
    """Parts on circles of a radius in m, at 1 m from the centre."""
    start = "x(start = 0.6), y(start = 0.8)"
    return circles(n).replace("-1 [m2]", f"{radius**2} [m2]").replace("x(start = 1), y", start)


def steps_of_start(text: str) -> int:
    """Lines that kernels run through when the start is tried."""
    model = pipeline.resolve(pipeline.parse(Source("m.lag", text)), Choice())
    program = pipeline.optimize(pipeline.derive(model), work=True)
    count = 0

    def look(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal count
        count += event == "line"
        return look if frame.f_code.co_filename.endswith(("evaluation", "search.py")) else None

    sys.settrace(look)
    try:
        try_start(program, [p.value or 0.0 for p in program.interface.parameters])
    finally:
        sys.settrace(None)
    return count


@pytest.mark.full
@pytest.mark.parametrize("radius", [1, 2], ids=["met", "moved"])
def test_starts_of_parts_that_share_nothing_cost_the_sum_of_theirs(radius: int) -> None:
    """But for a look at each pair of rows; a dense factorisation takes 8 times as much for twice the rows."""
    steps_of_start(circled(2, radius))
    one, two, four = (steps_of_start(circled(n, radius)) for n in (6, 12, 24))
    assert four - two < 4.5 * (two - one)


def rods(n: int) -> str:
    """A chain of points in absolute coordinates, each 0.301 m from the one before, guessed at 0.3 m."""
    return f"""\
model Rods
  coordinate Length x[{n}], z[{n}];
  point P[0] = {{0, 0, 0}};
  for i in 1:{n} loop
    point P[i] = {{0.18 [m]*i + x[i], 0, -0.24 [m]*i + z[i]}};
    body bob[i] = Particle(mass = 1, at = P[i]);
    constraint rod[i]: norm(P[i] - P[i-1]) = 0.301 [m];
  end for;
end Rods;
"""


@pytest.mark.full
def test_the_start_of_a_chain_costs_what_its_rods_do() -> None:
    """Rows overlap with those beside them alone, in whatever order coordinates were declared."""
    steps_of_start(rods(3))
    one, two, four = (steps_of_start(rods(n)) for n in (16, 32, 64))
    assert four - two < 2.5 * (two - one)


def in_pairs(n: int) -> tuple[Graph, list[Node]]:
    """A sum in which every two of 2n terms share a factor of their own."""
    g = Graph()
    a, b, c = ([g.symbol(kind, str(k)) for k in range(n)] for kind in "abc")
    return g, [g.sum([a[k] * x[k] for k in range(n) for x in (b, c)])]


def of_many(n: int) -> tuple[Graph, list[Node]]:
    """n products of 12 factors among n."""
    random, g = Random(7), Graph()
    x = [g.symbol("x", str(k)) for k in range(n)]
    return g, [g.product([(f, 1) for f in random.sample(x, 12)]) for _ in range(n)]


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("job", "make"),
    [(lambda t: factored(*t), in_pairs), (lambda t: plan(t[1]), of_many)],
    ids=["sums", "products"],
)
def test_shared_factors_are_found_in_linear_time(
    job: Callable[[Any], Any], make: Callable[[int], tuple[Graph, list[Node]]]
) -> None:
    one, two, four = (work(job, make(n)) for n in (100, 200, 400))
    assert four - two < 2.25 * (two - one)


def test_few_names_are_compared_with_unknown_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    compared: list[int] = []
    compare = difflib.get_close_matches

    def counting(word: str, possibilities: Collection[str], **more: Any) -> list[str]:
        compared.append(len(possibilities))
        return compare(word, possibilities, **more)

    monkeypatch.setattr(difflib, "get_close_matches", counting)
    for n in (250, 500):
        compared.clear()
        checked(unknown_names(n))
        assert 0 < sum(compared) <= 2 * MOST_FAULTS * NEAREST


def peak(text: str) -> int:
    """Bytes at most.  Tables of the whole process, as that of Python's own names, may grow meanwhile."""
    gc.collect()
    tracemalloc.start()
    try:
        checked(text)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.full
@pytest.mark.parametrize("make", [coordinates, instances])
def test_memory_grows_with_the_coordinates(make: Callable[[int], str]) -> None:
    checked(make(40))
    one, two, four = (min(peak(make(n)) for _ in range(2)) for n in (40, 80, 160))
    assert four - two < 3 * (two - one)  # 2 and the steps in which tables grow; 4 where it is quadratic


@pytest.mark.full
def test_models_that_are_compiled_one_after_the_other_do_not_pile_up() -> None:
    """Graphs are garbage in circles, which nobody here asks to be collected."""
    source, graphs = Source("m.lag", outputs(40)), list[weakref.ref[Graph]]()
    for _ in range(40):
        model = pipeline.resolve(pipeline.parse(source), Choice())
        pipeline.optimize(pipeline.derive(model), work=True)
        graphs.append(weakref.ref(model.graph))
        del model
    assert sum(1 for graph in graphs if graph() is not None) < 20


def test_each_scene_is_checked_without_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    one = Builder._register_one

    def counting(self: Builder, *arguments: Any) -> None:
        seen[-1] += 1
        one(self, *arguments)

    monkeypatch.setattr(Builder, "_register_one", counting)
    for n in (5, 10, 20):
        seen.append(0)
        found = checking.check(Source("m.lag", scenes(n)), Choice())
        assert {fault.code for fault in found} == {"LAG0429"}  # gravity does not move x
    assert seen[2] - seen[1] < 2.25 * (seen[1] - seen[0])


def test_scenes_are_compared_where_they_are_checked_one_by_one() -> None:
    """What is wrong with two scenes together, in each of two models."""
    text = scenes(3) + scenes(3).replace("model M", "model N").replace("end M", "end N").replace("s1", "s2")
    faults = checking.check(Source("m.lag", text), Choice())
    errors = [f for f in faults if f.severity == "error" and f.span]
    assert [(f.code, f.span.line > 12) for f in errors if f.span] == [("LAG0202", True)]


@pytest.mark.full
def test_coordinates_that_nothing_couples_are_solved_one_by_one() -> None:
    """The operations of a right-hand side, and the text of the generated code."""
    sizes = []
    for n in (100, 200, 400):
        equations = pipeline.derive(pipeline.resolve(pipeline.parse(Source("m.lag", instances(n))), Choice()))
        program = pipeline.optimize(equations, work=True)
        assert program.interface.solve == "straight"
        texts = [pipeline.render(program, target) for target in ("c", "numpy")]
        sizes.append((program.interface.operations, *(sum(map(len, t.values())) for t in texts)))
    for one, two, four in zip(*sizes):
        assert four - two < max(2.4 * (two - one), 200 * 120)  # where loops begin it may be less and more
