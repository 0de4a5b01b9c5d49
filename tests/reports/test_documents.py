"""What the documents show: models are models, commands and programs run as they are printed.

Those of embedding.md are run with what comes out of them, in `tests/simulation/test_controller.py`.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

import lagc
from lagc.cli.main import main
from lagc.compiler.checking import check
from lagc.compiler.pipeline import Choice
from lagc.diagnostics.faults import Source

pytestmark = pytest.mark.usefixtures("own_cache")

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


SAVED = {  # under the names that the text around gives them
    "pendulum.lag": ("README.md", "SimplePendulum"),
    "swing.lag": ("tutorial.md", "Swing"),
    "cart_pole.lag": ("embedding.md", "CartPole"),
}


def blocks(language: str) -> list[tuple[str, str]]:
    """(where, text) of every block of a language that is not marked as a fragment."""
    found = []
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
            found.append((f"{path.name}:{text.count(chr(10), 0, match.start()) + 2}", match[1]))
    return found


def lines() -> list[tuple[str, str]]:
    """(document, line) of every command of lagc, without those that install it."""
    return [
        (where.partition(":")[0], line)
        for where, text in blocks("sh")
        for line in text.splitlines()
        if line.startswith("lagc ")
    ]


@pytest.fixture
def saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the models of the documents, in which we are."""
    for name, (document, model) in SAVED.items():
        (text,) = [
            text
            for where, text in blocks("modelica")
            if where.startswith(document) and text.startswith(f"model {model} ")
        ]
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_commands_run_as_printed_there(saved: Path) -> None:
    shown = lines()
    assert {document for document, _ in shown} == {"README.md", "tutorial.md"}
    for _, line in shown:
        assert main([*shlex.split(line, comments=True)[1:], "--no-color"]) == 0, line


PROGRAMS = [b for b in blocks("python") if not b[0].startswith("embedding.md")]


@pytest.mark.parametrize(("where", "text"), PROGRAMS, ids=[where for where, _ in PROGRAMS])
def test_python_runs_as_printed_there(saved: Path, where: str, text: str) -> None:
    exec(compile(text, where, "exec"), {})


def test_what_is_found_for_a_start_is_what_is_said_there() -> None:
    page = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
    (model,) = [text for where, text in blocks("modelica") if text.startswith("model Disc ")]
    road, straight = (
        lagc.loads(model).compile(scene, backend="numpy").simulate(0.01) for scene in ("road", "straight")
    )
    assert any(note in page for note in road.notes if note.startswith("found for the start")), road.notes
    assert straight["der(x)"][0] == pytest.approx(1.5, rel=1e-12)
    assert straight["der(psi)"][0] == straight["der(theta)"][0] == 0.0


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
def test_c_of_the_interface_compiles_as_printed_there(saved: Path) -> None:
    """Its `#include` is the first line, what follows stands within a function."""
    ((_, text),) = [b for b in blocks("c") if b[0].startswith("interface.md")]
    include, _, body = text.partition("\n")
    assert main(["build", "pendulum.lag", "--target", "c", "-o", ".", "-q"]) == 0
    program = f"{include}\nint main(void)\n{{\n{body}return xdot[0] != xdot[0];\n}}\n"
    (saved / "main.c").write_text(program)
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(["gcc", *strict, "main.c", "simple_pendulum.c", "-lm", "-o", "main"], check=True)
    subprocess.run(["./main"], check=True)


@pytest.mark.parametrize(("where", "text"), blocks("modelica"), ids=lambda x: x if len(x) < 40 else "")
def test_models_of_the_documents_are_accepted(where: str, text: str) -> None:
    assert check(Source(where, text), Choice()) == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda p: p.name)
def test_links_lead_somewhere(path: Path) -> None:
    prose = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    for target in re.findall(r"\]\(([^)#]+)\)", prose):
        if "://" not in target:
            assert (path.parent / target).exists(), target
