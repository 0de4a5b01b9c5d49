"""The one layout: what it looks like, that it changes nothing, and that it is final."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lagc.diagnostics.faults import Refused, Source
from lagc.syntax.formatter import format_source
from lagc.syntax.lexer import tokenise
from tests.syntax.shapes import meaning

MODELS = sorted((Path(__file__).resolve().parents[2] / "models").rglob("*.lag"))


def laid_out(text: str) -> str:
    return format_source(Source("x", text))


def check(text: str) -> str:
    """Lay a text out and see that it says the same, keeps its comments, and stays as it is then."""
    result = laid_out(text)
    assert meaning(result) == meaning(text)
    assert comments(result) == comments(text)
    assert laid_out(result) == result
    return result


def comments(text: str) -> list[str]:
    return ["\n".join(s.rstrip() for s in c.text.split("\n")) for c in tokenise(Source("x", text)).comments]


def in_model(lines: str) -> str:
    return check(f"model M\n{lines}\nend M;\n").removeprefix("model M\n").removesuffix("end M;\n")


@pytest.mark.sample(6, 12)
@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_the_models_are_laid_out(path: Path) -> None:
    text = path.read_text("utf-8")
    assert check(text) == text


WHOLE = """\
// A file comment.

model Pendulum "A mass on a massless string"  // of the course
  parameter Mass m(min = 0) = 1 [kg];
  parameter Length l = 0.5 [m] "string length", k = -2*l;

  // what moves
  coordinate Angle theta(start = 60 [deg]), th[n](each start = 0.1 [rad]);
  point P[0] = {0, 0, 0};
  for i in 1:n - 1 loop
    point P[i] = P[i-1] + l*{sin(th[i]), 0, -cos(th[i])};  // next
    for j in i:2:n loop
      body bob[i, j] = Particle(mass = m, at = P[i]);
    end for;
  end for;

  effect gravity Gravity field; end gravity;

  effect air "drag"
    requires gravity;
    parameter Real[kg/m] k = 1e-3;
    force drag = -k*norm(v)^2*velocity(bob) at bob;
    torque T = (a - b)/2 on bob from wall unless calm "text";
  end air;

  constraint floor: position(ball).z >= 2*r (restitution = 0.8) unless calm;
  constraint c: x - f(y) = if t > 0 and not z == 1 then -a else b^-2;

  initial
    der(x) = 0;
    for i in 1:n loop
      th[i] = 0.1;
    end for;

  scene vacuum uses gravity;
  scene room uses gravity, air
    parameter l = 0.7 [m];
    start theta = 30 [deg];
    simulate(stop = 20 [s], accuracy = 1e-8);
  end room;

  when x > 3 then
    terminate("why");
  end when;

  output Energy E = energy();
  output Real s = sum(sum(i*j for j in i+1:max(n, 2)-1) + 1 - i for i in 1:n);
  output Real u = sum({i - 1 for i in 1:n});
  /* last
     words */
end Pendulum;

partial model B
  import a.b.*;
  extends lib.C(n = 3);
  Chain a(n = 3), b(n = 4);
  function f(Length x, Real[1] y) = x*y;
  type T = Real[kg.m2] "text";
end B;
// the end
""".replace("1:n - 1", "1:n-1")


def test_the_layout_is_final() -> None:
    assert check(WHOLE) == WHOLE


def test_layout_from_any_blanks() -> None:
    """All blanks squeezed or blown up: the same layout (short blocks, which keep to their line, and
    comments and blank lines apart)."""
    uncommented = (line.partition("//")[0] for line in WHOLE.split("\n"))
    bare = "\n".join(line for line in uncommented if line.strip())
    bare = bare.replace("  /* last\n     words */\n", "").replace(
        " Gravity field; end", "\n    Gravity field;\n  end"
    )
    expected = check(bare)
    tokens = tokenise(Source("x", bare)).tokens
    # The blank that tells a constraint's options from a call stays.
    blown = "\n".join(token.text for token in tokens)
    assert check(blown) == expected


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("parameter   Mass m=1[kg]  ;", "  parameter Mass m = 1 [kg];\n"),
        ("parameter Real [ kg/m ] k=1e-3;", "  parameter Real[kg/m] k = 1e-3;\n"),
        ("potential V=a+b*c-d/e^2;", "  potential V = a + b*c - d/e^2;\n"),
        ("potential V=- a*( - b );", "  potential V = -a*(-b);\n"),
        ("potential V = 2 * - x ^ - 2;", "  potential V = 2*-x^-2;\n"),
        ("potential V=P[ i - 1 ]+f( a = 1 );", "  potential V = P[i-1] + f(a = 1);\n"),
        ("potential V={0,0,0} . x;", "  potential V = {0, 0, 0}.x;\n"),
        ("potential V=a<=b or c<>d;", "  potential V = a <= b or c <> d;\n"),
        ("potential V=if a then-b else+c;", "  potential V = if a then -b else +c;\n"),
        ("potential V = f (x);", "  potential V = f(x);\n"),
        ("constraint c :a=b;", "  constraint c: a = b;\n"),
        ("constraint c: a>=b (e=1);", "  constraint c: a >= b (e = 1);\n"),
        ("constraint c: a>=0(e=1);", "  constraint c: a >= 0 (e = 1);\n"),
        ("constraint c: a>=b(e=1);", "  constraint c: a >= b(e = 1);\n"),
        ("effect e potential V=1;end e;", "  effect e potential V = 1; end e;\n"),
        ("effect e\npotential V=1;end e;", "  effect e\n    potential V = 1;\n  end e;\n"),
        ("effect e potential V=1;potential W=1;end e;",
         "  effect e\n    potential V = 1;\n    potential W = 1;\n  end e;\n"),
        ("scene s parameter a . b [ 2 ] . m=1,c=2; end s;",
         "  scene s parameter a.b[2].m = 1, c = 2; end s;\n"),
        ("scene s;scene t uses a,b;", "  scene s;\n  scene t uses a, b;\n"),
        ("\n\n\nscene s;\n\n\n\nscene t;\n\n\n", "  scene s;\n\n  scene t;\n"),
        ("initial x=1;-y=2;scene s;", "  initial\n    x = 1;\n    -y = 2;\n  scene s;\n"),
        ("initial x=1;", "  initial\n    x = 1;\n"),
        ("// a\n//b  \nscene s; //  c", "  // a\n  //b\n  scene s;  //  c\n"),
        ("scene s; // a\n// b\n", "  scene s;  // a\n  // b\n"),
        ("/* a */ scene s; /* b */ // c", "  /* a */\n  scene s;  /* b */  // c\n"),
        ("potential V = a /* b */ + c;", "  potential V = a /* b */ + c;\n"),
        ("potential V = a // b\n + c;", "  potential V = a // b\n    + c;\n"),
        ("potential V = f(a, // b\n c);", "  potential V = f(a, // b\n    c);\n"),
        ("effect e // a\n// b\npotential V=1; // c\n// d\nend e; // f",
         "  effect e  // a\n    // b\n    potential V = 1;  // c\n    // d\n  end e;  // f\n"),
        ("initial\nx=1;\n// a\nscene s;", "  initial\n    x = 1;\n    // a\n  scene s;\n"),
    ],
)  # fmt: skip
def test_details(written: str, expected: str) -> None:
    assert in_model(written) == expected


def test_long_lines_are_broken() -> None:
    arguments = ", ".join(f"argument{i} = {i}*alpha" for i in range(8))
    result = in_model(f"body b = Solid({arguments});")
    lines = result.rstrip("\n").split("\n")
    assert len(lines) == 2 and all(len(line) <= 100 for line in lines)
    assert lines[0].endswith(",") and lines[1].startswith("    argument")


def test_long_sums_are_broken_before_their_signs() -> None:
    result = in_model("potential V = " + " + ".join(f"term{i}*factor{i}" for i in range(12)) + ";")
    lines = result.rstrip("\n").split("\n")
    assert all(len(line) <= 100 for line in lines)
    assert all(line.startswith("    + term") for line in lines[1:])


def test_what_cannot_be_broken_stays() -> None:
    name = "x" * 150
    assert in_model(f"point P = {name};") == f"  point P =\n    {name};\n" or name in in_model(
        f"point P = {name};"
    )


def test_faulty_files_are_refused() -> None:
    with pytest.raises(Refused):
        laid_out("model M parameter Mass m = ; end M;")


@pytest.mark.full
def test_long_files_are_laid_out_soon() -> None:
    text = "model M\n" + "potential V = " + "+".join(f"a{i}" for i in range(5_000)) + ";\nend M;\n"
    assert laid_out(text).count("\n") > 200


# -- texts that are made up -----------------------------------------------------------------

NAMES = st.sampled_from(["a", "x1", "theta", "t", "at", "unless", "start", "P", "end_", "e"])
NUMBERS = st.sampled_from(["0", "1", "2.5", "1e-3", ".5", "3."])
UNITS = st.sampled_from([[], [], ["[m]"], ["[kg.m2/s]"], ["[1]"]])


def joined(*parts: list[str] | str) -> list[str]:
    return [word for part in parts for word in ([part] if isinstance(part, str) else part)]


@st.composite
def expressions(draw: st.DrawFn, depth: int = 3) -> list[str]:
    """The tokens of an expression."""
    kind = draw(st.integers(0, 9 if depth else 1))
    inner = expressions(depth - 1) if depth else st.nothing()
    if kind == 0:
        return [draw(NAMES)]
    if kind == 1:
        return [draw(NUMBERS), *draw(UNITS)]
    if kind in (2, 3):
        return joined(
            "(", draw(inner), draw(st.sampled_from(["+", "-", "*", "/", "^"])), "(", draw(inner), ")", ")"
        )
    if kind == 4:
        return joined(
            "(", draw(inner), draw(st.sampled_from(["<", ">=", "==", "<>"])), "(", draw(inner), ")", ")"
        )
    if kind == 5:
        return joined("(", draw(st.sampled_from(["-", "+", "not"])), "(", draw(inner), ")", ")")
    if kind == 6:
        return joined(draw(NAMES), "(", draw(inner), ",", draw(NAMES), "=", draw(inner), ")")
    if kind == 7:
        return joined(draw(NAMES), "[", draw(NAMES), "-", "1", ",", draw(inner), "]", ".", draw(NAMES))
    if kind == 8:
        return joined("{", draw(inner), ",", draw(inner), "}", *draw(UNITS))
    return joined("(", "if", draw(inner), "then", draw(inner), "else", draw(inner), ")")


@st.composite
def lines(draw: st.DrawFn, depth: int = 2) -> list[str]:
    """The tokens of a declaration."""
    kind = draw(st.integers(0, 9 if depth else 6))
    name, value = draw(NAMES), draw(expressions())
    tail = draw(st.sampled_from([[], ["unless", "e"], ['"text"'], ["unless", "e", ",", "f", '"te // xt"']]))
    if kind in (0, 1):
        return joined(
            "parameter", "Real", "[kg/m]", name, "(", "min", "=", value, ")", "=", draw(expressions()), ";"
        )
    if kind == 2:
        return joined("point", name, "[", "i", "]", "=", value, tail, ";")
    if kind == 3:
        return joined("force", name, "=", value, "at", "P", tail, ";")
    if kind == 4:
        return joined("constraint", name, ":", "(", value, ")", ">=", draw(expressions()), tail, ";")
    if kind == 5:
        return joined("Chain", name, "(", "n", "=", value, ")", ",", "b", ";")
    if kind == 6:
        return joined("initial", "(", value, ")", "=", draw(expressions()), ";")
    inside = draw(st.lists(lines(depth - 1), max_size=3))
    body = [word for line in inside for word in line]
    if kind == 7:
        good = [line for line in inside if line[0] in ("point", "force", "constraint", "for")]
        loop = [w for line in good if not {"parameter", "effect"}.intersection(line) for w in line]
        return joined("for", "i", "in", "1", ":", "n", "-", "1", "loop", loop, "end", "for", ";")
    if kind == 8:
        flat = [word for line in inside if line[0] != "effect" for word in line]
        flat = [] if "effect" in flat else flat
        return joined("effect", "e", '"text"', flat, "end", "e", ";")
    return body or joined("when", value, "then", "reinit", "(", "v", ")", ";", "end", "when", ";")


GAPS = st.sampled_from([" ", " ", " ", "\n", "  \n\n\n", " /* c */ ", " // c\n", "\t"])


@pytest.mark.full
@settings(max_examples=60, deadline=None)
@given(st.lists(lines(), max_size=5), st.data())
def test_made_up_models(declarations: list[list[str]], data: st.DataObject) -> None:
    words = joined("model", "M", *declarations, "end", "M", ";")
    text = "".join(word + data.draw(GAPS) for word in words)
    check(text)


def test_paths_in_uses_do_not_open_a_block() -> None:
    text = (
        "model M\n  scene a uses r[2].drag;\n  scene b uses r.drag, own, q[1, 2].x.y;\n"
        "  scene c uses r[2].drag, air\n    simulate(stop = 1);\n  end c;\n"
        "  parameter Real a[2] = {i^2 for i in 1:2 /* two */};\nend M;\n"
    )
    assert laid_out(text) == text
