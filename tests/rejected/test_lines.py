"""Lines as students and users of MATLAB, Modelica, Python and C write them, and the lines to write.

A row of `lines.txt` is `CODE wrong line ==> right line`, put at the end of a pendulum.  The wrong line gives
one fault, at the place between the guillemets.  What its remedy says to write stands in the right line,
which gives none.
"""

import re
from pathlib import Path
from typing import NamedTuple

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Source

PENDULUM = """\
model P
  parameter Mass m = 1 [kg];
  parameter Length l = 0.5 [m];
  coordinate Angle theta(start = 1);
  body b = Particle(mass = m, at = l*{sin(theta), 0, -cos(theta)});
  Gravity field;
  """


class Row(NamedTuple):
    code: str
    wrong: str
    right: str


def rows() -> list[Row]:
    lines = (Path(__file__).parent / "lines.txt").read_text().splitlines()
    split = [line.partition(" ") for line in lines if line and not line.startswith("#")]
    return [Row(code, *rest.split(" ==> ")) for code, _, rest in split]


def found(line: str) -> list[Fault]:
    return check(Source("line.lag", f"{PENDULUM}{line}\nend P;\n"), Choice())


def errors(faults: list[Fault]) -> list[Fault]:
    return [fault for fault in faults if fault.severity == "error"]


def without_blanks(text: str) -> str:
    return re.sub(r"\s", "", text)


ROWS = rows()


@pytest.mark.sample(60)
@pytest.mark.parametrize("row", ROWS, ids=[row.wrong for row in ROWS])
def test_the_remedy_of_a_line_is_in_the_right_line(row: Row) -> None:
    wrong = row.wrong.replace("«", "").replace("»", "")
    (fault,) = found(wrong)
    place = row.wrong.index("«"), row.wrong.index("»") - 1
    assert fault.code == row.code
    assert fault.span is not None
    assert (fault.span.start, fault.span.end) == tuple(len(PENDULUM) + at for at in place), fault.span.text
    remedy, right = fault.remedy or "", without_blanks(row.right)
    pieces = [without_blanks(piece) for piece in re.findall(r"`([^`]+)`", remedy)]
    left_out = remedy.startswith(("leave it out", "delete it")) and len(right) < len(without_blanks(wrong))
    assert left_out or any(piece in right for piece in pieces), remedy


HARDER = ("«F0»*cos", "(1 - cos theta)")  # a name that is not declared at all, a line with two faults
EDITED = [row for row in ROWS if not any(words in row.wrong for words in HARDER)]


@pytest.mark.sample(10, 60)
@pytest.mark.parametrize("row", EDITED, ids=[row.wrong for row in EDITED])
def test_the_edits_of_a_line_correct_it(row: Row) -> None:
    wrong = row.wrong.replace("«", "").replace("»", "")
    (fault,) = found(wrong)
    text = f"{PENDULUM}{wrong}"
    for edit in fault.edits:
        text = text[: edit.start] + edit.text + text[edit.end :]
    right = text.removeprefix(PENDULUM)
    assert not fault.edits or without_blanks(right) == without_blanks(row.right) or not errors(found(right))


@pytest.mark.sample(20)
@pytest.mark.parametrize("row", ROWS, ids=[row.right for row in ROWS])
def test_the_right_line_is_accepted(row: Row) -> None:
    assert [(fault.code, fault.message) for fault in found(row.right)] == []


@pytest.mark.parametrize(
    ("line", "remedies"),
    [("output Angle a = asind(0.5);", ["write `asin(x)`, in rad: `asin(x)/(1 [deg])` is the number of "
      "degrees"]),
     ("output Real a = length({1, 2});", ["write `norm(v)` for the length of a vector, `size(x)` for the "
      "number of elements of an array"]),
     ("parameter Mass M = 2 [ton];", ["write `[t]` for 1000 kg; a US ton is `907.18474 [kg]`, a British one "
      "`1016.0469 [kg]`"]),
     ("parameter Real T = 20 [degC];", ["write kelvins: 20 °C are `293.15 [K]`, and a difference of 1 °C is "
      "`1 [K]`"]),
     ("dissipation D = 1/2*c*v^2;", ["declare `v` first: the dimension of `c` follows from it",
      "write the rate `der(x)` of a coordinate, or declare `speed Velocity v = der(x);`"])],
)  # fmt: skip
def test_remedies_that_depend_on_what_is_meant(line: str, remedies: list[str]) -> None:
    assert [fault.remedy for fault in found(line)] == remedies


def test_what_these_remedies_say_is_so() -> None:
    assert found("output Real a = asin(0.5)/(1 [deg]); output Real n = size({1, 2}), r = norm({3, 4});") == []
    assert found("speed AngularVelocity v = der(theta); parameter RotationalDamping c = 1 [N.m.s/rad]; "
                 "dissipation D = 1/2*c*v^2;") == []  # fmt: skip
