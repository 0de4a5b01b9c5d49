"""The C of every scene of every model of the library passes the compilers with all warnings as errors."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from lagc import compiler
from lagc.diagnostics.faults import Source
from lagc.meaning.variants import Variant
from tests.stages.test_stages import every_variant, name

STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-fsyntax-only"]
LANGUAGES = {"gcc": ["-std=c99"], "g++": ["-x", "c++"]}


@pytest.mark.parametrize("path, variant", every_variant(), ids=name)
def test_no_warning(path: Path, variant: Variant, tmp_path: Path) -> None:
    chosen = compiler.Choice(variant.model, variant.scene, variant.with_effects, variant.without_effects)
    program = compiler.program(Source(path.name, path.read_text()), chosen)
    for file, text in compiler.render(program, "c").items():
        (tmp_path / file).write_text(text)
    (source,) = tmp_path.glob("*.c")
    for command, language in LANGUAGES.items():
        if shutil.which(command) is None:
            pytest.skip(f"no {command}")
        done = subprocess.run([command, *language, *STRICT, str(source)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
