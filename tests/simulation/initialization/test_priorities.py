"""Starts of whole models: who wins, what is held, what is named, and the recipe of the header."""

import random
import re
import shutil
import subprocess
from math import cos
from pathlib import Path

import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.identifiers import prefix as prefix_of
from lagc.diagnostics.faults import Refused
from lagc.simulation.initialization.initialize import consistent_start
from lagc.simulation.request import Request
from lagc.simulation.simulate import simulate
from tests.simulation.initialization.generated_starts import program_of, start_of, system_of

WHEEL = """\
model Wheel
  parameter Length R = 0.3 [m];
  coordinate Length x{x}, z(start = R);
  coordinate Angle th{th};
  frame F = rotate_y(world, th);
  body w = Solid(mass = 1 [kg], inertia = {{1, 1, 1}}, frame = F, com = {{x, 0, z}});
  constraint roll: velocity(w, at = {{x, 0, z}} - R*world.z) = {{0, 0, 0}};
{more}
end Wheel;
"""


def wheel(x: str = "", th: str = "", more: str = "") -> str:
    return WHEEL.format(x=x, th=th, more=more)


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", range(8))
def test_a_train_of_gears_turns_as_its_one_stated_wheel_says(seed: int) -> None:
    dice = random.Random(seed)
    n = dice.randint(2, 6)
    stated, rate = dice.randrange(n), dice.choice((10.0, -1e-9, 3e7))
    ratios = [dice.choice((2.0, -0.5, 3.0, 0.25)) for _ in range(n - 1)]
    lines = [
        f"  coordinate Angle a{i}{f'(rate = {rate!r} [rad/s])' if i == stated else ''};" for i in range(n)
    ]
    lines += [f"  frame F{i} = rotate_z(world, a{i});" for i in range(n)]
    lines += [
        f"  body b{i} = Solid(mass = 1, inertia = {{1, 1, 1}}, frame = F{i}, com = {{0, 0, 0}});"
        for i in range(n)
    ]
    lines += [f"  constraint c{i}: der(a{i}) = {r!r}*der(a{i + 1});" for i, r in enumerate(ratios)]
    found = start_of("\n".join(["model Train", *lines, "end Train;\n"]))
    expected = [1.0]
    for r in ratios:
        expected.append(expected[-1] / r)
    for i in range(n):
        assert found[f"der(a{i})"] == pytest.approx(rate * expected[i] / expected[stated], rel=1e-12)
    assert found[f"der(a{stated})"] == rate


def test_a_wheel_rolls_as_fast_as_its_centre_is_said_to() -> None:
    found = start_of(wheel(x="(rate = 10 [m/s])"))
    assert found["der(x)"] == 10.0 and found["der(th)"] == pytest.approx(10.0 / 0.3, rel=1e-14)
    assert found["der(z)"] == 0.0


@pytest.mark.sample(2)
@pytest.mark.parametrize("turn", ["90[deg]", "-90[deg]", "270[deg]", "0.25[rev]", "acos(0)", "2*asin(1)/2"])
def test_a_quarter_of_a_turn_leaves_a_stated_value(turn: str) -> None:
    """A row along what was the x axis of a frame turned by a quarter: z = 0, whatever x."""
    text = f"""model Q
  coordinate Length x(start = 1), z(start = 0, startFixed = true);
  frame f = rotate_y(world, {turn});
  body b = Particle(mass = 1[kg], at = {{x, 0, z}});
  constraint r: dot(position(b), f.x) = 0;
end Q;
"""
    start = start_of(text)
    assert (start["x"], start["z"]) == (1.0, 0.0)


def test_a_stated_zero_is_stated() -> None:
    """Both rates are stated, and 0 is one of them: of the two one has to move, and by less in proportion."""
    text = wheel(x="(rate = 10 [m/s])", th="(rate = 0)")
    system = system_of(text)
    start = consistent_start(system)
    assert not start.unmet
    assert len([c for c in start.changes if c.stated]) == 1
    assert start_of(wheel(x="(rate = 10 [m/s])"))["der(x)"] == 10.0


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("scene", "run", "kept"),
    [
        ("", {}, None),
        ("start der(x) = 6 [m/s];", {}, ("der(x)", 6.0)),
        ("start der(th) = 7 [rad/s];", {}, ("der(th)", 7.0)),
        ("start der(x) = 6 [m/s];", {"der(th)": 9.0}, ("der(th)", 9.0)),
        ("start der(th) = 7 [rad/s];", {"der(x)": 8.0}, ("der(x)", 8.0)),
    ],
)
def test_the_more_specific_statement_wins(
    scene: str, run: dict[str, float], kept: tuple[str, float] | None
) -> None:
    text = wheel("(rate = 10 [m/s])", "(rate = 5 [rad/s])", f"  scene s {scene} end s;" if scene else "")
    found = start_of(text, **run)
    assert found["der(x)"] == pytest.approx(0.3 * found["der(th)"], rel=1e-14)
    if kept:
        assert found[kept[0]] == kept[1]
    else:
        assert (found["der(x)"] == 10.0) != (found["der(th)"] == 5.0)


def test_what_is_fixed_beats_the_run() -> None:
    text = wheel("(rate = 10 [m/s], rateFixed = true)")
    found = start_of(text, **{"der(th)": 1.0})
    assert found["der(x)"] == 10.0 and found["der(th)"] == pytest.approx(10.0 / 0.3)


@pytest.mark.parametrize(
    ("said", "held"),
    [
        ("start = 1, rate = 2, fixed = true", (True, True)),
        ("start = 1, fixed = true", (True, False)),
        ("start = 1, rate = 2, startFixed = true", (True, False)),
        ("start = 1, rate = 2, rateFixed = true", (False, True)),
        ("rateFixed = true", (False, True)),
        ("start = 1, rate = 2, fixed = true, rateFixed = false", (True, False)),
        ("start = 1, rate = 2, startFixed = true, rateFixed = true", (True, True)),
    ],
)
def test_position_and_rate_are_fixed_separately(said: str, held: tuple[bool, bool]) -> None:
    for declared in (f"x({said}), y", f"x[1]({said}), y", f"x[1](each {said.replace(', ', ', each ')}), y"):
        x = "x[1]" if "x[1]" in declared else "x"
        body = f"body p = Particle(mass = 1, at = {{{x}, y, 0}});"
        levels = system_of(
            f"model M\n  coordinate Length {declared};\n  {body}\nend M;\n"
        ).interface.start_levels
        assert (levels[0] == 4, levels[2] == 4) == held


@pytest.mark.parametrize("said", ["{true, false, true}", "{i <> 2 for i in 1:3}"])
def test_elements_are_fixed_each_by_itself(said: str) -> None:
    text = f"""\
model M
  coordinate Length x[3](start = {{1, 2, 3}}, rate = {{1, 2, 3}}, startFixed = {said}, rateFixed = {said});
  body b = Particle(mass = 1, at = {{x[1], x[2], x[3]}});
end M;
"""
    levels = system_of(text).interface.start_levels
    assert [level == 4 for level in levels] == [True, False, True] * 2


def test_instances_are_fixed_each_by_itself() -> None:
    text = """\
model Ball
  coordinate Length x[2](start = {1, 2});
  body b = Particle(mass = 1, at = {x[1], x[2], 0});
end Ball;
model M
  Ball a[3](x(fixed = {{true, false}, {false, false}, {true, true}}));
end M;
"""
    levels = system_of(text).interface.start_levels[:6]
    assert [level == 4 for level in levels] == [True, False, False, False, True, True]


def test_parts_of_orientations_and_declared_speeds_are_fixed() -> None:
    text = """\
model M
  coordinate Orientation o(rate = {{1, 2, 3}} [rad/s], {said});
  coordinate Length x(rate = 2 [m/s]);
  speed Velocity u(start = 4 [m/s]{fixed}) = 2*der(x);
  frame F = rotate(world, o);
  body b = Solid(mass = 1, inertia = {{1, 2, 3}}, frame = F, com = {{x, 0, 0}});
end M;
"""
    system = system_of(text.format(said="rateFixed = true", fixed=""))
    assert system.interface.start_levels == (0, 0, 0, 0, 0, 4, 4, 4, 1, 1)
    assert system.interface.rate_names == ("der(x)",)
    system = system_of(text.format(said="startFixed = true", fixed=", fixed = true"))
    assert system.interface.start_levels == (4, 4, 4, 4, 0, 1, 1, 1, 4, 1)


def test_a_rate_that_a_speed_replaces_counts() -> None:
    """u = x' cos th + y' sin th is not stated and gives way; where it is, more firmly than the rate of
    x, the rate does."""
    text = """\
model M
  coordinate Length x(rate = 3 [m/s]), y;
  coordinate Angle th(start = 0.5);
  speed Velocity u = cos(th)*der(x) + sin(th)*der(y);
  speed Velocity s = -sin(th)*der(x) + cos(th)*der(y);
  body b = Solid(mass = 1, inertia = {1, 1, 1}, frame = rotate_z(world, th), com = {x, y, 0});
  constraint skate: s = 0;
end M;
"""
    assert start_of(text)["u"] == pytest.approx(3.0 / cos(0.5), rel=1e-14)
    assert start_of(text, u=2.0)["u"] == 2.0
    (note,) = [c for c in consistent_start(system_of(text), 0.0, {"u": 2.0}).changes if c.stated]
    assert note.name == "der(x)" and note.used == pytest.approx(2.0 * cos(0.5)) and "`skate`" in str(note)


def test_what_forced_a_value_is_named() -> None:
    """Of three constraints on three points of a line the one that the stated values contradict."""
    text = """\
model M
  coordinate Length a(start = 1 [m]), b(start = 2.5 [m]), c(start = 5 [m]), d;
  body p = Particle(mass = 1, at = {a, b, c});
  body q = Particle(mass = 1, at = {d, b, c});
  constraint one: b - a = 1 [m];
  constraint two: d - c = 1 [m];
end M;
"""
    start = consistent_start(system_of(text))
    (change,) = [c for c in start.changes if c.stated]
    assert (change.name, change.used) == ("b", pytest.approx(2.0))  # 0.5 of 2.5 is less than 0.5 of 1
    assert change.forced == ("constraint `one` (m.lag:5)",)
    assert "(m.lag:2), because of constraint `one` (m.lag:5)" in str(change)
    assert start.notes[-1] == "found for the start: `d` = 6 m"


@pytest.mark.sample(2)
@pytest.mark.parametrize("seed", range(10))
def test_a_conflict_names_its_lines_and_no_other(seed: int) -> None:
    """A ring of differences that does not close, among constraints, conditions and fixed values that do."""
    dice = random.Random(seed)
    n, ring = 6, dice.sample(range(6), dice.randint(2, 5))
    solution = [round(dice.uniform(-2.0, 2.0), 3) for _ in range(n)]
    lines = ["model M", f"  coordinate Length x[{n}];"]
    lines += [f"  body b{i} = Particle(mass = 1, at = {{x[{i + 1}], 0, 0}});" for i in range(n)]
    planted, conditions = [], []
    for a, b in zip(ring, [*ring[1:], ring[0]]):
        difference = solution[a] - solution[b] + (0.5 if b == ring[0] else 0.0)
        equation = f"x[{a + 1}] - x[{b + 1}] = {difference!r} [m];"
        if dice.random() < 0.5 or len(ring) == 2:
            conditions.append(equation)
        else:
            lines.append(f"  constraint c{a}: {equation}")
            planted.append(len(lines))
    others = [i for i in range(n) if i not in ring]
    lines += [
        f"  constraint d{i}: x[{i + 1}]^3 = {solution[i] ** 3!r} [m3];" for i in others if dice.random() < 0.5
    ]
    lines.append("initial")
    for equation in conditions:
        lines.append(f"  {equation}")
        planted.append(len(lines))
    with pytest.raises(Refused) as refused:
        simulate(system_of("\n".join([*lines, "end M;\n"])), Request(stop=1.0))
    (fault,) = refused.value.faults
    assert fault.code == "LAG0610"
    assert sorted(map(int, re.findall(r"m\.lag:(\d+)", fault.message))) == sorted(planted)


def test_fixed_values_take_part_in_a_conflict() -> None:
    text = """\
model M
  coordinate Length x(start = 1 [m], startFixed = true);
  coordinate Length y(start = 2 [m], startFixed = true);
  coordinate Length z(start = 3 [m], fixed = true), w;
  body p = Particle(mass = 1, at = {x, y, z});
  body q = Particle(mass = 1, at = {w, 0, 0});
  constraint a: x + y = 4 [m];
  constraint b: w - z = 1 [m];
end M;
"""
    start = consistent_start(system_of(text))
    assert [m.name for m in start.unmet] == ["constraint `a` (m.lag:7)"]
    assert start.held == ("`x` (m.lag:2)", "`y` (m.lag:3)")


def test_what_is_no_number_is_said() -> None:
    text = """\
model M
  coordinate Length x(start = -1 [m], fixed = true), y;
  body p = Particle(mass = 1, at = {x, y, 0});
  constraint a: y = 1 [m]*log(x/(1 [m]));
end M;
"""
    with pytest.raises(Refused) as refused:
        simulate(system_of(text), Request(stop=1.0))
    (fault,) = refused.value.faults
    assert (
        "nan" not in fault.message and "constraint `a` (m.lag:4) is no finite number there" in fault.message
    )


MAIN = """
#include "{file}.h"
#include <stdio.h>
#include <stdlib.h>

int main(void)
{{
    {p}_start_work *c = ({p}_start_work *)malloc(sizeof *c);
    {p}_work *w = ({p}_work *)calloc(1, sizeof *w);
    {p}_params p = {p}_default_params();
    {p}_options o = {p}_default_options();
    {p}_state s;
    double x[{P}_NX];
    int i;
#ifdef {P}_NPREPARED
    {p}_bind(&p);
#endif
    {p}_start(&p, x);
    if ({p}_consistent(&p, 0.0, x, NULL, c) != {P}_OK)
        return 1;
    {p}_begin(&s, 0.0, x);
    if ({p}_advance(&p, &s, 0.25, &o, w) != {P}_OK)
        return 2;
    for (i = 0; i < {P}_NX; i++)
        printf("%a ", s.x[i]);
    free(c);
    free(w);
    return 0;
}}
"""
STRING = """\
model StringPendulum
  parameter Length l = 0.5 [m];
  coordinate Length x(start = 0.3 [m]), z;
  body bob = Particle(mass = 1, at = {x, 0, z});
  constraint string: norm(position(bob)) = l;
  effect gravity Gravity field; end gravity;
  scene lab uses gravity;
initial
  der(x) = 1 [m/s];
end StringPendulum;
"""
RECIPES = {
    "string": STRING,
    "wheel": wheel(x="(rate = 10 [m/s])"),
    "four bar": "classic/four_bar",
    "marble": "classic/sphere_on_turntable",
    "top": "classic/heavy_top_quaternion",
}


@pytest.mark.sample(0, 2)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("name", RECIPES)
def test_the_recipe_of_the_header_gives_the_motion_of_a_run(name: str, tmp_path: Path) -> None:
    program = program_of(RECIPES[name])
    prefix = prefix_of(program.interface.model)
    sources = render(program)
    assert f"{prefix}_consistent(&p, 0.0, x, NULL, &c)" in sources[f"{prefix}.h"]
    text = MAIN.format(p=prefix, P=prefix.upper(), file=prefix)
    for file, body in {**sources, "main.c": text}.items():
        (tmp_path / file).write_text(body)
    units = [file for file in (*sources, "main.c") if file.endswith(".c")]
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    command = ["gcc", "-std=c99", "-O0", "-ffp-contract=off", *units, "-lm", "-o", "main"]
    done = subprocess.run([*command, *checks], cwd=tmp_path, capture_output=True)
    if done.returncode != 0:
        subprocess.run(command, cwd=tmp_path, check=True)
    ran = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    run = simulate(system_of(RECIPES[name]), Request(stop=0.25, method="dop853", rtol=1e-9))
    assert [float.fromhex(word) for word in ran.stdout.split()] == run.states[-1]
