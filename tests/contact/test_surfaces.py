"""The slip of `at` against the explicit `slip` of the same model: surfaces in turned and moving frames."""

import pytest

import lagc
from lagc.api import Run

SCENE = "scene s\n  simulate(stop = 1 [s], accuracy = 1e-9);\nend s;"

MODELS = {
    "a block in coordinates along its slope": (
        """parameter Angle b = 20 [deg];
        coordinate Length s(rate = 2 [m/s]), n(start = 0);
        frame S = rotate_y(world, b);
        body block = Particle(mass = 1 [kg], at = s*S.x + n*S.z);
        constraint slope: n >= 0 (friction = 0.5, @);""",
        "at = block",
        "slip = der(s)",
    ),
    "a box that tumbles down a slope": (
        """parameter Angle b = 20 [deg];
        coordinate Length s(rate = 1 [m/s]), n(start = 0.5 [m]);
        coordinate Angle phi(start = 0.4 [rad], rate = 2 [rad/s]);
        frame S = rotate_y(world, b);
        frame B = rotate_y(S, phi);
        body box = Solid(mass = 1 [kg], inertia = 0.02 [kg.m2]*{1, 1, 1}, frame = B, com = s*S.x + n*S.z);
        for i in 1:2 loop
          point P[i] = position(box) + (2*i - 3)*0.2 [m]*B.x - 0.1 [m]*B.z;
          constraint c[i]: dot(P[i], S.z) >= 0 (restitution = 0.3, friction = 0.4, @);
        end for;""",
        "at = P[i]",
        "slip = der(dot(P[i], S.x))",
    ),
    "the tip of an arm on a slope": (
        """parameter Angle b = 30 [deg];
        coordinate Angle u(start = 0.5 [rad]), v(start = 0.6 [rad]);
        frame S = rotate_y(world, b);
        point E = 1 [m]*{cos(u), 0, sin(u)};
        point T = E + 1 [m]*{cos(v), 0, sin(v)};
        body one = Particle(mass = 1 [kg], at = E);
        body two = Particle(mass = 1 [kg], at = T);
        constraint slope: dot(T, S.z) >= -1 [m] (friction = 0.4, @);""",
        "at = T",
        "slip = der(dot(T, S.x))",
    ),
    "an arm that starts stretched, where it moves across itself alone": (
        """coordinate Angle u(start = 0), v(start = 0, rate = 1 [rad/s]);
        point E = 1 [m]*{cos(u), 0, -sin(u)};
        point T = E + 1 [m]*{cos(u + v), 0, -sin(u + v)};
        body one = Particle(mass = 1 [kg], at = E);
        body two = Particle(mass = 1 [kg], at = T);
        constraint floor: (T.z + 0.5*T.x)/sqrt(1.25) >= -0.5 [m] (friction = 0.3, @);""",
        "at = T",
        "slip = der((T.x - 0.5*T.z)/sqrt(1.25))",
    ),
    "a ball thrown on a slope in space": (
        """parameter Angle b = 20 [deg], c = 30 [deg];
        coordinate Length x(rate = 1 [m/s]), y(rate = -0.5 [m/s]), z(start = 0.4 [m]);
        frame T = rotate_z(world, c);
        frame S = rotate_y(T, b);
        point P = {x, y, z};
        body ball = Particle(mass = 1 [kg], at = P);
        constraint slope: dot(P, S.z) >= 0 (friction = 0.4, restitution = 0.2, @);""",
        "at = P",
        "slip = {der(dot(P, S.x)), der(dot(P, S.y))}",
    ),
    "a disc that slides and rolls down a slope": (
        """parameter Angle b = 20 [deg];
        parameter Length r = 0.1 [m];
        coordinate Length s(rate = 1 [m/s]), n(start = r);
        coordinate Angle phi(rate = 30 [rad/s]);
        frame S = rotate_y(world, b);
        frame B = rotate_y(S, phi);
        point C = s*S.x + n*S.z;
        body disc = Solid(mass = 1 [kg], inertia = 0.005 [kg.m2]*{1, 1, 1}, frame = B, com = C);
        constraint slope: n >= r (friction = 0.3, @);""",
        "at = C - r*S.z, on = disc",
        "slip = der(s) - r*der(phi)",
    ),
    "a block on a beam that turns": (
        """coordinate Length s, n(start = 0);
        coordinate Angle tilt(start = 0.2 [rad], rate = 0.5 [rad/s]);
        frame S = rotate_y(world, tilt);
        body beam = Solid(mass = 3 [kg], inertia = 0.5 [kg.m2]*{1, 1, 1}, frame = S, com = {0, 0, 0});
        body block = Particle(mass = 1 [kg], at = s*S.x + (n + 0.1 [m])*S.z);
        constraint top: n >= 0 (friction = 0.15, @);""",
        "at = block, against = beam",
        "slip = der(s)",
    ),
    "a puck on a plate that turns about a tilted axis": (
        """parameter Angle b = 20 [deg];
        coordinate Length x(start = 0.3 [m]*cos(b)), y, z(start = -0.3 [m]*sin(b));
        coordinate Angle phi(rate = 2 [rad/s]);
        frame T = rotate_y(world, b);
        frame D = rotate_z(T, phi);
        body plate = Solid(mass = 5 [kg], inertia = 1 [kg.m2]*{1, 1, 1}, frame = D, com = {0, 0, 0});
        body puck = Particle(mass = 1 [kg], at = {x, y, z});
        constraint top: dot(position(puck), D.z) >= 0 (friction = 0.2, @);""",
        "at = puck, against = plate",
        "slip = {der(dot(position(puck), D.x)), der(dot(position(puck), D.y))}",
    ),
    "a bead held on a plane from both sides": (
        """parameter Angle b = 20 [deg], c = 30 [deg];
        coordinate Length x(rate = 2 [m/s]), y, z;
        frame T = rotate_z(world, c);
        frame S = rotate_y(T, b);
        point P = {x, y, z};
        body bead = Particle(mass = 1 [kg], at = P);
        constraint plane: dot(P, S.z) = 0 (friction = 0.4, @);""",
        "at = P",
        "slip = {der(dot(P, S.x)), der(dot(P, S.y))}",
    ),
}


def _run(text: str, slip: str, backend: str = "numpy") -> Run:
    parts = text.replace("@", slip)
    model = f"model M\n{parts}\nGravity field(g = 9.81 [m/s2]);\n{SCENE}\nend M;"
    return lagc.loads(model).compile(backend=backend).simulate()


@pytest.mark.full
@pytest.mark.parametrize("name", MODELS)
def test_the_normal_follows_from_the_velocities(name: str) -> None:
    """The motion is that with the slip in words, to the same accuracy: the axes along a surface in space
    may differ, and with them round-off."""
    text, place, slip = MODELS[name]
    one, two = _run(text, place), _run(text, slip)
    assert one.status == two.status == "ok"
    assert [(e.contact, e.kind) for e in one.events] == [(e.contact, e.kind) for e in two.events]
    assert [e.t for e in one.events] == pytest.approx([e.t for e in two.events], abs=1e-7)
    moving = [key for key in one.final if not isinstance(two.final[key], str)]
    assert [one.final[k] for k in moving] == pytest.approx([two.final[k] for k in moving], abs=1e-7)


@pytest.mark.parametrize(("speed", "state"), [(1.0, 1.0), (-1.0, -1.0)])
@pytest.mark.parametrize("slip", ["slip = der(x)", "at = bead"])
def test_a_slip_has_one_sign(slip: str, speed: float, state: float) -> None:
    """Along +x it is 1, whichever way the contact is written."""
    text = f"""coordinate Length x(rate = {speed} [m/s]), z(start = 0);
    body bead = Particle(mass = 1 [kg], at = {{x, 0, z}});
    constraint lower: z >= 0 (friction = 0.05, @);"""
    assert _run(text, slip).final["lower"] == state


@pytest.mark.parametrize(
    ("gap", "at", "rate"),
    [("-z", "{x, 0, z}", "x"), ("x", "{x, 0, z}", "z"), ("-y", "{x, y, 0}", "x"), ("-x", "{x, y, 0}", "y")],
)
def test_a_slip_along_a_wall_is_positive_along_an_axis(gap: str, at: str, rate: str) -> None:
    """A ceiling and walls on either side, pressed by a load along the normal."""
    names = [name for name in "xyz" if name in at]
    declared = ", ".join(f"{name}(rate = {float(name == rate)} [m/s])" for name in names)
    load = (
        "{" + ", ".join(("5 [N]" if f"-{n}" == gap else "-5 [N]" if n == gap else "0") for n in "xyz") + "}"
    )
    text = f"""model M
      coordinate Length {declared};
      body bead = Particle(mass = 1 [kg], at = {at});
      force f = {load} at bead;
      constraint wall: {gap} >= 0 (friction = 0.05, at = bead);
      {SCENE.replace("1 [s]", "0.1 [s]")}
    end M;"""
    run = lagc.loads(text).compile(backend="numpy").simulate()
    assert run.status == "ok" and run.final["wall"] == 1.0


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.full)])
def test_friction_along_a_direction_that_a_constraint_holds(backend: str) -> None:
    """The ball lands after sqrt(2 h/g), where the blow of v = sqrt(2 g h) takes mu v of its speed 1 m/s; the
    rest lasts (1 - mu v)/(mu g)."""
    text = """coordinate Length x(rate = 1 [m/s]), y, z(start = 0.5 [m]);
    body ball = Particle(mass = 1 [kg], at = {x, y, z});
    constraint plane: y = 0;
    constraint floor: z >= 0 (friction = 0.3, @);"""
    run = _run(text, "at = ball", backend)
    fall, left = (1.0 / 9.81) ** 0.5, 1.0 - 0.3 * 9.81**0.5
    assert [event.kind for event in run.events] == ["impact", "sticks"]
    assert run.events[1].t == pytest.approx(fall + left / (0.3 * 9.81), abs=1e-9)
    assert run.final["x"] == pytest.approx(fall + left**2 / (2.0 * 0.3 * 9.81), abs=1e-9)


@pytest.mark.parametrize(
    ("rows", "held"),
    [
        ("constraint path: x = 0 (friction = 0.3, slip = der(x));", True),
        ("constraint path: x = 0 (friction = 0.3, slip = der(z));", False),
        ("constraint path: x = 0.1 [m/s]*time (friction = 0.3, slip = der(x));", False),
        ("constraint hold: x = 0;\nconstraint floor: z >= 0 (friction = 0.3, slip = der(x));", True),
        ("constraint hold: x = z;\nconstraint floor: z >= 0 (friction = 0.3, slip = der(x));", True),
        ("constraint hold: x = z;\nconstraint floor: z >= x - 1 [m] (friction = 0.3, slip = der(x));", False),
    ],
)
def test_friction_that_never_acts_has_a_warning(rows: str, held: bool) -> None:
    text = f"""model M
      coordinate Length x, z(start = 0);
      Gravity field;
      body ball = Particle(mass = 1 [kg], at = {{x, 0, z}});
      {rows}
    end M;"""
    assert ("LAG0433" in [fault.code for fault in lagc.loads(text).check()]) == held
