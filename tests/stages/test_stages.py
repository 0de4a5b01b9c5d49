"""Every stage keeps its promises, for every scene of every model of the library."""

from __future__ import annotations

from pathlib import Path

import pytest

from lagc.diagnostics.faults import Source
from lagc.frontend.parse import parse
from lagc.meaning.resolve import resolve
from lagc.meaning.variants import Variant, variants
from lagc.mechanics.derive import derive
from lagc.optimize.optimize import optimize

MODELS = Path(__file__).resolve().parents[2] / "models"
FILES = sorted(MODELS.rglob("*.lag"))


def every_variant() -> list[tuple[Path, Variant]]:
    return [(path, v) for path in FILES for v in variants(parse(Source(path.name, path.read_text())))]


def name(value: object) -> str:
    if isinstance(value, Path):
        return value.stem
    assert isinstance(value, Variant)
    return "-".join(filter(None, [value.scene, *value.with_effects]))


@pytest.mark.parametrize("path, variant", every_variant(), ids=name)
def test_stages(path: Path, variant: Variant) -> None:
    model = resolve(parse(Source(path.name, path.read_text())), variant.scene, variant.with_effects,
                    variant.without_effects, variant.model)  # fmt: skip
    model.verify()
    equations = derive(model)
    equations.verify()
    for work in (False, True):
        program = optimize(equations, work)
        program.verify()
        assert program.interface.nv == len(program.interface.v_names) > 0


def test_the_library_is_there() -> None:
    assert len(FILES) >= 40
