"""Motions against published numbers, through the asked global accuracy."""

import pytest

from tests.physics.references import compiled, names, read

CASES = [(name, sample.t) for name in names() for sample in read(name).samples]


@pytest.mark.sample(2, 12)
@pytest.mark.parametrize(("name", "t"), CASES, ids=[f"{n}-{t:g}" for n, t in CASES])
def test_motion_is_the_published_one(name: str, t: float) -> None:
    reference = read(name)
    (sample,) = [s for s in reference.samples if s.t == t]
    if reference.tolerance is None:
        # asked a decade finer than compared: the error estimate is good to a factor of about 2
        run = compiled(name).simulate(t, accuracy=reference.accuracy / 10, points=2, starts=reference.starts)
    else:
        tol = reference.tolerance
        run = compiled(name).simulate(t, method="dop853", rtol=tol, atol=tol, points=2)
    assert run.status == "ok", run.message
    found = run.final
    for quantity, value in sample.values.items():
        error = abs(found[quantity] - value) / reference.scale(quantity)
        assert error <= reference.accuracy, (quantity, found[quantity], value)
