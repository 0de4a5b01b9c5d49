"""What a start has to have besides meeting its conditions: bounds that hold, finite energies, inertia."""

import math
import random
from pathlib import Path

import numpy
import pytest

import lagc
from lagc.cli.main import main
from tests.simulation.initialization.generated_starts import Starts, program_of

DERIVED = """\
model M
  parameter Real q = {q}, s = 1;
  parameter Real p(min = -1, max = 2) = {derived};
  coordinate Length x(start = 1 [m]), y;
  body b = Particle(mass = 1, at = {{x, y, 0}});
  constraint c: y = 2*x;
  force f = {{p*1[N], 0, 0}} at b;
end M;
"""
FORMS = {
    "q": lambda q, s: q,
    "q - s": lambda q, s: q - s,
    "2*sin(q) - s": lambda q, s: 2 * math.sin(q) - s,
    "q*s/2": lambda q, s: q * s / 2,
}


def refused(model: lagc.CompiledModel, **values: float) -> bool:
    try:
        model.bind(values)
    except lagc.Refused as found:
        assert [fault.code for fault in found.faults] == ["LAG0617"]
        return True
    return False


@pytest.mark.full
@pytest.mark.parametrize("derived", FORMS)
def test_bounds_of_derived_parameters_hold_in_bind_and_in_checks_of_generated_code(derived: str) -> None:
    """For random values; what is derived is known in closed form."""
    text = DERIVED.format(q=1, derived=derived)
    model = lagc.loads(text).compile(backend="numpy")
    twins, dice, seen = Starts(program_of(text)), random.Random(derived), set()
    for _ in range(40):
        q, s = dice.uniform(-4, 4), dice.uniform(-4, 4)
        out = not -1.0 <= FORMS[derived](q, s) <= 2.0
        assert refused(model, q=q, s=s) == out
        names = [f.name for f in twins.interface.parameters]
        given = {"q": q, "s": s}
        p = [given[name] for name in names]
        assert twins.checked(p) == (len(p) if out else None)
        seen.add(out)
    assert seen == {False, True}


def test_bounds_of_derived_parameters_hold_in_commands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "m.lag"
    file.write_text(DERIVED.format(q=3, derived="q"))
    assert main(["check", str(file)]) == 1
    assert "`p` = 3 is above its maximum, 2" in capsys.readouterr().out
    assert main(["sim", str(file), "--backend", "numpy"]) == 1
    assert main(["sim", str(file), "--backend", "numpy", "--stop", "0", "-p", "q=2"]) == 0
    assert main(["check", str(file), "-p", "q=2"]) == 0


BODY = """\
model M
  parameter Mass m1 = {m1}, m2 = {m2};
  coordinate Length x(start = 1 [m]);
  body b = Particle(mass = {mass}, at = {{x, 0, 0}});
end M;
"""


@pytest.mark.sample(3)
@pytest.mark.parametrize("mass", ["m1", "m1 - m2", "m1*m2/(1[kg])", "2*m1 + m2"])
def test_no_mass_is_negative(mass: str) -> None:
    dice, seen = random.Random(mass), set()
    for _ in range(8):
        m1, m2 = dice.uniform(-2, 2), dice.uniform(-2, 2)
        value = eval(mass.replace("(1[kg])", "1"), {"m1": m1, "m2": m2})
        codes = {fault.code for fault in lagc.loads(BODY.format(m1=m1, m2=m2, mass=mass)).check()}
        assert ("LAG0617" in codes) == (value < 0.0)
        seen.add(value < 0.0)
    assert seen == {False, True}


SOLID = """\
model M
  parameter Inertia i1 = {0!r}, i2 = {1!r}, i3 = {2!r};
  coordinate Angle q(rate = 1 [rad/s]);
  frame R = rotate_z(world, q);
  Solid b(mass = 1, inertia = {inertia}, frame = R, com = {{0, 0, 0}});
end M;
"""
INERTIAS = ["{i1, i2, i3}", "{{i1, 0, 0}, {0, i2, 0}, {0, 0, i3}}", "{2*i1, i2 + i1, i3}"]


@pytest.mark.parametrize("inertia", INERTIAS)
def test_no_moment_of_inertia_is_more_than_the_others_together(inertia: str) -> None:
    """Those of random points are in bounds, flat ones too; random numbers may not be."""
    dice, seen = random.Random(inertia), set()
    model = lagc.loads(
        SOLID.replace("{inertia}", inertia.replace("{", "{{").replace("}", "}}")).format(1, 1, 1)
    )
    bound = model.compile(backend="numpy")
    for k in range(40):
        x, y, z = (dice.uniform(0.0, 1.0) for _ in range(3))
        i = [y + z, z + x, x + y] if k % 2 else [x, y, z]
        if k % 4 == 1:
            i = [x, y, x + y]
        told = [2 * i[0], i[1] + i[0], i[2]] if "2*" in inertia else i
        out = 2 * max(told) > sum(told) * (1 + 1e-12)
        assert refused(bound, i1=i[0], i2=i[1], i3=i[2]) == out
        seen.add(out)
    assert seen == {False, True}


FORM = """\
model M
  coordinate Length x(start = 1 [m]), y(start = 2 [m]), z(start = 3 [m]);
  kinetic k = 1[kg]*({form});
  {more}
end M;
"""


@pytest.mark.sample(3)
@pytest.mark.parametrize("seed", range(12))
def test_a_kinetic_energy_is_positive_on_what_constraints_allow(seed: int) -> None:
    """Random forms of three rates, free or on a random plane; NumPy's eigenvalues tell."""
    dice = numpy.random.default_rng(seed)
    m = dice.normal(size=(3, 3)) + dice.uniform(0.0, 3.0) * numpy.eye(3)
    m = m + m.T
    normal = dice.normal(size=3)
    rates = ("der(x)", "der(y)", "der(z)")
    form = " + ".join(f"({m[i, j] / 2})*{rates[i]}*{rates[j]}" for i in range(3) for j in range(3))
    plane = "constraint c: " + " + ".join(f"({a})*{q}" for a, q in zip(normal, "xyz")) + " = 1 [m];"
    allowed = numpy.linalg.svd(normal[None])[2][1:]
    for more, left in (("", m), (plane, allowed @ m @ allowed.T)):
        codes = {fault.code for fault in lagc.loads(FORM.format(form=form, more=more)).check()}
        assert ("LAG0615" in codes) == (numpy.linalg.eigvalsh(left)[0] < 0.0)


STRANGE = """\
model M
  coordinate Length x(start = 1 [m], rate = {rate} [m/s]);
  body b = Particle(mass = 1, at = {{x, 0, 0}});
  {more}
end M;
"""


@pytest.mark.sample(5)
@pytest.mark.parametrize(("more", "rate", "code"), [
    ("potential v = 1[J]*log(-x/(1[m]));", "0", "LAG0613"),
    ("potential v = 1[J]*sqrt(x/(1[m]) - 2);", "0", "LAG0613"),
    ("", "1e155", "LAG0613"),
    ("output Real o = log(x/(1[m]) - 1);", "0", "LAG0616"),
    ("output Real o = 1/(x/(1[m]) - 1);", "0", "LAG0616"),
])  # fmt: skip
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_what_is_not_finite_at_the_start_is_told_by_check_and_sim(
    more: str, rate: str, code: str, backend: str
) -> None:
    model = lagc.loads(STRANGE.format(more=more, rate=rate))
    assert [fault.code for fault in model.check()] == [code]
    if code == "LAG0616":
        run = model.compile(backend=backend).simulate(stop=1)
        assert "output `o` has no finite initial value" in run.notes
    else:
        with pytest.raises(lagc.Refused) as found:
            model.compile(backend=backend).simulate(stop=1)
        assert [fault.code for fault in found.value.faults] == [code]
