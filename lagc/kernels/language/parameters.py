"""Numbers computed from the parameters alone, once and not at every evaluation."""

from lagc.kernels.language.model_functions import fn_bind
from lagc.kernels.language.model_tables import *
from lagc.kernels.language.sizes import NP, NPREPARED, NREAD
from lagc.kernels.language.words import Params, public, vector


@public
def bind(p: Params) -> None:
    """Compute the prepared numbers.  Call it after the parameters are set, and again after each change of a
    parameter; a change of an input needs no call."""
    made = vector(NPREPARED)
    fn_bind(p, made)
    for k in range(NPREPARED):
        p[NP + k] = made[k]


def is_bound(p: Params) -> bool:
    """Return whether no parameter changed since the last call of `bind`."""
    for k in range(NREAD):
        if not p[sources[k]] == p[NP + NPREPARED - NREAD + k]:
            return False
    return True
