"""The last section of a solution: values, a run and its plot."""

from __future__ import annotations

import io

from lagc.base.records import replace
from lagc.reports.derivation.derivation import Derivation
from lagc.reports.derivation.document import Block, Heading, Paragraph, Picture, Table, math, plain
from lagc.reports.derivation.phrases import Phrases
from lagc.reports.equations.latex import letter
from lagc.reports.plots.plot import plot, styled, svg
from lagc.simulation.solution import Solution

PLOT = "solution-motion"  # the name of its files


def with_motion(found: Derivation, run: Solution) -> Derivation:
    """Return the solution with the values of a run, its start, its plot and its error. Raises ImportError
    without matplotlib."""
    say, interface = Phrases(found.language), run.system.interface
    fields = [*interface.parameters, *interface.inputs]
    rows = [(math(letter(f.name.rpartition(".")[2])), plain(f"{value:.6g}"), plain(f.unit or "1"))
            for f, value in zip(fields, run.parameters)]  # fmt: skip
    start = [(plain(name), plain(f"{value:.6g}"), plain(unit or "1"))
             for name, unit, value in zip(run.state_names, interface.state_units, run.states[0])]  # fmt: skip
    head = (say("parameter"), say("value"), say("unit"))
    blocks: list[Block] = [Heading(2, say("h_motion")), Paragraph(say("values")), Table((head, *rows))]
    blocks += [
        Paragraph((*say("start"), *plain(":"))),
        Table(((plain(""), say("value"), say("unit")), *start)),
    ]
    if run.status == "failed":
        blocks.append(Paragraph(say("stopped", f"{run.times[-1]:.6g} s", run.message)))
    else:
        blocks.append(Paragraph(say("simulated", f"{run.times[-1]:.6g} s")))
    figure, pdf = plot(run), io.BytesIO()
    with styled():
        figure.savefig(pdf, format="pdf", metadata={"CreationDate": None})
    blocks.append(Picture(PLOT, svg(figure).encode(), pdf.getvalue()))
    if run.estimated is not None:
        blocks.append(Paragraph(say("error", f"{run.estimated:.1e}")))
    return replace(found, blocks=(*found.blocks, *blocks))
