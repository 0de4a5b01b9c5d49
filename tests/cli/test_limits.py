"""Limits of time and memory: the stage is named, what was computed is kept, and nothing is left behind."""

import csv
import importlib
import json
import math
import os
import random
import signal
import subprocess
import sys
import tracemalloc
from contextlib import nullcontext
from pathlib import Path
from time import monotonic

import pytest

import lagc
from lagc.base.text import seconds, size
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.host import budgets
from lagc.simulation import supervision
from lagc.simulation.backends.compile import compiler
from lagc.simulation.request import Request

pytestmark = pytest.mark.usefixtures("own_cache")
SPRING = """\
model Spring
  parameter Mass m = 1 [kg];
  parameter Stiffness k = 1 [N/m];
  coordinate Length x(start = 1);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 1/2*k*x^2;
end Spring;
"""
STAGES = [  # where it is done, by which command, what it is called
    ("lagc.syntax.parse.parse", "check", "reading the model"),
    ("lagc.semantics.resolve.resolve", "check", "finding what its names mean"),
    ("lagc.mechanics.derive.derive", "equations", "deriving the equations"),
    ("lagc.lowering.lower_equations.optimize", "check", "simplifying the equations"),
    ("lagc.reports.equations.write.write", "equations", "writing the equations"),
    ("lagc.reports.explain.explanation", "explain", "examining the equations"),
    ("lagc.codegen.c.emit.render", "build", "writing the code"),
    ("lagc.codegen.python.emit.render", "sim", "writing the code"),
]


@pytest.fixture
def spring(tmp_path: Path) -> str:
    path = tmp_path / "spring.lag"
    path.write_text(SPRING)
    return str(path)


def endless(*_: object, **__: object) -> None:
    while True:
        pass


@pytest.mark.sample(1)
@pytest.mark.parametrize("given", [True, False], ids=["max-time", "of the stage"])
@pytest.mark.parametrize(("place", "command", "doing"), STAGES, ids=[s[0] for s in STAGES])
def test_a_stage_that_never_ends_is_ended_and_named(
    spring: str, place: str, command: str, doing: str, given: bool, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str], tmp_path: Path,
) -> None:  # fmt: skip
    module, _, name = place.rpartition(".")
    monkeypatch.setattr(importlib.import_module(module), name, endless)
    monkeypatch.setattr(budgets, "ALLOWED", 0.2)
    for size_of in ("PER_CHARACTER", "PER_PAIR", "PER_OPERATION"):
        monkeypatch.setattr(f"lagc.compiler.stages.{size_of}", 0.0)
    before, began = signal.getsignal(signal.SIGALRM), monotonic()
    words = [command, spring, *(["-o", str(tmp_path)] if command == "build" else [])]
    assert main([*words, *(["--max-time", "0.5"] if given else []), "--json"]) == 4
    assert monotonic() - began < 20.0
    out = capsys.readouterr()
    (fault,) = json.loads(out.out)["faults"]
    assert fault["code"] == "LAG0801"
    assert fault["message"].startswith(f"{doing} took longer than ")
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


@pytest.mark.sample(1)
@pytest.mark.parametrize("given", [False, True])
def test_a_start_that_takes_long_is_no_fault_of_the_model(
    spring: str, given: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A run goes on with it: `check` says that it was not tried to its end, or that the time given is up."""
    monkeypatch.setattr("lagc.simulation.initialization.initialize.consistent_start", endless)
    monkeypatch.setattr(budgets, "ALLOWED", 0.5)
    monkeypatch.setattr("lagc.compiler.stages.PER_OPERATION", 0.0)
    before = signal.getsignal(signal.SIGALRM)
    words = ["check", spring, "--json", *(["--max-time", "0.5"] if given else [])]
    assert main(words) == (4 if given else 0)
    found = json.loads(capsys.readouterr().out)
    (fault,) = found["faults"]
    assert fault["code"] == ("LAG0801" if given else "LAG0805")
    assert fault["severity"] == ("error" if given else "warning")
    assert not given or fault["message"].startswith("finding the start took longer than ")
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_what_comes_after_a_stage_that_had_no_more_time_has_its_own() -> None:
    with lagc.Limits(careful=True) as block:
        for _ in range(2):
            with pytest.raises(budgets.Exhausted), budgets.stage("the search", 0.1 - budgets.ALLOWED):
                endless()
            assert budgets.go_on() and not budgets.go_on()
            assert block.end == math.inf and not budgets.reached()
        with budgets.stage("what comes after"):
            assert block.end < math.inf
    with pytest.raises(Refused, match="the search took longer"), lagc.Limits(0.1):
        try:
            with budgets.stage("the search"):
                endless()
        except budgets.Exhausted:
            assert not budgets.go_on()
            raise


@pytest.mark.full
def test_a_run_that_is_ended_keeps_what_it_computed(
    spring: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "spring.csv"
    words = ["--stop", "1e5", "--every", "1", "--backend", "numpy", "--max-time", "2", "-o", str(path)]
    assert main(["sim", spring, *words, "--max-memory", "none", "--json"]) == 4
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "failed"
    assert found["message"].endswith("it took longer than the limit of 2 s")
    rows = list(csv.DictReader(path.open()))
    assert len(rows) > 3  # of which the pilots are good to about 1e-6 for a turn
    for row in rows:
        t = float(row["time"])
        assert float(row["x"]) == pytest.approx(math.cos(t), abs=1e-5 * (1.0 + t))


def test_the_time_of_a_block_is_that_of_all_in_it() -> None:
    with (
        pytest.raises(Refused, match=r"LAG0801: the inner took longer than the limit of 0[.]1 s"),
        lagc.Limits(time=0.1),
    ):
        with budgets.stage("the outer"):
            pass
        with budgets.stage("the inner"):
            endless()


@pytest.mark.sample(1)
@pytest.mark.parametrize("stage_of", [None, "outer", "inner"])
def test_a_block_in_a_block_does_what_is_done_there(stage_of: str | None) -> None:
    """Whose limit ends it, and where the stage began, changes nothing."""
    doing = f"the stage of the {stage_of}" if stage_of else "the work"
    for times in ((0.1, None), (None, 0.1), (0.1, 9.0), (9.0, 0.1)):
        outer, inner = (
            budgets.stage(doing) if stage_of == name else nullcontext() for name in ("outer", "inner")
        )
        with pytest.raises(Refused, match=f"LAG0801: {doing} took longer than"):  # noqa: SIM117
            with lagc.Limits(times[0]), outer, lagc.Limits(times[1]), inner:
                endless()


@pytest.mark.full
def test_a_run_in_python_ends_with_what_it_has() -> None:
    system = lagc.loads(SPRING).compile(backend="numpy")
    system.simulate(stop=1.0)  # loads all modules: the limit ends the integration
    with lagc.Limits(time=2.0):
        run = system.simulate(stop=1e5, every=1.0)
    assert (run.status, run.interrupted) == ("failed", True)
    assert 1 < len(run.t) < 1e5


def test_more_memory_than_allowed_is_told_and_the_limit_goes() -> None:
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_AS)
    with pytest.raises(Refused, match="LAG0802: the work needs more memory"), lagc.Limits(memory=1.0):
        bytearray(1 << 30)
    assert resource.getrlimit(resource.RLIMIT_AS) == before
    bytearray(1 << 26)


def test_less_memory_than_is_taken_is_refused_before_anything_is_done() -> None:
    """Where there is none left, nothing that comes after could be relied on, no report of it either."""
    taken = budgets.reserved()
    if not taken:
        pytest.skip("the system does not tell")
    for part in (1e-9, 1e-3, 0.1, 0.5, 0.99):
        with pytest.raises(Refused, match="LAG0802: the work needs more memory"):  # noqa: SIM117
            with lagc.Limits(memory=part * taken):
                pytest.fail("it began")
    with lagc.Limits(memory=budgets.reserved() + 1e8):
        bytearray(10_000_000)


@pytest.mark.sample(0, 2)
@pytest.mark.skipif(compiler() is None or sys.platform != "linux", reason="limits of memory")
@pytest.mark.parametrize("words", [["--backend", "c"], ["--backend", "auto"], ["--plot", "a.svg"]])
def test_any_limit_of_memory_is_kept_or_reached(spring: str, words: list[str], tmp_path: Path) -> None:
    """Whatever it hits: Python, a library that is loaded, or the compiler, which is several programs."""
    rng, codes = random.Random(4), list[int]()
    env = {
        **os.environ,
        "PYTHONPATH": str(Path(__file__).parents[2]),
        "LAGC_CACHE": "",
        "OPENBLAS_NUM_THREADS": "1",
    }
    for size_of in (16, 400, *(rng.randrange(17, 75) for _ in range(3))):
        command = [sys.executable, "-m", "lagc", "sim", spring, *words, "--max-memory", f"{size_of}M"]
        done = subprocess.run(command, env=env, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode in (0, 4), (size_of, done.stderr)
        assert ("error[LAG0802]" in done.stderr) == (done.returncode == 4)
        codes.append(done.returncode)
    assert codes[:2] == [4, 0]


@pytest.mark.sample(1, 5)
@pytest.mark.parametrize(
    ("outer", "inner", "ended"),
    [
        (0.3, 0.1, None), (0.3, None, None), (0.3, 5.0, None),  # the inner is done in time
        (0.3, 5.0, "inner"), (5.0, 0.3, "inner"), (0.3, None, "inner"), (None, 0.3, "inner"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("careful", [False, True])
def test_limits_hold_inside_and_after_others(
    outer: float | None, inner: float | None, ended: str | None, careful: bool
) -> None:
    """The outer limit ends what the inner block does, and what comes after it."""
    before, began, seen = signal.getsignal(signal.SIGALRM), monotonic(), ""
    with pytest.raises(Refused, match=r"LAG0801: .* than the limit of 0[.]3 s"), lagc.Limits(outer):
        try:
            with lagc.Limits(inner, careful=careful), budgets.stage("a stage"):
                if ended:
                    endless()
        except Refused:
            seen = "inner"
            raise
        endless()
    assert seen == (ended or "")
    assert 0.3 <= monotonic() - began < 3.0
    assert signal.getsignal(signal.SIGALRM) == before
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_a_ring_at_any_moment_is_answered_once_and_nothing_is_left() -> None:
    """Also while a block or a stage begins or ends: it is done, or refused, and never interrupted."""
    rng, before, refused = random.Random(3), signal.getsignal(signal.SIGALRM), 0
    for _ in range(3000):
        try:
            with lagc.Limits(10.0), lagc.Limits(10.0 ** rng.uniform(-6.5, -3.5)):
                for name in "abc":
                    with budgets.stage(name):
                        pass
        except Refused as error:
            assert error.faults[0].code == "LAG0801"
            refused += 1
        assert signal.getsignal(signal.SIGALRM) == before
        assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
        assert budgets._inside.block is None
    assert 300 < refused < 2900


def test_a_timer_that_rings_too_early_is_set_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budgets, "LONGEST", 0.01)
    began = monotonic()
    with pytest.raises(Refused, match="LAG0801"), lagc.Limits(time=0.3):
        endless()
    assert 0.3 <= monotonic() - began < 3.0


@pytest.mark.sample(6)
@pytest.mark.parametrize("exponent", range(-18, 18, 3))
def test_limits_of_any_size(spring: str, exponent: int, capsys: pytest.CaptureFixture[str]) -> None:
    """Each is kept or reached; a timer and a system count to less than what can be written."""
    word = str(10**exponent) if exponent >= 0 else f"{10.0**exponent:.18f}"
    given_ones = [["--max-time", word + "d"], *([["--max-memory", word + "G"]] if exponent > 0 else [])]
    for given in given_ones:
        code = main(["sim", spring, "--backend", "numpy", *given])
        said = capsys.readouterr().err
        told = "error[LAG080" in said or "it took longer than" in said  # before the run, or within it
        assert code == 0 or (code == 4 and exponent < 0 and told), said


@pytest.mark.parametrize(
    "words",
    [
        ["--stop", "1e300"], ["--stop", "1e306"], ["--stop", "1.7e308"], ["--stop", "1e100"],
        ["-p", "m=1e-300"], ["-p", "k=1e300"], ["--step", "1e-320"],
    ],
)  # fmt: skip
def test_a_run_of_more_steps_than_any_says_so(
    spring: str, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """A time, or a frequency, whose product is 1e99 or more: no cause is to be looked for in the model."""
    assert main(["sim", spring, "--backend", "numpy", *words, "--json"]) == 3
    assert "would take more than 1e+38 steps" in json.loads(capsys.readouterr().out)["message"]


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", ["string_pendulum", "double_pendulum", "four_bar", "heavy_top_quaternion"])
def test_a_run_whose_first_steps_overflow_does_not_blame_the_start(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sim", name, "--backend", "numpy", "--stop", "1e300", "--json"]) == 3
    told = json.loads(capsys.readouterr().out)["message"]
    assert "ask for a shorter" in told and "not a finite number" not in told


@pytest.mark.parametrize("low, high, default", [(1.0, 3.0, 2.0), (-4.0, -1.0, -2.5), (0.0, 1e6, 5.0)])
def test_bounds_of_inputs_are_held(
    low: float, high: float, default: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "a.lag"
    text = """model A
  input Force u(min = LOW, max = HIGH)DEFAULT;
  coordinate Length x;
  body b = Particle(mass = 1[kg], at = {x, 0, 0});
  force F = {u, 0, 0} at b;
end A;
""".replace("LOW", str(low)).replace("HIGH", str(high))
    file.write_text(text.replace("DEFAULT", f" = {default}[N]"))
    for value, code in ((low, 0), (high, 0), (low - 0.5, 2), (high + 0.5, 2)):
        words = ["sim", str(file), "-q", "--backend", "numpy", "--stop", "1", "-p", f"u={value}"]
        assert main(words) == code
        assert code == 0 or "LAG0602" in capsys.readouterr().err
    file.write_text(text.replace("DEFAULT", f" = {high + 1.0}[N]"))
    assert main(["check", str(file)]) == 1
    assert "above its maximum" in capsys.readouterr().out
    if not low <= 0.0 <= high:  # what it is where nothing is said
        file.write_text(text.replace("DEFAULT", ""))
        assert main(["check", str(file)]) == 1


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["simple_pendulum", "string_pendulum", "four_bar"])
@pytest.mark.parametrize("method", [[], ["--method", "dop853"], ["--method", "dopri5"]])
def test_a_run_may_be_as_short_as_numbers_are(
    name: str, method: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """Those below 2.3e-308 have fewer digits, and are to blame: not the model, nor too many steps."""
    rng = random.Random(name)
    for exponent in (323, 320, *(rng.randrange(100, 320) for _ in range(6)), 100):
        words = ["--stop", f"9e-{exponent}", "--backend", "numpy", "--json", *method]
        code = main(["sim", name, *words])
        found = json.loads(capsys.readouterr().out)
        assert code == (0 if found["status"] == "ok" else 3)
        few = ("in double precision", "for double precision", "was not reached: the best is estimated at")
        told = any(words in found["message"] for words in few)
        assert found["status"] == "ok" or (exponent > 308 and told)


@pytest.mark.parametrize("words", ["--points 60000000", "--points 600000000000000000", "--every 1e-15"])
def test_any_number_of_points_may_be_asked_for(
    spring: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The remedy says what allows it; then the memory there is decides, here that of a limit."""
    option, word = words.split()
    assert main(["sim", spring, option, word, "--json"]) == 4
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert fault["code"] == "LAG0804"
    allowed = size(fault["remedy"].split("`")[-2].split()[1])
    interface = lagc.loads(SPRING).compile(backend="numpy").interface
    request = Request(points=int(word)) if option == "--points" else Request(every=float(word))
    supervision.check_memory(request.completed({}), interface.nx, allowed or 0.0)


@pytest.mark.parametrize("words", [["--points", "9" * 19], ["--points", "9" * 400], ["--every", "1e-320"]])
def test_more_points_than_any_list_has_are_wrong_usage(spring: str, words: list[str]) -> None:
    assert main(["sim", spring, *words, "--max-memory", "none"]) == 2


@pytest.mark.sample(1)
@pytest.mark.parametrize("start", ["1e-320", "-5e-324", "1e-310", "1e-303"])
def test_states_that_leave_no_digits_are_no_internal_error(spring: str, start: str) -> None:
    assert main(["sim", spring, "--backend", "numpy", "--start", f"x={start}", "--json"]) in (0, 3)


@pytest.mark.parametrize("kind", [MemoryError, type("ArrayMemoryError", (MemoryError,), {})])
def test_memory_of_any_kind_is_told(kind: type[MemoryError]) -> None:
    given = pytest.raises(Refused, match="LAG0802: the work needs more memory than 1 GB")
    with given, lagc.Limits(memory=1e9), lagc.Limits(memory=2e9):
        raise kind("of arrays")
    without = pytest.raises(Refused, match="LAG0802: the work needs more memory than there is")
    with without, lagc.Limits(memory=math.inf):
        raise kind("of arrays")


@pytest.mark.parametrize("word", ["0", "-1", "nan", "inf", "2 weeks", "1e3", "", "٣"])
@pytest.mark.parametrize("option", ["--max-time", "--max-memory"])
def test_limits_that_are_none(spring: str, option: str, word: str) -> None:
    assert main(["check", spring, option, word]) == 2


def test_words_for_times_and_sizes() -> None:
    rng = random.Random(8)
    for _ in range(100):
        n = rng.choice((rng.randrange(1, 1000), round(rng.uniform(0.1, 99.0), 3)))
        assert seconds(f"{n}") == n
        for unit, factor in (("s", 1), ("min", 60), ("h", 3600), ("d", 86400)):
            assert seconds(f"{n}{unit}") == seconds(f"{n} [{unit}]") == n * factor
        for letter, power in (("", 0), ("K", 1), ("M", 2), ("G", 3)):
            assert size(f"{n}{letter}") == size(f"{n} {letter.lower()}B") == n * 1000.0**power


def test_a_run_is_ended_where_two_looks_say_that_it_takes_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs of a random steady pace: those that need more than the limit end at the second look, 2 s after
    they began, the others never."""
    rng = random.Random(5)
    for _ in range(200):
        needed = 10.0 ** rng.uniform(0.0, 8.0)
        if 150.0 < needed < 600.0:
            continue
        clock = [rng.uniform(0.0, 1e6)]
        monkeypatch.setattr(supervision, "monotonic", lambda clock=clock: clock[0])
        stop, step = 10.0 ** rng.uniform(-200, 200), rng.uniform(0.01, 0.3)
        began, reached = clock[0], []
        watched = supervision.Forecast(reached.append, stop, most=300.0)
        try:
            while clock[0] - began < min(needed, 30.0):
                watched(stop * ((clock[0] - began) / needed))
                clock[0] += step
        except Refused as refused:
            (fault,) = refused.faults
            assert fault.code == "LAG0803"
            assert needed > 300.0
            assert clock[0] - began < 2.0 + 3.0 * step
        else:
            assert needed <= 300.0
        assert reached


@pytest.mark.full
def test_what_is_recorded_takes_the_memory_that_is_foretold() -> None:
    system = lagc.loads(SPRING).compile(backend="numpy")
    for points in (4000, 16000):
        request = Request(stop=20.0, points=points, rtol=1e-6).completed({})
        tracemalloc.start()
        run = system.simulate(stop=20.0, points=points, rtol=1e-6)
        taken = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert len(run.times) == request.size() == len(request.grid())
        assert 0.5 * taken < request.size() * (supervision.POINT + supervision.NUMBER * 2) < 2.0 * taken


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["--points", "20000000"], "LAG0804"),
        (["--stop", "1e12", "--backend", "numpy"], "LAG0803"),
        (["--stop", "1e3", "--max-step", "1e-9", "--backend", "numpy"], "LAG0803"),
    ],
)
def test_a_run_that_takes_more_than_one_may_want_says_so(
    spring: str, words: list[str], code: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sim", spring, *words, "--json"]) == 4
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert fault["code"] == code
    assert "--max-" in fault["remedy"]


def test_points_that_no_memory_holds_are_refused_before_equations_are_derived(
    spring: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def derive(model: object) -> None:
        raise AssertionError

    monkeypatch.setattr("lagc.compiler.pipeline.derive", derive)
    assert main(["sim", spring, "--points", "60000000"]) == 4
