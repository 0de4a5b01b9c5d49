"""`lagc linearize`: what it prints, writes and draws."""

import json
import os
import re
import subprocess
import sys
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from lagc.cli.main import main
from lagc.simulation.backends.compile import compiler

Capture = pytest.CaptureFixture[str]
pytestmark = pytest.mark.usefixtures("own_cache")


def test_equilibria_are_told_with_their_modes(capsys: Capture) -> None:
    assert main(["linearize", "simple_pendulum", "--scene", "vacuum", "--equilibrium"]) == 0
    shown = capsys.readouterr().out
    assert "1 of 2 found: an equilibrium; stable: energy is least there" in shown
    assert "2 of 2 found: an equilibrium; unstable" in shown
    frequency = sqrt(9.81 / 0.5) / (2 * pi)
    assert f"0 +- 4.42944692i      {frequency:.8g}" in shown and "theta 1" in shown


@pytest.mark.full
def test_of_many_eigenvalues_the_first_are_told(capsys: Capture) -> None:
    words = ["linearize", "chain", "-p", "n=20"]
    assert main(words) == 0
    few = capsys.readouterr().out
    assert main([*words, "-v"]) == 0
    everything = capsys.readouterr().out
    assert few.endswith("\n  and 8 more: --json or -v shows them\n") and "more:" not in everything
    told = [line for line in few.splitlines() if " +- " in line]
    assert len(told) == 12 and told == [line for line in everything.splitlines() if " +- " in line][:12]


@pytest.mark.full
def test_a_limit_of_time_ends_the_motion_to_it(capsys: Capture) -> None:
    words = ["--at", "1e9", "--max-time", "0.5", "--json"]
    assert main(["linearize", "simple_pendulum", *words]) == 4
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert fault["code"] == "LAG0801" and fault["message"].startswith("the run took longer than ")


def test_the_start_is_that_of_a_run(capsys: Capture) -> None:
    words = ["linearize", "simple_pendulum", "--scene", "vacuum", "--start", "theta=0", "-p", "l=1", "--json"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    (linear,) = found["linear"]
    assert found["status"] == "ok" and linear["equilibrium"] and linear["states"] == ["theta", "der(theta)"]
    assert linear["A"] == [[0.0, 1.0], [pytest.approx(-9.81), 0.0]]
    pair = linear["eigenvalues"]
    assert [value["imag"] for value in pair] == pytest.approx([sqrt(9.81), -sqrt(9.81)])
    assert pair[0]["frequency"] == pytest.approx(sqrt(9.81) / (2 * pi)) and pair[0]["damping"] == 0.0
    assert pair[0]["mode"]["theta"] == [1.0, 0.0] and list(linear["x"]) == linear["states"]


def test_about_a_motion(capsys: Capture) -> None:
    """The pendulum at 60 degrees falls: g/l cos theta all along its way."""
    assert main(["linearize", "simple_pendulum", "--scene", "vacuum", "--at", "300[ms]", "--json"]) == 0
    (linear,) = json.loads(capsys.readouterr().out)["linear"]
    assert linear["t"] == 0.3 and linear["momentary"] and linear["stability"] is None
    x = linear["x"]
    energy = 0.5 * x["der(theta)"] ** 2 * 0.25 - 9.81 * 0.5 * np.cos(x["theta"])
    assert energy == pytest.approx(-9.81 * 0.25, rel=1e-7)
    assert linear["A"][1][0] == pytest.approx(-9.81 / 0.5 * np.cos(x["theta"]))


@pytest.mark.full
@pytest.mark.skipif(compiler() is None, reason="no C compiler")
def test_a_long_motion_is_followed_in_c(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """5,000 periods; the cache keeps what was compiled for them."""
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    text = "model M coordinate Length x(start = 1); body b = Particle(mass = 1 [kg], at = {x, 0, 0});"
    (tmp_path / "m.lag").write_text(f"{text} potential V = 5e7 [N/m]*x^2; end M;")
    assert main(["linearize", str(tmp_path / "m.lag"), "--at", "3"]) == 0
    assert any(name.startswith("library") for name in os.listdir(tmp_path / "cache"))


@pytest.mark.full
def test_a_motion_that_takes_too_long_is_refused(tmp_path: Path, capsys: Capture) -> None:
    """As by `lagc sim`; 1e10 periods."""
    text = "model M coordinate Length x(start = 1); body b = Particle(mass = 1 [kg], at = {x, 0, 0});"
    (tmp_path / "m.lag").write_text(f"{text} potential V = 5e7 [N/m]*x^2; end M;")
    assert main(["linearize", str(tmp_path / "m.lag"), "--at", "6e6"]) == 4
    assert "LAG0803" in capsys.readouterr().err


def test_matrices_are_written(tmp_path: Path, capsys: Capture) -> None:
    words = ["linearize", "classic/driven_oscillator", "-q"]
    assert (
        main([*words, "-o", str(tmp_path / "a.npz")]) == main([*words, "-o", str(tmp_path / "a.json")]) == 0
    )
    arrays = np.load(tmp_path / "a.npz")
    written = json.loads((tmp_path / "a.json").read_text())["linear"][0]
    assert arrays["A"].tolist() == written["A"] == [[0.0, 1.0], [-4.0, -0.2]]
    assert arrays["B"].tolist() == [[0.0], [1.0]] and arrays["inputs"].tolist() == ["u"]
    assert arrays["eigenvalues"] == pytest.approx(np.roots([1.0, 0.2, 4.0]))


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("model", ["simple_pendulum", "classic/chain", "classic/spring_chain"])
def test_modes_are_drawn(model: str, tmp_path: Path, capsys: Capture) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / "modes.svg"
    assert main(["linearize", model, "--equilibrium", "--plot", str(path)]) == 0
    first = path.read_bytes()
    assert b"<svg" in first
    assert main(["linearize", model, "--equilibrium", "--plot", str(path)]) == 0
    assert path.read_bytes() == first


@pytest.mark.full
def test_where_there_is_none_it_says_so(capsys: Capture) -> None:
    assert main(["linearize", "classic/kepler", "--equilibrium"]) == 3
    assert "LAG0621" in capsys.readouterr().err
    assert main(["linearize", "classic/kepler", "--equilibrium", "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["status"] == "failed"


SINGULAR = """
model Root
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  force f = -sqrt((x - 1 [m])/(1 [m]))*1 [N]*world.x at b;
end Root;
"""


def test_a_slope_without_a_value_is_told(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "root.lag"
    path.write_text(SINGULAR)
    assert main(["linearize", str(path)]) == 3
    assert "no finite value" in capsys.readouterr().err


def test_an_output_without_a_slope_takes_its_own_line_alone(tmp_path: Path, capsys: Capture) -> None:
    """A norm at zero; what else there is has its numbers."""
    path = tmp_path / "norm.lag"
    path.write_text(
        "model Norm coordinate Length x(start = 2 [m]); body b = Particle(mass = 1 [kg], at = {x, 0, 0});"
        "potential s = (1/2*8 [N/m])*x^2; output Velocity v = norm(velocity(b)), u = der(x); end Norm;"
    )
    for words in ([], ["--equilibrium"]):
        assert main(["linearize", str(path), "--json", *words]) == 0
        found = json.loads(capsys.readouterr().out)
        (linear,) = found["linear"]
        assert linear["C"] == [[None, None], [0.0, 1.0]] and linear["A"] == [[0.0, 1.0], [-8.0, 0.0]]
        assert found["notes"] == ["the output `v` has no derivatives there"]


@pytest.mark.parametrize(
    "words",
    [["--at", "x"], ["--at", "1", "--equilibrium"], ["-o", "a.txt"], ["-o", "/no/such/a.json"],
     ["--start", "z=1"], ["-p", "z=1"], ["--plot", "a.txt"]],
)  # fmt: skip
def test_nonsense_is_wrong_usage(words: list[str], capsys: Capture) -> None:
    assert main(["linearize", "simple_pendulum", *words]) == 2
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.full
def test_drag_by_the_square_of_the_speed_has_a_slope_at_rest(capsys: Capture) -> None:
    """norm(v) v has the derivative 0 there, though that of norm has none."""
    assert main(["linearize", "simple_pendulum", "--scene", "room", "--equilibrium", "--json"]) == 0
    down = json.loads(capsys.readouterr().out)["linear"][0]
    assert down["A"] == [[0.0, 1.0], [pytest.approx(-9.81 / 0.5), 0.0]]


def test_a_bend_is_told(tmp_path: Path, capsys: Capture) -> None:
    text = """model M
      coordinate Length x(start = 0 [m]);
      body b = Particle(mass = 1 [kg], at = {x, 0, 0});
      force f = {-4 [N/m]*max(x, 0 [m]), 0, 0} at b;
    end M;"""
    file = tmp_path / "m.lag"
    file.write_text(text)
    assert main(["linearize", str(file)]) == 0
    assert "note: forces have a kink there" in capsys.readouterr().out
    kept = tmp_path / "m.json"
    assert main(["linearize", str(file), "--json", "-o", str(kept)]) == 0
    assert json.loads(kept.read_text()) == json.loads(capsys.readouterr().out)
    file.write_text(text.replace("-4 [N/m]*max(x, 0 [m])", "-4 [N]*sign(x)"))
    assert main(["linearize", str(file)]) == 3
    assert "forces are discontinuous there, where x passes 0" in capsys.readouterr().err


def test_a_motion_that_ends_before_is_not_linearised_behind_its_end(tmp_path: Path, capsys: Capture) -> None:
    path = tmp_path / "m.lag"
    path.write_text(
        "model M\n  coordinate Length x(rate = 1 [m/s]);\n"
        "  body b = Particle(mass = 1 [kg], at = {x, 0, 0});\n"
        '  when x > 0.25 [m] then terminate("there"); end when;\nend M;\n'
    )
    assert main(["linearize", str(path), "--at", "0.2"]) == 0
    capsys.readouterr()
    assert main(["linearize", str(path), "--at", "1"]) == 3
    assert "does not reach t = 1 s" in capsys.readouterr().err
    for at in ("-1", "nan", "inf"):
        assert main(["linearize", str(path), f"--at={at}"]) == 2
        assert "the time of a linear model" in capsys.readouterr().err


def test_a_motion_that_gets_nowhere_in_any_finite_time(tmp_path: Path, capsys: Capture) -> None:
    """It is not followed to see whether slopes change: a free body has none."""
    path = tmp_path / "m.lag"
    path.write_text(
        "model M\n  coordinate Length k(start = 2 [m], rate = 5e-324 [m/s]);\n"
        "  coordinate Orientation turned(start = {1, 2, 0, 0});\n"
        "  frame own = rotate(world, turned);\n"
        "  body b = Solid(frame = own, com = {k, 0, 0}, inertia = 0.5 [kg.m2]*{1, 1, 1}, mass = 1 [kg]);\n"
        "end M;\n"
    )
    assert main(["linearize", str(path), "--json"]) == 0
    (linear,) = json.loads(capsys.readouterr().out)["linear"]
    assert {abs(value["real"]) + abs(value["imag"]) for value in linear["eigenvalues"]} == {0.0}


@pytest.mark.full
def test_of_many_equilibria_of_large_models_some_are_shown(capsys: Capture) -> None:
    command = ["linearize", "classic/chain", "-p", "n=20", "--equilibrium"]
    assert main(command) == 0
    said = capsys.readouterr().out
    assert len(said.splitlines()) < 60 and re.search(r"\nand \d+ more: --json or -v shows them\n", said)
    assert said.count(" found: an equilibrium") == 3 and said.count("and 36 more: --json or -v") == 3
    assert main([*command, "-v"]) == 0
    assert len(capsys.readouterr().out.splitlines()) > 500


@pytest.mark.full
@pytest.mark.skipif(not os.path.exists("/dev/stdout"), reason="no name for the standard output")
def test_the_standard_output_takes_the_linear_model_and_nothing_else() -> None:
    command = [sys.executable, "-m", "lagc", "linearize", "simple_pendulum", "-o", "/dev/stdout"]
    for more in ([], ["--json"]):
        done = subprocess.run([*command, *more], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0 and len(json.loads(done.stdout)["linear"][0]["A"]) == 2
        assert "eigenvalue" in done.stderr
