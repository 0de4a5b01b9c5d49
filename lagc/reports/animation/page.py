"""The page of an animation: one file without network access.

No text of a model is markup: all of it is JSON, which the script shows as text nodes. The policy of the page
allows its two blocks by their hashes, and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from importlib.resources import files
from math import isfinite
from typing import Any

from lagc.base.records import dataclass
from lagc.base.text import one_line
from lagc.host.atomic_write import Files
from lagc.reports.animation.arrays import values
from lagc.reports.animation.channels import Channels
from lagc.reports.animation.frames import Frames
from lagc.reports.animation.panels import panels
from lagc.reports.animation.shown import Shown
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
    return None if axis is None else channels.add_all(values(axis, frames.given, len(frames.t)))


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
