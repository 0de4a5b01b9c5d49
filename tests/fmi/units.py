"""FMUs of library models, and what is made of their sources."""

import io
import subprocess
import zipfile
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

from lagc.compiler.fmu import fmu
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.host import model_library
from lagc.simulation.backends.cross import Platform


@cache
def archive(model: str, version: int = 3, platforms: tuple[Platform, ...] | None = ()) -> bytes:
    """The FMU of a library model or of a text, without libraries by default."""
    source = Source("model.lag", model) if "\n" in model else model_library.read(model)
    compilation = Compilation(source, Choice())
    _, files = fmu(compilation, version, ("dop853",), platforms)
    ((_, data),) = files.items()
    return data


def contents(data: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        return {name: file.read(name) for name in file.namelist()}


def description(data: bytes) -> ET.Element:
    return ET.fromstring(contents(data)["modelDescription.xml"])


def sources(data: bytes, folder: Path) -> list[str]:
    """Write the sources of an FMU into a folder; return the files that its description lists."""
    found = contents(data)
    for name, text in found.items():
        if name.startswith("sources/"):
            (folder / Path(name).name).write_bytes(text)
    build = found.get("sources/buildDescription.xml", found["modelDescription.xml"])
    return [file.attrib["name"] for tag in ("SourceFile", "ModelExchange/SourceFiles/File")
            for file in ET.fromstring(build).findall(f".//{tag}")]  # fmt: skip


def gcc(folder: Path, *words: str) -> None:
    """Compile in a folder, without optimization."""
    command = ["gcc", "-std=c99", "-Wall", "-Werror", "-O0", "-ffp-contract=off", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def program(data: bytes, main: str, folder: Path) -> Path:
    """Compile `main`, a C file of this folder, with the sources of an FMU."""
    files = sources(data, folder)
    (folder / main).write_bytes((Path(__file__).parent / main).read_bytes())
    gcc(folder, *files, main, "-o", "main", "-lm")
    return folder / "main"
