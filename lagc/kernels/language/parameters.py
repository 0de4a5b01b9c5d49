"""What is prepared of the parameters: computed once, not at every call."""

from __future__ import annotations

from lagc.kernels.language.model import fn_bind
from lagc.kernels.language.sizes import NP, NPREPARED, NREAD
from lagc.kernels.language.tables import sources
from lagc.kernels.language.words import Params, public, vector


@public
def bind(p: Params) -> None:
    """Prepare what depends on parameters alone: once they are set, and whenever one was changed, before the
    next call.  Inputs may change at any time."""
    made = vector(NPREPARED)
    fn_bind(p, made)
    for k in range(NPREPARED):
        p[NP + k] = made[k]


def is_bound(p: Params) -> bool:
    """Whether no parameter was changed since."""
    for k in range(NREAD):
        if not p[sources[k]] == p[NP + NPREPARED - NREAD + k]:
            return False
    return True
