"""C and NumPy compute the same bits: every model of the library with most of its effects, 400
steps of each backend; and runs of chosen steps, through impacts and other events."""

import pytest

import lagc
from lagc.simulation.backends.compile import compiler
from tests.physics.library import compiled, fullest

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler")

SCENES = fullest()
STEPS = 400


@pytest.mark.sample(1, 12)
@pytest.mark.parametrize(("name", "scene"), SCENES, ids=[f"{n}-{s}" for n, s in SCENES])
def test_backends_agree_bitwise(name: str, scene: str) -> None:
    stop = float(compiled(name, scene, "numpy").interface.simulate.get("stop", 10.0))
    # DOPRI5 with a step of a 1/4000 of the scene: small enough for every model
    asked = {"stop": stop / 10.0, "method": "dopri5", "step": stop / 10.0 / STEPS, "points": 11}
    runs = [compiled(name, scene, backend).simulate(**asked) for backend in ("numpy", "c")]
    first, second = runs
    assert first.status == second.status == "ok", (first.message, second.message)
    assert first.cost.steps == second.cost.steps >= STEPS
    assert first.states == second.states
    for output in first.system.interface.outputs:
        assert first.column(output.name) == second.column(output.name), output.name


ADAPTIVE = [
    ("incline", 1.5, 1e-8), ("block_on_belt", 1.5, 1e-8), ("bowling_ball", 1.5, 1e-8),
    ("tumbling_box", 1.5, 1e-8), ("thrown_across", None, 1e-8), ("billiard", None, 1e-8),
    ("bouncing_ball", 2.0, 1e-7), ("newtons_cradle", 2.0, 1e-6), ("slack_rope", 2.0, 1e-8),
    ("rough_hoop", 0.6, 1e-7), ("rough_pin", 0.6, 1e-7), ("rough_crank", 0.6, 1e-7),
    ("painleve_klein", 0.6, 1e-7), ("block_in_rail", 0.6, 1e-7), ("simple_pendulum", 5.0, 1e-9),
    ("driven_cart_pole", 1.3, 1e-9), ("journal_bearing", 0.9, 1e-9), ("string_breaks", 2.0, 1e-9),
]  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "stop", "rtol"), ADAPTIVE, ids=[name for name, *_ in ADAPTIVE])
def test_runs_of_chosen_steps_agree_bitwise(name: str, stop: float | None, rtol: float) -> None:
    one, other = (
        lagc.load(name).compile(backend=backend).simulate(stop, rtol=rtol, points=9)
        for backend in ("numpy", "c")
    )
    assert one.states == other.states and one.events == other.events and one.cost.rhs == other.cost.rhs
