"""What a scene gives: parameters and starts, of instances, arrays and orientations too."""

from math import cos, sin

import pytest

import lagc
from lagc.diagnostics.faults import Refused
from tests.semantics.reading import output, read

PARTS = """
model B
  parameter Mass m = 1; parameter Real k[2] = {1, 2};
  coordinate Length x; body b = Particle(mass = m, at = {x, 0, 0});
end B;
model C
  B c[2], d;
end C;
model A
  B a, b(m = 3);
  C e;
  structural Integer n = 2;
  output Mass o[4] = {a.m, b.m, e.c[2].m, e.d.m};
  output Real k[4] = {a.k[1], a.k[2], e.c[1].k[2], e.d.k[1]};
  scene plain;
  scene s
    parameter a.m = 4 [kg], e.c[n].m = 7, e.d.m = 70 [g];
    parameter e.d.k = {5, 6};
    parameter a.k[2] = 9;
  end s;
end A;
"""


def test_a_scene_reaches_the_parameters_of_instances() -> None:
    model = read(PARTS, scene="s")
    assert [output(model, f"o[{i}]") for i in range(1, 5)] == [4.0, 3.0, 7.0, 0.07]
    assert [output(model, f"k[{i}]") for i in range(1, 5)] == [1.0, 9.0, 2.0, 5.0]


def test_another_scene_has_the_values_of_the_model() -> None:
    model = read(PARTS, scene="plain")
    assert [output(model, f"o[{i}]") for i in range(1, 5)] == [1.0, 3.0, 1.0, 1.0]


def test_the_command_goes_before_the_scene() -> None:
    model = read(PARTS, scene="s", parameters={"a.m": 8.0, "e.d.k[1]": 3.0, "n": 1})
    assert [output(model, f"o[{i}]") for i in range(1, 5)] == [8.0, 3.0, 1.0, 0.07]
    assert output(model, "k[4]") == 3.0


ARRAYS = """
model A
  structural Integer n = 3;
  parameter Length L[n];
  coordinate Length x[n](start = 7);
  coordinate Orientation o;
  frame F = rotate(world, o);
  body s = Solid(mass = 1, inertia = {1, 2, 3}, frame = F, com = {0, 0, 0});
  for i in 1:n loop
    body b[i] = Particle(mass = 1, at = {x[i] + L[i], 0, 0});
  end for;
  scene whole
    start x = {1, 2, 3}; start der(x) = {10, 20, 30} [cm/s];
    start o = {1, 1, 0, 0}; start o.rate = {1, 0, 0} [rad/s]; parameter L = {3, 4, 5};
  end whole;
  scene single
    start x = 2; start x[n] = 5; start o.x = 1; start o.rate.z = 2; parameter L = 1; parameter L[2] = 2;
  end single;
end A;
"""


def test_a_scene_starts_arrays_and_orientations() -> None:
    model = read(ARRAYS, scene="whole")
    *scalars, turn = model.coordinates
    assert [c.start.value for c in scalars] == [1.0, 2.0, 3.0]
    assert [c.rate.value for c in scalars] == [0.1, 0.2, 0.3]
    assert [s.value for s in turn.start] == pytest.approx([0.5**0.5, 0.5**0.5, 0.0, 0.0])
    assert [r.value for r in turn.rate] == [1.0, 0.0, 0.0]
    assert [p.value for p in model.parameters] == [3.0, 4.0, 5.0]


def test_a_scene_starts_single_elements() -> None:
    model = read(ARRAYS, scene="single")
    *scalars, turn = model.coordinates
    assert [c.start.value for c in scalars] == [2.0, 2.0, 5.0]
    assert [s.value for s in turn.start] == pytest.approx([0.5**0.5, 0.5**0.5, 0.0, 0.0])
    assert [r.value for r in turn.rate] == [0.0, 0.0, 2.0]
    assert [p.value for p in model.parameters] == [1.0, 2.0, 1.0]


@pytest.mark.parametrize(
    "line, code",
    [
        ("parameter a.q = 1;", "LAG0215"), ("parameter a.m = 1; parameter a.m = 2;", "LAG0209"),
        ("parameter e.c[3].m = 1;", "LAG0215"), ("parameter a = 1;", "LAG0215"),
        ("start a.m = 1;", "LAG0224"), ("start a.x = {1, 2};", "LAG0306"),
        ("start a.x = 1; start a.x = 2;", "LAG0209"), ("start 2*a.x = 1;", "LAG0110"),
        ("parameter a.k = {1, 2, 3};", "LAG0306"),
    ],
)  # fmt: skip
def test_what_a_scene_cannot_give(line: str, code: str) -> None:
    with pytest.raises(Refused) as refused:
        read(PARTS.replace("scene plain;", f"scene plain {line} end plain;"), scene="plain")
    assert [f.code for f in refused.value.faults] == [code]


SLEIGH = """
model Sleigh
  coordinate Length x, y; coordinate Angle phi(start = 0.3);
  speed Velocity u = der(x)*cos(phi) + der(y)*sin(phi);
  speed Velocity w = -der(x)*sin(phi) + der(y)*cos(phi);
  speed AngularVelocity r = der(phi);
  frame F = rotate_z(world, phi);
  body b = Solid(mass = 2, inertia = {1, 1, 1}, frame = F, com = {x, y, 0});
  constraint knife: w = 0;
  output Force N = reaction(knife);
  scene s start u = 1; start r = 2 [rad/s]; end s;
end Sleigh;
"""


def test_a_scene_starts_declared_speeds() -> None:
    run = lagc.loads(SLEIGH).compile(backend="numpy").simulate(stop=1.0, accuracy=1e-9)
    assert run["u"][0] == pytest.approx(1.0, rel=1e-12) and run["r"][0] == pytest.approx(2.0, rel=1e-12)
    assert run["N"] == pytest.approx(4.0, rel=1e-9)  # m u r, which holds the blade on its circle


def test_the_strength_of_gravity_is_a_parameter_that_others_may_use() -> None:
    text = (
        "model A parameter Mass m = 2; coordinate Length x; body b = Particle(mass = m, at = {0, 0, x});"
        "effect gravity Gravity field; output Force weight = m*field.g; end gravity;"
        "effect slope parameter Angle a = 30 [deg]; Gravity field(g = 2 [m/s2]*sin(a));"
        "output Acceleration down = field.g; end slope;"
        "scene earth uses gravity; scene moon uses gravity parameter field.g = 1.62; end moon;"
        "scene plane uses slope; end A;"
    )
    assert output(read(text, scene="earth"), "weight") == 2 * 9.81
    assert output(read(text, scene="moon"), "weight") == 2 * 1.62
    assert output(read(text, scene="plane"), "down") == pytest.approx(1.0, rel=1e-15)


def test_the_command_starts_declared_speeds_otherwise() -> None:
    system = lagc.loads(SLEIGH).compile(backend="numpy")
    run = system.simulate(stop=1.0, accuracy=1e-9, starts={"u": 3.0})
    assert run["u"][0] == pytest.approx(3.0, rel=1e-12)
    assert run["N"] == pytest.approx(12.0, rel=1e-9)


def test_a_speed_may_say_its_start_itself() -> None:
    text = SLEIGH.replace("speed Velocity u =", "speed Velocity u(start = 7 [m/s]) =")
    speeds = {s.name: s.start for s in read(text.replace("start u = 1;", "")).speeds}
    assert speeds["u"] is not None and speeds["u"].value == 7.0
    assert speeds["w"] is None and speeds["r"] is not None


LINK = """model Link
  coordinate Orientation o;
  body b = Solid(mass = 1, inertia = {1, 2, 3}, frame = rotate(world, o), com = {0, 0, 0});
end Link;
"""


def test_each_instance_starts_as_its_own_element_says() -> None:
    text = LINK + "model M Link k[3](o(start = {{cos(0.1*i), 0, 0, sin(0.1*i)} for i in 1:3})); end M;"
    start = lagc.loads(text).compile(backend="numpy").start()
    for i in range(1, 4):
        assert list(start[4 * i - 4 : 4 * i]) == pytest.approx(
            [cos(0.1 * i), 0.0, 0.0, sin(0.1 * i)], rel=1e-14
        )


def test_all_instances_start_as_one_quaternion_says() -> None:
    text = LINK + "model M Link k[4](o(start = {0.6, 0, 0.8, 0}, rate = {1, 2, 3} [rad/s])); end M;"
    start = lagc.loads(text).compile(backend="numpy").start()
    assert list(start) == pytest.approx([0.6, 0.0, 0.8, 0.0] * 4 + [1.0, 2.0, 3.0] * 4)


def test_too_few_elements_are_refused() -> None:
    text = LINK + "model M Link k[3](o(start = {{1, 0, 0, 0}, {0, 1, 0, 0}})); end M;"
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text).compile()
    assert [fault.code for fault in refused.value.faults] == ["LAG0306"]
