"""A solution in PDF, by a LaTeX of this machine."""

from __future__ import annotations

import os
import shutil
import subprocess

from lagc.host.atomic_write import scratch
from lagc.reports.derivation.derivation import Derivation

PROGRAMS = ("pdflatex", "lualatex", "xelatex", "tectonic")
SECONDS = 120.0  # of one pass


class NoLatex(Exception):
    """No LaTeX is installed, or it failed; the message says what to do."""


def to_pdf(found: Derivation) -> bytes:
    """Return the solution in PDF. Raises NoLatex."""
    program = next((name for name in PROGRAMS if shutil.which(name)), None)
    if program is None:
        raise NoLatex(
            f"a PDF needs a LaTeX: none of {', '.join(PROGRAMS)} is installed; write .tex or .html instead"
        )
    with scratch() as folder:
        for name, data in {"solution.tex": found.latex.encode(), **found.pictures(".tex")}.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(data)
        options = [] if program == "tectonic" else ["-interaction=nonstopmode", "-no-shell-escape"]
        try:
            done = subprocess.run([program, *options, "solution.tex"], cwd=folder, capture_output=True,
                                  stdin=subprocess.DEVNULL, timeout=SECONDS)  # fmt: skip
            with open(os.path.join(folder, "solution.pdf"), "rb") as file:
                return file.read()
        except (OSError, subprocess.TimeoutExpired):
            lines = done.stdout.decode(errors="replace").splitlines() if "done" in locals() else []
            said = next((line for line in lines if line.startswith("!")), "no PDF was made")
            raise NoLatex(f"{program} failed: {said}; write .tex or .html instead") from None
