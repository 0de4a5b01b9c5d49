"""Frictionless one-sided constraints against closed forms and published references."""

import ast
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

import lagc
from lagc.api import Run
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81
HEAD = """model M
  coordinate Length z(start = 1 [m]), x;
  Gravity field(g = 9.81 [m/s2]);
  body ball = Particle(mass = 2 [kg], at = {x, 0, z});
"""


def _run(name: str, backend: str, stop: float | None = None, **values: Any) -> Run:
    accuracy = values.pop("accuracy", 1e-9)
    return lagc.load(name).compile(backend=backend).simulate(stop, accuracy=accuracy, parameters=values)


def _model(text: str) -> lagc.ModelFile:
    return lagc.loads(f"{HEAD}{text}\n  scene s\n    simulate(stop = 1 [s]);\n  end s;\nend M;\n")


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_ball_bounces_and_comes_to_rest(backend: str) -> None:
    """Flights of 2 e^n sqrt(2h/g); rest at sqrt(2h/g)(1 + e)/(1 - e), with impulses m(1 + e) e^n sqrt(2gh).
    Modelica Association, Reference-FMUs, BouncingBall, has the first speeds to five digits."""
    run = _run("bouncing_ball", backend, 4.0, e=0.7)
    assert run.status == "ok"
    impacts = [event for event in run.events if event.kind == "impact"]
    first = math.sqrt(2.0 / G)
    assert 25 < len(impacts) < 40
    for n, event in enumerate(impacts):
        assert event.t == pytest.approx(first * (1.0 + 2.0 * sum(0.7**j for j in range(1, n + 1))), abs=1e-12)
        assert event.impulse == pytest.approx(1.7 * 0.7**n * math.sqrt(2.0 * G), rel=1e-7)
        assert event.loss == pytest.approx(0.51 * 0.49**n * G, rel=1e-6)
    rest = run.events[-1]
    assert rest.kind == "rests" and rest.t == pytest.approx(2.558633965585808458555, abs=1e-12)
    assert run.final["y"] == 0.0 == run.final["der(y)"] and run.final["floor"] == 1.0
    assert run.final["N"] == pytest.approx(G) and run.estimated is not None and run.estimated < 1e-9


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bead_leaves_a_sphere(backend: str) -> None:
    """cos(theta) = 2/3 cos(theta0); times by quadrature of the energy (D. T. Greenwood, Principles of
    Dynamics, 1988)."""
    run = _run("slide_off_sphere", backend, 2.0)
    leaves = run.events[0]
    assert leaves.kind == "opens" and leaves.t == pytest.approx(0.9071101110462694341024, abs=2e-9)
    assert run.status == "terminated" and run.t[-1] == pytest.approx(1.32650346437198793838, abs=2e-9)
    assert run.estimated is not None
    exact = {
        "x": 1.457991690006746788408,
        "der(x)": 1.692134823944013198903,
        "der(y)": -6.023177023826448103612,
    }
    for name, value in exact.items():
        size = 1.5 if name == "x" else 6.1
        assert abs(run.final[name] - value) <= run.estimated * size
    assert run["N"][0] == pytest.approx(G * math.cos(0.1)) and run["N"][-1] == 0.0


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "masses, e, after",
    [
        ((3.0, 1.0), 1.0, (0.0, 8.858893836140040345325)),
        ((3.0, 1.0), 0.8, (-0.04429446918070020172662, 6.334109092840128846907)),
        ((1.0, 0.1), 0.9, (2.532838283150947898732, 10.10719251305068239398)),
    ],
)
def test_balls_that_touch_fall_and_part(
    backend: str, masses: tuple[float, float], e: float, after: tuple[float, float]
) -> None:
    """The floor first, then the pair (W. G. Harter et al., Am. J. Phys. 39 (1971) 656). In flight the balls
    touch without an event."""
    run = _run("stacked_balls", backend, 0.4516, m1=masses[0], m2=masses[1], e=e)
    first = math.sqrt(2.0 / G)
    assert [event.t for event in run.events[:2]] == pytest.approx([first, first], abs=1e-12)
    assert [event.contact for event in run.events[:2]] == ["floor", "pair"]
    _, before, then = run.corners[0]
    assert before[2:4] == pytest.approx([-math.sqrt(2.0 * G)] * 2, rel=1e-12)
    if e == 1.0 or after[0] > 0.0:
        assert then[2:4] == pytest.approx(after, rel=1e-12, abs=1e-12)
    else:  # the lower ball falls back at once, and bounces on
        assert then[3] == pytest.approx(after[1], rel=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_end_of_a_rod_hits_a_floor(backend: str) -> None:
    """J = (1 + e) v/(1/m + d^2/J0), d = l/2 cos(angle) (W. J. Stronge, Impact Mechanics, 2000). The impact is
    the first event, at the start."""
    run = lagc.load("rod_impact").compile(backend=backend, scene="hit").simulate(0.1, accuracy=1e-9)
    hit = run.events[0]
    assert (hit.t, hit.contact) == (0.0, "left_end")
    assert hit.impulse == pytest.approx(1.08894870037899138989, rel=1e-12)
    assert run["der(y)"][0] == pytest.approx(-0.9110512996210086101101, rel=1e-12)
    assert abs(run["der(angle)"][0]) == pytest.approx(4.99724343503081283325, rel=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_rope_goes_slack(backend: str) -> None:
    """Where v^2 = g l cos(angle from the top): at z = (v0^2/g - 2 l)/3 above the pivot. The time is an
    integral of ds/v, by Simpson's rule."""
    run = _run("slack_rope", backend)
    height = (36.0 / G - 2.0) / 3.0
    end = math.pi - math.acos(height)
    n = 2000
    speeds = [math.sqrt(36.0 - 2.0 * G * (1.0 - math.cos(end * k / n))) for k in range(n + 1)]
    weights = [1, *(4 if k % 2 else 2 for k in range(1, n)), 1]
    time = sum(w / v for w, v in zip(weights, speeds)) * end / n / 3.0
    opens = run.events[0]
    assert opens.kind == "opens" and opens.t == pytest.approx(time, abs=2e-9)
    assert opens.t == pytest.approx(0.48446613, abs=1e-8)
    _, before, _ = run.corners[0]
    assert before[1] == pytest.approx(height, abs=2e-9)
    hit = run.events[1]
    speed_before = hit.impulse  # of a unit mass: all of its speed along the rope
    assert hit.kind == "impact" and hit.loss == pytest.approx(speed_before**2 / 2.0, rel=1e-9)
    assert run.final["x"] ** 2 + run.final["z"] ** 2 == pytest.approx(1.0, abs=1e-14)


@pytest.mark.full
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_a_cradle_passes_blows_on_at_every_tolerance(backend: str) -> None:
    """Equal masses exchange their speeds: ten blows in 10 s, each passed on by four pairs."""
    system = lagc.load("newtons_cradle").compile(backend=backend)
    for k in range(4, 13):
        run = system.simulate(10.0, rtol=10.0**-k, method="dop853")
        assert run.status == "ok"
        assert len([event for event in run.events if event.kind == "impact"]) == len(run.events) == 40


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_touches_without_load_makes_no_event(backend: str) -> None:
    text = """model M
      coordinate Length a(start = 1 [m]), b(start = 1 [m]);
      Gravity field(g = 9.81 [m/s2]);
      body one = Particle(mass = 3 [kg], at = {0, 0, a});
      body other = Particle(mass = 0.7 [kg], at = {0, 0, b});
      constraint pair: b >= a (restitution = 1);
      scene s
        simulate(stop = 0.4 [s], accuracy = 1e-9);
      end s;
    end M;"""
    run = lagc.loads(text).compile(backend=backend).simulate()
    assert run.status == "ok" and run.events == ()
    assert run.final["a"] == run.final["b"] == pytest.approx(1.0 - G * 0.08, abs=1e-12)


def _pendulum(rows: bool) -> str:
    place = "{x, 0, z}" if rows else "{l*sin(th), 0, -l*cos(th)}"
    state = (
        "coordinate Length x(start = l*sin(0.5)), z(start = -l*cos(0.5));"
        if rows
        else "coordinate Angle th(start = 0.5);"
    )
    rod = "constraint rod: norm(position(bob)) = l;" if rows else ""
    return f"""model M
      parameter Length l = 1 [m];
      {state}
      Gravity field(g = 9.81 [m/s2]);
      body bob = Particle(mass = 1 [kg], at = {place});
      {rod}
      constraint wall: position(bob).x >= -0.1 [m] (restitution = 0.8);
      scene s
        simulate(stop = 2 [s], accuracy = 1e-9);
      end s;
      output Length side = position(bob).x;
    end M;"""


@pytest.mark.parametrize("backend", BACKENDS)
def test_contacts_act_beside_two_sided_rows(backend: str) -> None:
    """The same pendulum in its angle, and in two coordinates with the equation of its rod."""
    with_rows, without = (
        lagc.loads(_pendulum(rows)).compile(backend=backend).simulate() for rows in (True, False)
    )
    assert len(with_rows.events) == len(without.events) == 2
    for one, other in zip(with_rows.events, without.events):
        assert one.t == pytest.approx(other.t, abs=1e-8)
        assert one.loss == pytest.approx(other.loss, rel=1e-6)
    assert with_rows["side"] == pytest.approx(without["side"], abs=1e-8)


def test_true_errors_stay_below_the_estimate() -> None:
    """A bead that leaves a sphere, at accuracies from 1e-4 to 1e-10."""
    system = lagc.load("slide_off_sphere").compile(backend="numpy")
    for accuracy in (1e-4, 1e-7, 1e-10):
        run = system.simulate(2.0, accuracy=accuracy)
        assert run.estimated is not None and run.estimated <= accuracy
        assert abs(run.final["x"] - 1.457991690006746788408) <= run.estimated * 1.46
        assert abs(run.final["der(y)"] + 6.023177023826448103612) <= run.estimated * 6.1


def test_arrays_names_and_reactions() -> None:
    model = _model("""  constraint corner: {x, z} >= {0, 0} (restitution = 0.5);
  output Force side = reaction(corner)[1], push = reaction(corner)[2];""")
    run = model.compile(backend="numpy").simulate(3.0)
    assert [event.contact for event in run.events] == ["corner[2]"] * len(run.events)
    assert run.final["corner[2]"] == 1.0 and run.final["push"] == pytest.approx(2.0 * G)


def test_the_flight_is_that_of_the_model_without_contacts() -> None:
    """The right-hand side has the same operations."""
    one, other = (
        _model(text).compile(backend="numpy").program.functions["rhs"]
        for text in ("", "  constraint floor: z >= 0;")
    )
    assert one.operations == other.operations


def _names_of_contacts() -> tuple[set[str], set[str]]:
    """The kernels of contacts, and the fields of records that only models with contacts have."""
    folder = Path(lagc.__file__).parent / "kernels"
    files = [*(folder / "contact").glob("*.py"), folder / "events/contact_events.py"]
    trees = [ast.parse(file.read_text(encoding="utf-8")) for file in files]
    kernels = {node.name for tree in trees for node in tree.body if isinstance(node, ast.FunctionDef)}
    records = ast.parse((folder / "language/records.py").read_text(encoding="utf-8"))
    guarded = [
        node
        for record in records.body
        if isinstance(record, ast.ClassDef) and record.name in ("State", "Work")
        for node in ast.walk(record)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "NCON > 0"
    ]
    fields = {
        node.target.id
        for guard in guarded
        for node in ast.walk(guard)
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }
    others = {  # kernels that stand for one of the same name without contacts
        "rates_at", "put_on_constraints", "pass_event", "seated"
    }  # fmt: skip
    inner = {"ContactLaw", "ContactWork", "SettlingWork", "contact_law", "contact_work", "settling_work"}
    return kernels - others, fields | inner


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["", "classic/stick_slip_belt", "hard/walls", "course/string_pendulum"])
def test_models_without_contacts_carry_nothing_of_them(name: str) -> None:
    """No kernel of contacts, no field of theirs, no status: also where relations and clauses `when` act."""
    from lagc.compiler import pipeline

    kernels, fields = _names_of_contacts()
    assert len(kernels) > 80 and len(fields) > 15
    model = lagc.load(name) if name else _model("")
    for target in ("c", "numpy"):
        found = pipeline.render(model.compile(backend="numpy").program, target)
        text = re.sub(r'/\*.*?\*/|""".*?"""|//[^\n]*', "", "".join(found.values()), flags=re.DOTALL)
        words = set(re.findall(r"[A-Za-z_]\w*", text))
        own = {word.split("_", k)[-1] for word in words for k in range(5)}
        called = set(re.findall(r"\b(\w+)\(", text))
        called |= {word.split("_", k)[-1] for word in called for k in range(5)}
        assert not fields & words
        assert not kernels & called
        assert not {"PARADOX", "PENETRATION", "NCON", "NCROW", "NSLIP"} & own


@pytest.mark.parametrize(
    "text, code, words",
    [
        ("  constraint top: 1 [m] <= 2 [m];", "LAG0235", "no coordinate"),
        ("  constraint floor: z >= 0 (restitution = 2);", "LAG0235", "0 to 1"),
        ("  constraint floor: z >= 0 (bounce = 0.5);", "LAG0209", "bounce"),
        ("  constraint floor: z >= 0 (restitution = 1 [m]);", "LAG03", "restitution"),
        ("  input Length h;\n  constraint floor: z >= h;", "LAG0235", "input"),
    ],
)
def test_what_contacts_cannot_do_is_refused(text: str, code: str, words: str) -> None:
    with pytest.raises(Refused) as refused:
        _ = _model(text).compile(backend="numpy").interface
    fault = refused.value.faults[0]
    assert fault.code.startswith(code) and words in fault.message + str(fault.remedy)


def test_a_start_beyond_a_bound_is_refused_with_its_depth() -> None:
    with pytest.raises(Refused) as refused:
        _model("  constraint floor: z >= 1.25 [m];").compile(backend="numpy").simulate()
    assert refused.value.faults[0].code == "LAG0624" and "0.25 m" in refused.value.faults[0].message


def test_what_does_not_follow_contacts_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "bouncing_ball", "--method", "taylor"]) != 0
    assert "LAG0623" in capsys.readouterr().err


def test_events_of_contacts_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sim", "slack_rope", "--json"]) == 0
    opens, hit = json.loads(capsys.readouterr().out)["events"]
    assert opens == {
        "t": pytest.approx(0.484466, abs=1e-5),
        "name": "rope opens",
        "contact": "rope",
        "kind": "opens",
    }
    assert hit["kind"] == "impact" and hit["impulse"] > 0.0 and hit["loss"] > 0.0


def test_a_table_that_shakes(tmp_path: Path) -> None:
    """A ball leaves a table where its acceleration is -g, and the energy books the work of the table."""
    text = """model M
      coordinate Length z;
      Gravity field(g = 9.81 [m/s2]);
      body ball = Particle(mass = 1 [kg], at = {0, 0, z});
      constraint table: z >= 0.02 [m]*(1 - cos(25 [rad/s]*time));
      scene s
        simulate(stop = 0.2 [s], accuracy = 1e-9);
      end s;
    end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate()
    leaves = run.events[0]
    assert leaves.kind == "opens"
    assert leaves.t == pytest.approx(math.acos(-G / (0.02 * 625.0)) / 25.0, abs=2e-9)
    assert abs(run.energy.imbalance) < 1e-6


def test_explain_lists_contacts_with_their_laws(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "incline"]) == 0
    incline = capsys.readouterr().out
    assert "slope (line 16): n >= 0, restitution 0, friction mu, slip s'" in incline
    assert "discrete variables" not in incline and "while contacts are open" in incline


@pytest.mark.parametrize("given, named", [("k", "`k`"), ("k/2", "restitution of floor")])
def test_a_restitution_by_parameters_is_from_0_to_1(given: str, named: str) -> None:
    model = _model(f"  parameter Real k = 3;\n  constraint floor: z >= 0 (restitution = {given});")
    with pytest.raises(Refused, match=f"{named}.* above its maximum, 1"):
        model.compile(backend="numpy").simulate(1.0)


@pytest.mark.full
def test_a_bound_with_a_kink_is_named_where_a_body_passes_it_without_end() -> None:
    """Between two planes a particle loses a share of its speed at the kink, in ever shorter times."""
    text = """model Vee
  coordinate Length x(start = 0.5 [m], rate = 1 [m/s]), y(start = 1 [m]);
  Gravity field(g = 9.81 [m/s2], direction = {0, -1, 0});
  body ball = Particle(mass = 1 [kg], at = {x, y, 0});
  constraint floor: y >= 0.5*abs(x);
end Vee;
"""
    run = lagc.loads(text).compile(backend="c").simulate(10.0, accuracy=1e-6)
    assert run.status == "failed" and "`floor` has a kink there: write a constraint for each" in run.message
    two = text.replace("floor: y >= 0.5*abs(x)", "left: y >= -0.5*x;\n  constraint right: y >= 0.5*x")
    run = lagc.loads(two).compile(backend="c").simulate(10.0, accuracy=1e-6)
    assert run.status == "ok" and run.final["x"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("law", ["restitution = 0.5", "restitution = 0.5, friction = 0.1, at = b"])
@pytest.mark.parametrize("start", ["start = 0", "start = 0, rate = 1", "start = 0.5"])
def test_a_pendulum_touches_the_floor_at_its_lowest_point(start: str, law: str) -> None:
    """Its gap L (1 - cos a) has no gradient there: no force of the floor moves it, it swings as without."""
    text = f"""model G
      parameter Length L = 0.2 [m];
      coordinate Angle a({start});
      body b = Particle(mass = 1 [kg], at = L*{{sin(a), 0, -cos(a)}});
      constraint bed: b.z >= -L ({law});
      Gravity field;
      force F = 0.3 [N]*world.x at b;
    end G;"""
    free = re.sub(r"constraint.*\n", "", text)
    runs = [lagc.loads(each).compile(backend="numpy").simulate(2.0) for each in (text, free)]
    assert [run.status for run in runs] == ["ok", "ok"]
    assert runs[0].final["a"] == pytest.approx(runs[1].final["a"], abs=2e-6)
