"""Inputs that change during a run: from the model, a scene, the command line and Python."""

import json
import pickle
import random
from math import cos, sin
from pathlib import Path

import numpy
import pytest
from scipy.interpolate import CubicSpline

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from tests.codegen.tools import bits

pytestmark = pytest.mark.usefixtures("own_cache")

CART = """model Cart
  parameter Mass m = 2 [kg];
  parameter Force k = 3 [N];
  parameter Force double = 2*k;
  input Force u = 1, w[2] "wind";
  input Length place = 0;
  coordinate Length x;
  body b = Particle(mass = m, at = {x, 0, 0});
  force f = {u + w[2], 0, 0} at b;
  scene plain;
  scene shaken
    input u = k*sin(2*time/1[s]);
  end shaken;
  effect rail
    constraint on: x = place;
    output Force pull = reaction(on);
  end rail;
  effect pushed
    force g = {double, 0, 0} at b;
  end pushed;
end Cart;
"""
SHAKEN = "k*sin(2*time/1[s])"


def shaken(t: float, k: float = 3.0) -> float:
    """x under k sin(2 t), from rest, of 2 kg."""
    return k / 4.0 * (t - sin(2.0 * t) / 2.0)


def compiled(**choice: object) -> lagc.CompiledModel:
    return lagc.loads(CART).compile(**choice)  # type: ignore[arg-type]


@pytest.mark.full
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_an_expression_is_the_same_wherever_it_is_said(backend: str, tmp_path: Path) -> None:
    declared = lagc.loads(CART.replace("u = 1", f"u = {SHAKEN}"))
    runs = [
        compiled(scene="shaken", backend=backend).simulate(2.0, accuracy=1e-8),
        compiled(inputs={"u": SHAKEN}, backend=backend).simulate(2.0, accuracy=1e-8),
        compiled(backend=backend).simulate(2.0, accuracy=1e-8, inputs={"u": SHAKEN}),
        declared.compile(backend=backend).simulate(2.0, accuracy=1e-8),
    ]
    for run in runs:
        assert run.status == "ok" and "u" in run.names
        assert [bits(x) for x in run.states] == [bits(x) for x in runs[0].states]
        assert run["x"] == pytest.approx([shaken(t) for t in run.t], abs=2e-8)
        assert run["u"] == pytest.approx([3.0 * sin(2.0 * t) for t in run.t], abs=1e-14)
    other = compiled(scene="shaken", backend=backend).simulate(2.0, accuracy=1e-8, parameters={"k": 1.5})
    assert other["x"] == pytest.approx([shaken(t, 1.5) for t in other.t], abs=1e-8)


@pytest.mark.full
def test_the_command_line_takes_numbers_expressions_and_columns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "models" / "cart.lag"
    path.parent.mkdir()
    path.write_text(CART)
    (tmp_path / "drive.csv").write_text("t [ms],u [N],v\n0,0,4\n1000,2,4\n5000,2,4\n")
    (tmp_path / "Drive (1).CSV").write_text("time,x[1],der(x[1]) [N]\n0,0,0\n1,1,2\n")
    (tmp_path / "it's.csv").write_text("time,u\n0,0\n1,2\n")
    monkeypatch.chdir(tmp_path)

    def final(*said: str) -> float:
        words = [word for one in said for word in ("--input", one)]
        assert main(["sim", str(path), "--stop", "1", "--json", "--accuracy", "1e-8", *words]) == 0
        return float(json.loads(capsys.readouterr().out)["final"]["x"])

    assert final("u=5") == pytest.approx(5.0 / 4.0, rel=1e-12)
    assert final("u = -5[kN]") == pytest.approx(-5e3 / 4.0, rel=1e-12)
    assert final(f"u={SHAKEN}") == pytest.approx(shaken(1.0), rel=1e-8)
    assert final("u=drive.csv:u") == pytest.approx(1.0 / 6.0, rel=1e-8)
    assert final(f"u={tmp_path}/drive.csv:v", "w[2]=-1[N]") == pytest.approx(3.0 / 4.0, rel=1e-8)
    assert final("u=Drive (1).CSV:der(x[1])") == pytest.approx(1.0 / 6.0, rel=1e-8)
    assert final("u=it's.csv") == pytest.approx(1.0 / 6.0, rel=1e-8)
    assert final('u=2*table(time, "drive.csv", "u")') == pytest.approx(1.0 / 3.0, rel=1e-8)
    assert final("u=0", "w[2]=1[N/s]*time") == pytest.approx(1.0 / 12.0, rel=1e-8)
    assert final("u=4[N]*(1 - x/1[m])", "w={0, 0}") == pytest.approx(1.0 - cos(2.0**0.5), rel=1e-7)


def test_a_file_that_changes_drives_the_next_run(tmp_path: Path) -> None:
    model, path = compiled(), tmp_path / "drive.csv"
    for force in (4.0, 8.0, 4.0):
        path.write_text(f"time,u\n0,{force}\n1,{force}\n")
        run = model.simulate(1.0, inputs={"u": f"{path}:u"})
        assert run["x"][-1] == pytest.approx(force / 4.0, rel=1e-9)


@pytest.mark.parametrize(
    "said, code",
    [
        ("u=3[m]*time/1[s]", "LAG0302"), ("u=sin(time)", "LAG0303"), ("u=1[N]*foo", "LAG0201"),
        ("u=1; constant Real b = 2", "LAG0110"), ("u=)", "LAG0114"), ("u=nowhere.csv", "LAG0226"),
        ("u={1, 2} [N]", "LAG0306"), ("u=b", "LAG0306"), ("u=2*u", "LAG0205"), ("v=2*time", "LAG0215"),
        ("k=2[N/s]*time", "LAG0311"), ("u=acceleration(b).x*m", "LAG0219"), ("u[1]=2[N/s]*time", "LAG0215"),
        ("u=if time > 1 then 2 else 3", "LAG0301"),
    ],
)  # fmt: skip
def test_what_no_input_can_be(said: str, code: str) -> None:
    name, _, text = said.partition("=")
    with pytest.raises(Refused) as refused:
        compiled().simulate(1.0, inputs={name: text})
    assert code in {fault.code for fault in refused.value.faults}


@pytest.mark.parametrize("words", [["--input", "u"], ["--input", "=2"], ["--input", "u="],
                                   ["-p", "u=1", "--input", "u=2"],
                                   ["--input", "u=1", "--input", "u=time"]])  # fmt: skip
def test_what_the_command_line_does_not_take(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "cart.lag").write_text(CART)
    assert main(["sim", str(tmp_path / "cart.lag"), *words]) == 2


@pytest.mark.full
@pytest.mark.parametrize("kind", ["held", "linear", "cubic"])
def test_points_are_the_table_that_is_written(kind: str) -> None:
    rng = random.Random(kind)
    t = numpy.cumsum([0.0, *(rng.uniform(0.1, 0.6) for _ in range(6))])
    values = numpy.array([rng.uniform(-2.0, 2.0) for _ in t])
    lists = ("{" + ", ".join(map(repr, map(float, row))) + "}" for row in (t, values))
    written = f'table(time, {", ".join(lists)}, "{kind}")'
    for backend in ("c", "numpy"):
        system = compiled(backend=backend)
        given = system.simulate(2.0, inputs={"u": (t, values, kind)})
        other = system.simulate(2.0, inputs={"u": written})
        assert given.status == "ok"
        assert [bits(x) for x in given.states] == [bits(x) for x in other.states]
        plain = system.simulate(2.0, inputs={"u": (list(t), list(values))})
        assert (plain.states == given.states) == (kind == "linear")


@pytest.mark.parametrize(
    "given, code",
    [
        (([0.0, 1.0], [1.0]), "LAG0314"), (([0.0, 1.0], [1.0, float("nan")]), "LAG0314"),
        (([0.0, float("inf")], [1.0, 2.0]), "LAG0314"), (([1.0, 0.0], [1.0, 2.0]), "LAG0314"),
        (([0.0, 0.0], [1.0, 2.0]), "LAG0314"), (([0.0], [1.0]), "LAG0314"), (([], []), "LAG0314"),
        (([0.0, 1.0], [1.0, 2.0], "quadratic"), "LAG0307"), (([0.0, 1.0],), "LAG0602"),
        (([0.0, 1.0], ["a", "b"]), "LAG0602"), (([0.0, 1.0], 2.0), "LAG0602"), ((), "LAG0602"),
        (([0.0, 1.0], [1.0, 2.0], "held", 3), "LAG0602"), (None, "LAG0602"), ([1.0, 2.0], "LAG0602"),
        ((70, "cm"), "LAG0605"), (float("nan"), "LAG0602"),
    ],
)  # fmt: skip
def test_what_python_cannot_give(given: object, code: str) -> None:
    with pytest.raises(Refused) as refused:
        compiled(backend="numpy").simulate(1.0, inputs={"u": given})  # type: ignore[dict-item]
    assert [fault.code for fault in refused.value.faults] == [code]


def test_numbers_compile_nothing_and_take_the_place_of_what_is_built_in() -> None:
    system = compiled(backend="numpy")
    run, same = (
        system.simulate(1.0, **given) for given in ({"inputs": {"u": 3.0}}, {"parameters": {"u": 3.0}})
    )
    assert run.system.model is system.system.model and run.states == same.states and "u" not in run.names
    moving = compiled(scene="shaken", backend="numpy")
    for _ in range(2):
        still = moving.simulate(1.0, inputs={"u": (3.0, "N")})
        assert still.states == run.states
        assert moving.simulate(1.0)["x"][-1] == pytest.approx(shaken(1.0), rel=1e-6)
    bound = moving.bind({"m": 4.0}).simulate(1.0, inputs={"u": "1[N]", "w[2]": "1[N]*time/1[s]"})
    assert bound["x"][-1] == pytest.approx((0.5 + 1.0 / 6.0) / 4.0, rel=1e-6)
    again = pickle.loads(pickle.dumps(compiled(inputs={"u": ([0, 1], [0, 3])}))).simulate(1.0)
    assert again["x"][-1] == pytest.approx(0.25, rel=1e-6)


def test_what_was_given_once_is_not_kept_for_those_who_do_not_give_it() -> None:
    """Of inputs and of parameters that are made of others, whoever was first compiled."""
    for first in (0, 1):
        for case in ({"scene": "shaken"}, {"use": ["pushed"]}):
            name, given = ("u", 7.0) if "scene" in case else ("double", 11.0)
            text = CART.replace("2 [kg]", f"{2 + first} [kg]")  # another entry of the cache
            found = {}
            for turn in (first, 1 - first, first):
                parameters = {name: given} if turn else {}
                system = lagc.loads(text).compile(**case, parameters=parameters, backend="numpy")  # type: ignore[arg-type]
                x = system.simulate(1.0)["x"][-1]
                assert found.setdefault(turn, x) == x
            force = {0: 0.0, 1: 7.0} if name == "u" else {0: 7.0, 1: 12.0}
            for turn, x in found.items():
                true = (
                    shaken(1.0) * 2.0 / (2 + first)
                    if name == "u" and not turn
                    else force[turn] / 2 / (2 + first)
                )
                assert x == pytest.approx(true, rel=1e-6)


@pytest.mark.full
def test_a_row_follows_an_input_whose_course_is_smooth() -> None:
    t, places = [0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.2, -0.1, 0.3, 0.1]
    system = compiled(use=["rail"], backend="numpy", inputs={"place": (t, places, "cubic")})
    run = system.simulate(2.0, accuracy=1e-10)
    assert run.status == "ok"
    assert run["x"] == pytest.approx(CubicSpline(t, places)(run.t), abs=1e-12)
    assert run["pull"] + 1.0 == pytest.approx(2.0 * CubicSpline(t, places)(run.t, 2), abs=1e-9)
    for place, code in ((1.0, "LAG0407"), ((t, places), "LAG0421"), ("0.1[m/s]*time", "")):
        try:
            warnings = compiled(use=["rail"], inputs={"place": place}).equations.warnings
            found = "".join(fault.code for fault in warnings if fault.code != "LAG0230")
        except Refused as refused:
            found = refused.faults[0].code
            assert code != "LAG0407" or 'compile(inputs={"place": ...})' in (refused.faults[0].remedy or "")
        assert found == code


@pytest.mark.full
@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("kind", ["held", "linear"])
def test_no_step_passes_over_what_is_short_in_a_table(kind: str, backend: str) -> None:
    """Pulses of microseconds to milliseconds, anywhere in ten seconds, change the speed by their areas."""
    rng = random.Random(kind)
    system = compiled(backend=backend)
    for _ in range(4):
        t, values, speed = [0.0], [0.0], 0.0
        for _ in range(3):
            begin, width, height = (
                t[-1] + rng.uniform(0.5, 3.0),
                10.0 ** rng.uniform(-6, -3),
                rng.uniform(1.0, 9.0),
            )
            t += [begin, begin + 0.5 * width, begin + width]
            values += [height, height, 0.0] if kind == "held" else [0.0, height, 0.0]
            speed += height * width * (1.0 if kind == "held" else 0.5) / 2.0
        run = system.simulate(10.0, inputs={"u": (t, values, kind)}, accuracy=1e-8)
        assert run.status == "ok" and run["der(x)"][-1] == pytest.approx(speed, rel=1e-8)
        rough = system.simulate(10.0, inputs={"u": (t, values, kind)}, rtol=1e-3)
        assert rough["der(x)"][-1] == pytest.approx(speed, rel=1e-8)  # a quadrature of polynomials
