"""What a program contains and what it does not; sizes, notes, refusals, sameness."""

import hashlib
import os
import subprocess
import sys
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused, Source, Span
from lagc.lowering.lower_equations import optimize
from lagc.lowering.program import Program
from lagc.mechanics.derive import derive
from lagc.semantics.model import Model
from lagc.symbolic.derivative import tangent
from lagc.symbolic.walk import evaluate
from tests.lowering.interpret import ask
from tests.mechanics import models
from tests.mechanics.builder import Builder


def double_pendulum(relative: bool = False) -> Model:
    b = Builder("DoublePendulum")
    g = b.graph
    m1, m2, l1, l2 = (b.parameter(name) for name in ("m1", "m2", "l1", "l2"))
    first, second = b.coordinate("a"), b.coordinate("b")
    angle = first + second if relative else second
    x, z = l1 * g.sin(first), -l1 * g.cos(first)
    b.particle("upper", m1, (x, 0.0, z))
    b.particle("lower", m2, (x + l2 * g.sin(angle), 0.0, z - l2 * g.cos(angle)))
    b.gravity(b.parameter("g", 9.81))
    return b.model()


def compiled(model: Model, work: bool = False) -> Program:
    return optimize(derive(model), work=work)


@pytest.mark.parametrize(("relative", "bound"), [(False, 33), (True, 47)])
def test_operations_of_the_double_pendulum(relative: Any, bound: int) -> None:
    """By hand: 4 sines and cosines, 3 products and sums for each of sin and cos of the difference,
    the 2x2 solve in 12 with its health, the rest forces.  Masses and lengths alone cost nothing."""
    rhs = compiled(double_pendulum(relative)).functions["rhs"]
    assert rhs.cost <= bound
    assert sum(o.op in ("sin", "cos") for o in rhs.operations) == 4
    assert sum(o.op == "div" for o in rhs.operations) == 1 + relative


def test_the_pendulum_has_no_trace_of_what_is_not_in_it() -> None:
    b = Builder("Pendulum")
    m, length = b.parameter("m"), b.parameter("l")
    b.parameter("drag", 0.3)  # nothing speaks of it
    theta = b.coordinate("theta")
    b.particle("bob", m, (length * b.graph.sin(theta), 0.0, -length * b.graph.cos(theta)))
    b.gravity(b.parameter("g", 9.81))
    program = compiled(b.model(), work=True)
    interface = program.interface
    assert [p.name for p in interface.parameters] == ["m", "l", "g"]
    assert "parameter `drag` reaches nothing" in interface.notes
    assert (interface.nz, interface.nc) == (0, 0)
    assert list(program.functions) == ["bind", "rhs", "system", "energies", "start"]
    rhs = program.functions["rhs"]
    assert [o.op for o in rhs.operations].count("sin") == 1
    assert "cos" not in [o.op for o in rhs.operations]
    loaded = {
        f: {o.payload for o in program.functions[f].operations if o.op == "load"} for f in ("bind", "rhs")
    }
    assert loaded["bind"] == {("p", 0), ("p", 1), ("p", 2)}
    assert loaded["rhs"] == {("x", 0), ("x", 1), ("p", 3)}  # m g l / (m l^2)


def test_a_coordinate_that_nothing_uses_is_left_out() -> None:
    b = Builder()
    b.coordinate("idle")
    x = b.coordinate("x", 0.5)
    b.orientation("o")
    b.particle("p", b.parameter("m"), (x, 0.0, 0.0))
    b.potential("spring", 0.5 * b.parameter("k") * x**2)
    program = compiled(b.model())
    interface = program.interface
    assert interface.q_names == ("x",)
    assert interface.v_names == ("der(x)",)
    assert interface.quaternions == ()
    assert interface.dropped == ("idle", "o")
    found = ask(program, "rhs", {"p": [2.0, 3.0], "t": [0.0], "x": [0.5, 0.1]})
    assert found["xdot"] == pytest.approx([0.1, -0.75], rel=1e-15)


def test_what_an_output_or_a_free_motion_speaks_of_stays() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.output("px", b.graph.symbol("rate", "x", order=1))
    assert compiled(b.model()).interface.q_names == ("x", "y")


def test_independent_parts_are_noted() -> None:
    b = Builder()
    x, y, z = b.coordinate("x"), b.coordinate("y"), b.coordinate("z")
    m, k = b.parameter("m"), b.parameter("k")
    b.particle("p", m, (x, 0.0, 0.0))
    b.particle("q", m, (y, 0.0, 0.0))
    b.particle("r", m, (z, 0.0, 0.0))
    b.potential("spring", k * (x - z) ** 2)
    notes = compiled(b.model()).interface.notes
    assert "the motion falls into independent parts: (der(x), der(z)) (der(y))" in notes
    assert not any("independent" in n for n in compiled(double_pendulum()).interface.notes)


@pytest.mark.parametrize("clause, parts", [
    ("when x + y > 1 [m] then reinit(der(x), -der(x)); end when;", "(der(x), der(y)) (der(z))"),
    ("when x > 1 [m] then reinit({der(x), der(y)}, {der(y), 0}); end when;", "(der(x), der(y)) (der(z))"),
    ("when x > 1 [m] then reinit(z, 0); mark(\"back\"); end when;", "(der(x), der(z)) (der(y))"),
    ("when time > 1 [s] then reinit({der(x), der(y)}, {0, 0}); end when;", "(der(x)) (der(y)) (der(z))"),
    ("when x + y > 1 [m] then mark(\"there\"); end when;", "(der(x)) (der(y)) (der(z))"),
])  # fmt: skip
def test_events_tie_what_they_change_to_what_they_ask_for(clause: str, parts: str) -> None:
    text = f"""model Balls
      coordinate Length x, y, z;
      body a = Particle(mass = 1 [kg], at = {{x, y, z}});
      {clause}
    end Balls;"""
    assert f"the motion falls into independent parts: {parts}" in lagc.loads(text).compile().interface.notes


def test_a_coordinate_without_inertia_is_refused() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, 0.0, 0.0))
    b.potential("spring", b.parameter("k") * (x - y) ** 2)
    with pytest.raises(Refused) as refused:
        compiled(b.model())
    assert [f.code for f in refused.value.faults] == ["LAG0501"]
    assert "`y`" in refused.value.faults[0].message


def test_a_massless_coordinate_tied_to_a_mass_is_solved() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    b.particle("p", b.parameter("m"), (x, 0.0, 0.0))
    b.potential("pull", -1.0 * y)
    b.constraint("gear", y - 2.0 * x)
    program = compiled(b.model())
    found = ask(program, "rhs", {"p": [4.0], "t": [0.0], "x": [0.0, 0.0, 0.0, 0.0]})
    assert found["xdot"][2:] == pytest.approx([0.5, 1.0], rel=1e-15)  # m a = 2 * (force 1 on y)


def test_work_is_the_last_state_and_its_rate_the_power() -> None:
    program = compiled(models.pendulum(), work=True)
    interface = program.interface
    assert (interface.nz, interface.nx) == (1, 3)
    assert dict(program.functions["start"].outputs) == {"x": 3}
    arrays = {"p": [f.value for f in interface.parameters], "t": [0.0], "x": [1.0, 2.0, 0.0]}
    xdot = ask(program, "rhs", arrays)["xdot"]
    power = ask(program, "power", {**arrays, "a": [xdot[1]], "lam": []})["e"]
    assert xdot[2] == pytest.approx(power[0], rel=1e-14)
    assert xdot[2] < 0.0  # drag


@pytest.mark.parametrize("make", [models.free_solid, models.declared_speeds])
def test_displace_is_the_linear_part_of_the_rates_of_the_coordinates(make: Any) -> None:
    equations = derive(make())
    program = optimize(equations)
    interface = program.interface
    rng = np.random.default_rng(1)
    x = [float(a) for a in rng.normal(size=interface.nx)]
    d = [float(a) for a in rng.normal(size=interface.nv)]
    p = [f.value for f in interface.parameters]
    found = ask(program, "displace", {"p": p, "t": [0.3], "x": x, "d": d})["dq"]
    values = dict(zip((*equations.q, *equations.v), x))
    values[equations.time] = 0.3
    values.update((q.symbol, q.value) for q in equations.model.parameters)
    graph = equations.graph
    directions = tangent(graph, equations.qdot, dict(zip(equations.v, map(graph.const, d))))
    assert found == pytest.approx(evaluate(directions, values), rel=1e-13, abs=1e-13)


def test_displace_is_absent_where_speeds_are_the_rates() -> None:
    assert "displace" not in compiled(models.string_pendulum()).functions


def test_scales_are_the_sizes_of_the_terms() -> None:
    program = compiled(models.string_pendulum())
    names = [f.name for f in program.interface.parameters]
    p = [{"m": 1.0, "l": 0.5, "g": 9.81}[name] for name in names]
    (scale,) = ask(program, "scales", {"p": p, "t": [0.0], "x": [0.3, 0.4, 0.0, 0.0]})["s"]
    assert scale == pytest.approx(0.5 + 0.5, rel=1e-14)
    given = {"p": p, "t": [0.0], "x": [0.3, 0.4, 0.0, 0.0], "c": [3.0, 5.0]}
    found = ask(program, "reaches", given)["s"]
    rows = [3.0 * (0.6 + 0.8), 5.0 * (0.6 + 0.8) + 5.0 * (0.5 + 0.5)]
    assert found == pytest.approx([*rows, 3.0, 5.0], rel=1e-14)


def test_conditions_of_the_start_and_their_derivatives() -> None:
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    rate = b.graph.symbol("rate", "y", order=1)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.initially(x * x + y * rate - 1.0)
    given = {"p": [1.0], "t": [0.0], "x": [2.0, 3.0, 4.0, 5.0]}
    found = ask(compiled(b.model()), "conditions", given)
    assert found == {"c": [18.0], "J": [4.0, 5.0, 3.0], "sizes": [20.0]}


@pytest.mark.full
def test_what_is_entangled_is_solved_in_a_loop_with_operations_in_proportion_to_n_squared() -> None:
    costs = []
    for n in (25, 50):
        program = compiled(models.entangled(n))
        assert program.interface.solve == "looped"
        assert "rhs" not in program.functions
        costs.append(program.functions["system"].cost)
    assert costs[1] < 4.5 * costs[0]  # common factors of the longer one are not looked for
    assert costs[1] < 10 * 50 * 50


@pytest.mark.full
def test_the_looped_system_gives_the_accelerations() -> None:
    """Against M a = r with M and r evaluated by the expression graph's own evaluator."""
    n = 25
    equations = derive(models.entangled(n))
    program = optimize(equations)
    x = [0.1 * (k % 5) for k in range(n)] + [0.3 * (k % 3) for k in range(n)]
    found = ask(program, "system", {
        "p": [f.value for f in program.interface.parameters], "t": [0.0], "x": x,
    })  # fmt: skip
    values = dict(zip((*equations.q, *equations.v), x))
    values.update((p.symbol, p.value) for p in equations.model.parameters)
    packed = [equations.mass_matrix[i, j] for i in range(n) for j in range(i + 1)]
    assert found["M"] == pytest.approx(evaluate(packed, values), rel=1e-12)
    forces = np.subtract(evaluate(equations.given_forces, values), evaluate(equations.bias_forces, values))
    assert np.abs(np.array(found["r"]) - forces).max() <= 1e-12 * np.abs(forces).max()


def digest() -> str:
    """Of every byte of some programs that could depend on an order."""
    text = hashlib.sha256()
    makes = [models.pendulum, models.string_pendulum, models.free_solid, models.rolling_ball,
             models.declared_speeds, double_pendulum, lambda: models.chain(12)]  # fmt: skip
    for make in makes:
        program = compiled(make(), work=True)
        text.update(repr(program.interface).encode())
        for name, f in program.functions.items():
            text.update(name.encode())
            text.update(repr([getattr(f, x.name) for x in fields(f)]).encode())
    return text.hexdigest()


@pytest.mark.full
def test_programs_do_not_depend_on_the_hash_seed() -> None:
    script = "from tests.lowering.test_optimize import digest; print(digest())"
    found = {
        subprocess.run(
            [sys.executable, "-c", script],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True, text=True, check=True,
        ).stdout
        for seed in ("0", "1", "77")
    }  # fmt: skip
    assert len(found) == 1


def test_the_hash_of_a_model_speaks_of_its_numbers_only() -> None:
    first = compiled(double_pendulum()).interface.model_hash
    assert first == compiled(double_pendulum()).interface.model_hash
    assert len(first) == 64
    assert first != compiled(double_pendulum(relative=True)).interface.model_hash


def test_stores_say_what_they_are_and_where_it_stands_in_the_source() -> None:
    program = compiled(models.string_pendulum())
    rhs = program.functions["rhs"]
    said = {(s.array, s.index): rhs.comments.get(len(rhs.operations) + k) for k, s in enumerate(rhs.stores)}
    assert said["xdot", 2] == "der(der(x))"
    assert said["lam", 0] == "string, built.lag:1"


def test_nothing_depends_on_the_directory_of_the_source() -> None:
    b = Builder()
    x = b.coordinate("x")
    b.particle("p", b.parameter("m"), (x, 0.0, 0.0))
    model = b.model()
    for directory in ("/home/a/", "C:\\b\\"):
        span = Span(Source(f"{directory}m.lag", "text\n"), 0, 1)
        moved = replace(model, parameters=tuple(replace(p, span=span) for p in model.parameters))
        assert compiled(moved).interface.parameters[0].place == "m.lag:1"


@pytest.mark.parametrize("place", ["{0, x, 0}", "{0, 0, 1 [m]}", "{0, 0, a*sin(time/(1 [s]))}"])
def test_what_acts_on_what_no_speed_moves_is_nothing(place: str) -> None:
    """Conditions, tables and parameters of it too."""
    text = f"""model M
      parameter Length a = 0.1 [m], b = 0.2 [m]; input Force u = 1 [N];
      coordinate Length x(start = 0.1 [m], rate = 0.3 [m/s]);
      body p = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      body o = Particle(mass = 1 [kg], at = {place});
      force f = {{if b >= x then 3 [N] else u, if x > 0 [m] then 0 [N] else 0 [N],
                  if b < x then 1 [N] else 2 [N]}} at o;
    end M;"""
    model = lagc.loads(text).compile(backend="numpy")
    assert "b" not in [p.name for p in model.interface.parameters] and not model.interface.relations
    assert model.simulate(1.0, points=2)["x"][-1] == pytest.approx(0.4)
