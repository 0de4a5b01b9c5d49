"""The equations of motion as a person would write them: text, LaTeX, or a SymPy script.

    M a + h - tau - G^T lam = 0,  phi = 0,  psi = 0,  q' = N v + n where speeds are declared

each up to a factor that is a number or a product of parameters.
"""

from collections.abc import Sequence

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite
from lagc.reports.algebra.trigonometric_identities import ShortAlgebra
from lagc.reports.equations.formulas import SymbolKinds, collector_of, nonnegative, tidy
from lagc.reports.equations.modes import IMPACTS, modes
from lagc.reports.equations.page import Page, in_parts, page
from lagc.reports.equations.plain_text import TextWriter
from lagc.reports.names import Name, names, where, words_taken
from lagc.reports.patterns.formula_trees import Former
from lagc.reports.patterns.index_rules import summed
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import reachable

TITLES = {
    "shared": "shared parts",
    "entry": "definitions",
    "kinematic": "kinematics",
    "momentum": "momenta",
    "motion": "equations of motion",
    "position": "constraints on positions",
    "velocity": "constraints on velocities",
    "contact": "one-sided constraints (the equations of motion are those of open contacts)",
    **dict.fromkeys(("closed", "stick", "slip"), "dry friction"),
    "impact": "at impacts: rates of gaps after and before (impulses act as the forces above)",
    "poisson": "at impacts: impulses of restitution and of compression (they act as the forces above)",
    "event": "at events",
}


def write(
    equations: EquationsOfMotion, format: str = "text", full: bool = True, form: str = "divided"
) -> str:
    """The equations in `format`: text, latex or sympy.  Not in `full`, many are written by their rules. The
    forms are "divided" and those of `forms`. Raises NoForm."""
    motion = None
    if form != "divided":
        from lagc.reports.equations.forms import FORMS

        motion = FORMS[form]
    found = [(mode.title, page(mode.equations, full, mode.laws, motion)) for mode in modes(equations)]
    if format == "latex":
        from lagc.reports.equations.latex import write_latex

        return write_latex(found)
    if format == "sympy":
        from lagc.reports.equations.script import write_script

        return write_script(equations, found)
    return write_text(found)


def write_text(modes: Sequence[tuple[str, Page]]) -> str:
    """Return the lines of all modes, each with its title, and the legend of names."""
    lines, seen = list[str](), set[Name]()
    for title, found in modes:
        writer = TextWriter(found.names, found.ruled)
        if title:
            lines += ["", f"// {title}"]
        before = title
        for kind, group in found.by_kind():
            after = title if title and kind not in IMPACTS else TITLES[kind]
            if after != before and len(found.lines) > 1:
                lines += ["", f"// {after}"] if lines else [f"// {after}"]
            before = after
            lines += [writer.line(line) for line in group]
        seen |= writer.seen
    legend = where(seen)
    if legend:
        lines += ["", "where " + ", ".join(f"{short} = {full}" for short, full in legend)]
    return "\n".join(lines)


LIMIT, WHOLE = 20_000, 800_000  # products: of one expression; of wholes, each half of what is left
LONGEST = 600  # characters
PARTS = 24  # lines that say the parts of expressions


class Expressions:
    """Writes expressions in t, q, v and the parameters of `equations`: in full for a `whole`; otherwise long
    sums by their rule, or their length if that is too long as well."""

    def __init__(self, equations: EquationsOfMotion, whole: bool) -> None:
        self.equations, self.whole = equations, whole
        self.names = names(equations)
        self._kinds, self._taken = SymbolKinds(equations), words_taken(self.names)
        self.seen: set[Name] = set()
        self.left = WHOLE

    def text(self, node: Node) -> str:
        """`node` multiplied out and collected."""
        return self.short(node) or f"(an expression of {len(reachable([node]))} parts)"

    def short(self, node: Node) -> str:
        """The same, and "" for what is too long."""
        limit = max(LIMIT, self.left // 2) if self.whole else LIMIT
        algebra = ShortAlgebra(nonnegative(self.equations), limit=limit)
        try:
            collector = collector_of(self._kinds, algebra, [node])
            p = tidy(self.equations, algebra, algebra.polynomials([node])[0])
            found = Former(collector, self.names).total(collector.collect(p))
            for form in (found,) if self.whole else (found, summed(found, set(self._taken))):
                writer = TextWriter(self.names)
                written = writer.total(form)
                if self.whole or len(written) <= LONGEST:
                    self.seen |= writer.seen
                    return written
        except (TooLarge, NotFinite):
            pass
        finally:
            self.left -= algebra.spent
        return ""

    def texts(self, nodes: Sequence[Node]) -> tuple[list[str], list[str]]:
        """Return `text` of each node, by rules where that is shorter, and lines that define parts of them."""
        short = [self.short(node) for node in nodes]
        long = [k for k, text in enumerate(short) if not text]
        if self.whole or not long:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        try:
            found = in_parts(self.equations, [nodes[k] for k in long])
        except NotFinite:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        writer = TextWriter(found.names)
        sums = [writer.total(line.left) for line in found.lines if line.kind == "motion"]
        parts = [writer.line(line) for line in found.lines if line.kind == "shared"]
        if len(parts) > PARTS or max(map(len, [*sums, *parts])) > LONGEST:
            return [text or self.text(node) for text, node in zip(short, nodes)], []
        self.seen |= writer.seen
        for k, text in zip(long, sums):
            short[k] = text
        return short, parts
