"""What `lagc explain` says of models whose properties are known."""

import json
import re
from math import cos, sin
from pathlib import Path
from random import Random

import pytest

from lagc.cli.main import main
from lagc.lowering.lower_equations import optimize
from lagc.reports.explain import Facts, explanation, text
from tests.reports.models import MODELS, derived, equations_of


def facts(name: str, scene: str | None = None) -> Facts:
    equations = derived(name, scene)
    return explanation(equations, optimize(equations))


def test_pendulum_on_a_string() -> None:
    found = facts("course/string_pendulum")
    assert found["count"] == {
        "coordinates": 2, "speeds": 2, "rows": 1, "unknowns": 3, "equations": 3, "dropped": 0,
    }  # fmt: skip
    assert found["degrees_of_freedom"] == 1
    (string,) = found["constraints"]
    assert (string["kind"], string["time"]) == ("holonomic", "scleronomic")
    assert "energy" in [c["name"] for c in found["conserved"]]


def test_rolling_disc_has_more_configurations_than_velocities() -> None:
    """6 coordinates, the contact, 2 rows of rolling: 3 degrees of freedom, configurations of 5."""
    found = facts("classic/rolling_disc")
    assert [c["kind"] for c in found["constraints"]] == ["holonomic", "non-holonomic", "non-holonomic"]
    assert not any(c["integrable"] for c in found["constraints"])
    assert (found["degrees_of_freedom"], found["positional_freedom"]) == (3, 5)


def test_heavy_top_is_cyclic_in_precession_and_spin() -> None:
    found = facts("classic/heavy_top")
    assert found["cyclic"] == ["phi", "psi"]
    assert {"energy", "momentum(phi)", "momentum(psi)"} <= {c["name"] for c in found["conserved"]}


@pytest.mark.full
def test_drag_ends_the_conservation_of_energy() -> None:
    assert "energy" in [c["name"] for c in facts("course/simple_pendulum", "vacuum")["conserved"]]
    room = facts("course/simple_pendulum", "room")
    assert room["conserved"] == []
    assert [e["name"] for e in room["effects"]["used"]] == ["gravity", "air"]


def test_what_is_left_out_is_said() -> None:
    vacuum = facts("course/simple_pendulum", "vacuum")
    assert [e["name"] for e in vacuum["effects"]["left_out"]] == ["air"]
    assert any("air" in line for line in vacuum["pruned"])


def test_moving_rail_makes_terms_of_lower_degree() -> None:
    """K = 1/2 m (x' + ...)^2 of a driven system has parts of degree 1 and 0 in the speeds."""
    kinetic = facts("classic/kapitza_pendulum")["kinetic"]
    assert kinetic["K2"] == "m*l^2*theta'^2/2"
    assert kinetic["K1"] != "0" and kinetic["K0"] != "0"


def test_operations_are_those_of_the_program() -> None:
    equations = derived("classic/double_pendulum")
    program = optimize(equations)
    found = explanation(equations, program)
    assert found["operations"]["right_hand_side"] == program.interface.operations
    assert found["operations"]["functions"]["rhs"] == program.functions["rhs"].cost


@pytest.mark.sample(0, 6)
@pytest.mark.parametrize("path", sorted(MODELS.rglob("*.lag")), ids=lambda p: p.stem)
def test_every_model_is_explained(path: Path) -> None:
    name = str(path.relative_to(MODELS).with_suffix(""))
    found = facts(name)
    json.dumps(found, allow_nan=False)
    assert found["count"]["unknowns"] == found["count"]["equations"]
    assert found["model"] in text(found)
    assert "None" not in text(found, verbose=True)


def test_the_command_prints_text_and_json(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(MODELS / "course" / "simple_pendulum.lag")
    assert main(["explain", path, "--scene", "room"]) == 0
    assert "degrees of freedom: 1" in capsys.readouterr().out
    assert main(["explain", path, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "ok"
    assert main(["equations", path, "--json", "--format", "latex"]) == 0
    assert json.loads(capsys.readouterr().out)["format"] == "latex"


THREE_CRANKS = """
model ThreeCranks "A plate on three equal parallel cranks"
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Length x(start = 0.6 [m]), y(start = 0.8 [m]);
  coordinate Angle turn;
  frame F = rotate_z(world, turn);
  body plate = Solid(mass = m, inertia = m*l^2*{1/8, 1/8, 1/4}, frame = F, com = {x, y, 0});
  point a = {x, y, 0} + l*(F.x/2 - F.y/3);
  point b = {x, y, 0} - l*F.x;
  point c = {x, y, 0} + l*(F.y - F.x/4);
  constraint first: norm(a - l*{1/2, -1/3, 0}) = l;
  constraint second: norm(b - l*{-1, 0, 0}) = l;
  constraint third: norm(c - l*{-1/4, 1, 0}) = l;
end ThreeCranks;
"""


@pytest.mark.full
def test_what_is_not_proved_seems_so() -> None:
    """The third crank follows from the two others where all hold, and nowhere else."""
    equations = equations_of(THREE_CRANKS)
    found = explanation(equations, optimize(equations))
    assert (found["degrees_of_freedom"], found["redundant"]) == (1, ["third"])
    assert found["seems"] == {
        "cyclic": [], "redundant": ["third"], "degrees_of_freedom": True, "positional_freedom": True,
    }  # fmt: skip
    written = text(found)
    assert "degrees of freedom: 1, it seems from states on the constraints" in written
    assert "redundant rows, it seems: third" in written
    proved = {c["name"]: c["proved"] for c in found["conserved"]}
    assert proved == {"energy": True, "angular_momentum().z": False}
    assert "angular_momentum().z = " in written and ", it seems: no net torque" in written


def test_what_is_proved_is_told_plainly() -> None:
    assert "seems" not in text(facts("classic/rolling_disc"))


def test_what_is_dropped_is_named_and_counted_apart() -> None:
    """Neither the coordinates on which nothing depends nor their speeds are degrees of freedom."""
    model = """
model Idle
  coordinate Length x, spare, gone;
  coordinate Orientation turn;
  body p = Particle(mass = 1, at = {x, 0, 0});
end Idle;
"""
    equations = equations_of(model)
    found = explanation(equations, optimize(equations))
    assert found["dropped"] == ["spare", "gone", "turn"]
    assert found["count"] == {
        "coordinates": 1, "speeds": 1, "rows": 0, "unknowns": 1, "equations": 1, "dropped": 3,
    }  # fmt: skip
    assert found["degrees_of_freedom"] == found["positional_freedom"] == 1
    assert "dropped, as nothing depends on them: spare, gone, turn" in text(found)


@pytest.mark.full
def test_long_expressions_are_written_by_their_rule_or_whole(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "classic/chain", "-p", "n=30"]) == 0
    said = capsys.readouterr().out
    assert "V = -sum(k = 1..30, (31 - k)*m*l*g*cos(th[k]))" in said
    assert "s1[i] = cos(th[i])*th[i]' + s1[i - 1]    for i = 3..30" in said
    assert "energy = K2 + V, since nothing brings power" in said
    assert main(["explain", "classic/chain", "-p", "n=30", "-v"]) == 0
    said = capsys.readouterr().out
    assert "parts)" not in said and "energy = K2" not in said
    assert main(["explain", "classic/chain", "-p", "n=30", "--json"]) == 0
    whole = json.loads(capsys.readouterr().out)
    chance = Random(30)
    at = {(name, k): chance.uniform(-1, 1) for name in ("th", "rate") for k in range(1, 31)}

    def value(text: str) -> float:
        code = re.sub(r"th\[(\d+)\]'", r"at['rate', \1]", text)
        code = re.sub(r"th\[(\d+)\]", r"at['th', \1]", code).replace("^", "**")
        return float(eval(code, {"at": at, "sin": sin, "cos": cos, "m": 0.7, "l": 0.3, "g": 9.81}))

    x = y = kinetic = potential = 0.0
    for k in range(1, 31):
        x += 0.3 * cos(at["th", k]) * at["rate", k]
        y += 0.3 * sin(at["th", k]) * at["rate", k]
        kinetic += 0.35 * (x * x + y * y)
        potential -= 0.7 * 9.81 * 0.3 * (31 - k) * cos(at["th", k])
    assert value(whole["kinetic"]["K2"]) == pytest.approx(kinetic)
    assert value(whole["potential"]) == pytest.approx(potential)
    assert value(whole["conserved"][0]["expression"]) == pytest.approx(kinetic + potential)


def test_actions_tell_their_generalized_forces() -> None:
    equations = derived("course/wheel_explicit")
    facts = explanation(equations, optimize(equations, work=False))
    found = {action["name"]: action["generalized_forces"] for action in facts["actions"]}
    assert found == {"field": {"der(y)": "-m*g"}, "P": {"der(x)": "-k*x"}, "drive": {"der(theta)": "C"}}
    assert facts["actions"][1]["virtual_power"] == "(-k*x)*virtual(der(x))"
