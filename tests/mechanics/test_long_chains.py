"""Constraints at the end of a long chain are judged as those of a short one."""

import pytest

from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Refused, Source
from lagc.mechanics.derive import derive

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
    "norm({P[n].x, P[n].y, 0}) = s": [],  # the tip of a cone
    "norm({P[n].x, P[n].y, l}) = 0.7*P[n].z": [],
}


def faults(n: int, row: str) -> list[str]:
    model = resolve(parse(Source("m.lag", CHAIN.format(n=n, row=row))), Choice())
    try:
        return [fault.code for fault in derive(model).warnings]
    except Refused as refused:
        return [fault.code for fault in refused.faults]


@pytest.mark.sample(3)
@pytest.mark.parametrize("row", ROWS)
def test_rows_of_long_chains_are_judged_as_those_of_short_ones(row: str) -> None:
    assert faults(SHORT, row) == faults(LONG, row) == ROWS[row]
