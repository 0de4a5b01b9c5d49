"""Model Exchange in a small explicit importer in C, with three habits of stopping at roots."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from tests.fmi.units import archive, gcc, program, sources

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "embed-the-c.md"
STRICT = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
HABITS = ("before", "on", "behind")
# Model, end, step: the error of the classical method at these steps is below 1e-9.
RUNS = [
    ("thermostat", 15.0, 0.05), ("bouncing_ball", 3.0, 0.01), ("sampled_pd", 0.95, 0.002),
    ("stick_slip_belt", 2.0, 0.005), ("block_on_belt", 4.0, 0.02), ("string_breaks", 1.0, 0.001),
    ("rod_impact", 0.6, 0.005), ("on_off_drive", 2.0, 0.01), ("rough_pin", 1.0, 0.002),
    ("conveyor", 1.0, 0.002),
]  # fmt: skip


@pytest.mark.sample(0, 6)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize(("model", "stop", "step"), RUNS, ids=[run[0] for run in RUNS])
def test_roots_are_passed_in_any_way(model: str, stop: float, step: float, tmp_path: Path) -> None:
    """An importer may stop before a root, as near to it as it gets, or behind it: each event of a run by
    lagc happens, at the same time, and the motion ends at the same state."""
    path = program(archive(model), "importer.c", tmp_path)
    system = lagc.load(model).compile()
    run = system.simulate(stop=stop, accuracy=1e-10)
    own = [event.t for event in run.events if event.t < stop]
    scale = [max(abs(run[name]).max() for name in names) for names in grouped(system)]
    for habit in range(3):
        done = subprocess.run(
            [path, str(habit), str(stop), str(step)], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0, done.stderr
        rows = [line.split() for line in done.stdout.splitlines()]
        times = [float(row[1]) for row in rows if row[0] == "event"]
        for t in own:
            assert min(abs(t - other) for other in times) < 1e-7 * stop, (HABITS[habit], t)
        states = [float(row[1]) for row in rows if row[0] == "state"]
        for name, value, size in zip(system.interface.state_names, states, scale):
            assert abs(value - run[name][-1]) < 1e-6 * size, (HABITS[habit], name)


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_an_importer_that_is_late(tmp_path: Path) -> None:
    """An importer of fixed steps handles an event of time up to a step late: each happens once, and the
    motion changes by its rates times this delay."""
    stop, step = 0.95, 0.003
    path = program(archive("sampled_pd"), "importer.c", tmp_path)
    run = lagc.load("sampled_pd").compile().simulate(stop=stop, accuracy=1e-9)
    done = subprocess.run([path, "3", str(stop), str(step)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    times = [float(row[1]) for row in rows if row[0] == "event"]
    assert times == pytest.approx([0.0, *(event.t for event in run.events)], abs=step)
    states = [float(row[1]) for row in rows if row[0] == "state"]
    for name, rate, value in zip(("x", "der(x)"), ("der(x)", "u"), states):
        assert abs(value - run[name][-1]) < 2.0 * step * abs(run[rate]).max()


TWO = """#include <stdio.h>
const char *bouncing_ball_GetVersion(void), *simple_pendulum_GetVersion(void);
int main(void)
{
    return printf("%s %s", bouncing_ball_GetVersion(), simple_pendulum_GetVersion()) < 0;
}
"""


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize("version", [3, 2])
def test_two_fmus_in_one_program(version: int, tmp_path: Path) -> None:
    """With the prefix of FMI's headers, sources of several FMUs are linked statically."""
    objects = []
    for model in ("bouncing_ball", "simple_pendulum"):
        folder = tmp_path / model
        folder.mkdir()
        for file in sources(archive(model, version), folder):
            gcc(folder, f"-DFMI{version}_FUNCTION_PREFIX={model}_", "-c", file)
            objects.append(f"{model}/{Path(file).stem}.o")
    (tmp_path / "main.c").write_text(TWO.replace("_Get", f"_fmi{version}Get"))
    gcc(tmp_path, "main.c", *objects, "-o", "main", "-lm")
    assert subprocess.check_output([tmp_path / "main"], text=True).split() == 2 * [f"{version}.0"]


def grouped(system: lagc.CompiledModel) -> list[list[str]]:
    """The states of the scaling group of each state."""
    interface = system.interface
    return [
        [name for name, other in zip(interface.state_names, interface.kinds) if other == kind]
        for kind in interface.kinds
    ]


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_the_program_of_the_page(tmp_path: Path) -> None:
    """The block moves with the belt until k vb t = fs, at 1 s; then it slips and sticks in turn."""
    (text,) = re.findall(r"```c\n(#include \"stick_slip_belt.h\".*?)```", PAGE.read_text("utf-8"), re.S)
    assert main(["build", "stick_slip_belt", "--events", "-o", str(tmp_path), "-q"]) == 0
    (tmp_path / "main.c").write_text(text)
    command = ["gcc", *STRICT, "main.c", "stick_slip_belt.c", "-lm", "-o", "main"]
    subprocess.run(command, cwd=tmp_path, check=True)
    done = subprocess.run(["./main"], cwd=tmp_path, capture_output=True, text=True, check=True)
    run = lagc.load("stick_slip_belt").compile().simulate(stop=5.0, accuracy=1e-10)
    printed = [line.split() for line in done.stdout.splitlines()]
    own = [event for event in run.events if event.name in ("slips", "sticks")]
    assert [word for _, word in printed] == [event.name for event in own]
    assert [float(t) for t, _ in printed] == pytest.approx([event.t for event in own], abs=1e-8)
    assert float(printed[0][0]) == pytest.approx(1.0, abs=1e-8)
