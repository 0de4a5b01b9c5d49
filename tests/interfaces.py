"""Interfaces of programs and systems that are written by hand."""

import math
from typing import Any

from lagc.lowering.interface import kinds
from lagc.lowering.program import Field, Interface


def field(name: str, value: float | None = 1.0, unit: str = "", **more: Any) -> Field:
    """A parameter, an input or an output without bounds."""
    plain: dict[str, Any] = {
        "minimum": -math.inf, "maximum": math.inf, "unit": unit, "display_unit": unit, "place": "m.lag:1",
        "description": "",
    }  # fmt: skip
    return Field(name=name, value=value, **{**plain, **more})


def interface(model: str = "m", nq: int = 1, nv: int = 1, nc: int = 0, **more: Any) -> Interface:
    """Of these sizes, with names q0, v0, row0 and so on and no units, unless `more` says otherwise."""
    plain: dict[str, Any] = {
        "scene": "", "source_name": f"{model.lower()}.lag", "model_hash": "0", "nz": 0, "nh": 0,
        "q_names": tuple(f"q{i}" for i in range(nq)), "v_names": tuple(f"v{i}" for i in range(nv)),
        "q_units": ("",) * nq, "v_units": ("",) * nv,
        "row_labels": tuple(f"row{i}" for i in range(nc)), "row_units": ("",) * nc,
        "quaternions": (), "parameters": (), "inputs": (), "outputs": (),
        "rate_names": (), "rate_units": (), "massless": (), "start_levels": (0,) * (nq + nv), 
        "start_places": ("m.lag:1",) * (nq + nv),
        "row_places": ("m.lag:2",) * nc, "initial_places": (), "condition_ends": (), "condition_columns": (),
        "solve": "straight", "work_size": 0, "health": 2,
        "operations": 1, "written": 1, "functions": ("system",), "effects": (), "simulate": {}, "notes": (),
        "warnings": (), "dropped": (),
    }  # fmt: skip
    given = {**plain, **more}
    given.setdefault("kinds", kinds(given["q_units"], given["v_units"]))
    return Interface(model=model, nq=nq, nv=nv, nc=nc, **given)
