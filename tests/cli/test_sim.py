"""`lagc sim`: options, JSON, files, exit codes, and a line for every broken input."""

import csv
import io
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from lagc.cli.main import main
from lagc.cli.summary import value_text

pytestmark = pytest.mark.usefixtures("own_cache")
PENDULUM = "simple_pendulum"
COURSE = Path(__file__).parents[2] / "models" / "course"
FALLING = """\
model Falling
  parameter Mass m;
  parameter Length h(min = 1 [m], max = 100 [m]) = 20 [m];
  coordinate Length z(start = h);
  body b = Particle(mass = m, at = {0, 0, z});
  effect gravity Gravity field; end gravity;
  scene earth uses gravity simulate(stop = 1 [s]); end earth;
  output Length height = z;
end Falling;
"""


@pytest.fixture
def falling(tmp_path: Path) -> str:
    path = tmp_path / "falling.lag"
    path.write_text(FALLING)
    return str(path)


def test_outputs_are_among_what_is_shown_of_many(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "chain", "-p", "n=10", "--stop", "0.01", "--backend", "numpy"]) == 0
    printed = capsys.readouterr().out
    assert "th[1]" in printed and " E " in printed and "more: --json or -v" in printed


def sim(*words: str) -> int:
    return main(["sim", *words, "--backend", "numpy"])


def test_the_json_of_a_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert sim(PENDULUM, "--json", "--scene", "room", "--accuracy", "1e-8") == 0
    found = json.loads(capsys.readouterr().out)
    assert list(found) == [
        "status", "message", "model", "scene", "effects", "backend", "method", "t", "final", "events",
        "accuracy", "errors", "scales", "drift", "energy", "cost", "warnings", "dropped",
        "open_reactions", "notes",
    ]  # fmt: skip
    assert (found["status"], found["model"], found["scene"]) == ("ok", "SimplePendulum", "room")
    assert found["effects"] == ["gravity", "air"]
    assert (found["backend"], found["method"], found["t"]) == ("numpy", "dop853", 10.0)
    assert set(found["final"]) == {"theta", "der(theta)", "E"}
    assert found["accuracy"]["asked"] == 1e-8 >= found["accuracy"]["estimated"] > 0.0
    energy = found["energy"]
    assert energy["work"] < 0.0  # the drag takes energy out
    assert energy["imbalance"] == energy["end"] - energy["start"] - energy["work"]
    assert abs(energy["imbalance"]) < 1e-6 * abs(energy["start"])
    kinds = "steps rejected rhs alone operations compile_s run_s start_s"
    assert set(found["cost"]) == set(kinds.split())
    assert 0.0 < found["cost"]["start_s"] < found["cost"]["run_s"]


def test_a_fall_takes_the_time_that_galilei_says(falling: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        sim(falling, "--json", "-p", "m=2[t]", "-p", "h=30[m]", "--start", "der(z)=-3[m/s]", "--stop", "1.5")
        == 0
    )
    found = json.loads(capsys.readouterr().out)
    assert found["final"]["height"] == pytest.approx(30.0 - 3.0 * 1.5 - 0.5 * 9.81 * 1.5**2, rel=1e-6)


def test_the_summary_tells_scene_accuracy_energy_and_cost(capsys: pytest.CaptureFixture[str]) -> None:
    assert sim(PENDULUM) == 0
    shown = capsys.readouterr().out
    assert len(shown.splitlines()) <= 14
    for word in ("SimplePendulum", "scene vacuum", "first of the file", "theta", "deg", "accuracy",
                 "estimated", "energy", "imbalance", "right-hand sides", "numpy"):  # fmt: skip
        assert word in shown


def test_the_summary_gives_the_time_of_a_long_initialization(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for least, told in ((60.0, False), (0.0, True)):
        monkeypatch.setattr("lagc.cli.summary.REPORTED", least)
        assert sim(PENDULUM) == 0
        assert ("of it for the initialization" in " ".join(capsys.readouterr().out.split())) is told


def test_quiet_prints_the_final_values_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert sim(PENDULUM, "-q") == 0
    captured = capsys.readouterr()
    assert len(captured.out.splitlines()) == 3 and captured.err == ""


def test_a_csv_file_holds_the_grid_with_every_digit(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    assert sim(PENDULUM, "-q", "--every", "0.25", "--stop", "1", "-o", str(path)) == 0
    text = path.read_bytes().decode()
    assert text.count("\r\n") == text.count("\n") == 6
    rows = list(csv.reader(io.StringIO(text)))
    assert rows[0] == ["time", "theta", "der(theta)", "E"]
    assert [float(row[0]) for row in rows[1:]] == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert float(rows[1][1]) == math.radians(60)
    assert all(repr(float(cell)) == cell for row in rows[1:] for cell in row)
    about = json.loads((tmp_path / "run.csv.json").read_text())
    assert about["units"]["theta"] == "rad" and about["model"] == "SimplePendulum" and about["rtol"] > 0.0


def test_a_csv_file_has_units_in_its_header_on_request(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    assert sim(PENDULUM, "-q", "--units", "-o", str(path)) == 0
    header = path.read_text().splitlines()[0]
    assert header == "time [s],theta [rad],der(theta) [rad/s],E [J]"


def test_an_npz_file_holds_columns_and_metadata(tmp_path: Path) -> None:
    numpy = pytest.importorskip("numpy")
    path = tmp_path / "run.npz"
    assert sim(PENDULUM, "-q", "--points", "11", "-o", str(path)) == 0
    with numpy.load(path) as found:
        assert found["time"].shape == found["theta"].shape == (11,)
        assert json.loads(str(found["metadata"]))["scene"] == "vacuum"


@pytest.mark.full
def test_a_parquet_file_reads_back(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "run.parquet"
    assert sim(PENDULUM, "-q", "--points", "11", "-o", str(path)) == 0
    table = parquet.read_table(path)
    assert table.column_names == ["time", "theta", "der(theta)", "E"]
    assert table.schema.field("theta").metadata[b"unit"] == b"rad"


def test_a_model_is_read_from_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    class Stdin:
        buffer = io.BytesIO(FALLING.encode())

    monkeypatch.setattr(sys, "stdin", Stdin())
    assert sim("-", "-q", "-p", "m=1") == 0


def test_a_failed_run_keeps_and_writes_what_was_computed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "pull.lag"
    model.write_text(
        "model Pull\n  parameter Mass m = 1 [kg];\n  coordinate Length x(start = 1 [m]);\n"
        "  body b = Particle(mass = m, at = {x, 0, 0});\n"
        "  potential V = -0.5 [J.m2]/x^2;\nend Pull;\n"
    )  # x = sqrt(1 - t^2): the sun is reached at t = 1
    out = tmp_path / "out.csv"
    assert sim(str(model), "--stop", "2", "--json", "-o", str(out)) == 3
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "failed"
    assert 0.9 < found["t"] <= 1.0
    assert len(out.read_text().splitlines()) > 100
    assert sim(str(model), "--stop", "2", "--every", "0.3") == 3
    said = re.search(r"last recorded state, at t = (\S+) s\s+x += (\S+) m\n", capsys.readouterr().out)
    assert said is not None
    assert float(said[1]) ** 2 + float(said[2]) ** 2 == pytest.approx(1.0, rel=1e-5)


@pytest.mark.full
def test_where_sensitivities_alone_fail_the_end_is_the_last_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "wall.lag"
    model.write_text(
        "model Wall\n  parameter Real n = 12;\n  coordinate Length x(start = 1 [m], rate = -1 [m/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        "  potential wall = 1 [J]*(0.001 [m]/x)^n;\nend Wall;\n"
    )
    assert sim(str(model), "--stop", "3", "--sensitivity", "n") == 3
    printed = capsys.readouterr().out
    assert "reached t = 3 s; sensitivities: their accuracy" in printed
    assert "last recorded" not in printed


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize(
    "words, code, said",
    [
        ([], 2, "FILE"),
        (["nofile.lag"], 2, "nofile.lag"),
        (["simple_pendulm"], 2, "did you mean the library model `simple_pendulum`"),
        ([str(COURSE / "simple_pendulum")], 2, "simple_pendulum.lag`?"),
        (["simple_pendulm.lag"], 2, "no model of that name in the library"),
        (["course/simple_pendulm"], 2, "did you mean the library model `course/simple_pendulum`"),
        ([f"{COURSE}/simple_pendulm.lag"], 2, "course/simple_pendulum.lag`?"),
        ([PENDULUM, "--plot", "x.jpg"], 2, "there are .png .svg .pdf"),
        ([PENDULUM, "-o", "x.h5"], 2, "one of .csv .npz .parquet"),
        (["."], 2, "cannot be read"),
        ([PENDULUM, "-p", "zz=1"], 2, "`zz`"),
        ([PENDULUM, "-p", "L=1"], 2, "did you mean `l`"),
        ([PENDULUM, "-p", "l=-1"], 2, "below its minimum"),
        ([PENDULUM, "-p", "l=nan"], 2, "finite"),
        ([PENDULUM, "-p", "l=1e999"], 2, "finite"),
        ([PENDULUM, "-p", "l=70[kg]"], 2, "cannot be converted"),
        ([PENDULUM, "-p", "l=70[cmm]"], 2, "not a unit"),
        ([PENDULUM, "-p", "l"], 2, "name=value"),
        ([PENDULUM, "--start", "thet=1"], 2, "did you mean `theta`"),
        ([PENDULUM, "--start", "theta=30[m]"], 2, "cannot be converted"),
        ([PENDULUM, "--start", "theta=inf"], 2, "finite"),
        ([PENDULUM, "--stop", "abc"], 2, "not a number"),
        ([PENDULUM, "--stop", "-1"], 2, "stop"),
        ([PENDULUM, "--stop", "5[kg]"], 2, "cannot be converted"),
        ([PENDULUM, "--accuracy", "0"], 2, "accuracy"),
        ([PENDULUM, "--accuracy", "1e-6", "--rtol", "1e-6"], 2, "accuracy"),
        ([PENDULUM, "--accuracy", "1e-20"], 3, "double precision"),
        ([PENDULUM, "--rtol", "0"], 2, "positive"),
        ([PENDULUM, "--rtol", "1e-300"], 2, "the limit of double precision"),
        ([PENDULUM, "--method", "euler"], 2, "euler"),
        ([PENDULUM, "--step", "0"], 2, "step"),
        ([PENDULUM, "--points", "1.5"], 2, "whole number"),
        ([PENDULUM, "--every", "1e-20"], 2, "points"),
        ([PENDULUM, "--scene", "rom"], 2, "`rom`"),
        ([PENDULUM, "--with", "wind"], 2, "`wind`"),
        ([PENDULUM, "--without", "wind"], 2, "`wind`"),
        ([PENDULUM, "-o", "x.xyz"], 2, "the ending gives the format"),
        ([PENDULUM, "-o", "/no/such/folder/x.csv"], 2, "no folder"),
        ([PENDULUM, "--plot", "x.xyz"], 2, "the ending says the format"),
        ([PENDULUM, "--nonsense"], 2, "--nonsense"),
        ([PENDULUM, "--stop=--"], 2, "`--` is not a value"),
        ([PENDULUM, "--plot=--"], 2, "`--` is not a value"),
        ([PENDULUM, "-o=--"], 2, "`--` is not a value"),
        ([PENDULUM, "another"], 2, "another"),
    ],
)
def test_broken_input_brings_one_line_and_an_exit_code(
    words: list[str], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sim", *words, "--backend", "numpy"] if words else ["sim"]) == code
    captured = capsys.readouterr()
    assert said in captured.err and "Traceback" not in captured.err
    assert len(captured.err.strip().splitlines()) <= 2  # a fault, and its remedy


def test_a_parameter_without_a_value_is_asked_for(falling: str, capsys: pytest.CaptureFixture[str]) -> None:
    # the mass cancels out of a free fall, but not out of the energies that are balanced
    assert sim(falling) == 2
    assert "`m`" in capsys.readouterr().err


def test_a_refused_model_exits_1_with_its_place(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "wrong.lag"
    path.write_text(FALLING.replace("z(start", "zz(start"))
    assert sim(str(path)) == 1
    assert "wrong.lag:" in capsys.readouterr().err
    assert sim(str(path), "--json") == 1
    found = json.loads(capsys.readouterr().out)
    assert found["status"] == "refused" and found["faults"][0]["code"].startswith("LAG0")


@pytest.mark.sample(1)
@pytest.mark.parametrize("heavy", ["lark", "numpy", "sympy", "lagc.syntax.parse", "lagc.semantics.resolve"])
def test_a_second_run_loads_no_stage_of_the_compiler(heavy: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert sim(PENDULUM, "-q") == 0
    program = (
        "import sys; from lagc.cli.main import main; "
        f"code = main(['sim', '{PENDULUM}', '-q', '--backend', 'numpy']); "
        f"sys.exit(code or {heavy!r} in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(("idle", "said"), [
    ("spare", "spare: nothing asked for depends on it\n"),
    ("spare, gone", "spare, gone: nothing asked for depends on them\n"),
])  # fmt: skip
def test_what_is_dropped_is_said(
    idle: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "idle.lag"
    path.write_text(FALLING.replace("coordinate Length z", f"coordinate Angle {idle}; coordinate Length z"))
    assert sim(str(path), "-p", "m=1", "--stop", "0.1") == 0
    assert said in capsys.readouterr().out


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.12345678901234567, 3e-13, "0.1234567890123 +- 3e-13"),
        (0.12345678901234567, 3e-7, "0.123456789 +- 3e-07"),
        (0.0, 1e-12, "0 +- 1e-12"),
        (1.5e-14, 1e-11, "1.5e-14 +- 1e-11"),
        (2.0 / 3.0, 1e-30, "0.66666666666666663 +- 1e-30"),
        (2.0 / 3.0, math.inf, "0.666666667 +- inf"),
    ],
)
def test_a_final_value_has_the_digits_that_its_error_leaves(value: float, error: float, text: str) -> None:
    assert value_text(value, "", error) == text
