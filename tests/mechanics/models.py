"""Hand-built models of the standard systems."""

from collections.abc import Callable

from lagc.semantics.model import Model
from lagc.symbolic.vectors import add, cross, matvec, norm, sub
from tests.mechanics.builder import Builder


def pendulum() -> Model:
    b = Builder("Pendulum")
    m, length, g = b.parameter("m", 2.0), b.parameter("l", 0.5), b.parameter("g", 9.81)
    k = b.parameter("k", 0.1)
    theta = b.coordinate("theta", 1.0)
    bob = b.particle("bob", m, (length * b.graph.sin(theta), 0.0, -length * b.graph.cos(theta)))
    b.gravity(g)
    u = bob.velocity
    speed = norm(u)
    b.force("drag", [-k * speed * x for x in u], bob.position)
    b.output("E", b.quantity("energy"))
    b.output("p", b.quantity("momentum", "theta"))
    b.output("px", b.quantity("momentum", component="x"))
    b.output("Ly", b.quantity("angular_momentum", component="y"))
    b.output("P", b.quantity("power", "drag"))
    b.output("alpha", b.graph.symbol("acceleration", "theta", order=2))
    return b.model()


def chain(n: int) -> Model:
    """`n` particles on massless links, one after another."""
    b = Builder("Chain")
    m, length, g = b.parameter("m", 1.0), b.parameter("l", 1.0), b.parameter("g", 9.81)
    at = b.vector((0.0, 0.0, 0.0))
    angles = [b.coordinate(f"th[{i + 1}]", 0.1 * (i % 7)) for i in range(n)]
    places = []
    for angle in angles:
        at = (at[0] + length * b.graph.sin(angle), at[1], at[2] - length * b.graph.cos(angle))
        places.append(at)
    for i, place in enumerate(places):
        b.particle(f"bob[{i + 1}]", m, place)
    b.gravity(g)
    return b.model()


def entangled(n: int) -> Model:
    """`n` coordinates whose kinetic energy ties each to each: a mass matrix without a zero."""
    b = Builder("Entangled")
    m, k = b.parameter("m", 1.0), b.parameter("k", 2.0)
    x = [b.coordinate(f"x[{i + 1}]", 0.1 * (i % 7), unit="rad") for i in range(n)]
    v = [b.der(q) for q in x]
    own = b.graph.sum(0.5 * (k + b.graph.sin(q)) * rate * rate for q, rate in zip(x, v))
    pairs = [b.graph.cos(x[i] - x[j]) * v[i] * v[j] * (1.0 / n) for i in range(n) for j in range(i)]
    b.lagrangian("motion", m * (own + b.graph.sum(pairs)), is_kinetic=True)
    return b.model()


def string_pendulum() -> Model:
    b = Builder("StringPendulum")
    m, length, g = b.parameter("m", 1.0), b.parameter("l", 0.5), b.parameter("g", 9.81)
    x, z = b.coordinate("x", 0.5), b.coordinate("z", 0.0)
    bob = b.particle("bob", m, (x, 0.0, z))
    b.gravity(g)
    b.constraint("string", norm(bob.position) - length)
    b.output("tension", -b.graph.symbol("multiplier", "string"))
    return b.model()


def free_solid() -> Model:
    b = Builder("FreeSolid")
    m, moment = b.parameter("m", 1.3), b.parameter("c", 0.2)
    xyz = [b.coordinate(k) for k in "xyz"]
    frame, _ = b.orientation("o", (0.1, 2.0, 0.3))
    b.solid("body", m, [b.parameter(f"I{k}", 0.1 * k) for k in (1, 2, 3)], frame, xyz)
    b.torque("spin", [moment * frame.axes[i][2] for i in range(3)], frame)
    b.output("Lx", b.quantity("angular_momentum", component="x"))
    b.output("p", b.quantity("momentum", "o", "x"))
    return b.model()


def rolling_ball() -> Model:
    """A ball that rolls on a turning table: a holonomic row and two of three velocity rows."""
    b = Builder("RollingBall")
    m, radius, omega = b.parameter("m", 1.0), b.parameter("R", 0.05), b.parameter("Omega", 2.0)
    x, y, z = b.coordinate("x", 0.3), b.coordinate("y", 0.0), b.coordinate("z", 0.05)
    frame, _ = b.orientation("o", (1.0, 0.0, 0.0))
    ball = b.solid("ball", m, [0.4 * m * radius * radius] * 3, frame, (x, y, z))
    b.gravity(b.parameter("g", 9.81))
    b.constraint("touch", z - radius)
    contact = b.vector((x, y, z - radius))
    w = matvec(frame.axes, frame.angular_velocity)
    lever = b.vector((0.0, 0.0, -radius))
    slip = add(ball.velocity, cross(w, lever))
    b.constraint("roll", *sub(slip, cross(b.vector((0.0, 0.0, omega)), contact)))
    b.output("normal", b.graph.symbol("multiplier", "touch"))
    b.output("spare", b.graph.symbol("multiplier", "roll[3]"))
    return b.model()


def charged_particle() -> Model:
    """In a uniform magnetic field, by a velocity-dependent potential."""
    b = Builder("ChargedParticle")
    m, charge, field = b.parameter("m", 1.0), b.parameter("e", 0.7), b.parameter("B", 1.5)
    x, y, z = (b.coordinate(k) for k in "xyz")
    u = b.particle("p", m, (x, y, z)).velocity
    b.lagrangian("magnetic", 0.5 * charge * field * (x * u[1] - y * u[0]))
    b.output("px", b.quantity("momentum", "x"))
    return b.model()


def rheonomic_disc() -> Model:
    """A disc whose hub is lifted as given, free to roll, with a bead on a driven arm."""
    b = Builder("RheonomicDisc")
    m, radius, omega = b.parameter("m", 1.0), b.parameter("R", 0.3), b.parameter("w", 2.0)
    x, y, phi = b.coordinate("x"), b.coordinate("y"), b.coordinate("phi")
    frame = b.rotate("F", b.world, "z", phi)
    b.solid("disc", m, (0.1, 0.1, 0.5 * m * radius * radius), frame, (x, y, 0.0))
    r = b.coordinate("r", 0.4)
    swing = b.graph.sin(omega * b.time)
    turned = omega * b.time
    b.particle("bead", 0.2 * m, (r * b.graph.cos(turned), r * b.graph.sin(turned), 0.0))
    b.potential("spring", 0.5 * b.parameter("k", 3.0) * (x - swing) ** 2 + 0.7 * r * r)
    b.dissipation("damper", 0.5 * b.parameter("c", 0.4) * b.der(r) ** 2)
    b.constraint("hub", y - 0.2 * swing)
    b.constraint("rolling", b.der(x) - radius * b.der(phi) * (1.0 + 0.1 * swing) - 0.3 * swing)
    return b.model()


def knife_edge() -> Model:
    """The Chaplygin sleigh: centre of mass ahead of a knife edge."""
    b = Builder("KnifeEdge")
    m, moment, d = b.parameter("m", 1.0), b.parameter("J", 0.2), b.parameter("d", 0.3)
    x, y, phi = b.coordinate("x"), b.coordinate("y"), b.coordinate("phi")
    g = b.graph
    frame = b.rotate("F", b.world, "z", phi)
    b.solid("sleigh", m, (0.0, 0.0, moment), frame, (x + d * g.cos(phi), y + d * g.sin(phi), 0.0))
    b.constraint("knife", b.der(x) * g.sin(phi) - b.der(y) * g.cos(phi))
    return b.model()


def declared_speeds() -> Model:
    """The sleigh with speeds along and across the knife."""
    b = Builder("DeclaredSpeeds")
    m, moment, d = b.parameter("m", 1.0), b.parameter("J", 0.2), b.parameter("d", 0.3)
    x, y, phi = b.coordinate("x"), b.coordinate("y"), b.coordinate("phi")
    g = b.graph
    frame = b.rotate("F", b.world, "z", phi)
    b.solid("sleigh", m, (0.0, 0.0, moment), frame, (x + d * g.cos(phi), y + d * g.sin(phi), 0.0))
    b.speed("u", b.der(x) * g.cos(phi) + b.der(y) * g.sin(phi))
    w = b.speed("w", -b.der(x) * g.sin(phi) + b.der(y) * g.cos(phi))
    b.constraint("knife", w)
    b.dissipation("mud", 0.5 * b.parameter("c", 0.2) * w * w)
    b.output("ax", g.symbol("acceleration", "x", order=2))
    b.output("p", b.quantity("momentum", "x"))
    return b.model()


def constant_speed() -> Model:
    """Appell-Hamel's kind: |velocity| = c, a velocity row that is not affine."""
    b = Builder("ConstantSpeed")
    m, c = b.parameter("m", 1.0), b.parameter("c", 1.5)
    x, y, z = (b.coordinate(k, rate=0.5) for k in "xyz")
    u = b.particle("p", m, (x, y, z)).velocity
    b.gravity(b.parameter("g", 9.81))
    b.constraint("speed", u[0] * u[0] + u[1] * u[1] + u[2] * u[2] - c * c)
    return b.model()


def relativistic() -> Model:
    """A free Lagrangian whose mass matrix depends on the speeds."""
    b = Builder("Relativistic")
    x, y = b.coordinate("x"), b.coordinate("y")
    m, c = b.parameter("m", 1.3), b.parameter("c", 3.0)
    square = b.der(x) ** 2 + b.der(y) ** 2
    b.lagrangian("free", -m * c * c * b.graph.sqrt(1.0 - square / (c * c)))
    b.potential("well", 0.5 * (x * x + 2.0 * y * y))
    return b.model()


ALL: dict[str, Callable[[], Model]] = {
    "pendulum": pendulum, "double pendulum": lambda: chain(2), "chain of 5": lambda: chain(5),
    "string pendulum": string_pendulum, "free solid": free_solid, "rolling ball": rolling_ball,
    "charged particle": charged_particle, "rheonomic disc": rheonomic_disc, "knife edge": knife_edge,
    "declared speeds": declared_speeds, "constant speed": constant_speed, "relativistic": relativistic,
}  # fmt: skip
