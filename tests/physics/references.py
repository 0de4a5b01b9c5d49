"""Published problems with published numbers: `tests/references/*.json`.

A file names a model of the library with scene, parameters and starts, and gives samples: values of
coordinates, rates and outputs at a time.  Its `accuracy` is relative to the largest value that a
quantity has among the samples.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import lagc

FOLDER = Path(__file__).parent.parent / "references"


@dataclass(frozen=True)
class Sample:
    t: float
    values: dict[str, float]


@dataclass(frozen=True)
class Reference:
    name: str
    model: str
    scene: str | None
    parameters: dict[str, float]
    starts: dict[str, float]
    accuracy: float
    tolerance: float | None  # of a run by hand; None: the run is asked for its accuracy
    samples: tuple[Sample, ...]
    constants: dict[str, float | list[float]]

    def scale(self, name: str) -> float:
        """The largest size of the quantity `name` among the samples."""
        return max(abs(s.values.get(name, 0.0)) for s in self.samples)


@cache
def read(name: str) -> Reference:
    data = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    samples = tuple(Sample(s["t"], s["values"]) for s in data["samples"])
    return Reference(
        data["name"], data["model"], data.get("scene"), data.get("parameters", {}), data.get("starts", {}),
        data["accuracy"], data.get("tolerance"), samples, data.get("constants", {}),
    )  # fmt: skip


def names() -> list[str]:
    """Of the files that hold samples."""
    return [name for name in sorted(p.stem for p in FOLDER.glob("*.json")) if read(name).samples]


@cache
def compiled(name: str, backend: str = "auto") -> lagc.CompiledModel:
    reference = read(name)
    model = lagc.load(reference.model)
    return model.compile(reference.scene, parameters=reference.parameters, backend=backend)
