"""The exercises of `docs/course.md`: their models, and the rows of their tables."""

import re
from functools import cache
from pathlib import Path

from lagc.base.records import dataclass
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.derivation.derivation import Derivation, derivation_of
from tests.reports.models import equations_of

ROOT = Path(__file__).resolve().parents[2]
ROW = re.compile(r"^\| ([^|]+) \| \$(.*)\$ \| `([^`]+)`(.*?) \|$", re.MULTILINE)
STEPS = {  # the words of a step -> what a formula of a derivation is about
    r"(K\d?|K of \w+|U of \w+|L|virtual power of \w+|compatible with \w+)": r"\1",
    r"momentum of (\w+)": r"conserved momentum(\1)",
    r"force of (\w+)": r"reaction(\1) solved",
}


@dataclass(frozen=True)
class Exercise:
    """A model of the page: its text, or the lines that it shows of a library model `name`. `rows` are its
    steps, each with the formula of the derivation in LaTeX, that of the book, and what is said of it."""

    name: str
    code: str
    rows: tuple[tuple[str, str, str, str], ...]

    @property
    def source(self) -> str:
        return self.name or self.code


@cache
def exercises() -> tuple[Exercise, ...]:
    text = (ROOT / "docs" / "course.md").read_text(encoding="utf-8")
    found = []
    block = re.compile(
        r"(?:`lagc derive (\w+)`\n\n)?(?:<!-- fragment -->\n)?```modelica\n(.*?)^```\n(.*?)(?=^#|^`|\Z)",
        re.S | re.M,
    )
    for name, code, rest in block.findall(text):
        found.append(Exercise(name, code, tuple(ROW.findall(rest))))
    return tuple(found)


@cache
def derivation_from(source: str) -> tuple[EquationsOfMotion, Derivation]:
    """Return the equations and the derivation of a library model, or of a text."""
    if not source.startswith("model "):
        (path,) = (ROOT / "models").rglob(f"{source}.lag")
        source = path.read_text(encoding="utf-8")
    equations = equations_of(source, "course.lag")
    return equations, derivation_of(equations)


def about_of(step: str, equations: EquationsOfMotion) -> str:
    """Return what the formula of a step is about, as in `Derivation.written`."""
    names = [c.name for c in equations.model.coordinates]
    if found := re.fullmatch(r"equation of (\w+)", step):
        return f"result {names.index(found[1])} "
    if found := re.fullmatch(r"dL/d(\w+)('?)", step):
        return f"dL/dq{found[2]} {names.index(found[1])}"
    for words, about in STEPS.items():
        if found := re.fullmatch(words, step):
            return found.expand(about)
    raise AssertionError(f"no formula is called {step}")
