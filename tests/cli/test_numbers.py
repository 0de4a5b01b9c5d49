"""Warnings of angles that look like degrees are about the values that run. Numbers at the ends of what a
double holds bring an answer or a fault, wherever a command takes one."""

import json
from pathlib import Path

import pytest

from lagc.cli.main import main

pytestmark = pytest.mark.usefixtures("own_cache")

MODEL = """model Lamp
  parameter Angle alpha = 30;
  parameter Real n = 1;
  input Angle w = 20;
  coordinate Angle theta(start = 40);
  body b = Particle(mass = 1, at = {sin(theta + alpha)*n*1 [m], 0, cos(theta)*1 [m]});
  force f = w*1 [N]*world.x at b;
end Lamp;
"""


@pytest.mark.parametrize(
    "given, radians",
    [
        ("", {"alpha": 30, "w": 20, "theta": 40}),
        ("-p alpha=45 -p n=20", {"alpha": 45, "w": 20, "theta": 40}),
        ("-p alpha=45[deg] --input w=1", {"theta": 40}),
        ("-p alpha=1 --input w=-50", {"w": -50, "theta": 40}),
        ("-p alpha=45[rad] --input w=20*time/1[s] --start theta=-30", {"theta": -30}),
        ("--start theta=30[deg] --start der(theta)=30", {"alpha": 30, "w": 20}),
    ],
)
def test_given_values_are_looked_at(
    given: str, radians: dict[str, int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "lamp.lag"
    path.write_text(MODEL)
    wanted = {f"`{name}` is {value} radians" for name, value in radians.items()}

    stop = " --stop 0.01 --backend numpy"
    assert main(["sim", str(path), "--json", *(given + stop).split()]) == 0
    warnings = [w for w in json.loads(capsys.readouterr().out)["warnings"] if w.startswith("LAG0618")]
    assert {w.removeprefix("LAG0618: ").split(" (")[0].split(";")[0] for w in warnings} == wanted
    if "--start" not in given:
        assert main(["check", str(path), "--json", *given.replace("--input", "-p").split()]) == 0
        faults = [
            f["message"] for f in json.loads(capsys.readouterr().out)["faults"] if f["code"] == "LAG0618"
        ]
        assert set(faults) == wanted and len(faults) == len(wanted)


@pytest.mark.parametrize(
    "given, warned", [("", 1), ("-p w=50[rad/s]", 0), ("-p w=2[kHz]", 1), ("-p w=300[rpm]", 0)]
)
def test_given_angular_velocities_are_looked_at(
    given: str, warned: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "lamp.lag"
    text = MODEL.replace("input Angle w = 20", "parameter AngularVelocity w = 50 [Hz]")
    path.write_text(text.replace("w*1 [N]", "w*1 [N.s]"))
    assert main(["check", str(path), "--json", *given.split()]) == 0
    codes = [f["code"] for f in json.loads(capsys.readouterr().out)["faults"]]
    assert codes.count("LAG0619") == warned


VALUES = (
    "1e300", "-1e300", "1e308", "1e18", "1e-300", "5e-324", "0", "-0.0", "-1", "nan", "inf", "1e999", "0.5",
    "1e7",
)  # fmt: skip
STRUCTURAL = """model S
  structural Integer n = 3;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Length x[n](each start = 0.1);
  for i in 1:n loop
    body b[i] = Particle(mass = m, at = {x[i], 0, 0});
  end for;
end S;
"""
CONSTANTS = """model S
  structural Integer n = 3;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle x(start = log(n - 2), rate = 1/n*1[1/s]);
  body b = Particle(mass = m, at = {x*l, x*l*n, exp(x*n)*l});
  potential V = exp(n*x)*1 [J] + 1 [J]*floor(n)/n + 1 [J]*(x + 1)^(if n > 5 then n else 2);
end S;
"""
START = """model S
  parameter Real n = 1;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Length x(start = l/n), y(start = log(n)*l);
  body b = Particle(mass = m, at = {x, y, 0});
  constraint c: x^2 + y^2 = l^2*n;
  potential V = 1 [J]*log(n + x/l) + 9.81 [m/s2]*m*y;
initial
  x = l*log(n)/3;
end S;
"""


@pytest.mark.sample(1, 8)
@pytest.mark.parametrize("text", [STRUCTURAL, CONSTANTS, START], ids=["sizes", "constants", "start"])
@pytest.mark.parametrize("value", VALUES)
def test_parameters(text: str, value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "s.lag"
    path.write_text(text)
    for name in "nml":
        for command in ("equations", "explain", "build", "sim", "linearize"):
            more = {"build": ["-o", str(tmp_path)], "sim": ["--backend", "numpy", "--stop", "1e-3"]}
            code = main([command, str(path), "-p", f"{name}={value}", *more.get(command, [])])
            assert code in (0, 1, 2, 3), (command, name, capsys.readouterr().err)
            assert code != 2 or name != "n" or "LAG" in capsys.readouterr().err


@pytest.mark.sample(3)
@pytest.mark.parametrize("value", VALUES)
def test_options(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    sim = ["sim", "simple_pendulum", "--backend", "numpy"]
    for option in ("--every", "--points", "--accuracy", "--rtol", "--atol", "--step", "--stop"):
        if option in ("--step", "--stop") and value in ("1e300", "1e308", "1e18", "1e7", "1e-300", "5e-324"):
            continue  # what would take its time
        assert main([*sim, f"{option}={value}"]) in (0, 2, 3), (option, capsys.readouterr().err)
    for start in ("theta", "der(theta)"):
        if float(value) < 1e6:
            code = main([*sim, "--stop", "1e-3", "--start", f"{start}={value}"])
            assert code in (0, 1, 2, 3), (start, capsys.readouterr().err)
