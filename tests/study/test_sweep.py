"""Sweeps: rows are those of single runs, nothing is lost or double, and all executors give the same bits."""

import errno
import json
import os
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from math import exp, log, sqrt
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.study.sweep import executors
from lagc.study.sweep.journal import Journal, NotKept
from lagc.study.sweep.plan import Distribution, Values, parse, plan_of
from lagc.study.sweep.worker import Record

ROOT = str(Path(__file__).parents[2])
SPRING = """model Spring
  parameter Mass m(min = 0.5) = 1 [kg];
  parameter Real[N/m] k = 4;
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = m, at = {x, 0, 0});
  potential V = 1/2*k*x^2;
  output Power P = k*x*der(x);
end Spring;
"""
BRIEF = {"rtol": 1e-8, "stop": 0.5, "points": 6}


@pytest.fixture(scope="module")
def spring() -> lagc.CompiledModel:
    return lagc.loads(SPRING, "spring.lag").compile(backend="numpy")


def si(name: str, numbers: Sequence[float], unit: str | None) -> list[float]:
    return [float(number) for number in numbers]


@pytest.mark.parametrize(
    "text, numbers, unit",
    [
        ("1,2,5", [1.0, 2.0, 5.0], None),
        ("-1:1:5", [-1.0, -0.5, 0.0, 0.5, 1.0], None),
        ("1:100:3:log [cm]", [1.0, 10.0, 100.0], "cm"),
        ("3:4:1", [3.0], None),
        ("0.1:0.3:3[m]", [0.1, 0.2, 0.3], "m"),
    ],
)
def test_values_are_read(text: str, numbers: list[float], unit: str | None) -> None:
    found = parse("l", text)
    assert isinstance(found, Values) and found.unit == unit
    assert found.numbers == pytest.approx(numbers, rel=1e-15)
    assert found.numbers[0] == numbers[0] and found.numbers[-1] == numbers[-1]  # both ends are exact


@pytest.mark.parametrize(
    "text", ["", "a", "1:2", "1:2:0", "1:2:x", "1:2:3:lin", "-1:1:3:log", "1,,2", "1:inf:3", "1[m],2[m]",
             "1[m", "normal(1)", "normal(1, -2)", "uniform(2, 1)", "cauchy(0, 1)", "loguniform(-1, 1)"],
)  # fmt: skip
def test_words_that_are_no_values_are_refused(text: str) -> None:
    with pytest.raises(Refused) as refused:
        parse("l", text)
    assert refused.value.code == "LAG0602"


def test_points_are_a_product_without_a_list_of_them() -> None:
    plan = plan_of({"a": Values([1, 2]), "b": Values([3, 4, 5])}, si)
    assert list(plan.points(0, len(plan))) == [(1, 3), (1, 4), (1, 5), (2, 3), (2, 4), (2, 5)]
    zipped = plan_of({"a": Values([1, 2]), "b": Values([3, 4])}, si, zipped=True)
    assert list(zipped.points(0, len(zipped))) == [(1, 3), (2, 4)]
    many = plan_of({name: Values(range(10_000)) for name in "abc"}, si)
    assert len(many) == 10**12
    assert list(many.points(10**12 - 2, 2)) == [(9999, 9999, 9998), (9999, 9999, 9999)]
    with pytest.raises(Refused, match="as many values"):
        plan_of({"a": Values([1, 2]), "b": Values([3])}, si, zipped=True)


# Mean and standard deviation in closed form.
MOMENTS = {
    Distribution("uniform", (2.0, 5.0)): (3.5, 3.0 / sqrt(12.0)),
    Distribution("normal", (1.0, 0.05)): (1.0, 0.05),
    Distribution("lognormal", (2.0, 0.3)): (2.0 * exp(0.045), 2.0 * exp(0.045) * sqrt(exp(0.09) - 1.0)),
    Distribution("loguniform", (1.0, 10.0)): (
        9.0 / log(10.0),
        sqrt(49.5 / log(10.0) - (9.0 / log(10.0)) ** 2),
    ),
    Distribution("triangular", (0.0, 1.0, 4.0)): (5.0 / 3.0, sqrt((16.0 + 1.0 - 4.0) / 18.0)),
}


@pytest.mark.parametrize("distribution", MOMENTS, ids=lambda d: d.kind)
def test_samples_have_the_moments_of_their_distribution(distribution: Distribution) -> None:
    mean, deviation = MOMENTS[distribution]
    found = distribution.sample("m", 4000, 1)
    assert abs(statistics.mean(found) - mean) < 4.0 * deviation / sqrt(4000)  # four standard errors
    assert statistics.stdev(found) == pytest.approx(deviation, rel=0.08)
    assert found == distribution.sample("m", 4000, 1)
    assert found[0] != distribution.sample("m", 1, 2)[0] != distribution.sample("k", 1, 2)[0]


def test_a_grid_point_has_the_same_samples_as_another() -> None:
    axes = {"a": Values([1, 2]), "b": Distribution("normal", (0.0, 1.0))}
    plan = plan_of(axes, si, samples=3, seed=7)
    points = list(plan.points(0, len(plan)))
    assert [a for a, _ in points] == [1, 1, 1, 2, 2, 2]
    assert [b for _, b in points[:3]] == [b for _, b in points[3:]] == axes["b"].sample("b", 3, 7)  # type: ignore


def test_rows_are_those_of_single_runs(spring: lagc.CompiledModel) -> None:
    axes = {"k": [1.0, 9.0], "start(x)": ([50, 100], "cm")}
    found = spring.sweep(axes, keep=["final", "max", "min", "rms"], parameters={"m": 2.0}, **BRIEF)
    points = [(1.0, 0.5), (1.0, 1.0), (9.0, 0.5), (9.0, 1.0)]
    assert found.axes == ("k", "start(x)") and found.complete and found.counts == {"ok": 4}
    assert [*zip(found["k"], found["start(x)"])] == points
    for row, (k, x) in enumerate(points):
        run = spring.simulate(parameters={"m": 2.0, "k": k}, starts={"x": x}, **BRIEF)
        for name in ("x", "der(x)", "P"):
            assert found[name][row] == run[name][-1]
            assert found[f"max({name})"][row] == run[name].max()
            assert found[f"min({name})"][row] == run[name].min()
        # The trapezoidal rule over five parts of the motion x = x0 cos(w t).
        assert found["rms(x)"][row] == pytest.approx(sqrt((run["x"] ** 2).mean()), rel=0.1)
    assert found.units["max(P)"] == "W" and found.units["start(x)"] == "m"


def test_a_root_mean_square_is_that_of_the_closed_form(spring: lagc.CompiledModel) -> None:
    """Over a whole period the trapezoidal rule is exact for a cosine."""
    found = spring.sweep({"k": [4.0]}, keep="rms", rtol=1e-10, stop=3.141592653589793, points=33)
    assert found["rms(x)"][0] == pytest.approx(sqrt(0.5), rel=1e-8)


def test_failures_are_rows_with_code_and_reason(spring: lagc.CompiledModel) -> None:
    found = spring.sweep({"m": [0.1, 1.0], "k": [-1e6, 4.0]}, rtol=1e-8, stop=2)
    assert list(found["status"]) == ["refused", "refused", found["status"][2], "ok"]
    assert found["code"][0] == "LAG0602" and "below its minimum" in found["message"][0]
    assert found["x"][0] != found["x"][0] and found["code"][3] == ""
    assert found.common_reasons()[0][:2] == (2, "LAG0602")


@pytest.mark.parametrize(
    "axes, code",
    [({"q": [1]}, "LAG0601"), ({"start(q)": [1]}, "LAG0606"), ({"m": ([1], "s")}, "LAG0605"),
     ({"m": []}, "LAG0602"), ({"m": "normal(1, 2)"}, "LAG0602"),
     (dict.fromkeys(("m", "k", "start(x)"), "1:2:9999"), "LAG0804")],
)  # fmt: skip
def test_wrong_axes_are_refused(spring: lagc.CompiledModel, axes: dict[str, Any], code: str) -> None:
    with pytest.raises(Refused) as refused:
        spring.sweep(axes, rtol=1e-6)
    assert refused.value.code == code


def test_an_interrupted_sweep_goes_on_where_it_was(spring: lagc.CompiledModel, tmp_path: Path) -> None:
    journal, given = str(tmp_path / "sweep.part"), {"axes": {"k": "1:9:30"}, **BRIEF}
    calls: list[int] = []

    def stop(found: Any) -> None:
        calls.append(len(found) - found.counts.get("not run", 0))
        if calls[-1] > 3:
            raise KeyboardInterrupt

    from lagc.study.sweep import sweep

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "LOOK", 0.0)
        patch.setattr(sweep, "SECONDS", 1e-3)  # chunks of a few runs
        part = spring.sweep(**given, journal=journal, progress=stop)
    assert part.interrupted and 3 < len(part) - part.counts["not run"] < 30
    seen: list[int] = []
    whole = spring.sweep(
        **given, journal=journal, progress=lambda w: seen.append(w.counts.get("not run", 0)), executor=1
    )
    assert whole.complete and seen[0] <= part.counts["not run"]
    assert whole.rows.tobytes() == spring.sweep(**given).rows.tobytes()
    with pytest.raises(Refused) as refused:
        spring.sweep({"k": "1:9:31"}, **BRIEF, journal=journal)
    assert refused.value.code == "LAG0706"


def records(journal: Journal) -> list[tuple[int, bytes]]:
    return [(record.first, record.rows) for record in journal.records()]


def test_a_record_that_is_cut_off_is_not_read(tmp_path: Path) -> None:
    """After a kill at any byte, the records before are there, and new ones follow."""
    path, written = tmp_path / "sweep.part", [(0, b"12345678" * 4), (4, b"abcdefgh"), (5, b"\n" * 16)]
    journal, ends = Journal(str(path), "key"), [path.stat().st_size]
    for first, rows in written:
        journal.add(Record(first, rows, {0: ("LAG0620", "a reason")}))
        ends.append(path.stat().st_size)
    journal.close()
    whole = path.read_bytes()
    for size in range(0, len(whole) + 1, 7):
        path.write_bytes(whole[:size])
        journal = Journal(str(path), "key")
        kept = sum(end <= size for end in ends[1:])
        assert records(journal) == written[:kept]
        journal.add(Record(9, b"87654321", {}))
        assert records(journal) == [*written[:kept], (9, b"87654321")]
        journal.close()


def test_a_journal_is_that_of_one_sweep_and_one_process(tmp_path: Path) -> None:
    path = str(tmp_path / "sweep.part")
    journal = Journal(path, "one")
    if sys.platform != "win32":
        with pytest.raises(Refused, match="is running"):
            Journal(path, "one")
    journal.close()
    with pytest.raises(Refused, match="another sweep"):
        Journal(path, "two")


class Full:
    """A file on a disk with room for some more bytes."""

    def __init__(self, file: Any, room: int):
        self.file, self.room = file, room

    def write(self, data: bytes) -> int:
        if self.room <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        part = bytes(data)[: min(self.room, 7)]
        self.room -= len(part)
        return int(self.file.write(part))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.file, name)


def test_a_full_disk_loses_no_record(tmp_path: Path) -> None:
    path = str(tmp_path / "sweep.part")
    journal = Journal(path, "key")
    journal.add(Record(0, b"12345678", {}))
    own, journal.file = journal.file, Full(journal.file, 20)  # type: ignore[assignment]
    with pytest.raises(NotKept, match="No space left"):
        journal.add(Record(1, b"abcdefgh" * 9, {}))
    journal.file = own
    assert records(journal) == [(0, b"12345678")]
    journal.add(Record(1, b"abcdefgh", {}))
    assert records(journal) == [(0, b"12345678"), (1, b"abcdefgh")]
    journal.close()


def test_a_worker_with_another_version_is_refused(spring: lagc.CompiledModel) -> None:
    from lagc.study.sweep import worker

    own, versions = worker.version, iter(["a"] * 2)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "version", lambda: next(versions, own()))
        with pytest.raises(Refused) as refused, ThreadPoolExecutor(1) as pool:
            spring.sweep({"k": [1.0, 2.0]}, executor=pool, **BRIEF)
    assert refused.value.code == "LAG0626"


def test_the_command_writes_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "spring.lag").write_text(SPRING)
    (tmp_path / "points.csv").write_text("k, start(x) [cm]\n1, 50\n9, 100\n")
    words = [
        "sweep", str(tmp_path / "spring.lag"), "--table", str(tmp_path / "points.csv"), "--backend", "numpy",
    ]  # fmt: skip
    words += ["--rtol", "1e-6", "--stop", "0.1", "-o", str(tmp_path / "out.csv"), "--units", "--json"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["status"] == "ok" and told["counts"] == {"ok": 2}
    head, *rows = (tmp_path / "out.csv").read_text().splitlines()
    assert head.startswith("k [N/m],start(x) [m],x [m],der(x) [m/s],P [W],t [s],estimated,status")
    assert [row.split(",")[:2] for row in rows] == [["1.0", "0.5"], ["9.0", "1.0"]]
    assert not (tmp_path / "out.csv.part").exists()
    about = json.loads((tmp_path / "out.csv.json").read_text())
    assert about["model"] == "Spring" and about["options"]["rtol"] == 1e-6
    assert main([*words[:2], "m=0.1,1", *words[4:]]) == 3  # a failed run
    assert json.loads(capsys.readouterr().out)["reasons"][0][:2] == [1, "LAG0602"]


@pytest.mark.full
def test_tables_are_those_of_other_packages(spring: lagc.CompiledModel, tmp_path: Path) -> None:
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    found = spring.sweep({"k": [1.0, 4.0, 9.0], "m": [0.1, 1.0]}, **BRIEF)
    frame = found.frame
    assert len(frame) == 6 and list(frame.columns) == list(found.names)
    assert list(found.failed["m"]) == [0.1] * 3
    found.save(str(tmp_path / "a.parquet"))
    again = pandas.read_parquet(tmp_path / "a.parquet")
    assert again["x"].equals(frame["x"]) and list(again["status"]) == list(frame["status"])
    data = found.to_xarray()
    assert data["x"].dims == ("k", "m") and float(data["x"].sel(k=4.0, m=1.0)) == found["x"][3]
    found.save(str(tmp_path / "a.nc"))
    with xarray.open_dataset(tmp_path / "a.nc") as saved:
        assert saved["x"].attrs["units"] == "m" and str(saved["status"].sel(k=1.0, m=1.0).values) == "ok"
        assert saved["x"].equals(data["x"])
    table = spring.sweep(frame[["k", "m"]], zip=True, **BRIEF)
    assert table.rows.tobytes() == found.rows.tobytes()
    sampled = spring.sweep({"k": "normal(4, 0.1)"}, samples=4, seed=3, **BRIEF).to_xarray()
    assert sampled["x"].dims == ("sample",)


@pytest.fixture(scope="module")
def pendulum() -> lagc.CompiledModel:
    return lagc.load("double_pendulum").compile(backend="c")


# Smooth, damped, with events, with constraints that are searched, with contacts.
MODELS = ["double_pendulum", "driven_oscillator", "on_off_drive", "string_breaks", "bouncing_ball"]


@pytest.mark.full
@pytest.mark.parametrize("model", MODELS)
def test_runs_without_records_are_those_of_simulate(model: str) -> None:
    """The loop over C gives the bits of `simulate`, and leaves to it all that it does not do."""
    system = lagc.load(model).compile(backend="c")
    (field,) = [f for f in system.interface.parameters if f.value][:1]
    values = [field.value * part for part in (1.0, 1.01, 1.3)]
    for given in ({"rtol": 1e-8}, {"accuracy": 1e-5}):
        found = system.sweep({field.name: values}, keep=["final", "max"], stop=1, points=7, **given)
        for row, value in enumerate(values):
            run = system.simulate(1, points=7, parameters={field.name: value}, **given)
            assert found["status"][row] == run.status
            assert run.estimated is None or found["estimated"][row] == run.estimated
            assert {name: found[name][row] for name in run.columns} == run.final
            assert [found[f"max({name})"][row] for name in run.columns] == [
                max(run.column(name)) for name in run.columns
            ]


@pytest.mark.full
def test_runs_at_rest_and_large_angles_are_those_of_simulate() -> None:
    system = lagc.load("simple_pendulum").compile(backend="c")
    angles = [0.0, 1e-9, 3.141592653589793, 1e11, 1.0]
    found = system.sweep({"start(theta)": angles}, stop=2, accuracy=1e-8)
    for row, angle in enumerate(angles):
        run = system.simulate(2, points=13, accuracy=1e-8, starts={"theta": angle})
        assert (found["status"][row], found["estimated"][row]) == (run.status, run.estimated)
        assert found["theta"][row] == run.final["theta"]
    assert found["status"][3] == "failed" and "Leave out whole turns" in found["message"][3]


@pytest.mark.full
def test_runs_that_a_clause_ends_are_those_of_simulate() -> None:
    clause = 'when x < -0.5 [m] then terminate("far"); end when;'
    text = SPRING.replace("end Spring;", f"{clause} end Spring;")
    system = lagc.loads(text, "spring.lag").compile(backend="c")
    ks = [0.1, 1.0, 4.0]
    for points in (2, 7):
        found = system.sweep({"k": ks}, keep=["final", "max", "rms"], stop=3, points=points, rtol=1e-8)
        for row, k in enumerate(ks):
            run = system.simulate(3, points=points, parameters={"k": k}, rtol=1e-8)
            assert (found["status"][row], found["t"][row]) == (run.status, run.times[-1])
            assert found["message"][row] == ("" if run.status == "ok" else run.message)
            for name in run.columns:
                assert found[name][row] == run.final[name]
                assert found[f"max({name})"][row] == max(run.column(name))
    assert found.counts == {"ok": 1, "terminated": 2}


GIVEN: dict[str, Any] = {
    "axes": {"l1": "0.5:1.5:40", "m1": "1:2:25"}, "rtol": 1e-8, "stop": 5, "points": 21,
    "keep": ("final", "rms"),
}  # fmt: skip


@pytest.fixture(scope="module")
def rows(pendulum: lagc.CompiledModel) -> bytes:
    return bytes(pendulum.sweep(**GIVEN).rows.tobytes())


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks of some runs, and processes from the first of them on."""
    from lagc.study.sweep import sweep

    monkeypatch.setattr(sweep, "ALONE", 0.0)
    monkeypatch.setattr(sweep, "SECONDS", 0.02)
    monkeypatch.setattr(sweep, "LOOK", 0.01)


@pytest.mark.full
def test_processes_give_the_same_bits(pendulum: lagc.CompiledModel, rows: bytes, small: None) -> None:
    assert pendulum.sweep(**GIVEN, executor=2).rows.tobytes() == rows
    with ThreadPoolExecutor(2) as pool:
        assert pendulum.sweep(**GIVEN, executor=pool).rows.tobytes() == rows
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        assert pendulum.sweep(**GIVEN, executor=pool).rows.tobytes() == rows


@pytest.mark.full
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_killed_process_is_replaced(
    pendulum: lagc.CompiledModel, rows: bytes, small: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    started, killed = list[int](), list[int]()
    own = executors.Processes._started

    def noted(self: executors.Processes) -> Any:
        found = own(self)
        started.append(found.pid)
        return found

    def kill(found: Any) -> None:
        if found.counts.get("ok", 0) > 300 and not killed:
            killed.append(started[-1])
            os.kill(started[-1], signal.SIGKILL)

    monkeypatch.setattr(executors.Processes, "_started", noted)
    assert pendulum.sweep(**GIVEN, executor=2, progress=kill).rows.tobytes() == rows
    assert killed and len(started) == 3


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    alone = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.LocalCluster(**alone) as cluster, distributed.Client(cluster) as found:
        yield found


@pytest.mark.full
def test_a_cluster_that_loses_a_worker_gives_the_same_bits(
    pendulum: lagc.CompiledModel, rows: bytes, small: None, client: Any
) -> None:
    pids, killed = [*client.run(os.getpid).values()], list[int]()

    def kill(found: Any) -> None:
        if found.counts.get("ok", 0) > 300 and not killed:
            killed.append(pids[0])
            os.kill(pids[0], signal.SIGKILL)

    found = pendulum.sweep(**GIVEN, executor=client, progress=kill)
    assert found.rows.tobytes() == rows and killed


@pytest.mark.full
def test_a_cluster_of_another_version_is_refused(pendulum: lagc.CompiledModel, client: Any) -> None:
    def other() -> None:
        from lagc.study.sweep import worker

        worker.version = lambda: "0.0.1 (another)"

    client.run(other)
    try:
        with pytest.raises(Refused) as refused:
            pendulum.sweep(**GIVEN, executor=client)
        assert refused.value.code == "LAG0626" and "0.0.1" in str(refused.value)
    finally:
        client.restart()


# Processes and chunks as in a long sweep.
PROGRAM = """
import sys
from lagc.cli.program import program
from lagc.study.sweep import sweep
sweep.ALONE, sweep.SECONDS = 0.0, 0.02
sys.exit(program())
"""


def command(*words: str) -> list[str]:
    grid = ("l1=0.5:1.5:40", "m1=1:2:100", "--rtol", "1e-8", "--stop", "10")
    return [sys.executable, "-c", PROGRAM, "sweep", "double_pendulum", *grid, *words]


@pytest.mark.full
@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_after_kills_the_same_command_goes_on(pendulum: lagc.CompiledModel, tmp_path: Path) -> None:
    cache, part = tmp_path / "cache", tmp_path / "a.csv.part"
    around = {**os.environ, "PYTHONPATH": ROOT, "LAGC_CACHE": str(cache)}
    words = command("-o", "a.csv", "--workers", "2")

    def size() -> int:
        return part.stat().st_size if part.exists() else 0

    ended = []
    for number in (signal.SIGKILL, signal.SIGINT):
        child = subprocess.Popen(words, cwd=tmp_path, env=around, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)  # fmt: skip
        before, began = size(), time.monotonic()
        while size() < before + 20_000 and child.poll() is None and time.monotonic() < began + 60.0:
            time.sleep(0.002)
        child.send_signal(number)
        ended.append(child.wait(60))
    assert ended == [-signal.SIGKILL, 130] and size() > 40_000
    assert subprocess.run(words, cwd=tmp_path, env=around, check=False).returncode == 0
    assert not part.exists()
    whole = pendulum.sweep({"l1": "0.5:1.5:40", "m1": "1:2:100"}, rtol=1e-8, stop=10)
    whole.save(str(tmp_path / "b.csv"))
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert (tmp_path / "a.csv").read_bytes().count(b"\r\n") == 4001
    assert len(list(cache.iterdir())) < 40  # none for each run


@pytest.mark.full
@pytest.mark.skipif(sys.platform == "win32", reason="limits of files")
def test_on_a_full_disk_runs_are_kept(tmp_path: Path) -> None:
    import resource

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (160_000, 160_000))  # a library has 120 kB

    around = {**os.environ, "PYTHONPATH": ROOT}
    whole = subprocess.run(command("-o", "b.csv", "--workers", "1"), cwd=tmp_path, env=around, check=False)
    assert whole.returncode == 0
    words = command("-o", "a.csv", "--workers", "1")
    full = subprocess.run(words, cwd=tmp_path, env=around, check=False, preexec_fn=limited,
                          capture_output=True, text=True)  # fmt: skip
    assert full.returncode == 74 and "cannot be written" in full.stderr, full.stderr
    kept = (tmp_path / "a.csv.part").stat().st_size
    assert 0 < kept <= 160_000 and not (tmp_path / "a.csv").exists()
    assert subprocess.run(words, cwd=tmp_path, env=around, check=False).returncode == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
