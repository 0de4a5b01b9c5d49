"""The package as a whole: who imports whom, what is loaded, and that the checkers have nothing to say."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
IMPORT_LINTER = """
import sys
from importlinter.cli import lint_imports_command
sys.argv = ["lint-imports", "--no-cache"]
lint_imports_command()
"""


def python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=240)


def test_rooms_import_only_what_comes_before_them() -> None:
    pytest.importorskip("importlinter")
    done = python("-c", IMPORT_LINTER)
    assert done.returncode == 0, done.stdout + done.stderr


def imports(tree: ast.AST, known: set[str]) -> Iterator[str]:
    """The files that a file imports, within functions too; not those of which it knows types alone."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            yield from (names & known) or ({node.module} & known)
        yield from imports(node, known)


def circle(files: dict[str, str]) -> list[str]:
    """Files, by name and text, that import one another around; none where none do."""
    needs = {name: set(imports(ast.parse(text), set(files))) for name, text in files.items()}
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_file_imports_one_that_imports_it() -> None:
    paths = [path for path in (ROOT / "lagc").rglob("*.py") if "support" not in path.parts]
    names = {path: ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in paths}
    files = {name.removesuffix(".__init__"): path.read_text() for path, name in names.items()}
    assert not circle(files)


def test_circles_of_imports_are_seen() -> None:
    late = "def f():\n    from lagc.b import g\n"
    assert circle({"lagc.a": late, "lagc.b": "import lagc.a"})
    assert circle(
        {"lagc.a": late, "lagc.b": "from lagc import c", "lagc.c": "if True:\n    from lagc.a import f"}
    )
    assert not circle({"lagc.a": late, "lagc.b": "if TYPE_CHECKING:\n    import lagc.a"})


@pytest.mark.parametrize("forbidden", ["numpy", "lark", "sympy", "scipy", "matplotlib"])
def test_the_package_imports_nothing_heavy(forbidden: str) -> None:
    program = f"import sys, lagc, lagc.cli.main, lagc.cli.sim; sys.exit({forbidden!r} in sys.modules)"
    assert python("-c", program).returncode == 0


@pytest.mark.parametrize("arguments", ["ruff check", "ruff format --check lagc tests", "mypy"])
def test_the_checkers_have_nothing_to_say(arguments: str) -> None:
    program, *rest = arguments.split()
    pytest.importorskip(program)
    done = python("-m", program, *rest)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_room_says_what_it_is_for() -> None:
    silent = [path for path in (ROOT / "lagc").rglob("__init__.py") if not path.read_text().startswith('"""')]
    assert not silent
