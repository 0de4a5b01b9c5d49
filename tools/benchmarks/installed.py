"""lagc as an installation lays it out: byte code, the parser's tables and the kernels are there already."""

from __future__ import annotations

import compileall
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from lagc.compiler.shipped import files

CHECKOUT = Path(__file__).parents[2]


@cache
def folder() -> str:
    """A temporary folder for PYTHONPATH, made once."""
    root = Path(tempfile.mkdtemp(prefix="lagc-installed-"))
    package = root / "lagc"
    shutil.copytree(CHECKOUT / "lagc", package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("grammar", "models"):
        shutil.copytree(CHECKOUT / name, package / name)
    for path, text in files(CHECKOUT).items():  # as `hatch_build.py`
        (package / path.relative_to(CHECKOUT / "lagc")).write_text(text, encoding="utf-8")
    compileall.compile_dir(package, quiet=1)
    return str(root)


def run(words: Sequence[str], cache: str, limit: float | None = None) -> subprocess.CompletedProcess[str]:
    """One process that imports this lagc, with the given cache folder; TimeoutExpired after `limit` s."""
    environment = dict(os.environ, LAGC_CACHE=cache, PYTHONPATH=folder())
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run(words, env=environment, cwd=folder(), capture_output=True, text=True, timeout=limit)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)[:200]} failed: {done.stderr}")
    return done
