"""Every stage keeps its promises, for every scene of every model of the library; compilers take its C with
all warnings as errors."""

import shutil
import subprocess
from pathlib import Path

import pytest

from lagc.codegen.c.emit import render
from lagc.diagnostics.faults import Source
from lagc.lowering.lower_equations import optimize
from lagc.mechanics.derive import derive
from lagc.semantics.resolve import resolve
from lagc.semantics.scenes import Variant, variants
from lagc.syntax.parse import parse
from tests.invariants import verify

MODELS = Path(__file__).resolve().parents[2] / "models"
FILES = sorted(MODELS.rglob("*.lag"))
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-fsyntax-only"]
LANGUAGES = {"gcc": ["-std=c99"], "g++": ["-x", "c++"]}


def every_variant() -> list[tuple[Path, Variant]]:
    return [(path, v) for path in FILES for v in variants(parse(Source(path.name, path.read_text())))]


def name(value: object) -> str:
    if isinstance(value, Path):
        return value.stem
    assert isinstance(value, Variant)
    return "-".join(filter(None, [value.scene, *value.with_effects]))


@pytest.mark.sample(0, 6)
@pytest.mark.parametrize("path, variant", every_variant(), ids=name)
def test_stages(path: Path, variant: Variant, tmp_path: Path) -> None:
    model = resolve(parse(Source(path.name, path.read_text())), variant.scene, variant.with_effects,
                    variant.without_effects, variant.model)  # fmt: skip
    verify(model)
    equations = derive(model)
    verify(equations)
    program = optimize(equations, work=True)
    verify(program)
    assert program.interface.nv == len(program.interface.v_names) > 0
    for file, text in render(program).items():
        (tmp_path / file).write_text(text)
    (source,) = tmp_path.glob("*.c")
    for command in filter(shutil.which, LANGUAGES):
        words = [command, *LANGUAGES[command], *STRICT, str(source)]
        done = subprocess.run(words, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_the_library_is_there() -> None:
    assert len(FILES) >= 40
