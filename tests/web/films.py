"""What is drawn of models, as JSON: `python films.py MODEL ...`, for `test_arrays.py`."""

import json
import sys
from typing import Any

import lagc
from lagc.reports.animation.shown import show


def film(name: str) -> list[Any]:
    """Return the last state of a run, its scene, places and attitudes at its frames, and forces."""
    run = lagc.load(name).compile(backend="numpy").simulate(points=61)
    shown = show(run._source(""))
    scene, frames = shown.scene.as_data(), shown.frames
    attitudes = {
        place: [[a * b for a in q for b in q] for q in rows.tolist()] for place, rows in frames.q.items()
    }
    arrows = [[arrow.name, arrow.kind, arrow.p.tolist(), arrow.v.tolist()] for arrow in shown.arrows]
    return json.loads(
        json.dumps([run.states[-1], scene, frames.t.tolist(), frames.p.tolist(), attitudes, arrows])
    )


if __name__ == "__main__":
    print(json.dumps({name: film(name) for name in sys.argv[1:]}))
