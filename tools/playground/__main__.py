"""Build the playground: lagc in a browser, as a folder of static files that needs no server.

    python -m tools.playground FOLDER

Needs Node. The packages are those of `package-lock.json`: Pyodide, KaTeX, CodeMirror.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from lagc.compiler.shipped import files as shipped
from lagc.editor.colours import patterns
from lagc.host.model_library import library_models, read

ROOT = Path(__file__).resolve().parent.parent.parent
HERE = ROOT / "tools" / "playground"
PLACES = {"models": "lagc/models", "docs/reference/messages": "lagc/messages", "grammar": "lagc/grammar"}


def members() -> Iterator[tuple[str, bytes]]:
    """Yield the files of Python's library folder: lagc as it is installed, array functions, the answers."""
    made = {path: text.encode() for path, text in shipped(ROOT).items()}
    for path in sorted((ROOT / "lagc").rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts and path not in made:
            yield path.relative_to(ROOT).as_posix(), path.read_bytes()
    for path, content in made.items():
        if "double" not in path.name:  # kernels in C
            yield path.relative_to(ROOT).as_posix(), content
    for folder, place in PLACES.items():
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file():
                yield f"{place}/{path.relative_to(ROOT / folder).as_posix()}", path.read_bytes()
    for path in [*sorted((HERE / "numpy").glob("*.py")), HERE / "answers.py"]:
        yield path.relative_to(HERE).as_posix(), path.read_bytes()


def build(folder: Path) -> None:
    """Write the playground into `folder`.  Raises OSError and subprocess.CalledProcessError."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (HERE / "node_modules").is_dir():
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=HERE, check=True, stdout=sys.stderr)
    with ZipFile(folder / "lagc.zip", "w", ZIP_DEFLATED) as archive:
        for name, content in members():
            archive.writestr(ZipInfo(name), content, ZIP_DEFLATED)
    subprocess.run(["node", HERE / "compile.mjs", folder / "lagc.zip"], check=True)
    models = {name: read(name).text for name in library_models()}
    text = f"self.MODELS = {json.dumps(models)};\nself.COLOURS = {json.dumps(patterns())};\n"
    (folder / "models.js").write_text(text, encoding="ascii")
    subprocess.run(["node", HERE / "build.mjs", folder.resolve()], check=True)
    (folder / "lagc.zip").unlink()


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tools.playground", description=__doc__)
    parser.add_argument("folder", type=Path)
    asked = parser.parse_args()
    if not shutil.which("node") or not shutil.which("npm"):
        parser.error("the playground needs Node: `node` and `npm` are not on the path")
    build(asked.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
