"""Signals at any time: files are the old ones or whole new ones, nothing is left, and the exit code says it.

LAGC_KILLS is the number of signals (10 where it is not set).
"""

import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lagc.cli.main import main
from lagc.cli.signals import SIGNALS

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="signals")
KILLS = int(os.environ.get("LAGC_KILLS", "10"))
ROOT = str(Path(__file__).parents[2])
UGLY = "model  A\ncoordinate Length x;body b=Particle(mass=1[kg],at={x,0,0});end A;"
SIM = "sim simple_pendulum -q --backend numpy --points 2001 --stop 20 -o"
# words, and the files that are there before, to be replaced
COMMANDS = {
    f"{SIM} run.csv": ("run.csv", "run.csv.json"),
    f"{SIM} run.npz": ("run.npz",),
    f"{SIM} run.parquet": ("run.parquet",),
    f"{SIM} run.csv --plot run.svg": ("run.csv", "run.csv.json", "run.svg"),
    "sim simple_pendulum -q --backend c -o run.csv": ("run.csv", "run.csv.json"),
    "build simple_pendulum -o .": ("simple_pendulum.c", "simple_pendulum.h"),
    "fmt ugly.lag": ("ugly.lag",),
    "new Swing --force": ("Swing.lag",),
    "equations simple_pendulum": (),
}
OLD = b"what was there\n"
# In a process that has loaded the program, each command runs in a child, to which the signals are sent.
DRIVER = """
import json, os, random, signal, sys, time
import lagc.api, lagc.semantics.resolve, lagc.lowering.lower_equations, lagc.simulation.simulate
from lagc.cli.program import program
seed, kills, commands = json.loads(sys.argv[1])
chance, ended, lasts = random.Random(seed), [], {}
for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # a child has them before its first line
    signal.signal(each, signal.SIG_DFL)
for number in range(kills + len(commands)):
    words = commands[number % len(commands)]
    began = time.perf_counter()
    child = os.fork()
    if child == 0:
        os.chdir(str(number))
        os.environ["TMPDIR"] = os.path.abspath("tmp")
        sys.argv = ["lagc", *words.split()]
        sys.exit(program())
    sent = []
    if number >= len(commands):  # the first run of each tells how long it takes
        for _ in range(chance.choice((1, 1, 2))):
            time.sleep(chance.uniform(0.0, 1.1 * lasts[words]))
            sent.append(chance.choice((signal.SIGINT, signal.SIGTERM, signal.SIGHUP)))
            if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
                os.kill(child, sent[-1])
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    lasts.setdefault(words, time.perf_counter() - began)
    ended.append((words, sent, code))
print()
print(json.dumps(ended))
"""


def environment(**more: str) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": ROOT, "MPLBACKEND": "agg", "LAGC_CACHE": "", **more}


@pytest.mark.full
def test_a_signal_at_any_time_loses_nothing(tmp_path: Path) -> None:
    commands = [c for c in COMMANDS if "plot" not in c or _has("matplotlib")]
    commands = [c for c in commands if "parquet" not in c or _has("pyarrow")]
    for number in range(KILLS + len(commands)):
        folder = tmp_path / str(number)
        (folder / "tmp").mkdir(parents=True)
        for name in COMMANDS[commands[number % len(commands)]]:
            (folder / name).write_bytes(UGLY.encode() if name == "ugly.lag" else OLD)
    given = json.dumps([random.Random(KILLS).random(), KILLS, commands])
    done = subprocess.run([sys.executable, "-c", DRIVER, given], cwd=tmp_path, env=environment(),
                          capture_output=True, text=True, timeout=300 + 30 * KILLS)  # fmt: skip
    assert "Traceback" not in done.stderr and "internal error" not in done.stderr, done.stderr
    ended = json.loads(done.stdout.splitlines()[-1])
    stopped = 0
    for number, (words, sent, code) in enumerate(ended):
        folder = tmp_path / str(number)
        came = [128 + s for s in sent] + [-s for s in sent]  # the latter before the program knows of it
        assert code == 0 or code in came, (words, sent, code)
        stopped += code != 0
        names = COMMANDS[words]
        assert sorted(p.name for p in folder.iterdir()) == sorted((*names, "tmp")), (words, sent)
        assert not list((folder / "tmp").iterdir()), (words, sent)
        for name in names:
            content = (folder / name).read_bytes()
            old = content == (UGLY.encode() if name == "ugly.lag" else OLD)
            assert (old and code != 0) or is_whole(folder / name), (words, sent, code)
        if "run.csv" in names:  # numbers that are new have what is known of them beside
            assert (folder / "run.csv").read_bytes() == OLD or is_whole(folder / "run.csv.json")
    assert stopped > KILLS // 3


def is_whole(path: Path) -> bool:
    """Whether it can be read, to its last byte."""
    content = path.read_bytes()
    if path.suffix == ".csv":
        lines = content.decode().split("\r\n")
        return lines.pop() == "" and len(lines) > 1 and {line.count(",") for line in lines} == {3}
    if path.suffix == ".json":
        return json.loads(content)["model"] == "SimplePendulum"
    if path.suffix == ".npz":
        numpy = pytest.importorskip("numpy")
        with numpy.load(path) as found:
            return len(found["E"]) == len(found["time"]) and "model" in str(found["metadata"])
    if path.suffix == ".parquet":
        parquet = pytest.importorskip("pyarrow.parquet")
        return parquet.read_table(path).column_names[0] == "time"
    ends = {".svg": b"</svg>\n", ".c": b"}\n", ".h": b"_H_ */\n", ".lag": b";\n"}
    return content.endswith(ends[path.suffix])


def _has(package: str) -> bool:
    from importlib.util import find_spec

    return find_spec(package) is not None


def started(words: list[str], folder: Path | None = None, **more: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "lagc", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
                            env=environment(**more))  # fmt: skip


LONG = ["sim", "simple_pendulum", "--backend", "numpy", "--stop", "1e5", "--rtol", "1e-12", "--every", "1"]


def told_until(terminal: int, enough: float) -> str:
    """What comes out of a terminal until the bar of a run tells of a later time than `enough`."""
    shown = ""
    while not any(float(t) > enough for t in re.findall(r"t = (\S+) s of", shown)):
        shown += os.read(terminal, 1024).decode()
    return shown


def told_in_the_end(terminal: int) -> str:
    """What still comes after the process at its other end has ended."""
    shown = b""
    try:
        while more := os.read(terminal, 1024):
            shown += more
    except OSError:  # as Linux says it
        pass
    os.close(terminal)
    return shown.decode()


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_run_that_is_ended_keeps_what_was_computed(name: str, tmp_path: Path) -> None:
    out, number = tmp_path / "run.csv", getattr(signal, name)
    terminal, other = os.openpty()
    command = [sys.executable, "-m", "lagc", *LONG, "-o", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=other, text=True, env=environment())
    os.close(other)
    said = told_until(terminal, 2.0)
    process.send_signal(number)
    shown = process.communicate(timeout=60)[0]
    said += told_in_the_end(terminal)
    assert process.returncode == 128 + number
    assert "interrupted at t =" in shown and "Traceback" not in said
    assert len(out.read_text().splitlines()) > 2


def test_a_run_that_ends_at_its_start_leaves_the_file_that_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def end(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("lagc.cli.output.Bar.__call__", end)
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_bytes(OLD)
    words = "sim simple_pendulum -q --backend numpy --points 2 --stop 1000 -o run.csv --plot run.svg"
    assert main(words.split()) == 130
    assert Path("run.csv").read_bytes() == OLD and os.listdir() == ["run.csv"]


@pytest.mark.full
def test_a_signal_that_was_ignored_stays_ignored(tmp_path: Path) -> None:
    command = f"trap '' HUP; exec {sys.executable} -m lagc sim simple_pendulum -q --backend numpy --stop 200"
    process = subprocess.Popen(["bash", "-c", command], stdout=subprocess.PIPE, env=environment())
    for _ in range(20):
        time.sleep(0.05)
        process.send_signal(signal.SIGHUP)
    assert b"theta" in process.communicate(timeout=60)[0] and process.returncode == 0


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="a list of processes")
def lives(state: Path) -> bool:
    """By its file in /proc."""
    try:
        return state.read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


@pytest.mark.full
def test_the_compiler_goes_too_with_all_that_it_started(tmp_path: Path) -> None:
    compiler, pid = tmp_path / "cc", tmp_path / "pid"
    compiler.write_text(f"#!/bin/sh\necho x > $TMPDIR/left\nsleep 100 &\necho $! > {pid}\nwait\n")
    compiler.chmod(0o755)
    (tmp_path / "tmp").mkdir()
    words = ["sim", "simple_pendulum", "--backend", "c"]
    process = started(words, LAGC_CC=str(compiler), TMPDIR=str(tmp_path / "tmp"))
    while not (pid.exists() and pid.read_text().strip()):
        time.sleep(0.05)
    process.terminate()
    _, said = process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGTERM and said == "interrupted\n"
    assert not list((tmp_path / "tmp").iterdir())
    state, end = Path(f"/proc/{pid.read_text().strip()}/stat"), time.monotonic() + 30.0
    while lives(state) and time.monotonic() < end:  # it was sent a signal that it cannot refuse
        time.sleep(0.01)
    assert not lives(state)


@pytest.mark.sample(1, 2)
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("reader", [False, True])
def test_a_pipe_that_nobody_reads_is_given_up_and_its_content_kept(
    name: str, reader: bool, tmp_path: Path
) -> None:
    pipe, number = tmp_path / "run.csv", getattr(signal, name)
    os.mkfifo(pipe)
    reads = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK) if reader else None
    words = ["sim", "simple_pendulum", "-q", "--backend", "numpy", "--points", "5001", "-o", "run.csv"]
    process = started(words, tmp_path)
    end = time.monotonic() + 30.0
    while not list(tmp_path.glob(".run.csv.json.*")) and time.monotonic() < end:
        time.sleep(0.01)
    time.sleep(0.3)  # it waits for somebody to read, or to read on
    process.send_signal(number)
    said = process.communicate(timeout=30)[1]
    if reads is not None:
        os.close(reads)
    assert process.returncode == 128 + number and "interrupted" in said and "Traceback" not in said
    kept = [path.name for path in tmp_path.iterdir() if path != pipe]
    assert len(kept) == 2 and all(name in said or name.endswith(".csv.json") for name in kept), kept
    assert all(is_whole(tmp_path / name) for name in kept)


def test_what_is_loaded_may_make_an_error_of_its_own_of_an_interruption(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As libraries in C do, whose initialization then failed."""

    def load(_: object) -> None:
        try:
            SIGNALS._came(signal.SIGTERM, None)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None

    monkeypatch.setattr(SIGNALS, "number", 0)
    monkeypatch.setattr("lagc.cli.cache.run", load)
    assert main(["cache"]) == 130 and SIGNALS.code == 143
    assert capsys.readouterr().err == "interrupted\n"


# A signal ends `main`, in a call of which nothing may be raised where it is `lost`; another one comes at the
# event NUMBER of what is done then in the program's own files.
TWICE = """
import os, signal, sys, time, weakref
import lagc.cli.main
from lagc.cli import program, signals
number, lost = int(sys.argv[1]), sys.argv[2] == "lost"
events = [0]
def trace(frame, event, _):
    own = frame.f_code.co_filename in (program.__file__, signals.__file__)
    if not own or frame.f_code.co_name in ("_came", "_lost", "_again", "main"):
        return None
    events[0] += 1
    if events[0] == number:
        print("another", flush=True)
        os.kill(os.getpid(), signal.SIGTERM)
    return trace
class Some:
    pass
def end(_=None):
    sys.settrace(trace)
    sys._getframe(2 if lost else 1).f_trace = trace
    os.kill(os.getpid(), signal.SIGHUP)
def main():
    if lost:
        some = Some()
        kept = weakref.ref(some, end)
        del some
        time.sleep(5.0)
    else:
        end()
lagc.cli.main.main = main
sys.exit(program.program())
"""


@pytest.mark.full
@pytest.mark.parametrize("lost", ["raised", "lost"])
def test_two_signals_leave_no_traceback(lost: str) -> None:
    number, came = 0, True
    while came:
        number += 1
        words = [sys.executable, "-c", TWICE, str(number), lost]
        done = subprocess.run(words, env=environment(), capture_output=True, text=True, timeout=30)
        assert done.returncode == 128 + signal.SIGHUP and done.stderr == "", (number, done.stderr)
        came = "another" in done.stdout
    assert number > 3
