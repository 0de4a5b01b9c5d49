"""Standard streams that are closed, full, or that nobody reads: what was asked for is done, and said."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.cli.output import DONE, FAILED, REFUSED, UNWRITTEN, USAGE

pytestmark = [
    pytest.mark.usefixtures("own_cache"),
    pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device that is full"),
]
WRONG = "model M\n  coordinate Length x;\n  body b = Particle(mass = 1 [kg], at = {y, 0, 0});\nend M;\n"
UGLY = "model  A\ncoordinate Length x;body b=Particle(mass=1[kg],at={x,0,0});end A;"
# words of a command line, its exit code, the files it leaves, whether it has something to print
COMMANDS = [
    ("check simple_pendulum", DONE, (), False),
    ("check wrong.lag", REFUSED, (), True),
    ("check --explain LAG0601", DONE, (), True),
    ("fmt ugly.lag", DONE, ("ugly.lag",), False),
    ("fmt -", DONE, (), True),
    ("explain simple_pendulum", DONE, (), True),
    ("equations simple_pendulum", DONE, (), True),
    ("equations simple_pendulum --json", DONE, (), True),
    ("sim simple_pendulum -o run.csv", DONE, ("run.csv", "run.csv.json"), True),
    ("sim simple_pendulum -q --json -o run.npz --plot run.svg", DONE, ("run.npz", "run.svg"), True),
    ("sim simple_pendulum --accuracy 1e-20 -o run.csv", FAILED, ("run.csv", "run.csv.json"), True),
    ("sim simple_pendulum --stop -1", USAGE, (), False),
    ("sim wrong.lag --json", REFUSED, (), True),
    ("linearize simple_pendulum -o linear.npz --plot modes.svg", DONE, ("linear.npz", "modes.svg"), True),
    ("linearize simple_pendulum --equilibrium --json -o linear.json", DONE, ("linear.json",), True),
    ("build simple_pendulum -o out", DONE, ("out/simple_pendulum.c", "out/simple_pendulum.h"), True),
    ("new Swing", DONE, ("Swing.lag",), False),
    ("--help", DONE, (), True),
    ("sim --help", DONE, (), True),
    ("--version", DONE, (), True),
    ("nonsense", USAGE, (), False),
]
# what is done to each standard stream, by its number; no reader: a pipe whose other end is closed
STREAMS = {
    "stdout closed": {"1": "closed"}, "stdout full": {"1": "full"}, "stdout unread": {"1": "unread"},
    "stderr closed": {"2": "closed"}, "stderr full": {"2": "full"},
    "both closed": {"1": "closed", "2": "closed"},
}  # fmt: skip
# A process that has loaded everything runs each command in a child of its own.
DRIVER = """
import json, os, sys
import lagc.api, lagc.semantics.resolve, lagc.lowering.lower_equations, lagc.simulation.simulate
import lagc.reports.explain
from lagc.cli.program import program
(streams, commands), codes = json.loads(sys.argv[1]), []
for number, words in enumerate(commands):
    child = os.fork()
    if child == 0:
        os.chdir(str(number))
        os.dup2(os.open("ugly.lag", os.O_RDONLY), 0)
        for stream, state in streams.items():
            if state == "unread":
                end, out = os.pipe()
                os.close(end)
            else:
                out = os.open("/dev/full", os.O_WRONLY)
            os.dup2(out, int(stream))
            if state == "closed":
                os.close(int(stream))
        sys.stdout, sys.stderr = [None if streams.get(n) == "closed" else open(int(n), "w") for n in "12"]
        sys.argv = ["lagc", *words.split()]
        sys.exit(program())
    codes.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
print(json.dumps(codes))
"""


def shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    words = ["bash", "-c", f"set -o pipefail; {line}"]
    return subprocess.run(words, cwd=folder, env=environment(), capture_output=True, text=True, timeout=120)


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "MPLBACKEND": "agg"}


@pytest.mark.full
@pytest.mark.parametrize("streams", STREAMS)
def test_every_command_does_its_work_and_says_what_was_not_printed(streams: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for number in range(len(COMMANDS)):
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "wrong.lag").write_text(WRONG)
        (tmp_path / str(number) / "ugly.lag").write_text(UGLY)
    given = json.dumps([STREAMS[streams], [words for words, *_ in COMMANDS]])
    done = subprocess.run([sys.executable, "-c", DRIVER, given], cwd=tmp_path, env=environment(),
                          capture_output=True, text=True, timeout=120)  # fmt: skip
    assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr
    assert "internal error" not in done.stderr
    codes = json.loads(done.stdout.splitlines()[-1])
    lost = streams in ("stdout closed", "stdout full", "both closed")
    wanted = [UNWRITTEN if lost and prints and code == DONE else code for _, code, _, prints in COMMANDS]
    assert codes == wanted
    for number, (words, _, files, _) in enumerate(COMMANDS):
        folder = tmp_path / str(number)
        found = {str(p.relative_to(folder)) for p in folder.rglob("*")} - {"wrong.lag", "ugly.lag", "out"}
        assert found == set(files) - {"ugly.lag"}, words
        assert "ugly.lag" not in files or "model A\n" in (folder / "ugly.lag").read_text()


def test_what_was_not_printed_is_said(tmp_path: Path) -> None:
    done = shell(f"{sys.executable} -m lagc explain simple_pendulum >/dev/full", tmp_path)
    assert done.stderr == "lagc: standard output cannot be written: No space left on device\n"


@pytest.mark.full
def test_what_is_said_never_goes_among_the_results(tmp_path: Path) -> None:
    """Python prints on standard output where standard error is closed."""
    done = shell(f"{sys.executable} -m lagc sim simple_pendulum --json -o run.csv 2>&-", tmp_path)
    assert json.loads(done.stdout)["status"] == "ok"


@pytest.mark.full
@pytest.mark.skipif(not os.path.exists("/dev/stdout"), reason="no name for the standard output")
def test_the_standard_output_takes_the_numbers_and_nothing_else(tmp_path: Path) -> None:
    command = f"{sys.executable} -m lagc sim simple_pendulum --points 3 -o /dev/stdout"
    for more in ("", " --json", " | cat", " > run"):
        done = shell(f"{command}{more}; cat run 2>&-", tmp_path)
        lines = done.stdout.splitlines()
        assert lines[0].startswith("time,theta") and len(lines) == 4, more
        assert "reached t = " in done.stderr
    done = shell(f"{command} --points 100000 | head -1", tmp_path)
    assert done.stdout.count("\n") == 1 and done.returncode == DONE
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


@pytest.mark.sample(1)
@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_letters_that_a_terminal_has_not_are_escaped(encoding: str, tmp_path: Path) -> None:
    name = "p\N{GREEK SMALL LETTER THETA}\N{GRINNING FACE}.lag"
    (tmp_path / name).write_text(WRONG)
    at = f"PYTHONIOENCODING={encoding} {sys.executable} -m lagc"
    done = shell(f"{at} check --format json {name}; {at} check {name}; {at} sim 'q\udcff'", tmp_path)
    assert done.returncode == USAGE and "LAG0799" not in done.stderr
    found = json.loads(done.stdout[: done.stdout.index("\n}\n") + 2])
    assert found["faults"][0]["file"] == name
