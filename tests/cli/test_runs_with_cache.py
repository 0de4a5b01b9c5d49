"""Whatever is done to the cache, runs give what they give without it, bit for bit."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.cli.main import main
from lagc.host import cache
from lagc.simulation.backends import compile as compilation
from lagc.simulation.backends.compile import build_library, compiler
from tests.cli.test_cache import DAMAGES

TIMES = int(
    os.environ.get("LAGC_CACHE_TRIALS", "1")
)  # how often what is random is tried, in units of seconds
MODEL = """
import "lib.lag";
model A
  parameter Mass m(min = 0) = m0;
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 2 [N/m]*x^2;
end A;
"""
LIBRARY = "constant Mass m0 = 2 [kg];"
needs_c = pytest.mark.skipif(compiler() is None, reason="no C compiler")
only_posix = pytest.mark.skipif(os.name != "posix", reason="signals and pipes are of other systems")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("model")
    (found / "a.lag").write_text(MODEL)
    (found / "lib.lag").write_text(LIBRARY)
    return found


def motion(folder: Path, backend: str) -> list[list[float]]:
    """By the Python interface."""
    run = lagc.load(str(folder / "a.lag")).compile(backend=backend).simulate(stop=1.0)
    assert run.status == "ok" and run.system.backend == backend
    return run.states


@pytest.fixture(scope="module")
def truth(folder: Path) -> list[list[float]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LAGC_CACHE", "")
        return motion(folder, "numpy")


@pytest.fixture(scope="module")
def filled(folder: Path, truth: list[list[float]], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache with entries of all kinds."""
    found = tmp_path_factory.mktemp("filled")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LAGC_CACHE", str(found))
        for backend in ("numpy", "c") if compiler() else ("numpy",):
            assert motion(folder, backend) == truth
    return found


@pytest.fixture()
def root(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it."""
    found = tmp_path / "cache"
    shutil.copytree(filled, found)
    monkeypatch.setenv("LAGC_CACHE", str(found))
    cache.notes.clear()
    return found


def names(root: Path) -> list[str]:
    return sorted(p.name for p in root.iterdir())


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["head", "artifact", "library"])
@pytest.mark.parametrize("trial", range(3 * TIMES))
def test_damaged_entries_change_no_result(
    root: Path, folder: Path, truth: list[list[float]], kind: str, trial: int
) -> None:
    """Entries of one kind, each damaged in a random way; those that count are made again."""
    among = random.Random(f"{kind} {trial}")
    entries = [name for name in names(root) if name.startswith(kind + "-")]
    assert entries or not compiler()
    for name in entries:
        DAMAGES[among.choice([d for d in DAMAGES if not d.startswith("another")])](root / name)
    for backend in ("numpy", "c") if compiler() else ("numpy",):
        assert motion(folder, backend) == truth
    assert {note.partition(" ")[0] for note in cache.notes if "again" in note} == set(entries)
    in_the_way = any((root / name).is_dir() for name in entries)  # nothing replaces a folder
    assert main(["cache", "--verify", "-q"]) == in_the_way
    assert motion(folder, "numpy") == truth


@pytest.mark.full
@needs_c
def test_entries_exchanged_are_noticed(root: Path, folder: Path, truth: list[list[float]]) -> None:
    """All entries of a kind change places with those of another model, with another spring."""
    other = folder.with_name("other")
    other.mkdir(exist_ok=True)
    (other / "a.lag").write_text(MODEL.replace("2 [N", "5 [N"))
    (other / "lib.lag").write_text(LIBRARY)
    first = names(root)
    theirs = [motion(other, backend) for backend in ("numpy", "c")]
    assert theirs[0] == theirs[1] != truth
    second = [name for name in names(root) if name not in first]
    for kind in ("head", "artifact", "library"):
        ours, others = ([root / n for n in ns if n.startswith(kind)] for ns in (first, second))
        assert len(ours) == len(others) > 0
        for one, two in zip(ours, others):
            swap = root / "swap"
            one.rename(swap)
            two.rename(one)
            swap.rename(two)
        assert [motion(folder, b) for b in ("numpy", "c")] == [truth] * 2
        assert [motion(other, b) for b in ("numpy", "c")] == theirs
        assert len([note for note in cache.notes if kind in note]) == 2 * len(ours)


@pytest.mark.full
@needs_c
def test_the_command_tells_of_damage_when_asked(
    root: Path, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def said(*words: str) -> tuple[str, str]:
        assert main(["sim", str(folder / "a.lag"), "--backend", "c", "--stop", "1", "-q", *words]) == 0
        printed = capsys.readouterr()
        return printed.out, printed.err

    def damage() -> None:
        cache.notes.clear()
        for name in names(root):
            DAMAGES["cut at 8/16"](root / name)

    before = said("-v")
    damage()
    quiet = said()
    damage()
    told, again = said("-v"), said("-v")
    assert before[1] == quiet[1] == ""
    assert all(f"cache: {kind}-" in told[1] for kind in ("head", "library"))
    assert before[0] == told[0] == again[0]


IN_USE = """
import os, sys, lagc
system = lagc.load(sys.argv[1]).compile(backend="c")
first = system.simulate(stop=1.0).states
for name in os.listdir(os.environ["LAGC_CACHE"]):
    with open(os.path.join(os.environ["LAGC_CACHE"], name), "r+b") as file:
        file.truncate(0)  # in place
assert system.simulate(stop=1.0).states == first
assert system.bind({"m": 3.0}).simulate(stop=1.0).states != first
"""


@pytest.mark.full
@only_posix
@needs_c
def test_a_library_cut_off_while_it_is_used_kills_nobody(root: Path, folder: Path) -> None:
    done = subprocess.run([sys.executable, "-c", IN_USE, str(folder / "a.lag")], capture_output=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.sample(1)
@needs_c
@pytest.mark.parametrize("in_memory", [True, False])
def test_libraries_are_told_apart(in_memory: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the loader sees the same numbers of descriptors again, all of them in use at once."""
    if not in_memory:
        monkeypatch.setattr(compilation, "_sealed", lambda data: None)
    built = [build_library({"n.c": f"int n(void) {{ return {k}; }}"}) for k in range(4)]
    order = [random.Random(1).randrange(len(built)) for _ in range(40)]
    loaded = [compilation.load(built[k]) for k in order]
    assert [found.n() for found in loaded] == order
    with pytest.raises(OSError):
        compilation.load(b"no library")


CROWD = """
import os, random, signal, sys, time
from lagc.host import cache
from lagc.host.cache import upkeep

BODIES = {cache.key(str(k)): bytes([k]) * random.Random(k).randrange(1, 60_000) for k in range(24)}

def work(seed):
    chosen = random.Random(seed)
    while True:
        key = chosen.choice(sorted(BODIES))
        deed = chosen.random()
        if deed < 0.5:
            cache.store("head", key, BODIES[key])
        elif deed < 0.95:
            found = cache.load("head", key, bytes)
            if found is not None and found != BODIES[key]:
                os._exit(7)
        else:
            place = cache.opened()
            if place is not None:
                with place:
                    bad = upkeep.damaged(place) if deed < 0.98 else upkeep.clear(place) and []
                    if bad:
                        os._exit(8)
        if cache.notes:
            os.write(2, repr(cache.notes).encode())
            os._exit(9)

def begin(seed):
    child = os.fork()
    if child == 0:
        try:
            work(seed)
        finally:
            os._exit(10)
    return child

def end(child):
    os.kill(child, signal.SIGKILL)
    status = os.waitpid(child, 0)[1]
    assert os.WIFSIGNALED(status), status

kills, chosen = int(sys.argv[1]), random.Random(int(sys.argv[2]))
running = [begin(k) for k in range(4)]
for k in range(kills):
    time.sleep(chosen.random() * 0.006)
    end(running.pop(chosen.randrange(len(running))))
    running.append(begin(100 + k))
for child in running:
    end(child)
with cache.opened() as place:
    print(len(upkeep.unfinished(place)))
    assert upkeep.damaged(place) == []
    upkeep.clear(place)
    assert upkeep.unfinished(place) == []
"""


@pytest.mark.full
@only_posix
@pytest.mark.parametrize("seed", range(TIMES))
def test_processes_that_are_killed_leave_nothing_half_written(seed: int, tmp_path: Path) -> None:
    """200 kills while four processes store, load, verify and clear: every entry that is read is whole, no
    process is told anything, and `clear` removes what was left unfinished."""
    environment = {**os.environ, "LAGC_CACHE": str(tmp_path / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", CROWD, "200", str(seed)], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.full
@only_posix
@needs_c
def test_runs_that_are_killed_spoil_no_other(
    folder: Path, truth: list[list[float]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`lagc sim` on one empty cache, killed at random moments, three at a time."""
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    cache.notes.clear()
    moments = random.Random(5)
    options = ("--stop", "1", "--json", "--backend")
    command = [sys.executable, "-m", "lagc", "sim", str(folder / "a.lag"), *options]

    def final(process: subprocess.Popen[str]) -> Any:
        said, _ = process.communicate()
        return json.loads(said)["final"] if process.returncode == 0 else process.returncode

    answers = []
    for _ in range(2 * TIMES):
        running = [
            subprocess.Popen([*command, b], stdout=subprocess.PIPE, text=True) for b in ("c", "c", "numpy")
        ]
        for process in running[1:]:
            time.sleep(moments.random() * 0.5)
            process.send_signal(signal.SIGKILL)
        answers += [final(process) for process in running]
    finals = [answer for answer in answers if answer != -signal.SIGKILL]
    assert len(finals) >= 2 * TIMES and all(answer == finals[0] for answer in finals)
    assert motion(folder, "c") == truth and cache.notes == []
    assert main(["cache", "--verify", "-q"]) == 0
