"""Compiling what was rendered."""

import importlib.util
import shutil
import struct
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from lagc.compiler import pipeline
from lagc.diagnostics.faults import Source
from lagc.lowering.program import Program

MODELS = Path(__file__).parents[2] / "models"
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror", "-ffp-contract=off"]
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "g++": ["g++", "-x", "c++", "-std=c++11"],
    "zig": [sys.executable, "-m", "ziglang", "cc", "-std=c99", "-fno-sanitize=all"],
    "zig c++": [sys.executable, "-m", "ziglang", "c++", "-x", "c++", "-std=c++11", "-fno-sanitize=all"],
}


def present(name: str) -> bool:
    """Whether a compiler of COMPILERS is there."""
    if name.startswith("zig"):
        return importlib.util.find_spec("ziglang") is not None
    return shutil.which(name) is not None


def write(files: dict[str, str], folder: Path) -> dict[str, Path]:
    """The files, by their ending."""
    for name, text in files.items():
        (folder / name).write_text(text)
    return {Path(name).suffix: folder / name for name in files}


def call(*words: str | Path) -> str:
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:3000] + done.stdout[:1000]
    return done.stdout


@cache
def of_model(name: str, work: bool = True, derivatives: bool = False, **parameters: float) -> Program:
    """The program of a model of the library, `classic/four_bar`."""
    path = MODELS / f"{name}.lag"
    return of_source(Source(path.name, path.read_text()), work, derivatives, **parameters)


def of_source(source: Source, work: bool = True, derivatives: bool = False, **parameters: float) -> Program:
    model = pipeline.resolve(pipeline.parse(source), pipeline.Choice(parameters=parameters))
    return pipeline.optimize(pipeline.derive(model), work, derivatives)


def bits(values: Iterable[float]) -> list[bytes]:
    """What tells numbers apart: signs of zeros too, but not one NaN from another."""
    return [b"nan" if v != v else struct.pack("<d", v) for v in values]
