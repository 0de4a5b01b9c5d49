"""What nothing asked for depends on is left out, and the rest moves as it did."""

import json
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.compiler import pipeline
from lagc.diagnostics.faults import Refused

TWO = """model Two
  parameter Mass m = 2 [kg];
  coordinate Length x(rate = 10 [m/s]), z, s(start = 0.1 [m]);
  coordinate Angle th(start = 60 [deg]);
  coordinate Orientation o(rate = {1, 0.1, 2} [rad/s]);
  frame F = rotate(world, o);
  body ball = Particle(mass = 0.1 [kg], at = {x, 0, z});
  body bob = Particle(mass = 1 [kg], at = 1 [m]*{sin(th), 0, -cos(th)});
  body slave = Particle(mass = m, at = {0, s, 0});
  body top = Solid(mass = 1 [kg], inertia = {1, 2, 3} [kg.m2], frame = F, com = {0, 0, 0} [m]);
  potential spring = 1/2*10 [N/m]*s^2;
  force drag = {0, 3 [N/m]*x, 0} at slave;
  force wind = {0.1 [N]*sin(time/1 [s]), 0, 0} at ball;
  Gravity field;
  EVENTS
  output Energy E = energy();
  output Length height = -1 [m]*cos(th);
  output Length twice = 2*s;
  output Acceleration pull = der(der(x));
  output Real spin = dot(F.x, world.z);
  scene all
    simulate(stop = 2 [s]);
  end all;
end Two;
"""
REINIT = """when s > 0.8 [m] then reinit(der(s), -der(s)); end when;
  discrete Real mode(start = 1);
  when z < -1 [m] then reinit(mode, -1); end when;
  force change = {0, 0, mode*1 [N]} at ball;"""
TOUCH = """coordinate Length a(start = 1 [m]), b;
  body link = Particle(mass = 1 [kg], at = {a, 0, b});
  constraint rod: a^2 + b^2 = 1 [m2];
  constraint table: z >= -3 [m] (restitution = 0.5);
  output Force held = reaction(rod)*2 [m];"""
KEPT = {
    "E": {"x", "z", "s", "th", "o"}, "height": {"th"}, "th": {"th"}, "twice": {"s", "x"}, "s": {"s", "x"},
    "pull": {"x"}, "der(x)": {"x"}, "z": {"z"}, "spin": {"o"}, "o": {"o"},
}  # fmt: skip


def _kept(system: lagc.CompiledModel) -> set[str]:
    return {name.partition(".")[0] for name in system.interface.q_names}


@pytest.mark.parametrize("asked", KEPT)
def test_what_stays_is_what_is_asked_for_and_what_acts_on_it(asked: str) -> None:
    model = lagc.loads(TWO.replace("EVENTS", REINIT))
    system = model.compile(outputs=asked, backend="numpy")
    assert _kept(system) == KEPT[asked]
    outputs = [output.name for output in system.interface.outputs]
    assert outputs == ([asked] if asked in ("E", "height", "twice", "pull", "spin") else [])
    assert [d.name for d in system.interface.discretes] == (["mode"] if asked in ("z", "E") else [])
    if asked != "E":
        assert ("m" in [p.name for p in system.interface.parameters]) == (asked in ("twice", "s"))


@pytest.mark.full
@pytest.mark.parametrize("events", [REINIT, TOUCH], ids=["reinit", "touch"])
def test_what_stays_moves_as_it_did(events: str) -> None:
    model = lagc.loads(TWO.replace("EVENTS", events))
    names = ["height", "twice", "pull", "spin", "z", *(["held"] if events == TOUCH else [])]
    full = model.compile(backend="numpy").simulate(accuracy=1e-9, points=21)
    for name in names:
        system = model.compile(outputs=[name], backend="numpy")
        run = system.simulate(accuracy=1e-9, points=21)
        assert run.status == "ok" and len(system.interface.q_names) < len(full.system.interface.q_names)
        assert run[name] == pytest.approx(full[name], rel=1e-7, abs=1e-7)
        assert abs(run.energy.imbalance) < 1e-6
    if events == TOUCH:
        held = model.compile(outputs=["held", "z"], backend="numpy")
        assert _kept(held) == {"a", "b", "z"} and len(held.interface.contacts) == 1
        assert len(model.compile(outputs="held", backend="numpy").interface.contacts) == 0


@pytest.mark.parametrize("first", ["", "reinit(der(s), 0); "])
def test_a_clause_that_ends_the_run_is_asked_for(first: str) -> None:
    text = TWO.replace("EVENTS", f'when s > 0.5 [m] then {first}terminate("there"); end when;')
    assert _kept(lagc.loads(text).compile(outputs="th", backend="numpy")) == {"th", "s", "x"}


def test_a_rate_is_asked_for_where_speeds_are_declared() -> None:
    text = TWO.replace("EVENTS", "speed Velocity u = 2*der(s);")
    for asked in ("der(s)", "s", "u", "twice"):
        assert _kept(lagc.loads(text).compile(outputs=asked, backend="numpy")) == {"s", "x"}


def test_an_energy_is_that_of_what_stays() -> None:
    run = lagc.loads(TWO.replace("EVENTS", "")).compile(outputs="th", backend="numpy").simulate(points=2)
    assert run.energy.start == pytest.approx(-9.81 * 0.5) and run.energy.work == 0.0


def test_functions_are_those_of_the_model_without_what_is_left_out() -> None:
    text = TWO.replace("EVENTS", "")
    lost = ("s(start", "Orientation", "frame F", "ball", "slave", "top", "spring", "wind", "output Energy",
            "output Length twice", "output Accel", "output Real")  # fmt: skip
    lines = [line for line in text.splitlines() if not any(word in line for word in lost)]
    alone = "\n".join(line for line in lines if "parameter" not in line) + "\n"
    choice = pipeline.Choice(outputs=("height",))
    made = [pipeline.program(lagc.loads(t, "two.lag").source, c) for t, c in
            ((text, choice), (alone, pipeline.Choice()))]  # fmt: skip
    one, other = ({name: f.cost for name, f in program.functions.items()} for program in made)
    assert one == other and made[0].interface.operations == made[1].interface.operations


def test_unknown_names_are_refused() -> None:
    model = lagc.loads(TWO.replace("EVENTS", ""))
    with pytest.raises(Refused) as refused:
        model.compile(outputs=["hight", "th"]).interface  # noqa: B018
    (fault,) = refused.value.faults
    assert fault.code == "LAG0606" and "`height`" in (fault.remedy or "")


def test_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "two.lag"
    file.write_text(TWO.replace("EVENTS", ""))
    assert main(["sim", str(file), "--outputs", "height, z", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["dropped"] == ["x", "s", "o"] and set(found["final"]) == {
        "th", "z", "der(th)", "der(z)", "height",
    }  # fmt: skip
    assert main(["explain", str(file), "--outputs", "height"]) == 0
    said = capsys.readouterr().out
    assert "`x` is dropped: nothing asked for depends on it" in said
    assert main(["build", str(file), "--outputs", "height", "-o", str(tmp_path / "c"), "-q"]) == 0
    assert "slave" not in "".join(p.read_text() for p in (tmp_path / "c").iterdir())
    assert main(["sim", str(file), "--outputs", "hight", "-q"]) != 0
    assert main(["sim", str(file), "--outputs", " , ", "-q"]) == 2
