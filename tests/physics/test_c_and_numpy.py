"""C and NumPy compute the same bits: every model of the library with most of its effects, 400
steps of each backend."""

import pytest

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
