"""What the scene does not use does not exist: its code is that of the model without it."""

import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Refused, Source, Span
from lagc.reports.explain import explanation
from lagc.semantics.scenes import Variant, variants
from lagc.syntax import tree
from lagc.syntax.parse import parse

MODELS = Path(__file__).resolve().parents[2] / "models"

SEVERAL = """
model Box
  parameter Mass m = 2;
  parameter Length unused = 3;
  coordinate Length x(start = 1), y, spare;
  effect tilt
    coordinate Angle a(start = 0.1);
    parameter Inertia I = 2;
    frame F = rotate_z(world, a);
    body plate = Solid(mass = m, inertia = {I, I, I}, frame = F, com = {0, 0, 0});
    potential spring = 1 [J]*a^2 + 1 [J/m]*x*a;
  end tilt;
  effect plane constraint flat: y = 0.1 [m]*x/1 [m]; end plane;
  effect lift potential up = 1 [N]*y; output Power p = power(up); end lift;
  effect air excludes plane;
    parameter Damping c = 1;
    dissipation D = 1/2*c*(der(x)^2 + der(y)^2);
  end air;
  body b = Particle(mass = m, at = {x, y, 0});
  potential home = 1/2*3 [N/m]*dot(position(b), position(b)) unless tilt;
  output Energy E = energy();
  scene nothing;
  scene one uses lift;
  scene held uses plane, lift;
  scene all uses air, tilt, lift;
end Box;
"""


def _texts() -> Iterator[tuple[str, str, Variant]]:
    sources = [(path.stem, path.read_text("utf-8")) for path in sorted(MODELS.rglob("*.lag"))]
    for name, text in [*sources, ("box", SEVERAL)]:
        file = parse(Source(name, text))
        effects = {inner.name for d in _models(file) for inner in d.body if isinstance(inner, tree.Effect)}
        for variant in variants(file):
            if not variant.with_effects and effects - _used(file, variant.scene):
                yield name, text, variant


def _used(file: tree.Tree, scene: str | None) -> set[str]:
    scenes = [inner for d in _models(file) for inner in d.body if isinstance(inner, tree.Scene)]
    return {name.name for d in scenes if d.name == scene for name in d.uses}


def _models(file: tree.Tree) -> list[tree.ModelDeclaration]:
    return [d for d in file.declarations if isinstance(d, tree.ModelDeclaration)]


CASES = list(_texts())


def without_unused(file: tree.Tree, scene: str | None) -> str:
    """The text without the effects that `scene` does not use, and without the other scenes, which
    name them.  Line ends stay, since the C names the lines that things are declared in."""
    removed: list[Span] = []
    for model in _models(file):
        scenes = [d for d in model.body if isinstance(d, tree.Scene)]
        uses = {name.name for d in scenes if d.name == scene for name in d.uses}
        removed += [d.span for d in scenes if d.name != scene]
        removed += [d.span for d in model.body if isinstance(d, tree.Effect) and d.name not in uses]
    gone = {
        d.name
        for model in _models(file)
        for d in model.body
        if isinstance(d, tree.Effect)
        if d.span in removed
    }
    text = file.source.text
    for span in sorted(removed, key=lambda s: s.start, reverse=True):
        lines = "\n" * text.count("\n", span.start, span.end)
        text = text[: span.start] + lines + text[span.end :]

    def others(listed: re.Match[str]) -> str:
        kept = [name for name in re.split(r",\s*", listed[2]) if name not in gone]
        if kept:
            return f"{listed[1]} {', '.join(kept)}{listed[3]}"
        return listed[3] if listed[1] == "unless" else ""

    return re.sub(r"\b(excludes|unless) (\w+(?:,\s*\w+)*)( *;)", others, text)


def _code(name: str, text: str, choice: Choice) -> list[dict[str, str]]:
    """The C and the Python."""
    found = pipeline.Compilation(Source(name, text), choice)
    program = pipeline.optimize(found.equations, work=False)
    return [pipeline.render(program, target) for target in ("c", "numpy")]


@pytest.mark.sample(1, 11)
@pytest.mark.parametrize("name, text, variant", CASES, ids=[f"{n}-{v.scene}" for n, _, v in CASES])
def test_the_code_is_that_of_the_model_without_unused_effects(name: str, text: str, variant: Variant) -> None:
    shorter = without_unused(parse(Source(name, text)), variant.scene)
    choice = Choice(model=variant.model, scene=variant.scene)
    assert _code(name, text, choice) == _code(name, shorter, choice)


# an effect, and the effects that it needs; {k} makes names its own
_DRAWN = (
    ("parameter Real[N/m3] p{k} = 2; potential V{k} = 1/4*p{k}*x^4;", "x"),
    ("parameter Damping p{k} = 2; dissipation D{k} = 1/2*p{k}*(der(x)^2 + der(y)^2);", "xy"),
    ("parameter Real[kg/m] p{k} = 2; force F{k} = -p{k}*norm(velocity(b))*velocity(b) at b;", "xy"),
    ("parameter Force p{k} = 2; force F{k} = p{k}*cos(3*time/1 [s])*world.y at b;", "y"),
    ("coordinate Length u{k}(start = 1); body b{k} = Particle(mass = 2, at = {{0, 0, u{k}}}); "
     "potential V{k} = 1 [N/m]*u{k}^2;", ""),
    ("constraint c{k}: y = 0.1 [1/m]*x^2;", ""),
    ("when x < 0 then reinit(der(x), -der(x)); end when;", ""),
    ("discrete Real s{k}(start = 1); when y > 0 then reinit(s{k}, 2); end when; "
     "force F{k} = s{k}*1 [N]*world.x at b;", ""),
    ("output Power P{k} = power(home);", ""),
)  # fmt: skip


@pytest.mark.sample(2, 20)
@pytest.mark.parametrize("seed", range(60))
def test_the_code_of_random_effects_is_that_without_the_unused(seed: int) -> None:
    drawn = random.Random(seed)
    kinds = [drawn.choice(_DRAWN)[0].format(k=k) for k in range(drawn.randint(2, 8))]
    names = [f"e{k}" for k in range(len(kinds))]
    used = [name for name in names if drawn.random() < 0.5]
    spare = [name for name in names if name not in used]
    texts = []
    for name, body in zip(names, kinds):
        before = names[: names.index(name)]
        needed = [other for other in before if other in used and drawn.random() < 0.2]
        apart = [other for other in spare if other != name and drawn.random() < 0.2] if name in used else []
        texts.append(f"  effect {name}\n")
        texts[-1] += f"    requires {', '.join(needed)};\n" if needed else ""
        texts[-1] += f"    excludes {', '.join(apart)};\n" if apart else ""
        texts[-1] += f"    {body}\n  end {name};\n"
    text = f"""model Drawn
  coordinate Length x(start = 1), y;
  body b = Particle(mass = 2, at = {{x, y, 0}});
  potential home = 3 [N/m]*dot(position(b), position(b)){f" unless {spare[0]}" if spare else ""};
{"".join(texts)}  scene some{f" uses {', '.join(used)}" if used else ""};
  scene others{f" uses {spare[0]}" if spare and "P" not in kinds[names.index(spare[0])] else ""};
end Drawn;
"""
    shorter = without_unused(parse(Source("drawn", text)), "some")
    assert len(shorter) < len(text) or not spare
    outcomes = []
    for written in (text, shorter):
        try:
            outcomes.append(_code("drawn", written, Choice(scene="some")))
        except Refused as refused:  # two constraints that say the same, at most
            outcomes.append([{fault.code: "" for fault in refused.faults}])
    assert outcomes[0] == outcomes[1]


@pytest.mark.parametrize("kind", range(len(_DRAWN)))
def test_operations_grow_by_those_of_the_effect_alone(kind: int) -> None:
    """An effect adds as many operations beside ten others as beside two."""
    counts = []
    for others in (2, 10):
        text = "".join(
            f"  effect e{k} parameter Energy p{k} = 1; "
            f"potential W{k} = p{k}*sin({k + 1}*{'xy'[k % 2]}/1 [m]); end e{k};\n"
            for k in range(others)
        )
        used = [f"e{k}" for k in range(others)]
        text = f"""model Grown
  coordinate Length x(start = 1), y;
  body b = Particle(mass = 2, at = {{x, y, 0}});
  potential home = 3 [N/m]*dot(position(b), position(b));
{text}  effect own {_DRAWN[kind][0].format(k="_own")} end own;
  scene without uses {", ".join(used)};
  scene with_it uses {", ".join(used)}, own;
end Grown;
"""
        found = [
            pipeline.optimize(pipeline.Compilation(Source("grown", text), Choice(scene=scene)).equations,
                              work=False).interface.operations
            for scene in ("without", "with_it")
        ]  # fmt: skip
        counts.append(found[1] - found[0])
    assert abs(counts[1] - counts[0]) <= 1


def test_something_is_removed() -> None:
    kept = without_unused(parse(Source("box", SEVERAL)), "one")
    assert "effect lift" in kept and "effect air" not in kept and "effect tilt" not in kept
    assert kept.count("\n") == SEVERAL.count("\n")


def test_what_nothing_depends_on_is_pruned_and_said() -> None:
    found = pipeline.Compilation(Source("box", SEVERAL), Choice(scene="one"))
    program = pipeline.optimize(found.equations, work=False)
    assert program.interface.q_names == ("x", "y")
    assert [p.name for p in program.interface.parameters] == ["m"]
    said = explanation(found.equations, program)["pruned"]
    assert isinstance(said, list)
    for line in ("effect `tilt` is left out", "parameter `unused` reaches nothing"):
        assert line in said
    assert "`spare` is dropped: nothing asked for depends on it" in said


def test_a_scene_names_the_effect_of_one_element() -> None:
    text = """model Car
      coordinate Length x(rate = 1);
      body b = Particle(mass = 1, at = {x, 0, 0});
      effect drag force f = -1 [N.s/m]*velocity(b) at b; end drag;
    end Car;
    model Row
      structural Integer n = 3;
      Car r[n], grid[2, 2];
      scene one uses r[2].drag;
      scene two uses r[1].drag, grid[2, 1].drag;
      scene none uses r[4].drag;
    end Row;"""
    for scene, dragged in (("one", {"r[2].f"}), ("two", {"r[1].f", "grid[2,1].f"})):
        model = pipeline.resolve(parse(Source("row.lag", text)), Choice(scene=scene, model="Row"))
        assert {f.name for f in model.actions} == dragged
    with pytest.raises(Refused, match=r"there is no effect `r\[4\].drag`"):
        pipeline.resolve(parse(Source("row.lag", text)), Choice(scene="none", model="Row"))
