"""Placeholders: bodies, points and frames that an instance gives; files of the library."""

from pathlib import Path

import pytest

from lagc.compiler import pipeline
from lagc.compiler.checking import check
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source
from lagc.host.model_library import library_models, models_folder
from lagc.semantics.model import Model
from lagc.syntax.parse import parse

PULL = """model Pull
  body b "what is pulled";
  point P;
  frame F;
  input Force u = 1;
  parameter Force f = 3;
  force along = (f + u)*F.x at P;
  potential V = 1 [N/m]*dot(position(b), position(b));
  %s
end Pull;
model M
  coordinate Length x, y;
  coordinate Angle a;
  frame A = rotate_z(world, a);
  body p = Particle(mass = 2 [kg], at = {x, 0, 0});
  body q[1] = Particle(mass = 1 [kg], at = {x, y, 0});
  body q[2] = Solid(mass = 1 [kg], inertia = {1, 1, 1}, frame = A, com = {0, y, 0});
  %s
end M;
"""


def of(instance: str, inside: str = "", scene: str | None = None) -> Model:
    return pipeline.resolve(parse(Source("m.lag", PULL % (inside, instance))), Choice(scene=scene))


def test_an_instance_is_what_could_have_been_written_there() -> None:
    """The same C, but for names and lines."""
    by_instance = PULL % (
        "",
        "effect e Pull w(b = p, P = q[1], F = A, u = 2*x*1 [N/m]); end e; scene s uses e;",
    )
    written = PULL % (
        "",
        """effect e
    parameter Force f = 3;
    force along = (f + 2*x*1 [N/m])*A.x at position(q[1]);
    potential V = 1 [N/m]*dot(position(p), position(p));
  end e;
  scene s uses e;""",
    )
    programs = []
    for text in (by_instance, written):
        equations = pipeline.Compilation(Source("m.lag", text), Choice()).equations
        programs.append(pipeline.optimize(equations, work=False))
    one, other = programs
    assert one.interface.operations == other.interface.operations
    assert len(one.interface.outputs) == len(other.interface.outputs) == 0
    assert [p.name for p in one.interface.parameters] == ["w.f"]


def test_what_an_instance_declares_belongs_to_its_effect() -> None:
    model = of("effect e Pull w(b = p, P = p, F = A); end e; scene s uses e;")
    assert {a.name: a.effect for a in model.actions} == {"w.along": "e", "w.V": "e"}


def test_arrays_of_instances() -> None:
    model = of("Pull w[2](b = q, each P = p, each F = world, f = {1, 2});")
    assert [a.name for a in model.actions] == ["w[1].along", "w[1].V", "w[2].along", "w[2].V"]
    assert [body.name for body in model.bodies] == ["p", "q[1]", "q[2]"]


def test_a_model_that_extends_another_gives_it_its_body() -> None:
    model = of("extends Pull(b = p, P = p, F = world);")
    assert [a.name for a in model.actions] == ["along", "V"]


def test_an_instance_within_an_instance_hands_on() -> None:
    text = (PULL % ("", "")).replace(
        "model M", "model Outer body c; Pull in(b = c, P = c, F = world); end Outer;\nmodel M"
    )
    text = text.replace("end M;", "Outer o(c = p);\nend M;")
    model = pipeline.resolve(parse(Source("m.lag", text)), Choice())
    assert [a.name for a in model.actions] == ["o.in.along", "o.in.V"]


@pytest.mark.parametrize(
    ("instance", "inside", "code", "words"),
    [
        ("Pull w(P = p, F = A);", "", "LAG0210", "`w` is not given the body `b`"),
        ("Pull w(b = x, P = p, F = A);", "", "LAG0209", "`b` of `Pull` is a body; this is a number"),
        ("Pull w(b = p, P = x, F = A);", "", "LAG0306", "a point must be a vector"),
        ("Pull w(b = p, P = {1, 2, 3} [kg], F = A);", "", "LAG0302", "a point must be Length"),
        ("Pull w(b = p, P = velocity(p)*1 [s], F = A);", "", "LAG0", "a point"),
        ("Pull w(b = p, P = p, F = p);", "", "LAG0209", "`F` of `Pull` is a frame; this is a body"),
        ("Pull w(b = p, P = p, F = A, g = p);", "", "LAG0209", "has no `g`"),
        ("Pull w[3](b = q, each P = p, each F = A);", "", "LAG0207", "there is no `q[3]`"),
        ("Pull w(b = q, P = p, F = A);", "", "LAG0209", "is a body; this is an array of things"),
        ("Pull w(b = p, P = p, F = A);", "potential U;", "LAG0210", "the potential `U` needs a value"),
        ("Pull w(b = p, P = p, F = A);", "point b;", "LAG0202", "`b` is declared twice"),
        ("Pull w(b = w, P = p, F = A);", "", "LAG0209", "this is an instance"),
    ],
)  # fmt: skip
def test_faults(instance: str, inside: str, code: str, words: str) -> None:
    with pytest.raises(Refused) as refused:
        of(instance, inside)
    fault = refused.value.faults[0]
    assert fault.code.startswith(code) and words in fault.message
    assert fault.span is not None


@pytest.mark.parametrize(
    ("instance", "remedy"),
    [
        ("QuadraticDrag d(rho = 1.2 [kg/m3]);", "QuadraticDrag d(rho = 1.2 [kg/m3], b = p);"),
        ("Lift d;", "Lift d(b = p, F = world);"),
        ("Lift d[2](each C = 1);", "Lift d[2](each C = 1, each b = p, each F = world);"),
    ],
)
def test_a_missing_placeholder_is_a_fault_of_the_instance(instance: str, remedy: str) -> None:
    """At the line of the user, with the line to write in its place."""
    text = f"""import "effects/fluid_forces.lag";
model M
  coordinate Length x(rate = 1 [m/s]), y;
  body p = Particle(mass = 2 [kg], at = {{x, 0, y}});
  effect air
    {instance}
  end air;
  scene s uses air;
end M;
"""
    (fault,) = check(Source("m.lag", text), Choice())
    assert fault.code == "LAG0210" and fault.span is not None
    assert (fault.span.source.name, fault.span.line) == ("m.lag", 6)
    assert fault.remedy == f"write `{remedy}`"
    assert "fluid_forces" in fault.related[0][0].source.name
    assert check(Source("m.lag", text.replace(instance, remedy)), Choice()) == []


def test_a_model_with_a_placeholder_does_not_run_alone_but_is_no_fault() -> None:
    text = PULL % ("", "Pull w(b = p, P = p, F = A);")
    found = check(Source("m.lag", text + "model Other extends M; end Other;"), Choice())
    assert found == []
    with pytest.raises(Refused, match="is not given"):
        pipeline.resolve(parse(Source("m.lag", text)), Choice(model="Pull"))


@pytest.mark.parametrize("form", ["{0}{1}", "package P {0}{1} end P;"])
def test_the_model_that_commands_take_is_checked_though_it_has_a_placeholder(form: str) -> None:
    whole = "model M coordinate Length x; body p = Particle(mass = 1, at = {x, 0, 0}); end M;\n"
    part = "model D body b; force f = 1 [N]*world.x at b; end D;\n"
    for first, last, expected in ((whole, part, ["LAG0210"]), (part, whole, [])):
        found = check(Source("m.lag", form.format(first, last)), Choice())
        assert [fault.code for fault in found if fault.severity == "error"] == expected
    with pytest.raises(Refused, match="is not given"):
        pipeline.resolve(parse(Source("m.lag", form.format(whole, part))), Choice())


def test_a_file_of_ones_own_comes_before_that_of_the_library(tmp_path: Path) -> None:
    main = 'import "effects/springs.lag";\nmodel M\n coordinate Length x;\n'
    main += " body p = Particle(mass = 1, at = {x, 0, 0});\n Spring s(A = p, B = {0, 0, 0});\nend M;\n"
    path = tmp_path / "m.lag"
    path.write_text(main)

    def parameters() -> list[str]:
        model = pipeline.resolve(parse(Source(str(path), path.read_text())), Choice())
        return [p.name for p in model.parameters]

    assert parameters() == ["s.k", "s.l"]
    (tmp_path / "effects").mkdir()
    own = "model Spring point A; point B; parameter Force g = 1; force f = g*world.x at A from B; end Spring;"
    (tmp_path / "effects" / "springs.lag").write_text(own.replace(" from B", ""))
    assert parameters() == ["s.g"]


@pytest.mark.parametrize(
    "written", ["../pyproject.toml", "effects/../../pyproject.toml", "effects/none.lag", "effects"]
)
def test_the_library_is_no_way_out(written: str, tmp_path: Path) -> None:
    text = f'import "{written}";\nmodel M coordinate Length x; '
    text += "body p = Particle(mass = 1, at = {x, 0, 0}); end M;"
    path = tmp_path / "m.lag"
    path.write_text(text)
    with pytest.raises(Refused) as refused:
        pipeline.resolve(parse(Source(str(path), text)), Choice())
    assert refused.value.faults[0].code in ("LAG0216", "LAG0217", "LAG0226")


def test_every_effect_of_the_library_is_on_its_page() -> None:
    page = (Path(models_folder()).parent / "docs" / "reference" / "effects.md").read_text("utf-8")
    for name in library_models():
        if name.startswith("effects/"):
            path = Path(models_folder()) / f"{name}.lag"
            for model in parse(Source(name, path.read_text("utf-8"))).declarations:
                body = getattr(model, "body", ())
                if any(type(d).__name__ == "Placeholder" for d in body):
                    assert f"`{model.name}(" in page, model.name  # type: ignore[union-attr]
