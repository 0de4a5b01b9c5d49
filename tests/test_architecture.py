"""The package as a whole: who imports whom, what is loaded, and that the checkers have nothing to say."""

from __future__ import annotations

import subprocess
import sys
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
