"""What the leaves of a model are called is what the language calls them."""

import pytest

from lagc.diagnostics.faults import Refused
from lagc.symbolic.leaves import derived
from tests.semantics.reading import read

TEXT = """
model Part
  parameter Mass m = 2 [kg];
  input Force pull;
  coordinate Length x[2];
  coordinate Orientation o;
  speed Velocity fast = 2*der(x[1]);
  frame F = rotate(world, o);
  body b = Solid(mass = m, inertia = {1, 2, 3} [kg.m2], frame = F, com = {x[1], x[2], 0});
  force push = {pull, 0, 0} at b;
end Part;
model Middle Part q; end Middle;
model Whole Part p; Part a[2]; Middle deep; end Whole;
"""
# Type, what stands before the path of the part, and behind it.
LEAVES = [
    ("Mass", "", "m"), ("Force", "", "pull"), ("Length", "", "x[2]"), ("Velocity", "", "fast"),
    *(("Real", "", f"o.{part}") for part in "wxyz"),
    *(("AngularVelocity", "", f"o.rate.{axis}") for axis in "xyz"),
    ("Velocity", "der(", "x[1])"), ("Acceleration", "der(der(", "x[2]))"),
    ("Acceleration", "der(", "fast)"), ("AngularAcceleration", "der(", "o.rate.y)"),
    ("Power", "power(", "push)"), ("Momentum", "momentum(", "x[1])"),
]  # fmt: skip
TOTALS = [
    ("Time", "time"), *(("Energy", f"{name}()") for name in ("energy", "kinetic", "potential")),
    *(("Momentum", f"momentum().{axis}") for axis in "xyz"),
    *(("AngularMomentum", f"angular_momentum().{axis}") for axis in "xyz"),
]  # fmt: skip


@pytest.mark.parametrize("where", ["p.", "a[2].", "deep.q."])
def test_a_symbol_writes_itself_as_the_language_does(where: str) -> None:
    """Each expression is one leaf, whose name is that expression; their records differ."""
    asked = [*TOTALS, *((kind, f"{head}{where}{tail}") for kind, head, tail in LEAVES)]
    outputs = "".join(f"output {kind} y{k} = {name};" for k, (kind, name) in enumerate(asked))
    model = read(TEXT.replace("end Whole", f"{outputs} end Whole"), model="Whole")
    leaves = [output.expression for output in model.outputs]
    assert [leaf.op for leaf in leaves] == ["symbol"] * len(asked)
    assert [leaf.record.name for leaf in leaves] == [name for _, name in asked]
    assert len({leaf.record for leaf in leaves}) == len(asked)


def test_derivatives_of_records_are_those_of_names() -> None:
    """At the state level: q, its rates, declared speeds and body rates."""
    model = read(TEXT, model="Part")
    orientation = model.coordinates[-1]
    moving = [model.coordinates[0].symbol, model.coordinates[0].rate_symbol, model.speeds[0].symbol,
              *orientation.rate_symbols]  # fmt: skip
    for symbol in moving:
        assert symbol.record.derivative.name == derived(symbol.record.name)
        assert model.graph.leaf(symbol.record) is symbol


@pytest.mark.parametrize("name", ["o.w", "o.rate.x", "der(x[1])", "m", "fast"])
def test_only_coordinates_that_are_numbers_have_a_momentum(name: str) -> None:
    text = TEXT.replace("end Part;", f"output Real y = momentum({name}); end Part;", 1)
    with pytest.raises(Refused) as refused:
        read(text, model="Part")
    assert "LAG0221" in {fault.code for fault in refused.value.faults}
