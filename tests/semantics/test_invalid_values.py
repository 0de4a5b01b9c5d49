"""Values that no quantity of a kind has: a fraction for an Integer, an impossible inertia, `time` twice."""

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused

BODY = "coordinate Length x(rate = 1);\n  body b = Particle(mass = 1, at = {x, 0, 0});"


def codes(text: str) -> list[str]:
    return [f.code for f in lagc.loads(f"model M\n  {text}\nend M;").check() if f.severity == "error"]


@pytest.mark.parametrize(
    "declared",
    ["output Length time = 2*x;", "parameter Time time = 1 [s];", "discrete Real time(start = 0);"],
)
def test_a_quantity_is_not_called_time(declared: str) -> None:
    """It would be a second column of that name in results."""
    assert codes(f"{BODY}\n  {declared}") == ["LAG0202"]
    assert codes(f"{BODY}\n  {declared.replace(' time', ' time2', 1)}") == []


@pytest.mark.parametrize(
    "declared",
    ["parameter Integer n = 1.5;", "discrete Integer k(start = 0.5);", "structural Integer n = 1.5;"],
)
def test_an_integer_is_whole(declared: str) -> None:
    assert codes(f"{BODY}\n  {declared}") == ["LAG0208"]
    assert codes(f"{BODY}\n  {declared.replace('.5', '')}") == []


@pytest.mark.parametrize("backend", ["numpy"])
def test_an_integer_that_is_given_is_whole(backend: str) -> None:
    text = f"model M\n  parameter Integer n = 2;\n  {BODY}\n  force f = n*1 [N]*world.x at b;\nend M;"
    model = lagc.loads(text).compile(backend=backend)
    with pytest.raises(Refused, match="Integer"):
        model.simulate(1, parameters={"n": 2.7})
    assert model.simulate(1, parameters={"n": 3.0}).final["x"] == pytest.approx(1 + 3 / 2, abs=1e-5)


def solid(matrix: str) -> list[str]:
    return codes(f"body b = Solid(mass = 1, inertia = {matrix}, com = {{0, 0, 1}});\n"
                 "  joint j = Spherical(world, b, at = {0, 0, 0});")  # fmt: skip


def test_a_matrix_of_inertia_belongs_to_a_body() -> None:
    """Random bodies of points have such matrices; one whose moments are changed has none."""
    assert solid("{{2, 1.9, 0}, {1.9, 2, 0}, {0, 0, 0.5}}") == ["LAG0308"]
    assert solid("{{1, 0.5, 0}, {0.5, 1, 0}, {0, 0, 1.5}}") == []
    chance = np.random.default_rng(1)
    for _ in range(20):
        points = chance.normal(size=(chance.integers(2, 6), 3))
        real = sum(np.dot(r, r) * np.eye(3) - np.outer(r, r) for r in points)
        values, axes = np.linalg.eigh(real)
        wrong = axes @ np.diag([values[0], values[1], 1.01 * (values[0] + values[1])]) @ axes.T
        for matrix, expected in ((real, []), (0.5 * (wrong + wrong.T), ["LAG0308"])):
            rows = ", ".join("{" + ", ".join(f"{a!r}" for a in row.tolist()) + "}" for row in matrix)
            assert solid("{" + rows + "}") == expected
