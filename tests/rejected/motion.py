"""What may move, what may not, what is known only once the equations are solved; scenes and effects.

The form of a case is told in `names`.
"""

CASES = [
    ("a parameter that moves", "LAG0311", "parameter Length k = «2*x»;"),
    ("a parameter of time", "LAG0311", "parameter Time k = «time»;"),
    ("a start that moves", "LAG0311", "coordinate Length y(«start = x»);"),
    ("a constant that moves", "LAG0311", "constant Length k = «x»;"),
    ("a derivative of an input", "LAG0311", "input Length u; potential V = 1 [N.s/m]*der(«u»)*x/1 [m];"),
    ("a frame turned by an input", "LAG0311", "input Angle u; frame F = rotate_z(world, «u»);"),
    (
        "a place that depends on a rate",
        "LAG0313",
        "body c = Particle(mass = m, at = «{der(x)*1 [s], 0, 0}»);",
    ),
    ("a point that depends on a rate", "LAG0313", "point P = «{der(x)*1 [s], 0, 0}»;"),
    ("a potential that depends on a rate", "LAG0313", "potential V = «1/2*m*der(x)^2»;"),
    ("a frame that depends on a rate", "LAG0313", "frame F = «rotate_z(world, der(x)*1 [s/m])»;"),
    ("a force that depends on an acceleration", "LAG0219", "force F = «m*acceleration(b)» at b;"),
    (
        "a force that depends on the reaction of a body",
        "LAG0219",
        "coordinate Length y; body c = Particle(mass = m, at = {0, y, 0}); constraint k: x = y; "
        "force F = «reaction(c)» at b;",
    ),
    ("a constraint of an energy", "LAG0219", "constraint c: «energy() = 1 [J]»;"),
    ("a constraint of an acceleration", "LAG0219", "constraint c: «der(der(x)) = 1 [m/s2]»;"),
    ("a potential of an energy", "LAG0219", "potential V = «energy()»;"),
    ("a speed of an acceleration", "LAG0219", "speed Velocity u = «der(der(x))*1 [s]»;"),
    (
        "a derivative of a reaction",
        "LAG0219",
        "constraint c: x = 0; output Power p = der(«reaction(c)»)*1 [m];",
    ),
    ("an initial condition of an energy", "LAG0219", "initial «energy() = 1 [J]»;"),
    ("an unknown effect of a scene", "LAG0212", "scene s uses «wind»;"),
    ("an unknown effect that is required", "LAG0212", "effect e requires «wind»; end e; scene s uses e;"),
    ("an unknown effect that is excluded", "LAG0212", "effect e excludes «wind»; end e; scene s uses e;"),
    ("an unknown effect after unless", "LAG0212", "potential V = 1 [N]*x unless «wind»;"),
    (
        "an effect that lacks another",
        "LAG0213",
        "effect d end d; effect e requires «d»; end e; scene s uses e;",
    ),
    (
        "effects that exclude each other",
        "LAG0213",
        "effect d end d; effect e excludes «d»; end e; scene s uses e, d;",
    ),
    (
        "a thing of an unused effect",
        "LAG0214",
        "effect e parameter Real k = 1; end e; effect d end d; potential V = «k»*1 [N]*x; scene s uses d;",
    ),
    (
        "a thing that an effect replaces",
        "LAG0214",
        "effect e end e; parameter Real k = 1 unless e; potential V = «k»*1 [N]*x; scene s uses e;",
    ),
    ("an unknown parameter of a scene", "LAG0215", "scene s parameter «k» = 1; end s;"),
    ("a start of an unknown coordinate", "LAG0224", "scene s start «y» = 1; end s;"),
    ("a start of a parameter", "LAG0224", "scene s start «m» = 1; end s;"),
    ("two scenes of one name", "LAG0202", "scene s; scene «s»;"),
    ("two effects of one name", "LAG0202", "effect e end e; effect «e» end e;"),
    ("a coordinate in a scene", "LAG0120", "scene s «coordinate» Length y; end s;"),
    ("a scene in an effect", "LAG0120", "effect e «scene» s; end e;"),
    ("a parameter of a scene without a value", "LAG0210", "scene s parameter «m»; end s;"),
]
