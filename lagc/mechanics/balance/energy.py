"""Energies and their balance.

The balance is that of Jacobi's energy E = sum of rate_i dL/d(rate_i) - L = K2 - K0 + V, because it needs no
force of a drive:

    dE/dt = -dL/dt + sum of Q_i rate_i

with dL/dt at fixed coordinates and rates, and Q the forces without a potential, multipliers included (C.
Lanczos, *The Variational Principles of Mechanics*, ch. V). Without drives E = K + V; without dissipation too,
the power is the constant zero. A body's velocity u = (linear in the rates) + d gives K2 - K0 = K - d.p with
its momentum p.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import dataclass
from lagc.mechanics.balance.generalized_forces import Acting
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Law
from lagc.mechanics.formulation.euler_lagrange import FreeTerms
from lagc.mechanics.formulation.mass_matrix import Moving
from lagc.mechanics.formulation.states import States
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.vectors import dot
from lagc.symbolic.walk import depends

WHOLE, BY_DEGREES, BY_MOMENTA = "K + V", "K2 - K0 + V", "p.v - L"


@dataclass(frozen=True, slots=True)
class Energies:
    kinetic: Node
    potential: Node
    energy: Node  # Jacobi's
    balance: str  # how it is written: K + V where it is proved to be that
    power: Node  # d(energy)/dt along the motion; the constant zero where nothing brings any


def energies(
    states: States,
    parts: Sequence[Moving],
    acting: Sequence[Acting],
    free: FreeTerms,
    rows: Sequence[Classified],
) -> Energies:
    """K, V, E and dE/dt of the whole system, in t, q, v (and the multipliers in the power)."""
    graph = states.graph
    momenta = [part.momentum(part.velocity) for part in parts]
    kinetic = graph.sum(0.5 * dot(part.velocity, p) for part, p in zip(parts, momenta))
    drives = graph.sum(dot(part.at_rest, p) for part, p in zip(parts, momenta))
    given = graph.sum(x.stored for x in acting)
    power = graph.sum(x.relative_power for x in acting if not x.contribution.conservative)
    explicit = graph.sum(dot(part.explicit, p) for part, p in zip(parts, momenta)) + free.explicit
    explicit = explicit - tangent(graph, [given], {states.model.time: graph.one})[0]
    if not _vanishes(states, explicit):  # as it does of a steady turn
        power = power - explicit
    power = power + graph.sum(x.row.multiplier * x.drive for x in rows if x.row.law is Law.PERFECT)
    return Energies(
        kinetic=kinetic + free.kinetic,
        potential=given + free.potential,
        energy=kinetic - drives + given + free.jacobi,
        balance=_balance(states, drives, free),
        power=power,
    )


def _balance(states: States, drives: Node, free: FreeTerms) -> str:
    if _vanishes(states, drives - free.beyond):
        return WHOLE
    return BY_DEGREES if not depends(free.mass_matrix.values(), states.v) else BY_MOMENTA


def _vanishes(states: States, node: Node) -> bool:
    if node.is_zero:
        return True
    from lagc.mechanics.identities.sampling_domains import (
        anywhere,  # what proves is loaded where there is a question
    )
    from lagc.mechanics.identities.zero_test import ZeroTest

    return bool(ZeroTest(anywhere(states)).vanish([node]))
