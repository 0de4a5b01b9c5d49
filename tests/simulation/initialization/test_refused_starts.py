"""What has no first step: `check` and `sim` refuse it with the same words, at the place that forces it."""

import random
from dataclasses import dataclass

import pytest

import lagc
from lagc.base.text import Quantity
from lagc.cli.main import main
from lagc.compiler import checking, pipeline
from lagc.diagnostics.faults import Fault, Refused, Source

FORM = """model Bead
  parameter Mass m = {m};
  parameter Length l = {l};
  parameter Length s = {s};
  coordinate Length x({x});
  coordinate Length y;
  body bead = Particle(mass = m, at = {{x, y, 0}});
  potential spring = 1[N/m]*(x - s)^2 + 1[N/m]*y^2;
{more}
end Bead;
"""


@dataclass(frozen=True)
class Case:
    text: str
    code: str  # "" where there is a first step
    line: str = ""  # a part of the line that forces it
    named: str = ""  # what the message names


def number(dice: random.Random) -> float:
    """Of any size, and positive."""
    return float(f"{10.0 ** dice.uniform(-6, 6):.4g}")


def case(seed: int) -> Case:
    """A bead on a plane with something that has a value, or not, as its numbers say."""
    dice = random.Random(seed)
    kind = dice.choice(["mass", "logarithm", "quotient", "root", "start", "circle", "held", "initial"])
    l, s, x0 = number(dice), number(dice), number(dice)  # noqa: E741
    good = dice.random() < 0.4
    given = {"m": "1", "l": repr(l), "s": repr(s), "x": f"start = {x0!r}", "more": ""}

    def made(code: str, line: str, named: str, **more: str) -> Case:
        text = FORM.format(**{**given, **more})
        return Case(text, "") if good else Case(text, code, line, named)

    if kind == "mass":
        mass = number(dice) if good else 0.0
        return made("LAG0612", "coordinate Length x", "`der(x)`", m=repr(mass))
    if kind == "logarithm":
        sign = "" if good else "-"
        line = f"  force F = {{0[N], 1[N]*log({sign}x/l), 0[N]}} at bead;"
        return made("LAG0613", "force F", "log(", more=line)
    if kind == "quotient":
        line = f"  force F = {{1[N]*l/(x - {x0 if not good else 2 * x0!r}[m]), 0[N], 0[N]}} at bead;"
        return made("LAG0613", "force F", "has no finite value", more=line)
    if kind == "root":
        length = l if good else -l
        line = "  force F = {0[N], 1[N]*sqrt(l/s), 0[N]} at bead;"
        return made("LAG0613", "force F", "`sqrt(", l=repr(length), more=line)
    if kind == "start":
        length = l if good else -l
        return made("LAG0611", "coordinate Length x", "`sqrt(", x="start = s*sqrt(l/s)", l=repr(length))
    if kind == "circle":
        sign = "" if good else "-"
        return made("LAG0610", "constraint c", "`c`", more=f"  constraint c: x^2 + y^2 = {sign}l^2;")
    if kind == "held":
        held = "" if good else ", fixed = true"
        line = "  constraint c: x = 3*l;"
        return made("LAG0610", "constraint c", "`c`", x=f"start = l{held}", more=line)
    place = "2*y = l" if good else "x^2 + l^2 = 0[m2]"
    return made("LAG0610", place, "condition", more=f"initial\n  {place};")


def refused(text: str) -> list[Fault]:
    """By a run."""
    try:
        lagc.loads(text, "m.lag").compile(backend="numpy").simulate(stop=1e-9, method="dopri5", rtol=1e-3)
    except Refused as found:
        return list(found.faults)
    return []


@pytest.mark.full
@pytest.mark.parametrize("first", range(0, 60, 20))
def test_check_tells_what_a_run_refuses(first: int) -> None:
    seen = set()
    for seed in range(first, first + 20):
        made = case(seed)
        checked = [f for f in lagc.loads(made.text, "m.lag").check() if f.severity == "error"]
        assert checked == refused(made.text), made.text
        assert [f.code for f in checked] == ([made.code] if made.code else []), (seed, made.text)
        seen.add(made.code)
        for fault in checked:
            assert fault.span is not None and fault.span.source.name == "m.lag"
            line = fault.span.source.line(fault.span.line)
            assert made.line in line and made.named in fault.message, (seed, made.text, fault)
            assert "nan" not in fault.message
    assert len(seen) > 2 and "" in seen


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_both_backends_refuse_alike(backend: str) -> None:
    text = FORM.format(m="0", l="1", s="2", x="start = 1", more="")
    if backend == "c":
        from lagc.simulation.backends.compile import compiler as found

        if found() is None:
            pytest.skip("there is no compiler")
    for step in (None, 0.1):
        with pytest.raises(Refused) as caught:
            lagc.loads(text, "m.lag").compile(backend=backend).simulate(1.0, step=step)
        (fault,) = caught.value.faults
        assert fault.code == "LAG0612" and "the mass of `bead` is 0 kg" in fault.related[0][1]


SCENES = """model Bead
  parameter Mass m(min = 0.5) = 1;
  parameter Length l;
  coordinate Length x(start = 1);
  body bead = Particle(mass = m, at = {x, 0, 0});
  force F = {1[N]*log(x/l), 0[N], 0[N]} at bead;
end Bead;
"""


def faults(**given: float) -> list[tuple[str, str]]:
    choice = pipeline.Choice(parameters={name: Quantity(value) for name, value in given.items()})
    return [(f.code, f.severity) for f in checking.check(Source("m.lag", SCENES), choice)]


def test_given_parameters_are_those_of_a_run() -> None:
    assert faults() == [("LAG0603", "warning")]  # not known, not tried, told
    assert faults(l=2.0) == []
    assert faults(l=-2.0) == [("LAG0613", "error")]
    assert faults(l=2.0, m=0.25) == [("LAG0602", "error")]
    assert faults(l=2.0, k=1.0) == [("LAG0601", "error")]


@pytest.mark.sample(2)
@pytest.mark.parametrize("size", [1e200, -3e250, 1e280])
def test_what_is_finite_is_a_start(size: float) -> None:
    """Stated or found; where it is too large for a row, or an energy, this is told to have no value."""
    form = """\
model M
  coordinate Length x(start = {x!r} [m]{rate}), y;
  body b = Particle(mass = 1, at = {{x, y, 0}});
  constraint c: {row};
end M;
"""

    def codes(row: str, rate: str = "") -> list[str]:
        text = form.format(x=size, rate=rate, row=row)
        return [f.code for f in checking.check(Source("m.lag", text), pipeline.Choice())]

    assert codes("y = 2*x") == codes("x = 2*y") == []
    assert codes("x^2 + y^2 = 1 [m2]") == ["LAG0610"]
    assert codes("y = 2*x", ", rate = 1e200 [m/s]") == ["LAG0613"]


def test_the_exit_code_of_check_is_that_of_sim(
    tmp_path: object, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LAGC_CACHE", "")
    path = f"{tmp_path}/m.lag"
    with open(path, "w") as file:
        file.write(SCENES)
    assert main(["check", "-p", "l=3", path]) == 0
    assert main(["check", "-p", "l=-3[m]", "--no-color", path]) == 1
    said = capsys.readouterr().out
    assert main(["sim", "-p", "l=-3[m]", "--backend", "numpy", "--no-color", path]) == 1
    assert capsys.readouterr().err.strip() in said
    assert main(["check", "-p", "l", path]) == 2
