"""Twelve digits of a whole motion, asked for at once, where doubles have them: against closed forms in 40
digits, from the very doubles where the motions begin.  A ball's orientation errs by 1e-12 at the finest
tolerance."""

from collections.abc import Callable

import mpmath as mp
import pytest

import lagc
from lagc.api import Run

pytestmark = pytest.mark.usefixtures("no_cache")
Motion = Callable[[float], dict[str, mp.mpf]]


def kepler(run: Run) -> Motion:
    """From the pericentre, by Kepler's equation."""
    x, speed = mp.mpf(run["x"][0]), mp.mpf(run["der(y)"][0])
    a = 1 / (2 / x - speed**2)
    e, n = 1 - x / a, a ** mp.mpf(-1.5)

    def motion(t: float) -> dict[str, mp.mpf]:
        u = mp.findroot(lambda u: u - e * mp.sin(u) - n * t, n * t + e * mp.sin(n * t))
        rate = n / (1 - e * mp.cos(u))
        return {
            "x": a * (mp.cos(u) - e), "y": a * mp.sqrt(1 - e**2) * mp.sin(u),
            "der(x)": -a * mp.sin(u) * rate, "der(y)": a * mp.sqrt(1 - e**2) * mp.cos(u) * rate,
        }  # fmt: skip

    return motion


def turntable(run: Run) -> Motion:
    """The centre's velocity turns with 2/7 of the table's."""
    x, y, u, v = (mp.mpf(run[name][0]) for name in ("x", "y", "der(x)", "der(y)"))
    w = mp.mpf(2) / 7 * 3

    def motion(t: float) -> dict[str, mp.mpf]:
        c, s = mp.cos(w * t), mp.sin(w * t)
        return {
            "x": x + (u * s + v * (c - 1)) / w, "y": y + (u * (1 - c) + v * s) / w,
            "der(x)": u * c - v * s, "der(y)": u * s + v * c,
        }  # fmt: skip

    return motion


@pytest.mark.sample(1)
@pytest.mark.parametrize("backend", ["numpy", "c"])
@pytest.mark.parametrize(
    ("name", "closed", "parameters", "accuracy"),
    [("classic/kepler", kepler, {"e": 0.4}, 1e-12), ("classic/sphere_on_turntable", turntable, {}, 3e-12)],
)
def test_twelve_digits_are_had_at_once(
    name: str, closed: Callable[[Run], Motion], parameters: dict[str, float], accuracy: float, backend: str
) -> None:
    model = lagc.load(name).compile(backend=backend)
    run = model.simulate(accuracy=accuracy, points=101, parameters=parameters)
    assert run.status == "ok", run.message
    assert run.estimated is not None and run.estimated <= accuracy
    with mp.workdps(40):
        motion = closed(run)
        exact = [motion(t) for t in run.t]
        for kind in (("x", "y"), ("der(x)", "der(y)")):
            size = max(abs(at[which]) for at in exact for which in kind)
            error = max(abs(run[which][k] - at[which]) for k, at in enumerate(exact) for which in kind)
            assert error <= run.estimated * size
