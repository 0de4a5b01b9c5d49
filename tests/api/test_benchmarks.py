"""The benchmarks: hand-written equations for other tools are those of the models; a short run."""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.simulation.programs import needs_compiler
from tools.benchmarks.problems import PROBLEMS, Problem, solve

ROOT = Path(__file__).parents[2]


def test_elimination_solves_linear_equations() -> None:
    dice = np.random.default_rng(3)
    matrix = dice.standard_normal((5, 5)) + 4.0 * np.eye(5)
    matrix[3, 1] = matrix[1, 4] = 0.0
    right = dice.standard_normal(5)
    assert solve(matrix.tolist(), right.tolist()) == pytest.approx(np.linalg.solve(matrix, right))


@pytest.mark.sample(2, 6)
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: str(p.name))
def test_the_equations_written_by_hand_are_those_of_the_model(problem: Problem) -> None:
    import lagc

    source = lagc.loads(problem.model) if "\n" in problem.model else lagc.load(problem.model)
    model = source.compile(problem.scene, parameters=problem.parameters, backend="numpy")
    assert (*model.interface.q_names, *model.interface.v_names) == problem.states
    run = model.simulate(
        0.02 if problem.stiff else 0.1 * problem.stop, accuracy=1e-6, points=4, starts=problem.starts
    )
    for x in run.states:
        state = [float(value) for value in x[: len(problem.states)]]
        assert problem.rates(math, state) == pytest.approx(model.rhs(0.0, state), rel=1e-9, abs=1e-9)


@needs_compiler
@pytest.mark.full
def test_a_quick_run_without_other_tools(tmp_path: Path) -> None:
    words = ["--quick", "--tools", "none", "--json", str(tmp_path / "r.json")]
    command = [sys.executable, "-m", "tools.benchmarks", *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "r.json").read_text())
    assert [part["name"] for part in found["problems"]] == ["double_pendulum", "impacts"]
    for part in found["problems"]:
        assert part["reference_agreement"] < 1e-9
        tools = [tool for tool in part["tools"] if tool["note"] != "for stiff problems"]
        assert [tool["tool"] for tool in tools] == ["lagc, C, dop853", "lagc, C, taylor", "lagc, accuracy="]
        for tool in tools:
            errors = [error for _, error, _, _ in tool["points"]]
            assert len(errors) == 3 and errors[-1] < 1e-5 and errors[-1] < errors[0]
            if tool["tool"] == "lagc, accuracy=":
                assert all(error <= tolerance for tolerance, error, _, _ in tool["points"])
    assert "keeps" in done.stdout


def test_the_readme_has_the_markers_and_pictures_of_the_report() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    part = text.partition("<!-- benchmarks -->")[2].partition("<!-- end of benchmarks -->")[0]
    pictures = re.findall(r"\]\((docs/[^)]*)\)", part)
    assert pictures == ["docs/work-precision.svg", "docs/asked-and-got.svg"]
    assert all((ROOT / path).exists() for path in [*pictures, "docs/benchmarks.json"])
