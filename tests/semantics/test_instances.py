"""Instances, inheritance, arrays, loops, effects, scenes, imports."""

from pathlib import Path

import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source
from lagc.semantics.resolve import resolve
from lagc.semantics.scenes import Variant, variants
from lagc.syntax.parse import parse
from tests.semantics.reading import read, value

CHAIN = """
partial model Lab
  parameter Mass m0 = 1;
  effect gravity Gravity field; end gravity;
  scene lab uses gravity;
end Lab;
model Chain
  structural Integer n = 5;
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  coordinate Angle th[n](each start = 0.1 [rad]);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{sin(th[i]), 0, -cos(th[i])};
    body bob[i] = Particle(mass = m, at = P[i]);
  end for;
end Chain;
"""


def test_a_chain_has_its_links() -> None:
    model = read(CHAIN)
    assert [c.name for c in model.coordinates] == [f"th[{i}]" for i in range(1, 6)]
    assert [b.name for b in model.bodies] == [f"bob[{i}]" for i in range(1, 6)]
    assert value(model, model.points[-1].position[2], **{f"th[{i}]": 0.0 for i in range(1, 6)}) == -5.0


def test_the_structure_is_chosen_from_outside() -> None:
    model = read(
        CHAIN, parameters={"n": 2, "l": (50.0, "cm")}, starts={"th[2]": (90.0, "deg"), "der(th[1])": 1.5}
    )
    assert len(model.coordinates) == 2
    assert {p.name: p.value for p in model.parameters} == {"m": 1.0, "l": 0.5}
    starts = [(c.start.value, c.rate.value) for c in model.coordinates]
    assert starts == [(0.1, 1.5), (pytest.approx(1.5707963267948966, rel=1e-15), 0.0)]


def test_instances_keep_apart_and_gravity_reaches_all() -> None:
    model = read(
        CHAIN + "model Two extends Lab; Chain a(n = 3), b(n = 4, l = 0.5 [m]); parameter Stiffness k = 2;"
        "potential spring = 1/2*k*norm(position(a.bob[3]) - position(b.bob[4]))^2; end Two;"
    )
    assert {p.name: p.value for p in model.parameters}["b.l"] == 0.5
    assert [c.name for c in model.coordinates][-1] == "b.th[4]"
    assert len(model.bodies) == 7
    gravity = next(a for a in model.actions if a.name == "field")
    at_rest = {c.name: 0.0 for c in model.coordinates}
    # hanging down: heights -1 -2 -3 and -0.5 -1 -1.5 -2, masses 1
    assert value(model, gravity.energy, **at_rest) == pytest.approx(-9.81 * 11)
    assert gravity.effect == "gravity"


def test_modifications_reach_inward() -> None:
    text = (
        "model A parameter Mass m(min = 0) = 1; coordinate Length x(start = 1); "
        "body b = Particle(mass = m, at = {x, 0, 0}); end A;"
        "model B A a(m(max = 9) = 3, x(start = 2)); end B;"
        "model C B b(a(m = 5)); end C;"
    )
    model = read(text)
    assert [(p.name, p.value, p.minimum, p.maximum) for p in model.parameters] == [("b.a.m", 5.0, 0.0, 9.0)]
    assert model.coordinates[0].start.value == 2.0


def test_arrays_of_instances() -> None:
    model = read(
        "model A parameter Mass m = 1; coordinate Length x; "
        "body b = Particle(mass = m, at = {x, 0, 0}); end A;"
        "model B structural Integer n = 3; A a[n](m = {1, 2, 3}); "
        "potential V = 1 [N/m]*norm(position(a[1].b) - position(a[n].b))^2; end B;"
    )
    assert [(p.name, p.value) for p in model.parameters] == [
        ("a[1].m", 1.0),
        ("a[2].m", 2.0),
        ("a[3].m", 3.0),
    ]


def test_what_depends_on_parameters_follows_them() -> None:
    text = (
        "model A parameter Length l = 2; parameter Length half = l/2; "
        "coordinate Length x(start = half); end A;"
    )
    model = read(text)
    assert [p.name for p in model.parameters] == ["l"]
    assert model.built_in == ("half",)
    assert value(model, model.coordinates[0].start) == 1.0
    given = read(text, parameters={"half": 7.0})
    assert [(p.name, p.value) for p in given.parameters] == [("l", 2.0), ("half", 7.0)]


SCENES = """
model P
  parameter Mass m = 1;
  parameter Length l = 0.5;
  coordinate Angle theta(start = 1);
  body bob = Particle(mass = m, at = l*{sin(theta), 0, -cos(theta)});
  effect gravity Gravity field; end gravity;
  effect air "drag" requires gravity;
    force drag = -1 [kg/s]*velocity(bob) at bob;
  end air;
  effect vacuum excludes air; end vacuum;
  potential spring = 1 [J]*theta^2 unless gravity;
  scene free;
  scene lab uses gravity
    parameter l = 70 [cm];
    start theta = 30 [deg]; start der(theta) = 2; simulate(stop = 2 [min]); end lab;
  scene room uses gravity, air;
end P;
"""


def test_the_first_scene_is_used_and_said() -> None:
    model = read(SCENES)
    assert model.scene == "free" and model.scenes == ("free", "lab", "room")
    assert model.notes == ("no scene was chosen; the first one is used: free",)
    assert [a.name for a in model.actions] == ["spring"]


def test_a_scene_has_its_effects_and_values() -> None:
    model = read(SCENES, scene="lab")
    assert [a.name for a in model.actions] == ["field"]
    assert {p.name: p.value for p in model.parameters}["l"] == 0.7
    assert model.simulate == {"stop": 120.0}
    coordinate = model.coordinates[0]
    assert (coordinate.start.value, coordinate.rate.value) == (pytest.approx(0.5235987755982988), 2.0)


def test_effects_are_added_and_removed() -> None:
    added = read(SCENES, scene="lab", with_effects=["air"])
    removed = read(SCENES, scene="room", without_effects=["air"])
    assert [(e.name, e.used) for e in added.effects] == [("gravity", True), ("air", True), ("vacuum", False)]
    assert [a.name for a in removed.actions] == ["field"]


CARTS = """model Cart
  coordinate Length x;
  body b = Particle(mass = 1, at = {x, 0, 0});
  effect spring
    potential s = 1/2*3 [N/m]*x^2;
  end spring;
end Cart;
model Train
  Cart a[3], c;
  scene all uses spring;
  scene row uses a.spring;
  scene last uses c.spring;
end Train;
"""


@pytest.mark.parametrize(
    ("scene", "more", "less", "used"),
    [
        ("all", (), (), ["a[1]", "a[2]", "a[3]", "c"]),
        ("row", (), (), ["a[1]", "a[2]", "a[3]"]),
        ("last", (), (), ["c"]),
        ("all", (), ("a[1].spring",), ["a[2]", "a[3]", "c"]),
        ("all", (), ("a.spring",), ["c"]),
        ("row", (), ("spring",), []),
        ("row", ("c.spring",), ("a[2].spring",), ["a[1]", "a[3]", "c"]),
        ("last", ("a[3].spring",), ("spring",), ["a[3]"]),
        ("all", ("a[3].spring",), ("a.spring",), ["a[3]", "c"]),
    ],
)
def test_effects_are_named_one_by_one_and_together(
    scene: str, more: tuple[str, ...], less: tuple[str, ...], used: list[str]
) -> None:
    model = read(CARTS, scene=scene, with_effects=more, without_effects=less)
    assert [e.name for e in model.effects if e.used] == [f"{name}.spring" for name in used]
    assert [a.name for a in model.actions] == [f"{name}.s" for name in used]


@pytest.mark.parametrize(
    "choice, code",
    [
        ({"scene": "moon"}, "LAG0215"),
        ({"scene": "lab", "with_effects": ["wind"]}, "LAG0212"),
        ({"scene": "free", "with_effects": ["air"]}, "LAG0213"),
        ({"scene": "room", "with_effects": ["vacuum"]}, "LAG0213"),
        ({"with_effects": ["air"], "without_effects": ["air"]}, "LAG0215"),
        ({"model": "Q"}, "LAG0215"),
        ({"parameters": {"k": 1.0}}, "LAG0215"),
        ({"parameters": {"field.g": 1.0}}, "LAG0215"),
        ({"parameters": {"m": (1.0, "s")}}, "LAG0302"),
        ({"parameters": {"m": (1.0, "foo")}}, "LAG0304"),
        ({"parameters": {"m": float("nan")}}, "LAG0309"),
        ({"starts": {"phi": 1.0}}, "LAG0224"),
    ],
)
def test_a_wrong_choice_is_refused(choice: dict[str, object], code: str) -> None:
    with pytest.raises(Refused) as refused:
        read(SCENES, **choice)
    assert [f.code for f in refused.value.faults] == [code]


@pytest.mark.parametrize(
    "effects, said",
    [
        ("effect gravity end gravity;", "did you mean `gravity`?"),
        ("effect air end air;", "the model has `air`"),
        ("", "the model has no effects"),
    ],
)
def test_an_effect_that_there_is_not_comes_with_those_that_there_are(effects: str, said: str) -> None:
    with pytest.raises(Refused) as refused:
        read(f"model A coordinate Length x; {effects} scene s uses gravty; end A;")
    (fault,) = refused.value.faults
    assert fault.code == "LAG0212" and said in (fault.remedy or "")
    assert said in str(refused.value)


def test_without_coordinates_empty_arrays_are_the_reason() -> None:
    with pytest.raises(Refused) as refused:
        read("model A structural Integer n = 2; coordinate Length x[n - 2]; end A;")
    assert "`x` has no entries, as n - 2 = 0" in refused.value.faults[0].message


def test_without_scenes_no_effect_is_used() -> None:
    model = read(
        SCENES.replace("scene free;", "").replace(
            SCENES[SCENES.index("scene lab") : SCENES.index("end P")], ""
        )
    )
    assert model.scene == "default"
    assert not any(e.used for e in model.effects)
    assert [fault.code for fault in model.warnings] == ["LAG0230"] * 3
    assert all("`scene lab uses gravity, air, vacuum;`" in (f.remedy or "") for f in model.warnings)


TOGETHER = [
    ("what is called is not known", "body b = Partcle(mass = m, at = {x, y, cos(thetta)});",
     "LAG0201 LAG0221"),
    ("a function is not known", "output Length u = sine(thetta);", "LAG0201 LAG0201"),
    ("an argument is not known", "output Real u = sin(thetta, k = phii);", "LAG0201 LAG0201 LAG0209"),
    ("a function of the model has more arguments",
     "function f(Length u) = u; output Length v = f(x, thetta);", "LAG0201 LAG0209"),
    ("both of a body's are wrong", "body b = Particle(mass = x, at = {m, m, m});", "LAG0302 LAG0302"),
    ("a force and its place are wrong", "force f = {m, 0, 0} at 3 [m];", "LAG0302 LAG0306"),
    ("a torque and its frame are wrong", "torque f = {m, 0, 0} on x;", "LAG0221 LAG0302"),
    ("the type of what is used is not known", "parameter Lenght l; output Mass u = l + x;",
     "LAG0203 LAG0302"),
    ("what is used is wrong", "coordinate Length z(start = 1 [kg]); output Mass u = z;", "LAG0302 LAG0302"),
    ("an array that is used is wrong", "parameter Mass k[2] = 1 [m]; output Length u = k[1];",
     "LAG0302 LAG0302"),
    ("a speed that is used is wrong", "speed Velocity u = m*der(x); output Mass v = u;", "LAG0302 LAG0302"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "codes"), [c[1:] for c in TOGETHER], ids=[c[0] for c in TOGETHER])
def test_a_fault_hides_no_other(text: str, codes: str) -> None:
    with pytest.raises(Refused) as refused:
        read(f"model A parameter Mass m = 1; coordinate Length x, y; {text} end A;")
    assert sorted(f.code for f in refused.value.faults) == codes.split()


def test_values_for_what_is_at_fault_are_no_further_fault() -> None:
    with pytest.raises(Refused) as refused:
        read("model A parameter Lenght l; coordinate Length x(start = 1 [s]); scene s "
             "parameter l = 3; start x = 1; start der(x) = 2; end s; end A;")  # fmt: skip
    assert sorted(f.code for f in refused.value.faults) == ["LAG0203", "LAG0302"]


def test_a_fault_is_told_once() -> None:
    with pytest.raises(Refused) as refused:
        read("model A parameter Mass k = nothing; coordinate Length x; "
        "body b = Particle(mass = k, at = {x, 0, 0});"
             "body c = Particle(mass = 2*k, at = {0, x, 0}); output Mass y = k; end A;")  # fmt: skip
    assert [f.code for f in refused.value.faults] == ["LAG0201"]


def test_files_and_packages_are_imported(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "parts.lag").write_text(
        "package parts constant Mass light = 0.1; type Grade = Real[kg/m];"
        "function twice(Mass u) = 2*u;"
        "model Bob parameter Mass m = light; coordinate Length x; "
        "body b = Particle(mass = m, at = {x, 0, 0}); end Bob;"
        "end parts;"
    )
    main = tmp_path / "main.lag"
    for header, name in (
        ('import "lib/parts.lag";', "parts.Bob"),
        ("import lib.parts;", "parts.Bob"),
        ("import p = lib.parts;", "p.Bob"),
        ("import lib.parts.Bob;", "Bob"),
        ("import lib.parts.*;", "Bob"),
    ):
        main.write_text(f"{header} model M {name} a, b(m = 3); end M;")
        model = resolve(parse(Source(str(main), main.read_text())))
        assert [(p.name, p.value) for p in model.parameters] == [("a.m", 0.1), ("b.m", 3.0)], header
        assert [Path(path).name for path, found in model.imports if found] == ["parts.lag"]


def test_models_that_import_each_other(tmp_path: Path) -> None:
    (tmp_path / "a.lag").write_text('import "b.lag"; model A coordinate Length x; end A;')
    (tmp_path / "b.lag").write_text('import "a.lag"; model B A a; end B;')
    text = 'import "b.lag"; model M B b; end M;'
    (tmp_path / "m.lag").write_text(text)
    model = resolve(parse(Source(str(tmp_path / "m.lag"), text)))
    assert [c.name for c in model.coordinates] == ["b.a.x"]


def test_everything_a_file_can_mean() -> None:
    text = (
        "partial model L effect e end e; effect f requires e; end f; effect g excludes e; end g;"
        "scene s uses e; end L; model Part coordinate Length x; end Part;"
        "model Alone coordinate Length x; scene one; scene two; end Alone;"
        "model Main extends L; Part p; end Main;"
    )
    found = variants(parse(Source("model.lag", text)))
    assert found == [
        Variant("Alone", "one"),
        Variant("Alone", "two"),
        Variant("Main", "s"),
        Variant("Main", "s", ("f", "e"), ("g",)),
        Variant("Main", "s", ("g",), ("e",)),
    ]


def test_models_in_packages_are_meant_too() -> None:
    text = (
        "package P model A coordinate Length x; scene s; end A;"
        "package Q model B extends A; end B; end Q; end P;"
        "model M P.Q.B b; effect e end e; effect f end f; scene s uses e; end M;"
    )
    found = variants(parse(Source("model.lag", text)))
    assert found == [Variant("M", "s"), Variant("M", "s", ("f",), (), ("e",))]
    assert variants(parse(Source("model.lag", text)), "P.A") == [Variant("P.A", "s")]
    alone = variants(parse(Source("model.lag", text[: text.index("model M")])))
    assert alone == [Variant("P.Q.B", "s")]


def test_an_effect_that_no_scene_uses_is_not_blamed_for_others() -> None:
    text = (
        "model A coordinate Length x(rate = 1); body b = Particle(mass = 1, at = {x, 0, 0});"
        "effect e parameter Real k = 1; end e; effect f parameter Real k = 2; {} end f;"
        "scene s uses e; output Real y = k; end A;"
    )
    faults = check(Source("model.lag", text.replace("{}", "")), Choice())
    assert [f.code for f in faults] == ["LAG0230"]
    faults = check(Source("model.lag", text.replace("{}", "potential V = 3 [m];")), Choice())
    assert [f.code for f in faults] == ["LAG0230", "LAG0302"]


WHOLE = "model A coordinate Length x; body b = Particle(mass = 1, at = {x, 0, 0}); end A; "
PARTS = """
package P
  constant Length l = 2 [m];
  model C
    coordinate Length x;
    body b = Particle(mass = 1 [kg], at = {x, 0, 0});
  end C;
  package Q
    constant Length l = 3 [m];
    model D
      extends C;
    end D;
  end Q;
end P;
"""


@pytest.mark.parametrize(
    ("imports", "type_name", "length", "expected"),
    [
        ("import P.C;", "C", "P.l", 2.0), ("import P.*;", "C", "l", 2.0), ("import P.Q;", "Q.D", "Q.l", 3.0),
        ("import P.Q.D;", "D", "P.Q.l", 3.0), ("import P.Q.*;", "D", "l", 3.0),
        ("import R = P.Q; import R.*;", "D", "R.l", 3.0), ("import P.*; import Q.D;", "D", "Q.l", 3.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("where", ["here", "there", "a file of that name"])
def test_imports_find_packages_that_are_known_and_files(
    imports: str, type_name: str, length: str, expected: float, where: str, tmp_path: Path
) -> None:
    """A package of this file, or of another that is imported, or of a file that has its name."""
    text = f"{imports}\nmodel M\n  {type_name} c;\n  parameter Length k = {length};\nend M;\n"
    if where == "there":
        (tmp_path / "parts.lag").write_text(PARTS)
        text = 'import "parts.lag";\n' + text
    elif where == "here":
        (tmp_path / "P.lag").write_text("package P end P;")  # what is known goes first
        text = PARTS + text
    else:
        (tmp_path / "P.lag").write_text(PARTS)
        if "P." in length or "Q." in length:
            text = text.replace(length, length.rpartition(".")[2]).replace("model M", "import P.*;\nmodel M")
            expected = 2.0 if "P.Q.*" not in imports and "R.*" not in imports else 3.0
    path = tmp_path / "m.lag"
    path.write_text(text)
    source = Source(str(path), text)
    assert not [f for f in check(source, Choice()) if f.code != "LAG0429"]
    model = resolve(parse(source))
    assert [c.name for c in model.coordinates] == ["c.x"]
    assert {p.name: p.value for p in model.parameters}["k"] == expected


@pytest.mark.parametrize(
    "text",
    [
        "import P.C;",
        "import P.*;",
        "import P.Q.*; import Q.P.*;",
        "import P.P; package P end P;",
        "import C.*;",
    ],
)
def test_imports_of_what_is_not_there_end_with_a_fault(text: str, tmp_path: Path) -> None:
    """Those that look for each other, too."""
    text += " model M coordinate Length x; C c; end M;"
    with pytest.raises(Refused) as refused:
        resolve(parse(Source(str(tmp_path / "m.lag"), text)))
    assert {f.code for f in refused.value.faults} <= {"LAG0203", "LAG0206", "LAG0216"}


@pytest.mark.parametrize("model", ["", "partial model A end A; ", WHOLE])
@pytest.mark.parametrize(
    "rest", ["", "package P constant Real k = 1; end P;", PARTS, "package P partial model C end C; end P;"]
)
def test_what_check_passes_can_be_built(model: str, rest: str) -> None:
    """Also where the models of a file are all in packages: the last one is meant."""
    source = Source("m.lag", model + rest)
    try:
        found = resolve(parse(source)).name
    except Refused as refused:
        assert {f.code for f in check(source, Choice())} == {f.code for f in refused.faults}
    else:
        assert not [f for f in check(source, Choice()) if f.code != "LAG0429"]
        assert found == ("A" if model == WHOLE else "D")


def test_what_was_before_needs_no_word() -> None:
    with pytest.raises(Refused) as refused:
        read("model A coordinate Length x; when x < 0 then reinit(der(x), -pre(der(x))); end when; end A;")
    assert "leave it out" in (refused.value.faults[0].remedy or "")


BALL = """
model Ball
  coordinate Length z(start = 1);
  body p = Particle(mass = 1, at = {0, 0, z});
  Gravity own;
end Ball;
"""


@pytest.mark.parametrize(
    ("body", "pairs"),
    [
        ("Ball a, b;", []),
        ("Ball b[40];\n  Gravity all;", [("b[1].own", "all")]),
        ("extends Ball;\n  Ball b;", [("own", "b.own")]),
        ("Ball a;\n  Gravity wind(g = 1, direction = {1, 0, 0});", []),
        ("Ball a;\n  Gravity all(direction = {0, 0, -0.3});", [("a.own", "all")]),
        ("Ball a;\n  Gravity one, two;", [("a.own", "one"), ("a.own", "two")]),
        ("Ball a;\n  effect more\n    Gravity all;\n  end more;", [("a.own", "all")]),
    ],
)
def test_gravity_that_acts_twice_on_a_body_is_told_once_for_each_pair(
    body: str, pairs: list[tuple[str, str]]
) -> None:
    text = f"{BALL}model Many\n  {body}\nend Many;\n"
    found = [f for f in check(Source("m.lag", text), Choice(model="Many")) if f.code == "LAG0229"]
    assert [fault.code for fault in found] == ["LAG0229"] * len(pairs)
    for fault, (one, other) in zip(found, pairs):
        assert fault.message.startswith(f"`{one}` and `{other}` both act on") and fault.severity == "warning"
