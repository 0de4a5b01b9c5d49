"""The page of an animation: one file without network access.

No text of a model is markup: all of it is JSON, which the script shows as text nodes. The policy of the page
allows its two blocks by their hashes, and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
from collections.abc import Sequence
from importlib.resources import files
from math import isfinite
from typing import Any

import numpy as np

from lagc.base.records import dataclass
from lagc.base.text import one_line
from lagc.host.atomic_write import Files
from lagc.reports.animation.frames import Frames
from lagc.reports.animation.shown import Shown
from lagc.reports.animation.states import Array, values
from lagc.reports.plots.curves import scales
from lagc.reports.plots.plot import by_unit, shown_names
from lagc.simulation.solution import Solution
from lagc.simulation.system import work_of
from lagc.symbolic.vectors import Vector
from lagc.version import __version__

HEIGHT = 620  # px, of the frame in a notebook


def page_data(shown: Shown) -> dict[str, Any]:
    """Return the plain data of a page.  See `docs/reference/animation.md` for its fields."""
    scene, frames, run = shown.scene, shown.frames, shown.run
    model, channels = scene.model, Channels()
    joints: list[dict[str, Any]] = []
    for joint in model.joints:
        place = scene.place_of(joint.name, "joint")
        if place is not None:
            joints.append({"name": joint.name, "kind": joint.kind, "place": place,
                           "axis": _axis(channels, frames, joint.axis)})  # fmt: skip
    # A page carries the channels of the places that it draws; the others are null, so that indices stay.
    used = _used(shown, [joint["place"] for joint in joints])
    data = scene.as_data()
    for figure, record in zip(scene.figures, data["figures"]):
        record["axis"] = _axis(channels, frames, figure.axis)
    data["places"] = [place if i in used else None for i, place in enumerate(data["places"])]
    interface = run.system.interface
    data |= {
        "model": model.name, "scene": model.scene, "about": model.description, "tool": f"lagc {__version__}",
        "effects": list(interface.effects), "status": run.status, "message": run.message,
        "accuracy": run.estimated, "error": frames.error * scene.scale, "joints": joints,
        "events": [{"t": e.t, "name": e.name, "kind": e.kind, "impulse": e.impulse, "loss": e.loss,
                    "at": scene.rows.touching.get(e.contact, [])} for e in run.events],
        "runs": [_run_data(channels, shown, label, other, used) for label, other in shown.all_frames],
        "counts": [len(other.t) for _, other in shown.all_frames],
        "panels": panels(shown, channels),
        "times": [channels.add_times(r.t) for r in shown.runs], "points": [len(r.t) for r in shown.runs],
        "forces": [{"name": f.name, "kind": f.kind, "p": channels.add_all(f.p), "v": channels.add_all(f.v)}
                   for f in shown.arrows],
    }  # fmt: skip
    data["blob"] = channels.text()
    return data


def _axis(channels: Channels, frames: Frames, axis: Vector | None) -> list[list[float]] | None:
    """Return the channels of an axis over the frames."""
    return None if axis is None else channels.add_all(values(axis, frames.symbol_values, len(frames.t)))


def _used(shown: Shown, joints: list[int]) -> set[int]:
    """Return the places that are drawn."""
    scene = shown.scene
    used = {x for link in (*scene.links, *scene.springs) for x in (link.a, link.b)}
    used |= {
        *joints,
        *(f.place for f in scene.figures),
        *scene.hinges,
        *scene.feet,
        *(body.place for body in scene.bodies),
    }
    used |= {i for i, place in enumerate(scene.places) if place.kind == "point"}
    used |= {i for row in scene.surfaces for i in row.places}
    return used | {i for row in scene.rows.touching.values() for i in row}


def _run_data(channels: Channels, shown: Shown, label: str, frames: Frames, used: set[int]) -> dict[str, Any]:
    """Return the channels of a run. Places of other runs are found by their names: those that a run does not
    have are left out."""
    known = {(place.kind, place.name): i for i, place in enumerate(frames.scene.places)}
    pairs = [(i, known.get((shown.scene.places[i].kind, shown.scene.places[i].name))) for i in sorted(used)]
    return {
        "t": channels.add_times(frames.t), "label": label, "end": float(frames.t[-1]),
        "P": {str(i): channels.add_all(frames.p[k]) for i, k in pairs if k is not None},
        "Q": {str(i): channels.add_all(frames.q[k].T) for i, k in pairs if k in frames.q},
    }  # fmt: skip


@dataclass(frozen=True)
class Animation:
    """A page as text; a notebook shows it in a frame of its own."""

    html: str

    def save(self, path: str) -> None:
        """Write the page into the file `path`.  Raises OSError."""
        with Files() as written:
            written.open(path).write(self.html.encode("utf-8", "replace"))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self.html) / 1e3:.0f} kB; `save(path)` writes it>"

    def _repr_html_(self) -> str:
        text = html.escape(self.html)
        style = f"width:100%;height:{HEIGHT}px;border:0"
        return f'<iframe sandbox="allow-scripts allow-downloads" style="{style}" srcdoc="{text}"></iframe>'


def page(data: dict[str, Any]) -> Animation:
    """Return the page with these data.  The same data give the same text."""
    folder = files("lagc.reports.animation") / "page"
    script, style = ((folder / f"animate.min.{kind}").read_text("utf-8") for kind in ("js", "css"))
    text = json.dumps(_finite(data), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    policy = (f"default-src 'none'; script-src {_digest(script)}; style-src {_digest(style)}; "
              "img-src data: blob:; base-uri 'none'; form-action 'none'")  # fmt: skip
    title = html.escape(one_line(f"{data['model']}, {data['scene']}"))
    return Animation(
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{html.escape(policy)}">'
        f'<meta name="viewport" content="width=device-width,initial-scale=1"><title>{title}</title>'
        f"<style>{style}</style></head><body><noscript>This page needs JavaScript.</noscript>"
        f'<script type="application/json" id="data">{text}</script><script>{script}</script></body></html>\n'
    )


def _digest(block: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(block.encode()).digest()).decode()}'"


def _finite(data: Any) -> Any:
    """Return plain data in which numbers that are not finite are None."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not isfinite(data) else data


# -- columns of numbers ----------------------------------------------------------------------------

LEVELS = 65_534
NO_VALUE = 65_535


class Channels:
    """One block of little-endian 16-bit integers. A channel is `[value]` if it is constant, else `[low, high,
    offset]`: its values between low and high, exact to 1/131070 of the range. Equal channels are stored
    once."""

    def __init__(self) -> None:
        self.parts: list[Any] = []
        self.size = 0
        self.offsets: dict[bytes, int] = {}

    def add(self, x: Any) -> list[float]:
        """Store a column and return its channel."""
        x = np.asarray(x, float)
        finite = x[np.isfinite(x)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
        if high - low <= 1e-13 * max(abs(low), abs(high)) and len(finite) == len(x):
            return [low]
        # The last level stands for a value that is not finite.
        share = (x - low) / (high - low or 1.0)
        levels = np.where(np.isfinite(x), np.round(np.nan_to_num(share) * LEVELS), NO_VALUE).astype("<u2")
        key = hashlib.sha256(levels.tobytes()).digest()
        if key not in self.offsets:
            self.offsets[key] = self.size
            self.parts.append(levels)
            self.size += len(levels)
        return [low, high, self.offsets[key]]

    def add_all(self, rows: Any) -> list[list[float]]:
        return [self.add(row) for row in rows]

    def add_times(self, t: Array) -> list[list[float]]:
        """Store times as two channels whose sum they are, exact to 1/131070^2 of the range."""
        first = self.add(t)
        if len(first) == 1:
            return [first]
        return [first, self.add(t - decode(first, self, len(t)))]

    def block(self) -> bytes:
        return b"".join(part.tobytes() for part in self.parts)

    def text(self) -> str:
        return base64.b64encode(self.block()).decode()


def decode(channel: list[float], channels: Channels, n: int) -> Array:
    """Return the n values of a channel, as the page reads them."""
    if len(channel) == 1:
        return np.full(n, channel[0])
    low, high, offset = channel
    words = np.frombuffer(channels.block(), "<u2", n, 2 * int(offset)).astype(float)
    return np.where(words == NO_VALUE, np.nan, low + (high - low) * words / LEVELS)


# -- plots ------------------------------------------------------------------------------------------

MOST_LINES = 8  # of one panel
LEAST_RESIDUAL = 1e-18  # on a logarithmic axis


def panels(shown: Shown, channels: Channels) -> list[dict[str, Any]]:
    """Return the data of all panels; columns of angles are in degrees."""
    run, model, found = shown.run, shown.scene.model, list[dict[str, Any]]()
    described = {x.name: x.description for x in (*model.coordinates, *model.outputs, *model.parameters)}
    units, known = run.units, scales(run)
    # A panel for each unit, then the two errors of the run, folded: energy and constraints.
    for unit, names in by_unit(run, shown_names(run)).items():
        factor = 180.0 / math.pi if "deg" in unit and not unit.startswith("orientation") else 1.0
        columns = [
            {"name": name, "about": described.get(name) or described.get(name.partition("[")[0], ""),
             "unit": units.get(name, ""), "size": factor * known.sizes.get(name, 0.0),
             "flat": known.is_flat(name, _finite_numbers(run.column(name)), units.get(name, "")),
             "y": [channels.add(r[name] * factor) if name in r else None for r in shown.runs]}
            for name in names[:MOST_LINES]
        ]  # fmt: skip
        found.append({"unit": "" if unit.startswith("orientation") else unit, "columns": columns,
                      "more": max(0, len(names) - MOST_LINES)})  # fmt: skip
    error = energy_error(run)
    if error is not None:
        column = {"name": "energy error", "about": "energy - start - work of the loads", "unit": "J",
                  "y": [channels.add(error)]}  # fmt: skip
        found.append({"unit": "J", "title": "energy error", "columns": [column], "more": 0, "folded": True})
    rows = residuals(run)
    if rows:
        columns = [{"name": name, "about": "", "unit": "", "y": [channels.add(y)]}
                   for name, y in rows[:MOST_LINES]]  # fmt: skip
        found.append({"unit": "", "title": "constraint residuals, scaled", "log": True, "columns": columns,
                      "more": max(0, len(rows) - MOST_LINES)})  # fmt: skip
    return found


def _finite_numbers(x: Sequence[float]) -> list[float]:
    return [value for value in x if math.isfinite(value)] or [0.0]


def energy_error(run: Solution) -> Array | None:
    """Return energy - start - work at the recorded points, in J; None if the energy has no value."""
    if not run.times or not math.isfinite(run.energy.start):
        return None
    system = run.system
    balance = np.array([system.energies(t, x)[2] - work_of(system, x) for t, x in zip(run.times, run.states)])
    error: Array = balance - balance[0]
    return error


def residuals(run: Solution) -> list[tuple[str, Array]]:
    """Return the label and the scaled residual, absolute, of each holonomic constraint over the recorded
    points."""
    system = run.system
    if not system.nh or not run.times:
        return []
    points = [*zip(run.times, run.states)]
    y = np.abs(np.array([system.position(t, x) for t, x in points]))
    size = np.array([system.scales(t, x)[: system.nh] for t, x in points])
    y = y / np.where(size > 0.0, size, 1.0)
    return [*zip(system.interface.row_labels, np.maximum(y, LEAST_RESIDUAL).T)]
