"""Units against the definitions of the SI (BIPM, *The International System of Units*, 9th ed., 2019)."""

import math
import random
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source
from lagc.semantics.resolve import resolve
from lagc.semantics.units import (
    KG,
    NONE,
    Dimension,
    M,
    UnknownUnit,
    dimension,
    over,
    raised,
    si_text,
    times,
    to_si,
    unit,
)
from lagc.semantics.values.unit_hints import spelling_remedy
from lagc.syntax.parse import parse


@pytest.mark.parametrize(
    "text, factor, exponents",
    [
        ("kg", 1.0, {"kg": 1}),
        ("g", 1e-3, {"kg": 1}),
        ("t", 1e3, {"kg": 1}),
        ("mm", 1e-3, {"m": 1}),
        ("km/h", 1 / 3.6, {"m": 1, "s": -1}),
        ("m/s2", 1.0, {"m": 1, "s": -2}),
        ("m/s^2", 1.0, {"m": 1, "s": -2}),
        ("m.s-2", 1.0, {"m": 1, "s": -2}),
        ("m*s^(-2)", 1.0, {"m": 1, "s": -2}),
        ("kg.m2/s2", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("m3/(kg.s2)", 1.0, {"kg": -1, "m": 3, "s": -2}),
        ("W/m2.K", 1.0, {"kg": 1, "s": -3, "K": -1}),  # a/b.c is a/(b.c), ISO 80000-1
        ("N.m/rad", 1.0, {"kg": 1, "m": 2, "s": -2}),
        ("kN", 1e3, {"kg": 1, "m": 1, "s": -2}),
        ("hPa", 1e2, {"kg": 1, "m": -1, "s": -2}),
        ("mT", 1e-3, {"kg": 1, "s": -2, "A": -1}),
        ("rpm", 2 * math.pi / 60, {"s": -1}),
        ("deg/s", math.pi / 180, {"s": -1}),
        ("rev", 2 * math.pi, {}),
        ("%", 1e-2, {}),
        ("eV", 1.602176634e-19, {"kg": 1, "m": 2, "s": -2}),
        ("1/s", 1.0, {"s": -1}),
    ],
)
def test_a_unit_means_what_the_si_says(text: str, factor: float, exponents: dict[str, int]) -> None:
    found = unit(text)
    assert found.dimension == dimension(**exponents)
    assert found.factor == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    "text", ["", " ", "foo", "m//s", "m/", "(m", "m)", "m^", "m^x", "2", "kg m", "m^1000", "k"]
)
def test_what_is_no_unit_is_said(text: str) -> None:
    with pytest.raises(UnknownUnit):
        unit(text)


def test_a_unit_of_many_factors_is_bounded() -> None:
    with pytest.raises(UnknownUnit, match="64"):
        unit(".".join(["m"] * 100))


@pytest.mark.parametrize(
    "value, text, wanted", [(70.0, "cm", 0.7), (9.81, "m/s2", 9.81), (0.1, "mm", 1e-4), (1e-3, "g", 1e-6)]
)
def test_a_decimal_is_converted_without_an_error(value: float, text: str, wanted: float) -> None:
    assert unit(text).to_si(value) == wanted


@given(st.floats(1e-250, 1e250), st.sampled_from(["mm", "km/h", "deg", "rpm", "lb", "g", "bar", "eV"]))
def test_there_and_back(value: float, text: str) -> None:
    meant = unit(text)
    assert meant.to_si(value) / meant.factor == pytest.approx(value, rel=1e-14)


def test_units_are_converted_between_equal_dimensions_only() -> None:
    assert to_si(70.0, "cm", "m") == 0.7
    with pytest.raises(UnknownUnit, match="cannot be converted"):
        to_si(70.0, "cm", "s")


_DIMENSIONS = st.tuples(*[st.integers(-4, 4).map(lambda n: 12 * n)] * 7)


@given(_DIMENSIONS, _DIMENSIONS)
def test_dimensions_form_a_group(a: tuple[int, ...], b: tuple[int, ...]) -> None:
    assert over(times(a, b), b) == a
    assert times(a, over(NONE, a)) == NONE
    assert raised(a, 2.0) == times(a, a)
    half = raised(a, 0.5)
    assert half is not None and times(half, half) == a


@given(_DIMENSIONS)
def test_the_name_of_a_dimension_is_read_back(a: tuple[int, ...]) -> None:
    assert unit(si_text(a) or "1").dimension == a


def test_the_remedy_for_a_wrong_unit_mends_it() -> None:
    """Of random types and units: what is written as the fault says has the declared dimension."""
    rng = random.Random(7)
    types = ["Mass", "Length", "Velocity", "Force", "Inertia", "Pressure", "Real", "Viscosity", "Charge"]
    units = ["kg", "mm", "m/s", "N.m", "kg.m2/s2", "1/s", "A", "K", "W/(m2.K)", "l", "bar"]
    mended = 0
    for _ in range(60):
        value = rng.choice((f"{rng.randrange(1, 99)}", "2.5e-3", "-7.")) + f" [{rng.choice(units)}]"
        text = f"model A\n  parameter {rng.choice(types)} p = {value};\n  coordinate Real x;\nend A;\n"
        try:
            resolve(parse(Source("a.lag", text)))
        except Refused as refused:
            (fault,) = [f for f in refused.faults if f.code == "LAG0302"]
            words = re.findall("`([^`]*)`", fault.remedy or "")
            new = value.replace(words[-1], words[0] if len(words) == 2 else "")
            resolve(parse(Source("a.lag", text.replace(value, new))))
            mended += 1
    assert mended > 40


@pytest.mark.parametrize(
    "written, warned",
    [
        ("coordinate Angle q(start = 45);", ["45"]),
        ("coordinate Angle q(start = -45);", ["45"]),
        ("coordinate Angle q(start = 45 [rad]);", []),
        ("coordinate Angle q(start = 45 [deg]);", []),
        ("coordinate Angle q(start = 7.5e1); scene s start q = 20; end s;", ["7.5e1", "20"]),
        ("coordinate Angle q(start = 3);", []),
        ("coordinate Angle q(start = 12.5);", []),
        ("parameter Angle a = 30; coordinate Angle q(start = a);", ["30"]),
        ("coordinate Real q(start = 45);", []),
    ],
)
def test_whole_numbers_of_many_radians_are_asked_after(written: str, warned: list[str]) -> None:
    text = f"model M {written} body b = Particle(mass = 1, at = {{sin(q)*1 [m], 0, 0}}); end M;"
    found = [f for f in check(Source("m.lag", text), Choice()) if f.code != "LAG0429"]
    assert [f.code for f in found] == ["LAG0618"] * len(warned)
    assert [text[f.span.start : f.span.end] for f in found if f.span] == warned


@pytest.mark.parametrize(
    "written, codes",
    [
        ("frame F = rotate_y(world, 30);", ["LAG0618"]),
        ("frame F = rotate(world, world.x + world.y, -45);", ["LAG0618"]),
        ("frame F = rotate_z(world, 30 [deg]);", []),
        ("frame F = rotate_x(world, 1.5);", []),
        ("parameter AngularVelocity w = 50 [Hz];", ["LAG0619"]),
        ("parameter AngularVelocity w = 2*pi*50 [Hz], u = 300 [rpm], v = 3;", []),
        ("parameter Frequency f = 50 [Hz];", []),
        ("coordinate Angle a(rate = 2 [kHz]); body c = Particle(mass = 1, at = {0, a*1 [m], 0});",
         ["LAG0619"]),
        ("coordinate Angle a; body c = Particle(mass = 1, at = {0, a*1 [m], 0});"
         " scene s start der(a) = 1 [Hz]; end s;", ["LAG0619"]),
        ("Gravity field(g = -9.81);", ["LAG0434"]),
        ("Gravity field(g = -9.81 [m/s2], direction = {0, 0, -1});", ["LAG0434"]),
        ("effect e Gravity field(g = -9.81 [m/s2]); end e; scene s uses e;", ["LAG0434"]),
        ("Gravity field(g = -9.81 [m/s2], direction = world.z);", []),
        ("Gravity field(g = 1.62 [m/s2]);", []),
    ],
)  # fmt: skip
def test_numbers_of_another_unit_or_sign_are_asked_after(written: str, codes: list[str]) -> None:
    body = "body b = Particle(mass = 1, at = {0, 0, z});"
    text = f"model M coordinate Length z(rate = 1); {body} {written} end M;"
    assert [f.code for f in check(Source("m.lag", text), Choice()) if f.code != "LAG0429"] == codes


def test_models_of_one_name_are_each_looked_at() -> None:
    text = "".join(
        f"package {package} model A coordinate Angle a(start = {start}); body b = Particle(mass = 1, "
        f"at = {{sin(a)*1 [m], 0, 0}}); end A; end {package};\n"
        for package, start in (("P", 30), ("Q", -40))
    )
    found = [f for f in check(Source("m.lag", text), Choice()) if f.code == "LAG0618"]
    assert [f.message for f in found] == ["`a` is 30 radians", "`a` is -40 radians"]


def test_an_angle_is_one_of_its_model_and_of_those_that_extend_it() -> None:
    text = """model Counted
  parameter Real n = 20;
  coordinate Length x;
  body b = Particle(mass = 1 [kg], at = {n*x, 0, 0});
end Counted;
partial model Turning
  coordinate Angle n;
  body b = Particle(mass = 1 [kg], at = 1 [m]*{sin(n), 0, cos(n)});
end Turning;
model Turned
  extends Turning;
  scene s
    start n = 45;
  end s;
end Turned;
"""
    (fault,) = [f for f in check(Source("m.lag", text), Choice()) if f.code != "LAG0429"]
    assert fault.code == "LAG0618" and fault.message == "`n` is 45 radians"


@pytest.mark.parametrize("text", ["N/m^1.5", "N/m^(3/2)", "m^-0.5", "kg/m^(0.5)"])
def test_exponents_of_units_are_whole(text: str) -> None:
    """As those of Hertz' stiffness are not: a way out is told."""
    with pytest.raises(UnknownUnit) as refused:
        unit(text)
    assert "integers" in refused.value.reason and "^1.5" in (spelling_remedy(text) or "")


def test_exponents_may_stand_in_parentheses() -> None:
    assert unit("m^(-2)") == unit("m-2") == unit("1/m2") and unit("m^2.kg") == unit("kg.m2")


@pytest.mark.parametrize(
    ("text", "wanted", "proposed"),
    [
        ("kk", KG, "[kg]"), ("xm", M, "m]"), ("m/z2", unit("m/s2").dimension, "[m/s2]"),
        ("rad/z", unit("1/s").dimension, "[rad/s]"), ("N.x", unit("N.m").dimension, "[N.m]"),
        ("qq", unit("kg/m3").dimension, "[kg/m3]"),
    ],
)  # fmt: skip
def test_the_proposal_for_a_unit_has_the_dimension_of_its_place(
    text: str, wanted: Dimension, proposed: str
) -> None:
    assert proposed in (spelling_remedy(text, wanted) or "")
