"""What each construct of the language is read as, and where. Names that other languages reserve, and those
that are keywords of this one elsewhere."""

import keyword

import pytest

from lagc.diagnostics.faults import Source
from lagc.syntax import tree
from lagc.syntax.lalr_tables import tables
from lagc.syntax.parse import parse


def declarations(body: str) -> tuple[tree.Declaration, ...]:
    read = parse(Source("test.lag", f"model M\n{body}\nend M;\n"))
    (block,) = read.declarations
    assert isinstance(block, tree.ModelDeclaration)
    return block.body


def one(body: str) -> tree.Declaration:
    (declaration,) = declarations(body)
    return declaration


def value(text: str) -> tree.Expression:
    declaration = one(f"potential V = {text};")
    assert isinstance(declaration, tree.Construct)
    return declaration.value


def shown(expression: tree.Expression) -> str:
    """Fully parenthesised, to see what binds to what."""
    match expression:
        case tree.Number(text=text) | tree.Name(name=text):
            return text
        case tree.Binary(op, left, right):
            return f"({shown(left)} {op} {shown(right)})"
        case tree.Unary(op, operand):
            return f"({op} {shown(operand)})"
        case tree.Member(base, name):
            return f"{shown(base)}.{name}"
        case tree.Index(base, indices):
            return f"{shown(base)}[{', '.join(map(shown, indices))}]"
        case tree.Call(function, arguments):
            inner = ", ".join(
                (f"{a.name} = " if a.name else "") + (shown(a.value) if a.value else "") for a in arguments
            )
            return f"{shown(function)}({inner})"
        case tree.Quantity(number, unit):
            return f"{shown(number)} [{unit.text}]"
        case tree.Vector(elements):
            return "{" + ", ".join(map(shown, elements)) + "}"
        case tree.Conditional(branches, otherwise):
            return " ".join(f"{shown(c)} ? {shown(v)} :" for c, v in branches) + " " + shown(otherwise)
        case tree.Range(start, step, stop):
            return ":".join(shown(part) for part in (start, step, stop) if part is not None)
        case tree.Boolean(truth):
            return str(truth)
        case tree.String(text):
            return repr(text)
    raise AssertionError(expression)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b*c", "(a + (b * c))"), ("a - b - c", "((a - b) - c)"), ("a/b*c", "((a / b) * c)"),
        ("-a^2", "(- (a ^ 2))"), ("-a*b", "((- a) * b)"), ("2^-x", "(2 ^ (- x))"), ("a*-b", "(a * (- b))"),
        ("(a + b)*c", "((a + b) * c)"), ("a.b.c", "a.b.c"), ("P[i-1]", "P[(i - 1)]"),
        ("a.bob[3].x", "a.bob[3].x"), ("M[i, j + 1]", "M[i, (j + 1)]"), ("P[1:n]", "P[1:n]"),
        ("P[1:2:n]", "P[1:2:n]"), ("f()", "f()"), ("f(a, b = 2, c = {1, 2})", "f(a, b = 2, c = {1, 2})"),
        ("a.f(x)", "a.f(x)"), ("0.5 [m]", "0.5 [m]"), ("{1, 0, 0} [rad/s]", "{1, 0, 0} [rad/s]"),
        ("1 [ kg.m2 ]", "1 [kg.m2]"), ("{}", "{}"), ("{{1, 2}, {3, 4}}", "{{1, 2}, {3, 4}}"),
        ("(a - b).x", "(a - b).x"), ("(a - b)[1]", "(a - b)[1]"),
        ("if a > 0 then b else c", "(a > 0) ? b : c"),
        ("if a then b elseif c then d elseif e then f else g", "a ? b : c ? d : e ? f : g"),
        ("if a then b else if c then d else e", "a ? b : c ? d : e"),
        ("a or b and not c", "(a or (b and (not c)))"), ("not a == b", "(not (a == b))"),
        ("a + 1 <= b", "((a + 1) <= b)"), ("a <> b", "(a <> b)"), ("true", "True"),
        ('table(file = "x.csv", n = 2)', "table(file = 'x.csv', n = 2)"),
        ("1e-3 + 2.5E+4 + .5 + 1.", "(((1e-3 + 2.5E+4) + .5) + 1.)"),
    ],
)  # fmt: skip
def test_expressions(text: str, expected: str) -> None:
    assert shown(value(text)) == expected


def test_numbers_keep_their_text() -> None:
    number = value("1e-3")
    assert isinstance(number, tree.Number)
    assert (number.value, number.text) == (1e-3, "1e-3")


def test_escapes_in_texts() -> None:
    text = value(r'"say \"hm\"\n\\"')
    assert isinstance(text, tree.String)
    assert text.value == 'say "hm"\n\\'


@pytest.mark.parametrize(
    "kind", ["constant", "parameter", "structural", "input", "coordinate", "speed", "discrete", "output"]
)
def test_quantities(kind: str) -> None:
    declaration = one(f'{kind} Real[kg/m] k[3](min = 0) = 1e-3 "first", lib = 2;')
    assert isinstance(declaration, tree.Quantities)
    assert declaration.kind == kind
    assert declaration.type is not None and declaration.type.path == ("Real",)
    assert declaration.type.unit is not None and declaration.type.unit.text == "kg/m"
    first, second = declaration.declarators
    assert (first.name, first.description, second.name) == ("k", "first", "lib")
    assert [shown(d) for d in first.dimensions] == ["3"]
    assert first.arguments[0].name == "min"
    assert first.value is not None and shown(first.value) == "1e-3"


def test_quantities_unless() -> None:
    declaration = one('input lib.Force u = 0 unless wind, rain "from outside";')
    assert isinstance(declaration, tree.Quantities)
    assert declaration.type is not None and declaration.type.path == ("lib", "Force")
    assert [name.name for name in declaration.unless] == ["wind", "rain"]
    assert declaration.declarators[0].description == "from outside"


def test_nested_and_each_modifications() -> None:
    declaration = one("Chain c(each start = 0, bob(m(min = 0) = 2 [kg]), n = 3);")
    assert isinstance(declaration, tree.Instance)
    each, nested, plain = declaration.declarators[0].arguments
    assert each.each and each.name == "start"
    assert nested.name is None and isinstance(nested.value, tree.Call)
    (inner,) = nested.value.arguments
    assert inner.name == "m" and inner.arguments[0].name == "min" and inner.value is not None
    assert plain.name == "n" and not plain.each


@pytest.mark.parametrize(
    "kind", ["frame", "point", "body", "joint", "potential", "kinetic", "lagrangian", "dissipation"]
)
def test_constructs(kind: str) -> None:
    declaration = one(f'{kind} c[i, 2] = f(x) unless e "text";')
    assert isinstance(declaration, tree.Construct)
    assert (declaration.kind, declaration.name, declaration.description) == (kind, "c", "text")
    assert [shown(i) for i in declaration.index] == ["i", "2"]
    assert [name.name for name in declaration.unless] == ["e"]


def test_description_before_unless() -> None:
    declaration = one('potential V = 3 "text" unless e;')
    assert isinstance(declaration, tree.Construct)
    assert declaration.description == "text" and declaration.unless[0].name == "e"


def test_loads() -> None:
    force, torque = declarations('force F[1] = -k*v at P + d unless e "drag"; torque T = M on a from b;')
    assert isinstance(force, tree.Load) and isinstance(torque, tree.Load)
    assert (force.kind, force.description, shown(force.target)) == ("force", "drag", "(P + d)")
    assert force.reaction is None
    assert torque.kind == "torque" and torque.reaction is not None
    assert (shown(torque.target), shown(torque.reaction)) == ("a", "b")


@pytest.mark.parametrize(
    ("text", "right", "options"),
    [
        ("z >= r (restitution = 0.8)", "r", ["restitution"]),
        ("z >= 2*r.a (restitution = 0.8, e = 1)", "(2 * r.a)", ["restitution", "e"]),
        ("z >= -r (restitution = 0.8)", "(- r)", ["restitution"]),
        ("z >= 0 (restitution = 0.8)", "0", ["restitution"]),
        ("z >= 0 [m] (restitution = 0.8)", "0 [m]", ["restitution"]),
        ("z >= f(x) (restitution = 0.8)", "f(x)", ["restitution"]),
        ("z >= (a + b) (restitution = 0.8)", "(a + b)", ["restitution"]),
        ("z >= f(x = 1)", "f(x = 1)", []),
        ("z >= f (x)", "f(x)", []),
        ("z >= (f (x = 1))", "f(x = 1)", []),
        ("z >= 2*(3 + r (x = 1))", "(2 * (3 + r(x = 1)))", []),
        ("z = if t > 0 then a else b", "(t > 0) ? a : b", []),
    ],
)
def test_constraints(text: str, right: str, options: list[str]) -> None:
    declaration = one(f'constraint c[1]: {text} unless e "text";')
    assert isinstance(declaration, tree.Constraint)
    assert shown(declaration.left) == "z"
    assert declaration.relation == text.split()[1]
    assert shown(declaration.right) == right
    assert [argument.name for argument in declaration.arguments] == options
    assert declaration.description == "text"


def test_initial_section() -> None:
    initial, loop, potential = declarations(
        "initial der(x) = 0; -y = 2*x; for i in 1:n loop z[i] = 0; end for; potential V = 1;"
    )
    assert isinstance(initial, tree.Initial)
    assert [shown(c.left) for c in initial.conditions] == ["der(x)", "(- y)"]
    assert isinstance(loop, tree.ForLoop)
    assert isinstance(loop.body[0], tree.Initial)
    assert isinstance(potential, tree.Construct)


def test_initial_conditions_unless() -> None:
    always, otherwise = declarations("initial x = 0; y = 0 unless e; z = 0 unless e;")
    assert isinstance(always, tree.Initial) and isinstance(otherwise, tree.Initial)
    assert [len(always.conditions), len(otherwise.conditions)] == [1, 2]
    assert otherwise.unless[0].name == "e"


def test_instance_after_initial() -> None:
    _, instance = declarations("initial x = 0; Chain a;")
    assert isinstance(instance, tree.Instance)


def test_loops() -> None:
    loop = one("for i in 1:n loop for j in i + 1:n loop potential V[i, j] = 1; end for; end for;")
    assert isinstance(loop, tree.ForLoop)
    assert (loop.variable, shown(loop.range)) == ("i", "1:n")
    inner = loop.body[0]
    assert isinstance(inner, tree.ForLoop) and shown(inner.range) == "(i + 1):n"


def test_when() -> None:
    when = one('when x > 3 then reinit(v, -v); terminate("why"); on = true; end when;')
    assert isinstance(when, tree.When) and shown(when.condition) == "(x > 3)"


def test_effects() -> None:
    effect = one('effect wind "a breeze" requires air, sky; excludes calm; potential V = 1; end wind;')
    assert isinstance(effect, tree.Effect)
    assert (effect.name, effect.description) == ("wind", "a breeze")
    assert [n.name for n in effect.requires] == ["air", "sky"]
    assert [n.name for n in effect.excludes] == ["calm"]
    assert len(effect.body) == 1


@pytest.mark.parametrize(
    ("text", "uses", "body"),
    [
        ("scene s;", [], 0),
        ("scene s uses a;", ["a"], 0),
        ('scene s "text" uses a, b;', ["a", "b"], 0),
        ("scene s uses a parameter l = 1; start x = 2; simulate(stop = 1); end s;", ["a"], 3),
        ("scene s start der(x[1]) = 3; end s;", [], 1),
        ("scene s parameter l = 1, m(min = 0) = 2; end s;", [], 1),
    ],
)
def test_scenes(text: str, uses: list[str], body: int) -> None:
    scene = one(text)
    assert isinstance(scene, tree.Scene)
    assert [name.name for name in scene.uses] == uses
    assert len(scene.body) == body


def test_scene_parameters_have_no_type() -> None:
    scene = one("scene s parameter l = 1, m = 2; end s;")
    assert isinstance(scene, tree.Scene)
    parameters = scene.body[0]
    assert isinstance(parameters, tree.Quantities) and parameters.type is None
    assert [d.name for d in parameters.declarators] == ["l", "m"]


def test_imports() -> None:
    read = parse(Source("x", 'import a.b.C; import X = a.b; import a.*; import "file.lag";')).declarations
    assert all(isinstance(d, tree.Import) for d in read)
    found = [(d.path, d.file, d.alias, d.wildcard) for d in read if isinstance(d, tree.Import)]
    assert found == [
        (("a", "b", "C"), None, "C", False),
        (("a", "b"), None, "X", False),
        (("a",), None, None, True),
        ((), "file.lag", None, False),
    ]


def test_packages_and_models() -> None:
    (package,) = parse(
        Source("x", 'package P "p" partial model A "a" end A; model B extends A(n = 3); end B; end P;')
    ).declarations
    assert isinstance(package, tree.Package) and package.description == "p"
    a, b = package.body
    assert isinstance(a, tree.ModelDeclaration) and a.partial and a.description == "a"
    assert isinstance(b, tree.ModelDeclaration) and not b.partial
    extends = b.body[0]
    assert isinstance(extends, tree.Extends) and extends.path == ("A",) and extends.arguments[0].name == "n"


def test_types_functions_annotations() -> None:
    kind, function, annotation = declarations(
        'type Drag = Real[kg/m](displayUnit = "g/m") "of air"; function f(Length x, Real[1] y) = x*y "text";'
        " annotation(version = 3);"
    )
    assert isinstance(kind, tree.TypeDeclaration)
    assert kind.definition.unit is not None and kind.definition.unit.text == "kg/m"
    assert kind.arguments[0].name == "displayUnit"
    assert isinstance(function, tree.FunctionDeclaration)
    assert [(t.path, n) for t, n, _ in function.parameters] == [(("Length",), "x"), (("Real",), "y")]
    assert function.description == "text"
    assert isinstance(annotation, tree.Annotation) and annotation.arguments[0].name == "version"


# -- spans ---------------------------------------------------------------------------------


def places(text: str, pattern: str) -> tuple[int, int]:
    start = text.index(pattern)
    return start, start + len(pattern)


def test_spans_are_exact() -> None:
    text = "model M\n  force drag = -k*norm(v) at bob.x;\nend M;\n"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    assert (model.span.start, model.span.end) == (0, len(text) - 1)
    assert (model.name_span.start, model.name_span.end) == places(text, "M")
    (load,) = model.body
    assert isinstance(load, tree.Load)
    assert (load.span.start, load.span.end) == places(text, "force drag = -k*norm(v) at bob.x;")
    assert (load.span.line, load.span.column) == (2, 3)
    assert (load.name_span.start, load.name_span.end) == places(text, "drag")
    assert (load.value.span.start, load.value.span.end) == places(text, "-k*norm(v)")
    assert isinstance(load.value, tree.Binary)
    assert (load.value.op_span.start, load.value.op_span.end) == places(text, "*")
    assert (load.target.span.start, load.target.span.end) == places(text, "bob.x")
    assert isinstance(load.target, tree.Member)
    name = load.target.name_span
    assert (name.start, name.end) == (text.index("x;"), text.index("x;") + 1)


def test_parentheses_belong_to_the_span() -> None:
    text = "model M\npotential V = 2*(a + b);\nend M;"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    (potential,) = model.body
    assert isinstance(potential, tree.Construct) and isinstance(potential.value, tree.Binary)
    assert (potential.value.right.span.start, potential.value.right.span.end) == places(text, "(a + b)")


def test_spans_of_units_and_arguments() -> None:
    text = "model M\nparameter Length l(min = 0 [m]) = 0.5 [m];\nend M;"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    (quantities,) = model.body
    assert isinstance(quantities, tree.Quantities)
    (declarator,) = quantities.declarators
    (argument,) = declarator.arguments
    assert (argument.span.start, argument.span.end) == places(text, "min = 0 [m]")
    assert isinstance(declarator.value, tree.Quantity)
    assert (declarator.value.span.start, declarator.value.span.end) == places(text, "0.5 [m]")
    unit = declarator.value.unit.span
    assert text[unit.start : unit.end] == "[m]"
    assert unit.start == text.rindex("[m]")
    assert (declarator.span.start, declarator.span.end) == places(text, "l(min = 0 [m]) = 0.5 [m]")


# The words that the grammar needs where an operand may stand.
RESERVED = {"if", "not", "true", "false"}
NAMES = sorted(
    {
        *keyword.kwlist,
        *("auto", "break", "case", "char", "const", "default", "do", "double", "enum", "extern", "float"),
        *("goto", "int", "long", "register", "short", "signed", "sizeof", "static", "struct", "switch"),
        *("typedef", "union", "unsigned", "void", "volatile", "t", "q", "x", "I", "E", "N", "main", "self"),
        *("math", "sin", "time", "world", "der", "y_1", "_x", "X9"),
        *tables().keywords,
    }
    - RESERVED
)


@pytest.mark.parametrize("name", NAMES)
def test_names_that_others_reserve_are_legal(name: str) -> None:
    text = (
        f"model {name}\n"
        f"  parameter Length {name}(min = 0) = 1, other = {name} + 1;\n"
        f"  coordinate Angle {name}[3](start = {name}, each {name} = 2);\n"
        f"  body {name} = Particle(mass = {name}, {name} = {name}.{name}[{name}]*{name});\n"
        f"  force {name} = {name}*{{{name}, -{name}, ({name})}} at {name};\n"
        f"  torque {name} = {name}/2 on {name} from {name} unless {name}, {name};\n"
        f"  constraint {name}: {name} = {name};\n"
        f"  for {name} in 1:{name} loop point P[{name}] = {name}; end for;\n"
        f"  effect {name} potential V = if {name} > 1 then {name} else {name}; end {name};\n"
        f"  scene {name} uses {name}, {name} start {name} = {name}; end {name};\n"
        f"  output Real {name} = {name}(1) + 2*{name};\n"
        f"end {name};\n"
    )
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration) and model.name == name
    assert len(model.body) == 10


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"end", "initial", "when"}))
def test_keywords_are_names_before_signs_of_names(name: str) -> None:
    text = f"model M initial x = 0; {name} = 1; {name}.y = 2; {name}[1] = 3; {name} + 1 = 4; end M;"
    (model,) = parse(Source("x", text)).declarations
    assert isinstance(model, tree.ModelDeclaration)
    (initial,) = model.body
    assert isinstance(initial, tree.Initial) and len(initial.conditions) == 5
