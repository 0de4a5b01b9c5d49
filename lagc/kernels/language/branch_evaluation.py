"""The branches that equations are evaluated on."""

from __future__ import annotations

from lagc.kernels.language.model import fn_modes
from lagc.kernels.language.records import Work
from lagc.kernels.language.sizes import NX
from lagc.kernels.language.words import Params, Real, Vec, public


def update_modes(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """That of the state alone, where no step holds another."""
    if not w.modes_fixed:
        fn_modes(p, t, x, w.modes)


@public
def hold(p: Params, t: Real, x: Vec[NX], w: Work) -> None:
    """From here on the equations are evaluated with *w on the branch of (t, x), until it is used to
    integrate or filled with zeros."""
    fn_modes(p, t, x, w.modes)
    w.modes_fixed = True
