"""Linear models are the same whether derivatives are made entry by entry or along directions."""

import numpy as np
import pytest

import lagc
from lagc.lowering import jacobians

ROUNDING = 1e-12  # of the largest entry: a few hundred roundings
AT = {
    "classic/chaplygin_sleigh_speeds": 0.3, "classic/four_bar": 0.3, "classic/sphere_on_turntable": 0.3,
    "course/string_pendulum": 0.0, "classic/moving_rail": 0.0, "classic/wheelset": 0.0,
    "drag": 0.0,
}  # fmt: skip


DRAG = """
model Drag "a double pendulum that sets out from rest in a wind, in air whose drag has no slope there"
  parameter Length l = 0.2 [m];
  input Force u = 0;
  coordinate Angle a(start = 0.3), b(start = -0.2);
  body p = Particle(mass = 1 [kg], at = l*{sin(a), 0, -cos(a)});
  body q = Particle(mass = 1 [kg], at = l*{sin(a) + sin(b), 0, -cos(a) - cos(b)});
  force drag = -0.3 [kg/m]*norm(velocity(p))*velocity(p) at p;
  force wind = {u, 0, 0} at q;
  Gravity field(g = 9.81 [m/s2], direction = {0, 0, -1});
  output Force f = 0.3 [kg/m]*norm(velocity(p))*velocity(p).x + u;
end Drag;
"""


@pytest.mark.sample(1)
@pytest.mark.usefixtures("no_cache")
@pytest.mark.parametrize("name, t", AT.items())
def test_both_ways_agree(name: str, t: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is rounding is 0 in both."""
    file = lagc.loads(DRAG) if name == "drag" else lagc.load(name)
    one = file.compile(backend="numpy").linearize(t)
    monkeypatch.setattr(jacobians, "MOST", 0)
    two = file.compile(backend="numpy").linearize(t)
    assert one.system.interface.derivatives and not two.system.interface.derivatives
    assert (one.states, one.idle, one.stability, one.free) == (two.states, two.idle, two.stability, two.free)
    for ours, theirs in ((one.A, two.A), (one.B, two.B), (one.C, two.C), (one.D, two.D)):
        assert np.abs(ours - theirs).max(initial=0.0) <= ROUNDING * np.abs(ours).max(initial=0.0)
        assert ((ours == 0.0) == (theirs == 0.0)).all()
