"""Each command on the library's models with contacts: it answers, or refuses by name. The program of how-
to/embed-the-c.md that reads events of contacts, against the closed form. What is said about contacts:
remedies, the order of events, the work of an effect of contacts."""

import json
import re
import shutil
import subprocess
from math import sqrt
from pathlib import Path

import pytest

import lagc
from lagc.api.cost import term_sizes
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.host.model_library import library_models
from lagc.simulation.works import works
from tests.simulation.programs import needs_compiler

np = pytest.importorskip("numpy")

Capture = pytest.CaptureFixture[str]
pytestmark = pytest.mark.usefixtures("own_cache")
MODELS = [name for name in library_models() if name.startswith("contact/")]
RUBBED = """\
model Rubbed
  parameter Mass m = 2 [kg];
  coordinate Length x(rate = 1 [m/s]), z;
  body b = Particle(mass = m, at = {x, 0, z});
  Gravity field(g = 9.81 [m/s2]);
  constraint floor: z >= 0;
  force resist = {-0.2*reaction(floor), 0, 0} at b;
  output Force N = reaction(floor);
  scene s
    simulate(stop = 0.4 [s]);
  end s;
end Rubbed;
"""


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
def test_commands_answer(name: str, tmp_path: Path, capsys: Capture) -> None:
    for words in (["explain"], ["equations"], ["build", "-o", str(tmp_path)],
                  ["build", "--target", "numpy", "-o", str(tmp_path)]):  # fmt: skip
        assert main([words[0], name, *words[1:]]) == 0, (words, capsys.readouterr().err)
    status = main(["linearize", name])
    shown = capsys.readouterr()
    assert status == 0 or "error[LAG062" in shown.err + shown.out  # two modes meet, or friction of `=`
    model = lagc.load(name).compile(backend="numpy")  # `cost` itself takes a compiler and 10 s
    x0 = model.system.start()
    sizes = term_sizes(model.equations, model.system, x0, [0.0], np.array([x0]))
    assert len(sizes) == len(model.equations.state_names) + len(model.equations.outputs)


def test_a_load_of_a_reaction_works_and_its_terms_have_sizes() -> None:
    """A block slides with mu N = mu m g against it: it loses mu m g s on s = v t - mu g t^2/2."""
    model = lagc.loads(RUBBED).compile(backend="numpy")
    equations, system, stop = model.equations, model.system, 0.4
    run = model.simulate(accuracy=1e-9, points=9)
    found = works(equations, system, run.states[0], stop, "dop853")
    way = stop - 0.5 * 0.2 * 9.81 * stop**2
    assert found is not None
    assert found.actions["resist"] == pytest.approx(-0.2 * 2.0 * 9.81 * way, rel=1e-8)
    assert found.end - found.start == pytest.approx(found.actions["resist"], rel=1e-8)
    assert found.rest == 0.0
    table = np.array([run[name] for name in ("x", "z", "der(x)", "der(z)", "N")]).T
    sizes = term_sizes(equations, system, run.states[0], run.times, table)
    assert sizes[4] == pytest.approx(2.0 * 9.81, rel=1e-6)


@pytest.mark.full
@needs_compiler
def test_effects_of_loads_of_reactions_are_told(capsys: Capture) -> None:
    """What the two effects take is what the cart loses: its wheels roll."""
    assert main(["effects", "rolling_cart", "--json", "-q"]) == 0
    told = json.loads(capsys.readouterr().out)
    works = [effect["work"] for effect in told["effects"]]
    energy = told["energy"]
    assert len(works) == 2 and max(works) < 0.0
    assert energy["end"] - energy["start"] == pytest.approx(sum(works), rel=1e-8)


PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "embed-the-c.md"
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.usefixtures("own_cache")
def test_the_program_that_reads_events(tmp_path: Path) -> None:
    """A ball of 1 kg from 1 m: all flights end at 3 t1 with e = 1/2; its impulses add up to (1 + e)/(1 - e)
    times that of stopping it once, m g t1 (W. Goldsmith, Impact, 1960, 1.2)."""
    (program,) = re.findall(r"```c\n(#include \"bouncing_ball.h\".*?)```", PAGE.read_text("utf-8"), re.S)
    assert main(["build", "bouncing_ball", "--target", "c", "-o", str(tmp_path), "-q"]) == 0
    (tmp_path / "main.c").write_text(program)
    command = ["gcc", *STRICT, "main.c", "bouncing_ball.c", "-lm", "-o", "main"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    rest, impacts, impulse, height = re.findall(r"[-\d.]+(?:e-\d+)?(?= s\n| impacts| N s| m)", done.stdout)
    fall = sqrt(2 / 9.81)
    assert float(rest) == pytest.approx(3 * fall, rel=1e-8)  # the printed digits; rtol is 1e-9
    left = 3 * sqrt(2 * 9.81 * 1e-10)  # of bounces that are not followed: lower than 1e-10 of 1 m
    assert 0.0 < 3 * 9.81 * fall - float(impulse) <= left
    assert int(impacts) > 10 and float(height) == 0.0


FALL = """model N
  coordinate Length y(start = 1 [m]);
  body ball = Particle(mass = 5 [kg], at = {{0, 0, y}});
  Gravity field(g = 9.81 [m/s2]);
  {}
  scene s
    simulate(stop = 0.6 [s]);
  end s;
end N;
"""


def _remedy(lines: str) -> str:
    with pytest.raises(Refused) as found:
        lagc.loads(FALL.format(lines)).compile(backend="numpy")
    return str(found.value.remedy)


@pytest.mark.parametrize(("bound", "last"), [("2 [m]", "2 [m]"), ("2*(1 [m])", "2*(1 [m])")])
def test_both_bounds_keep_the_arguments(bound: str, last: str) -> None:
    both = _remedy(f"constraint c: 0 <= y <= {bound} (restitution = 0.5);")
    one, other = (
        "constraint c_1: 0 <= y (restitution = 0.5);",
        f"constraint c_2: y <= {last} (restitution = 0.5);",
    )
    assert both == f"write two constraints: `{one}` and `{other}`"
    assert lagc.loads(FALL.format(one + other)).check() == []


@pytest.mark.parametrize(
    ("lines", "remedy"),
    [("constraint edge: y >= 0; output Force F = reaction(nothing);", "there are `edge`"),
     ("constraint edge: y >= 0; output Force F = reaction(floor);", "there are `edge`"),
     ("constraint edge: y >= 0 (friction = 0.1, slip = y);", "write `slip = der(y)`"),
     ("constraint edge: y >= 0 (friction = 0.1, slip = {y, 2*y});", "`slip = {der(y), der(2*y)}`"),
     ("output Real F = impulse(nothing);", "declare a one-sided constraint"),
     ("output Length h(scale = -1 [mm]) = y;", "`scale = 0.1 [m]`")],
)  # fmt: skip
def test_remedies_name_what_there_is(lines: str, remedy: str) -> None:
    assert remedy in _remedy(lines)


def test_an_impact_comes_before_the_clause_that_it_causes() -> None:
    lines = """constraint c: y >= 0 (restitution = 0.5);
  when der(y) > 0.1 [m/s] then mark("up"); end when;"""
    run = lagc.loads(FALL.format(lines)).compile(backend="numpy").simulate(rtol=1e-8)
    impact, up = run.events
    assert (impact.kind, up.name) == ("impact", "up") and impact.t == up.t


@pytest.mark.full
def test_the_work_of_an_effect_of_contacts_is_what_they_take() -> None:
    """A ball that falls by h and leaves with half of its speed: contacts take 3/4 m g h."""
    lines = """effect ground
    constraint c: y >= 0 (restitution = 0.5);
  end ground;"""
    text = FALL.format(lines).replace("scene s\n", "scene s uses ground\n")
    (one,) = lagc.loads(text).compile(scene="s").effects().left_out
    assert one.work == pytest.approx(-0.75 * 5.0 * 9.81, rel=1e-6)
