"""The array functions of the playground are those of NumPy."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.web.arrays import TABLE, evaluated
from tests.web.films import film

FILMS = ("double_pendulum", "four_bar", "bouncing_ball", "heavy_top_quaternion", "gyroscope_in_gimbals")
ROOT = Path(__file__).resolve().parents[2]
FUNCTIONS = ROOT / "tools" / "playground"  # with a folder `numpy`


def without_numpy(*arguments: str) -> str:
    """Return what Python prints where the array functions take the place of NumPy."""
    path = os.pathsep.join((str(FUNCTIONS), str(ROOT)))
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": path})  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    answer = json.loads(without_numpy(str(Path(__file__).parent / "arrays.py")))
    assert str(FUNCTIONS) in answer["file"]
    return answer["found"]


def differences(ours: Any, theirs: Any, relative: float, place: str = "") -> list[str]:
    """Return the places at which plain data differ, numbers by more than rounding."""
    if isinstance(ours, list) and isinstance(theirs, list) and len(ours) == len(theirs):
        pairs = [(f"{place}[{k}]", a, b) for k, (a, b) in enumerate(zip(ours, theirs))]
    elif isinstance(ours, dict) and isinstance(theirs, dict) and ours.keys() == theirs.keys():
        pairs = [(f"{place}.{k}", ours[k], theirs[k]) for k in ours]
    elif isinstance(ours, int | float) and isinstance(theirs, int | float):
        same = ours == theirs or (ours != ours and theirs != theirs)
        return [] if same or math.isclose(ours, theirs, rel_tol=relative, abs_tol=relative) else [
            f"{place}: {ours!r} {theirs!r}"]  # fmt: skip
    else:
        return [] if ours == theirs else [f"{place}: {ours!r:.80} {theirs!r:.80}"]
    return [text for at, a, b in pairs for text in differences(a, b, relative, at)]


@pytest.mark.parametrize("name", [*TABLE, "assigned"])
def test_results_are_those_of_numpy(name: str, found: dict[str, Any]) -> None:
    """Up to the rounding of sums in another order."""
    assert not differences(found[name], evaluated()[name], 1e-11)


@pytest.mark.full
@pytest.mark.parametrize("name", FILMS)
def test_films_are_those_with_numpy(name: str) -> None:
    """The states are the same bits; a length of the scene of 1e-9 is not seen."""
    ours = json.loads(without_numpy(str(Path(__file__).parent / "films.py"), name))[name]
    theirs = film(name)
    assert ours[0] == theirs[0]
    assert not differences(ours, theirs, 1e-9)
