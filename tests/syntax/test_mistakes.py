"""Each typical mistake: its code, its place, and the remedy; and that one mistake is one fault."""

import pytest

from lagc.diagnostics.catalogue import entries
from lagc.diagnostics.faults import Refused, Source
from lagc.host.model_library import messages_folder
from lagc.semantics.resolve import resolve
from lagc.syntax import tree
from lagc.syntax.parse import parse, parse_recovering

ENTRIES = {code: entry for code, entry in entries(messages_folder()).items() if code < "LAG02"}

# The mistake, the marked text (None: not looked at), the code, a part of the message or the remedy.
MISTAKES = [
    ("parameter Mass m = 1 [kg]", "", "LAG0111", "`;`"),
    ("output Energy E = energy()", "", "LAG0111", "`;`"),
    ("effect e potential V = 3; end e", "", "LAG0111", "end e;"),
    ("parameter Mass m == 1 [kg];", "==", "LAG0115", "write `=`"),
    ("constraint c: x == 3;", "==", "LAG0115", "write `=`"),
    ("constraint c: x > 3;", ">", "LAG0115", "write `>=`"),
    ("constraint c: x <> 3;", "<>", "LAG0115", "a constraint uses"),
    ("parameter Mass m = if a = b then 1 else 2;", "= b", "LAG0116", "write `==`"),
    ("when a = b then terminate(1); end when;", "= b", "LAG0116", "write `==`"),
    ("parameter Mass m = 0,5 [kg];", "0,5", "LAG0105", "write `0.5`"),
    ("scene s start x = 1,5; end s;", "1,5", "LAG0105", "write `1.5`"),
    ("parameter Mass m = 0.5,0.2 [kg];", "0.2", "LAG0132", "name is missing"),
    ("parameter Mass m = 5,.2 [kg];", ".2", "LAG0132", "name is missing"),
    ("scene s start x = 1, y = 2; end s;", ", y", "LAG0110", "`; start y`"),
    ("scene s start x = 1 [m], der(y[2]) = 2; end s;", ", der(y[2])", "LAG0110", "`; start der(y[2])`"),
    ("parameter Mass m = 5 kg;", "kg;", "LAG0121", "write `5 [kg]`"),
    ("parameter Acceleration g = 9.81 m/s2;", "m/s2", "LAG0121", "write `9.81 [m/s2]`"),
    ("coordinate Angle theta(start = 30 deg);", "deg", "LAG0121", "write `30 [deg]`"),
    ("parameter Mass m = (1/2) [kg];", "[kg]", "LAG0121", "follows a number"),
    ("parameter Length l = 1; point P = 2l*world.x;", "2l", "LAG0130", "2*l"),
    ("parameter Real[m] l = 1; point P = 2l*world.x;", "2l", "LAG0130", "2*l"),
    ("parameter Length k = 1, l = 1; point P = 2l*world.x;", "2l", "LAG0130", "2*l"),
    ("parameter Length k = 2 l;", "l;", "LAG0121", "write `2 [l]`"),
    ("if y > 0 then force f = -y*world.z at b; end if;", "if y", "LAG0118", "`when`"),
    ("if (y > 0) force f = -y*world.z at b; end if;", "if (", "LAG0118", "`effect`"),
    ("parameter Mass m = 2x;", "2x", "LAG0130", "2*x"),
    ("parameter Mass m = k g;", "k g", "LAG0130", "k*g"),
    ("parameter Mass m = (k) g;", ") g", "LAG0130", "between `)` and `g`"),
    ("parameter Mass m = 2(k);", "2(", "LAG0130", "between `2` and `(`"),
    ("body b Particle(mass = 3);", "b Particle", "LAG0130", "write `=`"),
    ("body b = Particle(mass = m at = P);", "m at", "LAG0130", "write `,`"),
    ("coordinate Angle a(start = 1 rate = 2);", "1 rate", "LAG0130", "write `,`"),
    ("output Real r = phi' + 1;", "'", "LAG0101", "write `der(phi)`"),
    ("output Real r = 2*phi'';", "''", "LAG0101", "write `der(der(phi))`"),
    ("output Real r = phi.^2;", ".^", "LAG0117", "write `^`"),
    ("output Real r = a./b;", "./", "LAG0117", "write `/`"),
    ("coordinate Angle a b;", "a b", "LAG0130", "`,`"),
    ("scene s uses a b;", "a b", "LAG0130", "`,`"),
    ("parameter Mass m = a**2;", "**", "LAG0117", "write `^`"),
    ("parameter Boolean m = a != b;", "!=", "LAG0117", "write `<>`"),
    ("parameter Boolean m = a && b;", "&&", "LAG0117", "write `and`"),
    ("parameter Boolean m = a || b;", "||", "LAG0117", "write `or`"),
    ("parameter Boolean m = !b;", "!", "LAG0117", "write `not`"),
    ("parameter Mass m := 3;", ":=", "LAG0117", "write `=`"),
    ("when a > b then x := 3; end when;", ":=", "LAG0117", "reinit"),
    ("when a > b then x := 3*y; reinit(y, 2); end when;", ":=", "LAG0117", "write `reinit(x, 3*y);`"),
    ("when a > b terminate(1); end when;", "terminate", "LAG0128", "`when condition then"),
    ("when a > b then x = 1; elsewhen a < b then y = 1; end when;", "elsewhen", "LAG0118",
     "`end when; when a < b then`"),
    ("parameter Real m = 5 % 2;", "%", "LAG0117", "not an operator"),
    ("paramter Mass m = 1 [kg];", "paramter", "LAG0119", "`parameter`"),
    ("Parameter Mass m = 1 [kg];", "Parameter", "LAG0119", "`parameter`"),
    ("bodi b = Particle(mass = m);", "bodi", "LAG0119", "`body`"),
    ("Body b = Particle(mass = m);", "Body", "LAG0119", "`body`"),
    ("Effect e potential V = 3; end e;", "Effect", "LAG0119", "`effect`"),
    ("const Real g = 9.81;", "const", "LAG0118", "`constant`"),
    ("var x = 3;", "var", "LAG0118", "coordinate"),
    ("Real[m] x(start = 1);", "Real", "LAG0119", "coordinate Real[m] x"),
    ("connect(a, b);", "connect", "LAG0118", "constraint"),
    ("theta = 3;", "theta = 3;", "LAG0122", "`initial`"),
    ("body b = Particle(mass = m, at = {x, 0, 0};", "(", "LAG0114", "`)`"),
    ("body b = Particle(mass = m, at = {x, 0, 0);", ")", "LAG0114", "`})`"),
    ("body b = Particle(mass = m, at = x));", ");", "LAG0114", "delete"),
    ("parameter Mass m(min = 0 = 1 [kg];", "(", "LAG0114", "`)`"),
    ("point P[i = {0, 0, 0};", "[", "LAG0114", "`]`"),
    ("potential V = (a + b;", "(", "LAG0114", "`)`"),
    ("potential V = (a + b];", "]", "LAG0114", "`)`"),
    ("force F = v;", ";", "LAG0127", "at"),
    ("force F = v on b;", ";", "LAG0127", "at"),
    ("torque M = v at b;", "at", "LAG0127", "write `on`"),
    ("coordinate Angle p, q(start=1); force F = v on q;", ";", "LAG0127",
     "write `torque F = v on rotate_y(world, q)`"),
    ("coordinate Length q; force F = v on q;", ";", "LAG0127", "`q` is a coordinate"),
    ("for i in 1:n point P[i] = x; end for;", "point", "LAG0128", "loop"),
    ("for i = 1:n loop point P[i] = x; end for;", "=", "LAG0128", "in"),
    ("for i in 1..3 loop point P[i] = x; end for;", "for i in 1..3", "LAG0128", "write `for i in 1:3 loop`"),
    ("output Real s = if x > 3 then 4;", ";", "LAG0128", "else"),
    ("output Real s = if x > 3 4 else 5;", "4 else", "LAG0128", "then"),
    ("constraint x = 3;", "= 3", "LAG0129", "name"),
    ("constraint c: x;", ";", "LAG0129", "two sides"),
    ('parameter Mass m "mass" = 1 [kg];', '"mass"', "LAG0125", "last"),
    ("parameter Real m = a^b^c;", "^c", "LAG0126", "a^(b^c)"),
    ("parameter Boolean m = a < b < c;", "< c", "LAG0126", "`and`"),
    ("parameter Mass m = ;", "= ;", "LAG0131", "value"),
    ("parameter Mass m = 3 + ;", "+ ;", "LAG0131", "value"),
    ("parameter Mass m = f(a, );", ", )", "LAG0131", "value"),
    ("body = Particle();", "body", "LAG0132", "body name"),
    ("start x = 3;", "start", "LAG0120", "scene"),
    ("requires a;", "requires", "LAG0120", "effect"),
    ("for i in 1:n loop coordinate Angle a; end for;", "coordinate", "LAG0120", "before the loop"),
    ("effect e effect f potential V = 1; end f; end e;", "effect f", "LAG0120", "model"),
    ("scene s coordinate Angle a; end s;", "coordinate", "LAG0120", "model"),
    ("parameter Mass m = 1 [kg];;", ";", "LAG0124", "delete"),
    ("effect e; potential V = 3; end e;", "; potential", "LAG0124", "delete"),
    ("parameter Real m = if a then; b else c;", "; b", "LAG0124", "delete"),
    ("effect e potential V = 3; end;", "end", "LAG0113", "end e;"),
    ("effect e potential V = 3; end f;", "f;", "LAG0113", "end e;"),
    ("effect e { potential V = 3; end e;", "{", "LAG0114", "delete"),
    ("effect e potential V = 3;", None, "LAG0112", "end e;"),
    ("effect e potential V = 3; effect f end f;", "effect f", "LAG0112", "end e;"),
    ('parameter Mass m = "abc;', '"abc', "LAG0102", '"'),
    ("parameter Mass m = 3 [kg;", "[kg", "LAG0104", "[kg]"),
    ("parameter Angle θ = 1;", "θ", "LAG0101", "theta"),
    ("parameter Angle t = 30°;", "°", "LAG0101", "[deg]"),
    ("parameter Real x = 3 − 2;", "−", "LAG0101", "write `-`"),
    ("parameter Real m = c ? a : b;", "?", "LAG0101", "if condition"),
    ("parameter Mass m = f(a.b = 3);", "a.b", "LAG0123", "name"),
    (")", ")", "LAG0114", ""),
    ("3;", ";", "LAG0110", ""),
]  # fmt: skip
LAST = "parameter Mass last = 1 [kg];"


def read(lines: str) -> tuple[Source, tree.Tree, list[tuple[str, int, str, str]]]:
    source = Source("x", f"model M\n{lines}\n{LAST}\nend M;\n")
    found, faults = parse_recovering(source)
    table = []
    for fault in faults:
        assert fault.span is not None
        text = source.text[fault.span.start : fault.span.end]
        said = f"{fault.message} {fault.remedy}"
        table.append((fault.code, fault.span.start - len("model M\n"), text, said))
    return source, found, table


@pytest.mark.parametrize(("lines", "marked", "code", "said"), MISTAKES)
def test_mistakes(lines: str, marked: str | None, code: str, said: str) -> None:
    _, found, faults = read(lines)
    assert [fault[0] for fault in faults] == [code]
    ((_, start, text, message),) = faults
    if marked is not None:
        last = marked in (";", ")", "at", "f;")
        assert start == (lines.rindex(marked) if last else lines.index(marked) if marked else len(lines))
        assert marked.startswith(text)
    assert said in message
    # What follows is read.
    (model,) = found.declarations
    assert isinstance(model, tree.ModelDeclaration)
    if code != "LAG0112":
        behind = model.body[-1]
        assert isinstance(behind, tree.Quantities) and behind.declarators[0].name == "last"


def test_unclosed_comment() -> None:
    with pytest.raises(Refused) as refused:
        parse(Source("x", "model M\n  parameter Mass m = 1 [kg]; /* never\nend M;\n"))
    (fault,) = refused.value.faults
    assert fault.code == "LAG0103" and fault.span is not None and fault.span.line == 2


def test_missing_end_at_the_end_of_the_file() -> None:
    with pytest.raises(Refused) as refused:
        parse(Source("x", "model M\n  effect e\n    potential V = 1;\n  end e;\n"))
    (fault,) = refused.value.faults
    assert fault.code == "LAG0112" and "model `M`" in fault.message
    ((span, label),) = fault.related
    assert (span.line, span.column, label) == (1, 1, "opened here")


def test_wrong_end_shows_both_places() -> None:
    with pytest.raises(Refused) as refused:
        parse(Source("x", "model Pendulum\nend Pendelum;\n"))
    (fault,) = refused.value.faults
    assert fault.code == "LAG0113" and fault.span is not None
    assert (fault.span.line, fault.span.column) == (2, 5)
    assert fault.related[0][0].line == 1
    assert fault.remedy == "write `end Pendulum;`"


def test_inner_block_without_end() -> None:
    """The `end M` does not close the loop: the loop's own is what is missing."""
    text = "model M\n  for i in 1:3 loop\n    point P[i] = x;\nend M;\nmodel N\nend N;\n"
    found, faults = parse_recovering(Source("x", text))
    assert [fault.code for fault in faults] == ["LAG0112"]
    assert len(found.declarations) == 2


def test_missing_word_end() -> None:
    found, faults = parse_recovering(Source("x", "model M\n  scene lab\n    start x = 1;\n  lab;\nend M;\n"))
    (fault,) = faults
    assert fault.code == "LAG0112" and fault.span is not None and fault.span.line == 4
    (model,) = found.declarations
    assert isinstance(model, tree.ModelDeclaration) and isinstance(model.body[0], tree.Scene)


def test_end_of_a_block_whose_first_line_is_lost() -> None:
    text = "model M\n  scene = lab\n    start x = 1;\n  end lab;\n  potential V = 1;\nend M;\n"
    found, faults = parse_recovering(Source("x", text))
    assert faults[0].span is not None and faults[0].span.line == 2
    assert "LAG0113" not in {fault.code for fault in faults}
    (model,) = found.declarations
    assert isinstance(model, tree.ModelDeclaration) and isinstance(model.body[-1], tree.Construct)


def test_end_that_closes_nothing() -> None:
    text = "model M\n  potential V = 1;\n  end lab;\n  potential W = 1;\nend M;\n"
    found, faults = parse_recovering(Source("x", text))
    assert [(f.code, f.span.line) for f in faults if f.span is not None] == [("LAG0113", 3)]
    (model,) = found.declarations
    assert isinstance(model, tree.ModelDeclaration) and len(model.body) == 2


def test_an_end_with_a_wrong_name_in_a_clause() -> None:
    text = 'model M\n  when x > 0 then\n    mark("s");\n  end whenx;\n  when x < 0 then end when;\nend M;\n'
    _, faults = parse_recovering(Source("x", text))
    assert [(f.code, f.remedy) for f in faults] == [("LAG0113", "write `end when;`")]


def test_modelicas_equation_section() -> None:
    with pytest.raises(Refused) as refused:
        parse(Source("x", "model M\nequation\n  m*der(v) = F;\n  der(x) = v;\n  a = 1;\nend M;\n"))
    assert [fault.code for fault in refused.value.faults] == ["LAG0118"]


def test_several_faults_in_one_go() -> None:
    text = (
        "model M\n"
        "  parameter Mass m = 1 [kg]\n"
        "  parameter Length l == 2 [m];\n"
        "  paramter Length d = 2 [m];\n"
        "  effect air\n"
        "    force F = 2v at P;\n"
        "  end air\n"
        "  output Energy E = energy(;\n"
        "end M;\n"
    )
    found, faults = parse_recovering(Source("x", text))
    assert [(f.code, f.span.line) for f in faults if f.span is not None] == [
        ("LAG0111", 2), ("LAG0115", 3), ("LAG0119", 4), ("LAG0130", 6), ("LAG0111", 7), ("LAG0114", 8),
    ]  # fmt: skip
    (model,) = found.declarations
    assert isinstance(model, tree.ModelDeclaration) and len(model.body) == 5


def test_one_fault_a_declaration() -> None:
    _, _, faults = read("body b = Particle(mass == m, at = {x 0 0, +});")
    assert len(faults) == 1


def test_a_call_of_a_solver_may_stay_open_to_the_end_of_the_file() -> None:
    _, faults = parse_recovering(Source("x", "model M\n  [t, y] = ode45(f, [0, 10];\nend M;\n"))
    assert faults[0].code == "LAG0118"


@pytest.mark.parametrize("code", sorted(ENTRIES))
def test_catalogue(code: str) -> None:
    entry = ENTRIES[code]
    with pytest.raises(Refused) as refused:
        resolve(parse(Source("wrong.lag", entry.wrong)))
    assert [fault.code for fault in refused.value.faults] == [code]
    assert resolve(parse(Source("right.lag", entry.right))).name
    assert entry.title and entry.explanation


def test_every_fault_is_in_the_catalogue() -> None:
    _, _, faults = read("\n".join(mistake[0] for mistake in MISTAKES))
    assert {fault[0] for fault in faults} <= set(ENTRIES)
