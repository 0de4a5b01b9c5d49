"""Warnings of angles that look like degrees are about the values that run."""

import json
from pathlib import Path

import pytest

from lagc.cli.main import main

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
