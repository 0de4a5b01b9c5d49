"""The description and the archive of FMUs, without an importer."""

from math import pi

import pytest

import lagc
from lagc.cli.main import main
from lagc.simulation.backends import compile as compile_
from lagc.simulation.backends.cross import PLATFORMS, Platform
from tests.fmi.units import archive, contents, description

PLANE = """model Plane "two bodies and a switch"
  parameter Angle a = 30 [deg] "of the plane";
  structural Integer n = 2;
  parameter Mass m[2](min = 0) = {1, 2} [kg];
  input Force u(min = -5, max = 5) = 0.5 [N];
  coordinate Length s[n], r(start = 0.1 [m]);
  discrete Boolean on(start = true);
  body one = Particle(mass = m[1], at = {s[1], s[2], 0});
  body two = Particle(mass = m[2], at = {r, 0, 1 [m]});
  force push = (if on then u else 0)*world.x at one;
  potential spring = 1 [N/m]*(s[1]^2 + s[2]^2 + r^2)/2;
  when s[1] > 1 [m] then
    reinit(on, false);
  end when;
  output Energy E = energy();
  output Angle turn = a;
end Plane;
"""


def variables(text: str) -> dict[str, dict[str, str]]:
    found = description(archive(text)).find("ModelVariables")
    assert found is not None
    return {v.attrib["name"]: {"type": v.tag, **v.attrib} for v in found}


def test_variables() -> None:
    found = variables(PLANE)
    assert found["a"]["unit"] == "rad" and found["a"]["displayUnit"] == "deg"
    assert float(found["a"]["start"]) == pytest.approx(pi / 6)
    assert found["m[2]"] == {
        **found["m[2]"],
        "unit": "kg",
        "min": "0.0",
        "start": "2.0",
        "variability": "tunable",
    }
    assert found["u"] == {**found["u"], "causality": "input", "start": "0.5", "min": "-5.0", "max": "5.0"}
    assert found["r"]["start"] == "0.1" and found["r"]["initial"] == "exact"
    assert found["der(r)"]["derivative"] == found["r"]["valueReference"]
    assert found["der(r,2)"]["unit"] == "m/s2"
    assert found["on"]["type"] == "Boolean" and found["on"]["variability"] == "discrete"
    references = [v["valueReference"] for v in found.values()]
    assert len(set(references)) == len(references)


def test_units_and_constants() -> None:
    root = description(archive(PLANE))
    degree = root.find(".//Unit[@name='rad']/DisplayUnit[@name='deg']")
    assert degree is not None and float(degree.attrib["factor"]) == pytest.approx(180 / pi)
    joule = root.find(".//Unit[@name='J']/BaseUnit")
    assert joule is not None and joule.attrib == {"kg": "1", "m": "2", "s": "-2"}
    assert "Constants of this code: n." in root.attrib["description"]


@pytest.mark.full
def test_every_initial_unknown_is_listed() -> None:
    """All outputs, and the state derivatives and states that the initialization computes."""
    for model, states in ((PLANE, False), ("four_bar", True)):
        root = description(archive(model))
        found = {v.attrib["name"]: v.attrib for v in root.find("ModelVariables") or ()}
        listed = {v.attrib["valueReference"] for v in root.iter("InitialUnknown")}
        derivatives = {v.attrib["valueReference"] for v in root.iter("ContinuousStateDerivative")}
        of_states = {v["derivative"] for v in found.values() if "derivative" in v}
        computed = {
            v["valueReference"] for v in found.values() if v.get("initial") in ("calculated", "approx")
        }
        outputs = {v["valueReference"] for v in found.values() if v["causality"] == "output"}
        assert listed == computed & (outputs | derivatives | of_states)
        assert (of_states <= listed) == states


@pytest.mark.full
def test_start_values_are_those_of_a_run() -> None:
    system = lagc.load("four_bar").compile()
    own = dict(zip(system.interface.state_names, system.start()))
    found = {v.attrib["name"]: v.attrib for v in description(archive("four_bar")).iter("Float64")}
    assert all(float(found[name]["start"]) == value for name, value in own.items())


def test_the_same_bytes() -> None:
    first = archive("simple_pendulum")
    archive.cache_clear()
    assert archive("simple_pendulum") == first
    assert "documentation/licenses/license.txt" in contents(first)


def test_fmi2_counts_from_one() -> None:
    root = description(archive("bouncing_ball", 2))
    assert root.attrib["fmiVersion"] == "2.0" and root.attrib["numberOfEventIndicators"] == "1"
    names = [v.attrib["name"] for v in root.iter("ScalarVariable")]
    places = [int(v.attrib["index"]) for v in root.findall("ModelStructure/Derivatives/Unknown")]
    assert [names[k - 1] for k in places] == ["der(y)", "der(y,2)"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--platforms", "amiga"], "is no platform"),
        (["--real", "float"], "--real needs --target c"),
        (["--derivatives"], "leave --derivatives out"),
        (["--events"], "--events needs --target c"),
        (["-o", "pendulum.fmu"], "-o names the folder"),
    ],
)
def test_wrong_usage(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "simple_pendulum", "--target", "fmu3", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.long
@pytest.mark.parametrize("platform", PLATFORMS, ids=[platform.name for platform in PLATFORMS])
def test_libraries_for_other_machines(platform: Platform, monkeypatch: pytest.MonkeyPatch) -> None:
    """zig links them: the first bytes are those of ELF, PE or Mach-O, and two builds are the same bytes, as
    users have them: with optimization."""
    pytest.importorskip("ziglang")
    monkeypatch.setattr(compile_, "FLAGS", (*compile_.FLAGS, "-O2"))
    first = archive("simple_pendulum", 3, (platform,))
    (library,) = [
        data for file, data in contents(first).items() if file.startswith(f"binaries/{platform.name}/")
    ]
    assert library[:4] in (b"\x7fELF", b"MZ\x90\x00", b"MZ\x78\x00", b"\xcf\xfa\xed\xfe")
    archive.cache_clear()
    assert archive("simple_pendulum", 3, (platform,)) == first
