"""Other forms of the equations of motion say the same as the derived ones, at random states. The matrices
that people get for their own algebra."""

import math

import pytest
import sympy

import lagc
from lagc.cli.main import main
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.identities.samples import Chance, samples
from lagc.reports.equations.forms import FORMS, NoForm
from lagc.reports.equations.page import page
from lagc.reports.equations.write import write
from lagc.symbolic.derivative import gradient, tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate
from tests.derivation.values import value
from tests.reports.models import derived

CLOSE = 1e-11  # of the largest term
FREE = ["course/simple_pendulum", "classic/double_pendulum", "classic/heavy_top", "classic/elastic_pendulum",
        "course/moving_slide_implicit", "classic/spinning_hoop"]  # fmt: skip
MODELS = [*FREE, "course/moving_slide_explicit", "course/wheel_rolling_explicit", "classic/rolling_disc"]
State = dict[Node, float]


def state_of(equations: EquationsOfMotion) -> State:
    chance = Chance(99)
    (state,) = samples(equations.model, 1)
    state.update((x, chance.draw()) for x in (*equations.v, *equations.a, *equations.lam))
    state[equations.graph.symbol("number", "pi")] = math.pi
    return state


def lines(equations: EquationsOfMotion, form: str, at: State) -> dict[str, tuple[float, float]]:
    """Both sides of each line by its label; names that are defined get their values in `at`."""
    found = {}
    for kind, group in page(equations, motion=FORMS[form]).by_kind():
        for line in group:
            right = value(line.right, at)
            (term,) = line.left.terms[:1] or (None,)
            if kind in ("entry", "momentum", "shared"):
                at[term.factors[0][0].node] = right  # type: ignore[union-attr]
            elif kind == "motion":
                found[line.label] = (value(line.left, at) if form != "hamilton" else math.nan, right)
    return found


def residuals(equations: EquationsOfMotion, at: State) -> list[float]:
    found = []
    for i, row in enumerate(equations.mass_rows(range(len(equations.v)))):
        terms = [m * equations.a[j] for j, m in row.items()]
        terms += [equations.bias_forces[i], -equations.given_forces[i], -equations.constraint_forces[i]]
        found.append(equations.graph.sum(terms))
    return evaluate(found, at)


@pytest.mark.parametrize("name", MODELS)
def test_undivided_equations_are_those_derived(name: str) -> None:
    equations = derived(name)
    at = state_of(equations)
    shown = [left for left, _ in lines(equations, "undivided", at).values()]
    for a, b in zip(shown, residuals(equations, at)):
        assert abs(a - b) < CLOSE * max(1.0, abs(b))


@pytest.mark.parametrize("name", MODELS)
def test_solved_accelerations_satisfy_the_equations(name: str) -> None:
    equations = derived(name)
    at = state_of(equations)
    found = lines(equations, "solved", at)
    moved = {**at, **dict(zip(equations.a, [right for _, right in found.values()]))}
    size = max(map(abs, residuals(equations, {**at, **dict.fromkeys(equations.a, 0.0)})))
    assert max(map(abs, residuals(equations, moved))) < CLOSE * max(1.0, size)


@pytest.mark.parametrize("name", MODELS)
def test_entries_of_matrices_are_those_derived(name: str) -> None:
    equations = derived(name)
    at = state_of(equations)
    lines(equations, "matrix", at)
    entries = {x.record.owner.rstrip("_"): v for x, v in at.items() if x.record.kind == "letter"}
    every = [(f"M_{i + 1}_{j + 1}", m) for (i, j), m in equations.mass_matrix.items()]
    every += [(f"h_{i}", x) for i, x in enumerate(equations.bias_forces, 1)]
    every += [(f"Q_{i}", x) for i, x in enumerate(equations.given_forces, 1)]
    every += [
        (f"G_{k}_{j + 1}", x) for k, row in enumerate(equations.rows, 1) for j, x in row.jacobian.items()
    ]
    for (entry, _), true in zip(every, evaluate([node for _, node in every], at)):
        assert abs(entries.get(entry, 0.0) - true) < CLOSE * max(1.0, abs(true)), entry


@pytest.mark.parametrize("name", FREE)
def test_hamiltons_equations_are_those_of_lagrange(name: str) -> None:
    """q' is the rate, and p' the derivative of the momentum along the motion of the solved equations."""
    equations, graph = derived(name), derived(name).graph
    at = state_of(equations)
    found = lines(equations, "hamilton", at)
    accelerations = [right for _, right in lines(equations, "solved", dict(at)).values()]
    at.update(zip(equations.a, accelerations))
    slopes = gradient(graph, {equations.kinetic: graph.one}, list(equations.v))
    momenta = [slopes.get(v, graph.zero) for v in equations.v]
    flow = {
        **dict(zip(equations.q, equations.v)),
        **dict(zip(equations.v, equations.a)),
        equations.time: graph.one,
    }
    true = [*evaluate(list(equations.v), at), *evaluate(tangent(graph, momenta, flow), at)]
    shown = [right for _, right in found.values()]
    assert len(shown) == len(true)
    for a, b in zip(shown, true):
        assert abs(a - b) < CLOSE * max(1.0, *map(abs, true))
    (energy,) = evaluate([equations.energy], at)
    (h,) = [v for x, v in at.items() if x.record.kind == "letter" and x.record.owner == "H"]
    assert abs(h - energy) < CLOSE * max(1.0, abs(energy))


def test_a_model_without_a_hamiltonian_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(NoForm, match="`slide` is explicit"):
        write(derived("course/moving_slide_explicit"), form="hamilton")
    assert main(["equations", "wheel_explicit", "--form", "hamilton"]) == 2
    assert "`drive` has no potential" in capsys.readouterr().err


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("format", ["text", "latex", "sympy"])
def test_each_form_has_each_format(form: str, format: str) -> None:
    text = write(derived("course/simple_pendulum"), format, form=form)
    assert text
    if format == "sympy":
        pytest.importorskip("sympy")
        names: dict[str, object] = {}
        exec(compile(text, "script", "exec"), names)
        assert isinstance(names["equations"], list)


def test_the_simple_pendulum() -> None:
    """m l^2 theta'' = -m g l sin(theta)."""
    found = lagc.load("simple_pendulum").compile().matrices()
    m, length, g, theta = (sympy.Symbol(name, real=True) for name in ("m", "l", "field.g", "theta"))
    assert found.mass_matrix == sympy.Matrix([[m * length**2]])
    assert found.given_forces - found.bias_forces == sympy.Matrix([-m * g * length * sympy.sin(theta)])
    assert found.constraint_jacobian.shape == (0, 1)


def test_shapes_of_a_constrained_system() -> None:
    found = lagc.load("string_pendulum").compile().matrices()
    assert found.mass_matrix == sympy.Symbol("m", real=True) * sympy.eye(2)
    assert found.constraint_jacobian.shape == (1, 2) and found.gamma.shape == (1, 1)
    assert found.qdot == found.v
