"""The result of a simulation for Python users: columns and expressions, plots, animations and files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from lagc.base.records import replace
from lagc.diagnostics.faults import Refused
from lagc.simulation.solution import Solution

if TYPE_CHECKING:
    from lagc.compiler.loaded import Loaded
    from lagc.compiler.probed import Probe
    from lagc.reports.animation.page import Animation
    from lagc.reports.animation.scene import Scene
    from lagc.reports.animation.shown import Source
    from lagc.simulation.request import Request
    from lagc.simulation.solution import Array


class Run(Solution):
    """The result of a simulation, with plots, animations and files.

    `loaded` and `request` are the code and the request of the run; None for one that was made by hand."""

    loaded: Loaded | None = None
    request: Request | None = None

    def __getitem__(self, name: str) -> Array:
        """Return the values of a column, (points,), or of any expression of the model, such as
        `norm(velocity(bob))`; of a vector (points, 3).  Raises KeyError."""
        if not isinstance(name, str) or name in self.units or self.loaded is None:
            return super().__getitem__(name)
        try:
            return self.evaluate(name)
        except Refused as refused:
            if name.isidentifier() or name.startswith("d("):
                return super().__getitem__(name)  # raises KeyError with similar names
            fault = refused.faults[0]
            raise KeyError(fault.message + (f"; {fault.remedy}" if fault.remedy else "")) from None

    def evaluate(self, expression: str) -> Array:
        """Return the values of an expression of the model at the recorded points, (points,), of a vector
        (points, 3), in SI units. The run is not repeated. Raises Refused if the expression is wrong."""
        return self._probes([expression])[0].values

    def unit(self, expression: str) -> str:
        """Return the SI unit of a column or an expression; "" for a number.  Raises Refused."""
        return self.units[expression] if expression in self else self._probes([expression])[0].unit

    def position(self, name: str) -> Array:
        """Return the positions of a body or point at the recorded points, (points, 3), in m.  Raises
        Refused."""
        return self.evaluate(f"position({name})")

    def add_columns(self, *expressions: str) -> None:
        """Add the values of expressions to the columns of this run, which plots and files contain; those of a
        vector as `expression[1]` and so on.  Raises Refused."""
        for probe in self._probes(expressions):
            n, flat = len(self), probe.values.reshape(len(self), -1)
            names = (
                [probe.text]
                if probe.values.ndim == 1
                else [f"{probe.text}[{k + 1}]" for k in range(flat.shape[1])]
            )
            self.expressions.update((name, (probe.unit, x.tolist())) for name, x in zip(names, flat.T) if n)

    def _probes(self, expressions: Sequence[str]) -> list[Probe]:
        if not expressions:
            return []
        if self.loaded is None:
            raise ValueError("this run has no model to evaluate expressions with")
        from lagc.compiler.probed import probe

        return probe(self.loaded, self, expressions)

    def plot(self, *names: str, path: str | None = None) -> object:
        """Draw the named columns over time and return the matplotlib figure.

        Without names, draw the coordinates.  `path` is the file to write (.png, .svg, .pdf).  Raises
        ImportError if matplotlib is not installed, KeyError for an unknown name."""
        from lagc.reports.plots.plot import plot

        return plot(self, names=names, path=path)

    def animate(
        self, path: str | None = None, *, overlay: Sequence[Run] | Mapping[str, Run] = (), forces: bool = True
    ) -> Animation | str:
        """Show the motion: a page with bodies, links, springs, surfaces, forces and plots, inferred from the
        model.

        path: the file to write, .html, or .gif and .mp4 with matplotlib; it is returned.  Without it an
            object is returned that notebooks show, with a method `save(path)`.
        overlay: other runs of the model, which are drawn as ghosts; a mapping gives their labels.
        forces: whether loads and reactions are drawn as arrows.

        Raises ValueError for another ending or a run without points, ImportError if a film needs a package
        that is missing, OSError."""
        from lagc.reports.animation.page import page, page_data
        from lagc.reports.animation.shown import show

        ending = ".html" if path is None else check_animation(path)
        others = overlay.items() if isinstance(overlay, Mapping) else ((_label(self, r), r) for r in overlay)
        shown = show(self._source(""), [run._source(label) for label, run in others], forces)
        if path is not None and ending != ".html":
            from lagc.reports.animation.film import film

            film(shown, path)
            return path
        made = page(page_data(shown))
        if path is None:
            return made
        made.save(path)
        return path

    def scene(self) -> Scene:
        """Return the scene that is inferred from the model: places, bodies, links, surfaces and springs;
        `as_data()` gives it as plain data, for one's own drawing."""
        from lagc.reports.animation.scene import infer

        source = self._source("")
        return infer(source.model, source.run)

    def _source(self, label: str) -> Source:
        from lagc.compiler.probed import probe
        from lagc.reports.animation.shown import Source

        loaded, request = self.loaded, self.request
        if loaded is None or request is None:
            raise ValueError("this run has no model that could be drawn")

        def simulate_again(points: int) -> Solution:
            denser = replace(request, points=points, every=None, sensitivity=())
            return loaded.simulate(denser, self.parameters)

        def evaluate(texts: Sequence[str], times: Array, states: Array) -> list[Array]:
            return [found.values for found in probe(loaded, self, texts, times.tolist(), states.tolist())]

        return Source(self, loaded.compilation.model, label, simulate_again, evaluate)

    def save(self, path: str, units: bool = False) -> None:
        """Write the recorded times and columns to a file; the ending gives the format: .csv, .npz or
        .parquet.

        `units` adds the units to the header of a CSV file, as in `theta [rad]`.  Units and all metadata are
        always saved: in the archive, or in the file `PATH.json` beside a CSV file.  Raises
        `lagc.simulation.formats.CannotSave` if the ending is unknown, a package is missing or the file
        cannot be written."""
        from lagc.simulation.formats import save

        save(self, path, units)

    def _repr_html_(self) -> str:
        from lagc.reports.plots.plot import solution_html

        return solution_html(self)


def check_animation(path: str) -> str:
    """Return the ending of the file of an animation.  Raises ValueError if it is none, ImportError if a film
    needs a package that is missing."""
    ending = os.path.splitext(path)[1].lower()
    if ending in (".gif", ".mp4"):
        from lagc.reports.animation.film import check_film

        check_film(path)
    elif ending != ".html":
        raise ValueError(f"`{path}` cannot be drawn: the ending gives the format, one of .html .gif .mp4")
    return ending


def _label(leader: Run, other: Run) -> str:
    """Return the parameters, initial values or the scene in which a run differs from the leading one."""
    here, there = leader.system.interface, other.system.interface
    if here.scene != there.scene:
        return there.scene
    names = [f.name for f in (*there.parameters, *there.inputs)]
    known = dict(zip([f.name for f in (*here.parameters, *here.inputs)], leader.parameters))
    changed = [f"{n} = {v:g}" for n, v in zip(names, other.parameters) if known.get(n) != v]
    if leader.states and other.states and not changed:
        pairs = zip(there.state_names, leader.states[0], other.states[0])
        changed = [f"{n} = {b:g}" for n, a, b in pairs if a != b]
    return ", ".join(changed[:3]) or "another run"
