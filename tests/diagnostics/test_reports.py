"""Faults as a person sees them: whole reports, letter by letter."""

from pathlib import Path

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Source, Span, as_json, report
from lagc.diagnostics.suggest import closest, did_you_mean, foreign_call


def shown(text: str, name: str = "m.lag") -> str:
    return report(check(Source(name, text), Choice()))


MANY = """\
model Many
  parameter Mass m = 1 [kgg];
  parameter Length l = 0.5;
  coordinate Angle theta(start = 60 [deg], strt = 2);
  body bob = Particle(mass = 1, at = l*{sin(thet), 0, -cos(theta)});
  body ball = Particle(mass = 1, at = {theta*l, 2, 0});
  scene s parameter ll = 3; start thta = 3; end s;
end Many;
"""


def test_all_faults_of_a_file_in_the_order_of_their_places() -> None:
    assert (
        shown(MANY)
        == """\
error[LAG0304]: `kgg` is not a unit
  --> m.lag:2:24
   |
 2 |   parameter Mass m = 1 [kgg];
   |                        ^^^^^
   = help: did you mean `[kg]`?

error[LAG0209]: a coordinate has no `strt`
  --> m.lag:4:44
   |
 4 |   coordinate Angle theta(start = 60 [deg], strt = 2);
   |                                            ^^^^
   = help: did you mean `start`?

error[LAG0201]: `thet` is not declared
  --> m.lag:5:45
   |
 5 |   body bob = Particle(mass = 1, at = l*{sin(thet), 0, -cos(theta)});
   |                                             ^^^^
   = help: did you mean `theta`?

error[LAG0301]: the elements have different dimensions: Length [m] and a number
  --> m.lag:6:49
   |
 6 |   body ball = Particle(mass = 1, at = {theta*l, 2, 0});
   |                                                 ^
   |                                        ------- Length [m]
   = help: a number inside an expression has no unit: write `2 [m]`

error[LAG0215]: there is no parameter or input `ll`
  --> m.lag:7:21
   |
 7 |   scene s parameter ll = 3; start thta = 3; end s;
   |                     ^^
   = help: did you mean `l`?

error[LAG0224]: there is no coordinate, rate or speed `thta`
  --> m.lag:7:35
   |
 7 |   scene s parameter ll = 3; start thta = 3; end s;
   |                                   ^^^^
   = help: did you mean `theta`?

6 errors"""
    )


def test_a_fault_in_a_function_shows_who_calls_it() -> None:
    text = """\
model A
  function f(Length u) = u + 1 [s];
  function g(Length u) = f(2*u);
  coordinate Length x;
  output Length y = g(x);
  output Length z = g(3*x);
end A;
"""
    assert (
        shown(text)
        == """\
error[LAG0301]: the two sides of `+` have different dimensions: Length [m] and Time [s]
  --> m.lag:2:28
   |
 2 |   function f(Length u) = u + 1 [s];
   |                            ^
   |                          - Length [m]
   |                              ----- Time [s]
  ::: m.lag:3:26
   |
 3 |   function g(Length u) = f(2*u);
   |                          ------ called here
  ::: m.lag:5:21
   |
 5 |   output Length y = g(x);
   |                     ---- called here"""
    )


def test_tabs_wide_letters_and_line_ends() -> None:
    letters = "\N{CJK UNIFIED IDEOGRAPH-65E5}e\N{COMBINING ACUTE ACCENT}"
    text = f"model A\r\n\tcoordinate Length x; /* {letters} */\tpotential V = 2*y;\r\nend A;\r\n"
    lines = shown(text).splitlines()
    assert lines[1] == "  --> m.lag:2:49"
    under = lines[4].split("|", 1)[1][1:]
    source = lines[3].split("|", 1)[1][1:]
    assert under.strip() == "^"
    # the ideograph takes two columns and the accent none: together as many as letters
    assert source[under.index("^")] == "y" and "\t" not in source and "\r" not in source


def test_a_long_line_is_shown_around_the_fault() -> None:
    text = "model A coordinate Length x; potential V = 1 [N]*(" + "x+" * 300 + "yy" + "+x" * 300 + "); end A;"
    lines = shown(text).splitlines()
    at = text.index("yy") + 1
    assert lines[1] == f"  --> m.lag:1:{at}"
    assert all(len(line) <= 120 for line in lines)
    assert lines[3][lines[4].index("^") :].startswith("yy+x")
    assert lines[4].count("^") == 2


def test_faults_of_an_imported_file_are_shown_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "lib.lag").write_text("model P\n  coordinate Length x;\n  potential V = x;\nend P;\n")
    text = 'import "sub/lib.lag";\nmodel A\n  P p;\nend A;\n'
    Path("main.lag").write_text(text)
    assert (
        shown(text, "main.lag")
        == """\
error[LAG0302]: the potential `V` must be Energy [J]; this is Length [m]
  --> sub/lib.lag:3:17
   |
 3 |   potential V = x;
   |                 ^
   = help: a factor with the unit `[N]` is missing"""
    )


def test_syntax_faults_of_an_imported_file_come_with_the_import(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lib.lag").write_text("model P coordinate Length x = ; end P;")
    text = 'import "lib.lag";\nmodel A P p; end A;\n'
    Path("main.lag").write_text(text)
    faults = check(Source("main.lag", text), Choice())
    places = [(f.code, f.span.source.name) for f in faults if f.span]
    assert ("LAG0216", "main.lag") in places and ("LAG0131", "lib.lag") in places


def test_json_says_the_same() -> None:
    (found, *_) = as_json(
        check(Source("m.lag", "model A coordinate Length x; potential V = x + 1 [s]; end A;"), Choice())
    )
    assert found["code"] == "LAG0301" and found["severity"] == "error"
    assert (found["file"], found["line"], found["column"]) == ("m.lag", 1, 46)
    assert (found["end_line"], found["end_column"]) == (1, 47)
    related = found["related"]
    assert isinstance(related, list)
    assert [(r["label"], r["column"]) for r in related] == [("Length [m]", 44), ("Time [s]", 48)]


def test_json_says_what_to_write_instead() -> None:
    text = "model A coordinate Length x; body b = Particle(mass = 1 [kg], at = {x, 0, 0}); end A;"
    for right, wrong in (("0});", "0};"), ("{x,", "{X,"), ("[kg]", "[kx]"), ("; end", " end")):
        damaged = text.replace(right, wrong)
        (found,) = as_json(check(Source("m.lag", damaged), Choice()))
        edits = found["edits"]
        assert isinstance(edits, list)
        (edit,) = edits
        assert damaged[: edit["column"] - 1] + edit["text"] + damaged[edit["end_column"] - 1 :] == text


def test_characters_that_steer_a_terminal_are_not_printed() -> None:
    source = Source("m\x1b[2J.lag", "a\x1b[31mb\n")
    text = report([Fault("LAG0000", "x\x1by", Span(source, 0, 1))])
    assert "\x1b" not in text


def test_colours_are_only_added() -> None:
    faults = check(Source("m.lag", MANY), Choice())
    coloured = report(faults, color=True)
    for code in ("\033[1;31m", "\033[1;33m", "\033[1;36m", "\033[1;34m", "\033[1m", "\033[0m"):
        coloured = coloured.replace(code, "")
    assert coloured == report(faults)


@pytest.mark.parametrize(
    "name, known, found",
    [
        ("thet", ["theta", "phi"], "theta"), ("Theta0", ["phi", "theta_0"], "theta_0"), ("x", ["phi"], None),
        ("lenght", ["length", "weight"], "length"), ("a" * 100, ["a" * 99], None), ("x", [], None),
        ("u.damp.c", ["u.m", "u.c", "v.c"], "u.c"), ("c", ["m", "u.c"], "u.c"),
        ("u.damp.c", ["c", "u.c"], "u.c"), ("u.c", ["v.c.u"], None),
    ],
)  # fmt: skip
def test_the_name_that_was_meant(name: str, known: list[str], found: str | None) -> None:
    assert closest(name, known) == found
    assert did_you_mean(name, known) == (f"did you mean `{found}`?" if found else None)


def test_words_of_other_languages() -> None:
    assert foreign_call("ln", ["x"]) == "write `log(x)`"
    assert foreign_call("theta") is None


@pytest.mark.parametrize(
    "line, remedies",
    [
        ("potential V = 9.81*m*x;", ["a unit may be missing: `9.81 [m/s2]` gives Energy [J]"]),
        ("constraint c: x = -1;", ["a number inside an expression has no unit: write `-1 [m]`"]),
        ("point P = {0, x, 1/2};", ["a number inside an expression has no unit: write `1/2*1 [m]`"]),
        ("torque M = {0, 0, 1} on b;",
         ["write `body b = Solid(mass = m, inertia = {I1, I2, I3}, frame = F, com = P);`"]),
        ("body c = Particle(mas = m, place = {x, 0, 0});", ["did you mean `mass`?", "it takes `mass`, `at`"]),
        ("body c = Partcle(mass = m, at = {x, 0, 0});", ["did you mean `Particle`?"]),
        ("potential V = sin(x/x)^2;", ["a factor with the unit `[J]` is missing"]),
        ("potential V = 2*sin(x/x) + 1;", ["give a number in it a unit, such as `1 [J]`"]),
        ("output Energy E = kinetic;", ["write `kinetic()`"]),
        ("output Velocity v = velocity;", ["write `velocity(of)`"]),
        ("Gravity field; output Acceleration y = g;", ["write `field.g`"]),
        ("output Acceleration y = g; Gravity field;", ["write `field.g`"]),
        ("constraint c: {x, 2*x} = {0, 0}; output Force y = reaction(c[1]);",
         ["write `reaction(c)[1]` for the force of one component"]),
        ("output Real y = atan2(x);", ["the arguments are (y, x)"]),
        ("coordinate Speed y;", ["write `Velocity`"]),
        ("scene s start m = 2; end s;", ["`m` is a parameter: write `parameter m = ...;`"]),
        ("scene s parameter x = 2; end s;", ["`x` is a coordinate: write `start x = ...;`"]),
        ("coordinate Length y[2]; output Length z = y[0];", ["elements are counted from 1"]),
        ("output Length y = sum({x, x}) > 1 [m];", ["write `if condition then 1 else 0`"]),
    ],
)  # fmt: skip
def test_remedies(line: str, remedies: list[str | None]) -> None:
    head = "model M parameter Mass m = 1; coordinate Length x; body b = Particle(mass = m, at = {x, 0, 0});\n"
    faults = check(Source("m.lag", f"{head}{line}\nend M;"), Choice())
    assert [f.remedy for f in faults] == remedies


@pytest.mark.parametrize(
    "line, unknown",
    [
        ("output Real y = if aa > bb then cc elseif dd then ee else ff;", "aa bb cc dd ee ff"),
        ("coordinate Length y(start = aa, rate = bb, fixed = cc);", "aa bb cc"),
        ("parameter Length l(min = aa, max = bb) = cc;", "aa bb cc"),
        ("body s = Solid(mass = aa, inertia = bb, frame = cc, com = dd);", "aa bb cc dd"),
        ("constraint c: aa = bb; force F = cc at dd; torque T = ee on ff from gg;", "aa bb cc dd ee ff gg"),
        ("initial aa = bb; cc = dd;", "aa bb cc dd"),
        ("function f(Length u) = aa + bb(norm(u)); // that nobody calls", "aa bb"),
        ("scene s uses aa, bb parameter cc = 1; start dd = 2; end s;", "aa bb cc dd"),
        ("output Real y = aa^bb + {cc, dd}.x*sin(ee) - atan2(ff, -gg);", "aa bb cc dd ee ff gg"),
    ],
)
def test_nothing_unknown_is_passed_over(line: str, unknown: str) -> None:
    text = f"model M coordinate Length x; body b = Particle(mass = 1, at = {{x, 0, 0}});\n{line}\nend M;"
    spans = [f.span for f in check(Source("m.lag", text), Choice()) if f.span]
    assert sorted(text[s.start : s.end] for s in spans) == unknown.split()
