"""Random mechanisms, by a seed: contacts, friction, joints, servos, events, and what acts on them, in models
that a user could have written.

The models are made of texts with slots.  `<a|b>` is one of its alternatives, `<word>` one of those of `RULES`
or a name of the model so far (of `NAMES`), `<word1>` the same one wherever it stands in a text, and `#` the
number of the part.
"""

from __future__ import annotations

import random
import re

from tests.fuzz.models import VALUES, Case
from tests.fuzz.words import NASTY

RULES: dict[str, list[str]] = {
    "length": ["0.1 [m]", "20 [cm]", "0.3 [m]", "50 [mm]", "1 [m]", "1 [ft]", "5 [mm]"],
    "height": ["0", "0", "0", "<length>", "<length>", "1e-3 [mm]"],
    "mass": ["1 [kg]", "200 [g]", "0.5 [kg]", "2", "5 [lb]", "0.1 [t]", "3 [kg]", "20 [g]"],
    "inertia": ["{0.1, 0.1, 0.1} [kg.m2]", "{0.01, 0.02, 0.02}", "{500, 500, 700} [g.m2]",
                "{{0.2, 0.01, 0}, {0.01, 0.2, 0}, {0, 0, 0.3}} [kg.m2]"],
    "speed": ["1 [m/s]", "0.5 [m/s]", "-2 [m/s]", "3 [km/h]", "-1", "2 [mm/s]"],
    "rate": ["0", "<speed>", "<speed>"],
    "fall": ["0", "0", "<speed>", "-1 [m/s]"],
    "turn": ["1 [rad/s]", "-3", "30 [rpm]", "90 [deg/s]", "20 [rad/s]", "0", "0"],
    "angle": ["0.3 [rad]", "20 [deg]", "-0.5", "60 [deg]", "0", "0", "1e-3 [rad]"],
    "time": ["10 [ms]", "0.02 [s]", "0.05 [s]", "1 [ms]", "0.2 [s]", "0 [s]"],
    "sample": ["5 [ms]", "0.01 [s]", "0.02 [s]"],
    "force": ["1 [N]", "5 [N]", "-20 [N]", "0.05 [kN]", "200 [N]", "0.1 [N]"],
    "spring": ["100 [N/m]", "1 [N/mm]", "10 [kg/s2]"],
    "damping": ["1 [N.s/m]", "20 [kg/s]", "0.05 [kg/s]"],
    "wave": ["", "*sin(30*time/(1 [s]))", "*(if time > <time> then 1 else 0)", "*exp(-time/(0.1 [s]))"],
    "axis": ["world.x", "world.y", "world.z", "world.y", "{1, 0, 1}", "{0, -1, 0}"],
    "vector": ["{0, 0, 0}", "{0.1, 0, 0} [m]", "{0, 0.05, -0.2} [m]", "{10, 0, 30} [mm]"],
    # Laws of contact, without the velocity of the slip.
    "restitution": ["0", "0.5", "0.8", "1", "0.3", "1/(1 + 0.2*time/(1 [s]))", "e0"],
    "bounce": ["", "(restitution = <restitution>)", "(restitution = <restitution>, law = poisson)"],
    "mu": ["0.2", "0.5", "0", "0.05", "1.5", "mu0"],
    "friction": ["friction = <mu>", "friction = <mu>", "friction = 0.2, static = 0.3", "friction = mu0, static = 2*mu0",
                 "friction = 0.1 + 0.1*exp(-slip/(0.1 [m/s]))", "friction = 0.3*(1 + time/(1 [s]))"],
    "rubs": ["<friction>", "<friction>, restitution = <restitution>",
             "<friction>, restitution = <restitution>, law = poisson"],
    "pin": ["", "", "friction = <mu>, radius = <10 [mm]|0.02 [m]>, ",
            "friction = 0.1, static = 0.2, radius = 2 [cm], "],
    "guide": ["", "", "friction = <mu>, ", "friction = 0.1, static = 0.15, "],
    # Joints that place a body.
    "placed": [
        "Revolute(world, b#, axis = <axis>, at = <vector>, <pin>angle(start = <angle>, rate = <turn>))",
        "Revolute(world, b#, axis = <axis>, at = <vector>, <pin>angle(rate = <turn>))",
        "Prismatic(world, b#, axis = <axis>, <guide>slide(rate = <rate>))",
        "Cylindrical(world, b#, axis = <axis>, at = <vector>, slide(rate = <rate>), angle(rate = <turn>))",
        "Screw(world, b#, axis = <axis>, at = <vector>, pitch = <5 [mm]|0.1 [m]>, angle(rate = <turn>))",
        "Spherical(world, b#, at = <vector>, orientation(rate = {1, 0, 2} [rad/s]))",
        "Universal(world, b#, axis = world.x, at = <vector>, along = <world.y|world.z>, angle1(start = <angle>))",
        "Planar(world, b#, axis = world.y, at = <vector>, along = world.x, x(rate = <rate>))",
        "PointOnPlane(world, b#, axis = <axis>, at = <vector>)",
        "LineOnPlane(world, b#, axis = world.z, at = <vector>, along = world.x, x(rate = <rate>))",
        "PointOnLine(world, b#, axis = <axis>, at = <vector>, slide(rate = <rate>))",
        "Free(world, b#, at = <vector>, z(start = <length>))",
        "Weld(world, b#)",
    ],
    "bound": ["<= 2 [m]", ">= -2 [m]", ">= -1e4 [m]", "<= 0.3 [m]"],
    "end": ["<= 100 [deg]", ">= -2"],
}

# What moves, each with contacts of its own; the ground is at z = z0.
PARTS = [
    # particles above a floor, beside a wall, on a rope
    """coordinate Length x#(start = <length>, rate = <rate>), z#(start = z0 + <height>, rate = <fall>);
    body b# = Particle(mass = <mass>, at = {x#, 0, z#});
    constraint floor#: z# >= z0 (<rubs>, <slip = der(x#)|at = b#|slip = der(x#) - <speed>|at = position(b#)>);
    <|constraint wall#: x# <= <length> + 1 [m] <bounce>;|constraint rope#: norm({x#, 0, z# - z0}) <= 2 [m] <bounce>;>""",
    """coordinate Length x#(rate = <rate>), y#(rate = <rate>), z#(start = z0 + <height>, rate = <fall>);
    body b# = Particle(mass = <mass>, at = {x#, y#, z#});
    constraint floor#: position(b#).z >= z0 (<rubs>, <at = b#|slip = {der(x#), der(y#)}|slip = velocity(b#)>);
    <|constraint wall#: y# <= 0.3 [m] (<rubs>, at = b#);|constraint post#: x#^2 + y#^2 <= 4 [m2] <bounce>;>""",
    # on a slope, in a groove between two planes
    """parameter Angle tilt# = <angle>;
    coordinate Length x#(rate = <rate>), z#(start = z0 + <height>);
    body b# = Particle(mass = <mass>, at = {x#, 0, z#});
    constraint slope#: (z# - z0)*cos(tilt#) - x#*sin(tilt#) >= 0 (<rubs>,
      <at = b#|slip = der(x#)*cos(tilt#) + der(z#)*sin(tilt#)>);
    <|constraint other#: (z# - z0)*cos(tilt#) + x#*sin(tilt#) >= 0 (<rubs>, at = b#);>""",
    # a box on corners, with a loop
    """parameter Length w# = <length>, h# = <length>;
    coordinate Length x#(rate = <rate>), z#(start = z0 + h# + <height>, rate = <fall>);
    coordinate Angle phi#(rate = <0|0|<turn>>);
    frame F# = rotate_y(world, phi#);
    body b# = Solid(mass = <mass>, inertia = <inertia>, frame = F#, com = {x#, 0, z#});
    for i in 1:2 loop
      point foot#[i] = {x#, 0, z#} + (2*i - 3)*w#*F#.x - h#*F#.z;
      constraint corner#[i]: foot#[i].z >= z0 (<rubs>, <slip = der(foot#[i].x)|at = foot#[i]|on = b#, at = foot#[i]>);
    end for;""",
    # a table on three or four feet, in space
    """coordinate Length x#(rate = <rate>), y#, z#(start = z0 + 0.5 [m] + <height>);
    coordinate Orientation o#<|(rate = {0, 0, 1} [rad/s])>;
    frame F# = rotate(world, o#);
    body b# = Solid(mass = <mass>, inertia = <inertia>, frame = F#, com = {x#, y#, z#});
    structural Integer n# = <3|4>;
    for i in 1:n# loop
      point foot#[i] = {x#, y#, z#} + 0.4 [m]*(cos(2*pi*i/n#)*F#.x + sin(2*pi*i/n#)*F#.y) - 0.5 [m]*F#.z;
      constraint leg#[i]: foot#[i].z >= z0 (<rubs>, on = b#, at = foot#[i]);
    end for;""",
    # balls and wheels
    """parameter Length r# = <length>;
    coordinate Length x#(rate = <rate>), y#, z#(start = z0 + r# + <height>);
    coordinate Orientation o#(rate = {<0|10>, 0, <0|5>} [rad/s]);
    frame F# = rotate(world, o#);
    body b# = Solid(mass = <mass>, inertia = 0.01 [kg.m2]*{1, 1, 1}, frame = F#, com = {x#, y#, z#});
    constraint floor#: z# >= z0 + r# (<rubs>, on = b#, at = {x#, y#, z#} - r#*world.z);""",
    """parameter Length r# = <length>;
    coordinate Length x#(rate = <rate>), z#(start = z0 + r#);
    coordinate Angle phi#(rate = <turn>);
    frame F# = rotate_y(world, phi#);
    body b# = Solid(mass = <mass>, inertia = {0.01, 0.02, 0.01} [kg.m2], frame = F#, com = {x#, 0, z#});
    constraint road#: z# >= z0 + r# (<rubs>, <slip = der(x#) - r#*der(phi#)|on = b#, at = {x#, 0, z# - r#}>);
    torque loss# = -<0.01|0.1>*r#*<reaction(road#)|abs(reaction(road#))>*tanh(der(phi#)/(1 [rad/s]))*world.y on b#;""",
    # two bodies: a block on a cart, on a wedge; a row; a stack
    """coordinate Length s#(rate = <rate>), x#(rate = <rate>), z#(start = z0 + <height>);
    body cart# = Solid(mass = <mass>, inertia = {0, 0, 0}, frame = world, com = {s#, 0, z0});
    body b# = Particle(mass = <mass>, at = {x#, 0, z#});
    constraint deck#: z# >= z0 (<rubs>, <at = b#, against = cart#|slip = der(x#) - der(s#)>);
    <|constraint stop#: x# - s# <= 0.2 [m] <bounce>;>""",
    """parameter Angle a# = <20 [deg]|0.1>;
    coordinate Length s#, x#(start = 1 [m]), z#(start = z0 + tan(a#)*1 [m] + <height>);
    body wedge# = Solid(mass = <mass>, inertia = {0, 0, 0}, frame = world, com = {s#, 0, z0});
    body b# = Particle(mass = <mass>, at = {x#, 0, z#});
    constraint slope#: (z# - z0)*cos(a#) >= (x# - s#)*sin(a#) (<rubs>, at = b#, against = wedge#);
    <|constraint track#: s# = <0|0.1 [m]*sin(time/(0.1 [s]))>;>""",
    """structural Integer n# = <2|3|4>;
    coordinate Length x#[n#](start = {<0.1 [m]|20 [cm]>*i for i in 1:n#}, rate = {(2 - i)*(1 [m/s]) for i in 1:n#});
    for i in 1:n# loop
      body b#[i] = Particle(mass = i*1 [kg], at = {x#[i], 0, z0});
    end for;
    for i in 1:n#-1 loop
      constraint pair#[i]: x#[i+1] - x#[i] >= 0.1 [m] <bounce>;
    end for;""",
    """coordinate Length z#(start = z0 + <height>), u#(start = z0 + <height> + 0.5 [m]);
    body b# = Particle(mass = <mass>, at = {0, 0, z#});
    body c# = Particle(mass = <mass>, at = {0, 0, u#});
    constraint floor#: z# >= z0 <bounce>;
    constraint pair#: u# >= z# <bounce>;""",
    # pendulums with stops, a cradle, a slack rope, what shakes
    """coordinate Angle phi#(start = <angle>, rate = <turn>);
    body b# = Particle(mass = <mass>, at = {0, 0, z0} + <length>*{sin(phi#), 0, -cos(phi#)});
    constraint stop#: {phi#, -phi#} >= {-1.2, -1.1} <bounce>;""",
    """coordinate Length z#(start = z0 + <height>), x#(rate = <rate>);
    body b# = Particle(mass = <mass>, at = {x#, 0, z#});
    constraint shaker#: z# >= z0 + <1 [mm]|0.05 [m]>*sin(<50|300>*time/(1 [s])) (<rubs>, slip = der(x#));""",
    # two-sided constraints that rub
    """coordinate Length x#(rate = <rate>), z#;
    body b# = Particle(mass = <mass>, at = {x#, 0, z0 + z#});
    constraint rail#: z# = <0|0.2*x#|0.1 [m]*sin(x#/(0.5 [m]))> (<friction>, <at = b#|slip = der(x#)>);""",
    """coordinate Length x#, z#(start = -0.5 [m]);
    body b# = Particle(mass = <mass>, at = {x#, 0, z0 + z#});
    constraint hoop#: x#^2 + z#^2 = 0.25 [m2] <(<friction>, at = b#)|(<friction>, at = position(b#))|>;""",
    # servos
    """coordinate Length x#;
    coordinate Angle phi#(start = <angle>);
    body b# = Particle(mass = <mass>, at = {x#, 0, z0});
    body bob# = Particle(mass = <mass>, at = {x#, 0, z0} + <length>*{sin(phi#), 0, -cos(phi#)});
    force motor# = {1 [N], 0, 0} at b#;
    constraint path#: x# = <0.3 [m]*sin(4*time/(1 [s]))|0|table(time, {{0, 0}, {0.1, 0.01}, {0.2, 0.03}, {0.4, 0}}, interpolation = "cubic")> (by = motor#);""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0.1, 0, 0} [m]);
    joint j# = Revolute(world, b#, axis = world.y, at = {0, 0, 0}<|, angle(start = 0)>);
    torque motor# = 1 [N.m]*world.y on b#;
    constraint path#: j#.angle = <0.5*time^2/(1 [s2])|0.1*sin(time/(0.02 [s]))> (by = motor#);""",
    # joints: open ones of all kinds, on which others stand
    """body c# = Solid(mass = <mass>, inertia = <inertia>, com = <vector>);
    joint k# = Revolute(world, c#, axis = <axis>, at = {0, 0, 0}, <pin>angle(rate = <turn>));
    body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0.1, 0.2, 0} [m]);
    joint j# = <carried>;""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = <vector>);
    joint j# = <placed>;""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, -0.1} [m]);
    joint j# = Revolute(world, b#, axis = world.y, at = {0, 0, 0}, <pin>angle(start = <angle>, rate = <turn>));
    constraint stop#: j#.angle <= 1.5 <bounce>;
    point tip# = attached(b#, {0, 0, -0.2} [m]);
    constraint bed#: tip#.z >= -0.2 [m] <<bounce>|(<rubs>, on = b#, at = tip#)>;""",
    # joints that close loops
    """body crank# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, 0});
    body rod# = Solid(mass = <mass>, inertia = {0.01, 0.01, 0.01} [kg.m2], com = {0.1, 0, 0} [m]);
    body b# = Particle(mass = <mass>, at = {0.2, 0, 0} [m]);
    joint main# = Revolute(world, crank#, axis = world.y, at = {0, 0, 0}, <pin>angle(rate = <turn>));
    joint wrist# = Revolute(crank#, rod#, axis = world.y, at = {0.05, 0, 0} [m]<|, friction = 0.1, radius = 10 [mm]>);
    joint guide# = Prismatic(world, b#, axis = world.x<|, friction = <mu>>);
    joint pin# = Revolute(rod#, b#, axis = world.y, at = {0.2, 0, 0} [m]);
    <|constraint end#: guide#.slide >= -50 [mm] <bounce>;>""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, -0.1} [m]);
    body c# = Solid(mass = <mass>, inertia = <inertia>, com = {0.5, 0, -0.1} [m]);
    joint j# = Revolute(world, b#, axis = world.y, at = {0, 0, 0}, <pin>angle(rate = <turn>));
    joint k# = Revolute(world, c#, axis = world.y, at = {0.5, 0, 0} [m]<|, friction = <mu>, radius = 1 [cm]>);
    joint rod# = <Distance(b#, c#, at = {0, 0, -0.2} [m], to = {0.5, 0, -0.3} [m])|Gear(j#, k#, ratio = <2|-0.5>)>;""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, 0});
    body c# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, -0.1} [m]);
    joint j# = Revolute(world, b#, axis = world.y, at = {0, 0, 0}, <pin>angle(rate = <turn>));
    joint k# = Prismatic(world, c#, axis = world.x<|, friction = <mu>>);
    joint teeth# = RackAndPinion(j#, k#, radius = 100 [mm]);""",
    """body b# = Solid(mass = <mass>, inertia = <inertia>, com = {0, 0, 0.1} [m]);
    joint j# = Free(world, b#, at = {0, 0, 0.1} [m]);
    joint roll# = Rolling(world, b#, normal = world.z, at = {0, 0, 0.1} [m], radius = 0.1 [m]<|, axis = world.y>);""",
]

# What acts on them, watches them, or is shown.
ACTIONS = [
    "potential spring# = 1/2*<spring>*(<slide1> - <length>)^2;",
    "potential coil# = 1/2*<5 [N.m]|0.1 [N.m/rad]>*<hinge>^2;",
    "dissipation damper# = 1/2*<damping>*der(<slide>)^2;",
    "force drag# = -<damping>*velocity(<body1>) at <body1>;",
    "force drag# = -<0.1 [kg/m]|2 [g/mm]>*norm(velocity(<body1>))*velocity(<body1>) at <body1>;",
    "force push# = <force><wave>*<world.x|world.z|normalize({1, 0, 1})> at <body>;",
    "input Force u# = <force>;\nforce drive# = u#*world.x at <body>;",
    'force gust# = {table(time, {0, 0.02, 0.05} [s], {0, 5, -3} [N]<|, interpolation = "held"|, interpolation = "cubic">), 0, 0}'
    " at <body>;",
    "force pull# = -<spring>*(position(<body1>) - position(<body2>)) at <body1>;",
    "torque engine# = <1 [N.m]|-20 [N.m]><wave>*<axis> on <solid>;",
    "force coulomb# = -<force>*sign(der(<slide1>))*world.x at <body>;",
    "force bump# = (if <slide1> < <length> then 0 else -<spring>*(<slide1> - <length>))*world.x at <body>;",
    "force rub# = -<0.1|0.4>*abs(reaction(<row>))*tanh(der(<slide>)/(0.1 [m/s]))*world.x at <body>;",
    "force resist# = -<0.05|0.3>*reaction(<straight>)*tanh(der(<slide>)/(0.1 [m/s]))*world.x at <body>;",
    "constraint tie#: <slide1> = <slide2>;",
    "constraint hold#: <hinge1> = <hinge2>;",
    "constraint skate#: der(<slide1>) = <0|0.2*der(<slide2>)|2 [m/s]>;",
    "constraint limit#: <slide> <bound> <bounce>;",
    "constraint limit#: <hinge> <end> <bounce>;",
    "constraint string#: norm(position(<body1>) - position(<body2>)) <= z0 + 50 [m] <bounce>;",
    # discrete variables and events
    """discrete Force held#(start = 0);
    discrete Time next#(start = <sample>);
    force digital# = held#*world.x at <body>;
    when time >= next# then
      reinit(held#, -<spring>*<slide1> - <damping>*der(<slide1>));
      reinit(next#, next# + <sample>);
    end when;""",
    """discrete Boolean on#(start = <true|false>);
    force motor# = (if on# then <force> else 0)*world.x at <body>;
    when der(<slide1>) > 0.6 [m/s] then reinit(on#, false); end when;
    when der(<slide1>) < 0.4 [m/s] then reinit(on#, true); end when;""",
    """discrete Real count#(start = 0);
    when impulse(<contact1>) > <0|0|1e-9 [N.s]> then reinit(count#, count# + 1); <|mark("hit");> end when;""",
    "when time >= <time> then reinit(der(<slide1>), <speed>); end when;",
    "when time >= <time> then reinit({der(<slide1>), der(<slide2>)}, {0, der(<slide2>) + <speed>}); end when;",
    "when <slide1> > <length> then reinit(der(<slide1>), -0.5*der(<slide1>)); mark(\"bounce\"); end when;",
    'when <slide> > <length> or der(<hinge>) < -1 [rad/s] then terminate("far"); end when;',
    'when reaction(<straight>) > <5 [N]|0> then <mark("loaded")|terminate("breaks")>; end when;',
    'when energy() < <1 [J]|0> and time > 1 [ms] then mark("low"); end when;',
    "output Force push#_ = reaction(<straight>);",
    "output Momentum blow#_ = impulse(<straight>);",
    "output Energy E#_ = <energy()|kinetic() + potential()|potential()>;",
    "output Force F#_[3] = reaction(<joint>).force;\noutput Torque M#_[3] = reaction(<joint>).moment;",
    "output Force R#_[3] = reaction(<particle>);",
    "output Acceleration a#_[3] = acceleration(<body>);",
    "output Length gap#_ = position(<body>).z - z0;",
    "output Real[rad/s2] alpha#_ = der(der(<hinge>));",
    "output Momentum p#_[3] = momentum();",
]
RULES["carried"] = [text.replace("(world, ", "(c#, ") for text in RULES["placed"]]
SIMULATIONS = ["stop = 0.1 [s]", "stop = 50 [ms], points = 20", "stop = 0.3, accuracy = 1e-4", "stop = 0.02 [s]"]

# Names of a text by what they are for slots: (kind, pattern whose group has the names, what each is written as).
NAMES = [
    ("slide", r"coordinate Length ([^;]*)", "{}"),
    ("slide", r"joint (\w+) = Prismatic", "{}.slide"),
    ("hinge", r"coordinate Angle ([^;]*)", "{}"),
    ("hinge", r"joint (\w+) = (?:Revolute|Screw)\([^;]*angle\(", "{}.angle"),
    ("body", r"body (\w+) = ", "{}"),
    ("solid", r"body (\w+) = Solid", "{}"),
    ("particle", r"body (\w+) = Particle", "{}"),
    ("jointed", r"joint \w+ = \w+\(world, (\w+),", "{}"),
    ("joint", r"joint (\w+) = (?!Distance|Gear|Rack|Rolling)", "{}"),
    ("contact", r"constraint (\w+): [^;]*?[<>]=", "{}"),
    ("straight", r"constraint (?!stop|post|limit)(\w+): [^;]*?[<>]=", "{}"),
    ("row", r"constraint ((?:rail|track|tie)\w*): ", "{}"),
]
_SLOT = re.compile(r"<([^\s<>=](?:[^<>]|(?<=\s)[<>]=?(?=\s))*)(?<!\s)>")  # what stands between blanks compares
_ATTRIBUTES = re.compile(r"\([^()]*(?:\([^()]*\)[^()]*)*\)|\[[^\]]*\]")


class Missing(Exception):
    """No name of the model fits a slot."""


class _Mechanism:
    def __init__(self, chance: random.Random):
        self.chance = chance
        self.known: dict[str, list[str]] = {}

    def fill(self, text: str, number: int) -> str:
        """The text without slots."""
        same: dict[str, str] = {}

        def chosen(slot: re.Match[str]) -> str:
            word = slot[1]
            if "|" in word:
                return self.chance.choice(word.split("|"))
            kind = word.rstrip("0123456789")
            others = [v for k, v in same.items() if k.startswith(kind)]
            if word not in same:
                choices = RULES.get(kind) or [n for n in self.known.get(kind, []) if n not in others]
                if not choices:
                    raise Missing(word)
                same[word] = self.chance.choice(choices)
            found = same[word]
            if word == kind:
                del same[word]
            return found

        while (filled := _SLOT.sub(chosen, text, count=1)) != text:
            text = filled
        return text.replace("#", str(number)).replace("\n    ", "\n")

    def note(self, text: str, prefix: str = "") -> None:
        """Enter the names that a text declares."""
        for kind, pattern, written in NAMES:
            for found in re.findall(pattern, text):
                names = _ATTRIBUTES.sub("", found).split(",")
                if not re.search(rf"\b{names[0].strip()}\[", text):
                    self.known.setdefault(kind, []).extend(prefix + written.format(n.strip()) for n in names)

    def case(self) -> Case:
        chance, head, items = self.chance, list[str](), list[str]()
        origin = chance.choice(["0", "0", "0", "0", "1 [m]", "-30 [cm]", "1000 [km]", "1e4"])
        items.append(f"parameter Length z0 = {origin};\nparameter Real mu0 = 0.3, e0 = 0.4;")
        for number in range(1, chance.choice([2, 2, 2, 3, 4])):
            text = self.fill(chance.choice(PARTS), number)
            if chance.random() < 0.15:
                inner = f"parameter Length z0 = 0;\nparameter Real mu0 = 0.3, e0 = 0.4;\n{text}"
                head.append(f"model Part{number}\n{_indented(inner)}end Part{number};\n")
                self.note(text, f"part{number}.")
                text = f"Part{number} part{number}(z0 = z0);"
            else:
                self.note(text)
            items.append(text)
        gravity = f"Gravity field{chance.choice(['', '', '(g = 9.81 [m/s2])', '(g = 1.6)', '(g = 0)'])};"
        effects = []
        for number in range(10, 10 + chance.choice([1, 2, 3, 5, 8])):
            try:
                text = self.fill(chance.choice(ACTIONS), number)
            except Missing:
                continue
            if chance.random() < 0.15:
                effects.append(f"effect_{number}")
                text = f"effect {effects[-1]}\n{_indented(text)}end {effects[-1]};"
            else:
                self.note(text)
            items.append(text)
        if chance.random() < 0.2:
            effects.append("weight")
            gravity = f"effect weight\n  {gravity}\nend weight;"
        items += [gravity, *self._scenes(effects)]
        return self._named(f"{''.join(head)}model M\n{_indented(*items)}end M;\n")

    def _scenes(self, effects: list[str]) -> list[str]:
        chance, found = self.chance, list[str]()
        for number in range(chance.choice([0, 1, 1, 2]) if not effects else 2):
            used = [e for e in effects if chance.random() < 0.7]
            inside = [f"simulate({chance.choice(SIMULATIONS)});"]
            if chance.random() < 0.2:
                inside.append("parameter mu0 = 0.6;")
            if self.known.get("slide") and chance.random() < 0.2:
                inside.append(f"start der({chance.choice(self.known['slide'])}) = {chance.choice(RULES['speed'])};")
            uses = f" uses {', '.join(used)}" if used else ""
            found.append(f"scene run{number}{uses}\n{_indented(*inside)}end run{number};")
        return found

    def _named(self, text: str) -> Case:
        """With words for `sim`; now and then under names that programs stumble over."""
        chance, run = self.chance, list[str]()
        for own in self.known.get("slide", []):
            if chance.random() < 0.05:
                run += ["--start", f"der({own})={chance.choice(VALUES)}"]
        own = sorted(set(re.findall(r"\b[A-Za-z_]+\d+\b", text)) - {"m2", "s2"})
        if not run and chance.random() < 0.1:
            chosen = chance.sample(NASTY, len(own))
            given = dict(zip(own, (n for n in chosen)))
            text = re.sub(r"\b[A-Za-z_]+\d+\b", lambda name: given.get(name[0], name[0]), text)
        return Case(text, run=tuple(run))


def _indented(*texts: str) -> str:
    return "".join(f"  {line}\n" for text in texts for line in text.split("\n") if line.strip())


def mechanism(seed: int) -> Case:
    """The model of this seed."""
    return _Mechanism(random.Random(seed)).case()
