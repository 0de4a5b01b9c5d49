"""Rows at the end of a long chain are judged as at that of a short one, in work that grows as it does."""

from __future__ import annotations

import cProfile
import pstats

import pytest

from lagc.compiler.pipeline import Choice, parse, resolve
from lagc.diagnostics.faults import Refused, Source
from lagc.host import model_library
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.lint.smoothness import refuse_breaks

CHAIN = """model M
structural Integer n = {n};
parameter Length l(min = 0) = 0.3 [m];
coordinate Angle a[n](each start = 20 [deg]), b[n](each start = 25 [deg]);
point P[0] = {{0, 0, 0}};
for i in 1:n loop
  point P[i] = P[i-1] + l*{{sin(a[i])*cos(b[i]), sin(a[i])*sin(b[i]), -cos(a[i])}};
  body m[i] = Particle(mass = 1 [kg], at = P[i]);
end for;
coordinate Length s(start = 1 [m]);
body e = Particle(mass = 1 [kg], at = {{0, 0, s}});
constraint c: {row};
end M;"""
SHORT, LONG = 2, 20

ROWS = {
    "norm(P[n]) = l": [],
    "norm(P[n]) = 0": ["LAG0413"],  # wherever it holds
    "P[n].x^2 = 0": ["LAG0413"],
    "P[n].x^2*P[n].y = 0": ["LAG0413"],
    "abs(P[n].x) = 0.5*l + P[n].y": ["LAG0421"],
    "sqrt(P[n].x^2 + (2*P[n].x)^2) = l + P[n].z": ["LAG0421"],  # two sums that are one
    "norm({P[n].x, P[n].y, 0}) = s": ["LAG0426"],  # the tip of a cone
    "norm({P[n].x, P[n].y, l}) = 0.7*P[n].z": [],
}


def faults(n: int, row: str) -> list[str]:
    model = resolve(parse(Source("m.lag", CHAIN.format(n=n, row=row))), Choice())
    try:
        return [fault.code for fault in derive(model).warnings]
    except Refused as refused:
        return [fault.code for fault in refused.faults]


@pytest.mark.parametrize("row", ROWS)
def test_rows_of_long_chains_are_judged_as_those_of_short_ones(row: str) -> None:
    assert faults(SHORT, row) == faults(LONG, row) == ROWS[row]


def calls(n: int) -> int:
    """Of functions, to see that the rows of a truss are smooth."""
    states = build_states(resolve(parse(model_library.read("large/truss")), Choice(parameters={"n": n})))
    profile = cProfile.Profile()
    assert profile.runcall(refuse_breaks, states, {x for x in states.graph.nodes if x.op == "sqrt"}) == ()
    return int(vars(pstats.Stats(profile))["total_calls"])


@pytest.mark.full
def test_the_work_of_looking_for_breaks_grows_as_the_rows_do() -> None:
    few, many = 40, 80
    assert calls(many) / calls(few) < 2.0**1.1
