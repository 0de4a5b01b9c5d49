"""The package as a whole: who imports whom, what is loaded, and that the checkers have nothing to say."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

import pytest

from lagc.lowering.program import Interface
from tests.test_words import functions

ROOT = Path(__file__).resolve().parent.parent
IMPORT_LINTER = """
import sys
from importlinter.cli import lint_imports_command
sys.argv = ["lint-imports", "--no-cache"]
lint_imports_command()
"""


def python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=240)


@pytest.mark.full
def test_rooms_import_only_what_comes_before_them() -> None:
    pytest.importorskip("importlinter")
    done = python("-c", IMPORT_LINTER)
    assert done.returncode == 0, done.stdout + done.stderr


IMPORT = re.compile(r"^[ ]*(?:from (lagc[\w.]*) import (\([^)]*\)|.*)|import (lagc[\w.]*))", re.MULTILINE)


def imports(text: str, known: set[str]) -> Iterator[str]:
    """Yield the modules that a module imports: at the top, within functions and for type checkers alone. They
    are found in the text, as it takes long to parse all modules."""
    for module, names, whole in IMPORT.findall(text):
        found = {f"{module}.{name}" for name in re.findall(r"\w+", names)} or {whole}
        yield from (found & known) or ({module} & known)


def circles(files: dict[str, str]) -> list[frozenset[str]]:
    """Return the sets of modules, given by name and text, that import one another in a circle."""
    needs = {name: set(imports(text, set(files))) - {name} for name, text in files.items()}
    found: set[frozenset[str]] = set()
    while True:
        try:
            TopologicalSorter(needs).prepare()
            return sorted(found, key=sorted)
        except CycleError as error:
            circle = error.args[1]  # each module, and behind it one that imports it
            found.add(frozenset(circle))
            for imported, importer in pairwise(circle):
                needs[importer].discard(imported)


def modules() -> dict[str, str]:
    paths = [path for path in (ROOT / "lagc").rglob("*.py") if "support" not in path.parts]
    names = {path: ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in paths}
    return {name.removesuffix(".__init__"): path.read_text() for path, name in names.items()}


def test_no_modules_import_one_another_in_a_circle() -> None:
    assert not circles(modules())


def test_circles_of_imports_are_found() -> None:
    late = "def f():\n    from lagc.b import g\n"
    both = [frozenset({"lagc.a", "lagc.b"})]
    assert circles({"lagc.a": late, "lagc.b": "import lagc.a"}) == both
    assert circles({"lagc.a": late, "lagc.b": "if TYPE_CHECKING:\n    import lagc.a"}) == both
    deep = {"lagc.a": late, "lagc.b": "from lagc import c", "lagc.c": "if True:\n    from lagc.a import f"}
    assert circles(deep) == [frozenset({"lagc.a", "lagc.b", "lagc.c"})]
    assert not circles({"lagc.a": late, "lagc.b": "import os"})


@pytest.mark.sample(3)
@pytest.mark.parametrize("forbidden", ["numpy", "lark", "sympy", "scipy", "matplotlib"])
def test_the_package_imports_nothing_heavy(forbidden: str) -> None:
    program = f"import sys, lagc, lagc.cli.main, lagc.cli.sim; sys.exit({forbidden!r} in sys.modules)"
    assert python("-c", program).returncode == 0


@pytest.mark.full
@pytest.mark.parametrize("arguments", ["ruff check", "ruff format --check lagc tests", "mypy"])
def test_the_checkers_have_nothing_to_say(arguments: str) -> None:
    program, *rest = arguments.split()
    pytest.importorskip(program)
    done = python("-m", program, *rest)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_room_says_what_it_is_for() -> None:
    silent = [path for path in (ROOT / "lagc").rglob("__init__.py") if not path.read_text().startswith('"""')]
    assert not silent


FOLDERS = {
    "docs", "grammar", "lagc", "models", "tests", "tools", *(p.name for p in (ROOT / "lagc").iterdir()),
}  # fmt: skip


def paths_in(text: str) -> list[str]:
    """Return the paths in backticks: files of Python, and whatever begins with a folder of the project."""
    named = re.findall(r"`([\w./-]+)`", text)
    return [
        path
        for path in named
        if re.search(r"\w\.py$", path) or (path.split("/")[0] in FOLDERS and "/" in path)
    ]


def test_documents_name_files_that_exist() -> None:
    """A path begins at the root or in `lagc`; a bare name is that of a file of `lagc`."""
    names = {path.name for path in (ROOT / "lagc").rglob("*.py")}
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    found = [(page.name, path) for page in pages for path in paths_in(page.read_text(encoding="utf-8"))]
    assert ("events.md", "lagc/kernels/events") in found
    assert not [
        (page, path)
        for page, path in found
        if not ((ROOT / path).exists() or (ROOT / "lagc" / path).exists() or path in names)
    ]


def test_documents_name_members_of_the_interface() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    named = set(re.findall(r"\.interface\.(\w+)", text))
    assert named and named <= {*Interface.__annotations__, *dir(Interface)}


LONGEST_FUNCTION, LONGEST_FILE = 60, 600  # lines


def test_functions_and_files_are_short() -> None:
    long = list[str]()
    for path in (ROOT / "lagc").rglob("*.py"):
        lines = path.read_text(encoding="utf-8").split("\n")
        long += [path.name] if len(lines) > LONGEST_FILE + 1 else []
        long += [name for name, first, last in functions(lines) if last - first >= LONGEST_FUNCTION]
    assert not long
