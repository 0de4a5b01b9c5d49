"""Effects of a scene against closed forms: an oscillator with constant forces, and sets that were run."""

import json
from collections.abc import Iterator, Mapping
from math import cos
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from tests.simulation.programs import needs_compiler

np = pytest.importorskip("numpy")

from lagc.reports.effects import text, to_dict  # noqa: E402
from lagc.study.effect_changes import in_turn  # noqa: E402
from lagc.study.effects import Effects, Motion, Variant  # noqa: E402

pytestmark = needs_compiler

# x'' + x = sum of forces: each force f alone moves x by f (1 - cos t)
SPRING = """model Spring
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 1/2*1 [N/m]*x^2;
  effect big
    parameter Force f1 = 1e-2;
    force one = {f1, 0, 0} at b;
  end big;
  effect small
    parameter Force f2 = 1e-5;
    force two = {f2, 0, 0} at b;
  end small;
  effect tiny
    parameter Force f3 = 1e-13;
    force three = {f3, 0, 0} at b;
  end tiny;
  effect against
    parameter Force f4 = -9e-3;
    force four = {f4, 0, 0} at b;
  end against;
  effect never
    force five = {if x < -5 [m] then 1 [N] else 0, 0, 0} at b;
  end never;
  effect more
    parameter Force f6 = 1e-4;
    force six = {f6, 0, 0} at b;
  end more;
  scene all uses big, small, tiny, against, never
    simulate(stop = 3.5 [s]);
  end all;
end Spring;
"""
STOP = 3.5

DOUBLE = """model Double
  coordinate Angle a(start = 120 [deg]), b(start = 100 [deg]);
  point P = 1 [m]*{sin(a), 0, -cos(a)};
  point Q = P + 1 [m]*{sin(b), 0, -cos(b)};
  body one = Particle(mass = 1 [kg], at = P);
  body two = Particle(mass = 1 [kg], at = Q);
  Gravity field;
  effect bearing
    parameter Real[N.m.s] c = 1e-3;
    dissipation d = 1/2*c*der(a)^2;
  end bearing;
  effect hair
    parameter Real[N.m] t = 1e-9;
    potential v = 1/2*t*a^2;
  end hair;
  scene all uses bearing, hair
    simulate(stop = 30 [s]);
  end all;
end Double;
"""


def _of(text: str, **options: object) -> Effects:
    return lagc.loads(text).compile().effects(**options)  # type: ignore[arg-type]


def counted(variants: Mapping[str, Variant], setting: Motion) -> dict[str, tuple[float, int]]:
    """Instead of `in_turn`: a time of evaluations and operations, which no other process disturbs."""
    counts = {name: variant.plain(setting, 1)[1] for name, variant in variants.items()}
    return {name: (1e-9 * rhs * (50 + variants[name].operations), rhs) for name, rhs in counts.items()}


@pytest.fixture(scope="module", autouse=True)
def clock() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lagc.study.effect_changes.in_turn", counted)
        patch.setattr("lagc.study.effect_sets.in_turn", counted)
        yield


@pytest.fixture(scope="module")
def spring(clock: None) -> Effects:
    return _of(SPRING, accuracies=(1e-1, 1e-2, 1e-3, 1e-7))


def _span() -> float:
    """The range of x: from 1 to the minimum near t = pi."""
    force = 1e-2 + 1e-5 - 9e-3
    return 2.0 * (1.0 - force)


def test_each_change_is_that_of_the_closed_form(spring: Effects) -> None:
    size, of = spring.scales["x"]
    assert of == "range" and size == pytest.approx(_span(), rel=1e-4)
    changes = {one.effect: one for one in spring.left_out}
    for effect, force in (("big", 1e-2), ("small", 1e-5), ("against", 9e-3)):
        one = changes[effect]
        assert one.change == pytest.approx(2.0 * force / size, rel=1e-4)  # 1 - cos(pi) = 2
        assert one.curve is not None
        assert one.curve[0] == pytest.approx(
            -np.sign(changes[effect].curve[0][-1]) * -abs(force) / size
            * (1.0 - np.cos(np.linspace(0.0, STOP, 501))), abs=1e-8,
        )  # fmt: skip


def test_a_change_below_the_error_bar_is_measured_stronger(spring: Effects) -> None:
    (tiny,) = [one for one in spring.left_out if one.effect == "tiny"]
    assert tiny.how.startswith("f3 times")
    assert tiny.change == pytest.approx(2e-13 / spring.scales["x"][0], rel=0.01)


def test_an_effect_that_never_acts_changes_nothing(spring: Effects) -> None:
    (never,) = [one for one in spring.left_out if one.effect == "never"]
    assert never.change == 0.0 and not never.acted
    ((condition, size),) = never.nearest  # x from 1 to -1
    assert "x" in condition and size == pytest.approx(5.0 - _span() + 1.0, rel=1e-4)


def test_each_effect_has_its_work(spring: Effects) -> None:
    """That of a constant force f is f times the displacement, the energy that of the spring."""
    force = 1e-2 + 1e-5 - 9e-3
    moved = -(1.0 - force) * (1.0 - cos(STOP))
    works = {one.effect: one.work for one in spring.left_out}
    assert works["big"] == pytest.approx(1e-2 * moved, rel=1e-8)
    assert works["against"] == pytest.approx(-9e-3 * moved, rel=1e-8)
    assert works["tiny"] == pytest.approx(1e-13 * moved, rel=1e-8)
    assert works["never"] == 0.0
    energy = spring.energy
    assert energy is not None and energy.rest == 0.0
    given = sum(work for work in works.values() if work is not None)
    assert energy.end - energy.start == pytest.approx(given, abs=1e-9)


def test_offered_effects_are_added(spring: Effects) -> None:
    (more,) = spring.added
    assert more.effect == "more"
    assert more.change == pytest.approx(2e-4 / spring.scales["x"][0], rel=1e-3)


def test_sets_stay_below_the_accuracy_by_the_sum_of_absolute_changes(spring: Effects) -> None:
    found = {one.accuracy: set(one.left_out) for one in spring.sets}
    size = spring.scales["x"][0]
    assert found[1e-1] == {"big", "small", "tiny", "against", "never"}
    assert "big" in found[1e-2] or "against" in found[1e-2]
    assert not {"big", "against"} <= found[1e-2]  # 1.9e-2 by the sum, though they cancel to 1e-3
    assert found[1e-3] == {"small", "tiny", "never"}
    assert found[1e-7] == {"tiny", "never"}
    for one in spring.sets:
        assert one.change <= one.accuracy
        known = {"big": 1e-2, "small": 1e-5, "tiny": 1e-13, "against": -9e-3, "never": 0.0}
        exact = abs(sum(known[name] for name in one.left_out)) * 2.0 / size
        assert one.change == pytest.approx(exact, rel=1e-3, abs=1e-9)


@pytest.mark.full
def test_effects_that_are_harmless_alone_may_not_be_together() -> None:
    """Two stiff springs hold y: each is enough, none is not."""
    text = """model Held
  coordinate Length x(start = 1 [m]), y;
  body b = Particle(mass = 1 [kg], at = {x, y, 0});
  potential V = 1/2*1 [N/m]*(x^2 + 0.01*y^2) - 1 [N]*y;
  effect first potential V1 = 1/2*1e5 [N/m]*y^2; end first;
  effect second potential V2 = 1/2*1e5 [N/m]*y^2; end second;
  output Length z = x + y;
  scene all uses first, second
    simulate(stop = 3 [s]);
  end all;
end Held;
"""
    found = _of(text, accuracies=(1e-3,), of=["z"])
    assert max(one.change or 0.0 for one in found.left_out) < 1e-4
    assert len(found.sets[0].left_out) < 2


@pytest.mark.full
def test_recommended_scenes_are_verified_for_other_initial_states(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """x'' + x + k x^3 = 0: the share of the range that the effect changes grows with the square of x."""
    model = tmp_path / "m.lag"
    model.write_text("""model Bent
  coordinate Length x(start = 0.01 [m]);
  body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  potential V = 1/2*1 [N/m]*x^2;
  effect cubic
    parameter Real[N/m3] k = 1;
    potential W = 1/4*k*x^4;
  end cubic;
  scene all uses cubic
    simulate(stop = 6 [s]);
  end all;
end Bent;
""")
    also = ["--also", "start x=0.02", "--also", "start  x=50[cm]"]
    assert main(["effects", str(model), "--accuracy", "1e-3", "--json", *also]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["sets"][0]["left_out"] == ["cubic"]
    near, far = found["also"]
    assert near["start"] == "start x=0.02" and near["holds"] and near["change"] < 1e-3
    # to first order the phase is late by 3/8 k A^2 t (Duffing), the range is 2 A, t |sin t| is below 4.8145
    assert near["change"] == pytest.approx(3 / 16 * 0.02**2 * 4.8145, rel=0.02)
    assert far["start"] == "start x=50[cm]" and not far["holds"] and far["change"] > 0.1
    assert main(["effects", str(model), "--accuracy", "1e-3", "--quiet", *also]) == 0
    assert "does not hold" in capsys.readouterr().out
    for wrong in ("x=1", "start", "start y=1", "start x=a"):
        assert main(["effects", str(model), "--also", wrong, "--quiet"]) != 0


@pytest.mark.full
def test_a_chaotic_scene_is_compared_until_it_is_not_predictable() -> None:
    found = _of(DOUBLE, accuracies=(1e-2, 1e-5))
    assert found.horizon is not None and 5.0 < found.horizon < 30.0
    changes = {one.effect: one for one in found.left_out}
    bearing = changes["bearing"].until
    assert 0.0 < bearing[1e-5] < bearing[1e-2] < found.horizon
    assert found.sets[0].left_out == ("hair",) and 1e-9 < (changes["hair"].change or 0.0) < 1e-2
    shown = text(found, "Double")
    assert "not predictable beyond" in shown and "1e-02 from" in shown
    for one in found.sets:
        assert one.change <= one.accuracy


@pytest.mark.full
def test_an_effect_goes_with_those_that_need_it() -> None:
    found = lagc.load("stiff_rod").compile().effects(3.0, accuracies=(1e-2,))
    changes = {one.effect: one for one in found.left_out}
    assert changes["elastic"].along == ("inner",)
    assert found.not_compared == ("s",)
    assert {"elastic", "inner"} <= set(found.sets[0].left_out)
    assert found.sets[0].operations < 20 < found.operations
    assert 20 * changes["elastic"].rhs < found.rhs  # evaluations, at one tolerance
    assert found.sets[0].time < 0.5 and changes["inner"].time > 1.2


@pytest.mark.full
def test_an_effect_that_ends_the_run_stays() -> None:
    stop = '  effect stop when x < 0 then terminate("there"); end when; end stop;'
    text = SPRING.replace("  effect more", f"{stop}\n  effect more")
    text = text.replace("never\n    simulate", "never, stop\n    simulate")
    found = _of(text, accuracies=(1e-2,))
    (one,) = [one for one in found.left_out if one.effect == "stop"]
    assert one.change is None and "ends" in one.ends
    assert "stop" not in found.sets[0].left_out


def test_events_of_the_effect_itself_vanish_with_it() -> None:
    """A tap dv at 1 s moves x by dv sin(t - 1)."""
    tap = """  effect kick
    when time > 1 [s] then reinit(der(x), der(x) + 1e-4 [m/s]); mark("tap"); end when;
  end kick;
"""
    text_ = SPRING.replace("  effect more", tap + "  effect more").replace("never\n    sim", "kick\n    sim")
    found = _of(text_, accuracies=(1e-3, 1e-6))
    (one,) = [one for one in found.left_out if one.effect == "kick"]
    assert one.events == ("tap",) and one.ends == ""
    assert one.per["x"] == pytest.approx(1e-4 / found.scales["x"][0], rel=1e-3)  # at t = 1 + pi/2
    assert "kick" in found.sets[0].left_out
    assert "its events vanish: tap" in " ".join(text(found, "Spring").split())


def test_reports(spring: Effects, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = text(spring, "Spring, scene all")
    assert "Each effect left out alone" in shown and "-0.0193 J" in shown and "scene for_1em01" in shown
    assert "did not act at the recorded times" in shown
    data = json.loads(json.dumps(to_dict(spring)))
    assert data["compared"]["x"]["of"] == "range" and len(data["effects"]) == 5
    model = tmp_path / "spring.lag"
    model.write_text(SPRING)
    svg = tmp_path / "a.svg"
    assert main(["effects", str(model), "--accuracy", "1e-2", "-o", str(svg), "--quiet"]) == 0
    assert svg.read_text().startswith("<?xml") and "leave out" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments", [["--accuracy", "2"], ["--accuracy", "a..b"], ["-o", "x.txt"], ["--scene", "default"]]
)
def test_wrong_arguments(arguments: list[str], tmp_path: Path) -> None:
    model = tmp_path / "spring.lag"
    model.write_text(SPRING)
    assert main(["effects", str(model), *arguments, "--quiet"]) != 0


def test_a_scene_without_effects_is_refused() -> None:
    plain = SPRING.replace(" uses big, small, tiny, against, never", "")
    with pytest.raises(Refused, match="uses no effect"):
        _of(plain)
    with pytest.raises(Refused, match="no coordinate or output"):
        _of(SPRING, of=["y"])


@pytest.mark.full
def test_prune_runs_the_cheapest_scene_and_remembers_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LAGC_CACHE", str(tmp_path / "cache"))
    model = tmp_path / "spring.lag"
    model.write_text(SPRING)
    shown = []
    for _ in range(2):
        assert main(["sim", str(model), "--accuracy", "1e-3", "--prune", "--json", "-p", "f2=2e-5"]) == 0
        shown.append(json.loads(capsys.readouterr().out))
    assert shown[0]["effects"] == shown[1]["effects"] == ["big", "against"]
    first, second = (found["notes"][0] for found in shown)
    assert "left out small, tiny, never" in first and "found in" in first and "found in" not in second
    exact = 1e-3 + (1.0 - 1e-3) * cos(STOP) + 2e-5 * (1.0 - cos(STOP))  # of the full scene
    pruned = shown[0]["pruned"]
    assert pruned == shown[1]["pruned"] and pruned["left_out"] == ["small", "tiny", "never"]
    assert pruned["asked"] == 1e-3 and 0.0 < pruned["bar"] < pruned["error"] < 1e-3
    assert shown[0]["final"]["x"] == pytest.approx(exact, abs=1e-3 * _span())
    assert main(["sim", str(model), "--rtol", "1e-3", "--prune", "--quiet"]) == 2
    assert main(["sim", "bouncing_ball", "--prune", "--quiet"]) == 0


def test_the_scene_without_effects_that_others_need_is_refused() -> None:
    model = lagc.load("stiff_rod").compile()
    assert "s" not in model.without(["elastic", "inner"]).state_names
    with pytest.raises(Refused, match="requires"):
        model.without(["elastic"])
    with pytest.raises(Refused, match="no effect"):
        model.without(["nothing"])


def test_times_are_measured_in_turn() -> None:
    class Fixed:
        operations = 1

        def __init__(self, seconds: float):
            self.seconds = seconds

        def plain(self, setting: Motion, repeats: int) -> tuple[float, int]:
            return self.seconds, 7

    made = {"a": Fixed(2e-3), "b": Fixed(1e-3)}
    assert in_turn(made, None) == {"a": (2e-3, 7), "b": (1e-3, 7)}  # type: ignore[arg-type]


BOUNCING = """model Bouncing
  coordinate Length x(rate = 1 [m/s]), y, z(start = 1 [m]);
  body ball = Particle(mass = 1 [kg], at = {x, y, z});
  Gravity field;
  when z < 0 [m] then
    reinit(der(z), -0.9*der(z));
    mark("bounce");
  end when;
  effect air
    excludes breeze;
    parameter Real[kg/m] k = 1e-2;
    force f = -k*norm(velocity(ball))*velocity(ball) at ball;
  end air;
  effect breeze
    parameter Force fy = 1e-9;
    force g = fy*world.y at ball;
  end breeze;
  scene calm uses air
    simulate(stop = 3 [s]);
  end calm;
  scene windy uses breeze
    simulate(stop = 3 [s]);
  end windy;
  output Velocity fall = der(z);
end Bouncing;
"""


@pytest.mark.full
def test_quantities_that_jump_are_compared_between_the_same_events() -> None:
    found = _of(BOUNCING, accuracies=(1e-2,), points=6001)
    (air,) = found.left_out
    model = lagc.loads(BOUNCING)
    with_air, without = (
        np.array(model.compile(scene, parameters=own).simulate(3.0, points=6001).column("fall"))
        for scene, own in (("calm", {}), ("windy", {"fy": 0.0}))
    )  # fmt: skip
    plain = np.abs(with_air - without).max() / np.ptp(with_air)
    assert plain > 0.5 > 0.2 > (air.change or 1.0) > 1e-3
    assert not found.added  # `breeze` is excluded


@pytest.mark.full
def test_a_quantity_that_rests_is_compared_with_the_largest_of_its_unit() -> None:
    found = _of(BOUNCING, accuracies=(1e-2,), points=101)
    assert found.scales["y"] == (found.scales["x"][0], "unit")
    windy = lagc.loads(BOUNCING).compile("windy").effects(accuracies=(1e-2,))
    assert windy.scales["y"][1] == "range"
    (breeze,) = windy.left_out
    assert breeze.change == pytest.approx(1.0, rel=1e-6)  # of y, which nothing else moves
