"""The recommended sets against all sets, by brute force: strengths of 0 leave effects out."""

import random
from collections.abc import Iterable
from itertools import combinations
from typing import Any

import pytest

import lagc
from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.study.effects import Effects
from tests.simulation.programs import needs_compiler
from tests.study.test_effects import clock  # noqa: F401

np = pytest.importorskip("numpy")

pytestmark = [needs_compiler, pytest.mark.full]

SEVEN = """model Seven "a spring pendulum with seven effects"
  parameter Mass m = 1 [kg];
  parameter Length l = 1 [m];
  parameter Real[N/m] k = 40;
  coordinate Angle th(start = 30 [deg]);
  coordinate Length r(start = 1.2 [m]);
  point P = r*{sin(th), 0, -cos(th)};
  body bob = Particle(mass = m, at = P);
  potential spring = 1/2*k*(r - l)^2;
  Gravity field;
  effect bearing parameter Real[N.m.s] a1 = 1e-3; dissipation d1 = 1/2*a1*der(th)^2; end bearing;
  effect air parameter Real[kg/m] a2 = 1e-3; force f2 = -a2*norm(velocity(bob))*velocity(bob) at bob; end air;
  effect wind parameter Force a3 = 1e-3; force f3 = a3*world.x at bob; end wind;
  effect torsion parameter Real[N.m] a4 = 1e-3; potential v4 = 1/2*a4*th^2; end torsion;
  effect cubic parameter Real[N/m3] a5 = 1e-3; potential v5 = 1/4*a5*(r - l)^4; end cubic;
  effect tide parameter Force a6 = 1e-3; force f6 = a6*cos(2*time/1[s])*world.x at bob; end tide;
  effect lift parameter Force a7 = 1e-3; force f7 = a7*world.z at bob; end lift;
  scene all uses bearing, air, wind, torsion, cubic, tide, lift
    simulate(stop = 5 [s]);
  end all;
  output Length height = P.z;
end Seven;
"""
# a pendulum; each effect is a force of its own along the path, in powers of ten
TEN = f"""model Ten
  coordinate Angle th(start = 60 [deg]);
  body bob = Particle(mass = 1 [kg], at = 1 [m]*{{sin(th), 0, -cos(th)}});
  Gravity field;
  {
    " ".join(
        f"effect e{k} parameter Real[N.m] a{k} = 1e-{k}; potential v{k} = a{k}*{law}; end e{k};"
        for k, law in enumerate(
            [
                "th^2", "sin(th)", "cos(2*th)", "th^4", "sin(time/1[s])*th", "th", "exp(th)", "sin(3*th)",
                "cos(time/2[s])*sin(th)", "1/(2 + cos(th))",
            ],
            1,
        )
    )
}
  scene all uses {", ".join(f"e{k}" for k in range(1, 11))}
    simulate(stop = 5 [s]);
  end all;
end Ten;
"""  # fmt: skip


class Brute:
    """Plain runs of the full scene with strengths of 0."""

    def __init__(self, text: str, names: list[str], found: Effects, own: dict[str, float]):
        self.system = lagc.loads(text).compile(backend="c")
        self.names, self.found, self.own = names, found, own
        self.full = self.motion(frozenset())
        self.alone = {name: np.abs(self.motion(frozenset([name])) - self.full) for name in names}

    def motion(self, left: frozenset[str]) -> Any:
        zero = {f"a{self.names.index(name) + 1}": 0.0 for name in left}
        run = self.system.simulate(
            5.0, method="dop853", rtol=1e-11, atol=1e-11, points=501, parameters={**self.own, **zero}
        )
        return np.array([np.array(run.column(n)) / size for n, (size, _) in self.found.scales.items()])

    def change(self, left: Iterable[str]) -> float:
        return float(np.abs(self.motion(frozenset(left)) - self.full).max())

    def sets(self) -> dict[frozenset[str], float]:
        """All sets, with the change that they have without luck: the sum of the changes alone."""
        return {
            frozenset(left): float(sum(self.alone[name] for name in left).max())
            for size in range(1, len(self.names) + 1)
            for left in combinations(self.names, size)
        }


def _operations(source: Source, left: Iterable[str]) -> int:
    choice = Choice(without_effects=tuple(sorted(left)))
    return pipeline.optimize(pipeline.Compilation(source, choice).equations, work=False).interface.operations


def _changes_are_those_of_brute_force(found: Effects, brute: Brute, within: float) -> None:
    for one in found.sets:
        exact = brute.change(one.left_out) if one.left_out else 0.0
        assert exact <= one.accuracy
        assert one.change == pytest.approx(exact, rel=within, abs=1e-8)


@pytest.mark.parametrize("seed", [0, 1])
def test_of_all_sets_of_seven_effects_of_drawn_strengths_the_cheapest_is_taken(seed: int) -> None:
    names = ["bearing", "air", "wind", "torsion", "cubic", "tide", "lift"]
    drawn = random.Random(seed)
    own = {f"a{k}": 10.0 ** drawn.uniform(-7, -1) for k in range(1, 8)}
    found = lagc.loads(SEVEN).compile().effects(accuracies=(1e-1, 1e-2, 1e-3, 1e-4, 1e-5), parameters=own)
    brute, source = Brute(SEVEN, names, found, own), Source("seven.lag", SEVEN)
    operations = {left: _operations(source, left) for left in brute.sets()}
    _changes_are_those_of_brute_force(found, brute, 1e-2)
    for one in found.sets:
        least = min(operations[left] for left, bound in brute.sets().items() if bound <= one.accuracy)
        assert operations[frozenset(one.left_out)] == least


def test_of_all_sets_of_ten_effects_the_cheapest_is_taken() -> None:
    names = [f"e{k}" for k in range(1, 11)]
    found = lagc.loads(TEN).compile().effects(accuracies=[10.0**-k for k in range(1, 8)])
    brute = Brute(TEN, names, found, {})
    _changes_are_those_of_brute_force(found, brute, 1e-2)
    saved = {one.effect: found.operations - one.operations for one in found.left_out}
    for one in found.sets:
        sets = [left for left, bound in brute.sets().items() if bound + one.bar <= one.accuracy]
        most = max((sum(saved[name] for name in left) for left in sets), default=0)
        assert sum(saved[name] for name in one.left_out) == most
