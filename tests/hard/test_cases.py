"""The cases of `lagc hard`: each keeps its figures, and misses them without the mechanism that it guards.

Sources, figures and why a figure follows from the method stand in the cases themselves.  Long runs are
shorter here.
"""

from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from types import CodeType
from typing import Any

import pytest

import lagc
from lagc.host.model_library import references_folder
from lagc.kernels.events.location import NO_EVENT
from lagc.kernels.language.statuses import OK, SINGULAR_MASS
from lagc.simulation.backends import python
from lagc.simulation.backends.compile import compiler
from lagc.study.hard.case import Lab, Row, measured
from lagc.study.hard.cases import CASES, HARD

OWN = {
    case.name: case for case in CASES if case.name not in HARD
}  # the others: tests/physics/test_closed_forms
MISSED = {"tip_angles": [0], "kepler": [2]}  # figures that lagc does not keep, by case
LONG = {"stiff_spring", "chaos", "kepler", "chain"}


def short(full: float) -> float:
    return full / 4.0


class Short(Lab):
    """A lab whose long runs are short."""

    def __init__(self, backend: str = "numpy"):
        super().__init__(lagc.load, backend, part=0.002)

    def long(self, full: float, python: float, what: str) -> tuple[float, float]:
        return super().long(full, short(python), what)


def missed(row: Row) -> list[int]:
    assert row.found is not None, row.failure
    pairs = zip(row.found.values, row.case.figures, strict=True)
    return [k for k, (value, figure) in enumerate(pairs) if value is not None and not value <= figure.most]


@pytest.mark.full
@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("backend", ["numpy", "c"])
def test_case(name: str, backend: str) -> None:
    if backend == "c" and compiler() is None:
        pytest.skip("no C compiler")
    row = measured(OWN[name], Short(backend))
    found = [k for k in missed(row) if row.case.figures[k].words != "an evaluation in C [us]"]
    assert found == MISSED.get(name, [])
    assert row.meets_figures == (missed(row) == [])


@pytest.mark.parametrize("name", ["contradiction", "massless", "speed", "relay", "drive", "tip_angles"])
def test_quick_case(name: str) -> None:
    assert missed(measured(OWN[name], Short())) == MISSED.get(name, [])


def test_every_file_of_references_is_a_case() -> None:
    files = {path.stem for path in Path(references_folder()).glob("*.json")}
    assert files - {case.name for case in CASES} == {
        "andrews_squeezer",
        "rolling_disc",
    }  # a case; accelerations in test_closed_forms
    assert len({case.name for case in CASES}) == len(CASES)


def _no_projection(module: dict[str, Any]) -> None:
    module["project"] = lambda p, t, x, sizes, w: OK


def _no_refinement(module: dict[str, Any]) -> None:
    module["REFINED_RESIDUAL"] = inf


def _no_rank(module: dict[str, Any]) -> None:
    """Only the elimination with all rows is left."""
    module["rhs_any_rank"] = lambda p, t, x, xdot, lam, w: SINGULAR_MASS


def _no_events(module: dict[str, Any]) -> None:
    """Steps do not end at events."""
    module["first_crossing"] = lambda p, s, method, a, w: NO_EVENT


def _no_seat(module: dict[str, Any]) -> None:
    """Contacts that touch are not put on gap = 0."""
    module["seat"] = lambda p, t, x, w: OK


def _no_rest(module: dict[str, Any]) -> None:
    """Bounces go on for ever."""
    module["find_rests"] = lambda s, w: False


def _no_law(module: dict[str, Any]) -> None:
    """Contacts that touch stay closed in the modes in which they are listed."""

    def keep(law: Any) -> int:
        law.p[:] = [0.0] * len(law.p)
        return 0

    module["set_law"] = keep


def _no_guard(module: dict[str, Any]) -> None:
    """Forces of contacts that touch are not watched."""
    indicate, enclose = module["indicate_forces"], module["enclose_forces"]
    contacts, relations, free = module["NCON"], module["NMODE"], module["NFREE"]

    def indicated(p: Any, t: float, x: list[float], w: Any) -> None:
        indicate(p, t, x, w)
        for i in range(contacts):
            if x[len(x) - contacts + i] != 0.0:
                w.events.indicators[relations - contacts + i] = 1.0

    def enclosed(s: Any, w: Any) -> None:
        enclose(s, w)
        for i in range(contacts):
            if s.x[len(s.x) - contacts + i] != 0.0:
                j = free - contacts + i
                w.events.enclosures[2 * j : 2 * j + 2] = [1.0, 1.0]

    module.update(indicate_forces=indicated, enclose_forces=enclosed)


def _no_impact(module: dict[str, Any]) -> None:
    """Contacts that approach have no impact."""
    module["impact"] = lambda law, a: 1  # none approaches


def _no_jump(module: dict[str, Any]) -> None:
    """Contacts do not act after new values."""
    module["settle_jump"] = lambda p, s, w: OK


OFF = {
    "projection": (_no_projection, ["pendulum_projected", "speed", "solid_turns"]),
    "refinement": (_no_refinement, ["tip_strings"]),
    "rank": (_no_rank, ["twice", "overconstrained"]),
    "events": (_no_events, ["relay", "walls"]),
    "seat": (_no_seat, ["bouncing_ball"]),
    "rest": (_no_rest, ["bouncing_ball"]),
    "set law": (_no_law, ["incline", "painleve_rod"]),
    "guard": (_no_guard, ["slide_off_sphere", "roll_off_sphere"]),
    "impact": (_no_impact, ["rod_impact", "stacked_balls", "rocking_block"]),
    "jump": (_no_jump, ["conveyor"]),
}
SWITCHED = [(change, name) for change, names in OFF.values() for name in names]


@pytest.mark.sample(2)
@pytest.mark.usefixtures("no_cache")  # runs with the mechanism are remembered there
@pytest.mark.parametrize(("change", "name"), SWITCHED, ids=[f"{c.__name__}-{n}" for c, n in SWITCHED])
def test_a_case_misses_its_figure_without_its_mechanism(
    change: Callable[[dict[str, Any]], None], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A mechanism that is switched off in all generated Python, whichever method it has: the run fails, or a
    figure is missed."""
    executed = python.executed

    def changed(code: Sequence[CodeType]) -> dict[str, Any]:
        module = executed(code)
        change(module)
        return module

    monkeypatch.setattr(python, "executed", changed)
    row = measured(OWN[name], Short())
    assert not row.meets_figures
    assert row.found is None or missed(row)
